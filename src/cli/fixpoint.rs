//! `outmerge fixpoint`: where a fragment drawn again and again gets stuck.

use std::fmt::Write as _;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, explain, output};
use crate::analysis::departure::Departure;
use crate::analysis::fixpoint::{self, Answer, Channel, Limit, Question, sweep::Sweep};
use crate::format::ColorFormat;
use crate::model::{Number, NumericModel, decimal, registry};
use crate::state::shaderlab::Properties;
use crate::state::text;

/// Models beside the registry's that `all` adds: blenders that truncate instead of rounding.
const TRUNCATING: [&str; 3] = ["exact:toward-zero", "fixed:8,rounding=truncate", "fixed:8,rounding=shift"];

/// Arguments of `fixpoint`.
#[derive(Debug, Args)]
pub(super) struct Fixpoint {
    /// The state: a preset, blend factors in any API's spelling, a ShaderLab block, or WebGPU JSON.
    #[arg(long, short, default_value = "fade")]
    state: String,
    /// The target's format: unsigned normalised, sRGB included.
    #[arg(long, short, default_value = "rgba8unorm")]
    format: String,
    /// The shader's output in A.
    #[arg(long, default_value_t = 0.025, allow_hyphen_values = true)]
    alpha: f32,
    /// The shader's output in R, G and B.
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    source: f32,
    /// Blend constant: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", default_value = "0,0,0,0", allow_hyphen_values = true)]
    constant: String,
    /// The channel to follow.
    #[arg(long, value_enum, default_value_t)]
    channel: Channel,
    /// The code to start from; the largest unless given.
    #[arg(long)]
    from: Option<u32>,
    /// A numeric model, or `all`: one of each kind, and blenders that truncate.
    #[arg(long, short, default_value = "all")]
    model: String,
    /// Instead of one alpha and source, follow every alpha and every source of 8 bits.
    #[arg(long, conflicts_with_all = ["alpha", "source", "from"])]
    every: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Answers as JSON has them.
#[derive(serde::Serialize)]
struct Answers<'a> {
    answers: &'a [Answer],
    /// Models that do not cover the state.
    left_out: &'a [String],
}

/// Sweeps as JSON has them.
#[derive(serde::Serialize)]
struct Sweeps<'a> {
    sweeps: &'a [Sweep],
    left_out: &'a [String],
}

impl Fixpoint {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let format = ColorFormat::from_name(&self.format)?;
        let block = text::parse(&self.state, &Properties::new()).map_err(|e| format!("--state: {e}"))?;
        let question = Question {
            format,
            blend: block.blend[0],
            channel: self.channel,
            source: self.source,
            alpha: self.alpha,
            constant: explain::color("--constant", &self.constant)?,
        };
        question.check()?;
        let models = self.models()?;
        let (models, left_out) = covering(&models, &question)?;
        let text = if self.every {
            let sweeps = sweep_all(&question, &models)?;
            if self.json {
                output::print_json("fixpoint-every", &Sweeps { sweeps: &sweeps, left_out: &left_out })?;
                return Ok(Outcome::Done);
            }
            sweep_table(&sweeps)
        } else {
            let from = self.from.unwrap_or(question.last_code());
            let exact = registry::by_name("exact")?;
            let answers = models
                .iter()
                .map(|model| fixpoint::analyze(&question, *model, exact.as_ref(), from))
                .collect::<Result<Vec<_>, _>>()?;
            if self.json {
                output::print_json("fixpoint", &Answers { answers: &answers, left_out: &left_out })?;
                return Ok(Outcome::Done);
            }
            self.answer_text(&question, &answers)
        };
        let left_out: String = left_out.iter().map(|reason| format!("left out: {reason}\n")).collect();
        output::print(&(text + &left_out))?;
        Ok(Outcome::Done)
    }

    fn models(&self) -> Result<Vec<Box<dyn NumericModel>>, Failure> {
        if self.model != "all" {
            return Ok(vec![registry::by_name(&self.model)?]);
        }
        let mut models = registry::all();
        for name in TRUNCATING {
            models.push(registry::by_name(name)?);
        }
        Ok(models)
    }

    /// What was asked, a row a model, and what it means.
    fn answer_text(&self, question: &Question, answers: &[Answer]) -> String {
        let mut text = format!(
            "{}, state {}, source {}, alpha {}, from code {}\n",
            self.format,
            self.state,
            question.source,
            question.alpha,
            answers.first().map_or(0, |answer| answer.from)
        );
        if let Some(goal) = answers.first().and_then(|answer| answer.goal) {
            let _ = writeln!(text, "real numbers would come to rest at code {goal}");
        }
        let mut table =
            output::table(["model", "ends at", "frames", "fixed points", "cycles", "alpha to move", "alpha to arrive"]);
        for answer in answers {
            let alpha = |alpha: Option<f32>| match alpha {
                None => "none".to_owned(),
                Some(tiny) if tiny != 0.0 && tiny.abs() < 1e-6 => format!("{tiny:e}"),
                Some(alpha) => alpha.to_string(),
            };
            table.add_row([
                answer.model.clone(),
                limit(&answer.ends_in),
                answer.frames.to_string(),
                ranges(&answer.fixed_points),
                cycles(&answer.dynamics.cycles().collect::<Vec<_>>()),
                alpha(answer.smallest_alpha.moves),
                alpha(answer.smallest_alpha.reaches),
            ]);
        }
        text.push('\n');
        text.push_str(&output::lines(&table));
        text.push('\n');
        for answer in answers {
            let _ = writeln!(text, "{}: {}", answer.model, verdict(answer));
        }
        text
    }
}

/// The models that cover the state, and for each that does not, why.
fn covering<'a>(
    models: &'a [Box<dyn NumericModel>],
    question: &Question,
) -> Result<(Vec<&'a dyn NumericModel>, Vec<String>), Failure> {
    let mut covering = Vec::new();
    let mut left_out = Vec::new();
    for model in models {
        match model.supports(question.format, question.blend.as_ref()) {
            Ok(()) => covering.push(model.as_ref()),
            Err(reason) if models.len() == 1 => return Err(reason.into()),
            Err(reason) => left_out.push(reason.to_string()),
        }
    }
    Ok((covering, left_out))
}

/// One answer in words.
fn verdict(answer: &Answer) -> String {
    let frames = |n: u32| if n == 1 { "1 frame".to_owned() } else { format!("{n} frames") };
    let mut text = match (answer.stuck_by, &answer.ends_in[..]) {
        (Some(0), _) => format!("arrives after {}", frames(answer.frames)),
        (Some(codes), [_]) => {
            let unit = if codes == 1 { "code" } else { "codes" };
            format!("stuck {codes} {unit} from where it should go, after {}", frames(answer.frames))
        }
        (None, [_]) => format!("comes to rest after {}", frames(answer.frames)),
        (_, cycle) => format!("oscillates among {} codes after {}", cycle.len(), frames(answer.frames)),
    };
    if let Some(d) = &answer.difference {
        let reason = d.departure.as_ref().map_or("the same value is stored with another rounding".to_owned(), reason);
        let _ = write!(
            text,
            "; leaves exact at frame {}: {} becomes {} instead of {}, as {reason}",
            d.frame, d.code, d.model, d.exact
        );
    } else if answer.model != "exact" {
        text.push_str("; every frame as exact");
    }
    text
}

/// A departure in words.
fn reason(departure: &Departure) -> String {
    let show = |number: &Number| match number.exact.as_str() {
        "" => decimal(number.decimal),
        exact if exact.len() > 32 || exact == decimal(number.decimal) => decimal(number.decimal),
        exact => format!("{} ({exact})", decimal(number.decimal)),
    };
    let (step, formula) = (departure.step, &departure.formula);
    format!("the {step}, {formula}, is {} where exact has {}", show(&departure.model), show(&departure.exact))
}

/// A limit: one code, or a cycle.
fn limit(codes: &[u32]) -> String {
    let shown: Vec<String> = codes.iter().take(6).map(u32::to_string).collect();
    let more = if codes.len() > 6 { format!(" ... ({} codes)", codes.len()) } else { String::new() };
    shown.join(" > ") + &more
}

/// `0-19, 255`, the first few.
fn ranges(ranges: &[[u32; 2]]) -> String {
    let one = |[first, last]: &[u32; 2]| if first == last { first.to_string() } else { format!("{first}-{last}") };
    match ranges.len() {
        0 => "none".to_owned(),
        n if n <= 4 => ranges.iter().map(one).collect::<Vec<_>>().join(", "),
        n => format!("{}, ... ({n} ranges)", ranges[..3].iter().map(one).collect::<Vec<_>>().join(", ")),
    }
}

fn cycles(cycles: &[&Limit]) -> String {
    match cycles {
        [] => "none".to_owned(),
        [one] => limit(&one.codes),
        [first, ..] => format!("{} (and {} more)", limit(&first.codes), cycles.len() - 1),
    }
}

fn sweep_all(question: &Question, models: &[&dyn NumericModel]) -> Result<Vec<Sweep>, Failure> {
    let bar = ProgressBar::new(256 * models.len() as u64)
        .with_style(ProgressStyle::with_template("following {bar:40} {pos}/{len} alphas {elapsed}")?);
    let sweeps = models.iter().map(|model| fixpoint::sweep::sweep(question, *model, &|| bar.inc(1)));
    let sweeps = sweeps.collect::<Result<Vec<_>, _>>()?;
    bar.finish_and_clear();
    Ok(sweeps)
}

/// Dead zones at a few alphas beside the theory, and the extremes over all.
fn sweep_table(sweeps: &[Sweep]) -> String {
    const SHOWN: [usize; 7] = [1, 2, 6, 13, 32, 128, 255];
    let mut text = "Farthest from the goal, above/below, over all 256 sources; by alpha code\n\n".to_owned();
    let shown = SHOWN.map(|alpha| alpha.to_string());
    let names = ["model"].into_iter().chain(shown.iter().map(String::as_str)).chain(["cycles", "most frames"]);
    let mut table = output::table(names);
    if let Some(first) = sweeps.first() {
        let theory = SHOWN.map(|alpha| format!("{:.1}", first.rows[alpha].theory));
        table.add_row(["1 / (2 alpha)".to_owned()].into_iter().chain(theory));
    }
    for sweep in sweeps {
        let cell = |alpha: usize| format!("{}/{}", sweep.rows[alpha].stuck_above, sweep.rows[alpha].stuck_below);
        let cycles: u32 = sweep.rows.iter().map(|row| row.sources_with_cycles).sum();
        let frames = sweep.rows.iter().map(|row| row.frames).max().unwrap_or(0);
        let start = [sweep.model.clone()].into_iter().chain(SHOWN.map(cell));
        table.add_row(start.chain([cycles.to_string(), frames.to_string()]));
    }
    text.push_str(&output::lines(&table));
    text
}
