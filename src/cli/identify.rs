//! `outmerge identify`: which numeric model stores these results?

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use wgpu_types::{BlendState, ColorWrites};

use super::{Failure, Outcome, output};
use crate::format::layout::FORMATS;
use crate::format::{Codes, ColorFormat};
use crate::identify::examine::{Asked, asked};
use crate::identify::{Blender, Candidate, Examination, Fit, Question, Sample, candidates, examine, fit, propose};
use crate::model::{ColorInputs, NumericModel, registry};
use crate::state::shaderlab::Properties;
use crate::state::text;
use crate::vectors::{Entry, Line, VectorLine};
use crate::verdict::Verdict;

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub(super) struct Identify {
    /// Samples: vector lines with results (JSON lines), or CSV with the columns state, src, dst, out; `-` is stdin.
    #[arg(required_unless_present_any = ["adapter", "of"], conflicts_with_all = ["adapter", "of"])]
    input: Option<PathBuf>,
    /// Ask this Vulkan adapter instead: part of its name or driver.
    #[arg(long, short, conflicts_with = "of")]
    adapter: Option<String>,
    /// Ask this numeric model as if it were unknown, to see the search at work.
    #[arg(long, value_name = "MODEL")]
    of: Option<String>,
    /// Ask about this format alone, instead of all; also that of CSV samples without a column `format` (rgba8unorm unless
    /// given).
    #[arg(long, short)]
    format: Option<String>,
    /// Questions of the search at most; who is left is then checked by a few hundred more on each format.
    #[arg(long, default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    budget: u32,
    /// Seed of the questions.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Fits to show.
    #[arg(long, default_value_t = 8)]
    show: usize,
    /// Where to write the questions that would tell the remaining candidates apart, as vector lines without results.
    #[arg(long, value_name = "FILE")]
    next: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The answer.
#[derive(Serialize)]
struct Answer {
    /// Whether a model reproduces the samples.
    verdict: Verdict,
    /// What was asked.
    subject: String,
    /// Samples compared.
    samples: usize,
    /// What the verdict rests on: formats with their states, samples and clears.
    rests_on: Vec<Asked>,
    /// Models that reproduce all of them.
    reproduced_by: Vec<String>,
    /// Whether more questions would not tell those apart.
    settled: bool,
    /// The best fits.
    fits: Vec<Fit>,
    /// Questions written for the next round.
    proposed: usize,
}

/// Questions proposed for the next round.
const PROPOSED: usize = 64;

impl Identify {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let format = ColorFormat::from_name(self.format.as_deref().unwrap_or("rgba8unorm"))?;
        let candidates = candidates();
        let (subject, found) = match (&self.input, &self.of) {
            (Some(path), _) => (path.display().to_string(), self.given(path, format, &candidates)?),
            (None, Some(name)) => {
                let model = registry::by_name(name)?;
                model.supports(format, None)?;
                (format!("the model {name}"), self.ask_model(model.as_ref(), format, &candidates)?)
            }
            (None, None) => self.ask_adapter(format, &candidates)?,
        };
        // Only samples of one format lead to questions: those of the format that was asked about.
        let open = found.reproduced_by.len() > 1 && !found.settled;
        let next = if open { propose(&candidates, &found.samples, format, PROPOSED) } else { Vec::new() };
        if let Some(path) = &self.next {
            output::write_file(path, |file| {
                lines(&next).iter().try_for_each(|line| writeln!(file, "{}", line.to_json()))?;
                Ok(())
            })?;
        }
        let verdict = Verdict::of_search(found.reproduced_by.is_empty(), found.samples.len());
        let answer = Answer {
            verdict,
            subject,
            samples: found.samples.len(),
            rests_on: found.asked,
            reproduced_by: found.reproduced_by,
            settled: found.settled || next.is_empty(),
            fits: found.fits.into_iter().take(self.show.max(1)).collect(),
            proposed: next.len(),
        };
        if self.json {
            output::print_json("identify", &answer)?;
        } else {
            output::print(&self.text(&answer))?;
        }
        Ok(Outcome::Judged(verdict))
    }

    fn question(&self, first: ColorFormat) -> Question {
        let all = || FORMATS.iter().filter_map(|(_, format)| ColorFormat::new(*format).ok()).collect();
        let formats = if self.format.is_some() { vec![first] } else { all() };
        Question { first, formats, budget: self.budget as usize, seed: self.seed }
    }

    /// Samples from a file.
    fn given(&self, path: &Path, format: ColorFormat, candidates: &[Candidate]) -> Result<Examination, Failure> {
        let mut input = BufReader::new(output::open(path)?);
        let named = |error: String| -> Failure { format!("{}: {error}", path.display()).into() };
        let is_json = first_byte(&mut input)? == Some(b'{');
        let samples = if is_json { from_lines(input) } else { from_csv(input, format) }.map_err(named)?;
        if samples.is_empty() {
            return Err(named("no samples: lines of kind color with `out` are wanted".to_owned()));
        }
        if samples.iter().all(|sample| sample.mask.is_empty()) {
            return Err(named("no sample writes a channel, so that every model would reproduce them".to_owned()));
        }
        let fits = fit(candidates, &samples);
        let reproduced_by =
            fits.iter().filter(|fit| fit.is_exact(samples.len())).map(|fit| fit.model.clone()).collect();
        let asked = asked(&samples, &BTreeMap::new());
        Ok(Examination { samples, asked, reproduced_by, settled: false, fits })
    }

    fn ask_model(
        &self,
        model: &dyn NumericModel,
        format: ColorFormat,
        candidates: &[Candidate],
    ) -> Result<Examination, Failure> {
        examine(candidates, &self.question(format), &mut Unknown(model))
    }

    #[cfg(feature = "gpu")]
    fn ask_adapter(&self, format: ColorFormat, candidates: &[Candidate]) -> Result<(String, Examination), Failure> {
        use crate::crosscheck::{Device, OpenOptions, adapter};
        adapter::reexec_without_shader_cache()?;
        let device = Device::open(&OpenOptions { adapter: self.adapter.clone(), ..OpenOptions::default() })?;
        if !device.renders(format.texture_format()) {
            return Err(format!("{}: does not render to {}", device.report(), format.name()).into());
        }
        if let Some(warning) = device.report().warning() {
            output::complain(&warning);
        }
        let found = examine(candidates, &self.question(format), &mut Adapter(&device))?;
        Ok((device.report().to_string(), found))
    }

    #[cfg(not(feature = "gpu"))]
    fn ask_adapter(&self, _: ColorFormat, _: &[Candidate]) -> Result<(String, Examination), Failure> {
        Err("this program was built without the feature `gpu`; build with --all-features to ask an adapter".into())
    }

    fn text(&self, answer: &Answer) -> String {
        let mut text = format!("{}: {} samples\n", answer.subject, answer.samples);
        text.push_str(&basis(&answer.rests_on));
        match answer.reproduced_by.as_slice() {
            [] => text.push_str("none: no candidate reproduces every sample\n"),
            [one] => {
                let _ = writeln!(text, "{one} reproduces every sample asked, and no other candidate does");
            }
            several => {
                let _ = writeln!(text, "{} candidates reproduce every sample asked:", several.len());
                for name in several.iter().take(self.show.max(1)) {
                    let _ = writeln!(text, "  {name}");
                }
                if several.len() > self.show.max(1) {
                    let _ = writeln!(text, "  ... and {} more", several.len() - self.show.max(1));
                }
                text.push_str(if answer.settled {
                    "no question found tells them apart on these formats\n"
                } else {
                    "more samples would tell them apart: see --next\n"
                });
            }
        }
        if answer.reproduced_by.is_empty() {
            text.push_str("best fits:\n");
            for fit in &answer.fits {
                let (wrong, of) = (fit.mismatches, fit.samples);
                let _ = writeln!(text, "  {:50} {wrong:>7} of {of} differ ({:.3} %)", fit.model, 100.0 * fit.rate());
            }
        }
        if let (Some(path), true) = (&self.next, answer.proposed > 0) {
            let _ = writeln!(text, "{} questions for the next round are in {}", answer.proposed, path.display());
        }
        text
    }
}

/// What a verdict rests on, and what it says nothing of.
fn basis(asked: &[Asked]) -> String {
    let mut text = String::new();
    for asked in asked {
        let clears = if asked.clears > 0 { format!(", {} clears", asked.clears) } else { String::new() };
        let states = asked.states.len();
        let plural = if states == 1 { "" } else { "s" };
        let _ = writeln!(text, "  {:16} {:6} samples of {states} state{plural}{clears}", asked.format, asked.samples);
    }
    if !text.is_empty() {
        text.push_str(
            "  numbers: codes, ties and their neighbours, powers of two, random, denormal, huge and special ones\n  not asked: other states and numbers, second sources, write masks, depth, stencil, samples; --json names the states\n",
        );
    }
    text
}

/// A numeric model asked as if it were unknown.
struct Unknown<'a>(&'a dyn NumericModel);

impl Blender for Unknown<'_> {
    type Error = Failure;

    fn renders(&self, format: ColorFormat) -> bool {
        self.0.supports(format, None).is_ok()
    }

    fn runs(&self, format: ColorFormat, blend: Option<&BlendState>) -> bool {
        self.0.supports(format, blend).is_ok()
    }

    fn merge(&mut self, asked: &[ColorInputs]) -> Result<Vec<Codes>, Failure> {
        Ok(asked.iter().map(|inputs| self.0.merge_color(inputs)).collect())
    }

    fn clear(&mut self, format: ColorFormat, colors: &[[f32; 4]]) -> Result<Option<Vec<Codes>>, Failure> {
        Ok(Some(colors.iter().map(|color| self.0.clear_color(format, *color)).collect()))
    }
}

/// A device.
#[cfg(feature = "gpu")]
struct Adapter<'a>(&'a crate::crosscheck::Device);

#[cfg(feature = "gpu")]
impl Blender for Adapter<'_> {
    type Error = Failure;

    fn renders(&self, format: ColorFormat) -> bool {
        self.0.renders(format.texture_format())
    }

    fn runs(&self, format: ColorFormat, blend: Option<&BlendState>) -> bool {
        blend.is_none() || self.0.blends(format)
    }

    fn merge(&mut self, asked: &[ColorInputs]) -> Result<Vec<Codes>, Failure> {
        use crate::crosscheck::vector;
        // A line a state: lines come in the order of their first question.
        let mut answers = vec![[0; 4]; asked.len()];
        for mut line in lines(asked) {
            let places: Vec<usize> = (0..asked.len()).filter(|i| belongs(&asked[*i], &line)).collect();
            let mut recorded = Line::Color(line.clone());
            vector::record(self.0, &mut recorded)?;
            let Line::Color(recorded) = recorded else { continue };
            line.out = recorded.out;
            for (place, sample) in places.into_iter().zip(Sample::from_line(&line).unwrap_or_default()) {
                answers[place] = sample.got;
            }
        }
        Ok(answers)
    }

    fn clear(&mut self, format: ColorFormat, colors: &[[f32; 4]]) -> Result<Option<Vec<Codes>>, Failure> {
        let wide: Vec<[f64; 4]> = colors.iter().map(|color| color.map(f64::from)).collect();
        Ok(Some(crate::crosscheck::clear::clear(self.0, format, &wide)?))
    }
}

/// The first byte that is not white space, left in the input.
fn first_byte(input: &mut impl BufRead) -> Result<Option<u8>, Failure> {
    loop {
        let buffer = input.fill_buf()?;
        match buffer.first().copied() {
            Some(byte) if byte.is_ascii_whitespace() => input.consume(1),
            found => return Ok(found),
        }
    }
}

/// Texels of the color lines of a vector file.
fn from_lines(input: impl Read) -> Result<Vec<Sample>, String> {
    let mut samples = Vec::new();
    for (number, text) in BufReader::new(input).lines().enumerate() {
        let place = |error: String| format!("line {}: {error}", number + 1);
        let text = text.map_err(|error| place(error.to_string()))?;
        if text.trim().is_empty() {
            continue;
        }
        match Entry::parse(&text).map_err(|error| place(error.to_string()))? {
            Entry::Driver(_) => {}
            Entry::Line(Line::Color(line)) => {
                samples.extend(Sample::from_line(&line).ok_or_else(|| place("has no `out`".to_owned()))?);
            }
            Entry::Line(Line::Depth(_) | Line::Layers(_)) => {
                return Err(place("only lines of kind color show how a blender rounds".to_owned()));
            }
        }
    }
    Ok(samples)
}

/// Texels of a CSV file: `state`, `src`, `dst`, `out`, and if there are any `format`, `constant`, `src1`.
fn from_csv(input: impl Read, format: ColorFormat) -> Result<Vec<Sample>, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(input);
    let headers = reader.headers().map_err(|error| error.to_string())?.clone();
    const COLUMNS: [&str; 7] = ["format", "state", "src", "src1", "constant", "dst", "out"];
    if let Some(unknown) = headers.iter().find(|header| !COLUMNS.contains(header)) {
        return Err(format!("unknown column `{unknown}`; columns are {}", COLUMNS.join(", ")));
    }
    let column = |name: &str| headers.iter().position(|header| header == name);
    let mut samples = Vec::new();
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|error| error.to_string())?;
        let place = |name: &str, error: String| format!("line {}, `{name}`: {error}", number + 2);
        let cell = |name: &str| column(name).and_then(|i| record.get(i)).filter(|cell| !cell.is_empty());
        let needed = |name: &str| cell(name).ok_or_else(|| place(name, "missing".to_owned()));
        let numbers = |name: &str| cell(name).map_or(Ok([0.0; 4]), |text| numbers(text).map_err(|e| place(name, e)));
        let format = match cell("format") {
            Some(name) => ColorFormat::from_name(name).map_err(|error| place("format", error.to_string()))?,
            None => format,
        };
        let block = text::parse(needed("state")?, &Properties::new()).map_err(|e| place("state", e.to_string()))?;
        needed("src")?;
        let codes = |name: &str| codes(format, needed(name)?).map_err(|error| place(name, error));
        let inputs = ColorInputs {
            format,
            blend: block.blend[0],
            constant: numbers("constant")?,
            src: numbers("src")?,
            src1: numbers("src1")?,
            dst: codes("dst")?,
        };
        samples.push(Sample { inputs, mask: block.write_mask[0], got: codes("out")? });
    }
    Ok(samples)
}

/// Four things between spaces, commas or semicolons.
fn four(text: &str) -> Result<[&str; 4], String> {
    let separates = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let parts: Vec<&str> = text.split(separates).filter(|part| !part.is_empty()).collect();
    parts.try_into().map_err(|parts: Vec<&str>| format!("`{text}` has {} values; four are wanted", parts.len()))
}

fn numbers(text: &str) -> Result<[f32; 4], String> {
    let mut numbers = [0.0; 4];
    for (number, part) in numbers.iter_mut().zip(four(text)?) {
        *number = part.parse().map_err(|_| format!("`{part}` is not a number"))?;
    }
    Ok(numbers)
}

/// `#` and the texel's bytes in memory order as hex, or four codes.
fn codes(format: ColorFormat, text: &str) -> Result<Codes, String> {
    if let Some(digits) = text.strip_prefix('#') {
        let each = format.bytes_per_texel();
        let byte = |i: usize| digits.get(2 * i..2 * i + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok());
        let bytes: Option<Vec<u8>> = (0..each).map(byte).collect();
        return match bytes {
            Some(bytes) if digits.len() == 2 * each => Ok(format.unpack(&bytes)),
            _ => Err(format!("`{text}` is not the hex of {each} bytes, which a texel of {} has", format.name())),
        };
    }
    let mut codes = [0; 4];
    for (i, part) in four(text)?.into_iter().enumerate() {
        let code: Option<u32> = part.parse().ok();
        let fits = |code: &u32| u64::from(*code) < 1 << format.channels()[i].bits();
        codes[i] = code.filter(fits).ok_or_else(|| format!("`{part}` is no code of {}", format.name()))?;
    }
    Ok(codes)
}

/// Whether a question goes into a line: the same state and constant.
fn belongs(inputs: &ColorInputs, line: &VectorLine) -> bool {
    let bits = |color: [f32; 4]| color.map(f32::to_bits);
    inputs.format == line.format && inputs.blend == line.blend && bits(inputs.constant) == bits(line.constant)
}

/// Questions as vector lines without results, a line a state.
fn lines(questions: &[ColorInputs]) -> Vec<VectorLine> {
    let mut lines: Vec<VectorLine> = Vec::new();
    for inputs in questions {
        let place = lines.iter().position(|line| belongs(inputs, line)).unwrap_or_else(|| {
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
    lines
}
