//! Results as JUnit XML, one test case a unit and model, for CI systems.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::Results;

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
                (Some(reason), _) => {
                    let mut status = TestCaseStatus::skipped();
                    status.set_message(reason.clone());
                    status
                }
                (None, Some(outcome)) if outcome.mismatches == 0 => TestCaseStatus::success(),
                (None, outcome) => {
                    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                    let count = outcome.map_or(0, |outcome| outcome.mismatches);
                    status.set_message(format!("{count} texels differ"));
                    if let Some(first) = outcome.and_then(|outcome| outcome.first.as_ref()) {
                        status.set_description(first.clone());
                    }
                    status
                }
            };
            let mut case = TestCase::new(unit.unit.clone(), status);
            case.set_time(std::time::Duration::from_secs_f64(unit.seconds));
            suite.add_test_case(case);
        }
        report.add_test_suite(suite);
    }
    report.to_string()
}
