//! Vectors recorded from the device pass the model of its driver.

use outmerge::crosscheck::vector;
use outmerge::format::depth::DEPTH_FORMATS;
use outmerge::format::{ColorFormat, DepthFormat, layout::FORMATS};
use outmerge::model::registry;
use outmerge::vectors::{self, Kind};

use crate::harness::llvmpipe;

/// Recorded lines of a kind as a file, and how many.
fn recorded(kind: Kind, lines: usize, texels: usize) -> Option<(String, usize)> {
    let device = llvmpipe()?;
    let colors: Vec<ColorFormat> = FORMATS.iter().filter_map(|(name, _)| ColorFormat::from_name(name).ok()).collect();
    let depths: Vec<DepthFormat> = DEPTH_FORMATS.iter().filter_map(|(name, _)| DepthFormat::from_name(name)).collect();
    let (mut text, mut recorded) = (String::new(), 0);
    for mut line in vectors::generate_kind(kind, 20_261_123, &colors, &depths, lines, texels) {
        if let Some(reason) = vector::refusal(device, &line) {
            println!("not run: {}: {reason}", line.group());
            continue;
        }
        vector::record(device, &mut line).expect("drawn");
        text.push_str(&line.to_json());
        text.push('\n');
        recorded += 1;
    }
    Some((text, recorded))
}

/// How many texels of a file differ from a model.
fn differ(model: &str, text: &str, lines: usize) -> usize {
    let model = registry::by_name(model).expect("a model");
    let print = |mismatch: &vectors::Mismatch| println!("{mismatch:?}");
    let report = vectors::check(model.as_ref(), text.as_bytes(), print).expect("valid");
    assert_eq!(report.total.lines, lines, "every line is compared");
    report.total.failed_texels
}

#[test]
fn recorded_vectors_of_every_format_pass_the_drivers_model() {
    let Some((text, lines)) = recorded(Kind::Color, 12, 300) else { return };
    assert!(lines > 200, "most formats are rendered: {lines} lines");
    assert_eq!(differ("llvmpipe", &text, lines), 0, "the driver's model");
    assert!(differ("exact", &text, lines) > 0, "the driver is not exact, so the check can fail");
}

#[test]
fn recorded_depth_vectors_of_every_format_pass_the_drivers_model() {
    let Some((text, lines)) = recorded(Kind::Depth, 24, 300) else { return };
    assert_eq!(lines, 24 * DEPTH_FORMATS.len(), "every depth format is rendered");
    assert_eq!(differ("llvmpipe", &text, lines), 0, "the driver's model");
    assert!(differ("exact", &text, lines) > 0, "NaN is the nearest depth by the rules, the farthest here");
}

#[test]
fn recorded_layers_of_every_format_pass_the_drivers_model() {
    let Some((text, lines)) = recorded(Kind::Layers, 6, 100) else { return };
    assert!(lines > 100, "most formats are rendered: {lines} lines");
    assert_eq!(differ("llvmpipe", &text, lines), 0, "the driver's model");
    assert!(differ("exact", &text, lines) > 0, "the driver is not exact");
}
