//! States that tell the drivers' generations, vector widths and processors apart, on every format where they differ.
//!
//! Random states see a rare rule by luck; these are found by [`identify::telling`](crate::identify::telling()), from the models
//! alone. They are recorded in `telling.jsonl`, so that a mistake in a model cannot hide the states that show it; a test finds them
//! again (`OUTMERGE_BLESS=1 cargo test --all-features --lib telling` records them anew).

use std::sync::LazyLock;

use super::blend::run_states;
use super::run::{Subject, Tally};
use crate::crosscheck::{Device, ReplayError};
use crate::format::ColorFormat;
use crate::vectors::VectorLine;
#[cfg(test)]
use {
    crate::format::ChannelKind,
    crate::identify::telling,
    crate::model::llvmpipe::{Estimate, Generation, Llvmpipe, VectorWidth},
    crate::model::{ColorInputs, NumericModel},
    wgpu_types::{BlendState, ColorWrites},
};

/// Questions for each pair of drivers, shared among the sources of the search.
#[cfg(test)]
const QUESTIONS: usize = 48;

/// Texels of a draw: a row of the device's copies.
const TEXELS: usize = 256;

/// Two drivers that store different bytes for some state on a format.
#[cfg(test)]
type Pair = [Box<dyn NumericModel>; 2];

/// The questions, a state a line, without results.
const RECORDED: &str = include_str!("telling.jsonl");

/// The formats that have questions.
#[must_use]
pub(super) fn has(format: ColorFormat) -> bool {
    recorded().iter().any(|line| line.format == format)
}

/// The recorded questions.
fn recorded() -> &'static [VectorLine] {
    static LINES: LazyLock<Vec<VectorLine>> = LazyLock::new(|| {
        let line = |text| VectorLine::parse(text).expect("the project's own file holds color lines");
        RECORDED.lines().map(line).collect()
    });
    &LINES
}

/// The pairs of drivers that differ on a format by one thing alone, according to their rules.
#[cfg(test)]
fn pairs(format: ColorFormat) -> Vec<Pair> {
    let boxed = |a: Llvmpipe, b: Llvmpipe| -> Pair { [Box::new(a), Box::new(b)] };
    let newest = Llvmpipe::default();
    let channels = format.channels();
    let mut pairs = Vec::new();
    for (i, older) in Generation::ALL.into_iter().enumerate() {
        for newer in Generation::ALL.into_iter().skip(i + 1) {
            if differ(older, newer, format) {
                let of = |generation| Llvmpipe { generation, ..newest };
                pairs.push(boxed(of(older), of(newer)));
            }
        }
    }
    if channels[0] == ChannelKind::Unorm(8) {
        pairs.push(boxed(newest, Llvmpipe { vector_width: VectorWidth::Bits128, ..newest }));
    }
    if channels[0] == ChannelKind::Srgb {
        let estimates = Estimate::RECORDED;
        for (i, a) in estimates.iter().enumerate() {
            let of = |estimate: &Estimate| Llvmpipe { estimate: *estimate, ..newest };
            pairs.extend(estimates[i + 1..].iter().map(|b| boxed(of(a), of(b))));
        }
    }
    pairs
}

/// Whether two generations blend differently on a format, in a way that one texel decides.
#[cfg(test)]
fn differ(a: Generation, b: Generation, format: ColorFormat) -> bool {
    let decided = |generation: Generation| {
        let words = generation.rules().words(format).into_iter();
        // What may be one or the other tells nothing of its own.
        words.filter(|words| !words.contains("factor zero")).collect::<Vec<_>>()
    };
    decided(a) != decided(b)
}

/// The questions of a format in draws: 256 texels of one state and constant each.
fn lines(format: ColorFormat) -> Vec<VectorLine> {
    let mut lines: Vec<VectorLine> = recorded().iter().filter(|line| line.format == format).cloned().collect();
    lines.iter_mut().for_each(fill_up);
    lines
}

/// The questions of a format, found by the search.
#[cfg(test)]
fn found(format: ColorFormat) -> Vec<VectorLine> {
    let mut lines: Vec<VectorLine> = Vec::new();
    for [a, b] in pairs(format) {
        for mut inputs in telling(a.as_ref(), b.as_ref(), format, QUESTIONS, 1) {
            if !inputs.blend.is_some_and(|blend| uses_constant(&blend)) {
                inputs.constant = [0.0; 4];
            }
            add(&mut lines, &inputs);
        }
    }
    lines
}

#[cfg(test)]
fn uses_constant(blend: &BlendState) -> bool {
    blend.color.uses_constant() || blend.alpha.uses_constant()
}

/// Puts a question into the line of its state, made if there is none with room.
#[cfg(test)]
fn add(lines: &mut Vec<VectorLine>, inputs: &ColorInputs) {
    let bits = |color: [f32; 4]| color.map(f32::to_bits);
    let fits = |line: &VectorLine| {
        line.blend == inputs.blend && bits(line.constant) == bits(inputs.constant) && line.len() < TEXELS
    };
    let place = lines.iter().position(fits).unwrap_or_else(|| {
        lines.push(VectorLine {
            format: inputs.format,
            blend: inputs.blend,
            mask: ColorWrites::ALL,
            constant: inputs.constant,
            src: Vec::new(),
            src1: None,
            dst: Vec::new(),
            out: None,
        });
        lines.len() - 1
    });
    let line = &mut lines[place];
    line.src.push(inputs.src);
    let start = line.dst.len();
    line.dst.resize(start + line.format.bytes_per_texel(), 0);
    line.format.pack(inputs.dst, &mut line.dst[start..]);
}

/// Repeats a line's texels until they are [`TEXELS`].
fn fill_up(line: &mut VectorLine) {
    let (src, dst) = (line.src.clone(), line.dst.clone());
    line.src = src.into_iter().cycle().take(TEXELS).collect();
    line.dst = dst.into_iter().cycle().take(TEXELS * line.format.bytes_per_texel()).collect();
}

/// Runs a telling unit.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    let mut left_out = 0;
    for line in lines(format) {
        if line.blend.is_some() && !device.blends(format) {
            left_out += 1;
            continue;
        }
        run_states(device, subjects, &line, &[(line.blend, line.mask, line.constant)], tally)?;
    }
    if left_out > 0 {
        tally.left_out = Some(format!("{left_out} states that blend, which the adapter does not on this format"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::layout::FORMATS;
    use crate::identify::telling::tells;

    #[test]
    fn the_recorded_questions_are_those_the_search_finds() {
        let formats = FORMATS.iter().map(|(_, format)| ColorFormat::new(*format).expect("listed"));
        let text: String = formats.flat_map(found).map(|line| line.to_json() + "\n").collect();
        if std::env::var_os("OUTMERGE_BLESS").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/conform/telling.jsonl");
            std::fs::write(path, &text).expect("writable");
        }
        assert!(text == RECORDED, "record them anew: see the module's page");
    }

    #[test]
    fn every_pair_of_drivers_is_told_apart_by_a_texel_of_every_format_they_differ_on() {
        let mut formats = 0;
        for (name, texture_format) in FORMATS {
            let format = ColorFormat::new(texture_format).expect("listed");
            let lines = lines(format);
            for [a, b] in pairs(format) {
                let texel = |line: &VectorLine| (0..line.len()).any(|i| tells(a.as_ref(), b.as_ref(), &line.inputs(i)));
                assert!(lines.iter().any(texel), "{name}: {} and {}", a.name(), b.name());
            }
            formats += usize::from(!lines.is_empty());
            assert!(lines.iter().all(|line| line.len() == TEXELS), "{name}: whole rows");
        }
        assert_eq!(formats, 14, "4 of 8-bit unorm, 2 sRGB, 4 of 16 and 10 bits, 3 halves, 11/10-bit floats");
    }

    /// What `pairs` leaves out by rule is not found by search either: no format is forgotten.
    #[test]
    fn formats_without_a_pair_are_alike() {
        let newest = Llvmpipe::default();
        let others = [
            Llvmpipe { generation: Generation::Mesa22_3, ..newest },
            Llvmpipe { generation: Generation::Mesa25_0, ..newest },
            Llvmpipe { vector_width: VectorWidth::Bits128, ..newest },
            Llvmpipe { estimate: Estimate::AmdZen5, ..newest },
        ];
        for (name, texture_format) in FORMATS {
            let format = ColorFormat::new(texture_format).expect("listed");
            for other in &others {
                let known = pairs(format).iter().any(|pair| pair.iter().any(|model| model.name() == other.name()));
                let found = !telling(&newest, other, format, 4, 2).is_empty();
                assert_eq!(found, known, "{name}: {}", other.name());
            }
        }
    }
}
