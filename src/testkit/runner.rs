//! Folders of scene and vector files as named tests, on libtest-mimic: `cargo test` and `cargo nextest` list, filter and
//! run them like any other.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};

use super::{Actual, Nonconformance, Prediction, conforms, folder, pictures};
use crate::model::registry;
use crate::scene::Scene;
use crate::vectors;
use crate::verdict::Verdict;

/// Tests from folders, for a test target with `harness = false`:
///
/// ```no_run
/// use outmerge::testkit::Runner;
///
/// fn main() -> std::process::ExitCode {
///     Runner::new().vectors("tests/vectors", "llvmpipe").main()
/// }
/// ```
#[derive(Debug, Default)]
pub struct Runner {
    trials: Vec<Trial>,
}

/// What a renderer made of a scene: its first color target, or why there is none.
type Rendered = Result<Actual, Box<dyn std::error::Error>>;

impl Runner {
    /// No tests yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A test for each vector file (`.jsonl`) in a folder and below: the model must confirm every line.
    ///
    /// A folder that cannot be read, or holds no such file, is a failing test.
    #[must_use]
    pub fn vectors(self, folder: impl AsRef<Path>, model: &str) -> Self {
        let model: Arc<str> = model.into();
        self.each(folder.as_ref(), &["jsonl"], move |path| {
            let model = Arc::clone(&model);
            move || check_vectors(&path, &model)
        })
    }

    /// A test for each scene file (`.toml`, `.json`) in a folder and below: what `render` makes of it must conform to the
    /// model's prediction. Failures leave pictures, as [`assert_conforms!`](crate::assert_conforms) does.
    ///
    /// A folder that cannot be read, or holds no such file, is a failing test.
    #[must_use]
    pub fn scenes(
        self,
        folder: impl AsRef<Path>,
        model: &str,
        render: impl Fn(&Scene) -> Rendered + Send + Sync + 'static,
    ) -> Self {
        let (model, render): (Arc<str>, _) = (model.into(), Arc::new(render));
        self.each(folder.as_ref(), &["toml", "json"], move |path| {
            let (model, render) = (Arc::clone(&model), Arc::clone(&render));
            move || check_scene(&path, &model, render.as_ref())
        })
    }

    /// A test of the caller's.
    #[must_use]
    pub fn test(mut self, name: &str, test: impl FnOnce() -> Result<(), String> + Send + 'static) -> Self {
        self.trials.push(Trial::test(name, move || Ok(test()?)));
        self
    }

    /// Runs what the command line asks for, in the manner of libtest. Without any test it fails.
    #[must_use]
    pub fn main(mut self) -> ExitCode {
        if self.trials.is_empty() {
            let nothing = || Err(Verdict::NotRun.meaning().into());
            self.trials.push(Trial::test("no test was given to this runner", nothing));
        }
        libtest_mimic::run(&Arguments::from_args(), self.trials).exit_code()
    }

    fn each<T>(mut self, folder: &Path, endings: &[&str], test: impl Fn(PathBuf) -> T) -> Self
    where
        T: FnOnce() -> Result<(), Failed> + Send + 'static,
    {
        let mut files = Vec::new();
        let found = search(folder, endings, &mut files);
        let folder_name = folder.display().to_string();
        let problem = match found {
            Err(error) => Some(error.to_string()),
            Ok(()) if files.is_empty() => Some(format!("no file ends in .{}", endings.join(" or ."))),
            Ok(()) => None,
        };
        if let Some(problem) = problem {
            self.trials.push(Trial::test(folder_name.clone(), move || Err(format!("{folder_name}: {problem}").into())));
        }
        for path in files {
            let name = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
            self.trials.push(Trial::test(name, test(path)));
        }
        self
    }
}

/// Files with one of the endings, in order of their names.
fn search(folder: &Path, endings: &[&str], files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        // A link to a folder could lead round in a circle; links to files are followed.
        if entry.file_type()?.is_dir() {
            search(&path, endings, files)?;
        } else if path.extension().and_then(|ending| ending.to_str()).is_some_and(|ending| endings.contains(&ending)) {
            files.push(path);
        }
    }
    Ok(())
}

fn check_vectors(path: &Path, model: &str) -> Result<(), Failed> {
    let model = registry::by_name(model)?;
    let mut first = None;
    let report = vectors::check(model.as_ref(), BufReader::new(File::open(path)?), |mismatch| {
        first.get_or_insert_with(|| mismatch.clone());
    })?;
    match first {
        None if report.verdict.passes() => Ok(()),
        None => {
            let reasons: String = report.not_covered.keys().map(|reason| format!("; {reason}")).collect();
            Err(format!("{}: {}{reasons}", report.verdict, report.verdict.meaning()).into())
        }
        Some(m) => Err(format!(
            "{} of {} texels differ from {}; first in line {}, texel {}: {}; {} gives {}, not {}",
            report.total.failed_texels,
            report.total.texels,
            report.model,
            m.line,
            m.texel,
            m.state,
            m.inputs,
            m.expected,
            m.got
        )
        .into()),
    }
}

fn check_scene(path: &Path, model: &str, render: &dyn Fn(&Scene) -> Rendered) -> Result<(), Failed> {
    let model = registry::by_name(model)?;
    let scene = Scene::load(path)?;
    let expected = Prediction::of_scene(&scene, model.as_ref())?;
    let actual = render(&scene).map_err(|error| format!("not rendered: {error}"))?;
    match conforms(&actual, &expected) {
        Ok(()) => Ok(()),
        Err(problem @ Nonconformance::Shape { .. }) => Err(problem.to_string().into()),
        Err(problem) => {
            let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            pictures::write(&actual, &expected, &folder(), &name)?;
            Err(format!("{problem}\npictures in {}", folder().display()).into())
        }
    }
}
