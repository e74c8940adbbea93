//! Scenes drawn by a device itself, compared with the model; or why none were drawn.

pub mod page;

use serde::Serialize;

use crate::verdict::Verdict;

#[cfg(feature = "gpu")]
use crate::{
    crosscheck::Device,
    crosscheck::drawn::{Agreement, Drawer, Drawn},
    crosscheck::raster::of_llvmpipe_here,
    model::{NumericModel, exact::Exact},
    report::difference::{Difference, Differences},
    scene::raster::Rasteriser,
    scene::{Picture, PictureAlpha, Scene},
};
#[cfg(feature = "gpu")]
use rayon::prelude::*;

/// What the report has of a device.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceSection {
    /// No scene was drawn.
    NotRun {
        /// Why, and what to do about it.
        reason: String,
    },
    /// The device drew the scenes.
    #[cfg(feature = "gpu")]
    Run(Box<DeviceReport>),
}

impl std::fmt::Display for DeviceSection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotRun { reason } => write!(f, "drawn by a device: {}: {reason}", Verdict::NotRun),
            #[cfg(feature = "gpu")]
            Self::Run(report) => {
                let all = &report.all;
                write!(
                    f,
                    "drawn by {} ({}; compared with {}): of {} pixels {} covered differently; {} alike in every fragment, of these {} stored \
                     differently; {} stored differently in all",
                    report.adapter,
                    report.driver,
                    report.model,
                    all.texels,
                    all.texels_covered_differently,
                    all.texels_alike,
                    all.alike_but_stored_differently,
                    all.stored_differently
                )
            }
        }
    }
}

/// What a device made of the scenes.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Serialize)]
pub struct DeviceReport {
    /// The device and its driver.
    pub adapter: String,
    /// Driver, version, processor: what the bytes depend on.
    pub driver: crate::vectors::DriverRecord,
    /// The model it is compared with: that of its driver, or `exact` where there is none.
    pub model: String,
    /// All scenes together.
    pub all: Agreement,
    /// The scenes.
    pub scenes: Vec<DeviceScene>,
}

/// One scene on a device.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Serialize)]
pub struct DeviceScene {
    /// File name without extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// What came of it, or why the device could not draw it.
    pub outcome: Result<DeviceOutcome, String>,
}

/// A drawn scene.
#[cfg(feature = "gpu")]
#[derive(Clone, Debug, Serialize)]
pub struct DeviceOutcome {
    /// Coverage, fragments and stored colors.
    pub agreement: Agreement,
    /// Stored colors of all targets, in codes.
    pub difference: Difference,
    /// The device's picture, color target 0.
    #[serde(skip)]
    pub picture: Picture,
    /// Where and how much it differs from the model's.
    #[serde(skip)]
    pub heat_map: Picture,
}

/// Draws each scene on `device` and compares it with the model.
///
/// `done` is called after each scene, from any thread.
#[cfg(feature = "gpu")]
#[must_use]
pub fn draw(device: &Device, scenes: &[(String, Scene)], done: &(dyn Fn() + Sync)) -> DeviceReport {
    let (model, rasteriser, subpixel_bits) = modelled(device);
    let by_its_rules = |(name, scene): &(String, Scene)| {
        let mut scene = scene.clone();
        scene.target.subpixel_bits = subpixel_bits;
        scene.target.rasteriser = rasteriser;
        (name.clone(), scene)
    };
    let scenes: &Vec<_> = &scenes.iter().map(by_its_rules).collect();
    let mut drawer = Drawer::new(device);
    let drawn: Vec<_> = scenes.iter().map(|(_, scene)| drawer.draw(scene).map_err(|error| error.to_string())).collect();
    let one = |((name, scene), drawn): (&(String, Scene), Result<Drawn, String>)| {
        let outcome = drawn.and_then(|drawn| outcome(scene, &drawn, model.as_ref()));
        done();
        DeviceScene { name: name.clone(), title: scene.title.clone(), outcome }
    };
    let scenes: Vec<_> = scenes.par_iter().zip(drawn).map(one).collect();
    let mut all = Agreement::default();
    scenes.iter().filter_map(|scene| scene.outcome.as_ref().ok()).for_each(|outcome| all.absorb(&outcome.agreement));
    let driver = device.report().record();
    DeviceReport { adapter: device.report().to_string(), driver, model: model.name(), all, scenes }
}

/// The model of a device's driver and its rasteriser, `exact` and the reference for drivers without one, and the driver's
/// `subPixelPrecisionBits`, which wgpu does not tell.
#[cfg(feature = "gpu")]
fn modelled(device: &Device) -> (Box<dyn NumericModel>, Rasteriser, u8) {
    let llvmpipe = device.report().drivers().llvmpipe;
    match device.report().name.as_str() {
        name if name.contains("llvmpipe") => (Box::new(llvmpipe), of_llvmpipe_here(llvmpipe.generation), 8),
        name if name.contains("SwiftShader") => {
            (Box::new(device.report().drivers().swiftshader), Rasteriser::Reference, 4)
        }
        _ => (Box::new(Exact::default()), Rasteriser::Reference, 8),
    }
}

#[cfg(feature = "gpu")]
fn outcome(scene: &Scene, drawn: &Drawn, model: &dyn NumericModel) -> Result<DeviceOutcome, String> {
    let agreement = Agreement::of(scene, drawn, model).map_err(|error| error.to_string())?;
    let expected = scene.render(model).map_err(|error| error.to_string())?.framebuffer;
    let pairs = drawn.framebuffer.colors.iter().flatten().zip(expected.colors.iter().flatten());
    let differences: Vec<_> = pairs.map(|(device, model)| Differences::between(device, model)).collect();
    let mut difference = Difference::default();
    differences.iter().for_each(|part| difference.absorb(&part.summary()));
    let empty = || Picture { width: 0, height: 0, rgba: Vec::new() };
    let first = drawn.framebuffer.colors.iter().flatten().next();
    let picture = first.map_or_else(empty, |t| Picture::of_color(t, scene.target.display, PictureAlpha::Opaque));
    let heat_map = differences.first().map_or_else(empty, Differences::heat_map);
    Ok(DeviceOutcome { agreement, difference, picture, heat_map })
}
