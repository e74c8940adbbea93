use wgpu_types::{ColorTargetState, TextureFormat};

use super::*;
use crate::fragment::Fragment;
use crate::model::exact::Exact;
use crate::model::registry;
use crate::scene::Scene;
use crate::state::{MergerState, preset};
use crate::target::{Extent, Framebuffer};

fn fade() -> MergerState {
    let blend = preset::by_name("fade").expect("a preset").blend;
    MergerState::single(ColorTargetState { blend, ..TextureFormat::Rgba8Unorm.into() })
}

/// Black at half coverage over grey 0x7f: 64 in `exact`, 63 in `fixed:8`.
fn half_black() -> Prediction {
    let state = fade();
    let mut before = Framebuffer::for_state(Extent::new(3, 2).expect("small"), &state).expect("small");
    before.colors[0].as_mut().expect("there").bytes_mut().fill(0x7f);
    let shade = Draw::covering("shade", state, before.extent, Fragment::new([0.0, 0.0, 0.0, 0.5]));
    Prediction::of_draws(&before, vec![shade], &Exact::default()).expect("covered")
}

fn image(texels: &[[u8; 4]]) -> Actual {
    let bytes: Vec<u8> = texels.iter().flatten().copied().collect();
    Actual::new(TextureFormat::Rgba8Unorm, 3, 2, &bytes).expect("3 x 2 texels")
}

const RIGHT: [u8; 4] = [64, 64, 64, 127];
const FIXED: [u8; 4] = [63, 63, 63, 127];

#[test]
fn the_prediction_itself_conforms() {
    let expected = half_black();
    assert_eq!(expected.target().bytes(), [RIGHT; 6].as_flattened(), "black over grey: {expected:?}");
    assert_conforms!(image(&[RIGHT; 6]), expected);
}

#[test]
fn a_wrong_pixel_is_reported_with_history_bytes_and_the_model_that_explains_it() {
    let mut texels = [RIGHT; 6];
    texels[4] = FIXED;
    let error = conforms(&image(&texels), &half_black()).expect_err("one pixel differs");
    let Nonconformance::Pixels(mismatch) = error else { panic!("pixels differ, not the shape") };
    assert_eq!((mismatch.pixel, mismatch.differing), ((1, 1), (1, 6)), "where");
    assert_eq!(mismatch.expected, [(RIGHT.to_vec(), vec!["exact".to_owned()])], "what it should be");
    assert_eq!(mismatch.got, FIXED, "what it is");
    assert_eq!(mismatch.history.len(), 1, "one fragment: {:?}", mismatch.history);
    assert_eq!(mismatch.history[0].after, RIGHT, "the model's result");
    let explains = |name: &str| mismatch.models.iter().any(|found| found.model == name && found.explains_pixel);
    assert!(explains("fixed:8"), "an 8-bit blender writes 63: {:?}", mismatch.models);
    assert!(!explains("exact"), "the prediction does not: {:?}", mismatch.models);
    let text = mismatch.to_string();
    for part in
        ["pixel (1, 1)", "4040407f (codes", "3f3f3f7f", "draw 0 (shade): Merged", "fixed:8", "outmerge explain --state"]
    {
        assert!(text.contains(part), "`{part}` in:\n{text}");
    }
}

#[test]
fn further_models_widen_what_is_accepted_pixel_by_pixel() {
    let mixed = image(&[RIGHT, FIXED, RIGHT, FIXED, FIXED, RIGHT]);
    assert!(conforms(&mixed, &half_black()).is_err(), "one model alone");
    let fixed = registry::by_name("fixed:8").expect("a model");
    let both = half_black().or(fixed.as_ref()).expect("covered");
    assert_conforms!(mixed, both);
    let any = half_black().or_any_model().expect("covered");
    assert_conforms!(mixed, any);
    let error = conforms(&image(&[[62, 62, 62, 127]; 6]), &any).expect_err("no model writes 62").to_string();
    assert!(error.contains("no numeric model writes these bytes"), "{error}");
    assert!(error.contains("by exact") && error.contains("fixed:8"), "both sets are listed: {error}");
}

#[test]
fn a_failure_leaves_three_pictures() {
    let folder = std::env::temp_dir().join(format!("outmerge-testkit-{}", std::process::id()));
    let mut texels = [RIGHT; 6];
    texels[0] = [255, 64, 64, 127];
    let files = pictures::write(&image(&texels), &half_black(), &folder, "a::b c").expect("writable");
    let names: Vec<_> =
        files.iter().map(|file| file.file_name().expect("a file").to_string_lossy().into_owned()).collect();
    assert_eq!(names, ["a--b-c.actual.png", "a--b-c.expected.png", "a--b-c.diff.png"], "names");
    let diff = image::open(&files[2]).expect("a PNG file").into_rgba8();
    assert_eq!(diff.get_pixel(0, 0).0, [255, 255, 0, 255], "far off is yellow");
    assert_eq!(diff.get_pixel(1, 0).0, [21, 21, 21, 255], "equal is a third of its grey");
    let actual = image::open(&files[0]).expect("a PNG file").into_rgba8();
    assert_eq!(actual.get_pixel(0, 0).0, [255, 64, 64, 127], "the image with its alpha");
    std::fs::remove_dir_all(folder).expect("our own folder");
}

#[test]
#[should_panic(expected = "`named` does not conform: 6 of 6 samples differ")]
fn the_macro_panics_with_the_name() {
    assert_conforms!(image(&[FIXED; 6]), half_black(), "named");
}

#[test]
fn row_padding_is_skipped() {
    let mut padded = Vec::new();
    for _ in 0..2 {
        padded.extend([RIGHT; 3].as_flattened());
        padded.extend([0xee; 244]);
    }
    let format = TextureFormat::Rgba8Unorm;
    let whole = Actual::with_pitch(format, 3, 2, &padded, 256).expect("padded rows");
    let short = Actual::with_pitch(format, 3, 2, &padded[..268], 256).expect("the last row may lack its padding");
    assert_eq!(whole, short, "padding does not count");
    assert_conforms!(whole, half_black());
}

#[test]
fn what_is_no_image_is_an_error() {
    let format = TextureFormat::Rgba8Unorm;
    assert_eq!(
        Actual::new(format, 2, 2, &[0; 15]),
        Err(ActualError::Length { got: 15, expected: 16 }),
        "too few bytes"
    );
    assert_eq!(
        Actual::with_pitch(format, 2, 2, &[0; 64], 4),
        Err(ActualError::Pitch { pitch: 4, row: 8 }),
        "overlapping rows"
    );
    assert!(matches!(Actual::new(format, 0, 2, &[]), Err(ActualError::Extent(_))), "no texels");
    assert!(matches!(Actual::new(TextureFormat::Rgba8Uint, 1, 1, &[0; 4]), Err(ActualError::Format(_))), "integers");
    let other = Actual::new(TextureFormat::R8Unorm, 3, 2, &[0; 6]).expect("an image");
    let error = conforms(&other, &half_black()).expect_err("another format").to_string();
    assert!(error.contains("r8unorm 3 x 2") && error.contains("rgba8unorm 3 x 2"), "{error}");
}

#[test]
fn any_nan_equals_any_nan() {
    let state = MergerState::single(TextureFormat::R16Float.into());
    let before = Framebuffer::for_state(Extent::new(1, 1).expect("small"), &state).expect("small");
    let nan = Draw::covering("nan", state, before.extent, Fragment::new([f32::NAN; 4]));
    let expected = Prediction::of_draws(&before, vec![nan], &Exact::default()).expect("covered");
    for bytes in [[0x01, 0x7e], [0xff, 0xff], [0x01, 0x7c]] {
        assert_conforms!(Actual::new(TextureFormat::R16Float, 1, 1, &bytes).expect("a texel"), expected);
    }
    let infinity = Actual::new(TextureFormat::R16Float, 1, 1, &[0x00, 0x7c]).expect("a texel");
    assert!(conforms(&infinity, &expected).is_err(), "infinity is no NaN");
}

#[test]
fn draws_that_cannot_be_predicted_are_errors() {
    let state = fade();
    let before = Framebuffer::for_state(Extent::new(1, 1).expect("small"), &state).expect("small");
    let wide = Extent::new(2, 1).expect("small");
    let outside = Draw::covering("wide", state.clone(), wide, Fragment::default());
    let error = Prediction::of_draws(&before, vec![outside], &Exact::default()).expect_err("outside");
    assert!(error.to_string().contains("(1, 0), outside the 1 x 1 target"), "{error}");
    let mut other = state;
    other.targets[0].as_mut().expect("there").format = TextureFormat::R8Unorm;
    let misfit = Draw::covering("misfit", other, before.extent, Fragment::default());
    let error = Prediction::of_draws(&before, vec![misfit], &Exact::default()).expect_err("another format");
    assert!(error.to_string().starts_with("draw 0 (misfit)"), "{error}");
    let none = Prediction::of_draws(&before, Vec::new(), &Exact::default()).expect("nothing drawn").of_target(1);
    assert!(matches!(none, Err(PredictionError::Target(1))), "no second target");
}

#[test]
fn bundled_scenes_are_predicted_as_they_are_rendered_with_history() {
    for name in ["fade-over-opaque", "stencil-cutout", "self-overlap"] {
        let scene = Scene::bundled_by_name(name).expect("bundled").expect("correct");
        let model = registry::by_name("f32").expect("a model");
        let rendered = scene.render(model.as_ref()).expect("renders").framebuffer;
        let expected = Prediction::of_scene(&scene, model.as_ref()).expect("renders");
        let mut target = rendered.colors[0].clone().expect("a target");
        assert_conforms!(Actual::from(target.clone()), expected, name);
        let middle = target.extent().index(target.extent().width / 2, target.extent().height / 2, 0) * 4;
        target.bytes_mut()[middle] ^= 0x80;
        let error = conforms(&Actual::from(target), &expected).expect_err("one bit differs").to_string();
        assert!(error.starts_with("1 of ") && error.contains("draw 0"), "{name}: {error}");
    }
}
