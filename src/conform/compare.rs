//! Results of several devices side by side, as Markdown.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::Results;
use super::result::Totals;
use super::table::spec_rows;
use crate::verdict::Verdict;

/// Whether all that was asked for of every device is there, and something was run; nothing is judged otherwise.
#[must_use]
pub fn verdict(devices: &[Results]) -> Verdict {
    let whole = |results: &Results| match (results.missing(true).is_empty(), results.units_run()) {
        (false, _) => Verdict::Fails,
        (true, 0) => Verdict::NotRun,
        (true, _) => Verdict::Holds,
    };
    Verdict::of_all(devices.iter().map(whole))
}

/// One table for the models and one for each specification, a row a format, a column a device.
#[must_use]
pub fn markdown(devices: &[Results]) -> String {
    let names = names(devices.iter().map(|results| results.adapter.as_str()));
    let mut text = String::from("# Devices side by side\n\n");
    for results in devices {
        let (units, skipped) = (results.units.len(), results.units.iter().filter(|u| u.not_run.is_some()).count());
        let level = results.level;
        let _ = writeln!(text, "- {}: level {level}, {units} units, {skipped} of them not run", results.adapter);
        results.missing(true).to_string().lines().for_each(|line| text.push_str(&format!("  - {line}\n")));
    }
    text.push_str(
        "\nMade by `outmerge conform compare FILE...` from results of `outmerge conform --json-file FILE`.\n\n\
         ## Models that match every state, bit for bit\n\n\
         A model that cannot say anything of some states, such as those with a second source, is not listed.\n\n",
    );
    let models: Vec<_> = devices.iter().map(Results::by_format).collect();
    let cell = |rows: &BTreeMap<String, BTreeMap<String, Totals>>, format: &str| match rows.get(format) {
        Some(row) if row.values().any(|total| total.states > 0) => {
            let most = row.values().map(|total| total.states).max();
            let matching = row.iter().filter(|(_, t)| Some(t.states) == most && t.states == t.states_matched);
            let names: Vec<String> = matching.map(|(name, _)| format!("`{name}`")).collect();
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        }
        _ => "not run".to_owned(),
    };
    let formats: BTreeSet<&String> = models.iter().flat_map(BTreeMap::keys).collect();
    table(&mut text, &names, formats.iter().map(|format| (*format, models.iter().map(|m| cell(m, format)).collect())));
    let specs: BTreeSet<&String> = devices.iter().flat_map(|results| &results.specs).collect();
    for spec in specs {
        let _ = writeln!(text, "\n## States by {spec}: exact / tight / wide / **outside**\n");
        let rows: Vec<_> = devices.iter().map(|results| spec_rows(results, spec)).collect();
        let formats: BTreeSet<&String> = rows.iter().flat_map(BTreeMap::keys).collect();
        let cell = |row: Option<&super::SpecOutcome>| {
            row.map_or("not run".to_owned(), |row| {
                let [exact, tight, wide, outside, _] = row.states.in_order();
                let outside = if outside > 0 { format!("**{outside}**") } else { "0".to_owned() };
                format!("{exact} / {tight} / {wide} / {outside}")
            })
        };
        let row = |format: &&String| rows.iter().map(|rows| cell(rows.get(*format))).collect::<Vec<String>>();
        table(&mut text, &names, formats.iter().map(|format| (*format, row(format))));
    }
    text
}

/// The adapters' names without what is in brackets; with the driver's where they are the same.
fn names<'a>(adapters: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
    let short = |adapter: &'a str| adapter.split(['(', '[']).next().unwrap_or(adapter).trim();
    // "NAME [TYPE, DRIVER, VERSION]"
    let driver =
        |adapter: &'a str| adapter.split('[').next_back().and_then(|rest| rest.split(", ").nth(1)).unwrap_or("");
    let name = |adapter: &'a str| match adapters.clone().filter(|other| short(other) == short(adapter)).count() {
        1 => short(adapter).to_owned(),
        _ => format!("{}, {}", short(adapter), driver(adapter)),
    };
    adapters.clone().map(name).collect()
}

fn table<'a>(text: &mut String, names: &[String], rows: impl Iterator<Item = (&'a String, Vec<String>)>) {
    let _ = writeln!(text, "| format | {} |", names.join(" | "));
    let _ = writeln!(text, "|---|{}", "---|".repeat(names.len()));
    for (format, cells) in rows {
        let _ = writeln!(text, "| {format} | {} |", cells.join(" | "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_of_one_name_are_told_apart_by_their_driver() {
        let adapters = [
            "llvmpipe (LLVM 15) [Cpu, llvmpipe, Mesa]",
            "llvmpipe (LLVM 15) [Cpu, gl, 4.5]",
            "softpipe [Other, gl, 4.5]",
        ];
        assert_eq!(names(adapters.into_iter()), ["llvmpipe, llvmpipe", "llvmpipe, gl", "softpipe"]);
    }
}
