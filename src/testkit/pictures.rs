//! The three pictures that a failure leaves behind.

use std::io;
use std::path::{Path, PathBuf};

use super::{Actual, Prediction};
use crate::scene::description::Display;
use crate::scene::{Picture, PictureAlpha};
use crate::target::ColorTarget;
use crate::vectors::same_codes;

/// Where pictures go: `$OUTMERGE_TESTKIT_DIR`, or `testkit` in cargo's target folder, or in the system's temporary folder
/// where there is no target folder.
#[must_use]
pub fn folder() -> PathBuf {
    if let Some(folder) = std::env::var_os("OUTMERGE_TESTKIT_DIR") {
        return folder.into();
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    if target.is_dir() { target.join("testkit") } else { std::env::temp_dir().join("outmerge-testkit") }
}

/// Writes `NAME.actual.png`, `NAME.expected.png` and `NAME.diff.png` and returns their names.
pub(super) fn write(
    actual: &Actual,
    expected: &Prediction,
    folder: &Path,
    name: &str,
) -> Result<[PathBuf; 3], io::Error> {
    std::fs::create_dir_all(folder)?;
    // A test's name may be a path of modules.
    let safe = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    let name: String = name.chars().map(safe).collect();
    let picture = |target: &ColorTarget| Picture::of_color(target, Display::Stored, PictureAlpha::Stored);
    let files = [
        ("actual", picture(&actual.target)),
        ("expected", picture(expected.target())),
        ("diff", difference(actual, expected)),
    ];
    let mut written = Vec::new();
    for (kind, picture) in files {
        let path = folder.join(format!("{name}.{kind}.png"));
        std::fs::write(&path, picture.to_png().map_err(io::Error::other)?)?;
        written.push(path);
    }
    written.try_into().map_err(|_| io::Error::other("three files are written"))
}

/// Conforming pixels as dark grey of what they show, others red (off by one code) to yellow (by 16 and more).
fn difference(actual: &Actual, expected: &Prediction) -> Picture {
    let got = &actual.target;
    let mut picture = Picture::of_color(got, Display::Stored, PictureAlpha::Opaque);
    let width = picture.width as usize;
    for (i, pixel) in picture.rgba.chunks_exact_mut(4).enumerate() {
        let (Ok(x), Ok(y)) = (u32::try_from(i % width), u32::try_from(i / width)) else { continue };
        let codes = got.codes(x, y, 0);
        let wanted = |framebuffer| expected.color(framebuffer).codes(x, y, 0);
        let conforms = expected.accepted.iter().any(|(_, result)| same_codes(got.format(), codes, wanted(result)));
        if conforms {
            let sum: u16 = pixel[..3].iter().map(|channel| u16::from(*channel)).sum();
            let grey = u8::try_from(sum / 9).unwrap_or(u8::MAX);
            pixel[..3].fill(grey);
        } else {
            let off = codes.iter().zip(expected.target().codes(x, y, 0)).map(|(a, b)| a.abs_diff(b)).max();
            let green = off.unwrap_or(0).saturating_sub(1).saturating_mul(17).min(255);
            pixel[..3].copy_from_slice(&[255, u8::try_from(green).unwrap_or(u8::MAX), 0]);
        }
    }
    picture
}
