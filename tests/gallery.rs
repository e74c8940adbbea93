//! The committed gallery is what its command makes.
#![cfg(feature = "report")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use outmerge::report::gallery::{Gallery, HEADLINE_SCENE, gallery, headline};
use outmerge::scene::{Picture, Scene};

const COMMAND: &str = "cargo run --release --example gallery";

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

fn scenes() -> Vec<(String, Scene)> {
    Scene::bundled().map(|(name, scene)| (name.to_owned(), scene.expect("bundled scenes are correct"))).collect()
}

fn made() -> Gallery {
    gallery(&scenes(), COMMAND).expect("bundled scenes render")
}

fn page() -> String {
    std::fs::read_to_string(docs().join("gallery.md")).unwrap_or_else(|error| panic!("{error}; run `{COMMAND}`"))
}

#[test]
fn every_bundled_scene_is_listed_with_its_sentences_and_a_picture_that_exists() {
    let page = page();
    for (name, scene) in scenes() {
        let entry = format!("- **{}** (`{name}`): {}", scene.title, scene.explanation);
        assert!(page.lines().any(|line| line == entry), "{name} is not listed as it explains itself; run `{COMMAND}`");
        assert!(page.contains(&format!("](gallery/{name}.png)")), "{name} has no picture on the page");
        assert!(docs().join(format!("gallery/{name}.png")).is_file(), "gallery/{name}.png is missing");
    }
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
