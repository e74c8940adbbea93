//! Whose blender is this? A hidden fixed-point blender answers questions until one candidate is left; a file of samples
//! from elsewhere would do as well.
//!
//!     cargo run --example identify

use std::convert::Infallible;

use outmerge::format::ColorFormat;
use outmerge::identify::{Options, candidates, interrogate};
use outmerge::model::fixed::FixedPoint;
use outmerge::model::{ColorInputs, NumericModel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // What somebody's hardware does: 10-bit sources, 8-bit factors, products cut to 9 bits.
    let hidden: FixedPoint = "source=10,factor=8,product=9,rounding=truncate".parse()?;
    let options = Options::new(ColorFormat::from_name("rgba8unorm")?);
    let mut batches = 0;
    let found = interrogate(
        &candidates(),
        options,
        |_| true,
        |asked: &[ColorInputs]| {
            batches += 1;
            Ok::<_, Infallible>(asked.iter().map(|inputs| hidden.merge_color(inputs)).collect())
        },
    )?;
    println!("{} samples in {batches} batches; reproduced by:", found.samples.len());
    for name in &found.reproduced_by {
        println!("  {name}");
    }
    assert!(found.reproduced_by.contains(&hidden.to_string()), "the hidden blender is among them");
    assert!(found.settled, "and nothing tells it from the others named");
    Ok(())
}
