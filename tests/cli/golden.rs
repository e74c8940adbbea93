//! Texts that must not change unseen, kept in `tests/golden`.
//!
//! After a wanted change: `OUTMERGE_BLESS=1 cargo test --all-features --test cli`, then read `git diff tests/golden`.

use std::fmt::Write as _;
use std::path::Path;

use outmerge::model::registry;
use outmerge::scene::{Picture, PictureAlpha, Rendered, Scene};
use rayon::prelude::*;

use super::outmerge;

/// Compares with the stored text, or stores it where `OUTMERGE_BLESS` is set.
pub(super) fn compare(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if std::env::var_os("OUTMERGE_BLESS").is_some() {
        std::fs::write(&path, text).expect("writable");
    }
    let wanted = std::fs::read_to_string(&path).expect("the golden file is committed");
    let (mut wanted, mut lines) = (wanted.lines(), text.lines());
    for number in 1.. {
        match (wanted.next(), lines.next()) {
            (None, None) => break,
            (wanted, now) => assert_eq!(now, wanted, "tests/golden/{name}:{number}: left is now, right is stored"),
        }
    }
}

/// What a command prints, in lines that fit 120 columns.
pub(super) fn printed(name: &str, arguments: &[&str]) {
    let output = outmerge(arguments).output().expect("runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for line in text.lines() {
        assert!(line.chars().count() <= 120, "{name}: wider than 120 columns: {line}");
    }
    compare(name, &text);
}

/// Every byte of every target of every bundled scene in every model. A line a target: mean color as a person sees it
/// (0 to 255, to tell how far a change goes), and a hash of all bytes.
#[test]
fn every_scene_keeps_its_bytes_in_every_model() {
    let scenes: Vec<_> = Scene::bundled().collect();
    let tables = scenes.into_par_iter().map(|(name, scene)| table(name, &scene.expect("bundled scenes are sound")));
    compare("scenes.txt", &tables.collect::<Vec<_>>().concat());
}

fn table(name: &str, scene: &Scene) -> String {
    let mut text = format!("{name}\n");
    for model in registry::all() {
        match scene.render(model.as_ref()) {
            Ok(rendered) => rows(&mut text, scene, &rendered),
            Err(error) => writeln!(text, "  {:9} {error}", model.name()).expect("memory"),
        }
    }
    text
}

fn rows(text: &mut String, scene: &Scene, rendered: &Rendered) {
    let model = &rendered.model;
    for (index, target) in rendered.framebuffer.colors.iter().enumerate() {
        let Some(target) = target else { continue };
        let mean = mean(&Picture::of_color(target, scene.target.display, PictureAlpha::Opaque));
        let (format, hash) = (target.format().name(), fnv1a(target.bytes().iter().copied()));
        writeln!(text, "  {model:9} target {index} {format:15} mean {mean}  {hash:016x}").expect("memory");
    }
    if let Some(target) = &rendered.framebuffer.depth_stencil {
        let depth = target.depth().iter().flat_map(|code| code.to_le_bytes());
        let hash = fnv1a(depth.chain(target.stencil().iter().copied()));
        writeln!(text, "  {model:9} depth and stencil {:29}  {hash:016x}", "").expect("memory");
    }
}

fn mean(picture: &Picture) -> String {
    let mut sums = [0_u64; 4];
    for pixel in picture.rgba.chunks_exact(4) {
        sums.iter_mut().zip(pixel).for_each(|(sum, &x)| *sum += u64::from(x));
    }
    let pixels = u64::from(picture.width) * u64::from(picture.height);
    let hundredths = |sum: u64| (100 * sum + pixels / 2) / pixels;
    let shown = sums[..3].iter().map(|&sum| format!("{:3}.{:02}", hundredths(sum) / 100, hundredths(sum) % 100));
    shown.collect::<Vec<_>>().join(" ")
}

/// The 64-bit FNV-1a hash: small enough to write down, and the same everywhere.
fn fnv1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn the_hash_is_fnv1a() {
    // Test vectors of the hash's authors.
    assert_eq!(fnv1a([].into_iter()), 0xcbf2_9ce4_8422_2325, "of nothing");
    assert_eq!(fnv1a(b"foobar".iter().copied()), 0x8594_4171_f739_67e8, "of foobar");
}
