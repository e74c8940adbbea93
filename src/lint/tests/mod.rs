//! Which rules fire ([`examples`]: what they show).

mod examples;

use super::*;
use crate::scene::tests::{FADE, OPAQUE, quads};
use crate::state::shaderlab::Properties;
use crate::state::text;

const TEXTURES: &str = r#"
[[texture]]
name = "half"
pattern = "solid"
size = [4, 4]
colors = [[0.8, 0.6, 0.4, 0.5]]
space = "linear"
[[texture]]
name = "half premultiplied"
pattern = "solid"
size = [4, 4]
colors = [[0.4, 0.3, 0.2, 0.5]]
space = "linear"
premultiplied = true
"#;

/// A scene of quads from far to near, each with its material's text.
fn scene(target: &str, materials: &[&str]) -> Scene {
    quads(&format!("{target}{TEXTURES}"), materials)
}

/// The rules that fire, each once; every finding with a pixel is checked to differ there.
fn fired(scene: &Scene) -> Vec<&'static str> {
    let findings = lint_scene(scene).expect("the scene renders");
    for finding in &findings {
        let Example { pixel, stored, repaired, .. } = &finding.example;
        assert!(pixel.is_none() || stored != repaired, "a pixel that shows it: {finding:?}");
        assert!(!finding.problem.is_empty() && !finding.fix.is_empty() && !finding.place.is_empty(), "{finding:?}");
    }
    let mut rules: Vec<_> = findings.iter().map(|finding| finding.rule).collect();
    rules.dedup();
    rules
}

fn state(state: &str) -> StateQuestion {
    StateQuestion {
        block: block(state),
        format: ColorFormat::from_name("rgba8unorm").expect("a format"),
        constant: None,
        source: None,
        depth_known: true,
    }
}

fn block(state: &str) -> StateBlock {
    text::parse(state, &Properties::new()).expect("a state")
}

fn fired_by(question: &StateQuestion) -> Vec<&'static str> {
    lint_state(question).iter().map(|finding| finding.rule).collect()
}

fn with_pass(material: &str, state: &str) -> String {
    format!("{material}\n[[material.pass]]\nstate = \"{state}\"")
}

#[test]
fn a_correct_scene_is_clean() {
    let clean = scene("clear = [0.0, 0.0, 0.0, 1.0]", &[OPAQUE, FADE, FADE]);
    assert_eq!(fired(&clean), Vec::<&str>::new(), "opaque, then two faded quads");
}

#[test]
fn destination_alpha_fires_on_targets_whose_alpha_matters() {
    let layer = "clear = [0.0, 0.0, 0.0, 0.0]";
    assert_eq!(fired(&scene(layer, &[FADE])), ["destination-alpha"], "a transparent layer to be composited");
    let own = with_pass(FADE, "Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha ZWrite Off");
    assert!(fired(&scene(layer, &[&own])).is_empty(), "alpha has factors of its own");
    let window = "clear = [0.0, 0.0, 0.0, 1.0]";
    assert!(fired(&scene(window, &[FADE])).is_empty(), "nobody reads a window's alpha");
    let reader = with_pass(FADE, "Blend OneMinusDstAlpha DstAlpha, Zero One ZWrite Off");
    assert_eq!(fired(&scene(window, &[FADE, &reader])), ["destination-alpha"], "a later factor reads it");
    let own_reader = with_pass(FADE, "Blend OneMinusDstAlpha DstAlpha, SrcAlpha OneMinusSrcAlpha ZWrite Off");
    assert!(fired(&scene(window, &[&own_reader])).is_empty(), "a draw's own factors read the alpha from before it");
    let other = with_pass(FADE, "Blend SrcAlpha OneMinusSrcAlpha, Zero One ZWrite Off");
    assert!(fired(&scene(layer, &[&other])).is_empty(), "a factor that is not SrcAlpha squares nothing");
    assert_eq!(fired_by(&state("Blend SrcAlpha OneMinusSrcAlpha ZWrite Off")), ["destination-alpha"], "a state alone");
    assert!(fired_by(&state("alpha-blending")).is_empty(), "a preset with factors for alpha");
    assert!(fired_by(&state("Blend SrcAlpha OneMinusSrcAlpha ZWrite Off ColorMask RGB")).is_empty(), "alpha masked");
    let no_alpha = StateQuestion { format: ColorFormat::from_name("rg8unorm").expect("a format"), ..state("fade") };
    assert!(fired_by(&no_alpha).is_empty(), "no alpha channel");
}

#[test]
fn double_multiply_fires_on_premultiplied_colors_under_a_straight_state() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]";
    let straight_state = "Blend SrcAlpha OneMinusSrcAlpha ZWrite Off";
    let shader = with_pass("mode = \"transparent\"\ntint = [0.9, 0.2, 0.1, 0.5]", straight_state);
    assert_eq!(fired(&scene(window, &[&shader])), ["double-multiply"], "the shader multiplied already");
    let texture = with_pass("mode = \"fade\"\ntexture = \"half premultiplied\"", straight_state);
    assert_eq!(fired(&scene(window, &[&texture])), ["double-multiply"], "the texture is multiplied already");
    let right = with_pass("mode = \"fade\"\ntexture = \"half premultiplied\"", "Blend One OneMinusSrcAlpha ZWrite Off");
    assert!(fired(&scene(window, &[&right])).is_empty(), "a premultiplied state");
    let question = |source| StateQuestion { source, ..state("alpha-blending") };
    assert_eq!(fired_by(&question(Some(SourceAlpha::Premultiplied))), ["double-multiply"], "a state alone");
    assert!(fired_by(&question(Some(SourceAlpha::Straight))).is_empty(), "a straight source");
}

#[test]
fn straight_source_fires_on_straight_colors_under_a_premultiplied_state() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]";
    let premultiplied_state = "Blend One OneMinusSrcAlpha ZWrite Off";
    let texture = with_pass("mode = \"fade\"\ntexture = \"half\"", premultiplied_state);
    assert_eq!(fired(&scene(window, &[&texture])), ["straight-source"], "nobody multiplies");
    let shader = "mode = \"transparent\"\ntexture = \"half\"";
    assert!(fired(&scene(window, &[shader])).is_empty(), "the shader multiplies");
    let question = |source| StateQuestion { source, ..state("transparent") };
    assert_eq!(fired_by(&question(Some(SourceAlpha::Straight))), ["straight-source"], "a state alone");
    assert!(fired_by(&question(Some(SourceAlpha::Premultiplied))).is_empty(), "a premultiplied source");
}

#[test]
fn depth_write_fires_where_a_hole_appears() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]\n";
    let writes = with_pass(FADE, "Blend SrcAlpha OneMinusSrcAlpha ZWrite On");
    let mut near_first = scene(window, &[FADE, &writes]);
    near_first.order = crate::scene::description::Order::Listed;
    near_first.objects.swap(0, 1);
    assert_eq!(fired(&near_first), ["depth-write"], "the far quad fails behind the near one");
    assert!(fired(&scene(window, &[FADE, &writes])).is_empty(), "far to near leaves no hole to show");
    assert_eq!(
        fired_by(&state("Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha")),
        ["depth-write"],
        "ZWrite is on"
    );
    assert!(fired_by(&state("Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha ZWrite Off")).is_empty(), "off");
    let open = StateQuestion { depth_known: false, ..state("SrcAlpha OneMinusSrcAlpha One OneMinusSrcAlpha") };
    assert!(fired_by(&open).is_empty(), "bare factors say nothing about depth");
}

#[test]
fn blended_first_fires_where_an_opaque_draw_covers_it() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]\n";
    let early = "mode = \"fade\"\ntint = [0.9, 0.2, 0.1, 0.5]";
    let mut listed = scene(window, &[OPAQUE, early]);
    listed.order = crate::scene::description::Order::Listed;
    assert!(fired(&listed).is_empty(), "opaque first");
    listed.objects.swap(0, 1);
    assert_eq!(fired(&listed), ["blended-first"], "the opaque quad behind overwrites the blended one");
    let mut apart = listed.clone();
    apart.objects[0].transform.translation.x = 5.0;
    assert!(fired(&apart).is_empty(), "where they do not overlap, the order does not show");
}

/// A quad whose depth prepass, with this test, hides the far quad, and whose color pass draws nothing: a hole.
fn hole(depth: &str) -> Scene {
    let material = format!(
        "mode = \"fade\"\ntexture = \"half\"\nqueue = \"Transparent\"\n[[material.pass]]\nname = \"depth\"\n\
         state = \"ZWrite On ColorMask 0 {depth}\"\n[[material.pass]]\nname = \"color\"\n\
         state = \"Blend SrcAlpha OneMinusSrcAlpha ZWrite Off AlphaTest Greater 0.75\""
    );
    let mut scene = scene("clear = [0.1, 0.1, 0.1, 1.0]", &[FADE, &material]);
    scene.order = crate::scene::description::Order::Listed;
    scene.objects.swap(0, 1);
    scene
}

#[test]
fn prepass_cutoff_fires_where_the_prepass_keeps_what_the_color_pass_drops() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]\n";
    let hole = |depth: &str| fired(&hole(depth));
    assert_eq!(hole(""), ["prepass-cutoff"], "no test in the prepass");
    assert_eq!(hole("AlphaTest Greater 0.25"), ["prepass-cutoff"], "a lower cutoff");
    assert!(hole("AlphaTest Greater 0.75").is_empty(), "the same test");
    // A pass that marks stencil is no depth prepass, though its test shows too.
    let stencil = "mode = \"fade\"\ntexture = \"half\"\n[[material.pass]]\nname = \"mark\"\n\
                   state = \"ZWrite Off ColorMask 0 AlphaTest Greater 0.75 Stencil { Ref 1 Pass Replace }\"\n\
                   [[material.pass]]\nname = \"color\"\n\
                   state = \"Blend SrcAlpha OneMinusSrcAlpha ZWrite Off AlphaTest Greater 0.25 Stencil { Ref 1 Comp Equal }\"";
    let with_stencil = format!("{window}depth = \"depth24plus-stencil8\"\n");
    assert!(!fired(&scene(&with_stencil, &[stencil])).contains(&"prepass-cutoff"), "stencil");
}

#[test]
fn blend_constant_fires_while_it_is_zero() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]\n";
    let constant = |value: &str| format!("{OPAQUE}\n[[material.pass]]\nstate = \"Blend Off\"{value}");
    assert!(fired(&scene(window, &[&constant("")])).is_empty(), "no factor reads it");
    // ShaderLab has no word for the constant factor, so the scene is changed after reading.
    let mut scene = scene(window, &[FADE]);
    let factor = wgpu_types::BlendFactor::Constant;
    let with_constant = |constant: [f32; 4]| {
        let mut passes = scene.materials[0].passes();
        passes[0].state.blend[0].as_mut().expect("fade blends").color.src_factor = factor;
        passes[0].blend_constant = constant;
        passes
    };
    let (unset, set) = (with_constant([0.0; 4]), with_constant([0.5; 4]));
    scene.materials[0].passes = Some(unset);
    assert_eq!(fired(&scene), ["blend-constant"], "zeros");
    scene.materials[0].passes = Some(set);
    assert!(fired(&scene).is_empty(), "a half");
    let factors = "GL_CONSTANT_COLOR GL_ONE_MINUS_SRC_ALPHA";
    assert_eq!(fired_by(&StateQuestion { depth_known: false, ..state(factors) }), ["blend-constant"], "a state alone");
    let set = StateQuestion { depth_known: false, constant: Some([0.5; 4]), ..state(factors) };
    assert!(fired_by(&set).is_empty(), "the constant is set");
}

#[test]
fn one_zero_fires_on_float_targets_alone() {
    let pass = with_pass(OPAQUE, "Blend One Zero");
    let target = |format: &str| format!("format = \"{format}\"\nclear = [0.1, 0.1, 0.1, 1.0]");
    assert!(fired(&scene(&target("rgba8unorm"), &[&pass])).is_empty(), "unorm holds no NaN");
    assert!(fired(&scene(&target("rgba16float"), &[OPAQUE])).is_empty(), "blending is off");
    let question = |name: &str| StateQuestion {
        format: ColorFormat::from_name(name).expect("a format"),
        block: StateBlock::with_blend(Some(BlendState::REPLACE)),
        ..state("opaque")
    };
    assert_eq!(fired_by(&question("rgba16float")), ["one-zero"], "a state alone");
    assert!(fired_by(&question("rgba8unorm")).is_empty(), "unorm");
    let mut float = scene(&target("rgba16float"), &[OPAQUE]);
    let mut passes = float.materials[0].passes();
    passes[0].state.blend[0] = Some(BlendState::REPLACE);
    float.materials[0].passes = Some(passes);
    assert_eq!(fired(&float), ["one-zero"], "in a scene");
    assert_eq!(
        fired_by(&StateQuestion { block: block("Blend One One, One Zero ZWrite Off"), ..question("rgba16float") }),
        ["one-zero"],
        "alpha alone"
    );
    assert_eq!(
        fired_by(&StateQuestion { block: block("Blend One Zero, One One ZWrite Off"), ..question("rgba16float") }),
        ["one-zero"],
        "color alone"
    );
}

#[test]
fn queue_fires_where_it_does_not_suit_the_state() {
    let window = "clear = [0.1, 0.1, 0.1, 1.0]\n";
    let early = format!("{FADE}\nqueue = \"Geometry\"");
    assert!(fired(&scene(window, &[OPAQUE, &early])).contains(&"queue"), "blended among the opaque ones");
    let late = format!("{OPAQUE}\nqueue = \"Transparent\"");
    assert_eq!(fired(&scene(window, &[&late])), ["queue"], "opaque among the transparent ones");
    let own = format!("{FADE}\nqueue = \"Transparent+10\"");
    assert!(fired(&scene(window, &[OPAQUE, &own])).is_empty(), "its own offset");
    let tagged = |queue: &str, blend: &str| fired_by(&state(&format!("Tags {{ \"Queue\" = \"{queue}\" }} {blend}")));
    let over = "Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha ZWrite Off";
    assert_eq!(tagged("Geometry", over), ["queue"], "a state alone, blended");
    assert_eq!(tagged("Transparent", ""), ["queue"], "a state alone, opaque");
    assert!(tagged("Transparent", over).is_empty() && tagged("AlphaTest", "").is_empty(), "as they should be");
    assert!(tagged("Transparent", "ColorMask 0").is_empty(), "nothing is written");
    assert_eq!(
        tagged("Geometry", "Blend One Zero, One OneMinusSrcAlpha ZWrite Off"),
        ["queue"],
        "alpha alone is blended"
    );
    assert_eq!(tagged("Geometry", "Blend One One, One Zero ZWrite Off"), ["queue"], "color alone is blended");
    // Queues order nothing where the objects are listed in order, or where replacement shading draws them.
    let mut listed = scene(window, &[&late]);
    listed.order = crate::scene::description::Order::Listed;
    assert!(fired(&listed).is_empty(), "drawn as listed");
    let replaced = "clear = [0.1, 0.1, 0.1, 1.0]\n[replacement]\nrender-type = \"Opaque\"\ncolor = [1.0, 1.0, 1.0]\n";
    assert!(fired(&scene(replaced, &[&late])).is_empty(), "replaced");
    // Passes over an opaque one: a glow that blends is a reason to be late, a further light is none.
    let glowing = format!(
        "{late}\n[[material.pass]]\nname = \"base\"\nstate = \"ZWrite On\"\n\
         [[material.pass]]\nname = \"glow\"\nstate = \"Blend One One, Zero One ZWrite Off ZTest Equal\""
    );
    assert!(fired(&scene(window, &[&glowing])).is_empty(), "a later pass blends");
    let lit = "clear = [0.1, 0.1, 0.1, 1.0]\n[[light]]\ndirection = [0.0, 0.0, -1.0]\n[[light]]\ndirection = [1.0, 0.0, -1.0]\n";
    assert_eq!(fired(&scene(lit, &[&late])), ["queue"], "a further light blends");
}

/// Bundled scenes show mistakes on purpose; all others are clean.
#[test]
fn bundled_scenes_are_clean_but_for_those_that_show_a_mistake() {
    let on_purpose: &[(&str, &[&str])] = &[
        ("overlap-zwrite-on", &["depth-write"]),
        ("order-transparent-first", &["depth-write", "blended-first"]),
        // The middle grid is drawn late to show what a custom queue does.
        ("queue-custom", &["blended-first", "queue"]),
        // Its middle tree is blended alone, in the queue of the others, to show what the two passes repair.
        ("vegetation-three-trees", &["depth-write", "blended-first", "queue"]),
        // Rows of grass are drawn one after the other, each with its soft edge before the next row's solid part.
        ("vegetation-grass", &["blended-first"]),
    ];
    for (name, scene) in Scene::bundled() {
        let expected = on_purpose.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, rules)| rules);
        assert_eq!(fired(&scene.expect("correct")), expected, "{name}");
    }
}

#[test]
fn every_rule_has_a_section_in_the_docs_with_its_sentence() {
    let page = include_str!("../../../docs/lint.md");
    for rule in RULES {
        let section = page.split("\n## ").find(|section| section.starts_with(&format!("`{}`", rule.name)));
        assert!(format!("{rule:?}").contains(rule.name), "a rule's name in its debug form: {rule:?}");
        let section = section.unwrap_or_else(|| panic!("docs/lint.md has no section `{}`", rule.name));
        assert!(section.contains(rule.about), "{}: the sentence `{}` opens its section", rule.name, rule.about);
    }
}
