//! The report's section on scenes drawn by a device.

use maud::{Markup, html};

use super::DeviceSection;
#[cfg(feature = "gpu")]
use super::{DeviceOutcome, DeviceReport, DeviceScene};
#[cfg(feature = "gpu")]
use crate::report::html::image;

/// The section.
///
/// # Errors
/// When a picture cannot be encoded as PNG.
pub fn section(device: &DeviceSection) -> Result<Markup, image::ImageError> {
    let content = match device {
        DeviceSection::NotRun { reason } => html! { p { b { "Not run: " } (reason) "." } },
        #[cfg(feature = "gpu")]
        DeviceSection::Run(report) => content(report)?,
    };
    Ok(html! { section #device { h2 { "Drawn by a device" } (content) } })
}

#[cfg(feature = "gpu")]
fn content(report: &DeviceReport) -> Result<Markup, image::ImageError> {
    let figures = report.scenes.iter().map(figure).collect::<Result<Vec<_>, _>>()?;
    let all = &report.all;
    Ok(html! {
        p { "The same scenes, rasterised and shaded in WGSL by " (report.adapter) ", compared with " code { (report.model) }
            ". Shader arithmetic and texture filters differ in the last bits, and so does interpolation where the \
             driver's rasteriser is not modelled, so some fragments do; where all fragments of a pixel are alike, so \
             must the stored colors be, and the device's own fragments must merge as the model merges them." }
        table {
            tbody {
                (count("pixels", all.texels))
                (count("covered differently", all.texels_covered_differently))
                (count("all fragments alike, bit for bit", all.texels_alike))
                (count("of these, stored differently", all.alike_but_stored_differently))
                (count("stored differently than the model merges the device's fragments", all.merged_differently))
                (count("stored differently than in the model's picture", all.stored_differently))
                (count("fragments", all.fragments))
                (count("with other output colors", all.outputs_differing))
                (count("discarded by one side alone", all.discarded_differently))
            }
        }
        details {
            summary { "Each scene: the device's picture, and where it differs from the model's" }
            div.figures { @for figure in &figures { (figure) } }
        }
    })
}

#[cfg(feature = "gpu")]
fn count(name: &str, value: u64) -> Markup {
    html! { tr { th scope="row" { (name) } td { (value) } } }
}

#[cfg(feature = "gpu")]
fn figure(scene: &DeviceScene) -> Result<Markup, image::ImageError> {
    let (pictures, caption) = match &scene.outcome {
        Err(reason) => (html! {}, html! { " not drawn: " (reason) }),
        Ok(outcome) => {
            let picture = image(&outcome.picture, &format!("{} drawn by the device", scene.name))?;
            let heat_map = image(&outcome.heat_map, &format!("where {} differs from the model", scene.name))?;
            (html! { div.pair { (picture) (heat_map) } }, caption(outcome))
        }
    };
    Ok(html! {
        figure { (pictures) figcaption { b { a href={"#" (scene.name)} { (scene.title) } } (caption) } }
    })
}

#[cfg(feature = "gpu")]
fn caption(outcome: &DeviceOutcome) -> Markup {
    let (agreement, difference) = (&outcome.agreement, &outcome.difference);
    let codes = if difference.max_codes == 1 { "1 code".to_owned() } else { format!("{} codes", difference.max_codes) };
    html! {
        @if agreement.texels_covered_differently == 0 { " covered alike" }
        @else { " " (agreement.texels_covered_differently) " pixels covered differently" }
        ", " (agreement.outputs_differing) " of " (agreement.fragments) " fragments with other colors"
        @if agreement.largest_output > 0.0 { " (by at most " (format!("{:.0e}", agreement.largest_output)) ")" }
        ", "
        @if difference.pixels_differing == 0 { "every stored byte equal" }
        @else { (difference.pixels_differing) " pixels stored differently, at most " (codes) }
    }
}
