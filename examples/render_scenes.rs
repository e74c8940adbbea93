//! Renders every bundled scene in the exact model into a folder of PNG files, and all of them into one sheet.

use std::path::PathBuf;

use outmerge::model::exact::Exact;
use outmerge::scene::{Picture, PictureAlpha, Scene};

/// Pictures in a row of the sheet, and the gap between them in pixels.
const COLUMNS: usize = 6;
const GAP: usize = 6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: render_scenes FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    let mut pictures = Vec::new();
    for (name, scene) in Scene::bundled() {
        let scene = scene?;
        let rendered = scene.render(&Exact::default())?;
        for (index, target) in rendered.framebuffer.colors.iter().flatten().enumerate() {
            let file = if index == 0 { format!("{name}.png") } else { format!("{name}.{index}.png") };
            let picture = Picture::of_color(target, scene.target.display, PictureAlpha::Opaque);
            std::fs::write(folder.join(file), picture.to_png()?)?;
            pictures.push(picture);
        }
        println!("{name}: {} draws, {} fragments", rendered.draws.len(), rendered.fragments);
    }
    std::fs::write(folder.join("sheet.png"), sheet(&pictures)?.to_png()?)?;
    Ok(())
}

/// All pictures on one, row by row.
fn sheet(pictures: &[Picture]) -> Result<Picture, std::num::TryFromIntError> {
    let cell = |side: fn(&Picture) -> u32| pictures.iter().map(|p| side(p) as usize).max().unwrap_or(1) + GAP;
    let (cell_width, cell_height) = (cell(|p| p.width), cell(|p| p.height));
    let (width, height) = (COLUMNS * cell_width, pictures.len().div_ceil(COLUMNS) * cell_height);
    let mut rgba = vec![u8::MAX; width * height * 4];
    for (i, picture) in pictures.iter().enumerate() {
        let (left, top) = (i % COLUMNS * cell_width, i / COLUMNS * cell_height);
        let row_bytes = picture.width as usize * 4;
        for (y, row) in picture.rgba.chunks_exact(row_bytes).enumerate() {
            let at = ((top + y) * width + left) * 4;
            rgba[at..at + row_bytes].copy_from_slice(row);
        }
    }
    Ok(Picture { width: width.try_into()?, height: height.try_into()?, rgba })
}
