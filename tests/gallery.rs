//! The committed gallery is what its command makes.
#![cfg(all(feature = "meshes", feature = "report"))]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use outmerge::report::gallery::{Gallery, HEADLINE_SCENE, gallery, headline, stem};
use outmerge::scene::{Picture, Scene};

const COMMAND: &str = "cargo run --release --example gallery";

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

fn scenes() -> Vec<(String, Scene)> {
    let bundled = Scene::bundled().map(|(name, scene)| (name.to_owned(), scene.expect("bundled scenes are correct")));
    let mut files: Vec<_> = std::fs::read_dir(docs().join("../examples/scenes"))
        .expect("the folder of examples")
        .map(|file| file.expect("a directory entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    assert!(files.len() >= 3, "scenes with pictures, meshes and models of their own: {files:?}");
    let loaded = files.iter().map(|path| {
        let file = path.file_name().expect("a file").to_string_lossy();
        (format!("examples/scenes/{file}"), Scene::load(path).unwrap_or_else(|error| panic!("{error}")))
    });
    bundled.chain(loaded).collect()
}

fn made() -> Gallery {
    gallery(&scenes(), COMMAND).expect("bundled scenes render")
}

fn page() -> String {
    std::fs::read_to_string(docs().join("gallery.md")).unwrap_or_else(|error| panic!("{error}; run `{COMMAND}`"))
}

#[test]
fn every_scene_is_listed_with_its_sentences_and_a_picture_that_exists() {
    let page = page();
    for (name, scene) in scenes() {
        let entry = format!("- **{}** (`{name}`): {}", scene.title, scene.explanation);
        assert!(page.lines().any(|line| line == entry), "{name} is not listed as it explains itself; run `{COMMAND}`");
        let picture = format!("gallery/{}.png", stem(&name));
        assert!(page.contains(&format!("]({picture})")), "{name} has no picture on the page");
        assert!(docs().join(&picture).is_file(), "{picture} is missing");
    }
}

#[test]
fn the_precision_scenes_lead_to_the_texture_report() {
    let page = page();
    let section = page.split("\n## ").find(|section| section.starts_with("Premultiplied precision")).expect("there");
    for way in ["`outmerge texture FILE.png`", "](../examples/texture_report.rs)"] {
        assert!(section.contains(way), "{way} in {section}");
    }
    assert!(docs().join("../examples/texture_report.rs").is_file(), "the example exists");
}

fn compare(path: &Path, picture: &Picture) {
    let read = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_rgba8();
    assert_eq!((read.width(), read.height()), (picture.width, picture.height), "{}: size", path.display());
    assert!(read.into_raw() == picture.rgba, "{} is old; run `{COMMAND}`", path.display());
}

#[test]
fn the_front_page_s_picture_is_up_to_date() {
    let scene = Scene::bundled_by_name(HEADLINE_SCENE).expect("bundled").expect("a correct scene");
    compare(&docs().join("headline.png"), &headline(&scene).expect("the scene renders"));
    let readme = std::fs::read_to_string(docs().join("../README.md")).expect("README.md");
    assert!(readme.contains("](docs/headline.png)"), "README.md shows it");
}

#[test]
fn page_and_pictures_are_up_to_date() {
    let made = made();
    assert_eq!(page(), made.page, "docs/gallery.md is old; run `{COMMAND}`");
    let mut kept = BTreeSet::new();
    for (file, picture) in &made.pictures {
        compare(&docs().join("gallery").join(file), picture);
        kept.insert(file.clone());
    }
    for entry in std::fs::read_dir(docs().join("gallery")).expect("the folder of pictures") {
        let file = entry.expect("a directory entry").file_name().to_string_lossy().into_owned();
        assert!(kept.contains(&file), "gallery/{file} belongs to no scene; run `{COMMAND}`");
    }
}
