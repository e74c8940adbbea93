//! What a comparison may end in: five words, what each means, and the exit status that goes with it.
//!
//! Example: a file of three vector lines, one confirmed by the model, one that differs, one of a format the model does not
//! cover, *fails*: [`Verdict::of_parts`] of holds, fails and not covered. Commands, test kit, JUnit files and the report
//! all use these words and no others; `docs/verdicts.md` says the same for users.
//!
//! ```
//! use outmerge::verdict::Verdict;
//!
//! // One question in parts: what was compared counts, and one difference is enough.
//! assert_eq!(Verdict::of_parts([Verdict::Holds, Verdict::NotCovered]), Verdict::Holds);
//! assert_eq!(Verdict::of_parts([Verdict::Holds, Verdict::Fails]), Verdict::Fails);
//! // Nothing compared never passes.
//! assert_eq!(Verdict::of_parts([]), Verdict::NotRun);
//! // Several questions that must all hold.
//! assert_eq!(Verdict::of_all([Verdict::Holds, Verdict::NotRun]), Verdict::NotRun);
//! assert_eq!(Verdict::NotRun.exit_status(), 2);
//! ```

use std::fmt;

/// What a comparison ended in, from saying least to saying most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "json", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "json", serde(rename_all = "kebab-case"))]
pub enum Verdict {
    /// Nothing was compared: nothing was asked for, a device lacks a format, a run was cut short.
    NotRun,
    /// The model, or the specification, says nothing about what was given.
    NotCovered,
    /// Compared, but any of several results is right there, and one of them was found: neither match nor mismatch.
    Undecided,
    /// Compared, and equal, or admitted.
    Holds,
    /// Compared, and different, or a finding; also when a part is missing of what should be whole.
    Fails,
}

impl Verdict {
    /// All of them, in their order.
    pub const ALL: [Self; 5] = [Self::NotRun, Self::NotCovered, Self::Undecided, Self::Holds, Self::Fails];

    /// The word that outputs use.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::NotRun => "not run",
            Self::NotCovered => "not covered",
            Self::Undecided => "undecided",
            Self::Holds => "holds",
            Self::Fails => "fails",
        }
    }

    /// What a whole that ended so means, as the end of a sentence.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::NotRun => "nothing was compared",
            Self::NotCovered => "no rule covers anything that was given",
            Self::Undecided => "nothing that was compared could be decided",
            Self::Holds => "all that was compared is as it should be",
            Self::Fails => "something differs or is missing",
        }
    }

    /// The exit status of a command: 0 holds, 1 fails, 2 where nothing was decided.
    #[must_use]
    pub fn exit_status(self) -> u8 {
        match self {
            Self::Holds => 0,
            Self::Fails => 1,
            Self::NotRun | Self::NotCovered | Self::Undecided => 2,
        }
    }

    /// Whether a test may pass.
    #[must_use]
    pub fn passes(self) -> bool {
        self == Self::Holds
    }

    /// A comparison's, from its counts: what differs, what was compared in all, what of that stays undecided.
    #[must_use]
    pub fn of_counts(different: u64, compared: u64, undecided: u64) -> Self {
        match (different, compared) {
            (1.., _) => Self::Fails,
            (0, 0) => Self::NotRun,
            (0, _) if undecided >= compared => Self::Undecided,
            (0, _) => Self::Holds,
        }
    }

    /// The verdict of one question from its parts: the one that says most. Parts that were not run do not spoil those
    /// that were; no part at all is not run.
    #[must_use]
    pub fn of_parts(parts: impl IntoIterator<Item = Self>) -> Self {
        parts.into_iter().max().unwrap_or(Self::NotRun)
    }

    /// The verdict of several questions each of which must hold: fails if one does, else the one that says least.
    #[must_use]
    pub fn of_all(questions: impl IntoIterator<Item = Self>) -> Self {
        let worst = |a: Self, b: Self| if a == Self::Fails || b == Self::Fails { Self::Fails } else { a.min(b) };
        questions.into_iter().reduce(worst).unwrap_or(Self::NotRun)
    }

    /// A finding makes it fail, nothing found makes it hold; with nothing looked at, it was not run.
    #[must_use]
    pub fn of_search(found: bool, looked_at: usize) -> Self {
        match (found, looked_at) {
            (true, _) => Self::Fails,
            (false, 0) => Self::NotRun,
            (false, _) => Self::Holds,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Verdict::{Fails, Holds, NotCovered, NotRun, Undecided};

    #[test]
    fn only_what_holds_passes_and_ends_with_status_0() {
        for verdict in Verdict::ALL {
            assert_eq!(verdict.passes(), verdict == Holds, "{verdict}");
            assert_eq!(verdict.exit_status() == 0, verdict == Holds, "{verdict}");
        }
        assert_eq!(Fails.exit_status(), 1, "a finding is not an error");
        assert_eq!([NotRun, NotCovered, Undecided].map(Verdict::exit_status), [2; 3], "nothing was decided");
    }

    #[test]
    fn parts_that_were_not_run_neither_spoil_nor_pass() {
        assert_eq!(Verdict::of_parts([NotRun, Holds, NotCovered]), Holds, "the rest holds");
        assert_eq!(Verdict::of_parts([Holds, Fails, NotRun]), Fails, "one difference");
        assert_eq!(Verdict::of_parts([NotRun, NotCovered]), NotCovered, "nothing was compared");
        assert_eq!(Verdict::of_parts([]), NotRun, "no part");
    }

    #[test]
    fn all_questions_must_hold() {
        assert_eq!(Verdict::of_all([Holds, Holds]), Holds, "both");
        assert_eq!(Verdict::of_all([Holds, NotRun]), NotRun, "one was not run");
        assert_eq!(Verdict::of_all([NotRun, Fails, Holds]), Fails, "one fails");
        assert_eq!(Verdict::of_all([Undecided, Holds]), Undecided, "one is open");
        assert_eq!(Verdict::of_all([]), NotRun, "no question");
    }

    #[test]
    fn counts_and_searches_without_anything_are_not_run() {
        assert_eq!(Verdict::of_counts(0, 0, 0), NotRun);
        assert_eq!(Verdict::of_counts(0, 5, 5), Undecided);
        assert_eq!(Verdict::of_counts(0, 5, 4), Holds);
        assert_eq!(Verdict::of_counts(1, 5, 4), Fails);
        assert_eq!([(false, 0), (false, 1), (true, 1)].map(|(f, n)| Verdict::of_search(f, n)), [NotRun, Holds, Fails]);
    }

    #[cfg(feature = "json")]
    #[test]
    fn json_has_the_words_with_dashes() {
        for verdict in Verdict::ALL {
            let json = serde_json::to_string(&verdict).expect("a word");
            assert_eq!(json, format!("\"{}\"", verdict.word().replace(' ', "-")));
        }
    }
}
