//! Every section stands on its own.

use super::*;
use crate::model::{binary32::Binary32, exact::Exact};

fn check(section: &Section) {
    let id = section.id;
    assert!(section.finding.ends_with('.') && section.finding.len() > 40, "{id}: a finding: `{}`", section.finding);
    assert!(section.command.starts_with("outmerge "), "{id}: a command");
    assert!(!section.figures.is_empty() && !section.tables.is_empty(), "{id}: a picture and a table");
    for table in &section.tables {
        assert!(!table.rows.is_empty(), "{id}: {} has rows", table.caption);
        for row in &table.rows {
            assert_eq!(row.len(), table.header.len(), "{id}: {}: {row:?}", table.caption);
        }
    }
    let page = page::section(section).expect("a section is drawn").into_string();
    assert!(page.contains(&format!("id=\"{id}\"")), "{id}: an anchor");
    assert!(!page.contains("<script") && !page.contains("http-equiv"), "{id}: no script");
    assert!(page.contains("<svg") || page.contains("data:image/png"), "{id}: a picture inside");
}

#[test]
fn cheap_sections_have_finding_picture_table_and_command() {
    let (exact, single) = (Exact::default(), Binary32);
    let models: [&dyn NumericModel; 2] = [&exact, &single];
    for section in [bound::section(), fixpoint::section(&models), texture::section(&models), plan::section()] {
        check(&section.expect("an analysis of fixed questions"));
    }
}

#[test]
fn order_and_stability_sections_have_finding_picture_table_and_command() {
    let (exact, single) = (Exact::default(), Binary32);
    let models: [&dyn NumericModel; 2] = [&exact, &single];
    for section in
        [stability::stack_section(&models), stability::extreme_section(&models), stability::order_section(&models)]
    {
        check(&section.expect("an analysis of fixed questions"));
    }
}
