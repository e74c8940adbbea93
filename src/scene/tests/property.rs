//! Laws that hold for any scene of a kind.

use std::collections::BTreeMap;
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::scene::description::Order;
use crate::scene::file::Syntax;

/// The head of a small scene in this mode; materials m0, m1, ... take the tints.
pub(super) fn head(mode: &str, passes: &str, tints: &[[f32; 4]]) -> String {
    let mut text =
        "version = 1\ntitle = \"t\"\n[target]\nwidth = 24\nheight = 24\nclear = [0.2, 0.3, 0.4, 1.0]\n".to_owned();
    for (i, tint) in tints.iter().enumerate() {
        text += &format!("[[material]]\nname = \"m{i}\"\nmode = \"{mode}\"\ntint = {tint:?}\n{passes}");
    }
    text
}

pub(super) fn object(
    text: &mut String,
    mesh: &str,
    material: usize,
    position: [f64; 3],
    rotation: [f64; 3],
    scale: f64,
) {
    *text += &format!(
        "[[object]]\nname = \"o{material}\"\nmesh = \"{mesh}\"\nmaterial = \"m{material}\"\nposition = {position:?}\nrotation = {rotation:?}\nscale = [{scale:?}, {scale:?}, {scale:?}]\n"
    );
}

pub(super) fn parse(text: &str) -> Scene {
    Scene::parse(text, Syntax::Toml, Path::new("generated.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

pub(super) fn tint(alpha: impl Strategy<Value = f32>) -> impl Strategy<Value = [f32; 4]> {
    (prop::array::uniform3(0.0_f32..1.0), alpha).prop_map(|([r, g, b], a)| [r, g, b, a])
}

pub(super) fn place() -> impl Strategy<Value = ([f64; 3], [f64; 3], f64)> {
    let position = prop::array::uniform3(-0.4_f64..0.4);
    (position, prop::array::uniform3(-80.0_f64..80.0), 0.5_f64..1.5)
}

/// Depths and draws of every covered texel, in drawing order.
fn stacks(scene: &Scene) -> BTreeMap<(u32, u32), Vec<f32>> {
    let mut stacks = BTreeMap::<_, Vec<f32>>::new();
    for draw in scene.draws() {
        scene.shade(&draw, None, |fragments| {
            for pixel in fragments {
                stacks.entry((pixel.x, pixel.y)).or_default().push(pixel.fragment.depth);
            }
        });
    }
    stacks
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Each texel keeps its nearest fragment, whoever comes first; equal depths aside.
    #[test]
    fn the_order_of_opaque_draws_does_not_matter(
        tints in prop::collection::vec(tint(Just(1.0)), 3),
        places in prop::collection::vec(place(), 3),
        swap in 0_usize..3,
    ) {
        let mut text = head("opaque", "", &tints);
        for (i, (position, rotation, scale)) in places.iter().enumerate() {
            object(&mut text, "cube", i, *position, *rotation, *scale);
        }
        let mut scene = parse(&text);
        scene.order = Order::Listed;
        let before = exact(&scene).framebuffer;
        scene.objects.swap(swap, (swap + 1) % 3);
        let after = exact(&scene).framebuffer;
        prop_assert_eq!(&before.depth_stencil, &after.depth_stencil);
        // Two opaque surfaces at one depth code are a tie the order decides, as on any GPU.
        let ties = stacks(&scene).values().filter(|depths| {
            let mut codes: Vec<_> = depths.iter().map(|z| (f64::from(*z) * 16_777_215.0).round()).collect();
            codes.sort_by(f64::total_cmp);
            codes.windows(2).any(|pair| pair[0] == pair[1])
        }).count();
        if ties == 0 {
            prop_assert_eq!(before, after);
        }
    }

    #[test]
    fn fade_at_alpha_zero_equals_not_drawing(color in tint(Just(0.0)), (position, rotation, scale) in place()) {
        let mut text = head("fade", "", &[color]);
        object(&mut text, "cube", 0, position, rotation, scale);
        let scene = parse(&text);
        prop_assert_eq!(exact(&scene).framebuffer, scene.cleared().expect("fits"));
    }

    #[test]
    fn cutout_below_its_cutoff_leaves_color_depth_and_stencil_untouched(
        color in tint(0.0_f32..0.5), (position, rotation, scale) in place()
    ) {
        let text = head("cutout", "", &[color]).replace("height = 24", "height = 24\ndepth = \"depth24plus-stencil8\"");
        let passes = "[[material.pass]]\nstate = 'Stencil { Ref 7 Comp Always Pass Replace Fail Invert ZFail IncrWrap }'\n";
        let mut text = text + passes;
        object(&mut text, "cube", 0, position, rotation, scale);
        let scene = parse(&text);
        prop_assert_eq!(exact(&scene).framebuffer, scene.cleared().expect("fits"));
    }

    /// What a partition of space promises: at every texel, parts come from far to near.
    #[test]
    fn split_faces_are_drawn_back_to_front_everywhere(
        tints in prop::collection::vec(tint(0.1_f32..0.9), 4), places in prop::collection::vec(place(), 4)
    ) {
        let passes = "[[material.pass]]\nstate = 'Blend SrcAlpha OneMinusSrcAlpha ZWrite Off Cull Off'\n";
        let mut text = head("fade", passes, &tints);
        for (i, (position, rotation, scale)) in places.iter().enumerate() {
            object(&mut text, "quad", i, *position, *rotation, *scale);
        }
        let mut scene = parse(&text);
        let whole = stacks(&scene);
        scene.order = Order::Split;
        let split = stacks(&scene);
        let mut odd = 0;
        for (texel, depths) in &split {
            // Nearness below the resolution of positions and depth is a tie: a slanted face gains depth over 1/256 pixel,
            // and the more so the nearer it is: depth falls with the inverse distance, its slope with the square.
            let tie = |z: f32| 1e-5 + 1e-4 * (1.0 - z) * (1.0 - z);
            let ordered = depths.windows(2).all(|pair| pair[1] <= pair[0] + tie(pair[0]));
            prop_assert!(ordered, "texel {:?}: depths {:?} are not far to near", texel, depths);
            odd += usize::from(whole.get(texel).map_or(0, Vec::len) != depths.len());
        }
        // Where a cut ends, snapping to the sub-pixel grid may gain or lose a texel; six pairs of faces have twelve ends.
        prop_assert!(odd <= 12, "{} texels are covered more or less often than by whole faces", odd);
    }

    /// Inner faces, then outer faces: for a convex mesh that is the order from far to near.
    #[test]
    fn two_culled_passes_draw_a_convex_mesh_back_to_front(
        color in tint(0.1_f32..0.9), (position, rotation, scale) in place(), mesh in prop_oneof![Just("cube"), Just("sphere")]
    ) {
        let passes = "[[material.pass]]\nstate = 'Cull Front ZWrite Off'\n[[material.pass]]\nstate = 'Cull Back ZWrite Off'\n";
        let mut text = head("fade", passes, &[color]);
        object(&mut text, mesh, 0, position, rotation, scale);
        let mut folded = 0;
        for (texel, depths) in stacks(&parse(&text)) {
            // A ray meets a convex mesh at most twice. Snapping to the sub-pixel grid may fold a corner of the silhouette:
            // the texel has more fragments there, of faces seen edge on, whose depth is nearly arbitrary.
            if depths.len() > 2 {
                folded += 1;
                continue;
            }
            prop_assert!(depths.windows(2).all(|pair| pair[1] <= pair[0] + 1e-5), "texel {:?}: {:?}", texel, depths);
        }
        prop_assert!(folded <= 2, "{} texels are covered more than twice", folded);
    }

    /// Cut, doubled and overwritten texts are read or refused, with a line that exists.
    #[test]
    fn damaged_scene_files_are_errors_with_a_line(
        which in 0_usize..1000, start in 0_usize..2000, length in 0_usize..40, insert in "[ -~\n]{0,12}"
    ) {
        let (name, text) = bundled::SCENES[which % bundled::SCENES.len()];
        let mut bytes = text.as_bytes().to_vec();
        let start = start.min(bytes.len());
        let end = (start + length).min(bytes.len());
        bytes.splice(start..end, insert.bytes());
        let Ok(damaged) = String::from_utf8(bytes) else { return Ok(()) };
        if let Err(error) = Scene::parse(&damaged, Syntax::Toml, Path::new(name)) {
            let message = error.to_string();
            let line = message.split(':').nth(1).and_then(|line| line.parse::<usize>().ok());
            let lines = damaged.lines().count() + 1;
            prop_assert!(line.is_some_and(|line| (1..=lines).contains(&line)), "{}", message);
        }
    }
}
