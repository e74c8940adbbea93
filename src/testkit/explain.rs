//! Everything known about the first pixel that differs.

use std::fmt::{self, Write as _};

use super::{Actual, Prediction};
use crate::format::{Codes, ColorFormat};
use crate::merger::{Fate, Merger};
use crate::model::{ColorInputs, registry};
use crate::state::spelling;
use crate::target::{ColorTarget, Extent};
use crate::vectors::same_codes;

/// What one fragment did to the pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Index and name of the draw.
    pub draw: (usize, String),
    /// How the fragment ended.
    pub fate: Fate,
    /// What the blender saw; `None` where it was not reached.
    pub inputs: Option<ColorInputs>,
    /// The texel's bytes afterwards.
    pub after: Vec<u8>,
}

/// How much of the image a numeric model explains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelMatch {
    /// The model's name.
    pub model: String,
    /// Whether it writes the wrong pixel's bytes.
    pub explains_pixel: bool,
    /// Pixels of the image it agrees with.
    pub pixels: usize,
}

/// A pixel that differs, with its history.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// Column and row of the first pixel that differs.
    pub pixel: (u32, u32),
    /// The sample.
    pub sample: u32,
    /// Samples that differ, and samples in all.
    pub differing: (usize, usize),
    /// The format.
    pub format: ColorFormat,
    /// The bytes that are allowed, with the models that write them.
    pub expected: Vec<(Vec<u8>, Vec<String>)>,
    /// The bytes that were read back.
    pub got: Vec<u8>,
    /// The pixel's fragments in drawing order, by the first model.
    pub history: Vec<Event>,
    /// Models of the registry, those that explain most pixels first.
    pub models: Vec<ModelMatch>,
}

/// The samples of a target, pixel by pixel.
fn places(extent: Extent) -> impl Iterator<Item = (u32, u32, u32)> {
    let Extent { width, height, samples } = extent;
    (0..height).flat_map(move |y| (0..width).flat_map(move |x| (0..samples).map(move |sample| (x, y, sample))))
}

fn texel(target: &ColorTarget, (x, y, sample): (u32, u32, u32)) -> Vec<u8> {
    let each = target.format().bytes_per_texel();
    let at = target.extent().index(x, y, sample) * each;
    target.bytes()[at..at + each].to_vec()
}

fn same(a: &ColorTarget, b: &ColorTarget, (x, y, sample): (u32, u32, u32)) -> bool {
    same_codes(a.format(), a.codes(x, y, sample), b.codes(x, y, sample))
}

/// The first difference; `None` where the image conforms.
pub(super) fn mismatch(actual: &Actual, expected: &Prediction) -> Option<Mismatch> {
    let got = &actual.target;
    let accepted = |place| expected.accepted.iter().any(|(_, result)| same(got, expected.color(result), place));
    let extent = got.extent();
    let first = places(extent).find(|place| !accepted(*place))?;
    let differing = places(extent).filter(|place| !accepted(*place)).count();
    let mut allowed: Vec<(Vec<u8>, Vec<String>)> = Vec::new();
    for (name, result) in &expected.accepted {
        let bytes = texel(expected.color(result), first);
        match allowed.iter_mut().find(|(known, _)| *known == bytes) {
            Some((_, names)) if names.contains(name) => {}
            Some((_, names)) => names.push(name.clone()),
            None => allowed.push((bytes, vec![name.clone()])),
        }
    }
    Some(Mismatch {
        pixel: (first.0, first.1),
        sample: first.2,
        differing: (differing, extent.sample_total()),
        format: got.format(),
        expected: allowed,
        got: texel(got, first),
        history: history(expected, first),
        models: models(got, expected, first),
    })
}

/// What every fragment of the pixel did, in the first accepted model.
fn history(expected: &Prediction, place: (u32, u32, u32)) -> Vec<Event> {
    let (x, y, sample) = place;
    let Ok(model) = registry::by_name(&expected.accepted[0].0) else { return Vec::new() };
    let mut framebuffer = expected.before.clone();
    let mut events = Vec::new();
    for (index, draw) in expected.draws.iter().enumerate() {
        let Ok(merger) = Merger::new(&draw.state, model.as_ref(), &expected.before) else { continue };
        for pixel in draw.fragments.iter().filter(|pixel| (pixel.x, pixel.y) == (x, y)) {
            let mut trace = merger.trace(&pixel.fragment, x, y, &mut framebuffer);
            let mut sample = trace.samples.swap_remove(sample as usize);
            let inputs = sample.colors.get_mut(expected.index).and_then(Option::take).map(|(inputs, _)| inputs);
            let after = texel(expected.color(&framebuffer), place);
            events.push(Event { draw: (index, draw.name.clone()), fate: sample.fate, inputs, after });
        }
    }
    events
}

/// How well each model of the registry explains the image.
fn models(got: &ColorTarget, expected: &Prediction, first: (u32, u32, u32)) -> Vec<ModelMatch> {
    let mut matches: Vec<ModelMatch> = registry::all()
        .iter()
        .filter_map(|model| {
            let result = expected.run(model.as_ref()).ok()?;
            let color = expected.color(&result);
            let pixels = places(got.extent()).filter(|place| same(got, color, *place)).count();
            Some(ModelMatch { model: model.name(), explains_pixel: same(got, color, first), pixels })
        })
        .collect();
    matches.sort_by_key(|found| std::cmp::Reverse((found.pixels, found.explains_pixel)));
    matches
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn shown(format: ColorFormat, bytes: &[u8]) -> String {
    let codes: Codes = format.unpack(bytes);
    format!("{} (codes {codes:?})", hex(bytes))
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let (wrong, all) = self.differing;
        writeln!(f, "{wrong} of {all} samples differ; first at pixel ({x}, {y}), sample {}", self.sample)?;
        for (bytes, models) in &self.expected {
            writeln!(f, "  expected {} by {}", shown(self.format, bytes), models.join(", "))?;
        }
        writeln!(f, "  got      {}", shown(self.format, &self.got))?;
        if self.history.is_empty() {
            writeln!(f, "history: no fragment; the pixel keeps what it was cleared to")?;
        } else {
            writeln!(f, "history of the pixel, in model {}:", self.expected[0].1[0])?;
        }
        for event in &self.history {
            let (index, name) = &event.draw;
            write!(f, "  draw {index} ({name}): {:?}", event.fate)?;
            if let Some(inputs) = &event.inputs {
                write!(f, ", source {:?} over {:?}", inputs.src, inputs.dst)?;
            }
            writeln!(f, ", then {}", hex(&event.after))?;
        }
        let total = |found: &ModelMatch| format!("{} ({} of {all})", found.model, found.pixels);
        let explaining: Vec<String> = self.models.iter().filter(|found| found.explains_pixel).map(total).collect();
        match explaining.as_slice() {
            [] => {
                let best = self.models.first().map(total).unwrap_or_default();
                write!(f, "no numeric model writes these bytes; most samples agree with {best}")?;
            }
            some => write!(f, "models that write these bytes, with the samples they agree on: {}", some.join(", "))?,
        }
        if let Some(inputs) = self.history.iter().rev().find_map(|event| event.inputs.as_ref()) {
            write!(f, "\nlast blend, step by step: {}", command(inputs))?;
        }
        Ok(())
    }
}

/// The command line that explains a blend.
fn command(inputs: &ColorInputs) -> String {
    let state = inputs.blend.map_or("off".to_owned(), |blend| {
        let component = |c: wgpu_types::BlendComponent| {
            let (src, dst) = (spelling::factor_name(c.src_factor), spelling::factor_name(c.dst_factor));
            let operation = spelling::operation_name(c.operation);
            format!(r#"{{"srcFactor":"{src}","dstFactor":"{dst}","operation":"{operation}"}}"#)
        };
        format!(r#"'{{"color":{},"alpha":{}}}'"#, component(blend.color), component(blend.alpha))
    });
    let numbers = |values: [f32; 4]| values.map(|x| x.to_string()).join(",");
    let mut dst = vec![0; inputs.format.bytes_per_texel()];
    inputs.format.pack(inputs.dst, &mut dst);
    let mut text = format!(
        "outmerge explain --state {state} --format {} --src={} --dst '#{}'",
        inputs.format.name(),
        numbers(inputs.src),
        hex(&dst)
    );
    for (flag, values) in [("--src1", inputs.src1), ("--constant", inputs.constant)] {
        if values.iter().any(|value| value.to_bits() != 0) {
            let _ = write!(text, " {flag}={}", numbers(values));
        }
    }
    text
}
