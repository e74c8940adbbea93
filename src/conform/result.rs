//! What a run found: a versioned record that can be logged, merged and judged.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Level, SpecOutcome};
use crate::vectors::DriverRecord;

/// Version of the JSON form.
pub const VERSION: u32 = 1;

/// A run's results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The shards these results cover, `i/n`.
    pub shards: Vec<String>,
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
    pub fn not_run(unit: &super::Unit, reason: impl Into<String>) -> Self {
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
        // Blend units may have another number of texels than the level's, which their names end with.
        let stem = |id: &str| match id.strip_prefix("blend/").and_then(|rest| rest.match_indices('/').nth(1)) {
            Some((end, _)) => id[..end + "blend/".len()].to_owned(),
            None => id.to_owned(),
        };
        let order: Vec<String> = super::level::units(merged.level).iter().map(|unit| stem(&unit.id())).collect();
        merged.units.sort_by_key(|unit| order.iter().position(|id| *id == stem(&unit.unit)));
        Ok(merged)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn part(shard: &str, unit: &str) -> Results {
        let outcome = ModelOutcome { states: 2, states_matched: 1, mismatches: 3, ..ModelOutcome::default() };
        Results {
            version: VERSION,
            adapter: "a".to_owned(),
            driver: None,
            level: Level::Quick,
            shards: vec![shard.to_owned()],
            models: vec!["m".to_owned()],
            specs: Vec::new(),
            units: vec![UnitOutcome {
                unit: unit.to_owned(),
                format: "f".to_owned(),
                texels: 10,
                states: 2,
                seconds: 1.0,
                not_run: None,
                left_out: None,
                models: [("m".to_owned(), outcome)].into(),
                specs: BTreeMap::new(),
            }],
        }
    }

    #[test]
    fn shards_merge_into_the_level_s_order() {
        let ids: Vec<String> =
            crate::conform::level::units(Level::Quick).iter().map(crate::conform::Unit::id).collect();
        let merged = Results::merge(vec![part("2/2", &ids[1]), part("1/2", &ids[0])]).expect("shards of one run");
        assert_eq!(merged.units.iter().map(|u| u.unit.clone()).collect::<Vec<_>>(), ids[..2], "order");
        assert_eq!(merged.totals()["m"].mismatches, 6, "sum");
    }

    #[test]
    fn only_shards_of_one_run_merge() {
        let other = Results { adapter: "b".to_owned(), ..part("2/2", "y") };
        assert!(matches!(Results::merge(vec![part("1/2", "x"), other]), Err(MergeError::Different { .. })), "adapter");
        let twice = Results::merge(vec![part("1/2", "x"), part("2/2", "x")]);
        assert_eq!(twice, Err(MergeError::Twice("x".to_owned())), "the same unit");
        assert_eq!(Results::merge(Vec::new()), Err(MergeError::Empty), "nothing");
    }
}
