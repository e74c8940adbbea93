//! What a run found: a versioned record that can be logged, merged and judged.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Level, Shard, SpecOutcome, Unit};
use crate::vectors::DriverRecord;
use crate::verdict::Verdict;

/// Version of the JSON form.
pub const VERSION: u32 = 2;

/// Which units of a level were asked for, and of whom.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Only units whose name contains this text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub only: Option<String>,
    /// Not the units whose name contains this text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skip: Option<String>,
    /// Texels for each blend state, in place of the level's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texels: Option<u32>,
    /// Whether every model must match; otherwise it is asked whether one does.
    pub every_model: bool,
}

impl Asked {
    /// The units of a level that these shards of it have, in the level's order.
    pub fn units<'a>(&'a self, level: Level, shards: &'a [Shard]) -> impl Iterator<Item = Unit> + 'a {
        let named = |unit: &Unit| {
            let has = |text: &String| unit.id().contains(text);
            self.only.as_ref().is_none_or(has) && !self.skip.as_ref().is_some_and(has)
        };
        let units = super::level::units_of(level, self.texels).into_iter().enumerate();
        units
            .filter(move |(place, unit)| shards.iter().any(|shard| shard.has(*place)) && named(unit))
            .map(|(_, unit)| unit)
    }
}

/// A run's results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    /// [`VERSION`].
    pub version: u32,
    /// The adapter, in one line.
    pub adapter: String,
    /// Driver, version, processor: what the bytes depend on. Absent in results from before it was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driver: Option<DriverRecord>,
    /// The level.
    pub level: Level,
    /// What was asked for.
    pub asked: Asked,
    /// The shards these results cover.
    pub shards: Vec<Shard>,
    /// The models compared with.
    pub models: Vec<String>,
    /// The specifications held against.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub specs: Vec<String>,
    /// The units, in the level's order.
    pub units: Vec<UnitOutcome>,
}

/// One unit's outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnitOutcome {
    /// The unit's name.
    pub unit: String,
    /// Format, for tables.
    pub format: String,
    /// Texels drawn and compared.
    pub texels: u64,
    /// States gone through.
    pub states: u64,
    /// Seconds it took.
    pub seconds: f64,
    /// Why it was not run; then it counts neither for nor against any model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_run: Option<String>,
    /// Which of its states the adapter cannot run; the others count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
    /// By model.
    pub models: BTreeMap<String, ModelOutcome>,
    /// By specification.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub specs: BTreeMap<String, SpecOutcome>,
}

/// How a model fared in a unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelOutcome {
    /// Texels that differ.
    pub mismatches: u64,
    /// Texels whose result depends on the driver's history, and is one of the possible ones: neither match nor mismatch.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub undecided: u64,
    /// States compared.
    pub states: u64,
    /// States without any difference in a texel that is decided.
    pub states_matched: u64,
    /// Why the model was not compared, if it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_run: Option<String>,
    /// The first difference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<String>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl UnitOutcome {
    /// A unit that could not be run.
    #[must_use]
    pub fn not_run(unit: &Unit, reason: impl Into<String>) -> Self {
        Self {
            unit: unit.id(),
            format: unit.format_name().to_owned(),
            texels: 0,
            states: 0,
            seconds: 0.0,
            not_run: Some(reason.into()),
            left_out: None,
            models: BTreeMap::new(),
            specs: BTreeMap::new(),
        }
    }

    /// What comparing the unit with a model ended in, and why where it was not compared.
    #[must_use]
    pub fn with_model(&self, model: &str) -> (Verdict, Option<&str>) {
        match (&self.not_run, self.models.get(model)) {
            (Some(reason), _) => (Verdict::NotRun, Some(reason)),
            (None, None) => (Verdict::NotRun, None),
            (None, Some(ModelOutcome { not_run: Some(reason), .. })) => (Verdict::NotCovered, Some(reason)),
            // A state of no texel was not compared.
            (None, Some(outcome)) if outcome.states == 0 => (Verdict::NotRun, None),
            (None, Some(outcome)) => {
                (Verdict::of_counts(outcome.mismatches, self.texels, outcome.undecided), outcome.first.as_deref())
            }
        }
    }

    /// What judging the unit by a specification ended in, and why where it was not judged.
    #[must_use]
    pub fn with_spec(&self, spec: &str) -> (Verdict, Option<&str>) {
        match (&self.not_run, self.specs.get(spec)) {
            (Some(reason), _) => (Verdict::NotRun, Some(reason)),
            (None, None) => (Verdict::NotRun, None),
            (None, Some(SpecOutcome { not_run: Some(reason), .. })) => (Verdict::NotCovered, Some(reason)),
            (None, Some(outcome)) => (outcome.texels.ended(), outcome.first.as_deref()),
        }
    }
}

/// Results that cannot be merged.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// Nothing to merge.
    #[error("no results given")]
    Empty,
    /// Another schema.
    #[error("results of version {0}; this program reads version {VERSION}")]
    Version(u32),
    /// Different runs.
    #[error("the results differ in {what}: `{a}` and `{b}`; only shards of one run merge")]
    Different {
        /// Member.
        what: &'static str,
        /// One value.
        a: String,
        /// The other.
        b: String,
    },
    /// A unit in both.
    #[error("unit `{0}` is in more than one of the results")]
    Twice(String),
    /// A unit that was not asked for.
    #[error(
        "unit `{0}` is none of those that the results say were asked for; were they made by another version of this program?"
    )]
    Unknown(String),
}

/// What should be there and is not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// Shards of the run.
    pub shards: Vec<Shard>,
    /// Units, each with the model or specification that it lacks, if it lacks only that.
    pub units: Vec<String>,
}

impl Missing {
    /// Whether nothing is missing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shards.is_empty() && self.units.is_empty()
    }
}

impl fmt::Display for Missing {
    /// A line a kind, the first few by name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 8;
        let list = |f: &mut fmt::Formatter<'_>, what: &str, names: Vec<String>| {
            let (count, plural) = (names.len(), if names.len() == 1 { "" } else { "s" });
            let more = if count > SHOWN { format!(", and {} more", count - SHOWN) } else { String::new() };
            let shown = names.into_iter().take(SHOWN).collect::<Vec<_>>().join(", ");
            if count == 0 { Ok(()) } else { writeln!(f, "missing: {count} {what}{plural}: {shown}{more}") }
        };
        list(f, "shard", self.shards.iter().map(Shard::to_string).collect())?;
        list(f, "unit", self.units.clone())
    }
}

impl Results {
    /// Puts shards of one run together; the units come out in the level's order.
    ///
    /// # Errors
    /// [`MergeError`] when they are not shards of one run.
    pub fn merge(parts: Vec<Self>) -> Result<Self, MergeError> {
        let mut parts = parts.into_iter();
        let mut merged = parts.next().ok_or(MergeError::Empty)?;
        for part in std::iter::once(&merged.clone()).chain(parts.as_slice()) {
            if part.version != VERSION {
                return Err(MergeError::Version(part.version));
            }
            let different = |what, a: String, b: String| MergeError::Different { what, a, b };
            if part.adapter != merged.adapter {
                return Err(different("adapter", merged.adapter, part.adapter.clone()));
            }
            if part.driver != merged.driver {
                let text = |driver: &Option<DriverRecord>| {
                    driver.as_ref().map_or("not recorded".to_owned(), ToString::to_string)
                };
                return Err(different("driver", text(&merged.driver), text(&part.driver)));
            }
            if part.level != merged.level {
                return Err(different("level", merged.level.to_string(), part.level.to_string()));
            }
            if part.models != merged.models {
                return Err(different("models", merged.models.join(","), part.models.join(",")));
            }
            if part.specs != merged.specs {
                return Err(different("specifications", merged.specs.join(","), part.specs.join(",")));
            }
            if part.asked != merged.asked {
                return Err(different(
                    "what was asked for",
                    format!("{:?}", merged.asked),
                    format!("{:?}", part.asked),
                ));
            }
            let counts = |results: &Self| results.shards.iter().map(|shard| shard.count).collect::<BTreeSet<_>>();
            if counts(part) != counts(&merged) || counts(part).len() > 1 {
                let text = |results: &Self| results.shards.iter().map(Shard::to_string).collect::<Vec<_>>().join(",");
                return Err(different("number of shards", text(&merged), text(part)));
            }
            let wanted: BTreeSet<String> = part.asked.units(part.level, &part.shards).map(|unit| unit.id()).collect();
            if let Some(unknown) = part.units.iter().find(|unit| !wanted.contains(&unit.unit)) {
                return Err(MergeError::Unknown(unknown.unit.clone()));
            }
        }
        for part in parts {
            merged.shards.extend(part.shards);
            for unit in part.units {
                if merged.units.iter().any(|known| known.unit == unit.unit) {
                    return Err(MergeError::Twice(unit.unit));
                }
                merged.units.push(unit);
            }
        }
        merged.shards.sort_by_key(|shard| shard.index);
        let order: Vec<String> = merged.asked.units(merged.level, &merged.shards).map(|unit| unit.id()).collect();
        merged.units.sort_by_key(|unit| order.iter().position(|id| *id == unit.unit));
        Ok(merged)
    }

    /// What is missing of these shards; with `all_shards`, of the whole run.
    #[must_use]
    pub fn missing(&self, all_shards: bool) -> Missing {
        let count = self.shards.first().map_or(1, |shard| shard.count);
        let all = (1..=count).map(|index| Shard { index, count });
        let shards = all.filter(|shard| all_shards && !self.shards.contains(shard)).collect();
        let there: BTreeMap<&str, &UnitOutcome> = self.units.iter().map(|unit| (unit.unit.as_str(), unit)).collect();
        let mut units = Vec::new();
        for id in self.asked.units(self.level, &self.shards).map(|unit| unit.id()) {
            match there.get(id.as_str()) {
                None => units.push(id),
                Some(UnitOutcome { not_run: Some(_), .. }) => {}
                Some(unit) => {
                    let models = self.models.iter().filter(|model| !unit.models.contains_key(*model));
                    let specs = self.specs.iter().filter(|spec| !unit.specs.contains_key(*spec));
                    units.extend(models.chain(specs).map(|of| format!("{id} by {of}")));
                }
            }
        }
        Missing { shards, units }
    }

    /// What comparing with a model ended in.
    #[must_use]
    pub fn of_model(&self, model: &str) -> Verdict {
        Verdict::of_parts(self.units.iter().map(|unit| unit.with_model(model).0))
    }

    /// What judging by a specification ended in.
    #[must_use]
    pub fn of_spec(&self, spec: &str) -> Verdict {
        Verdict::of_parts(self.units.iter().map(|unit| unit.with_spec(spec).0))
    }

    /// What it all ended in: specifications must hold, and the models that had to match, or else one of those that were
    /// tried. Where something is [missing](Self::missing) it fails.
    #[must_use]
    pub fn verdict(&self, all_shards: bool) -> Verdict {
        let models: Vec<Verdict> = self.models.iter().map(|model| self.of_model(model)).collect();
        let any = if models.contains(&Verdict::Holds) { Verdict::Holds } else { Verdict::of_parts(models.clone()) };
        let models = if self.asked.every_model || models.is_empty() { models } else { vec![any] };
        let complete = if self.missing(all_shards).is_empty() { None } else { Some(Verdict::Fails) };
        Verdict::of_all(models.into_iter().chain(self.specs.iter().map(|spec| self.of_spec(spec))).chain(complete))
    }

    /// Units that were run.
    #[must_use]
    pub fn units_run(&self) -> usize {
        self.units.iter().filter(|unit| unit.not_run.is_none()).count()
    }

    /// Of these formats those of which a unit was not run, or none was asked for, with the reason.
    #[must_use]
    pub fn lacking(&self, formats: &[String]) -> Vec<String> {
        let of = |format: &String| {
            let mut units = self.units.iter().filter(|unit| unit.format == *format).peekable();
            if units.peek().is_none() {
                return Some(format!("{format}: no unit"));
            }
            let unit = units.find(|unit| unit.not_run.is_some())?;
            Some(format!("{format}: unit `{}` was not run: {}", unit.unit, unit.not_run.clone().unwrap_or_default()))
        };
        formats.iter().filter_map(of).collect()
    }

    /// Per model: mismatching texels, states compared, states matched, units not compared.
    #[must_use]
    pub fn totals(&self) -> BTreeMap<String, Totals> {
        let mut totals: BTreeMap<String, Totals> = BTreeMap::new();
        for unit in &self.units {
            for model in &self.models {
                let total = totals.entry(model.clone()).or_default();
                match unit.models.get(model).filter(|outcome| outcome.not_run.is_none()) {
                    Some(outcome) if unit.not_run.is_none() => total.add(unit.texels, outcome),
                    _ => total.units_not_run += 1,
                }
            }
        }
        totals
    }

    /// Per specification: all its units together.
    #[must_use]
    pub fn spec_totals(&self) -> BTreeMap<String, SpecOutcome> {
        let mut totals: BTreeMap<String, SpecOutcome> = BTreeMap::new();
        for (unit, (spec, outcome)) in self.units.iter().flat_map(|unit| unit.specs.iter().map(move |s| (unit, s))) {
            let total = totals.entry(spec.clone()).or_default();
            total.texels.add(outcome.texels);
            total.states.add(outcome.states);
            if let (None, Some(first)) = (&total.first, &outcome.first) {
                total.first = Some(format!("{}: {first}", unit.unit));
            }
        }
        totals
    }

    /// The same by format.
    #[must_use]
    pub fn by_format(&self) -> BTreeMap<String, BTreeMap<String, Totals>> {
        let mut formats: BTreeMap<String, BTreeMap<String, Totals>> = BTreeMap::new();
        for unit in &self.units {
            let row = formats.entry(unit.format.clone()).or_default();
            for (model, outcome) in &unit.models {
                let total = row.entry(model.clone()).or_default();
                if outcome.not_run.is_none() { total.add(unit.texels, outcome) } else { total.units_not_run += 1 }
            }
        }
        formats
    }
}

/// Sums over units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Texels compared.
    pub texels: u64,
    /// Texels that differ.
    pub mismatches: u64,
    /// Texels that are undecided: neither match nor mismatch.
    pub undecided: u64,
    /// States compared.
    pub states: u64,
    /// States without any difference in a texel that is decided.
    pub states_matched: u64,
    /// Units not compared.
    pub units_not_run: u64,
}

impl Totals {
    fn add(&mut self, texels: u64, outcome: &ModelOutcome) {
        self.texels += texels;
        self.mismatches += outcome.mismatches;
        self.undecided += outcome.undecided;
        self.states += outcome.states;
        self.states_matched += outcome.states_matched;
    }
}

/// Results for tests.
#[cfg(test)]
pub(super) mod samples {
    use super::*;

    pub(in crate::conform) fn unit(name: &str) -> UnitOutcome {
        let outcome = ModelOutcome { states: 2, states_matched: 1, mismatches: 3, ..ModelOutcome::default() };
        UnitOutcome {
            unit: name.to_owned(),
            format: "r8unorm".to_owned(),
            texels: 10,
            states: 2,
            seconds: 1.25,
            not_run: None,
            left_out: None,
            models: [("m".to_owned(), outcome)].into(),
            specs: BTreeMap::new(),
        }
    }

    pub(in crate::conform) fn results(units: &[&str]) -> Results {
        Results {
            version: VERSION,
            adapter: "a".to_owned(),
            driver: None,
            level: Level::Quick,
            asked: Asked { every_model: true, ..Asked::default() },
            shards: vec![Shard::ALL],
            models: vec!["m".to_owned()],
            specs: Vec::new(),
            units: units.iter().map(|name| unit(name)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::samples::{results, unit};
    use super::*;

    const HALVES: [Shard; 2] = [Shard { index: 1, count: 2 }, Shard { index: 2, count: 2 }];

    /// The units that a shard has, all of them run, of the first few of the level.
    fn part(shard: Shard) -> Results {
        let asked = Asked { only: Some("r8unorm".to_owned()), every_model: true, ..Asked::default() };
        let units = asked.units(Level::Quick, &[shard]).map(|unit| self::unit(&unit.id())).collect();
        Results { shards: vec![shard], asked, units, ..results(&[]) }
    }

    fn without_mismatches(mut results: Results) -> Results {
        for unit in &mut results.units {
            unit.models
                .insert("m".to_owned(), ModelOutcome { states: 2, states_matched: 2, ..ModelOutcome::default() });
        }
        results
    }

    #[test]
    fn shards_merge_into_the_level_s_order() {
        let [first, second] = HALVES.map(part);
        let asked = first.asked.clone();
        let sum = 3 * (first.units.len() + second.units.len()) as u64;
        let merged = Results::merge(vec![second, first]).expect("shards of one run");
        let order: Vec<String> = asked.units(Level::Quick, &[Shard::ALL]).map(|unit| unit.id()).collect();
        assert_eq!(merged.units.iter().map(|u| u.unit.clone()).collect::<Vec<_>>(), order, "order");
        assert_eq!((merged.totals()["m"].mismatches, merged.shards.clone()), (sum, HALVES.to_vec()), "sum");
        assert!(merged.missing(true).is_empty(), "nothing is missing");
    }

    #[test]
    fn only_shards_of_one_run_merge() {
        let [first, second] = HALVES.map(part);
        let different =
            |other: Results| matches!(Results::merge(vec![first.clone(), other]), Err(MergeError::Different { .. }));
        assert!(different(Results { adapter: "b".to_owned(), ..second.clone() }), "adapter");
        assert!(different(Results { level: Level::Full, ..second.clone() }), "level");
        assert!(different(Results { models: Vec::new(), ..second.clone() }), "models");
        assert!(different(Results { specs: vec!["d3d".to_owned()], ..second.clone() }), "specifications");
        assert!(different(Results { asked: Asked::default(), ..second.clone() }), "what was asked for");
        assert!(
            different(Results { shards: vec![Shard { index: 3, count: 3 }], units: Vec::new(), ..second.clone() }),
            "shards"
        );
        let twice = Results::merge(vec![first.clone(), first.clone()]);
        assert_eq!(twice, Err(MergeError::Twice(first.units[0].unit.clone())), "the same unit");
        assert_eq!(Results::merge(Vec::new()), Err(MergeError::Empty), "nothing");
        let mut foreign = second;
        foreign.units.push(unit("blend/r8unorm/no-such-unit"));
        assert!(matches!(Results::merge(vec![foreign]), Err(MergeError::Unknown(_))), "a unit of no level");
        let old = Results { version: 1, ..first };
        assert_eq!(Results::merge(vec![old]), Err(MergeError::Version(1)), "another version");
    }

    #[test]
    fn a_lost_shard_or_unit_fails_whatever_the_rest_says() {
        let [first, second] = HALVES.map(part).map(without_mismatches);
        let whole = Results::merge(vec![first.clone(), second]).expect("shards of one run");
        assert_eq!(whole.verdict(true), Verdict::Holds, "all there");
        assert_eq!((first.verdict(false), first.verdict(true)), (Verdict::Holds, Verdict::Fails), "one of two");
        assert_eq!(first.missing(true).to_string(), "missing: 1 shard: 2/2\n");
        let mut lost = whole.clone();
        let unit = lost.units.pop().expect("units").unit;
        assert_eq!(lost.verdict(true), Verdict::Fails, "a unit fewer");
        assert_eq!(lost.missing(true).to_string(), format!("missing: 1 unit: {unit}\n"));
        let mut unasked = whole;
        unasked.units[0].models.clear();
        assert_eq!(unasked.verdict(true), Verdict::Fails, "a unit without the model");
        assert!(unasked.missing(true).to_string().ends_with(" by m\n"), "{}", unasked.missing(true));
    }

    #[test]
    fn named_models_must_all_hold_and_of_others_one() {
        let mut results = without_mismatches(Results::merge(HALVES.map(part).to_vec()).expect("shards"));
        results.models.push("n".to_owned());
        let bad = ModelOutcome { states: 2, mismatches: 1, ..ModelOutcome::default() };
        results.units.iter_mut().for_each(|unit| drop(unit.models.insert("n".to_owned(), bad.clone())));
        assert_eq!(results.verdict(true), Verdict::Fails, "n was asked for");
        results.asked.every_model = false;
        assert_eq!(results.verdict(true), Verdict::Holds, "m matches");
        let absent = ModelOutcome { not_run: Some("too slow".to_owned()), ..ModelOutcome::default() };
        results.asked.every_model = true;
        results.units.iter_mut().for_each(|unit| drop(unit.models.insert("n".to_owned(), absent.clone())));
        assert_eq!(results.verdict(true), Verdict::NotCovered, "m holds, but n says nothing");
        for unit in &mut results.units {
            *unit = UnitOutcome {
                not_run: Some("no device".to_owned()),
                ..UnitOutcome { models: BTreeMap::new(), ..unit.clone() }
            };
        }
        assert_eq!(results.verdict(true), Verdict::NotRun, "nothing was run");
        assert_eq!(results.totals()["m"].units_not_run, results.units.len() as u64, "units not run are counted");
    }

    #[test]
    fn units_whose_every_texel_is_undecided_pass_for_nothing() {
        let outcome = ModelOutcome { states: 2, states_matched: 2, undecided: 10, ..ModelOutcome::default() };
        let mut unit = unit("u");
        unit.models.insert("m".to_owned(), outcome);
        assert_eq!(unit.with_model("m"), (Verdict::Undecided, None));
        assert_eq!(unit.with_model("other"), (Verdict::NotRun, None));
    }

    #[test]
    fn required_formats_must_have_units_that_were_all_run() {
        let mut results = results(&["a", "b"]);
        let formats = ["r8unorm".to_owned(), "rg8unorm".to_owned()];
        assert_eq!(results.lacking(&formats), ["rg8unorm: no unit"]);
        results.units[1].not_run = Some("no such format".to_owned());
        assert_eq!(results.lacking(&formats[..1]), ["r8unorm: unit `b` was not run: no such format"]);
        assert_eq!(results.units_run(), 1);
    }
}
