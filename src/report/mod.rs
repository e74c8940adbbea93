//! Reports: every scene in every numeric model, as data, as a table and as one self-contained HTML page.
//!
//! [`compare`] makes the data; [`html`] and [`table`](fn@table) show it. [`device`] adds what a real driver makes of the
//! same scenes; [`gallery`](mod@gallery) shows one picture of each.

pub mod device;
pub mod difference;
pub mod gallery;
pub mod html;
pub mod plot;
pub mod section;
#[cfg(test)]
mod tests;

use std::time::Duration;

use rayon::prelude::*;
use serde::Serialize;

use crate::model::NumericModel;
use crate::model::exact::Exact;
use crate::scene::description::Reference;
use crate::scene::{DrawReport, Picture, PictureAlpha, Rendered, Scene, SceneError};
use crate::target::Framebuffer;
use difference::{Difference, Differences};

/// One scene in every model.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// File name without extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it shows.
    pub explanation: String,
    /// The technique it belongs to.
    pub technique: String,
    /// Format of color target 0.
    pub format: String,
    /// The draws, in order.
    pub draws: Vec<DrawReport>,
    /// The models, `exact` first.
    pub models: Vec<ModelReport>,
    /// What it should have looked like, if the scene asks for that.
    pub reference: Option<ReferenceReport>,
}

/// The reference a scene asks for, in the `exact` model.
#[derive(Clone, Debug, Serialize)]
pub struct ReferenceReport {
    /// How `exact`'s target 0 differs from it, in codes.
    pub difference: Difference,
    /// The picture, color target 0.
    #[serde(skip)]
    pub picture: Picture,
}

/// One scene in one model.
#[derive(Clone, Debug, Serialize)]
pub struct ModelReport {
    /// The model's name.
    pub model: String,
    /// How its target differs from `exact`'s, in codes.
    pub difference: Difference,
    /// Fragments merged.
    pub fragments: u64,
    /// Time of the planned merger per fragment, in nanoseconds.
    pub ns_per_fragment: f64,
    /// The picture, color target 0.
    #[serde(skip)]
    pub picture: Picture,
    /// Where and how much it differs from `exact`.
    #[serde(skip)]
    pub heat_map: Picture,
}

/// One model over all scenes.
#[derive(Clone, Debug, Serialize)]
pub struct ModelSummary {
    /// The model's name.
    pub model: String,
    /// Scenes it rendered.
    pub scenes: usize,
    /// How it differs from `exact`.
    pub difference: Difference,
    /// Time of the planned merger per fragment, in nanoseconds.
    pub ns_per_fragment: f64,
}

/// A scene that could not be compared.
#[derive(Debug, thiserror::Error)]
#[error("scene `{scene}`: {source}")]
pub struct ReportError {
    /// The scene.
    pub scene: String,
    /// Why; boxed, as scene errors are large.
    pub source: Box<SceneError>,
}

/// Renders each scene in every model that covers its targets, and compares each with the first model, the yardstick.
///
/// `done` is called after each scene, from any thread.
///
/// # Errors
/// [`ReportError`] for the first scene that cannot be rendered.
pub fn compare(
    scenes: &[(String, Scene)],
    models: &[&dyn NumericModel],
    done: &(dyn Fn() + Sync),
) -> Result<Vec<SceneReport>, ReportError> {
    let one = |(name, scene): &(String, Scene)| {
        let report = compare_scene(name, scene, models)
            .map_err(|source| ReportError { scene: name.clone(), source: Box::new(source) });
        done();
        report
    };
    scenes.par_iter().map(one).collect()
}

fn compare_scene(name: &str, scene: &Scene, models: &[&dyn NumericModel]) -> Result<SceneReport, SceneError> {
    let covers = |model: &&&dyn NumericModel| {
        scene.draws().iter().all(|draw| {
            draw.state.targets.iter().flatten().all(|target| {
                let format = crate::format::ColorFormat::new(target.format);
                format.is_ok_and(|format| model.supports(format, target.blend.as_ref()).is_ok())
            })
        })
    };
    let covering: Vec<&dyn NumericModel> = models.iter().filter(covers).copied().collect();
    let rendered = scene.render_models(&covering)?;
    let yardstick = &rendered[0];
    Ok(SceneReport {
        name: name.to_owned(),
        title: scene.title.clone(),
        explanation: scene.explanation.trim().to_owned(),
        technique: scene.technique.clone(),
        format: scene.target.colors[0].format.name().to_owned(),
        draws: yardstick.draws.clone(),
        models: rendered.iter().map(|r| model_report(scene, r, yardstick)).collect(),
        reference: match scene.reference {
            Some(Reference::Sorted) => reference_report(scene, yardstick)?,
            None => None,
        },
    })
}

fn reference_report(scene: &Scene, yardstick: &Rendered) -> Result<Option<ReferenceReport>, SceneError> {
    let sorted = scene.render_sorted_per_pixel(&Exact::default())?;
    let first = |framebuffer: &Framebuffer| framebuffer.colors.first().cloned().flatten();
    let pair = first(&sorted).zip(first(&yardstick.framebuffer));
    Ok(pair.map(|(sorted, drawn)| ReferenceReport {
        difference: Differences::between(&drawn, &sorted).summary(),
        picture: Picture::of_color(&sorted, scene.target.display, PictureAlpha::Opaque),
    }))
}

fn model_report(scene: &Scene, rendered: &Rendered, yardstick: &Rendered) -> ModelReport {
    let mut all = Difference::default();
    for pair in rendered.framebuffer.colors.iter().zip(&yardstick.framebuffer.colors) {
        if let (Some(mine), Some(exact)) = pair {
            all.absorb(&Differences::between(mine, exact).summary());
        }
    }
    let first = rendered.framebuffer.colors.first().and_then(Option::as_ref);
    let exact = yardstick.framebuffer.colors.first().and_then(Option::as_ref);
    let empty = || Picture { width: 0, height: 0, rgba: Vec::new() };
    ModelReport {
        model: rendered.model.clone(),
        difference: all,
        fragments: rendered.fragments,
        ns_per_fragment: per_fragment(rendered.merge_time, rendered.fragments),
        picture: first.map_or_else(empty, |t| Picture::of_color(t, scene.target.display, PictureAlpha::Opaque)),
        heat_map: first.zip(exact).map_or_else(empty, |(mine, exact)| Differences::between(mine, exact).heat_map()),
    }
}

/// Nanoseconds a fragment; 0 without fragments.
fn per_fragment(time: Duration, fragments: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count far below 2^53")]
    let count = fragments as f64;
    if fragments == 0 { 0.0 } else { time.as_secs_f64() * 1e9 / count }
}

/// Each model over all scenes, in the models' order.
#[must_use]
pub fn summarize(scenes: &[SceneReport]) -> Vec<ModelSummary> {
    let mut rows: Vec<(ModelSummary, f64, u64)> = Vec::new();
    for report in scenes.iter().flat_map(|scene| &scene.models) {
        let index = rows.iter().position(|(row, ..)| row.model == report.model).unwrap_or_else(|| {
            let row = ModelSummary {
                model: report.model.clone(),
                scenes: 0,
                difference: Difference::default(),
                ns_per_fragment: 0.0,
            };
            rows.push((row, 0.0, 0));
            rows.len() - 1
        });
        let (row, time, fragments) = &mut rows[index];
        row.scenes += 1;
        row.difference.absorb(&report.difference);
        #[expect(clippy::cast_precision_loss, reason = "a count far below 2^53")]
        let count = report.fragments as f64;
        *time += report.ns_per_fragment * count;
        *fragments += report.fragments;
    }
    let finish = |(mut row, time, fragments): (ModelSummary, f64, u64)| {
        row.ns_per_fragment = per_fragment(Duration::from_secs_f64(time / 1e9), fragments);
        row
    };
    rows.into_iter().map(finish).collect()
}

/// The summary as an aligned table.
#[must_use]
pub fn table(rows: &[ModelSummary]) -> String {
    let mut text = format!(
        "{:<10} {:>6} {:>10} {:>10} {:>16} {:>12}\n",
        "model", "scenes", "max error", "mean error", "pixels differing", "ns/fragment"
    );
    for row in rows {
        let d = &row.difference;
        text.push_str(&format!(
            "{:<10} {:>6} {:>10} {:>10.5} {:>15.3}% {:>12.1}\n",
            row.model,
            row.scenes,
            d.max_codes,
            d.mean_codes(),
            d.percent_differing(),
            row.ns_per_fragment
        ));
    }
    text
}
