//! The whole examination of a blender that can be asked: a conversation on one format, then a check of who is left on every
//! format, by questions that tell the rest apart, by random states, and by clears.

use std::collections::BTreeMap;

use serde::Serialize;
use wgpu_types::{BlendState, ColorWrites};

use super::interrogate::{Options, interrogate};
use super::score::{each, survivors};
use super::telling::aimed;
use super::{Candidate, Fit, Sample, clears, fit, telling};
use crate::format::{Codes, ColorFormat};
use crate::model::{ColorInputs, same_codes};
use crate::state::reads_second_source;
use crate::vectors::{Generator, describe_state};

/// Something that stores texels.
pub trait Blender {
    /// Why it could not answer.
    type Error;

    /// Whether it draws to a format.
    fn renders(&self, format: ColorFormat) -> bool;

    /// Whether it runs a state on a format.
    fn runs(&self, format: ColorFormat, blend: Option<&BlendState>) -> bool;

    /// What it stores for each of these, every channel written.
    ///
    /// # Errors
    /// The blender's own.
    fn merge(&mut self, asked: &[ColorInputs]) -> Result<Vec<Codes>, Self::Error>;

    /// What clears to these colors leave; `None` where it cannot clear.
    ///
    /// # Errors
    /// The blender's own.
    fn clear(&mut self, format: ColorFormat, colors: &[[f32; 4]]) -> Result<Option<Vec<Codes>>, Self::Error>;
}

/// What to ask.
#[derive(Clone, Debug)]
pub struct Question {
    /// The format of the conversation.
    pub first: ColorFormat,
    /// Formats whoever is left is checked on, the first among them if it is to be.
    pub formats: Vec<ColorFormat>,
    /// Samples of the conversation at most; the check takes a few hundred more a format.
    pub budget: usize,
    /// Equal seeds give equal questions.
    pub seed: u64,
}

/// What was asked on one format.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Asked {
    /// The format's name.
    pub format: String,
    /// Texels drawn and compared.
    pub samples: usize,
    /// The states they were drawn with, and the samples of each.
    pub states: BTreeMap<String, usize>,
    /// Colors cleared to and compared.
    pub clears: usize,
}

/// How an examination ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Examination {
    /// Everything drawn, with the answers.
    pub samples: Vec<Sample>,
    /// What the verdict rests on, by format.
    pub asked: Vec<Asked>,
    /// Names of the candidates that may have given every answer; empty for a blender that is none of them.
    pub reproduced_by: Vec<String>,
    /// Whether those left cannot be told apart by any question found on these formats. False where the budget ended first.
    pub settled: bool,
    /// Candidates by mismatches, the best first.
    pub fits: Vec<Fit>,
}

/// Random states of the check on each format, and texels of each.
const STATES: usize = 12;
const TEXELS: usize = 32;

/// Questions of each source of [`telling`](mod@super::telling), whether or not they tell candidates apart: a driver with a rule
/// that no candidate has is found by these.
const AIMED: usize = 128;

/// Telling questions for each pair that is left, on each format.
const TELLING: usize = 12;

/// Candidates of which all pairs are told apart: more are left only on a format where nothing tells them apart.
const PAIRS_OF: usize = 16;

/// Colors cleared to on each format.
const CLEARS: usize = 512;

/// Examines a blender.
///
/// # Errors
/// The blender's own.
pub fn examine<B: Blender>(
    candidates: &[Candidate],
    question: &Question,
    blender: &mut B,
) -> Result<Examination, B::Error> {
    let options = Options { format: question.first, budget: question.budget, seed: question.seed };
    // The conversation borrows the blender twice: what it runs is asked before.
    let runs: Vec<(Option<BlendState>, bool)> = super::Questions::new(question.first, 0)
        .states()
        .iter()
        .map(|state| (*state, blender.runs(question.first, state.as_ref())))
        .collect();
    let runs = |state: Option<&BlendState>| runs.iter().any(|(known, runs)| *runs && known.as_ref() == state);
    let talk = interrogate(candidates, options, runs, |asked| blender.merge(asked))?;
    let named = |name: &String| candidates.iter().position(|candidate| candidate.name() == *name);
    let mut rest: Vec<usize> = talk.reproduced_by.iter().filter_map(named).collect();
    let mut samples = talk.samples;
    let mut cleared: BTreeMap<&'static str, usize> = BTreeMap::new();
    for format in question.formats.iter().copied() {
        if rest.is_empty() {
            break;
        }
        if !blender.renders(format) {
            continue;
        }
        let known = samples.len();
        let mut asked = random(format, question.seed);
        asked.extend(aimed(format, AIMED, question.seed));
        asked.extend(telling_questions(candidates, &rest, format, question.seed));
        asked.retain(|inputs| {
            let blend = inputs.blend.as_ref();
            blender.runs(format, blend) && rest.iter().all(|i| candidates[*i].model().supports(format, blend).is_ok())
        });
        let answers = blender.merge(&asked)?;
        let sample = |(inputs, got)| Sample { inputs, mask: ColorWrites::ALL, got };
        samples.extend(asked.into_iter().zip(answers).map(sample));
        rest = survivors(candidates, &rest, &samples[known..]);
        // Fixed-point blenders say nothing of clears.
        let colors = clears::colors(format, CLEARS, question.seed);
        if rest.iter().any(|i| is_driver(&candidates[*i]))
            && let Some(stored) = blender.clear(format, &colors)?
        {
            cleared.insert(format.name(), colors.len());
            let clears_alike = |i: &usize| {
                let model = candidates[*i].model();
                let same =
                    |(color, codes): (&[f32; 4], &Codes)| same_codes(format, model.clear_color(format, *color), *codes);
                !is_driver(&candidates[*i]) || colors.iter().zip(&stored).all(same)
            };
            rest.retain(clears_alike);
        }
    }
    let reproduced_by: Vec<String> = rest.iter().map(|i| candidates[*i].name()).collect();
    let fits = if rest.is_empty() {
        fit(candidates, &samples)
    } else {
        let undecided = |i: &usize| {
            let model = candidates[*i].model();
            samples.iter().filter(|sample| sample.agreement(model) == crate::model::Agreement::Undecided).count()
        };
        let exact = |i: &usize| Fit {
            model: candidates[*i].name(),
            samples: samples.len(),
            mismatches: 0,
            undecided: undecided(i),
        };
        rest.iter().map(exact).collect()
    };
    let asked = asked(&samples, &cleared);
    let settled = rest.len() <= 1 || talk.settled;
    Ok(Examination { samples, asked, reproduced_by, settled, fits })
}

/// Whether a candidate claims the clears of a driver as well.
fn is_driver(candidate: &Candidate) -> bool {
    candidate.name().starts_with("llvmpipe")
}

/// Random states, separate alpha, all factors and constants among them, on random and special numbers.
fn random(format: ColorFormat, seed: u64) -> Vec<ColorInputs> {
    let mut generator = Generator::new(seed ^ 0x0c4e_c4ed);
    let lines = (0..STATES).map(|_| generator.line(format, TEXELS));
    let lines = lines.filter(|line| line.blend.is_none_or(|blend| !reads_second_source(&blend)));
    lines.flat_map(|line| (0..line.len()).map(|i| line.inputs(i)).collect::<Vec<_>>()).collect()
}

/// What tells the candidates that are left apart, two by two.
fn telling_questions(candidates: &[Candidate], rest: &[usize], format: ColorFormat, seed: u64) -> Vec<ColorInputs> {
    let rest = &rest[..rest.len().min(PAIRS_OF)];
    let pairs: Vec<(usize, usize)> =
        rest.iter().enumerate().flat_map(|(k, a)| rest[k + 1..].iter().map(move |b| (*a, *b))).collect();
    let of = |(a, b): &(usize, usize)| telling(candidates[*a].model(), candidates[*b].model(), format, TELLING, seed);
    each(&pairs, of).concat()
}

/// What samples were asked, by format.
pub(crate) fn asked(samples: &[Sample], cleared: &BTreeMap<&'static str, usize>) -> Vec<Asked> {
    let mut formats: BTreeMap<&'static str, (usize, BTreeMap<String, usize>)> = BTreeMap::new();
    for sample in samples {
        let (count, states) = formats.entry(sample.inputs.format.name()).or_default();
        *count += 1;
        *states.entry(describe_state(sample.inputs.blend.as_ref())).or_default() += 1;
    }
    let of = |(format, (samples, states)): (&'static str, (usize, BTreeMap<String, usize>))| Asked {
        format: format.to_owned(),
        samples,
        states,
        clears: cleared.get(format).copied().unwrap_or(0),
    };
    formats.into_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::layout::FORMATS;
    use crate::identify::candidates;
    use crate::model::NumericModel;
    use crate::model::llvmpipe::{Estimate, Generation, Llvmpipe, VectorWidth};
    use std::convert::Infallible;

    /// A model behind an interface that tells nothing of its name.
    struct Hidden<'a>(&'a dyn NumericModel);

    impl Blender for Hidden<'_> {
        type Error = Infallible;

        fn renders(&self, format: ColorFormat) -> bool {
            self.0.supports(format, None).is_ok()
        }

        fn runs(&self, format: ColorFormat, blend: Option<&BlendState>) -> bool {
            self.0.supports(format, blend).is_ok()
        }

        fn merge(&mut self, asked: &[ColorInputs]) -> Result<Vec<Codes>, Infallible> {
            Ok(asked.iter().map(|inputs| self.0.merge_color(inputs)).collect())
        }

        fn clear(&mut self, format: ColorFormat, colors: &[[f32; 4]]) -> Result<Option<Vec<Codes>>, Infallible> {
            Ok(Some(colors.iter().map(|color| self.0.clear_color(format, *color)).collect()))
        }
    }

    fn question() -> Question {
        let formats: Vec<ColorFormat> = FORMATS.iter().filter_map(|(_, f)| ColorFormat::new(*f).ok()).collect();
        Question { first: ColorFormat::from_name("rgba8unorm").expect("a format"), formats, budget: 4096, seed: 1 }
    }

    fn name(candidates: &[Candidate], model: &dyn NumericModel) -> Vec<String> {
        examine(candidates, &question(), &mut Hidden(model)).expect("models do not fail").reproduced_by
    }

    #[test]
    fn every_generation_width_and_processor_is_named_and_no_other() {
        let candidates = candidates();
        let newest = Llvmpipe::default();
        for generation in Generation::ALL {
            let model = Llvmpipe { generation, ..newest };
            assert_eq!(name(&candidates, &model), [model.name()]);
        }
        let narrow = Llvmpipe { vector_width: VectorWidth::Bits128, ..newest };
        let amd = Llvmpipe { estimate: Estimate::AmdZen5, ..newest };
        for model in [narrow, amd] {
            assert_eq!(name(&candidates, &model), [model.name()]);
        }
    }

    #[test]
    fn a_generation_that_is_no_candidate_is_none() {
        for hidden in Generation::ALL {
            let mut others = candidates();
            others.retain(|candidate| !candidate.name().starts_with(&format!("llvmpipe:mesa={hidden}")));
            let model = Llvmpipe { generation: hidden, ..Llvmpipe::default() };
            assert_eq!(name(&others, &model), Vec::<String>::new(), "{hidden}");
        }
    }

    /// With only older rules known, products alone give the newest generation away on rgba8unorm.
    #[test]
    fn an_unknown_generation_is_none_on_one_format_as_well() {
        let mut others = candidates();
        others.retain(|candidate| !candidate.name().starts_with("llvmpipe:mesa=26.1"));
        others.retain(|candidate| matches!(candidate, Candidate::Named(_)));
        let model = Llvmpipe::default();
        let first = question().first;
        let one = Question { formats: vec![first], ..question() };
        let found = examine(&others, &one, &mut Hidden(&model)).expect("models do not fail");
        assert_eq!(found.reproduced_by, Vec::<String>::new());
    }

    #[test]
    fn the_verdict_names_what_it_rests_on() {
        let model = Llvmpipe::default();
        let found = examine(&candidates(), &question(), &mut Hidden(&model)).expect("models do not fail");
        assert_eq!(found.asked.len(), FORMATS.len(), "every format");
        assert_eq!(found.asked.iter().map(|asked| asked.samples).sum::<usize>(), found.samples.len());
        let first = found.asked.iter().find(|asked| asked.format == "rgba8unorm").expect("asked");
        assert!(first.states.len() > 12 && first.clears == CLEARS, "{first:?}");
    }
}
