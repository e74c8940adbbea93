//! Every section stands on its own.

use super::*;
use crate::model::{binary32::Binary32, exact::Exact};
use crate::report::device::DeviceSection;
use crate::report::{SceneReport, html};
use crate::scene::Scene;

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

/// The figures of the plan section from the plans as they are written to JSON.
#[test]
fn the_plan_section_adds_up() {
    let section = plan::section().expect("bundled scenes are planned");
    let [parts, scenes] = &section.tables[..] else { panic!("two tables") };
    let number = |value: &serde_json::Value| value.as_u64().expect("a count");
    let share = |lean: u64, full: u64| {
        // In hundredths of a percent, rounded, by integers.
        let hundredths = (20_000 * (full - lean) + full) / (2 * full);
        format!("{}.{:02} %", hundredths / 100, hundredths % 100)
    };
    let (mut total, mut left_out) = ([0, 0], std::collections::BTreeMap::<String, [usize; 2]>::new());
    let mut draws = 0;
    for ((name, scene), row) in Scene::bundled().zip(&scenes.rows) {
        let planned = scene.expect("valid").plan(&Binary32).expect("planned");
        let json = serde_json::to_value(&planned).expect("JSON");
        let mut bytes = [0, 0];
        for draw in json["draws"].as_array().expect("draws") {
            draws += 1;
            for (sum, way) in bytes.iter_mut().zip(["planned", "everything"]) {
                let traffic = draw[way]["traffic"].as_object().expect("six counts");
                assert_eq!(traffic.len(), 6, "{traffic:?}");
                *sum += traffic.values().map(number).sum::<u64>();
            }
            for decision in ["pipeline", "merger"].iter().flat_map(|part| draw[*part].as_array().expect("decisions")) {
                if decision["target"].as_u64().is_none_or(|target| target == 0) {
                    let name = decision["part"].as_str().expect("a name").replace('-', " ");
                    let count = left_out.entry(name).or_default();
                    count[0] += usize::from(decision["needed"] == false);
                    count[1] += 1;
                }
            }
        }
        let cells = [name.to_owned(), planned.draws.len().to_string(), bytes[0].to_string(), bytes[1].to_string()];
        assert_eq!(row[..4], cells);
        assert_eq!(row[4], share(bytes[0], bytes[1]), "{name}");
        total = [total[0] + bytes[0], total[1] + bytes[1]];
    }
    assert_eq!(scenes.rows.len(), Scene::bundled().count(), "every scene");
    assert!(
        section.finding.contains(&format!("Over all scenes {} of", share(total[0], total[1]))),
        "{}",
        section.finding
    );
    let told: std::collections::BTreeMap<_, _> = parts
        .rows
        .iter()
        .map(|row| (row[0].clone(), [row[1].parse().expect("a count"), row[2].parse().expect("a count")]))
        .collect();
    assert_eq!(told, left_out);
    assert!(left_out.values().all(|count| count[1] <= draws), "at most once a draw");
    for row in &parts.rows {
        assert_eq!(row[3].is_empty(), row[1] == "0", "a reason where something is left out: {row:?}");
    }
}

/// The fixpoint section's table by integers.
#[test]
fn the_fixpoint_section_is_an_integer_recurrence() {
    let exact = Exact::default();
    let section = fixpoint::section(&[&exact]).expect("a fixed question");
    // d - d / 40 rounded to nearest even; the binary32 next to 0.025 is above it, so no move is a tie that stays.
    let (mut code, mut frames) = (255_u32, 0);
    loop {
        let moved = (39 * code + 20) / 40 - u32::from((39 * code + 20).is_multiple_of(40));
        if moved == code {
            break;
        }
        (code, frames) = (moved, frames + 1);
    }
    assert_eq!(section.tables[0].rows[0][..3], ["exact".to_owned(), code.to_string(), frames.to_string()]);
    assert!(section.finding.contains(&format!("stops at code {code} even")), "{}", section.finding);
    // A blender that truncates loses at least a code a frame: it ends at 0.
    assert_eq!(section.tables[0].rows[1][1], "0");
    assert!(section.finding.ends_with("ends at 0."), "{}", section.finding);
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
