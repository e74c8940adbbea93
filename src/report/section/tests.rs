//! Every section stands on its own.

use super::*;
use crate::model::{binary32::Binary32, exact::Exact};
use crate::report::device::DeviceSection;
use crate::report::{SceneReport, html};

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
fn scenes_of_lost_precision_link_to_the_texture_section() {
    let scene = |name: &str, technique: &str| SceneReport {
        name: name.to_owned(),
        title: name.to_owned(),
        explanation: String::new(),
        technique: technique.to_owned(),
        format: "rgba8unorm".to_owned(),
        draws: Vec::new(),
        models: Vec::new(),
        reference: None,
    };
    let section = Section {
        id: texture::ID,
        title: "What premultiplied storage costs",
        finding: String::new(),
        method: String::new(),
        figures: Vec::new(),
        tables: Vec::new(),
        command: String::new(),
    };
    let device = DeviceSection::NotRun { reason: "not asked for".to_owned() };
    let links = |technique: &str, analyses: &[Section]| {
        let scenes = [scene("one", technique), scene("two", technique)];
        let page = html::page(&scenes, &[], &device, analyses, "a command").expect("a page");
        page.contains("In numbers: <a href=\"#texture\">What premultiplied storage costs</a>")
    };
    assert!(links(texture::TECHNIQUE, std::slice::from_ref(&section)), "from the scenes to the numbers");
    assert!(!links("fade", &[section]), "others have nothing to do with it");
    assert!(!links(texture::TECHNIQUE, &[]), "no link to a section that is not there");
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
