//! The library of a driver that reports no version: its SHA-256, and the builds that were tried.

use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use super::adapter::AdapterReport;
use crate::vectors::Library;

/// Builds of SwiftShader by SHA-256, each with the browser it shipped with. `tests/drivers.sh` fetches and runs them.
const BUILDS: &str = include_str!("swiftshader_builds.txt");

/// Variables that name ICD files, colon separated; the first that is set counts.
const VARIABLES: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

/// Folders the Vulkan loader looks for ICD files in.
const FOLDERS: [&str; 3] = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// The library of an adapter; `None` where it cannot be told which file it is, or the file cannot be read.
///
/// The driver's file is the one library among the ICD files whose name is part of the adapter's.
pub(super) fn of_adapter(report: &AdapterReport) -> Option<Library> {
    let name = report.name.to_lowercase();
    let driver = name.split([' ', '(']).next().filter(|word| !word.is_empty())?;
    let libraries = icd_files().into_iter().filter_map(|icd| library_of(&icd));
    let path = libraries.into_iter().find(|path| file_name(path).to_lowercase().contains(driver))?;
    of_file(&path)
}

fn of_file(path: &Path) -> Option<Library> {
    let bytes = std::fs::read(path).ok()?;
    let sha256: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    let known_as = known_build(&sha256);
    Some(Library { name: file_name(path), sha256, known_as })
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The build with this sum: lines of sum and name, comments after `#`.
fn known_build(sha256: &str) -> Option<String> {
    let entries = BUILDS.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(' '));
    entries.into_iter().find(|(sum, _)| *sum == sha256).map(|(_, name)| name.trim().to_owned())
}

fn icd_files() -> Vec<PathBuf> {
    if let Some(list) = VARIABLES.iter().find_map(std::env::var_os) {
        return std::env::split_paths(&list).collect();
    }
    let entries = FOLDERS.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    entries.map(|entry| entry.path()).collect()
}

/// The library an ICD file names: relative paths count from the file, bare names are the system's and stay unknown.
fn library_of(icd: &Path) -> Option<PathBuf> {
    let icd_text = std::fs::read_to_string(icd).ok()?;
    let manifest: serde_json::Value = serde_json::from_str(&icd_text).ok()?;
    let library = PathBuf::from(manifest["ICD"]["library_path"].as_str()?);
    if library.is_absolute() { Some(library) } else { Some(icd.parent()?.join(library)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_known_by_its_sum() {
        let dir = tempfile::tempdir().expect("a folder");
        let library = dir.path().join("libvk_test.so");
        std::fs::write(&library, b"abc").expect("written");
        let icd = dir.path().join("icd.json");
        std::fs::write(&icd, r#"{"ICD":{"library_path":"./libvk_test.so"}}"#).expect("written");
        let found = of_file(&library_of(&icd).expect("a path")).expect("a file");
        // FIPS 180-4's example.
        assert_eq!(found.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!((found.name.as_str(), found.known_as), ("libvk_test.so", None));
    }

    #[test]
    fn every_known_build_has_a_sum_and_a_name() {
        for line in BUILDS.lines().filter(|line| !line.starts_with('#')) {
            let (sum, name) = line.split_once(' ').expect("sum and name");
            assert!(sum.len() == 64 && sum.bytes().all(|byte| byte.is_ascii_hexdigit()), "{line}");
            assert_eq!(known_build(sum).as_deref(), Some(name.trim()), "{line}");
        }
    }
}
