//! Vectors recorded from the device pass the model of its driver.

use outmerge::crosscheck::vector;
use outmerge::format::{ColorFormat, layout::FORMATS};
use outmerge::model::registry;
use outmerge::vectors;

use crate::harness::llvmpipe;

#[test]
fn recorded_vectors_of_every_format_pass_the_drivers_model() {
    let Some(device) = llvmpipe() else { return };
    let formats: Vec<ColorFormat> = FORMATS.iter().filter_map(|(name, _)| ColorFormat::from_name(name).ok()).collect();
    let mut text = String::new();
    let mut recorded = 0;
    for mut line in vectors::generate(20_261_123, &formats, 12, 300) {
        if let Some(reason) = vector::refusal(device, &line) {
            println!("not run: {}: {reason}", line.format.name());
            continue;
        }
        line.out = Some(vector::record(device, &line).expect("drawn"));
        text.push_str(&line.to_json());
        text.push('\n');
        recorded += 1;
    }
    assert!(recorded > 200, "most formats are rendered: {recorded} lines");
    let model = registry::by_name("llvmpipe").expect("a model");
    let report = vectors::check(model.as_ref(), text.as_bytes(), |mismatch| println!("{mismatch:?}")).expect("valid");
    assert_eq!((report.total.lines, report.total.failed_texels), (recorded, 0));
    let exact = registry::by_name("exact").expect("a model");
    let report = vectors::check(exact.as_ref(), text.as_bytes(), |_| ()).expect("valid");
    assert!(report.total.failed_texels > 0, "the driver is not exact, so the check can fail");
}
