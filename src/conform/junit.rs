//! Results as JUnit XML, one test case a unit and model or specification, for CI systems.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{Results, UnitOutcome};
use crate::verdict::Verdict;

/// The report as XML; shards that are missing fail with `all_shards`, and missing units always.
///
/// # Errors
/// When a text cannot be written as XML.
pub fn xml(results: &Results, all_shards: bool) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new(format!("outmerge conform {}", results.level));
    for model in &results.models {
        let mut suite = TestSuite::new(format!("{model} on {}", results.adapter));
        for unit in &results.units {
            let status = status(unit.with_model(model), || {
                format!("{} texels differ", unit.models.get(model).map_or(0, |outcome| outcome.mismatches))
            });
            suite.add_test_case(case(unit, status));
        }
        report.add_test_suite(suite);
    }
    for spec in &results.specs {
        let mut suite = TestSuite::new(format!("{spec} on {}", results.adapter));
        for unit in &results.units {
            let status = status(unit.with_spec(spec), || {
                let outside = unit.specs.get(spec).map_or(0, |outcome| outcome.texels.outside);
                format!("{outside} texels are outside what {spec} admits")
            });
            suite.add_test_case(case(unit, status));
        }
        report.add_test_suite(suite);
    }
    let missing = results.missing(all_shards);
    if !missing.is_empty() {
        let mut suite = TestSuite::new("what is missing");
        let shards = missing.shards.iter().map(|shard| format!("shard {shard}"));
        for name in shards.chain(missing.units) {
            suite.add_test_case(TestCase::new(name, failed("missing".to_owned(), None)));
        }
        report.add_test_suite(suite);
    }
    report.to_string()
}

/// Only what holds is a success; what was not decided is skipped, with the reason.
fn status((verdict, why): (Verdict, Option<&str>), difference: impl FnOnce() -> String) -> TestCaseStatus {
    match verdict {
        Verdict::Holds => TestCaseStatus::success(),
        Verdict::Fails => failed(difference(), why),
        Verdict::NotRun | Verdict::NotCovered | Verdict::Undecided => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(format!("{verdict}: {}", why.unwrap_or(verdict.meaning())));
            status
        }
    }
}

fn failed(message: String, first: Option<&str>) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_message(message);
    if let Some(first) = first {
        status.set_description(first.to_owned());
    }
    status
}

fn case(unit: &UnitOutcome, status: TestCaseStatus) -> TestCase {
    let mut case = TestCase::new(unit.unit.clone(), status);
    case.set_time(std::time::Duration::from_secs_f64(unit.seconds));
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conform::ModelOutcome;
    use crate::conform::result::samples;

    #[test]
    fn only_what_holds_passes_and_what_is_missing_fails() {
        let mut results = samples::results(&["differs", "lacks a format", "undecided", "equal", "not covered"]);
        results.units[1].not_run = Some("no such format".to_owned());
        let outcome = ModelOutcome { states: 1, states_matched: 1, ..ModelOutcome::default() };
        let mut set = |i: usize, outcome| drop(results.units[i].models.insert("m".to_owned(), outcome));
        set(2, ModelOutcome { undecided: 10, ..outcome.clone() });
        set(3, outcome.clone());
        set(4, ModelOutcome { not_run: Some("no such state".to_owned()), ..ModelOutcome::default() });
        results.asked.only = Some("no unit has this name".to_owned());
        let xml = xml(&results, false).expect("XML");
        assert!(xml.contains("tests=\"5\" disabled=\"3\" errors=\"0\" failures=\"1\""), "{xml}");
        for text in ["3 texels differ", "not run: no such format", "undecided: nothing", "not covered: no such state"] {
            assert!(xml.contains(text), "{text} in {xml}");
        }
        results.asked.only = Some("store/r8unorm".to_owned());
        let missing = self::xml(&results, false).expect("XML");
        assert!(missing.contains("name=\"what is missing\"") && missing.contains("name=\"store/r8unorm/"), "{missing}");
    }
}
