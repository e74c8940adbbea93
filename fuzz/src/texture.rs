//! The texture report on any PNG file, or on any texels: no panic, and the law of 8-bit premultiplied storage holds.

use std::path::Path;

use outmerge::analysis::texture::{ImageReport, Options, Source, Space, measure};
use outmerge::model::NumericModel;
use outmerge::model::binary32::Binary32;
use outmerge::model::exact::Exact;
use outmerge::scene::texture::{ColorSpace, png};

use super::input::Input;

/// Larger images are read and not measured.
const MAX_TEXELS: usize = 64;

pub fn check(data: &[u8]) {
    let source = if data.starts_with(b"\x89PNG") {
        let _ = png::decode(data, Path::new("fuzz.png"), ColorSpace::Srgb);
        match Source::decode(data, Path::new("fuzz.png"), None) {
            Ok(source) => source,
            Err(error) => {
                assert!(error.to_string().contains("fuzz.png"), "an error names its file: {error}");
                return;
            }
        }
    } else {
        texels(&mut Input::new(data))
    };
    assert_eq!(source.texels.len(), source.width as usize * source.height as usize, "every texel is there");
    if source.texels.len() > MAX_TEXELS {
        return;
    }
    let (exact, f32) = (Exact::default(), Binary32);
    let models: [&dyn NumericModel; 2] = [&exact, &f32];
    obeys_the_law(&source, &measure(&source, &Options { models: &models, exact: &exact, cutoff: 0.5 }));
}

fn texels(input: &mut Input) -> Source {
    let (width, height) = (1 + u32::from(input.byte()) % 8, 1 + u32::from(input.byte()) % 8);
    let wide = input.bool();
    let texel = |input: &mut Input| {
        std::array::from_fn(|_| if wide { u16::from_le_bytes(input.array()) } else { u16::from(input.byte()) })
    };
    Source {
        name: "fuzz".to_owned(),
        width,
        height,
        bits: if wide { 16 } else { 8 },
        space: input.pick(&[Space::Linear, Space::Srgb]),
        texels: (0..width * height).map(|_| texel(input)).collect(),
    }
}

fn obeys_the_law(source: &Source, report: &ImageReport) {
    assert_eq!((report.width, report.height), (source.width, source.height), "size");
    assert!(report.transparent + report.translucent <= source.texels.len() as u64, "counts: {report:?}");
    assert!((0.0..=24.0).contains(&report.bits_lost_per_texel), "of 24 bits: {}", report.bits_lost_per_texel);
    for row in &report.pipelines {
        assert!((0.0..=1.0).contains(&row.texels_changed) && row.mean <= row.worst + 1e-9, "{row:?}");
    }
    if source.bits == 8 {
        for row in &report.alphas {
            assert!(row.worst <= f64::from(row.worst_possible), "alpha {}: {row:?}", row.alpha);
        }
    }
}
