//! `outmerge report`: the main job. Every scene in every model: a table, and one HTML page.

use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output, render};
use crate::model::{NumericModel, registry};
use crate::report;
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
    /// Print the report as JSON instead of the table.
    #[arg(long)]
    json: bool,
}

impl Report {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let models = self.models()?;
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let scenes = self.scenes()?;
        std::fs::create_dir_all(&self.output)
            .map_err(|error| format!("cannot make the folder {}: {error}", self.output.display()))?;

        let bar = ProgressBar::new(scenes.len() as u64)
            .with_style(ProgressStyle::with_template("rendering {bar:40} {pos}/{len} scenes {elapsed}")?);
        let reports = report::compare(&scenes, &models, &|| bar.inc(1))?;
        bar.finish_and_clear();

        let rows = report::summarize(&reports);
        let page = report::html::page(&reports, &rows, "outmerge report")?;
        let index = self.output.join("index.html");
        output::write_file(&index, |file| Ok(file.write_all(page.as_bytes())?))?;
        let data = serde_json::json!({ "version": 1, "models": rows, "scenes": reports });
        let json = serde_json::to_string_pretty(&data)?;
        output::write_file(&self.output.join("report.json"), |file| Ok(writeln!(file, "{json}")?))?;
        if self.json {
            output::print(&format!("{json}\n"))?;
        } else {
            output::print(&report::table(&rows))?;
            eprintln!("wrote {}", index.display());
        }
        Ok(Outcome::Fine)
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
