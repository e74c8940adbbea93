//! ShaderLab: an error with a place or passes that a merger takes; white space before and a comment after change nothing.

use outmerge::model::registry;
use outmerge::plan::Planned;
use outmerge::state::shaderlab::{Properties, PropertyValue, ShaderLabError, parse};
use outmerge::state::text;
use outmerge::{Extent, Fragment, Framebuffer};
use wgpu_types::TextureFormat;

pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // A byte order mark is one only at the start, and this text is moved.
    let text = text.trim_start_matches('\u{feff}');
    let properties: Properties =
        [("_Mode".to_owned(), PropertyValue::Number(5.0)), ("_Name".to_owned(), PropertyValue::Name("One".to_owned()))]
            .into();
    let read = parse(text, &properties);
    let moved = parse(&format!("\n \n{text}"), &properties);
    match &read {
        Ok(passes) => {
            assert_eq!(moved.as_ref(), Ok(passes), "white space before changes nothing");
            assert_eq!(parse(&format!("{text}\n// end"), &properties).as_ref(), Ok(passes), "nor does a comment after");
            assert!(!passes.is_empty(), "at least one pass");
            for pass in passes {
                merges(&pass.state);
            }
        }
        Err(ShaderLabError { position, message }) => {
            let lines = u32::try_from(text.split('\n').count()).expect("fewer lines than bytes");
            assert!(
                (1..=lines).contains(&position.line) && position.column >= 1,
                "{position:?} of {lines} lines: {message}"
            );
            let moved = moved.expect_err("white space before repairs nothing");
            assert_eq!((moved.position.line, &moved.message), (position.line + 2, message), "the error moves along");
        }
    }
    // The general reader must not panic either.
    let _ = text::parse(text, &properties);
}

/// The state drives a merger on ordinary targets.
fn merges(block: &outmerge::state::StateBlock) {
    let state = block.to_merger_state(&[TextureFormat::Rgba8Unorm], Some(TextureFormat::Depth24PlusStencil8));
    let model = registry::by_name("f32").expect("a model");
    let mut framebuffer =
        Framebuffer::for_state(Extent::new(1, 1).expect("one texel"), &state).expect("ordinary formats");
    let merger = Planned::new(&state, model.as_ref(), &framebuffer).expect("binary32 takes every state");
    merger.merge(&Fragment::new([0.25, 0.5, 0.75, 0.5]).at_depth(0.5), 0, 0, &mut framebuffer);
}
