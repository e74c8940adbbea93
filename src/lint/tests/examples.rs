//! The numbers that findings show, by hand.

use super::*;

/// The only finding of a state.
fn only(question: &StateQuestion) -> Finding {
    let mut findings = lint_state(question);
    assert_eq!(findings.len(), 1, "{findings:?}");
    findings.remove(0)
}

/// The findings of one rule in a scene.
fn of(rule: &str, scene: &Scene) -> Vec<Finding> {
    let findings = lint_scene(scene).expect("the scene renders");
    findings.into_iter().filter(|finding| finding.rule == rule).collect()
}

#[test]
fn a_state_shows_one_blend_as_it_is_and_repaired() {
    // White at alpha 1/2 over transparent black: alpha 1/4 (63.75 of 255), repaired 1/2 (127.5, to even).
    let squared = only(&state("Blend SrcAlpha OneMinusSrcAlpha ZWrite Off")).example;
    assert_eq!((squared.stored, squared.repaired), ([128, 128, 128, 64], [128, 128, 128, 128]));
    // White times a constant of 0, over grey 64/255 times one minus it: the grey stays. With 1/2: (255 + 64) / 2 = 159.5.
    let factors = "GL_CONSTANT_COLOR GL_ONE_MINUS_CONSTANT_COLOR GL_ONE GL_ZERO";
    let unset = only(&StateQuestion { depth_known: false, ..state(factors) });
    assert_eq!(unset.example.stored, [64, 64, 64, 255], "{unset:?}");
    assert_eq!(unset.example.repaired, [160, 160, 160, 255], "{unset:?}");
}

#[test]
fn one_zero_shows_a_nan_that_survives() {
    let float = ColorFormat::from_name("rgba16float").expect("a format");
    let block = StateBlock::with_blend(Some(BlendState::REPLACE));
    let example = only(&StateQuestion { format: float, block, ..state("opaque") }).example;
    assert!(example.stored.iter().all(|code| code & 0x7C00 == 0x7C00 && code & 0x03FF != 0), "NaNs: {example:?}");
    assert_eq!(example.repaired, [0x3800, 0x3800, 0x3800, 0x3C00], "1/2 and 1 as binary16");
}

#[test]
fn one_zero_names_the_target() {
    let targets = "[[target.color]]\nformat = \"rgba8unorm\"\n[[target.color]]\nformat = \"rgba16float\"";
    let mut scene = scene(targets, &[OPAQUE]);
    let mut passes = scene.materials[0].passes();
    passes[0].state.blend = [Some(BlendState::REPLACE); 8];
    scene.materials[0].passes = Some(passes);
    let findings = of("one-zero", &scene);
    assert_eq!(findings.len(), 1, "the float target alone: {findings:?}");
    assert_eq!((findings[0].example.target, findings[0].example.format.name()), (1, "rgba16float"));
    assert!(findings[0].place.ends_with("color target 1"), "{findings:?}");
}

#[test]
fn prepass_cutoff_tells_both_tests() {
    let findings = of("prepass-cutoff", &hole(""));
    let problem = "it writes depth with no alpha test, and pass color draws the color with AlphaTest Greater 0.75";
    assert_eq!(findings.iter().map(|finding| finding.problem.as_str()).collect::<Vec<_>>(), [problem]);
}

/// An opaque quad behind is drawn after the blended one in front of it, and covers it.
#[test]
fn queue_names_the_draw_and_a_pixel_that_the_right_queue_changes() {
    let early = format!("{FADE}\nqueue = \"Geometry\"");
    let found = of("queue", &scene("clear = [0.1, 0.1, 0.1, 1.0]", &[OPAQUE, &early]));
    assert_eq!(found.len(), 1, "{found:?}");
    // Front to back: the near quad is the first draw.
    assert!(found[0].place.starts_with("draw 1 (o1"), "{found:?}");
    let right = scene("clear = [0.1, 0.1, 0.1, 1.0]", &[OPAQUE, FADE]).render(&crate::model::exact::Exact::default());
    let right = right.expect("renders");
    let (x, y) = found[0].example.pixel.expect("a pixel shows it");
    let codes = right.framebuffer.colors[0].as_ref().expect("a target").codes(x, y, 0);
    assert_eq!(found[0].example.repaired, codes, "repaired is the scene with the right queue");
    assert_ne!(found[0].example.stored, codes);
}

#[test]
fn queue_counts_the_passes_of_the_objects_before() {
    let two =
        format!("{OPAQUE}\n[[material.pass]]\nname = \"a\"\n[[material.pass]]\nname = \"b\"\nstate = \"ZTest Equal\"");
    let late = format!("{OPAQUE}\nqueue = \"Transparent\"");
    let found = of("queue", &scene("clear = [0.1, 0.1, 0.1, 1.0]", &[&two, &late]));
    let places: Vec<_> = found.iter().map(|finding| finding.place.as_str()).collect();
    assert_eq!(places.len(), 1, "{found:?}");
    assert!(places[0].starts_with("draw 3 (o1"), "{places:?}");
}
