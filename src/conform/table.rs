//! Results for reading: a table for the terminal, and the same as Markdown for documentation.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::SpecOutcome;
use super::result::{Results, Totals};
use crate::admissible;
use crate::verdict::Verdict;

/// The table, what was not run and why, what is missing (with `all_shards`, of the whole run), and the verdicts.
#[must_use]
pub fn text(results: &Results, all_shards: bool) -> String {
    let mut text = format!("{}\n", results.adapter);
    if let Some(driver) = &results.driver {
        let _ = writeln!(text, "{driver}");
        driver.warning.iter().for_each(|warning| text.push_str(&format!("{warning}\n")));
    }
    let _ = write!(text, "level {}, shard {}\n\n", results.level, shards(results));
    if !results.models.is_empty() {
        let _ = write!(text, "{:18}{:>14}", "states matched", "texels");
        for model in &results.models {
            let _ = write!(text, " {model:>14}");
        }
        text.push('\n');
        for (format, texels, cells) in rows(results) {
            let _ = write!(text, "{format:18}{texels:>14}");
            for cell in cells {
                let _ = write!(text, " {cell:>14}");
            }
            text.push('\n');
        }
    }
    for spec in &results.specs {
        let _ = write!(text, "\n{:18}{:>14}", format!("states by {spec}"), "texels");
        admissible::Verdict::NAMES.iter().for_each(|name| text.push_str(&format!(" {name:>9}")));
        text.push('\n');
        for (format, outcome) in spec_rows(results, spec) {
            let _ = write!(text, "{format:18}{:>14}", outcome.texels.total());
            outcome.states.in_order().iter().for_each(|count| text.push_str(&format!(" {count:>9}")));
            text.push('\n');
        }
    }
    for line in not_compared(results) {
        let _ = writeln!(text, "{line}");
    }
    let _ = writeln!(text, "{}", results.missing(all_shards));
    for (spec, outcome) in results.spec_totals() {
        let _ = writeln!(text, "{spec:14} {}", spec_verdict(results.of_spec(&spec), &outcome));
        for deviation in deviations(results, &spec) {
            let _ = writeln!(text, "{:14} {deviation}", "");
        }
    }
    for (model, total) in results.totals() {
        let _ = writeln!(text, "{model:14} {}", verdict(results.of_model(&model), total));
        if let Some((unit, first)) = first_difference(results, &model) {
            let _ = writeln!(text, "{:14} first in {unit}: {first}", "");
        }
    }
    let all = results.verdict(all_shards);
    let _ = writeln!(text, "\nin all: {all}: {}", all.meaning());
    text
}

fn shards(results: &Results) -> String {
    results.shards.iter().map(super::Shard::to_string).collect::<Vec<_>>().join(", ")
}

/// The same as a Markdown page.
#[must_use]
pub fn markdown(results: &Results, all_shards: bool) -> String {
    let arguments: String = results.specs.iter().map(|spec| format!(" --spec {spec}")).collect();
    let title = if results.models.is_empty() { "What specifications say of" } else { "Which models match" };
    let models = "A state matches a model when every texel does, bit for bit.";
    let specs =
        "A state counts in the narrowest class that holds all its texels; where every result conforms, as undefined.";
    let rule = match (results.models.is_empty(), results.specs.is_empty()) {
        (true, _) => specs.to_owned(),
        (_, true) => models.to_owned(),
        _ => format!("{models} {specs}"),
    };
    let mut text = format!(
        "# {title} {}\n\nMade by `outmerge conform --level {}{arguments} --markdown FILE`. {rule}\n\n",
        results.adapter, results.level
    );
    if let Some(driver) = &results.driver {
        let _ = writeln!(text, "Driver: {driver}.");
        driver.warning.iter().for_each(|warning| text.push_str(&format!("{warning}.\n")));
        text.push('\n');
    }
    if !results.models.is_empty() {
        let _ = writeln!(text, "| states matched | texels | {} |", results.models.join(" | "));
        let _ = writeln!(text, "|---|--:|{}", "--:|".repeat(results.models.len()));
        for (format, texels, cells) in rows(results) {
            let _ = writeln!(text, "| {format} | {texels} | {} |", cells.join(" | "));
        }
        text.push('\n');
    }
    for spec in &results.specs {
        let _ = writeln!(text, "| states by {spec} | texels | {} |", admissible::Verdict::NAMES.join(" | "));
        let _ = writeln!(text, "|---|--:|{}", "--:|".repeat(admissible::Verdict::NAMES.len()));
        for (format, outcome) in spec_rows(results, spec) {
            let cells = outcome.states.in_order().map(|count| count.to_string()).join(" | ");
            let _ = writeln!(text, "| {format} | {} | {cells} |", outcome.texels.total());
        }
        text.push('\n');
    }
    for (spec, outcome) in results.spec_totals() {
        let _ = writeln!(text, "- `{spec}` {}", spec_verdict(results.of_spec(&spec), &outcome));
        for deviation in deviations(results, &spec) {
            let _ = writeln!(text, "  - {deviation}");
        }
    }
    for (model, total) in results.totals() {
        let _ = write!(text, "- `{model}` {}", verdict(results.of_model(&model), total));
        if let Some((unit, first)) = first_difference(results, &model) {
            let _ = write!(text, ". First in `{unit}`: {first}");
        }
        text.push('\n');
    }
    for line in not_compared(results) {
        let _ = writeln!(text, "- {line}");
    }
    results.missing(all_shards).to_string().lines().for_each(|line| text.push_str(&format!("- {line}\n")));
    text
}

/// Format, texels, and for each model how many of its states matched.
fn rows(results: &Results) -> impl Iterator<Item = (String, u64, Vec<String>)> {
    results.by_format().into_iter().map(|(format, row)| {
        let texels = row.values().map(|total| total.texels).max().unwrap_or(0);
        let cell = |model: &String| match row.get(model) {
            Some(total) if total.states > 0 => format!("{}/{}", total.states_matched, total.states),
            // The units were run, and the model says nothing of them.
            Some(_) => Verdict::NotCovered.to_string(),
            None => Verdict::NotRun.to_string(),
        };
        let cells = results.models.iter().map(cell).collect();
        (format, texels, cells)
    })
}

/// Units that were not run, in whole or in part, and formats that a model does not cover, each with its reason.
fn not_compared(results: &Results) -> Vec<String> {
    let mut lines = Vec::new();
    // Units of which a part was left out, by the reason.
    let mut partly: BTreeMap<&String, Vec<&String>> = BTreeMap::new();
    let mut left_out: BTreeMap<(&String, &String), String> = BTreeMap::new();
    for unit in &results.units {
        if let Some(reason) = &unit.not_run {
            lines.push(format!("{}: {reason}", unit.unit));
        }
        if let Some(reason) = &unit.left_out {
            partly.entry(reason).or_default().push(&unit.unit);
        }
        let models = unit.models.iter().map(|(name, outcome)| (name, &outcome.not_run));
        let specs = unit.specs.iter().map(|(name, outcome)| (name, &outcome.not_run));
        for (model, reason) in models.chain(specs) {
            if let Some(reason) = reason {
                let formats = left_out.entry((model, reason)).or_default();
                if !formats.ends_with(unit.format.as_str()) {
                    let _ = write!(formats, "{}{}", if formats.is_empty() { "" } else { ", " }, unit.format);
                }
            }
        }
    }
    lines.extend(partly.into_iter().map(|(reason, units)| match units.as_slice() {
        [unit] => format!("in {unit}: {reason}"),
        [first, rest @ ..] => format!("in {first} and {} more: {reason}", rest.len()),
        [] => reason.clone(),
    }));
    lines.iter_mut().for_each(|line| line.insert_str(0, &format!("{}: ", Verdict::NotRun)));
    let not_covered = |((model, reason), formats)| format!("{}: {model} on {formats}: {reason}", Verdict::NotCovered);
    lines.extend(left_out.into_iter().map(not_covered));
    lines
}

/// Each format's verdicts by one specification.
pub(super) fn spec_rows(results: &Results, spec: &str) -> BTreeMap<String, SpecOutcome> {
    let mut rows: BTreeMap<String, SpecOutcome> = BTreeMap::new();
    for unit in &results.units {
        if let Some(outcome) = unit.specs.get(spec).filter(|outcome| outcome.texels.total() > 0) {
            let row = rows.entry(unit.format.clone()).or_default();
            row.texels.add(outcome.texels);
            row.states.add(outcome.states);
            if let (None, Some(first)) = (&row.first, &outcome.first) {
                row.first = Some(format!("{}: {first}", unit.unit));
            }
        }
    }
    rows
}

/// Formats with results that are not admitted, each with the first of them.
fn deviations(results: &Results, spec: &str) -> Vec<String> {
    let outside = spec_rows(results, spec).into_iter().filter(|(_, row)| row.texels.outside > 0);
    let line = |(format, row): (String, SpecOutcome)| {
        let (texels, states) = (row.texels.outside, row.states.outside);
        format!("{format}: {texels} texels in {states} states, first in {}", row.first.unwrap_or_default())
    };
    outside.map(line).collect()
}

/// Undefined results are excluded from what holds.
fn spec_verdict(verdict: Verdict, outcome: &SpecOutcome) -> String {
    let (states, texels) = (outcome.states, outcome.texels);
    let defined = states.total() - states.undefined;
    match verdict {
        Verdict::Holds => format!(
            "{verdict}: {defined} states ({} exact, {} tight, {} wide), {} texels, and {} more where any result does",
            states.exact,
            states.tight,
            states.wide,
            texels.total() - texels.undefined,
            texels.undefined
        ),
        Verdict::Fails => format!(
            "{verdict}: {} of {defined} states, {} of {} texels are outside what it admits",
            states.outside,
            texels.outside,
            texels.total() - texels.undefined
        ),
        _ => format!("{verdict}: {}", verdict.meaning()),
    }
}

fn verdict(verdict: Verdict, total: Totals) -> String {
    let Totals { texels, mismatches, undecided, states, states_matched, units_not_run } = total;
    let verdict = match verdict {
        Verdict::Holds => format!("{verdict}: {states} states, {texels} texels, no mismatch"),
        Verdict::Fails => {
            format!("{verdict}: {} of {states} states, {mismatches} of {texels} texels differ", states - states_matched)
        }
        _ => format!("{verdict}: {}", verdict.meaning()),
    };
    let verdict = match units_not_run {
        0 => verdict,
        1 => format!("{verdict}; 1 unit was not compared"),
        _ => format!("{verdict}; {units_not_run} units were not compared"),
    };
    match undecided {
        0 => verdict,
        _ => format!("{verdict}; {undecided} of them undecided: the driver's result there depends on its history"),
    }
}

fn first_difference<'a>(results: &'a Results, model: &str) -> Option<(&'a String, &'a String)> {
    results.units.iter().find_map(|unit| Some((&unit.unit, unit.models.get(model)?.first.as_ref()?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::admissible::Counts;
    use crate::conform::result::VERSION;
    use crate::conform::{Asked, Level, ModelOutcome, Shard, UnitOutcome};

    fn results() -> Results {
        let good = ModelOutcome { states: 2, states_matched: 2, ..ModelOutcome::default() };
        let bad = ModelOutcome {
            states: 2,
            states_matched: 1,
            mismatches: 3,
            first: Some("expected 1, got 2".to_owned()),
            ..ModelOutcome::default()
        };
        let absent = ModelOutcome { not_run: Some("too slow".to_owned()), ..ModelOutcome::default() };
        let unit = |name: &str| UnitOutcome {
            unit: name.to_owned(),
            format: "r8unorm".to_owned(),
            texels: 10,
            states: 2,
            seconds: 1.0,
            not_run: None,
            left_out: None,
            models: BTreeMap::new(),
            specs: BTreeMap::new(),
        };
        let models = [("a", good), ("b", bad), ("c", absent)].map(|(name, outcome)| (name.to_owned(), outcome));
        let good = SpecOutcome {
            texels: Counts { exact: 8, undefined: 2, ..Counts::default() },
            states: Counts { exact: 1, undefined: 1, ..Counts::default() },
            ..SpecOutcome::default()
        };
        let bad = SpecOutcome {
            texels: Counts { wide: 8, outside: 2, ..Counts::default() },
            states: Counts { wide: 1, outside: 1, ..Counts::default() },
            first: Some("red: 101 admitted, got 7".to_owned()),
            not_run: None,
        };
        let specs = [("vulkan".to_owned(), good), ("d3d".to_owned(), bad)];
        Results {
            version: VERSION,
            adapter: "device".to_owned(),
            driver: None,
            level: Level::Quick,
            // None of the level's own, so that none of them is missing.
            asked: Asked { only: Some("no unit has this name".to_owned()), every_model: true, ..Asked::default() },
            shards: vec![Shard::ALL],
            models: ["a", "b", "c"].map(str::to_owned).into(),
            specs: vec!["vulkan".to_owned(), "d3d".to_owned()],
            units: vec![
                UnitOutcome { models: models.into(), specs: specs.into(), ..unit("u") },
                UnitOutcome { not_run: Some("no such format".to_owned()), ..unit("v") },
            ],
        }
    }

    #[test]
    fn a_model_fits_only_if_it_was_compared_without_a_mismatch() {
        let text = text(&results(), false);
        assert!(
            text.contains("a              holds: 2 states, 10 texels, no mismatch; 1 unit was not compared"),
            "{text}"
        );
        assert!(text.contains("b              fails: 1 of 2 states, 3 of 10 texels differ"), "{text}");
        assert!(text.contains("first in u: expected 1, got 2"), "{text}");
        assert!(text.contains("c              not covered"), "{text}");
        assert!(text.ends_with("in all: fails: something differs or is missing\n"), "{text}");
    }

    #[test]
    fn a_specification_is_met_only_if_nothing_is_outside_and_undefined_results_do_not_count() {
        for text in [text(&results(), false), markdown(&results(), false)] {
            let conforms = "holds: 1 states (1 exact, 0 tight, 0 wide), 8 texels, and 2 more where any result does";
            assert!(text.contains(conforms), "{text}");
            assert!(text.contains("fails: 1 of 2 states, 2 of 10 texels are outside"), "{text}");
            assert!(text.contains("r8unorm: 2 texels in 1 states, first in u: red: 101 admitted, got 7"), "{text}");
        }
        assert!(markdown(&results(), false).contains("| r8unorm | 10 | 0 | 0 | 1 | 1 | 0 |"), "a row by class");
    }

    #[test]
    fn devices_side_by_side_have_a_column_each() {
        let other = Results { adapter: "other (x) [y]".to_owned(), specs: Vec::new(), ..results() };
        let other = Results { units: vec![UnitOutcome { specs: BTreeMap::new(), ..other.units[0].clone() }], ..other };
        let text = crate::conform::compare::markdown(&[results(), other]);
        assert!(text.contains("| format | device | other |"), "{text}");
        assert!(text.contains("| r8unorm | `a` | `a` |"), "the model that matches: {text}");
        assert!(text.contains("| r8unorm | 0 / 0 / 1 / **1** | not run |"), "d3d: {text}");
    }

    #[test]
    fn what_was_not_run_is_named_with_its_reason() {
        for text in [text(&results(), false), markdown(&results(), false)] {
            assert!(text.contains("not run: v: no such format"), "a unit: {text}");
            assert!(text.contains("not covered: c on r8unorm: too slow"), "a model: {text}");
        }
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut results = results();
        results.asked.only = Some("r8unorm".to_owned());
        results.shards = vec![Shard { index: 1, count: 2 }];
        for text in [text(&results, true), markdown(&results, true)] {
            assert!(text.contains("missing: 1 shard: 2/2"), "{text}");
            assert!(text.contains("missing: 1 shard: 2/2") && text.contains("/r8unorm"), "{text}");
        }
        assert!(!text(&results, false).contains("shard: 2/2"), "one shard's own table");
    }

    #[test]
    fn markdown_rows_have_a_cell_for_each_model() {
        let text = markdown(&results(), false);
        assert!(text.contains("| r8unorm | 10 | 2/2 | 1/2 | not covered |"), "{text}");
    }
}
