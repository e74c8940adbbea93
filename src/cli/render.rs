//! `outmerge render`: one scene, one picture.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Outcome, output};
use crate::analysis::trap::{self, Caught, Place, Search, Trap};
use crate::model::{NumericModel, registry};
use crate::scene::{Picture, PictureAlpha, Scene};
use crate::verdict::Verdict;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub(super) struct Render {
    /// A scene file (.toml or .json), or the name of a bundled scene (see `outmerge scenes`).
    scene: String,
    /// The PNG to write; `-` is stdout.
    #[arg(long, short, required_unless_present = "trap")]
    output: Option<PathBuf>,
    /// The numeric model.
    #[arg(long, short, default_value = "exact")]
    model: String,
    /// Color target to show.
    #[arg(long, default_value_t = 0)]
    target: usize,
    /// Show the depth target instead, near black to far white.
    #[arg(long, conflicts_with = "target")]
    depth: bool,
    /// Keep the target's alpha in the PNG instead of showing it opaque.
    #[arg(long)]
    alpha: bool,
    /// Merge with the reference, which leaves nothing out, instead of as planned; the picture is the same.
    #[arg(long, conflicts_with = "trap")]
    reference: bool,
    /// Instead of a picture, find the first fragment with a NaN, an infinity or a value that a clamp changes; exit with
    /// status 1 if there is one.
    #[arg(long, value_enum, value_delimiter = ',', conflicts_with = "output")]
    trap: Vec<Trap>,
    /// Print what was trapped as JSON.
    #[arg(long, requires = "trap")]
    json: bool,
}

/// What was trapped, as JSON has it.
#[derive(serde::Serialize)]
struct Found {
    verdict: Verdict,
    /// Fragments looked at.
    fragments: usize,
    caught: Option<Caught>,
}

/// A scene by file name or bundled name.
pub(super) fn load(name: &str) -> Result<Scene, Failure> {
    if let Some(scene) = Scene::bundled_by_name(name) {
        return Ok(scene?);
    }
    let path = Path::new(name);
    if path.extension().is_none() && !path.exists() {
        let names: Vec<&str> = Scene::bundled().map(|(name, _)| name).collect();
        return Err(format!("no file and no bundled scene `{name}`; bundled are: {}", names.join(", ")).into());
    }
    Ok(Scene::load_within(path, super::limits::get())?)
}

impl Render {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let scene = load(&self.scene)?;
        if !self.trap.is_empty() {
            return self.find(&scene, model.as_ref());
        }
        // A plan may leave the depth target out; who asks for it wants it all the same.
        let whole = self.reference || self.depth;
        let rendered = if whole { scene.render_reference(model.as_ref())? } else { scene.render(model.as_ref())? };
        let picture = if self.depth {
            let target = rendered.framebuffer.depth_stencil.as_ref();
            target.and_then(Picture::of_depth).ok_or("the scene has no depth target")?
        } else {
            let alpha = if self.alpha { PictureAlpha::Stored } else { PictureAlpha::Opaque };
            let colors = &rendered.framebuffer.colors;
            let target = colors.get(self.target).and_then(Option::as_ref);
            let target = target.ok_or_else(|| {
                format!("the scene has no color target {}; it has {}, counted from 0", self.target, colors.len())
            })?;
            Picture::of_color(target, scene.target.display, alpha)
        };
        let png = picture.to_png()?;
        let path = self.output.as_deref().ok_or("give the PNG to write: -o FILE")?;
        output::write_file(path, |file| Ok(file.write_all(&png)?))?;
        Ok(Outcome::Done)
    }

    fn find(&self, scene: &Scene, model: &dyn NumericModel) -> Result<Outcome, Failure> {
        let Search { fragments, caught } = trap::find(scene, model, &self.trap)?;
        let verdict = Verdict::of_search(caught.is_some(), fragments);
        let outcome = Outcome::Judged(verdict);
        if self.json {
            output::print_json("trap", &Found { verdict, fragments, caught })?;
            return Ok(outcome);
        }
        output::print(&caught.map_or("nothing was trapped\n".to_owned(), |caught| description(&caught)))?;
        Ok(outcome)
    }
}

/// What was caught, in words.
fn description(caught: &Caught) -> String {
    let name = match caught.trap {
        Trap::Nan => "a NaN",
        Trap::Inf => "an infinity",
        Trap::Clamp => "a value out of range",
    };
    let channel = ["R", "G", "B", "A"].get(caught.channel).copied().unwrap_or("?");
    let place = match caught.place {
        Place::Source => format!("the shader's output {}, {channel}", caught.target),
        Place::Depth => "the fragment's depth".to_owned(),
        Place::Result => format!("the blend's result on target {}, {channel}", caught.target),
        Place::Stored => format!("the value stored in target {}, {channel}", caught.target),
    };
    let mut text = format!(
        "{name} at pixel ({}, {}) in draw {} ({}): {place} is {}\n",
        caught.x,
        caught.y,
        caught.draw + 1,
        caught.label,
        caught.value
    );
    if let Some(blend) = &caught.blend {
        for (name, values) in [("source", &blend.source), ("before", &blend.before), ("after", &blend.after)] {
            text.push_str(&format!("  {name:<7}{}\n", values.join(", ")));
        }
    }
    text
}
