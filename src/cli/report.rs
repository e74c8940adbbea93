//! `outmerge report`: the main job. Every scene in every model: a table, and one HTML page.

use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output, render};
use crate::model::{NumericModel, registry};
use crate::report::section::{self, Section};
use crate::report::{self, device::DeviceSection};
use crate::scene::Scene;

/// Arguments of `report`.
#[derive(Debug, Args)]
pub(super) struct Report {
    /// Folder to write `index.html` and `report.json` to; made if missing.
    #[arg(long, short)]
    output: PathBuf,
    /// Scenes, by file or bundled name; all bundled ones unless given.
    scenes: Vec<String>,
    /// Numeric models beside `exact`, comma separated; all unless given.
    #[arg(long, short, value_delimiter = ',')]
    models: Vec<String>,
    /// Add the analyses also when scenes are named; with all scenes they are always there.
    #[arg(long)]
    analyses: bool,
    /// Print the report as JSON instead of the table.
    #[arg(long)]
    json: bool,
    /// Draw the scenes on this device too, by part of its name or driver; the first one unless given.
    #[cfg(feature = "gpu")]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Draw on no device.
    #[cfg(feature = "gpu")]
    #[arg(long, conflicts_with = "adapter")]
    no_device: bool,
}

/// A progress bar over scenes or analyses, on stderr.
fn progress(scenes: usize, doing: &'static str) -> Result<ProgressBar, Failure> {
    let style = ProgressStyle::with_template("{prefix} {bar:40} {pos}/{len} {elapsed}")?;
    Ok(ProgressBar::new(scenes as u64).with_style(style).with_prefix(doing))
}

impl Report {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        #[cfg(feature = "gpu")]
        if !self.no_device {
            crate::crosscheck::adapter::reexec_without_shader_cache()?;
        }
        let models = self.models()?;
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let scenes = self.scenes()?;
        std::fs::create_dir_all(&self.output)
            .map_err(|error| format!("cannot make the folder {}: {error}", self.output.display()))?;

        let bar = progress(scenes.len(), "rendering scenes")?;
        let reports = report::compare(&scenes, &models, &|| bar.inc(1))?;
        bar.finish_and_clear();

        let device = self.device(&scenes)?;
        let analyses = self.analyses(&models)?;
        let rows = report::summarize(&reports);
        let page = report::html::page(&reports, &rows, &device, &analyses, "outmerge report")?;
        let index = self.output.join("index.html");
        output::write_file(&index, |file| Ok(file.write_all(page.as_bytes())?))?;
        let data = serde_json::json!({ "models": rows, "device": device, "analyses": analyses, "scenes": reports });
        let json = output::json("report", &data)?;
        output::write_file(&self.output.join("report.json"), |file| Ok(file.write_all(json.as_bytes())?))?;
        if self.json {
            output::print(&json)?;
        } else {
            output::print(&format!("{}\n{device}\n", report::table(&rows)))?;
            output::complain(&format!("wrote {}", index.display()));
        }
        Ok(Outcome::Done)
    }

    #[cfg(not(feature = "gpu"))]
    #[expect(
        clippy::unnecessary_wraps,
        clippy::unused_self,
        reason = "with the feature `gpu` it reads both and may fail"
    )]
    fn device(&self, _: &[(String, Scene)]) -> Result<DeviceSection, Failure> {
        let reason = "this outmerge was built without the feature `gpu`; build it with --all-features".to_owned();
        Ok(DeviceSection::NotRun { reason })
    }

    /// What the device makes of the scenes. Only a device that was asked for by name must be there.
    #[cfg(feature = "gpu")]
    fn device(&self, scenes: &[(String, Scene)]) -> Result<DeviceSection, Failure> {
        use crate::crosscheck::{Device, OpenOptions};
        if self.no_device {
            return Ok(DeviceSection::NotRun { reason: "--no-device was given".to_owned() });
        }
        match Device::open(&OpenOptions { adapter: self.adapter.clone(), ..OpenOptions::default() }) {
            Ok(device) => {
                let bar = progress(scenes.len(), "drawing scenes")?;
                let report = report::device::draw(&device, scenes, &|| bar.inc(1));
                bar.finish_and_clear();
                Ok(DeviceSection::Run(Box::new(report)))
            }
            Err(error) if self.adapter.is_some() => Err(error.into()),
            Err(error) => Ok(DeviceSection::NotRun { reason: error.to_string() }),
        }
    }

    fn analyses(&self, models: &[&dyn NumericModel]) -> Result<Vec<Section>, Failure> {
        if !self.scenes.is_empty() && !self.analyses {
            return Ok(Vec::new());
        }
        let bar = progress(section::COUNT, "analysing")?;
        bar.tick();
        let sections = section::all(models, &|| bar.inc(1))?;
        bar.finish_and_clear();
        Ok(sections)
    }

    /// The models, `exact` first.
    fn models(&self) -> Result<Vec<Box<dyn NumericModel>>, Failure> {
        if self.models.is_empty() {
            return Ok(registry::all());
        }
        let names = std::iter::once("exact").chain(self.models.iter().map(String::as_str).filter(|n| *n != "exact"));
        Ok(names.map(registry::by_name).collect::<Result<_, _>>()?)
    }

    fn scenes(&self) -> Result<Vec<(String, Scene)>, Failure> {
        if self.scenes.is_empty() {
            return Scene::bundled().map(|(name, scene)| Ok((name.to_owned(), scene?))).collect();
        }
        let stem = |name: &String| {
            let path = std::path::Path::new(name);
            path.file_stem().map_or_else(|| name.clone(), |stem| stem.to_string_lossy().into_owned())
        };
        self.scenes.iter().map(|name| Ok((stem(name), render::load(name)?))).collect()
    }
}
