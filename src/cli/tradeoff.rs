//! `outmerge tradeoff`: error against run time.

use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome, output};
use crate::analysis::texture::Source;
use crate::analysis::tradeoff::clock::{self, Time};
#[cfg(feature = "gpu")]
use crate::analysis::tradeoff::driver;
use crate::analysis::tradeoff::fixed::{self, FixedRow};
use crate::analysis::tradeoff::front::{self, Point};
use crate::analysis::tradeoff::input::Inputs;
use crate::analysis::tradeoff::{FORMATS, LAYERS, Row, Survey, jobs, survey};
use crate::format::ColorFormat;
use crate::model::NumericModel;
use crate::model::registry::{self, Drivers};
use crate::report::section::tradeoff as section;

/// Arguments of `tradeoff`.
#[derive(Debug, Args)]
pub(super) struct Tradeoff {
    /// Formats, comma separated; one of each kind unless given.
    #[arg(long, short, value_delimiter = ',')]
    formats: Vec<String>,
    /// Numeric models, comma separated; one of each kind unless given.
    #[arg(long, short, value_delimiter = ',')]
    models: Vec<String>,
    /// Depths of stacks, comma separated, of 1, 10, 100 and 1000; all unless given.
    #[arg(long, short = 'n', value_delimiter = ',')]
    layers: Vec<u32>,
    /// A PNG for the picture input instead of the built-in one.
    #[arg(long)]
    image: Option<PathBuf>,
    /// Seed of the random and adversarial inputs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Texels of each stack, as a multiple of the usual number.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    effort: u32,
    /// A Vulkan adapter to measure as one more point: part of its name or driver. The first there is unless given.
    #[arg(long, short)]
    adapter: Option<String>,
    /// Measure no adapter.
    #[arg(long, conflicts_with = "adapter")]
    no_adapter: bool,
    /// Every row (state and input) instead of one a model, format and depth.
    #[arg(long)]
    rows: bool,
    /// Draw error against time (SVG).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Draw error against bits of the fixed-point family (SVG).
    #[arg(long, value_name = "FILE")]
    plot_fixed: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Everything measured.
#[derive(Debug, serde::Serialize)]
struct Measured {
    points: Vec<Point>,
    rows: Vec<Row>,
    times: Vec<Time>,
    fixed: Vec<FixedRow>,
}

#[cfg(feature = "gpu")]
use crate::crosscheck::Device;

/// A build without wgpu has no devices.
#[cfg(not(feature = "gpu"))]
#[derive(Debug)]
enum Device {}

/// What plain names of drivers mean.
fn drivers(device: &Option<Device>) -> Drivers {
    #[cfg(feature = "gpu")]
    return device.as_ref().map_or_else(Drivers::default, |device| device.report().drivers());
    #[cfg(not(feature = "gpu"))]
    match device {
        None => Drivers::default(),
        Some(none) => match *none {},
    }
}

impl Tradeoff {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        // Plain names of drivers mean the driver that is measured beside them.
        let device = self.device()?;
        let drivers = drivers(&device);
        let models = if self.models.is_empty() {
            registry::all_among(drivers)
        } else {
            self.models.iter().map(|name| registry::by_name_among(name, drivers)).collect::<Result<_, _>>()?
        };
        let models: Vec<&dyn NumericModel> = models.iter().map(AsRef::as_ref).collect();
        let formats: Vec<&str> = if self.formats.is_empty() {
            FORMATS.to_vec()
        } else {
            self.formats
                .iter()
                .map(|name| ColorFormat::from_name(name).map(ColorFormat::name))
                .collect::<Result<_, _>>()?
        };
        let inputs = match &self.image {
            None => Inputs::new(self.seed),
            Some(path) => Inputs::with_picture(self.seed, &Source::load_within(path, None, super::limits::get())?),
        };
        let layers = self.layers()?;
        let what = Survey { models: &models, inputs: &inputs, formats: &formats, layers: &layers };
        #[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "a driver's come behind"))]
        let mut times = clock::times(&models, &formats, &inputs)?;
        let bar = ProgressBar::new(jobs(&what) as u64)
            .with_style(ProgressStyle::with_template("drawing {bar:40} {pos}/{len} stacks {elapsed}")?);
        #[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "a driver's come behind"))]
        let mut rows = survey(&what, &|| bar.inc(1));
        bar.finish_and_clear();
        #[cfg(feature = "gpu")]
        if let Some(device) = &device {
            rows.extend(driver::survey(device, &what, &|| ())?);
            times.extend(driver::times(device, &what)?);
        }
        let fixed = fixed::sweep(&inputs, 4096 * self.effort);
        let measured = Measured { points: front::points(&rows, &times), rows, times, fixed };
        if let Some(path) = &self.plot {
            output::write_chart(path, &section::scatter(&measured.points))?;
        }
        if let Some(path) = &self.plot_fixed {
            output::write_chart(path, &section::fixed_chart(&measured.fixed))?;
        }
        if self.json {
            output::print_json("tradeoff", &measured)?;
        } else {
            output::print(&self.text(&measured))?;
        }
        Ok(Outcome::Done)
    }

    /// The driver to measure, unless none is wanted. A missing one is an error only if it was asked for.
    #[cfg(feature = "gpu")]
    fn device(&self) -> Result<Option<Device>, Failure> {
        use crate::crosscheck::OpenOptions;
        if self.no_adapter {
            return Ok(None);
        }
        // Time is measured, not compared bit for bit, so a shader cache does no harm.
        let options = OpenOptions { adapter: self.adapter.clone(), allow_shader_cache: true, ..OpenOptions::default() };
        match Device::open(&options) {
            Ok(device) => Ok(Some(device)),
            Err(error) if self.adapter.is_none() => {
                output::complain(&format!("not run: a driver as one of the points: {error}"));
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Without the feature `gpu` there is no driver to measure.
    #[cfg(not(feature = "gpu"))]
    fn device(&self) -> Result<Option<Device>, Failure> {
        let reason = "this program was built without the feature `gpu`";
        match &self.adapter {
            Some(_) => Err(format!("{reason}; build with --all-features to measure an adapter").into()),
            None => {
                if !self.no_adapter {
                    output::complain(&format!("not run: a driver as one of the points: {reason}"));
                }
                Ok(None)
            }
        }
    }

    fn layers(&self) -> Result<Vec<(u32, u32)>, Failure> {
        if let Some(unknown) = self.layers.iter().find(|n| LAYERS.iter().all(|(layers, _)| layers != *n)) {
            return Err(format!("--layers {unknown} is not surveyed; use 1, 10, 100 or 1000").into());
        }
        let wanted = LAYERS.into_iter().filter(|(layers, _)| self.layers.is_empty() || self.layers.contains(layers));
        Ok(wanted.map(|(layers, texels)| (layers, texels * self.effort)).collect())
    }

    fn text(&self, measured: &Measured) -> String {
        let table = if self.rows { section::row_table(&measured.rows) } else { section::point_table(&measured.points) };
        format!(
            "{}\n\n{}\n{}",
            section::finding(&measured.points),
            output::text(&table),
            output::text(&section::fixed_table(&measured.fixed))
        )
    }
}
