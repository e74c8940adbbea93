//! The conversation: ask, drop every candidate that would have answered otherwise, ask what tells the others apart.

use std::collections::HashMap;

use super::score::{each, survivors};
use super::{Candidate, Fit, Questions, Sample, fit};
use crate::format::{ChannelKind, Codes, ColorFormat};
use crate::model::ColorInputs;
use wgpu_types::{BlendState, ColorWrites};

/// How to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The format asked about.
    pub format: ColorFormat,
    /// Samples at most.
    pub budget: usize,
    /// Equal seeds give equal conversations with equal blenders.
    pub seed: u64,
}

impl Options {
    /// 4096 samples.
    #[must_use]
    pub fn new(format: ColorFormat) -> Self {
        Self { format, budget: 4096, seed: 1 }
    }
}

/// How a conversation ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrogation {
    /// Everything asked, with the answers.
    pub samples: Vec<Sample>,
    /// Names of the candidates that would have given every answer; empty for a blender that is none of them.
    pub reproduced_by: Vec<String>,
    /// Whether they are one and the same as far as many more questions tell. False where the budget ended first.
    pub settled: bool,
    /// Candidates by mismatches, the best first.
    pub fits: Vec<Fit>,
}

/// Questions before any candidate is dropped.
const OPENING: usize = 192;
/// Questions a batch after that.
const BATCH: usize = 64;
/// Questions looked at for each batch.
const POOL: usize = 2048;
/// Candidates whose answers are compared to choose among them.
const JURY: usize = 48;
/// Pools in a row in which no question tells the candidates apart, after which they are called the same.
const QUIET: usize = 8;

/// Asks `blender` until one candidate is left, or those left cannot be told apart, or the budget is used up. Questions
/// are put in batches of one blend constant; `runs` says which states the blender has.
///
/// # Errors
/// The blender's own.
pub fn interrogate<E>(
    candidates: &[Candidate],
    options: Options,
    runs: impl Fn(Option<&BlendState>) -> bool,
    mut blender: impl FnMut(&[ColorInputs]) -> Result<Vec<Codes>, E>,
) -> Result<Interrogation, E> {
    let mut questions = Questions::new(options.format, options.seed).only(&runs);
    let mut samples: Vec<Sample> = Vec::new();
    let mut put = |asked: Vec<ColorInputs>, samples: &mut Vec<Sample>| -> Result<(), E> {
        let answers = blender(&asked)?;
        let sample = |(inputs, got)| Sample { inputs, mask: ColorWrites::ALL, got };
        samples.extend(asked.into_iter().zip(answers).map(sample));
        Ok(())
    };
    put((0..OPENING.min(options.budget)).map(|_| questions.ask()).collect(), &mut samples)?;
    let covers = |i: &usize| {
        let model = candidates[*i].model();
        questions.states().iter().all(|state| model.supports(options.format, state.as_ref()).is_ok())
    };
    let all: Vec<usize> = (0..candidates.len()).filter(covers).collect();
    let mut rest = survivors(candidates, &all, &samples);
    let mut settled = rest.len() <= 1;
    while rest.len() > 1 && samples.len() < options.budget {
        let wanted = BATCH.min(options.budget - samples.len());
        let asked = batch(candidates, &rest, &mut questions, wanted);
        if asked.is_empty() {
            settled = true;
            break;
        }
        let known = samples.len();
        put(asked, &mut samples)?;
        rest = survivors(candidates, &rest, &samples[known..]);
        settled = rest.len() <= 1;
    }
    let fits = if rest.is_empty() { fit(candidates, &samples) } else { Vec::new() };
    let reproduced_by: Vec<String> = rest.iter().map(|i| candidates[*i].name()).collect();
    let exact = reproduced_by.iter().map(|model| Fit {
        model: model.clone(),
        samples: samples.len(),
        mismatches: 0,
        undecided: 0,
    });
    let fits = if fits.is_empty() { exact.collect() } else { fits };
    Ok(Interrogation { samples, reproduced_by, settled, fits })
}

/// Questions, at most `count`, whose answers would tell the candidates that reproduce `samples` apart; none where no
/// question found does. Without samples they are the most telling of all.
#[must_use]
pub fn propose(candidates: &[Candidate], samples: &[Sample], format: ColorFormat, count: usize) -> Vec<ColorInputs> {
    let covers = |i: &usize| candidates[*i].model().supports(format, None).is_ok();
    let all: Vec<usize> = (0..candidates.len()).filter(covers).collect();
    let rest = survivors(candidates, &all, samples);
    let mut questions = Questions::new(format, 2);
    let runs = |state: Option<&BlendState>| rest.iter().all(|i| candidates[*i].model().supports(format, state).is_ok());
    questions = questions.only(runs);
    batch(candidates, &rest, &mut questions, count)
}

/// The most telling questions of a pool; pools are gone through until one has any.
fn batch(candidates: &[Candidate], rest: &[usize], questions: &mut Questions, count: usize) -> Vec<ColorInputs> {
    if rest.len() < 2 {
        return Vec::new();
    }
    for turn in 0..QUIET {
        questions.renew_constant();
        let pool: Vec<ColorInputs> = (0..POOL).map(|_| questions.ask()).collect();
        // Evenly spread over those left, others each turn.
        let jury: Vec<usize> = if rest.len() <= JURY {
            rest.to_vec()
        } else {
            (0..JURY).map(|k| rest[(k * QUIET + turn) * rest.len() / (JURY * QUIET)]).collect()
        };
        let spread = each(&pool, |question| disagreement(candidates, &jury, question));
        let mut order: Vec<usize> = (0..pool.len()).filter(|i| spread[*i] > 0.0).collect();
        order.sort_by(|a, b| spread[*b].total_cmp(&spread[*a]));
        order.truncate(count);
        if !order.is_empty() {
            return order.into_iter().map(|i| pool[i]).collect();
        }
    }
    Vec::new()
}

/// Entropy of the candidates' answers, in bits.
fn disagreement(candidates: &[Candidate], jury: &[usize], question: &ColorInputs) -> f64 {
    let mut answers: HashMap<Codes, u32> = HashMap::new();
    for i in jury {
        let model = candidates[*i].model();
        // What a driver's history decides tells nothing.
        if model.alternative(question).is_some() {
            continue;
        }
        let mut codes = model.merge_color(question);
        for (code, kind) in codes.iter_mut().zip(question.format.channels()) {
            // Any NaN equals any NaN.
            if let ChannelKind::Float(layout) = kind
                && layout.is_nan(*code)
            {
                *code = layout.nan();
            }
        }
        *answers.entry(codes).or_default() += 1;
    }
    let total: f64 = answers.values().map(|count| f64::from(*count)).sum();
    if total == 0.0 {
        return 0.0;
    }
    let part = |count: &u32| {
        let p = f64::from(*count) / total;
        -p * p.log2()
    };
    answers.values().map(part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{candidates, family};
    use crate::model::fixed::FixedPoint;
    use crate::model::{NumericModel, registry};
    use std::convert::Infallible;

    fn format() -> ColorFormat {
        ColorFormat::from_name("rgba8unorm").expect("a format")
    }

    fn question(model: &dyn NumericModel, options: Options, candidates: &[Candidate]) -> Interrogation {
        let answer = |asked: &[ColorInputs]| -> Result<Vec<Codes>, Infallible> {
            Ok(asked.iter().map(|inputs| model.merge_color(inputs)).collect())
        };
        let runs = |state: Option<&BlendState>| model.supports(options.format, state).is_ok();
        interrogate(candidates, options, runs, answer).expect("models do not fail")
    }

    #[test]
    fn named_models_are_named_from_their_answers() {
        let candidates = candidates();
        for name in ["exact", "f32", "f16", "llvmpipe", "swiftshader"] {
            let model = registry::by_name(name).expect("a model");
            let found = question(model.as_ref(), Options::new(format()), &candidates);
            assert!(found.reproduced_by.contains(&model.name()), "{name}: {:?}", found.reproduced_by);
            assert!(found.settled && found.samples.len() <= 4096, "{name}: {} samples", found.samples.len());
            // Whatever else is named cannot be told from it on this format.
            for other in &found.reproduced_by {
                same(model.as_ref(), registry::by_name(other).expect("a model").as_ref());
            }
        }
    }

    /// Both answer many further questions alike.
    fn same(a: &dyn NumericModel, b: &dyn NumericModel) {
        let mut questions = Questions::new(format(), 99);
        for _ in 0..20_000 {
            let inputs = questions.ask();
            assert_eq!(a.merge_color(&inputs), b.merge_color(&inputs), "{} and {}: {inputs:?}", a.name(), b.name());
        }
    }

    #[test]
    fn a_hidden_member_of_the_family_is_recovered_from_at_most_4096_samples() {
        let candidates = candidates();
        let members: Vec<FixedPoint> = family().collect();
        let mut random = fastrand::Rng::with_seed(20_261_123);
        for seed in 0..12 {
            let hidden = members[random.usize(..members.len())];
            let found = question(&hidden, Options { seed, ..Options::new(format()) }, &candidates);
            let name = hidden.to_string();
            assert!(found.reproduced_by.contains(&name), "{name}: {:?}", found.reproduced_by);
            assert!(found.settled, "{name}: {} candidates after {}", found.reproduced_by.len(), found.samples.len());
            assert!(found.samples.len() <= 4096, "{name}: {} samples", found.samples.len());
        }
    }

    /// One code off in one texel of a thousand, where nothing else is.
    #[derive(Debug)]
    struct Unheard;

    impl NumericModel for Unheard {
        fn name(&self) -> String {
            "unheard".to_owned()
        }

        fn provenance(&self) -> String {
            "a test".to_owned()
        }

        fn supports(&self, _: ColorFormat, _: Option<&BlendState>) -> Result<(), crate::model::Unsupported> {
            Ok(())
        }

        fn merge_color(&self, inputs: &ColorInputs) -> Codes {
            let mut codes = registry::by_name("exact").expect("a model").merge_color(inputs);
            if inputs.dst[0] % 16 == 7 {
                codes[0] ^= 1;
            }
            codes
        }

        fn explain_color(&self, _: &ColorInputs) -> crate::model::Explanation {
            unimplemented!("never asked")
        }

        fn depth_code(&self, kind: crate::format::depth::DepthKind, z: f32, range: [f32; 2]) -> u32 {
            kind.encode(z, range)
        }
    }

    #[test]
    fn a_blender_that_is_none_of_them_is_called_none_with_its_nearest_relatives() {
        let found = question(&Unheard, Options::new(format()), &candidates());
        assert_eq!(found.reproduced_by, Vec::<String>::new(), "none");
        let best = &found.fits[0];
        assert!(best.mismatches > 0 && best.rate() < 0.2, "{best:?}");
        let exact = found.fits.iter().find(|fit| fit.model == "exact").expect("a named model is always ranked");
        assert!(exact.rate() < 0.2, "what it was made from: {exact:?}");
    }

    #[test]
    fn proposed_questions_tell_the_remaining_candidates_apart() {
        let candidates = candidates();
        let model = registry::by_name("f32").expect("a model");
        let mut questions = Questions::new(format(), 5);
        let sample = |inputs: ColorInputs| Sample { inputs, mask: ColorWrites::ALL, got: model.merge_color(&inputs) };
        let samples: Vec<Sample> = (0..40).map(|_| sample(questions.ask())).collect();
        let all: Vec<usize> = (0..candidates.len()).collect();
        let before = survivors(&candidates, &all, &samples);
        assert!(before.len() > 1, "40 samples leave a choice");
        let asked = propose(&candidates, &samples, format(), 64);
        assert!(!asked.is_empty(), "there is something to ask");
        let answers: Vec<Sample> = asked.into_iter().map(sample).collect();
        let after = survivors(&candidates, &before, &answers);
        assert!(after.len() < before.len(), "{} of {} left", after.len(), before.len());
    }
}
