//! Images whose losses are known.

use std::io::Cursor;
use std::path::Path;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::composite::{Background, Composite};
use super::*;
use crate::model::{binary32::Binary32, exact::Exact};

fn source(width: u32, bits: u32, space: Space, texels: Vec<[u16; 4]>) -> Source {
    let height = u32::try_from(texels.len()).expect("small") / width;
    Source { name: "test".to_owned(), width, height, bits, space, texels }
}

fn measured(source: &Source) -> ImageReport {
    let (exact, single) = (Exact::default(), Binary32);
    measure(source, &Options { models: &[&exact, &single], exact: &exact, cutoff: 0.5 })
}

/// Every (color, alpha) pair of 8 bits, grey: color across, alpha down.
fn every_pair() -> Source {
    let texels = (0..=255).flat_map(|a| (0..=255).map(move |c| [c, c, c, a])).collect();
    source(256, 8, Space::Srgb, texels)
}

fn row(report: &ImageReport, pipeline: Pipeline) -> &PipelineReport {
    report.pipelines.iter().find(|row| row.pipeline == pipeline).expect("every pipeline is measured")
}

#[test]
fn the_measurement_of_all_pairs_is_the_analytic_table() {
    let report = measured(&every_pair());
    assert_eq!(report.alphas.len(), 255, "every alpha but 0");
    for alpha in &report.alphas {
        let law = f64::from(table::worst_error(alpha.alpha));
        assert_eq!(alpha.worst, law, "worst error at alpha {}", alpha.alpha);
        assert_eq!(alpha.levels, u32::from(alpha.alpha) + 1, "levels at alpha {}", alpha.alpha);
    }
    assert_eq!(row(&report, Pipeline::Premultiplied8).worst, 127.0, "at alpha 1");
    let (sum, texels) = report.alphas.iter().fold((0.0, 0), |(s, n), row| (s + row.bits_lost, n + row.texels));
    assert_eq!(texels, 255 * 256, "texels that are not transparent");
    assert!((report.bits_lost_per_texel - 3.0 * sum / 255.0).abs() < 1e-9, "{}", report.bits_lost_per_texel);
}

#[test]
fn straight_storage_and_sixteen_bits_recover_every_code() {
    let report = measured(&every_pair());
    for pipeline in [Pipeline::Straight8, Pipeline::Premultiplied16] {
        let row = row(&report, pipeline);
        assert_eq!(row.worst, 0.0, "{}", pipeline.name());
        assert_eq!(row.histogram, [3 * 255 * 256], "{}: every channel exact", pipeline.name());
    }
}

#[test]
fn opaque_images_lose_nothing_in_any_storage_of_eight_bits() {
    let texels = (0..=255).map(|c| [c, 255 - c, c / 2, 255]).collect();
    let report = measured(&source(16, 8, Space::Srgb, texels));
    for row in &report.pipelines {
        assert_eq!(row.worst, 0.0, "{}", row.pipeline.name());
    }
    assert_eq!(report.bits_lost_per_texel, 0.0, "alpha 255 keeps 256 levels");
    assert!(report.verdict.contains("no texel is translucent"), "{}", report.verdict);
}

#[test]
fn drawn_once_premultiplied_storage_is_within_a_code_of_the_original() {
    let report = measured(&every_pair());
    let row = row(&report, Pipeline::Premultiplied8);
    for composite in &row.composites {
        assert!(composite.worst <= 1, "{composite:?}: half a code stored, half a code drawn");
    }
    assert!(row.composites.iter().any(|composite| composite.worst == 1), "and a code does get lost");
    let backgrounds = Background::ALL.len() * 2;
    assert_eq!(row.composites.len(), backgrounds, "every background in every model");
    assert!(report.verdict.contains("safe for this image when drawn once"), "{}", report.verdict);
}

/// PSNR and worst error in integers: premultiplied 8-bit storage of linear colors, drawn once by `exact`.
#[test]
fn signal_to_noise_is_that_of_integer_arithmetic() {
    let texels: Vec<[u16; 4]> = (0..=255).flat_map(|a| [0, 77, 200, 255].map(|c| [c, 255 - c, c / 3, a])).collect();
    let report = measured(&source(32, 8, Space::Linear, texels.clone()));
    // n / 255 to the nearest integer; 255 is odd, so that there is no tie.
    let nearest = |n: u64| (2 * n + 255) / 510;
    for (background, under) in [(Background::Black, 0_u64), (Background::White, 255), (Background::Grey, 128)] {
        let (mut squares, mut channels, mut worst) = (0, 0_u64, 0);
        for texel in &texels {
            let alpha = u64::from(texel[3]);
            for color in texel[..3].iter().map(|color| u64::from(*color)) {
                let truth = nearest(color * alpha + under * (255 - alpha));
                let drawn = nearest(255 * nearest(color * alpha) + under * (255 - alpha)).min(255);
                let difference = truth.abs_diff(drawn);
                squares += difference * difference;
                channels += 1;
                worst = worst.max(difference);
            }
        }
        let of = |row: &&Composite| row.background == background && row.model == "exact";
        let composite = row(&report, Pipeline::Premultiplied8).composites.iter().find(of).expect("drawn");
        assert_eq!(u64::from(composite.worst), worst, "{background:?}");
        let psnr = (squares > 0).then(|| 20.0 * 255.0_f64.log10() - 10.0 * (count(squares) / count(channels)).log10());
        match (composite.psnr, psnr) {
            (Some(got), Some(expected)) => assert!((got - expected).abs() < 1e-9, "{background:?}: {got}, {expected}"),
            (got, expected) => assert_eq!(got, expected, "{background:?}"),
        }
    }
}

#[test]
fn straight_eight_bits_drawn_by_exact_is_the_yardstick_itself() {
    let report = measured(&every_pair());
    for composite in row(&report, Pipeline::Straight8).composites.iter().filter(|c| c.model == "exact") {
        assert_eq!((composite.worst, composite.psnr), (0, None), "{composite:?}");
    }
}

#[test]
fn the_color_of_invisible_texels_bleeds_into_straight_storage_only() {
    // Opaque black beside transparent white: the middle should stay black.
    let texels = vec![[0, 0, 0, 255], [255, 255, 255, 0], [0, 0, 0, 255], [255, 255, 255, 0]];
    let filtering = measured(&source(2, 8, Space::Linear, texels)).filtering;
    assert_eq!(filtering.straight.worst, 63.75, "white at half alpha, half strength: 255 / 4");
    assert_eq!(filtering.premultiplied.worst, 0.0, "nothing to bleed");
    assert_eq!(filtering.filtered_first.worst, 0.0, "nothing to round");
}

#[test]
fn cutouts_thin_out_with_the_mips() {
    // Opaque columns among three transparent ones: average alpha 1/4 after two levels.
    let texels = (0..64).map(|i| [9, 9, 9, if i % 4 == 0 { 255 } else { 0 }]).collect();
    let levels = measured(&source(8, 8, Space::Linear, texels)).coverage;
    let kept: Vec<f64> = levels.iter().map(|level| level.kept).collect();
    assert_eq!(kept, [0.25, 0.5, 0.0, 0.0], "quarter, half (alpha exactly at the cutoff), nothing");
    assert_eq!((levels[3].width, levels[3].height), (1, 1), "down to one texel");
}

#[test]
fn wide_images_show_fractional_codes() {
    let texels = (0..=255).map(|i| [i * 257, i * 251, i * 17, 1000 + i * 200]).collect();
    let report = measured(&source(16, 16, Space::Linear, texels));
    assert!(row(&report, Pipeline::Premultiplied8).worst > 1.0, "8 bits lose");
    let wide = row(&report, Pipeline::Premultiplied16);
    assert!(wide.worst > 0.0 && wide.worst < 0.2, "16 bits lose far less than a code of 8 bits: {}", wide.worst);
}

fn png(color: ExtendedColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    PngEncoder::new(&mut file).write_image(bytes, 2, 1, color).expect("a small picture");
    file.into_inner()
}

/// Inserts a chunk after the header, which is 8 + 25 bytes long.
fn with_chunk(mut file: Vec<u8>, kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut checked = kind.to_vec();
    checked.extend(data);
    let mut chunk = u32::try_from(data.len()).expect("short").to_be_bytes().to_vec();
    chunk.extend(&checked);
    chunk.extend(crc32(&checked).to_be_bytes());
    file.splice(33..33, chunk);
    file
}

/// CRC-32 as PNG defines it, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}

#[test]
fn files_of_8_and_16_bits_are_read_with_the_space_they_declare() {
    let path = Path::new("x.png");
    let eight = png(ExtendedColorType::Rgba8, &[1, 2, 3, 4, 5, 6, 7, 8]);
    let image = Source::decode(&eight, path, None).expect("a PNG file");
    assert_eq!((image.bits, image.space, image.texels[1]), (8, Space::Srgb, [5, 6, 7, 8]), "sRGB unless declared");
    let bytes: Vec<u8> = [1_u16, 2, 3, 4, 5, 6, 7, 65535].iter().flat_map(|x| x.to_ne_bytes()).collect();
    let sixteen = Source::decode(&png(ExtendedColorType::Rgba16, &bytes), path, None).expect("a PNG file");
    assert_eq!((sixteen.bits, sixteen.texels[1]), (16, [5, 6, 7, 65535]), "16 bits");
    let linear = with_chunk(eight.clone(), b"gAMA", &100_000_u32.to_be_bytes());
    assert_eq!(Source::decode(&linear, path, None).expect("valid").space, Space::Linear, "gamma 1.0");
    let both = with_chunk(linear.clone(), b"sRGB", &[0]);
    assert_eq!(Source::decode(&both, path, None).expect("valid").space, Space::Srgb, "sRGB goes before gAMA");
    assert_eq!(Source::decode(&both, path, Some(Space::Linear)).expect("valid").space, Space::Linear, "the flag wins");
}

#[test]
fn damaged_and_huge_files_are_errors_that_name_the_file() {
    let path = Path::new("broken.png");
    let whole = png(ExtendedColorType::Rgba8, &[0; 8]);
    for bytes in [&whole[..0], &whole[..20], &whole[..45], b"not a picture at all"] {
        let error = Source::decode(bytes, path, None).expect_err("damaged");
        assert!(error.to_string().contains("broken.png"), "{error}");
    }
    // A header that promises 65536 x 1024 texels.
    let mut huge = whole;
    huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 0, 4, 0]);
    let crc = crc32(&huge[12..29]).to_be_bytes();
    huge[29..33].copy_from_slice(&crc);
    let error = Source::decode(&huge, path, None).expect_err("too large");
    assert!(matches!(error, SourceError::Size { width: 65536, height: 1024, .. }), "{error}");
}
