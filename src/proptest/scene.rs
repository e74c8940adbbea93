//! Whole small scenes: a few quads and cubes in any rendering mode on an 8 x 8 target (feature `scene`).
//!
//! Shrinks to one opaque quad in the middle, unrotated, in front of an orthographic camera.

use ::proptest::collection::vec;
use ::proptest::option;
use ::proptest::prelude::*;
use ::proptest::sample::select;
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use wgpu_types::TextureFormat;

use super::{number, state};
use crate::format::ColorFormat;
use crate::scene::Scene;
use crate::scene::camera::{Camera, Projection};
use crate::scene::description::{ColorSpec, DepthSpec, Display, Object, Order, Output, TargetSpec};
use crate::scene::material::{Light, Lighting, Material, Pass, RenderingMode, Shading};
use crate::scene::mesh::Mesh;
use crate::scene::raster::Rasteriser;
use crate::target::Extent;

/// Width and height of the target in texels.
pub const SIDE: u32 = 8;

/// Objects of a scene, at most.
pub const MAX_OBJECTS: usize = 4;

/// Any of the four rendering modes; shrinks to opaque.
pub fn mode() -> impl Strategy<Value = RenderingMode> + Clone {
    use RenderingMode::{Cutout, Fade, Opaque, Transparent};
    select(vec![Opaque, Cutout, Fade, Transparent])
}

/// A material without texture: mode, tint, unlit or lit, the mode's passes or one with any blend state.
pub fn material() -> impl Strategy<Value = Material> {
    let pass = option::weighted(0.2, (state::blend(), state::write_mask(), any::<bool>()));
    let shading = option::weighted(0.3, (0.0_f32..=1.0, 0.0_f32..=1.0));
    (mode(), number::unit_color(), shading, pass).prop_map(|(mode, tint, shading, pass)| {
        let shading = shading.map_or(Shading::Unlit, |(metallic, smoothness)| Shading::Lit { metallic, smoothness });
        let passes = pass.map(|(blend, mask, depth_write)| {
            let mut pass = Pass::base(mode);
            pass.state.blend[0] = blend;
            pass.state.write_mask[0] = mask;
            pass.state.depth_write = depth_write;
            vec![pass]
        });
        Material { tint, shading, passes, ..Material::new("material", mode) }
    })
}

/// A place for an object: position, turn about each axis, scale.
fn transform() -> impl Strategy<Value = DAffine3> + Clone {
    // Half of the objects face the camera squarely, where edges and depths coincide.
    let turn = prop_oneof![Just([0.0; 3]), ::proptest::array::uniform3(-3.0_f64..3.0)];
    let position = ::proptest::array::uniform3(prop_oneof![Just(0.0), Just(0.25), -0.8_f64..0.8]);
    (position, turn, prop_oneof![Just(1.0), 0.2_f64..2.0]).prop_map(|(position, [x, y, z], scale)| {
        let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
        DAffine3::from_scale_rotation_translation(DVec3::splat(scale), rotation, DVec3::from(position))
    })
}

fn target() -> impl Strategy<Value = TargetSpec> {
    let formats = ["rgba8unorm", "rgba8unorm-srgb", "rgb10a2unorm", "rgba16float"];
    let depths = [TextureFormat::Depth24Plus, TextureFormat::Depth16Unorm, TextureFormat::Depth32Float];
    let clear = number::unit_color();
    (select(formats.to_vec()), clear, option::weighted(0.8, select(depths.to_vec()))).prop_map(
        |(format, clear, depth)| TargetSpec {
            extent: Extent::new(SIDE, SIDE).expect("a small target"),
            colors: vec![ColorSpec {
                format: ColorFormat::from_name(format).expect("a format of the list"),
                clear,
                output: Output::Color,
            }],
            depth: depth.map(|format| DepthSpec { format, clear: 1.0, clear_stencil: 0 }),
            display: Display::Stored,
            subpixel_bits: 8,
            rasteriser: Rasteriser::Reference,
        },
    )
}

/// A camera in front of the origin, looking at it.
fn camera() -> impl Strategy<Value = Camera> + Clone {
    prop_oneof![
        Just(Projection::Orthographic { height: 2.0 }),
        (20.0_f64..90.0).prop_map(|fov_y| Projection::Perspective { fov_y }),
    ]
    .prop_map(|projection| Camera {
        eye: DVec3::new(0.0, 0.0, 4.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
        projection,
        near: 0.1,
        far: 100.0,
        reversed: false,
    })
}

/// A scene of one to [`MAX_OBJECTS`] objects, each with a material of its own; shrinks to the fewest.
///
/// # Panics
/// Never: the target is small and its formats are color formats.
pub fn scene() -> BoxedStrategy<Scene> {
    let objects = vec((0..2_usize, material(), transform()), 1..=MAX_OBJECTS);
    let order = select(vec![Order::Listed, Order::Queue, Order::Split]);
    (target(), camera(), objects, order)
        .prop_map(|(target, camera, objects, order)| {
            let mut scene = Scene {
                title: "generated".to_owned(),
                explanation: String::new(),
                technique: String::new(),
                target,
                camera,
                lighting: Lighting {
                    ambient: Vec3::splat(0.25),
                    lights: vec![Light::Directional { toward: Vec3::Z, color: Vec3::ONE }],
                },
                textures: Vec::new(),
                meshes: vec![Mesh::quad(), Mesh::cube()],
                materials: Vec::new(),
                objects: Vec::new(),
                order,
                reference: None,
                replacement: None,
            };
            for (index, (mesh, material, transform)) in objects.into_iter().enumerate() {
                scene.materials.push(Material { name: format!("material {index}"), ..material });
                scene.objects.push(Object { name: format!("object {index}"), mesh, material: index, transform });
            }
            scene
        })
        .boxed()
}

#[cfg(test)]
mod tests {
    use ::proptest::strategy::ValueTree;
    use ::proptest::test_runner::TestRunner;

    use super::*;
    use crate::model::binary32::Binary32;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn generated_scenes_render_and_their_plan_cannot_be_seen(scene in scene()) {
            let rendered = scene.render(&Binary32).expect("binary32 covers every state");
            prop_assert!(rendered.draws.len() >= scene.objects.len(), "every object is drawn");
            let plan = scene.plan(&Binary32).expect("binary32 covers every state");
            prop_assert!(plan.same_bytes, "an omission shows");
        }
    }

    #[test]
    fn scenes_shrink_to_one_plain_quad() {
        let mut runner = TestRunner::deterministic();
        let mut tree = scene().new_tree(&mut runner).expect("a scene");
        // Whatever fails, fails for every scene: shrinking goes all the way.
        while tree.simplify() {}
        let scene = tree.current();
        assert_eq!(scene.objects.len(), 1, "one object");
        assert_eq!((scene.objects[0].mesh, scene.materials[0].mode), (0, RenderingMode::Opaque), "an opaque quad");
        assert_eq!(scene.objects[0].transform, DAffine3::IDENTITY, "in the middle");
        assert_eq!(scene.camera.projection, Projection::Orthographic { height: 2.0 }, "orthographic");
    }

    #[test]
    fn scenes_draw_something_more_often_than_not() {
        let mut runner = TestRunner::deterministic();
        let drawn = (0..64)
            .filter(|_| {
                let scene = scene().new_tree(&mut runner).expect("a scene").current();
                scene.render(&Binary32).expect("renders").fragments > 0
            })
            .count();
        assert!(drawn > 48, "{drawn} of 64 scenes make fragments");
    }
}
