//! Results against what a specification admits.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::admissible::{Counts, Judge, Verdict};

/// How a device fared with one specification in a unit.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpecOutcome {
    /// Texels by verdict.
    pub texels: Counts,
    /// States by the narrowest class that holds all their texels; those whose every texel is undefined are that.
    pub states: Counts,
    /// Why nothing was judged, if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_run: Option<String>,
    /// The first result that is not admitted, with its equation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<String>,
}

/// One judge at work on a unit: verdicts of the state in hand, and of those before.
#[derive(Debug)]
pub(super) struct Bench<'a> {
    pub judge: &'a Judge,
    pub outcome: SpecOutcome,
    state: Counts,
}

impl<'a> Bench<'a> {
    pub(super) fn new(judge: &'a Judge) -> Self {
        Self { judge, outcome: SpecOutcome::default(), state: Counts::default() }
    }

    /// Judges texels of the state in hand, several at a time; `describe` words the first that is outside.
    pub(super) fn hear(
        &mut self,
        count: usize,
        verdict: impl Fn(usize) -> Verdict + Sync,
        describe: impl FnOnce(usize) -> String,
    ) {
        const CHUNK: usize = 1024;
        let chunk = |chunk: usize| {
            let (mut counts, mut first) = (Counts::default(), None);
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                let verdict = verdict(i);
                counts.add(Counts::one(verdict));
                if verdict == Verdict::Outside {
                    first.get_or_insert(i);
                }
            }
            (counts, first)
        };
        let join = |mut a: (Counts, Option<usize>), b: (Counts, Option<usize>)| {
            a.0.add(b.0);
            (a.0, a.1.into_iter().chain(b.1).min())
        };
        let (counts, first) =
            (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(|| (Counts::default(), None), join);
        self.state.add(counts);
        if let (None, Some(i)) = (&self.outcome.first, first) {
            self.outcome.first = Some(describe(i));
        }
    }

    /// Ends the state in hand.
    pub(super) fn close(&mut self) {
        let state = std::mem::take(&mut self.state);
        if state.total() > 0 {
            self.outcome.texels.add(state);
            self.outcome.states.add(Counts::one(state.verdict()));
        }
    }

    /// Says why a unit is not judged.
    pub(super) fn leave_out(&mut self, reason: &str) {
        self.outcome.not_run = Some(reason.to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::admissible::{Class, Spec};

    #[test]
    fn a_state_counts_once_by_its_worst_texel() {
        let judge = Judge::new(Spec::Vulkan);
        let mut bench = Bench::new(&judge);
        let verdict = |i: usize| match i {
            1500 | 2100 => Verdict::Outside,
            n if n % 2 == 0 => Verdict::Within(Class::Exact),
            _ => Verdict::Undefined,
        };
        bench.hear(3000, verdict, |i| format!("texel {i}"));
        bench.close();
        bench.hear(10, |_| Verdict::Undefined, |_| unreachable!("nothing is outside"));
        bench.close();
        let SpecOutcome { texels, states, first, .. } = bench.outcome;
        assert_eq!((texels.outside, texels.exact, texels.undefined), (2, 1498, 1510), "texels");
        assert_eq!((states.outside, states.undefined, states.total()), (1, 1, 2), "states");
        assert_eq!(first.as_deref(), Some("texel 1500"), "the first, whatever thread found it");
    }
}
