//! The texture report through the library: a soft brush of 64 x 64 texels, made here, and what storing it premultiplied
//! in 8 bits costs.
//!
//!     cargo run --features report --example texture_report

use outmerge::analysis::texture::pipeline::Pipeline;
use outmerge::analysis::texture::{Options, Source, Space, measure};
use outmerge::model::NumericModel;
use outmerge::model::binary16::Binary16;
use outmerge::model::exact::Exact;

const SIDE: u16 = 64;

/// A disc of one color whose alpha falls off towards its edge.
fn brush() -> Source {
    let texel = |x: u16, y: u16| {
        let (dx, dy) = (i32::from(x) - 32, i32::from(y) - 32);
        let distance = u16::try_from(dx * dx + dy * dy).unwrap_or(u16::MAX);
        [200, 90, 30, 255_u16.saturating_sub(distance / 4)]
    };
    Source {
        name: "brush".to_owned(),
        width: SIDE.into(),
        height: SIDE.into(),
        bits: 8,
        space: Space::Srgb,
        texels: (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| texel(x, y))).collect(),
    }
}

fn main() {
    let (exact, half) = (Exact::default(), Binary16);
    let models: [&dyn NumericModel; 2] = [&exact, &half];
    let report = measure(&brush(), &Options { models: &models, exact: &exact, cutoff: 0.5 });
    println!("{}", report.verdict);
    for row in &report.pipelines {
        println!("{:36} worst {:6.2} codes, mean {:.3}", row.pipeline.name(), row.worst, row.mean);
    }
    let of = |pipeline| report.pipelines.iter().find(|row| row.pipeline == pipeline).expect("all are measured");
    assert_eq!(of(Pipeline::Straight8).worst.to_bits(), 0_f64.to_bits(), "straight storage keeps every color");
    assert!(of(Pipeline::Premultiplied8).worst > 30.0, "premultiplied 8 bits lose dark edges");
    let bounded = |row: &outmerge::analysis::texture::AlphaRow| row.worst <= f64::from(row.worst_possible);
    assert!(report.alphas.iter().all(bounded), "never more than floor(127 / alpha + 1/2) codes");
}
