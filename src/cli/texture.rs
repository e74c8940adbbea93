//! `outmerge texture`: what storing colors premultiplied costs images.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output};
use crate::analysis::texture::{self, AlphaRow, ImageReport, Options, PipelineReport, Source, Space};
use crate::model::{NumericModel, registry};
use crate::report::section::texture::storages;
use crate::verdict::Verdict;

/// Arguments of `texture`.
#[derive(Debug, Args)]
pub(super) struct Texture {
    /// PNG images of 8 or 16 bits, or folders of them (searched to the bottom).
    #[arg(required = true)]
    images: Vec<PathBuf>,
    /// What the stored colors mean; by default what the file declares, or sRGB.
    #[arg(long, value_enum)]
    space: Option<SpaceArgument>,
    /// Numeric models to draw the image in, comma separated; all unless given.
    #[arg(long, short, value_delimiter = ',')]
    models: Vec<String>,
    /// Alpha at and above which a cutout keeps a texel, for the coverage of each mip level.
    #[arg(long, default_value_t = 0.5)]
    cutoff: f64,
    /// Exit with status 1 if 8-bit premultiplied storage misses any recovered color by more than this many codes.
    #[arg(long, value_name = "CODES")]
    max_error: Option<f64>,
    /// Folder for heat maps of the recovered colors' errors, one PNG an image; made if missing.
    #[arg(long, value_name = "DIR")]
    heat_maps: Option<PathBuf>,
    /// Every alpha in the table instead of the worst and the most frequent ones.
    #[arg(long)]
    all_alphas: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// [`Space`] on the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SpaceArgument {
    Linear,
    Srgb,
}

/// As JSON has it.
#[derive(serde::Serialize)]
struct Measured<'a> {
    /// Against --max-error, where it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<Verdict>,
    images: &'a [ImageReport],
}

/// Rows of the table of alphas, unless all are asked for.
const SHOWN_ALPHAS: usize = 12;

impl Texture {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if !(0.0..=1.0).contains(&self.cutoff) {
            return Err(format!("--cutoff {} is not an alpha; use 0 to 1", self.cutoff).into());
        }
        if let Some(limit) = self.max_error.filter(|limit| !(0.0..=255.0).contains(limit)) {
            return Err(format!("--max-error {limit} is not a number of codes; use 0 to 255").into());
        }
        let models = self.models()?;
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let exact = registry::by_name("exact")?;
        let options = Options { models: &models, exact: exact.as_ref(), cutoff: self.cutoff };
        let space = self.space.map(|space| match space {
            SpaceArgument::Linear => Space::Linear,
            SpaceArgument::Srgb => Space::Srgb,
        });
        let files = find_images(&self.images)?;
        let bar = ProgressBar::new(files.len() as u64)
            .with_style(ProgressStyle::with_template("measuring {bar:40} {pos}/{len} images {elapsed}")?);
        let mut reports = Vec::new();
        for path in &files {
            let source = Source::load_within(path, space, super::limits::get())?;
            let mut report = texture::measure(&source, &options);
            if let (Some(folder), Some(picture)) = (&self.heat_maps, report.heat_map.take()) {
                write_heat_map(folder, reports.len(), path, &picture.to_png()?)?;
            }
            reports.push(report);
            bar.inc(1);
        }
        bar.finish_and_clear();
        let worst = reports.iter().map(eight).map(|row| row.worst).fold(0.0, f64::max);
        let verdict = self.max_error.map(|limit| Verdict::of_search(worst > limit, reports.len()));
        if self.json {
            output::print_json("texture", &Measured { verdict, images: &reports })?;
        } else {
            let texts: Vec<String> = reports.iter().map(|report| self.image_text(report)).collect();
            let summary = if reports.len() > 1 { summary(&reports) } else { String::new() };
            output::print(&(texts.join("\n") + &summary))?;
        }
        Ok(verdict.map_or(Outcome::Done, Outcome::Judged))
    }

    fn models(&self) -> Result<Vec<Box<dyn NumericModel>>, Failure> {
        if self.models.is_empty() {
            return Ok(registry::all());
        }
        Ok(self.models.iter().map(|name| registry::by_name(name)).collect::<Result<_, _>>()?)
    }

    fn image_text(&self, report: &ImageReport) -> String {
        let mut text = format!(
            "{}: {} x {}, {} bits, {}; {} transparent and {} translucent texels\n",
            report.name,
            report.width,
            report.height,
            report.bits,
            match report.space {
                Space::Linear => "linear",
                Space::Srgb => "sRGB",
            },
            report.transparent,
            report.translucent
        );
        let _ = writeln!(text, "{}\n", report.verdict);
        text.push_str(&output::text(&storages(report)));
        let _ = writeln!(
            text,
            "\n8-bit premultiplied: {:.2} of 24 color bits lost per texel; channels by error in codes:{}",
            report.bits_lost_per_texel,
            histogram(&eight(report).histogram)
        );
        if !report.alphas.is_empty() {
            text.push_str("\nBy alpha, 8-bit premultiplied\n");
            text.push_str(&self.alphas(&report.alphas));
        }
        let f = &report.filtering;
        let _ = writeln!(
            text,
            "\nFiltered between four texels, worst (mean) error in codes: straight {:.2} ({:.4}), premultiplied {:.2} \
             ({:.4}), filtered before premultiplying {:.2} ({:.4})",
            f.straight.worst,
            f.straight.mean,
            f.premultiplied.worst,
            f.premultiplied.mean,
            f.filtered_first.worst,
            f.filtered_first.mean
        );
        let levels: Vec<String> = report
            .coverage
            .iter()
            .map(|level| format!("{}x{} {:.1} %", level.width, level.height, 100.0 * level.kept))
            .collect();
        let _ = writeln!(text, "Cutout at {} keeps, by mip level: {}", self.cutoff, levels.join(", "));
        text
    }

    fn alphas(&self, rows: &[AlphaRow]) -> String {
        let mut shown: Vec<&AlphaRow> = rows.iter().collect();
        if !self.all_alphas && shown.len() > SHOWN_ALPHAS {
            shown.sort_by(|a, b| b.worst.total_cmp(&a.worst));
            let mut frequent = shown.split_off(SHOWN_ALPHAS / 2);
            frequent.sort_by_key(|row| std::cmp::Reverse(row.texels));
            shown.extend(frequent.into_iter().take(SHOWN_ALPHAS / 2));
            shown.sort_by_key(|row| row.alpha);
        }
        let mut table =
            output::table(["alpha", "texels", "levels", "bits lost", "worst possible", "worst here", "mean here"]);
        for row in &shown {
            table.add_row([
                row.alpha.to_string(),
                row.texels.to_string(),
                row.levels.to_string(),
                format!("{:.2}", row.bits_lost),
                row.worst_possible.to_string(),
                format!("{:.2}", row.worst),
                format!("{:.3}", row.mean),
            ]);
        }
        let mut text = output::lines(&table);
        if shown.len() < rows.len() {
            let _ = writeln!(text, "  {} further alphas: --all-alphas", rows.len() - shown.len());
        }
        text
    }
}

/// The row of 8-bit premultiplied storage.
fn eight(report: &ImageReport) -> &PipelineReport {
    use texture::pipeline::Pipeline;
    let found = report.pipelines.iter().find(|row| row.pipeline == Pipeline::Premultiplied8);
    found.expect("every pipeline is measured")
}

/// ` 0: 81.2 %, 1: 12 %, 2-3: ...` in growing classes.
fn histogram(counts: &[u64]) -> String {
    let total: u64 = counts.iter().sum();
    let mut text = String::new();
    let (mut first, mut last) = (0, 0);
    while first < counts.len() {
        let sum: u64 = counts[first..counts.len().min(last + 1)].iter().sum();
        if sum > 0 {
            let name = if first == last { first.to_string() } else { format!("{first}-{last}") };
            let comma = if text.is_empty() { "" } else { "," };
            let _ = write!(text, "{comma} {name}: {:.2} %", 100.0 * ratio(sum, total));
        }
        (first, last) = (last + 1, 2 * last + 1);
    }
    if text.is_empty() { " none".to_owned() } else { text }
}

/// One line an image.
fn summary(reports: &[ImageReport]) -> String {
    let mut table =
        output::table(["image", "texels", "translucent", "bits lost", "worst", "mean", "texels changed", "fringe"]);
    for report in reports {
        let row = eight(report);
        let texels = u64::from(report.width) * u64::from(report.height);
        table.add_row([
            report.name.clone(),
            texels.to_string(),
            format!("{:.1} %", 100.0 * ratio(report.translucent, texels)),
            format!("{:.2}", report.bits_lost_per_texel),
            format!("{:.2}", row.worst),
            format!("{:.3}", row.mean),
            format!("{:.2} %", 100.0 * row.texels_changed),
            format!("{:.2}", report.filtering.straight.worst),
        ]);
    }
    format!("\nSummary of {} images, 8-bit premultiplied\n{}", reports.len(), output::lines(&table))
}

fn ratio(part: u64, whole: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    let ratio = part as f64 / whole as f64;
    if whole == 0 { 0.0 } else { ratio }
}

/// The files, and the PNG files in the folders, in order of their names.
fn find_images(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let before = files.len();
        search(path, &mut files)?;
        if files.len() == before {
            return Err(format!("{}: no .png file in this folder or below", path.display()).into());
        }
    }
    Ok(files)
}

fn search(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let named = |error: std::io::Error| format!("cannot read the folder {}: {error}", folder.display());
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(named)? {
        entries.push(entry.map_err(named)?);
    }
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        // A link to a folder could lead round in a circle; links to files are followed.
        if entry.file_type().map_err(named)?.is_dir() {
            search(&path, files)?;
        } else if path.is_file() && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            files.push(path);
        }
    }
    Ok(())
}

/// `DIR/000-name.png`; the number keeps equal names of several folders apart.
fn write_heat_map(folder: &Path, index: usize, image: &Path, png: &[u8]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    let stem = image.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    output::write_file(&folder.join(format!("{index:03}-{stem}.png")), |file| Ok(file.write_all(png)?))
}
