//! Samples against candidates.

use super::{Candidate, Sample};
use crate::model::Agreement;

/// How well a model reproduces samples.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Fit {
    /// The model's name.
    pub model: String,
    /// Samples compared: those whose format and state the model covers.
    pub samples: usize,
    /// Samples it stores something else for.
    pub mismatches: usize,
    /// Samples whose result depends on the driver's history by this model, and is a possible one: neither match nor mismatch.
    pub undecided: usize,
}

impl Fit {
    /// Whether every sample was compared and reproduced.
    #[must_use]
    pub fn is_exact(&self, samples: usize) -> bool {
        self.mismatches == 0 && self.samples == samples && samples > self.undecided
    }

    /// Mismatches in parts of one; 1 where nothing could be compared.
    #[must_use]
    pub fn rate(&self) -> f64 {
        if self.samples == 0 { 1.0 } else { ratio(self.mismatches, self.samples) }
    }
}

fn ratio(a: usize, b: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "counts of samples are far below 2^53")]
    let quotient = a as f64 / b as f64;
    quotient
}

/// Members of the family that stay in the search after each of its steps, by mismatches; those without any stay anyway.
const STEPS: [(usize, usize); 4] = [(8, 20_000), (32, 4000), (256, 200), (2048, 40)];

/// Every candidate that reproduces all samples, and the best of the others: all named models, and the members of the
/// family that led at every step of the search. Best first; equals in the order of the candidates.
#[must_use]
pub fn fit(candidates: &[Candidate], samples: &[Sample]) -> Vec<Fit> {
    let mixed = mixed(samples);
    let compare = |candidate: &Candidate, samples: &[Sample]| {
        let model = candidate.model();
        let known = |sample: &&Sample| model.supports(sample.inputs.format, sample.inputs.blend.as_ref()).is_ok();
        let (mut compared, mut mismatches, mut undecided) = (0, 0, 0);
        for sample in samples.iter().filter(known) {
            compared += 1;
            let agreement = sample.agreement(model);
            mismatches += usize::from(agreement == Agreement::Different);
            undecided += usize::from(agreement == Agreement::Undecided);
        }
        (compared, mismatches, undecided)
    };
    let mut rest: Vec<usize> = (0..candidates.len()).collect();
    for (count, kept) in STEPS.into_iter().filter(|(count, _)| *count < mixed.len()) {
        let scored = each(&rest, |i| compare(&candidates[*i], &mixed[..count]));
        let named = |i: usize| matches!(candidates[i], Candidate::Named(_));
        let mut order: Vec<(usize, (usize, usize, usize))> = rest.iter().copied().zip(scored).collect();
        order.sort_by_key(|(i, (compared, mismatches, _))| (!named(*i), *mismatches + count - *compared));
        let stays = |(place, (i, (compared, mismatches, _))): (usize, &(usize, (usize, usize, usize)))| {
            (place < kept || named(*i) || (*mismatches == 0 && *compared == count)).then_some(*i)
        };
        rest = order.iter().enumerate().filter_map(stays).collect();
        rest.sort_unstable();
    }
    let scored = each(&rest, |i| compare(&candidates[*i], &mixed));
    let fit = |(i, (samples, mismatches, undecided)): (&usize, (usize, usize, usize))| Fit {
        model: candidates[*i].name(),
        samples,
        mismatches,
        undecided,
    };
    let mut fits: Vec<Fit> = rest.iter().zip(scored).map(fit).collect();
    // Stable, so equals stay in order; a model that covers fewer samples is no better fit.
    fits.sort_by_key(|fit| fit.mismatches + mixed.len() - fit.samples);
    fits
}

/// Those of `rest` that reproduce every sample.
pub(super) fn survivors(candidates: &[Candidate], rest: &[usize], samples: &[Sample]) -> Vec<usize> {
    let mixed = mixed(samples);
    let survives = |i: &usize| {
        let model = candidates[*i].model();
        mixed.iter().all(|sample| {
            model.supports(sample.inputs.format, sample.inputs.blend.as_ref()).is_ok() && sample.is_possible_for(model)
        })
    };
    let kept = each(rest, survives);
    rest.iter().zip(kept).filter(|(_, kept)| *kept).map(|(i, _)| *i).collect()
}

/// Samples in an order that brings different states early, the same every time.
fn mixed(samples: &[Sample]) -> Vec<Sample> {
    let mut mixed = samples.to_vec();
    fastrand::Rng::with_seed(1).shuffle(&mut mixed);
    mixed
}

/// The results for each item, on all threads where there are some.
#[cfg(feature = "parallel")]
pub(super) fn each<T: Sync, R: Send>(items: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    use rayon::prelude::*;
    let run = &run;
    items.par_iter().map(run).collect()
}

/// The results for each item.
#[cfg(not(feature = "parallel"))]
pub(super) fn each<T, R>(items: &[T], run: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(run).collect()
}
