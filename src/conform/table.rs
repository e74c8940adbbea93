//! Results for reading: a table for the terminal, and the same as Markdown for documentation.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::result::{Results, Totals};

/// The table, what was not run and why, and a verdict for each model.
#[must_use]
pub fn text(results: &Results) -> String {
    let mut text = format!("{}\nlevel {}, shard {}\n\n", results.adapter, results.level, results.shards.join(", "));
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
    for line in not_run(results) {
        let _ = writeln!(text, "not run: {line}");
    }
    text.push('\n');
    for (model, total) in results.totals() {
        let _ = writeln!(text, "{model:14} {}", verdict(total));
        if let Some((unit, first)) = first_difference(results, &model) {
            let _ = writeln!(text, "{:14} first in {unit}: {first}", "");
        }
    }
    text
}

/// The same as a Markdown page.
#[must_use]
pub fn markdown(results: &Results) -> String {
    let mut text = format!(
        "# Which models match {}\n\nMade by `outmerge conform --level {} --markdown FILE`. A state matches when every texel \
         does, bit for bit.\n\n",
        results.adapter, results.level
    );
    let _ = writeln!(text, "| states matched | texels | {} |", results.models.join(" | "));
    let _ = writeln!(text, "|---|--:|{}", "--:|".repeat(results.models.len()));
    for (format, texels, cells) in rows(results) {
        let _ = writeln!(text, "| {format} | {texels} | {} |", cells.join(" | "));
    }
    text.push('\n');
    for (model, total) in results.totals() {
        let _ = write!(text, "- `{model}` {}", verdict(total));
        if let Some((unit, first)) = first_difference(results, &model) {
            let _ = write!(text, ". First in `{unit}`: {first}");
        }
        text.push('\n');
    }
    for line in not_run(results) {
        let _ = writeln!(text, "- not run: {line}");
    }
    text
}

/// Format, texels, and for each model how many of its states matched.
fn rows(results: &Results) -> impl Iterator<Item = (String, u64, Vec<String>)> {
    results.by_format().into_iter().map(|(format, row)| {
        let texels = row.values().map(|total| total.texels).max().unwrap_or(0);
        let cell = |model: &String| match row.get(model) {
            Some(total) if total.states > 0 => format!("{}/{}", total.states_matched, total.states),
            _ => "not run".to_owned(),
        };
        let cells = results.models.iter().map(cell).collect();
        (format, texels, cells)
    })
}

/// Units, and models in units, that were not compared, each with its reason.
fn not_run(results: &Results) -> Vec<String> {
    let mut lines = Vec::new();
    let mut left_out: BTreeMap<(&String, &String), String> = BTreeMap::new();
    for unit in &results.units {
        if let Some(reason) = &unit.not_run {
            lines.push(format!("{}: {reason}", unit.unit));
        }
        if let Some(reason) = &unit.left_out {
            lines.push(format!("in {}: {reason}", unit.unit));
        }
        for (model, outcome) in &unit.models {
            if let Some(reason) = &outcome.not_run {
                let formats = left_out.entry((model, reason)).or_default();
                if !formats.ends_with(unit.format.as_str()) {
                    let _ = write!(formats, "{}{}", if formats.is_empty() { "" } else { ", " }, unit.format);
                }
            }
        }
    }
    lines.extend(left_out.into_iter().map(|((model, reason), formats)| format!("{model} on {formats}: {reason}")));
    lines
}

fn verdict(total: Totals) -> String {
    let Totals { texels, mismatches, states, states_matched, .. } = total;
    match (states, mismatches) {
        (0, _) => "not run".to_owned(),
        (_, 0) => format!("fits: {states} states, {texels} texels, no mismatch"),
        _ => format!(
            "does not fit: {} of {states} states, {mismatches} of {texels} texels differ",
            states - states_matched
        ),
    }
}

fn first_difference<'a>(results: &'a Results, model: &str) -> Option<(&'a String, &'a String)> {
    results.units.iter().find_map(|unit| Some((&unit.unit, unit.models.get(model)?.first.as_ref()?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conform::result::VERSION;
    use crate::conform::{Level, ModelOutcome, UnitOutcome};

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
        };
        let models = [("a", good), ("b", bad), ("c", absent)].map(|(name, outcome)| (name.to_owned(), outcome));
        Results {
            version: VERSION,
            adapter: "device".to_owned(),
            level: Level::Quick,
            shards: vec!["1/1".to_owned()],
            models: ["a", "b", "c"].map(str::to_owned).into(),
            units: vec![
                UnitOutcome { models: models.into(), ..unit("u") },
                UnitOutcome { not_run: Some("no such format".to_owned()), ..unit("v") },
            ],
        }
    }

    #[test]
    fn a_model_fits_only_if_it_was_compared_without_a_mismatch() {
        let text = text(&results());
        assert!(text.contains("a              fits: 2 states, 10 texels, no mismatch"), "{text}");
        assert!(text.contains("b              does not fit: 1 of 2 states, 3 of 10 texels differ"), "{text}");
        assert!(text.contains("first in u: expected 1, got 2"), "{text}");
        assert!(text.contains("c              not run"), "{text}");
    }

    #[test]
    fn what_was_not_run_is_named_with_its_reason() {
        for text in [text(&results()), markdown(&results())] {
            assert!(text.contains("not run: v: no such format"), "a unit: {text}");
            assert!(text.contains("not run: c on r8unorm: too slow"), "a model: {text}");
        }
    }

    #[test]
    fn markdown_rows_have_a_cell_for_each_model() {
        let text = markdown(&results());
        assert!(text.contains("| r8unorm | 10 | 2/2 | 1/2 | not run |"), "{text}");
    }
}
