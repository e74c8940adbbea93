//! `outmerge render`: one scene, one picture.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Outcome, output};
use crate::model::registry;
use crate::scene::{Picture, PictureAlpha, Scene};

/// Arguments of `render`.
#[derive(Debug, Args)]
pub(super) struct Render {
    /// A scene file (.toml or .json), or the name of a bundled scene (see `outmerge scenes`).
    scene: String,
    /// The PNG to write; `-` is stdout.
    #[arg(long, short)]
    output: PathBuf,
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
    Ok(Scene::load(path)?)
}

impl Render {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let model = registry::by_name(&self.model)?;
        let scene = load(&self.scene)?;
        let rendered = scene.render(model.as_ref())?;
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
        output::write_file(&self.output, |file| Ok(file.write_all(&png)?))?;
        Ok(Outcome::Fine)
    }
}
