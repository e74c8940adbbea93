//! How many texels or states got each verdict.

use super::{Class, Verdict};
use crate::verdict::Verdict as Ended;

/// Numbers by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts {
    /// Correctly rounded.
    pub exact: u64,
    /// Within the store's tolerance and binary32.
    pub tight: u64,
    /// Within what a blender as coarse as the target may store.
    pub wide: u64,
    /// Not admitted.
    pub outside: u64,
    /// Where any result conforms; these count for nothing.
    pub undefined: u64,
}

impl Counts {
    /// One result of this verdict.
    #[must_use]
    pub fn one(verdict: Verdict) -> Self {
        let mut counts = Self::default();
        *counts.slot(verdict) = 1;
        counts
    }

    fn slot(&mut self, verdict: Verdict) -> &mut u64 {
        match verdict {
            Verdict::Within(Class::Exact) => &mut self.exact,
            Verdict::Within(Class::Tight) => &mut self.tight,
            Verdict::Within(Class::Wide) => &mut self.wide,
            Verdict::Outside => &mut self.outside,
            Verdict::Undefined => &mut self.undefined,
        }
    }

    /// Adds others.
    pub fn add(&mut self, other: Self) {
        self.exact += other.exact;
        self.tight += other.tight;
        self.wide += other.wide;
        self.outside += other.outside;
        self.undefined += other.undefined;
    }

    /// In the order of [`Verdict::NAMES`].
    #[must_use]
    pub fn in_order(&self) -> [u64; 5] {
        [self.exact, self.tight, self.wide, self.outside, self.undefined]
    }

    /// Everything counted, undefined results included.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.in_order().iter().sum()
    }

    /// The narrowest class that holds all of them; outside if one is. Undefined results say nothing, unless there are no
    /// others.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match () {
            () if self.outside > 0 => Verdict::Outside,
            () if self.wide > 0 => Verdict::Within(Class::Wide),
            () if self.tight > 0 => Verdict::Within(Class::Tight),
            () if self.exact > 0 => Verdict::Within(Class::Exact),
            () => Verdict::Undefined,
        }
    }

    /// What judging them ended in: undefined results alone are not covered, as any result conforms.
    #[must_use]
    pub fn ended(&self) -> Ended {
        match (self.outside, self.total() - self.undefined) {
            (1.., _) => Ended::Fails,
            (0, 1..) => Ended::Holds,
            (0, 0) if self.undefined > 0 => Ended::NotCovered,
            (0, 0) => Ended::NotRun,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undefined_results_alone_decide_nothing() {
        let undefined = Counts::one(Verdict::Undefined);
        assert_eq!((Counts::default().ended(), undefined.ended()), (Ended::NotRun, Ended::NotCovered));
        for (verdict, ended) in [(Verdict::Within(Class::Wide), Ended::Holds), (Verdict::Outside, Ended::Fails)] {
            let mut counts = undefined;
            counts.add(Counts::one(verdict));
            assert_eq!(counts.ended(), ended, "with {verdict:?}");
        }
    }

    #[test]
    fn the_widest_class_in_use_is_the_verdict() {
        let mut counts = Counts::one(Verdict::Undefined);
        assert_eq!(counts.verdict(), Verdict::Undefined, "nothing else");
        for (more, verdict) in [
            (Verdict::Within(Class::Exact), Verdict::Within(Class::Exact)),
            (Verdict::Within(Class::Wide), Verdict::Within(Class::Wide)),
            (Verdict::Within(Class::Tight), Verdict::Within(Class::Wide)),
            (Verdict::Outside, Verdict::Outside),
        ] {
            counts.add(Counts::one(more));
            assert_eq!(counts.verdict(), verdict, "with {more:?}");
        }
        assert_eq!((counts.total(), counts.in_order()), (5, [1, 1, 1, 1, 1]), "one of each");
    }
}
