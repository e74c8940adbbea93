//! `outmerge explain`: one blend, step by step, in one model or all, and why their codes differ; or one pixel's history.

mod compare;
mod drivers;
mod history;
mod layout;

use clap::Args;
use serde::Serialize;
use wgpu_types::ColorWrites;

use super::{Failure, Outcome, output};
use crate::format::{ChannelKind, Codes, ColorFormat};
use crate::merger::write_mask;
use crate::model::account::{Account, account};
use crate::model::exact::Exact;
use crate::model::registry::{self, Drivers};
use crate::model::{ColorInputs, Explanation, NumericModel};
use crate::state::shaderlab::Properties;
use crate::state::text;

/// Arguments of `explain`: either a scene and a pixel, or a state and its numbers.
#[derive(Debug, Args)]
#[command(override_usage = USAGE)]
pub(super) struct Explain {
    /// A scene file, or the name of a bundled scene, whose pixel to explain.
    #[arg(requires = "pixel", conflicts_with_all = ["state", "src", "dst"])]
    scene: Option<String>,
    /// The pixel: column,row, counted from 0 at the top left.
    #[arg(long, value_name = "X,Y", requires = "scene")]
    pixel: Option<String>,
    /// With a pixel: every layer's equation with its numbers, and its share of the final color.
    #[arg(long, requires = "pixel")]
    stack: bool,
    /// The state: a preset, blend factors in any API's spelling, a ShaderLab block, or WebGPU JSON.
    #[arg(long, short, required_unless_present = "scene")]
    state: Option<String>,
    /// The target's format, by its WebGPU name.
    #[arg(long, short, default_value = "rgba8unorm", conflicts_with = "scene")]
    format: String,
    /// Fragment output: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", allow_hyphen_values = true, required_unless_present = "scene")]
    src: Option<String>,
    /// Destination: r,g,b,a as numbers, stored first (nearest), or #hex, the texel's bytes in memory order.
    #[arg(long, value_name = "R,G,B,A", allow_hyphen_values = true, required_unless_present = "scene")]
    dst: Option<String>,
    /// Second source: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", default_value = "0,0,0,0", allow_hyphen_values = true)]
    src1: String,
    /// Blend constant: r,g,b,a.
    #[arg(long, value_name = "R,G,B,A", default_value = "0,0,0,0", allow_hyphen_values = true)]
    constant: String,
    /// A numeric model, or `all`; a pixel's history is then that in `exact`, with the end in the others.
    #[arg(long, short, default_value = "all")]
    model: String,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The two forms.
const USAGE: &str = "outmerge explain <SCENE> --pixel <X,Y> [--stack] [OPTIONS]
       outmerge explain --state <STATE> --src <R,G,B,A> --dst <R,G,B,A> [OPTIONS]";

/// What was asked.
struct Question {
    state: String,
    inputs: ColorInputs,
    mask: ColorWrites,
}

/// One model's answer.
#[derive(Serialize)]
struct Answer {
    model: String,
    provenance: String,
    #[serde(flatten)]
    explanation: Explanation,
    /// The codes stored, write mask applied.
    stored: Codes,
    /// Every rounding on the way, in codes, RGBA; nothing for channels that are masked, absent or not finite.
    accounts: [Option<Account>; 4],
}

/// All answers and what could not be answered.
#[derive(Serialize)]
struct Answers {
    /// `exact`, the yardstick of the rest.
    exact: Answer,
    /// The models asked for, `exact` not among them.
    models: Vec<Answer>,
    /// Models that define no result here, with the reason.
    left_out: Vec<String>,
    /// What llvmpipes of other generations, and of other processors, store.
    drivers: Vec<drivers::Variant>,
}

impl Explain {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if let (Some(scene), Some(pixel)) = (&self.scene, &self.pixel) {
            let question = history::Question { scene, pixel, model: &self.model, stack: self.stack, json: self.json };
            return history::run(&question);
        }
        let question = self.question()?;
        let answers = self.answers(&question)?;
        if self.json {
            output::print_json("explain", &answers)?;
        } else {
            let mut text = layout::heading(&question);
            let models = answers.models.iter();
            for answer in std::iter::once(&answers.exact).filter(|_| self.shows_exact()).chain(models) {
                text.push_str(&layout::answer(answer, &question));
            }
            text.push_str(&compare::tables(&answers, &question));
            text.push_str(&drivers::text(&answers.drivers, &question));
            output::print(&text)?;
        }
        Ok(Outcome::Done)
    }

    fn shows_exact(&self) -> bool {
        self.model == "all" || self.model == "exact"
    }

    fn question(&self) -> Result<Question, Failure> {
        let format = ColorFormat::from_name(&self.format)?;
        // clap asks for these where there is no scene.
        let given = |option: &Option<String>| option.clone().unwrap_or_default();
        let (state, src, dst) = (given(&self.state), given(&self.src), given(&self.dst));
        let block = text::parse(&state, &Properties::new()).map_err(|e| format!("--state: {e}"))?;
        let inputs = ColorInputs {
            format,
            blend: block.blend[0],
            constant: color("--constant", &self.constant)?,
            src: color("--src", &src)?,
            src1: color("--src1", &self.src1)?,
            dst: destination(format, &dst)?,
        };
        Ok(Question { state, inputs, mask: block.write_mask[0] })
    }

    fn answers(&self, question: &Question) -> Result<Answers, Failure> {
        let yardstick = Exact::default();
        let exact = yardstick.explain_color(&question.inputs);
        let models = match self.model.as_str() {
            "all" => registry::all(),
            name => vec![registry::by_name(name)?],
        };
        let mut answers = Answers {
            exact: question.answer(&yardstick, &exact),
            models: Vec::new(),
            left_out: Vec::new(),
            drivers: Vec::new(),
        };
        for model in models.iter().filter(|model| model.name() != yardstick.name()) {
            match model.supports(question.inputs.format, question.inputs.blend.as_ref()) {
                Ok(()) => answers.models.push(question.answer(model.as_ref(), &exact)),
                Err(reason) if models.len() == 1 => return Err(reason.into()),
                Err(reason) => answers.left_out.push(reason.to_string()),
            }
        }
        let mut drivers =
            answers.models.iter().filter_map(|answer| registry::llvmpipe(&answer.model, Drivers::default()).ok()?);
        if let Some(llvmpipe) = drivers.next_back() {
            answers.drivers = drivers::variants(llvmpipe, question);
        }
        Ok(answers)
    }
}

impl Question {
    fn answer(&self, model: &dyn NumericModel, exact: &Explanation) -> Answer {
        let explanation = model.explain_color(&self.inputs);
        let accounts =
            std::array::from_fn(|i| if self.writes(i) { account(&self.inputs, &explanation, exact, i) } else { None });
        Answer {
            model: model.name(),
            provenance: model.provenance(),
            stored: write_mask::select(self.mask, self.inputs.dst, explanation.codes),
            explanation,
            accounts,
        }
    }

    /// Whether the target has this channel.
    fn stores(&self, channel: usize) -> bool {
        self.inputs.format.channels()[channel] != ChannelKind::Absent
    }

    /// Whether the target has this channel and the mask lets it through.
    fn writes(&self, channel: usize) -> bool {
        self.stores(channel) && self.mask.bits() >> channel & 1 == 1
    }
}

/// Four numbers separated by commas; `nan`, `inf` and `-inf` are numbers here.
pub(super) fn color(option: &str, text: &str) -> Result<[f32; 4], Failure> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let wrong = || format!("{option} {text}: write four numbers separated by commas, e.g. 1,0.5,0,1");
    let [r, g, b, a] = parts[..] else { return Err(wrong().into()) };
    let number = |part: &str| part.parse::<f32>().map_err(|_| wrong());
    Ok([number(r)?, number(g)?, number(b)?, number(a)?])
}

/// A target holds no other numbers: a destination out of range is a slip, a code written as a number for example.
fn in_range(format: ColorFormat, text: &str, numbers: [f32; 4]) -> Result<(), Failure> {
    for ((kind, number), name) in format.channels().into_iter().zip(numbers).zip(["red", "green", "blue", "alpha"]) {
        let ([low, high], number) = (kind.range(), f64::from(number));
        let held = (low..=high).contains(&number);
        let special = matches!(kind, ChannelKind::Float(_)) && !number.is_finite();
        if !held && !special && kind != ChannelKind::Absent {
            let hex = format!("#{}", "00".repeat(format.bytes_per_texel()));
            return Err(format!(
                "--dst {text}: {name} is {number}, and {} holds numbers from {low} to {high}; write a number in range, or \
                 the texel's bytes in hex, e.g. {hex}",
                format.name()
            )
            .into());
        }
    }
    Ok(())
}

/// The stored texel: bytes in hex, or numbers stored to the nearest code.
fn destination(format: ColorFormat, text: &str) -> Result<Codes, Failure> {
    let Some(hex) = text.strip_prefix('#') else {
        let src = color("--dst", text)?;
        in_range(format, text, src)?;
        // Storing a number is what drawing it without blending does.
        let inputs = ColorInputs { format, blend: None, constant: [0.0; 4], src, src1: [0.0; 4], dst: [0; 4] };
        return Ok(Exact::default().merge_color(&inputs));
    };
    let bytes = format.bytes_per_texel();
    let digits = hex.chars().all(|c| c.is_ascii_hexdigit());
    if !digits || hex.len() != 2 * bytes {
        return Err(format!("--dst #{hex}: a {} texel is {} hex digits", format.name(), 2 * bytes).into());
    }
    let parsed = (0..bytes).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16)).collect::<Result<Vec<_>, _>>()?;
    Ok(format.unpack(&parsed))
}
