//! Vectors recorded from the device pass the model of its driver.

use outmerge::crosscheck::vector;
use outmerge::format::depth::DEPTH_FORMATS;
use outmerge::format::{ColorFormat, DepthFormat, layout::FORMATS};
use outmerge::model::registry::{self, Drivers};
use outmerge::vectors::{self, Generator, Kind, Line};
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState};

use crate::harness::llvmpipe;

fn colors() -> Vec<ColorFormat> {
    FORMATS.iter().filter_map(|(name, _)| ColorFormat::from_name(name).ok()).collect()
}

/// Recorded lines of a kind as a file, and how many.
fn recorded(kind: Kind, lines: usize, texels: usize) -> Option<(String, usize)> {
    let depths: Vec<DepthFormat> = DEPTH_FORMATS.iter().filter_map(|(name, _)| DepthFormat::from_name(name)).collect();
    record(vectors::generate_kind(kind, 20_261_123, &colors(), &depths, lines, texels))
}

/// What the device makes of these lines, as a file, and how many it can draw.
fn record(lines: Vec<Line>) -> Option<(String, usize)> {
    let device = llvmpipe()?;
    let (mut text, mut recorded) = (String::new(), 0);
    for mut line in lines {
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
    let drivers = llvmpipe().map_or_else(Drivers::default, |device| device.report().drivers());
    let model = registry::by_name_among(model, drivers).expect("a model");
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

/// A blend constant is prepared apart from the fragments, by rules of its own: a NaN is 1 on sRGB targets, 0 on unorm.
#[test]
fn special_blend_constants_of_every_format_pass_the_drivers_model() {
    let mut generator = Generator::new(7);
    let special = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-40, -2.0, 2.0, 0.25];
    let factors = [(F::Constant, F::Zero), (F::OneMinusConstant, F::SrcAlpha), (F::OneMinusSrc, F::Constant)];
    let mut lines = Vec::new();
    for format in colors() {
        for (turn, operation) in [(0, Op::Add), (2, Op::Subtract), (4, Op::ReverseSubtract), (5, Op::Add)] {
            for (src_factor, dst_factor) in factors {
                let component = BlendComponent { src_factor, dst_factor, operation };
                let mut line = generator.line(format, 64);
                line.blend = Some(BlendState { color: component, alpha: component });
                line.src1 = None;
                line.constant = std::array::from_fn(|i| special[(turn + 3 * i) % special.len()]);
                lines.push(Line::Color(line));
            }
        }
    }
    let Some((text, lines)) = record(lines) else { return };
    assert!(lines > 150, "most formats blend: {lines} lines");
    assert_eq!(differ("llvmpipe", &text, lines), 0, "the driver's model");
}
