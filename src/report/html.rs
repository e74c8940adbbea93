//! The report as one HTML page: pictures inside, no script, nothing fetched.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::device::{self, DeviceSection};
use super::difference::LEGEND;
use super::section::{Section, page, texture};
use super::{ModelReport, ModelSummary, ReferenceReport, SceneReport};
use crate::scene::Picture;
use crate::scene::queue::RenderQueue;

/// The page's style sheet.
const STYLE: &str = include_str!("style.css");

/// The whole page.
///
/// # Errors
/// When a picture cannot be encoded as PNG, or a chart not be drawn.
pub fn page(
    scenes: &[SceneReport],
    rows: &[ModelSummary],
    device: &DeviceSection,
    analyses: &[Section],
    command: &str,
) -> Result<String, Box<dyn std::error::Error>> {
    let device = device::page::section(device)?;
    let analyses = analyses.iter().map(|section| Ok((section, page::section(section)?)));
    let analyses = analyses.collect::<Result<Vec<_>, Box<dyn std::error::Error>>>()?;
    let groups = scenes.chunk_by(|a, b| a.technique == b.technique);
    let sections = groups.map(|scenes| group(scenes, measured(scenes, &analyses))).collect::<Result<Vec<_>, _>>()?;
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "outmerge report" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "outmerge report" }
                    p { "What bytes must the GPU write here, and why? Every bundled scene in every numeric model, compared \
                         with " code { "exact" } ": real arithmetic and one correct rounding at each store." }
                    p.command { "Made by " code { (command) } ", outmerge " (env!("CARGO_PKG_VERSION")) "." }
                }
                main {
                    section {
                        h2 { "All scenes" }
                        (summary(rows))
                        p.note { "Errors are in codes of the target: integers stored for normalised formats, representable \
                                  numbers for floats. Times are of the merger as planned, on this machine." }
                    }
                    @if !analyses.is_empty() {
                        nav { @for (section, _) in &analyses { a href={"#" (section.id)} { (section.title) } } }
                        @for (_, markup) in &analyses { (markup) }
                        h2 { "Scenes" }
                    }
                    nav { @for scene in scenes { a href={"#" (scene.name)} { (scene.title) } } }
                    (legend())
                    (device)
                    @for section in &sections { (section) }
                }
            }
        }
    };
    Ok(markup.into_string())
}

fn summary(rows: &[ModelSummary]) -> Markup {
    html! {
        table {
            thead { tr {
                th { "model" } th { "scenes" } th { "max error" } th { "mean error" } th { "pixels differing" }
                th { "ns per fragment" }
            } }
            tbody { @for row in rows { tr {
                th scope="row" { (row.model) }
                td { (row.scenes) }
                td { (row.difference.max_codes) }
                td { (format!("{:.5}", row.difference.mean_codes())) }
                td { (format!("{:.3} %", row.difference.percent_differing())) }
                td { (format!("{:.0}", row.ns_per_fragment)) }
            } } }
        }
    }
}

/// What the heat maps' colors mean.
fn legend() -> Markup {
    html! {
        p.legend {
            "Heat maps, the largest difference of a pixel's channels: "
            @for (_, [r, g, b], name) in LEGEND {
                span.swatch style=(format!("background:rgb({r},{g},{b})")) {} (name) " "
            }
        }
    }
}

/// The section that measures what these scenes show, if the page has one.
fn measured<'a>(scenes: &[SceneReport], analyses: &[(&'a Section, Markup)]) -> Option<&'a Section> {
    let shown = scenes.first().is_some_and(|scene| scene.technique == texture::TECHNIQUE);
    analyses.iter().map(|(section, _)| *section).find(|section| shown && section.id == texture::ID)
}

/// The scenes of one technique: side by side if there are several, then one by one.
fn group(scenes: &[SceneReport], measured: Option<&Section>) -> Result<Markup, image::ImageError> {
    let sections = scenes.iter().map(section).collect::<Result<Vec<_>, _>>()?;
    let mut pictures = Vec::new();
    for scene in scenes {
        let model = scene.models.first().map(|model| image(&model.picture, &scene.title)).transpose()?;
        pictures.push((model, html! { a href={"#" (scene.name)} { (scene.title) } }));
    }
    let technique = scenes.first().map_or("", |scene| scene.technique.as_str());
    Ok(html! {
        @if scenes.len() > 1 { section {
            h2 { (technique.replace('-', " ")) ", side by side" }
            div.figures { @for (picture, title) in &pictures { figure.single { @if let Some(picture) = picture { (picture) } figcaption { (title) } } } }
            @if let Some(section) = measured { p { "In numbers: " a href={"#" (section.id)} { (section.title) } } }
        } }
        @for section in &sections { (section) }
    })
}

fn section(scene: &SceneReport) -> Result<Markup, image::ImageError> {
    let exact = scene.models.first();
    let figures = scene.models.iter().map(figure).collect::<Result<Vec<_>, _>>()?;
    let fragments = exact.map_or(0, |model| model.fragments);
    let reference = scene.reference.as_ref().map(reference).transpose()?;
    Ok(html! {
        section #(scene.name) {
            h2 { (scene.title) " " small { (scene.technique) ", " (scene.format) } }
            p { (scene.explanation) }
            div.figures { @if let Some(reference) = &reference { (reference) } @for figure in &figures { (figure) } }
            details {
                summary { (scene.draws.len()) " draws, " (fragments) " fragments, in this order" }
                table {
                    thead { tr { th { "#" } th { "object" } th { "pass" } th { "queue" } th { "distance" } th { "shader evaluates" } } }
                    tbody { @for (i, draw) in scene.draws.iter().enumerate() { tr {
                        td { (i + 1) } th scope="row" { (draw.object) } td { (draw.pass) }
                        td { (draw.queue) " " (queue_name(draw.queue)) }
                        td { (format!("{:.3}", draw.distance)) } td { (draw.keywords.join(", ")) }
                    } } }
                }
            }
        }
    })
}

fn reference(reference: &ReferenceReport) -> Result<Markup, image::ImageError> {
    let wrong = reference.difference.pixels_differing;
    let picture = image(&reference.picture, "every pixel's fragments sorted")?;
    Ok(html! {
        figure.single {
            (picture)
            figcaption {
                b { "sorted per pixel" }
                @if wrong == 0 { " as drawn" } @else { " as it should be; drawn, " (wrong) " pixels differ" }
            }
        }
    })
}

fn figure(model: &ModelReport) -> Result<Markup, image::ImageError> {
    let d = &model.difference;
    let picture = image(&model.picture, &format!("rendered in {}", model.model))?;
    let heat_map = image(&model.heat_map, &format!("where {} differs from exact", model.model))?;
    Ok(html! {
        figure {
            div.pair { (picture) @if model.model != "exact" { (heat_map) } }
            figcaption {
                b { (model.model) }
                @if model.model == "exact" { " the yardstick" }
                @else if d.pixels_differing == 0 { " every byte as exact" }
                @else {
                    " " (format!("{:.2} %", d.percent_differing())) " of pixels differ, at most " (d.max_codes)
                    @if d.max_codes == 1 { " code" } @else { " codes" }
                }
            }
        }
    })
}

/// A queue's number as a name with an offset.
fn queue_name(number: u16) -> String {
    RenderQueue::new(number.into()).map_or_else(|_| String::new(), |queue| queue.to_string())
}

/// A picture as a data URI.
pub(super) fn image(picture: &Picture, alternative: &str) -> Result<Markup, image::ImageError> {
    let uri = format!("data:image/png;base64,{}", STANDARD.encode(picture.to_png()?));
    Ok(html! { img src=(uri) alt=(alternative) width=(picture.width) height=(picture.height); })
}
