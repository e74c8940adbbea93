//! `outmerge explain`: one blend, step by step, in one model or all.

use std::fmt::Write as _;

use clap::Args;
use serde::Serialize;
use wgpu_types::BlendComponent;

use super::{Failure, Outcome, output};
use crate::analysis::departure::Departure;
use crate::format::{ChannelKind, Codes, ColorFormat, Rounding, TargetClass};
use crate::merger::write_mask;
use crate::model::{ColorInputs, Explanation, Number, NumericModel, Step, registry};
use crate::state::shaderlab::Properties;
use crate::state::{spelling, text};

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub(super) struct Explain {
    /// The state: a preset, blend factors in any API's spelling, a ShaderLab block, or WebGPU JSON.
    #[arg(long, short)]
    state: String,
    /// The target's format, by its WebGPU name.
    #[arg(long, short, default_value = "rgba8unorm")]
    format: String,
    /// Fragment output: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", allow_hyphen_values = true)]
    src: String,
    /// Destination: r,g,b,a as numbers, stored first (nearest), or #hex, the texel's bytes in memory order.
    #[arg(long, value_name = "R,G,B,A", allow_hyphen_values = true)]
    dst: String,
    /// Second source: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", default_value = "0,0,0,0", allow_hyphen_values = true)]
    src1: String,
    /// Blend constant: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", default_value = "0,0,0,0", allow_hyphen_values = true)]
    constant: String,
    /// A numeric model, or `all`.
    #[arg(long, short, default_value = "all")]
    model: String,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// One model's answer.
#[derive(Serialize)]
struct Answer {
    model: String,
    #[serde(flatten)]
    explanation: Explanation,
    /// The codes stored, write mask applied.
    stored: Codes,
    /// Why it differs from `exact`, or nothing.
    difference: Option<String>,
}

impl Explain {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let format = ColorFormat::from_name(&self.format)?;
        let block = text::parse(&self.state, &Properties::new()).map_err(|e| format!("--state: {e}"))?;
        let (blend, mask) = (block.blend[0], block.write_mask[0]);
        let inputs = ColorInputs {
            format,
            blend,
            constant: color("--constant", &self.constant)?,
            src: color("--src", &self.src)?,
            src1: color("--src1", &self.src1)?,
            dst: destination(format, &self.dst)?,
        };
        let models = if self.model == "all" { registry::all() } else { vec![registry::by_name(&self.model)?] };
        let exact = registry::by_name("exact")?.explain_color(&inputs);
        let mut answers = Vec::new();
        let mut left_out = Vec::new();
        for model in &models {
            if let Err(reason) = model.supports(format, blend.as_ref()) {
                if models.len() == 1 {
                    return Err(reason.into());
                }
                left_out.push(reason.to_string());
                continue;
            }
            answers.push(answer(model.as_ref(), &inputs, mask, &exact));
        }
        if self.json {
            output::print_json(&answers)?;
            return Ok(Outcome::Fine);
        }
        let mut text = heading(&self.format, &inputs, mask);
        for (model, answer) in models.iter().filter(|m| m.supports(format, blend.as_ref()).is_ok()).zip(&answers) {
            let _ = write!(text, "\n{}: {}\n", answer.model, model.provenance());
            text.push_str(&steps(&answer.explanation.steps, format));
        }
        text.push_str(&summary(&answers, format));
        for reason in left_out {
            let _ = writeln!(text, "left out: {reason}");
        }
        output::print(&text)?;
        Ok(Outcome::Fine)
    }
}

fn answer(
    model: &dyn NumericModel,
    inputs: &ColorInputs,
    mask: wgpu_types::ColorWrites,
    exact: &Explanation,
) -> Answer {
    let explanation = model.explain_color(inputs);
    let stored = write_mask::select(mask, inputs.dst, explanation.codes);
    let difference = difference(&explanation, exact);
    Answer { model: model.name(), explanation, stored, difference }
}

/// Four numbers separated by commas; `nan`, `inf` and `-inf` are numbers here.
pub(super) fn color(option: &str, text: &str) -> Result<[f32; 4], Failure> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let wrong = || format!("{option} {text}: write four numbers separated by commas, e.g. 1,0.5,0,1");
    let [r, g, b, a] = parts[..] else { return Err(wrong().into()) };
    let number = |part: &str| part.parse::<f32>().map_err(|_| wrong());
    Ok([number(r)?, number(g)?, number(b)?, number(a)?])
}

/// The stored texel: bytes in hex, or numbers stored to the nearest code.
fn destination(format: ColorFormat, text: &str) -> Result<Codes, Failure> {
    let Some(hex) = text.strip_prefix('#') else {
        let color = color("--dst", text)?;
        // Storing a number is what drawing it without blending does.
        let exact = crate::model::exact::Exact { rounding: Rounding::NearestEven };
        let inputs = ColorInputs { format, blend: None, constant: [0.0; 4], src: color, src1: [0.0; 4], dst: [0; 4] };
        return Ok(exact.merge_color(&inputs));
    };
    let bytes = format.bytes_per_texel();
    let digits = hex.chars().all(|c| c.is_ascii_hexdigit());
    if !digits || hex.len() != 2 * bytes {
        return Err(format!("--dst #{hex}: a {} texel is {} hex digits", format.name(), 2 * bytes).into());
    }
    let parsed = (0..bytes).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16)).collect::<Result<Vec<_>, _>>()?;
    Ok(format.unpack(&parsed))
}

/// What was asked, in one paragraph.
fn heading(format: &str, inputs: &ColorInputs, mask: wgpu_types::ColorWrites) -> String {
    let equation = |c: &BlendComponent| {
        let (src, dst) = (spelling::factor_formula(c.src_factor), spelling::factor_formula(c.dst_factor));
        match c.operation {
            wgpu_types::BlendOperation::Add => format!("S * ({src}) + D * ({dst})"),
            wgpu_types::BlendOperation::Subtract => format!("S * ({src}) - D * ({dst})"),
            wgpu_types::BlendOperation::ReverseSubtract => format!("D * ({dst}) - S * ({src})"),
            wgpu_types::BlendOperation::Min => "min(S, D)".to_owned(),
            wgpu_types::BlendOperation::Max => "max(S, D)".to_owned(),
        }
    };
    let mut text = format!("format    {format}\n");
    match &inputs.blend {
        None => text.push_str("equation  S (blending off)\n"),
        Some(blend) if blend.color == blend.alpha => {
            let _ = writeln!(text, "equation  {}", equation(&blend.color));
        }
        Some(blend) => {
            let _ = writeln!(text, "equation  RGB {}; A {}", equation(&blend.color), equation(&blend.alpha));
        }
    }
    let _ = writeln!(text, "source    {:?}", inputs.src);
    let _ = writeln!(text, "stored    {}", codes(inputs.dst, inputs.format));
    if mask != wgpu_types::ColorWrites::ALL {
        let _ = writeln!(text, "mask      {:?}: other channels keep their bits", mask);
    }
    text
}

/// The steps as a table; channels that go the same way share a column.
fn steps(steps: &[Step], format: ColorFormat) -> String {
    let groups = columns(steps, format);
    let mut table = comfy_table::Table::new();
    table.load_preset(comfy_table::presets::NOTHING);
    let names = groups.iter().map(|group| group.iter().map(|&i| ["R", "G", "B", "A"][i]).collect::<String>());
    table.set_header(std::iter::once(String::new()).chain(names));
    for step in steps {
        let cell = |group: &Vec<usize>| {
            let i = group[0];
            let value = step.values[i].as_ref().map_or("-".to_owned(), show);
            if step.equation[i].is_empty() { value } else { format!("{value}  = {}", step.equation[i]) }
        };
        table.add_row(std::iter::once(format!("  {}", step.name)).chain(groups.iter().map(cell)));
    }
    let lines: Vec<String> = table.lines().map(|line| line.trim_end().to_owned()).collect();
    format!("{}\n", lines.join("\n"))
}

/// Channels with the same values and equations all along, together.
fn columns(steps: &[Step], format: ColorFormat) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in (0..4).filter(|&i| format.channels()[i] != ChannelKind::Absent || i == 3) {
        let same =
            |j: usize| steps.iter().all(|s| same_number(&s.values[i], &s.values[j]) && s.equation[i] == s.equation[j]);
        match groups.iter_mut().find(|group| same(group[0])) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}

fn same_number(a: &Option<Number>, b: &Option<Number>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.decimal.to_bits() == b.decimal.to_bits() && a.exact == b.exact,
        (None, None) => true,
        _ => false,
    }
}

/// Decimal, and the exact form beside it where it is short enough to check by hand.
fn show(number: &Number) -> String {
    let decimal = decimal(number.decimal);
    if number.exact.is_empty() || number.exact == decimal || number.exact.len() > 32 {
        return decimal;
    }
    format!("{decimal} ({})", number.exact)
}

/// Up to ten significant digits.
fn decimal(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-5..1e10).contains(&x.abs()) {
        let text = format!("{x:.9}");
        let trimmed = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return trimmed.to_owned();
    }
    format!("{x:.9e}")
}

/// The codes of the channels there are, decimal for normalised formats and hex for floats.
fn codes(codes: Codes, format: ColorFormat) -> String {
    let hex = format.class() == TargetClass::Float;
    let stored = codes.iter().zip(format.channels()).filter(|(_, kind)| *kind != ChannelKind::Absent);
    stored.map(|(code, _)| if hex { format!("{code:#x}") } else { code.to_string() }).collect::<Vec<_>>().join(" ")
}

/// The models' codes side by side, and why they differ.
fn summary(answers: &[Answer], format: ColorFormat) -> String {
    let width = answers.iter().map(|answer| answer.model.len()).max().unwrap_or(0);
    let mut text = "\nstored codes\n".to_owned();
    let longest = answers.iter().map(|answer| codes(answer.stored, format).len()).max().unwrap_or(0);
    for answer in answers {
        let why = answer.difference.as_deref().unwrap_or(if answer.model == "exact" { "" } else { "as exact" });
        let line = format!("  {:width$}  {:longest$}  {why}", answer.model, codes(answer.stored, format));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// The first step at which a channel that ends in another code departs from exact arithmetic.
fn difference(explanation: &Explanation, exact: &Explanation) -> Option<String> {
    let departure = Departure::between(explanation, exact)?;
    let (name, codes) = (["R", "G", "B", "A"][departure.channel], (explanation.codes, exact.codes));
    let (mine, theirs) = (codes.0[departure.channel], codes.1[departure.channel]);
    Some(format!("{name} {mine} instead of {theirs}: {}", reason(&departure)))
}

/// A departure in words.
pub(super) fn reason(departure: &Departure) -> String {
    let (mine, theirs) = (show(&departure.model), show(&departure.exact));
    format!("the {} is {mine} where exact has {theirs}", departure.step)
}
