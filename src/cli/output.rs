//! Where results go: stdout, or a file that appears whole or not at all, also when the disk is full or the run is
//! interrupted.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::Failure;

/// Prints a result.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

/// The version of the JSON results. It rises when a member changes its meaning or goes; new members may come without.
const JSON_VERSION: u32 = 1;

/// A result as JSON has it: what it is, then its members. The forms are in docs/schemas.
#[derive(serde::Serialize)]
struct Envelope<'a, T> {
    /// The file in docs/schemas, without its ending.
    schema: &'a str,
    version: u32,
    #[serde(flatten)]
    result: &'a T,
}

/// A result with members as JSON of the form `docs/schemas/SCHEMA.json`.
pub(super) fn json(schema: &str, result: &impl serde::Serialize) -> Result<String, Failure> {
    Ok(format!("{}\n", serde_json::to_string_pretty(&Envelope { schema, version: JSON_VERSION, result })?))
}

/// Prints a result as JSON of the form `docs/schemas/SCHEMA.json`.
pub(super) fn print_json(schema: &str, result: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json(schema, result)?)
}

/// Says something on stderr; where nobody can hear it, nothing is lost.
pub(super) fn complain(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// The temporary file being written.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Exit status after an interrupt, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Makes SIGINT, SIGTERM and SIGHUP remove the temporary file being written before they end the process.
pub(super) fn end_cleanly_when_interrupted() {
    // Without the handler an interrupt leaves a temporary file behind, and nothing worse.
    let _ = ctrlc::set_handler(|| {
        let unfinished = UNFINISHED.lock().map(|mut path| path.take());
        if let Ok(Some(path)) = unfinished {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(INTERRUPTED);
    });
}

fn set_unfinished(path: Option<PathBuf>) {
    if let Ok(mut unfinished) = UNFINISHED.lock() {
        *unfinished = path;
    }
}

/// Writes a file through `write`: to a temporary name beside it, renamed when complete. `-` is stdout. A link is
/// followed; what is no ordinary file (a device, a pipe) is written to directly.
pub(super) fn write_file<T>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
) -> Result<T, Failure> {
    if path == Path::new("-") {
        return write_to(io::stdout().lock(), write, Into::into);
    }
    let named = |error: io::Error| -> Failure { format!("cannot write {}: {error}", path.display()).into() };
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if place.is_dir() {
        return Err(format!("cannot write {}: it is a folder", path.display()).into());
    }
    if place.exists() && !place.is_file() {
        let file = File::options().write(true).open(&place).map_err(named)?;
        return write_to(file, write, named);
    }
    let folder = place.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let temporary = temporary_file(folder).map_err(named)?;
    set_unfinished(Some(temporary.path().to_owned()));
    let mut temporary = temporary;
    let written = write_to(&mut temporary, write, named);
    let outcome = written.and_then(|value| match temporary.persist(&place) {
        Ok(_) => Ok(value),
        Err(error) => Err(named(error.error)),
    });
    set_unfinished(None);
    outcome
}

/// Writes through a buffer; `named` tells of an error where `write` met none.
fn write_to<T>(
    file: impl Write,
    write: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
    named: impl Fn(io::Error) -> Failure,
) -> Result<T, Failure> {
    let mut checked = Checked { inner: BufWriter::new(file), failed: None };
    let outcome = write(&mut checked);
    let flushed = checked.flush();
    // The first failure of the file itself says more than what `write` made of it.
    if let Some(error) = checked.failed.take().or(flushed.err()) {
        return Err(named(error));
    }
    outcome
}

/// A writer that remembers its first failure.
struct Checked<W: Write> {
    inner: BufWriter<W>,
    failed: Option<io::Error>,
}

impl<W: Write> Checked<W> {
    fn note<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        result.map_err(|error| {
            let copy = io::Error::new(error.kind(), error.to_string());
            self.failed.get_or_insert(error);
            copy
        })
    }
}

impl<W: Write> Write for Checked<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.inner.write(bytes);
        self.note(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.inner.flush();
        self.note(result)
    }
}

/// Writes a chart as an SVG file.
pub(super) fn write_chart(path: &Path, chart: &crate::report::plot::Chart) -> Result<(), Failure> {
    let svg = crate::report::plot::svg(chart)?;
    write_file(path, |file| Ok(file.write_all(svg.as_bytes())?))
}

/// A temporary file with the permissions an ordinary new file has.
fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(permissions);
    builder.tempfile_in(folder)
}

/// Opens a file for reading; `-` is stdin.
pub(super) fn open(path: &Path) -> Result<Box<dyn io::BufRead>, Failure> {
    if path == Path::new("-") {
        return Ok(Box::new(io::BufReader::new(io::stdin())));
    }
    let file = File::open(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    Ok(Box::new(io::BufReader::new(file)))
}

/// Whether an error only says that nobody reads our output any more.
pub(super) fn is_closed_pipe(error: &(dyn Error + 'static)) -> bool {
    std::iter::successors(Some(error), |error: &&(dyn Error + 'static)| (*error).source())
        .filter_map(|error| error.downcast_ref::<io::Error>())
        .any(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

/// A table without rules or frame.
pub(super) fn table<'a>(header: impl IntoIterator<Item = &'a str>) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    table.load_preset(comfy_table::presets::NOTHING);
    table.set_header(header);
    table
}

/// The lines of a table.
pub(super) fn lines(table: &comfy_table::Table) -> String {
    table.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// A table of the report, its caption above it.
pub(super) fn text(report: &crate::report::section::Table) -> String {
    let mut shown = table(report.header.iter().map(String::as_str));
    report.rows.iter().for_each(|row| {
        shown.add_row(row);
    });
    let caption = if report.caption.is_empty() { String::new() } else { format!("{}\n", report.caption) };
    caption + &lines(&shown)
}
