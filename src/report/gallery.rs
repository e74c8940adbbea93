//! All scenes as a page of Markdown with one small picture each, side by side by technique.

use std::fmt::Write as _;

use super::difference::Differences;
use super::section;
use crate::model::exact::Exact;
use crate::model::registry;
use crate::scene::description::Reference;
use crate::scene::{Picture, PictureAlpha, Scene, SceneError};
use crate::target::Framebuffer;

/// Pictures in a row of the page.
const COLUMNS: usize = 4;

/// The page and its pictures.
#[derive(Clone, Debug)]
pub struct Gallery {
    /// The page, Markdown. Pictures are in the folder `gallery` beside it.
    pub page: String,
    /// File names and pictures.
    pub pictures: Vec<(String, Picture)>,
}

/// A picture of a scene and what the page calls it.
struct Shown {
    file: String,
    caption: String,
}

/// Where the numbers behind premultiplied storage are.
const TEXTURE_REPORT: &str = "In numbers, the texture report: `outmerge texture FILE.png` for any image, section \
                              *texture* of `outmerge report`, and the example [texture_report.rs](../examples/texture_report.rs).";

/// A scene's name without folder and ending: the first part of its pictures' file names.
#[must_use]
pub fn stem(name: &str) -> &str {
    let file = name.rsplit('/').next().unwrap_or(name);
    file.strip_suffix(".toml").unwrap_or(file)
}

/// Renders the scenes, by name or path, in the `exact` model and describes them, grouped by technique in the given
/// order.
///
/// # Errors
/// [`SceneError`] for the first scene that cannot be rendered.
pub fn gallery(scenes: &[(String, Scene)], command: &str) -> Result<Gallery, SceneError> {
    let mut page = format!(
        "# Gallery\n\nEvery bundled scene and, at the end, every scene of `examples/scenes`, rendered in the `exact` model. \
         Made by `{command}`; render one with `outmerge render NAME -o NAME.png`, see all models side by side with \
         `outmerge report -o DIR`.\n"
    );
    let mut pictures = Vec::new();
    for group in scenes.chunk_by(|(_, a), (_, b)| a.technique == b.technique) {
        let technique = group.first().map_or("", |(_, scene)| scene.technique.as_str());
        let _ = writeln!(page, "\n## {}\n", heading(technique));
        let mut shown = Vec::new();
        for (name, scene) in group {
            let stem = stem(name);
            for (suffix, caption, picture) in views(scene)? {
                let file = format!("{stem}{suffix}.png");
                shown.push(Shown { file: file.clone(), caption });
                pictures.push((file, picture));
            }
        }
        shown.chunks(COLUMNS).for_each(|row| table(&mut page, row));
        for (name, scene) in group {
            let _ = writeln!(page, "- **{}** (`{name}`): {}", scene.title, scene.explanation);
        }
        if technique == section::texture::TECHNIQUE {
            let _ = writeln!(page, "\n{TEXTURE_REPORT}");
        }
    }
    Ok(Gallery { page, pictures })
}

/// The pictures of one scene with their file suffixes and captions: its color targets, then its reference.
fn views(scene: &Scene) -> Result<Vec<(String, String, Picture)>, SceneError> {
    let picture = |framebuffer: &Framebuffer, index: usize| {
        let target = framebuffer.colors.get(index).and_then(Option::as_ref);
        target.map(|target| Picture::of_color(target, scene.target.display, PictureAlpha::Opaque))
    };
    let drawn = scene.render(&Exact::default())?.framebuffer;
    let mut views = Vec::new();
    for index in 0..drawn.colors.len() {
        let (suffix, caption) = if index == 0 {
            (String::new(), scene.title.clone())
        } else {
            (format!(".{index}"), format!("Target {index}"))
        };
        views.extend(picture(&drawn, index).map(|picture| (suffix, caption, picture)));
    }
    if scene.reference == Some(Reference::Sorted) {
        let sorted = scene.render_sorted_per_pixel(&Exact::default())?;
        let wrong = drawn.colors.iter().zip(&sorted.colors).flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| {
            let texels = |target: &crate::target::ColorTarget| target.format().bytes_per_texel();
            a.bytes().chunks_exact(texels(a)).zip(b.bytes().chunks_exact(texels(b))).filter(|(a, b)| a != b).count()
        });
        let caption = match wrong.sum::<usize>() {
            0 => "Sorted per pixel: the same".to_owned(),
            wrong => format!("Sorted per pixel: {wrong} pixels differ"),
        };
        views.extend(picture(&sorted, 0).map(|picture| (".sorted".to_owned(), caption, picture)));
    }
    Ok(views)
}

/// The bundled scene on the front page.
pub const HEADLINE_SCENE: &str = "alpha-smoothness-switch";

/// The models whose differences from `exact` the front page shows.
const HEADLINE_MODELS: [&str; 3] = ["f16", "fixed:8", "llvmpipe"];

/// Screen pixels a texel of the front page's picture takes.
const HEADLINE_SCALE: u32 = 2;

/// The front page's picture: a scene in `exact`, and beside it where each of some models stores another code.
///
/// # Errors
/// [`SceneError`] when the scene cannot be rendered.
pub fn headline(scene: &Scene) -> Result<Picture, SceneError> {
    let exact = scene.render(&Exact::default())?.framebuffer;
    let target = |framebuffer: &Framebuffer| framebuffer.colors.first().cloned().flatten();
    let Some(yardstick) = target(&exact) else { return Ok(Picture { width: 0, height: 0, rgba: Vec::new() }) };
    let mut pictures = vec![Picture::of_color(&yardstick, scene.target.display, PictureAlpha::Opaque)];
    for model in
        registry::all().into_iter().filter(|model| HEADLINE_MODELS.iter().any(|name| model.name().starts_with(name)))
    {
        let drawn = scene.render(&*model)?.framebuffer;
        pictures.extend(target(&drawn).map(|drawn| Differences::between(&yardstick, &drawn).heat_map()));
    }
    Ok(side_by_side(&pictures, HEADLINE_SCALE))
}

/// Pictures of one size in a row, every texel `scale` pixels wide and high.
fn side_by_side(pictures: &[Picture], scale: u32) -> Picture {
    let (width, height) = pictures.first().map_or((0, 0), |picture| (picture.width, picture.height));
    let mut rgba = Vec::new();
    for y in (0..height).flat_map(|y| std::iter::repeat_n(y as usize, scale as usize)) {
        for picture in pictures {
            let row = &picture.rgba[y * 4 * width as usize..(y + 1) * 4 * width as usize];
            rgba.extend(row.chunks_exact(4).flat_map(|texel| std::iter::repeat_n(texel, scale as usize)).flatten());
        }
    }
    let count = u32::try_from(pictures.len()).unwrap_or(u32::MAX);
    Picture { width: width * scale * count, height: height * scale, rgba }
}

/// `draw-order` as `Draw order`.
fn heading(technique: &str) -> String {
    let mut letters = technique.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect()).replace('-', " ")
}

fn table(page: &mut String, row: &[Shown]) {
    let line =
        |cell: &dyn Fn(&Shown) -> String| row.iter().map(|shown| format!(" {} |", cell(shown))).collect::<String>();
    let captions = line(&|shown| shown.caption.clone());
    let rule: String = row.iter().map(|_| "---|").collect();
    let pictures = line(&|shown| format!("![{}](gallery/{})", shown.caption, shown.file));
    let _ = writeln!(page, "|{captions}\n|{rule}\n|{pictures}\n");
}
