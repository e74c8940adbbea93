//! Scene files: an error with a place or a scene; small scenes render, and their plan cannot be seen in the bytes.

use std::path::Path;

use outmerge::model::registry;
use outmerge::scene::file::Syntax;
use outmerge::scene::{Scene, SceneFileError};

/// Scenes with more texels or triangles are read and not rendered.
const MAX_TEXELS: usize = 1024;
const MAX_TRIANGLES: usize = 200;

pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // Files beside the scene are no part of the fuzzer's input.
    if text.contains("file") {
        return;
    }
    let (syntax, name) =
        if text.trim_start().starts_with('{') { (Syntax::Json, "fuzz.json") } else { (Syntax::Toml, "fuzz.toml") };
    match Scene::parse(text, syntax, Path::new(name)) {
        Ok(scene) => render(&scene),
        Err(SceneFileError::Field { line, message, .. }) => {
            assert!(
                (1..=text.lines().count() + 1).contains(&line),
                "line {line} of {} for: {message}",
                text.lines().count()
            );
            assert!(!message.is_empty(), "an error says what is wrong");
        }
        Err(error) => assert!(!error.to_string().is_empty(), "an error says what is wrong"),
    }
}

fn render(scene: &Scene) {
    if scene.target.extent.sample_total() > MAX_TEXELS {
        return;
    }
    // An object is drawn once a pass and light at most.
    let corners = |object: &outmerge::scene::description::Object| scene.meshes[object.mesh].vertices.len();
    let times = 16 * scene.lighting.lights.len().max(1);
    if scene.objects.iter().map(corners).sum::<usize>() * times > 16 * MAX_TRIANGLES {
        return;
    }
    let model = registry::by_name("f32").expect("a model");
    let plan = scene.plan(model.as_ref()).expect("binary32 covers every state");
    assert!(plan.same_bytes, "an omission shows in {:?}", plan.draws);
    let rendered = scene.render(model.as_ref()).expect("binary32 covers every state");
    assert_eq!(rendered.draws.len(), plan.draws.len(), "the plan has every draw");
}
