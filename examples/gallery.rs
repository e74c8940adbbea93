//! Makes `docs/gallery.md`, its pictures and that of README.md: `cargo run --release --example gallery`.

use std::path::Path;

use outmerge::report::gallery::{HEADLINE_SCENE, gallery, headline};
use outmerge::scene::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let bundled = Scene::bundled().map(|(name, scene)| Ok((name.to_owned(), scene?)));
    let mut scenes = bundled.collect::<Result<Vec<_>, outmerge::scene::SceneFileError>>()?;
    let mut files = std::fs::read_dir(docs.join("../examples/scenes"))?.collect::<Result<Vec<_>, _>>()?;
    files.retain(|file| file.path().extension().is_some_and(|ending| ending == "toml"));
    files.sort_by_key(std::fs::DirEntry::file_name);
    for file in files {
        let name = format!("examples/scenes/{}", file.file_name().to_string_lossy());
        scenes.push((name, Scene::load(&file.path())?));
    }
    let gallery = gallery(&scenes, "cargo run --release --example gallery")?;
    let folder = docs.join("gallery");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(&folder)?;
    let mut bytes = 0;
    for (file, picture) in &gallery.pictures {
        let png = picture.to_png()?;
        bytes += png.len();
        std::fs::write(folder.join(file), png)?;
    }
    std::fs::write(docs.join("gallery.md"), &gallery.page)?;
    let first = Scene::bundled_by_name(HEADLINE_SCENE).ok_or("the front page's scene is not bundled")??;
    std::fs::write(docs.join("headline.png"), headline(&first)?.to_png()?)?;
    println!("docs/gallery.md: {} scenes, {} pictures, {bytes} bytes", scenes.len(), gallery.pictures.len());
    Ok(())
}
