//! A stack of 400 faint splats, premultiplied, in targets of 8 bits, half and single precision. Where a splat adds less
//! than half a code, 8 bits store nothing of it.
//!
//!     cargo run --example splats

use outmerge::format::ColorFormat;
use outmerge::model::exact::Exact;
use outmerge::model::{ColorInputs, NumericModel};
use outmerge::state::preset;

const SPLATS: u32 = 400;
const ALPHA: f32 = 0.004;
/// Red of a splat, before it is multiplied by alpha.
const RED: f32 = 0.4;

/// Red of the stack on a scale of 255.
fn stack(name: &str) -> Result<f64, Box<dyn std::error::Error>> {
    let format = ColorFormat::from_name(name)?;
    let model = Exact::default();
    let mut inputs = ColorInputs {
        format,
        blend: preset::by_name("premultiplied").ok_or("a preset")?.blend,
        constant: [0.0; 4],
        src: [RED * ALPHA, 0.0, 0.0, ALPHA],
        src1: [0.0; 4],
        dst: [0; 4],
    };
    for _ in 0..SPLATS {
        inputs.dst = model.merge_color(&inputs);
    }
    let red = inputs.dst[0];
    Ok(match name {
        "rgba8unorm" => f64::from(red),
        "rgba16float" => f64::from(half::f16::from_bits(u16::try_from(red)?).to_f32()) * 255.0,
        _ => f64::from(f32::from_bits(red)) * 255.0,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // In real numbers the red of n layers is RED (1 - (1 - ALPHA)^n).
    let coverage = (0..SPLATS).fold(0.0, |covered, _| covered + (1.0 - covered) * f64::from(ALPHA));
    let real = f64::from(RED) * coverage * 255.0;
    println!("real numbers: {real:.2} of 255");
    for (name, most) in [("rgba8unorm", f64::MAX), ("rgba16float", 1.0), ("rgba32float", 0.001)] {
        let red = stack(name)?;
        println!("{name:>12}: {red:.2}, off by {:.4}", (red - real).abs());
        assert!((red - real).abs() <= most, "{name} stays within {most} of 255");
    }
    assert_eq!(stack("rgba8unorm")?.to_bits(), 0_f64.to_bits(), "0.4 codes a splat round to nothing, 400 times over");
    Ok(())
}
