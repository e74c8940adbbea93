//! `outmerge models`, `formats`, `scenes` and `presets`: what there is.

use clap::Args;
use serde::Serialize;

use super::{Failure, Outcome, output};
use crate::format::{ColorFormat, layout::FORMATS};
use crate::model::registry;
use crate::scene::Scene;
use crate::state::{preset::PRESETS, spelling};

/// Arguments of `models`.
#[derive(Debug, Args)]
pub(super) struct Models {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `formats`.
#[derive(Debug, Args)]
pub(super) struct Formats {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `scenes`.
#[derive(Debug, Args)]
pub(super) struct Scenes {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `presets`.
#[derive(Debug, Args)]
pub(super) struct Presets {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Row {
    name: String,
    about: String,
}

/// As JSON has it.
#[derive(Serialize)]
struct Listing<'a> {
    of: &'a str,
    entries: Vec<Row>,
}

/// Prints names and descriptions, aligned, or as JSON.
fn show(of: &str, rows: Vec<Row>, json: bool) -> Result<Outcome, Failure> {
    if json {
        output::print_json("list", &Listing { of, entries: rows })?;
    } else {
        let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
        let text: String = rows.iter().map(|row| format!("{:width$}  {}\n", row.name, row.about)).collect();
        output::print(&text)?;
    }
    Ok(Outcome::Done)
}

impl Models {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut rows = Vec::new();
        for name in registry::NAMES {
            let model = registry::by_name(name)?;
            rows.push(Row { name: model.name(), about: model.provenance().to_owned() });
        }
        show("models", rows, self.json)
    }
}

impl Formats {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut rows = Vec::new();
        for (name, format) in FORMATS {
            let format = ColorFormat::new(format)?;
            let bits: Vec<String> =
                format.channels().iter().filter(|c| c.bits() > 0).map(|c| c.bits().to_string()).collect();
            let about = format!("{} bytes a texel, {} bits", format.bytes_per_texel(), bits.join("+"));
            rows.push(Row { name: name.to_owned(), about });
        }
        show("formats", rows, self.json)
    }
}

impl Scenes {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut rows = Vec::new();
        for (name, scene) in Scene::bundled() {
            let scene = scene?;
            rows.push(Row { name: name.to_owned(), about: format!("{} ({})", scene.title, scene.technique) });
        }
        show("scenes", rows, self.json)
    }
}

impl Presets {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let component = |c: &wgpu_types::BlendComponent| {
            let (src, dst) = (spelling::factor_name(c.src_factor), spelling::factor_name(c.dst_factor));
            format!("{} {src} {dst}", spelling::operation_name(c.operation))
        };
        let row = |preset: &crate::state::preset::Preset| {
            let state = match &preset.blend {
                None => "blending off".to_owned(),
                Some(blend) if blend.color == blend.alpha => component(&blend.color),
                Some(blend) => format!("{}, alpha {}", component(&blend.color), component(&blend.alpha)),
            };
            Row {
                name: preset.name.to_owned(),
                about: format!("{state}; {}; {}", preset.about, preset.known_as.join(", ")),
            }
        };
        show("presets", PRESETS.iter().map(row).collect(), self.json)
    }
}
