//! Units on a device, one after the other.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

use rayon::prelude::*;

#[cfg(feature = "scene")]
use super::raster;
use super::result::{ModelOutcome, UnitOutcome};
use super::spec::Bench;
use super::{Unit, blend, clear, codes, depth, sample_mask, store, telling};
use crate::admissible::Judge;
use crate::crosscheck::{Device, ReplayError};
use crate::format::{Codes, ColorFormat};
use crate::model::llvmpipe::Llvmpipe;
use crate::model::registry::{self, Drivers, ModelNameError};
use crate::model::{Agreement, NumericModel};

/// A model under comparison.
#[derive(Debug)]
pub struct Subject {
    /// Its name.
    pub name: String,
    /// The model.
    pub model: Box<dyn NumericModel>,
    /// The same as llvmpipe, whose store and 8-bit arithmetic run alone.
    pub llvmpipe: Option<Llvmpipe>,
    /// Whether the model is fast enough for every input: llvmpipe, and the models in binary32.
    pub exhaustive: bool,
}

impl Subject {
    /// The model with this name; what the name of a driver leaves unsaid is as in `drivers`.
    ///
    /// # Errors
    /// [`ModelNameError`].
    pub fn new(name: &str, drivers: Drivers) -> Result<Self, ModelNameError> {
        let model = registry::by_name_among(name, drivers)?;
        let llvmpipe = registry::llvmpipe(name, drivers)?;
        let name = model.name();
        let exhaustive = llvmpipe.is_some() || name == "f32" || name.starts_with("swiftshader");
        Ok(Self { name, model, llvmpipe, exhaustive })
    }
}

/// What a device's results are held against.
#[derive(Debug, Default)]
pub struct Panel {
    /// Models, bit for bit.
    pub subjects: Vec<Subject>,
    /// Specifications, by the codes they admit.
    pub judges: Vec<Judge>,
}

impl From<Vec<Subject>> for Panel {
    fn from(subjects: Vec<Subject>) -> Self {
        Self { subjects, judges: Vec::new() }
    }
}

/// Tallies of one unit: texels and states drawn, and each model's and each judge's count.
#[derive(Debug)]
pub(super) struct Tally<'a> {
    pub texels: u64,
    pub states: u64,
    /// States the device cannot run, in words.
    pub left_out: Option<String>,
    pub models: Vec<ModelOutcome>,
    pub benches: Vec<Bench<'a>>,
}

impl<'a> Tally<'a> {
    pub(super) fn new(panel: &'a Panel) -> Self {
        Self {
            texels: 0,
            states: 0,
            left_out: None,
            models: vec![ModelOutcome::default(); panel.subjects.len()],
            benches: panel.judges.iter().map(Bench::new).collect(),
        }
    }

    /// Says of a model, once, why it was not compared in this unit.
    pub(super) fn leave_out(&mut self, i: usize, reason: &str) {
        self.models[i].not_run.get_or_insert_with(|| reason.to_owned());
    }

    /// Says of every specification why it was not asked in this unit.
    pub(super) fn leave_out_specifications(&mut self, reason: &str) {
        self.benches.iter_mut().for_each(|bench| bench.leave_out(reason));
    }

    /// Adds one state's comparison with model number `i`.
    pub(super) fn add(&mut self, i: usize, compared: Compared, describe: impl FnOnce(usize) -> String) {
        let outcome = &mut self.models[i];
        outcome.states += 1;
        outcome.states_matched += u64::from(compared.mismatches == 0);
        outcome.mismatches += compared.mismatches;
        outcome.undecided += compared.undecided;
        if let (None, Some(at)) = (&outcome.first, compared.first) {
            outcome.first = Some(describe(at));
        }
    }
}

/// Texels of one job that differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Compared {
    pub mismatches: u64,
    /// Texels that count neither way.
    pub undecided: u64,
    pub first: Option<usize>,
}

/// Compares `count` texels, several at a time; `agreement` says how texel i relates to the model's.
pub(super) fn compare<A: Into<Agreement>>(count: usize, agreement: impl Fn(usize) -> A + Sync) -> Compared {
    const CHUNK: usize = 4096;
    let chunk = |start: usize| {
        let mut compared = Compared::default();
        for i in start * CHUNK..((start + 1) * CHUNK).min(count) {
            match agreement(i).into() {
                Agreement::Same => {}
                Agreement::Undecided => compared.undecided += 1,
                Agreement::Different => {
                    compared.mismatches += 1;
                    compared.first.get_or_insert(i);
                }
            }
        }
        compared
    };
    let join = |a: Compared, b: Compared| Compared {
        mismatches: a.mismatches + b.mismatches,
        undecided: a.undecided + b.undecided,
        first: a.first.into_iter().chain(b.first).min(),
    };
    (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(Compared::default, join)
}

/// The codes of texel `i` of a target's bytes.
pub(super) fn texel(format: ColorFormat, bytes: &[u8], i: usize) -> Codes {
    let each = format.bytes_per_texel();
    format.unpack(&bytes[i * each..(i + 1) * each])
}

/// Runs units in order and hands each outcome to `done`, which may end the run.
///
/// A unit the device refuses counts as not run, with the reason; so do all units after the device was lost or hung.
pub fn run(device: &Device, panel: &Panel, units: &[Unit], mut done: impl FnMut(UnitOutcome) -> ControlFlow<()>) {
    let mut fault: Option<String> = None;
    for unit in units {
        let outcome = match &fault {
            Some(reason) => UnitOutcome::not_run(unit, format!("the device failed before: {reason}")),
            None => run_unit(device, panel, unit).unwrap_or_else(|error| {
                if let ReplayError::Device(device_fault) = &error
                    && device_fault.is_final()
                {
                    fault = Some(device_fault.to_string());
                }
                UnitOutcome::not_run(unit, error.to_string())
            }),
        };
        if done(outcome).is_break() {
            return;
        }
    }
}

fn run_unit(device: &Device, panel: &Panel, unit: &Unit) -> Result<UnitOutcome, ReplayError> {
    if let Unit::Blend { format, .. } | Unit::Store { format, .. } | Unit::Telling { format } | Unit::Raster { format } =
        unit
        && !device.renders(format.texture_format())
    {
        return Ok(UnitOutcome::not_run(unit, format!("the adapter does not render to {}", format.name())));
    }
    let started = Instant::now();
    let mut tally = Tally::new(panel);
    let subjects = panel.subjects.as_slice();
    match unit {
        Unit::Blend { format, states, texels } => {
            if matches!(states, super::level::States::Equal { .. }) && !device.blends(*format) {
                let reason = format!("the adapter does not blend on {}", format.name());
                return Ok(UnitOutcome::not_run(unit, reason));
            }
            blend::run(device, subjects, *format, *states, *texels, &mut tally)?;
        }
        Unit::Store { format, stride, rotation } => {
            store::run(device, subjects, *format, *stride, *rotation, &mut tally)?;
        }
        Unit::Depth { format, stride } => depth::run(device, subjects, *format, *stride, &mut tally)?,
        Unit::Telling { format } => telling::run(device, subjects, *format, &mut tally)?,
        Unit::Clear { format } => clear::run(device, subjects, *format, &mut tally)?,
        Unit::SampleMask => sample_mask::run(device, subjects, &mut tally)?,
        #[cfg(feature = "scene")]
        Unit::Raster { format } => raster::run(device, subjects, *format, &mut tally)?,
        #[cfg(feature = "scene")]
        Unit::DepthBias { format } => raster::run_bias(device, subjects, *format, &mut tally)?,
        #[cfg(not(feature = "scene"))]
        Unit::Raster { .. } | Unit::DepthBias { .. } => {
            return Ok(UnitOutcome::not_run(unit, "this program was built without the feature `scene`"));
        }
        Unit::Codes { src_factor } => codes::run(device, subjects, *src_factor, &mut tally)?,
        Unit::CodesBothAlphas { component } => codes::run_both_alphas(device, subjects, *component, &mut tally)?,
    }
    let names = subjects.iter().map(|subject| subject.name.clone());
    let specs = tally.benches.into_iter().map(|bench| (bench.judge.spec.name().to_owned(), bench.outcome));
    Ok(UnitOutcome {
        unit: unit.id(),
        format: unit.format_name().to_owned(),
        texels: tally.texels,
        states: tally.states,
        // Short decimals survive writing and reading, which checksums ask for.
        seconds: (started.elapsed().as_secs_f64() * 1e3).round() / 1e3,
        not_run: None,
        left_out: tally.left_out,
        models: names.zip(tally.models).collect::<BTreeMap<_, _>>(),
        specs: specs.collect(),
    })
}
