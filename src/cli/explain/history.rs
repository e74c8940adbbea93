//! `outmerge explain SCENE --pixel x,y`: the history of one pixel.

use std::fmt::Write as _;

use serde::Serialize;
use wgpu_types::ColorWrites;

use super::layout::codes;
use crate::cli::{Failure, Outcome, output, render};
use crate::format::ColorFormat;
use crate::merger::Fate;
use crate::model::{ColorInputs, NumericModel, StepKind, decimal, registry};
use crate::scene::history::{Contents, Event, History, Stack, Verdict, describe};
use crate::scene::{Draw, Scene};

/// What was asked.
pub(super) struct Question<'a> {
    pub(super) scene: &'a str,
    pub(super) pixel: &'a str,
    pub(super) model: &'a str,
    pub(super) stack: bool,
    pub(super) json: bool,
}

/// The answer, as JSON has it.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    history: History,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stacks: Vec<Stack>,
    /// The pixel in the end in the other models, where all were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    others: Vec<Other>,
}

#[derive(Serialize)]
struct Other {
    model: String,
    last: Contents,
}

pub(super) fn run(question: &Question<'_>) -> Result<Outcome, Failure> {
    let (x, y) = pixel(question.pixel)?;
    let scene = render::load(question.scene)?;
    let all = question.model == "all";
    let model = registry::by_name(if all { "exact" } else { question.model })?;
    let history = scene.history(model.as_ref(), x, y)?;
    let draws = scene.draws();
    let stacks = if question.stack { history.stacks(&draws) } else { Vec::new() };
    let others = if all { others(&scene, model.as_ref(), x, y) } else { Vec::new() };
    let answer = Answer { history, stacks, others };
    if question.json {
        output::print_json("explain-pixel", &answer)?;
    } else {
        output::print(&text(&scene, &draws, &answer, model.as_ref())?)?;
    }
    Ok(Outcome::Done)
}

/// The pixel's end in every other model that covers the scene.
fn others(scene: &Scene, model: &dyn NumericModel, x: u32, y: u32) -> Vec<Other> {
    let rest = registry::all().into_iter().filter(|other| other.name() != model.name());
    let end = |other: Box<dyn NumericModel>| {
        let last = scene.history(other.as_ref(), x, y).ok()?.last;
        Some(Other { model: other.name(), last })
    };
    rest.filter_map(end).collect()
}

fn pixel(text: &str) -> Result<(u32, u32), Failure> {
    let parse = || {
        let (x, y) = text.split_once(',')?;
        Some((x.trim().parse().ok()?, y.trim().parse().ok()?))
    };
    parse().ok_or_else(|| {
        format!("--pixel {text}: write column and row, counted from 0 at the top left, e.g. 12,40").into()
    })
}

fn text(scene: &Scene, draws: &[Draw], answer: &Answer, model: &dyn NumericModel) -> Result<String, Failure> {
    let history = &answer.history;
    let formats: Vec<ColorFormat> = scene.target.colors.iter().map(|color| color.format).collect();
    let mut text = String::new();
    let merged = history.events.iter().filter(|event| event.fate == Fate::Merged).count();
    writeln!(text, "pixel {},{} of \"{}\", model {}", history.x, history.y, scene.title, history.model)?;
    writeln!(text, "{} draws, {} fragments on this pixel, {merged} merged\n", history.draws, history.events.len())?;
    writeln!(text, "cleared")?;
    contents(&mut text, &history.cleared, &formats)?;
    for (index, event) in history.events.iter().enumerate() {
        text.push('\n');
        one(&mut text, index, event, &formats)?;
        if !answer.stacks.is_empty() {
            equations(&mut text, event, &formats, draws, model)?;
        }
    }
    if history.events.is_empty() {
        writeln!(text, "\nno draw covers this pixel")?;
    }
    for stack in &answer.stacks {
        shares(&mut text, stack, &formats, history)?;
    }
    if !answer.others.is_empty() {
        writeln!(text, "\nin the end")?;
        let width = answer.others.iter().map(|other| other.model.len()).max().unwrap_or(0).max(history.model.len());
        let mut line =
            |model: &str, last: &Contents| writeln!(text, "  {model:width$}  {}", colors(last, &formats).join("; "));
        line(&history.model, &history.last)?;
        for other in &answer.others {
            line(&other.model, &other.last)?;
        }
    }
    Ok(text)
}

/// Everything the targets hold, a line each.
fn contents(text: &mut String, contents: &Contents, formats: &[ColorFormat]) -> Result<(), Failure> {
    for (i, color) in contents.colors.iter().enumerate() {
        let values = stored_channels(formats[i]).map(|channel| short(color.values[channel])).collect::<Vec<_>>();
        writeln!(text, "  color {i}  {}  ({})", codes(color.codes, formats[i]), values.join(", "))?;
    }
    if let Some((_, depth)) = contents.depth {
        writeln!(text, "  depth    {}", decimal(depth))?;
    }
    if let Some(stencil) = contents.stencil {
        writeln!(text, "  stencil  {stencil}")?;
    }
    Ok(())
}

/// One fragment: what came in, each stage, what changed.
fn one(text: &mut String, index: usize, event: &Event, formats: &[ColorFormat]) -> Result<(), Failure> {
    let facing = if event.front_facing { "front" } else { "back" };
    // Passes without a name of their own are called `pass 0` and so on.
    let pass = if event.pass.starts_with("pass ") { "" } else { "pass " };
    let light = event.light.map_or(String::new(), |light| format!(", light {}", light + 1));
    writeln!(text, "{}. draw {}: {}, {pass}{}{light}", index + 1, event.draw + 1, event.object, event.pass)?;
    let (triangle, triangles) = (event.triangle + 1, event.triangles);
    writeln!(text, "  primitive      triangle {triangle} of {triangles}, {facing} face")?;
    for (i, output) in event.outputs.iter().enumerate() {
        writeln!(text, "  output {i}       {}", output.map(|x| short(f64::from(x))).join(", "))?;
    }
    for stage in &event.stages {
        let verdict = match stage.verdict {
            Verdict::Off => "off",
            Verdict::Passed => "passed",
            Verdict::Failed => "FAILED",
        };
        writeln!(text, "{}", format!("  {:<14} {verdict:<7}{}", stage.name, stage.detail).trim_end())?;
    }
    let (before, after) = (colors(&event.before, formats), colors(&event.after, formats));
    for (i, (before, after)) in before.iter().zip(&after).enumerate() {
        let change = if before == after { format!("{before}, unchanged") } else { format!("{before} -> {after}") };
        writeln!(text, "  color {i}        {change}")?;
    }
    if event.before.depth != event.after.depth {
        let depth = |contents: &Contents| contents.depth.map_or(String::new(), |(_, depth)| decimal(depth));
        writeln!(text, "  depth          {} -> {}", depth(&event.before), depth(&event.after))?;
    }
    if event.before.stencil != event.after.stencil {
        let stencil = |contents: &Contents| contents.stencil.map_or(String::new(), |stencil| stencil.to_string());
        writeln!(text, "  stencil        {} -> {}", stencil(&event.before), stencil(&event.after))?;
    }
    if event.fate != Fate::Merged {
        writeln!(text, "  => {}", describe(event.fate))?;
    }
    Ok(())
}

/// The blend equation of a merged fragment with the model's numbers, a line a channel.
fn equations(
    text: &mut String,
    event: &Event,
    formats: &[ColorFormat],
    draws: &[Draw],
    model: &dyn NumericModel,
) -> Result<(), Failure> {
    for (target, inputs) in event.inputs.iter().enumerate() {
        let (Some(inputs), Some(format)) = (inputs, formats.get(target)) else { continue };
        let mask = draws[event.draw].state.targets[target].as_ref().map_or(ColorWrites::empty(), |t| t.write_mask);
        let explained = model.explain_color(inputs);
        for channel in stored_channels(*format) {
            let name = ["R", "G", "B", "A"][channel];
            if !mask.contains(ColorWrites::from_bits_truncate(1 << channel)) {
                writeln!(text, "  {name}{target}  masked, keeps its bits")?;
                continue;
            }
            let stored = explained.codes[channel];
            writeln!(text, "  {name}{target}  {} -> {stored}", equation(inputs, channel, &explained))?;
        }
    }
    Ok(())
}

/// `source * factor + destination * factor = result`.
fn equation(inputs: &ColorInputs, channel: usize, explained: &crate::model::Explanation) -> String {
    let number = |kind| explained.value(kind, channel).map_or("?".to_owned(), |number| short(number.decimal));
    let source = number(StepKind::Source);
    let Some(blend) = &inputs.blend else { return source };
    if explained.step(StepKind::Result, channel).is_none() {
        return format!("one fused step of {source} and {}", number(StepKind::Destination));
    }
    let operation = crate::merger::blend::component(blend, channel).operation;
    let (source_term, destination_term) = (
        format!("{source} * {}", number(StepKind::SourceFactor)),
        format!("{} * {}", number(StepKind::Destination), number(StepKind::DestinationFactor)),
    );
    let result = number(StepKind::Result);
    match operation {
        wgpu_types::BlendOperation::Add => format!("{source_term} + {destination_term} = {result}"),
        wgpu_types::BlendOperation::Subtract => format!("{source_term} - {destination_term} = {result}"),
        wgpu_types::BlendOperation::ReverseSubtract => format!("{destination_term} - {source_term} = {result}"),
        wgpu_types::BlendOperation::Min => format!("min({source}, {}) = {result}", number(StepKind::Destination)),
        wgpu_types::BlendOperation::Max => format!("max({source}, {}) = {result}", number(StepKind::Destination)),
    }
}

/// Each layer's part of the final color.
fn shares(text: &mut String, stack: &Stack, formats: &[ColorFormat], history: &History) -> Result<(), Failure> {
    let channels: Vec<usize> = stored_channels(formats[stack.target]).collect();
    writeln!(text, "\nthe layers of color {} as one sum, weight x source", stack.target)?;
    let mut table = output::table(std::iter::once("").chain(channels.iter().map(|&i| ["R", "G", "B", "A"][i])));
    for share in &stack.shares {
        let name = share.event.map_or("cleared".to_owned(), |i| format!("{}. {}", i + 1, history.events[i].object));
        let cell = |i: &usize| format!("{} x {}", short(share.weight[*i]), short(share.source[*i]));
        table.add_row(std::iter::once(name).chain(channels.iter().map(cell)));
    }
    for (name, values) in [("sum, in real numbers", &stack.sum), ("stored", &stack.stored)] {
        table.add_row(std::iter::once(name.to_owned()).chain(channels.iter().map(|&i| short(values[i]))));
    }
    text.push_str(&output::lines(&table));
    Ok(())
}

fn stored_channels(format: ColorFormat) -> impl Iterator<Item = usize> {
    (0..4).filter(move |&i| format.channels()[i] != crate::format::ChannelKind::Absent)
}

/// Codes of every color target.
fn colors(contents: &Contents, formats: &[ColorFormat]) -> Vec<String> {
    contents.colors.iter().zip(formats).map(|(color, format)| codes(color.codes, *format)).collect()
}

/// At most six digits.
fn short(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return x.to_string();
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{x:.4e}");
    }
    let text = format!("{x:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
