//! Results as JUnit XML, one test case a unit and model or specification, for CI systems.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{Results, UnitOutcome};

/// The report as XML.
///
/// # Errors
/// When a text cannot be written as XML.
pub fn xml(results: &Results) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new(format!("outmerge conform {}", results.level));
    for model in &results.models {
        let mut suite = TestSuite::new(format!("{model} on {}", results.adapter));
        for unit in &results.units {
            let outcome = unit.models.get(model);
            let not_run = unit.not_run.as_ref().or(outcome.and_then(|outcome| outcome.not_run.as_ref()));
            let status = match (not_run, outcome) {
                (Some(reason), _) => skipped(reason),
                (None, Some(outcome)) if outcome.mismatches == 0 => TestCaseStatus::success(),
                (None, outcome) => {
                    let count = outcome.map_or(0, |outcome| outcome.mismatches);
                    failed(format!("{count} texels differ"), outcome.and_then(|outcome| outcome.first.as_ref()))
                }
            };
            suite.add_test_case(case(unit, status));
        }
        report.add_test_suite(suite);
    }
    for spec in &results.specs {
        let mut suite = TestSuite::new(format!("{spec} on {}", results.adapter));
        for unit in &results.units {
            let outcome = unit.specs.get(spec);
            let not_run = unit.not_run.as_ref().or(outcome.and_then(|outcome| outcome.not_run.as_ref()));
            let outside = outcome.map_or(0, |outcome| outcome.texels.outside);
            let status = match not_run {
                Some(reason) => skipped(reason),
                None if outcome.is_some() && outside == 0 => TestCaseStatus::success(),
                None => failed(
                    format!("{outside} texels are outside what {spec} admits"),
                    outcome.and_then(|outcome| outcome.first.as_ref()),
                ),
            };
            suite.add_test_case(case(unit, status));
        }
        report.add_test_suite(suite);
    }
    report.to_string()
}

fn skipped(reason: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::skipped();
    status.set_message(reason.to_owned());
    status
}

fn failed(message: String, first: Option<&String>) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_message(message);
    if let Some(first) = first {
        status.set_description(first.clone());
    }
    status
}

fn case(unit: &UnitOutcome, status: TestCaseStatus) -> TestCase {
    let mut case = TestCase::new(unit.unit.clone(), status);
    case.set_time(std::time::Duration::from_secs_f64(unit.seconds));
    case
}
