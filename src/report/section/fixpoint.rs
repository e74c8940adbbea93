//! Fades that get stuck.

use super::{Failure, Figure, Section, Table};
use crate::analysis::fixpoint::{self, Answer, Channel, Question};
use crate::format::ColorFormat;
use crate::model::{NumericModel, registry};
use crate::report::plot::{Axis, Chart, Mark, Series};
use crate::state::shaderlab::Properties;
use crate::state::text;

/// A blender that truncates, beside the models.
const TRUNCATING: &str = "fixed:8,rounding=truncate";

/// The alpha of the table.
const ALPHA: f32 = 0.025;

fn question(alpha: f32) -> Result<Question, Failure> {
    Ok(Question {
        format: ColorFormat::from_name("rgba8unorm")?,
        blend: text::parse("fade", &Properties::new())?.blend[0],
        channel: Channel::Color,
        source: 0.0,
        alpha,
        constant: [0.0; 4],
    })
}

/// The section.
///
/// # Errors
/// None is expected: the question is a fixed one.
pub fn section(models: &[&dyn NumericModel]) -> Result<Section, Failure> {
    let (exact, truncating) = (registry::by_name("exact")?, registry::by_name(TRUNCATING)?);
    let mut all: Vec<&dyn NumericModel> = models.to_vec();
    all.push(truncating.as_ref());
    let asked = question(ALPHA)?;
    all.retain(|model| model.supports(asked.format, asked.blend.as_ref()).is_ok());
    let answers = all
        .iter()
        .map(|model| fixpoint::analyze(&asked, *model, exact.as_ref(), asked.last_code()))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(Section {
        id: "fixpoint",
        title: "Fades that get stuck",
        finding: finding(&answers),
        method: "White is faded by drawing black with a small alpha, again and again, on rgba8unorm. The chart follows every \
                 alpha of 8 bits to where it ends; rounding to nearest undoes moves of less than half a code, hence \
                 1 / (2 alpha)."
            .to_owned(),
        figures: vec![Figure::chart("Code at which a fade from white to black stops", chart(&all)?)],
        tables: vec![table(&answers)],
        command: format!("outmerge fixpoint --alpha {ALPHA} --source 0"),
    })
}

fn finding(answers: &[Answer]) -> String {
    let end = |name: &str| answers.iter().find(|answer| answer.model == name).and_then(|answer| answer.ends_in.last());
    match (end("exact"), end(TRUNCATING)) {
        (Some(exact), Some(truncated)) => format!(
            "A fade to black by {ALPHA} a frame stops at code {exact} even if every blend is rounded correctly; a blender \
             that truncates ends at {truncated}."
        ),
        _ => String::new(),
    }
}

fn table(answers: &[Answer]) -> Table {
    let mut table = Table::new(
        &format!("Black at alpha {ALPHA} over white, again and again"),
        ["model", "ends at", "frames", "smallest alpha that moves it", "that arrives"],
    );
    for answer in answers {
        let alpha = |alpha: Option<f32>| alpha.map_or("none".to_owned(), |alpha| format!("{alpha:.6}"));
        let ends: Vec<String> = answer.ends_in.iter().take(4).map(u32::to_string).collect();
        table.add([
            answer.model.clone(),
            ends.join(", "),
            answer.frames.to_string(),
            alpha(answer.smallest_alpha.moves),
            alpha(answer.smallest_alpha.reaches),
        ]);
    }
    table
}

/// Where the fade ends against alpha: a line a model, and the theory.
fn chart(models: &[&dyn NumericModel]) -> Result<Chart, Failure> {
    let alpha = |code: u16| f32::from(code) / 255.0;
    let mut series = Vec::new();
    for model in models {
        let mut points = Vec::new();
        for code in 1..=255 {
            let question = question(alpha(code))?;
            let map = question.map(*model);
            // A fade only falls: it is at rest after at most as many frames as there are codes.
            let end = (0..map.len()).fold(question.last_code(), |at, _| map[at as usize]);
            points.push((f64::from(alpha(code)), f64::from(end)));
        }
        series.push(Series { name: model.name(), points, mark: Mark::Line });
    }
    let theory = (1..=255).map(|code| (f64::from(alpha(code)), 0.5 / f64::from(alpha(code)))).collect();
    series.push(Series { name: "1 / (2 alpha)".to_owned(), points: theory, mark: Mark::Line });
    Ok(Chart {
        x: Axis::new("alpha of the black layer", 1e-3),
        y: Axis::new("code the fade stops at (0 at the bottom)", 0.1),
        series,
    })
}
