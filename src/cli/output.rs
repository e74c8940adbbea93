//! Where results go: stdout, or a file that appears whole or not at all.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::Failure;

/// Prints a result.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

/// Prints a result as JSON.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Writes a file through `write`: to a temporary name beside it, renamed when complete. `-` is stdout.
pub(super) fn write_file<T>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T, Failure>,
) -> Result<T, Failure> {
    if path == Path::new("-") {
        let mut stdout = BufWriter::new(io::stdout().lock());
        let value = write(&mut stdout)?;
        stdout.flush()?;
        return Ok(value);
    }
    let named = |error: io::Error| format!("cannot write {}: {error}", path.display());
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let temporary = temporary_file(folder).map_err(named)?;
    let mut buffered = BufWriter::new(temporary);
    let value = write(&mut buffered)?;
    let temporary = buffered.into_inner().map_err(|error| named(error.into_error()))?;
    temporary.persist(path).map_err(|error| named(error.error))?;
    Ok(value)
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
