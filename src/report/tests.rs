//! The report's figures by a second way, and what its page says of them.

use super::*;
use crate::model::binary16::Binary16;
use crate::report::device::DeviceSection;

fn bundled(name: &str) -> (String, Scene) {
    (name.to_owned(), Scene::bundled_by_name(name).expect("bundled").expect("valid"))
}

/// The codes of target 0, texel by texel.
fn codes(framebuffer: &Framebuffer) -> Vec<[u32; 4]> {
    let target = framebuffer.colors[0].as_ref().expect("a color target");
    let extent = target.extent();
    (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| target.codes(x, y, 0))).collect()
}

/// Differences of 8-bit codes: the largest, the sum, and the number of texels.
fn compared(a: &[[u32; 4]], b: &[[u32; 4]]) -> (u32, u64, u64) {
    let channels = |(a, b): (&[u32; 4], &[u32; 4])| [0, 1, 2, 3].map(|i| a[i].max(b[i]) - a[i].min(b[i]));
    let all: Vec<[u32; 4]> = a.iter().zip(b).map(channels).collect();
    let flat = || all.iter().flatten().copied();
    (flat().max().unwrap_or(0), flat().map(u64::from).sum(), all.iter().filter(|d| **d != [0; 4]).count() as u64)
}

fn reported(difference: &Difference) -> (u32, u64, u64) {
    (difference.max_codes, difference.sum_codes, difference.pixels_differing)
}

#[test]
fn models_and_the_sorted_reference_are_compared_texel_by_texel() {
    let (exact, half) = (Exact::default(), Binary16);
    let scenes = [bundled("fade-over-opaque"), bundled("cyclic-sorted")];
    let done = std::sync::atomic::AtomicUsize::new(0);
    let count = || {
        done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    let reports = compare(&scenes, &[&exact, &half], &count).expect("they render");
    assert_eq!((reports.len(), done.into_inner()), (2, 2), "a report and a call a scene");
    for ((name, scene), report) in scenes.iter().zip(&reports) {
        assert_eq!((&report.name, &report.title, report.format.as_str()), (name, &scene.title, "rgba8unorm"));
        assert_eq!(report.explanation, scene.explanation.trim());
        let rendered = scene.render_models(&[&exact, &half]).expect("renders");
        let [truth, rough] = [&rendered[0], &rendered[1]].map(|rendered| codes(&rendered.framebuffer));
        let [first, second] = &report.models[..] else { panic!("two models") };
        assert_eq!((first.model.as_str(), second.model.as_str()), ("exact", "f16"));
        assert_eq!(reported(&first.difference), (0, 0, 0), "the yardstick");
        assert_eq!(reported(&second.difference), compared(&truth, &rough), "{name}");
        assert!(second.difference.pixels_differing > 0, "{name}: binary16 shows");
        assert_eq!(
            (second.difference.pixels, second.difference.channels),
            (rough.len() as u64, 4 * rough.len() as u64)
        );
        assert_eq!(first.fragments, rendered[0].fragments);
        assert!(first.ns_per_fragment > 0.0, "it took time");
        assert_eq!(first.picture.rgba.len(), 4 * truth.len(), "a picture of the target");
        let equal = |pixel: &&[u8]| pixel[..3] == [24, 26, 33];
        let drawn_equal = second.heat_map.rgba.chunks(4).filter(equal).count() as u64;
        assert_eq!(drawn_equal, second.difference.pixels - second.difference.pixels_differing, "the heat map");
        let sorted = scene.render_sorted_per_pixel(&exact).expect("renders");
        match (&report.reference, scene.reference) {
            (Some(found), Some(Reference::Sorted)) => {
                assert_eq!(reported(&found.difference), compared(&truth, &codes(&sorted)), "{name}: sorted");
                assert_eq!(found.picture.rgba.len(), 4 * truth.len());
            }
            (found, asked) => assert_eq!((found.is_none(), asked), (true, None), "{name}"),
        }
    }
    assert!(reports.iter().any(|report| report.reference.is_some()), "a scene asks for its reference");
}

/// A report of one model, by hand.
fn report(model: &str, difference: Difference, fragments: u64, ns_per_fragment: f64) -> SceneReport {
    let picture = || Picture { width: 1, height: 1, rgba: vec![0; 4] };
    let model = ModelReport {
        model: model.to_owned(),
        difference,
        fragments,
        ns_per_fragment,
        picture: picture(),
        heat_map: picture(),
    };
    SceneReport {
        name: "s".to_owned(),
        title: "t".to_owned(),
        explanation: String::new(),
        technique: "fade".to_owned(),
        format: "rgba8unorm".to_owned(),
        draws: Vec::new(),
        models: vec![model],
        reference: None,
    }
}

const SOME: Difference = Difference { max_codes: 3, sum_codes: 10, channels: 400, pixels_differing: 5, pixels: 100 };
const MORE: Difference = Difference { max_codes: 2, sum_codes: 30, channels: 400, pixels_differing: 15, pixels: 100 };

#[test]
fn summaries_weigh_scenes_by_their_fragments() {
    let scenes = [report("a", SOME, 100, 10.0), report("b", SOME, 0, 0.0), report("a", MORE, 300, 30.0)];
    let rows = summarize(&scenes);
    let [a, b] = &rows[..] else { panic!("two models: {rows:?}") };
    assert_eq!((a.model.as_str(), a.scenes, b.model.as_str(), b.scenes), ("a", 2, "b", 1));
    let sum = Difference { max_codes: 3, sum_codes: 40, channels: 800, pixels_differing: 20, pixels: 200 };
    assert_eq!(a.difference, sum);
    assert!((a.ns_per_fragment - 25.0).abs() < 1e-6, "(100 x 10 + 300 x 30) / 400: {}", a.ns_per_fragment);
    assert_eq!(b.ns_per_fragment, 0.0, "no fragment took time");
    let text = table(&rows);
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[1], ["a", "2", "3", "0.05000", "10.000%", "25.0"]);
    assert_eq!(lines.len(), 3, "{text}");
}

#[test]
fn the_page_says_what_the_data_say() {
    let mut scene = report("exact", Difference::default(), 7, 1.0);
    scene.draws = Scene::bundled_by_name("fade-over-opaque")
        .expect("bundled")
        .expect("valid")
        .render(&Exact::default())
        .expect("renders")
        .draws;
    scene.models.push(report("f16", SOME, 7, 1.0).models.remove(0));
    let one_code = Difference { max_codes: 1, ..SOME };
    scene.models.push(report("f32", one_code, 7, 1.0).models.remove(0));
    scene.models.push(report("fixed:8", Difference::default(), 7, 1.0).models.remove(0));
    let picture = || Picture { width: 1, height: 1, rgba: vec![0; 4] };
    scene.reference = Some(ReferenceReport { difference: MORE, picture: picture() });
    let page = |scene: &SceneReport| {
        let rows = summarize(std::slice::from_ref(scene));
        let device = DeviceSection::NotRun { reason: "not asked for".to_owned() };
        html::page(std::slice::from_ref(scene), &rows, &device, &[], "outmerge report").expect("a page")
    };
    let text = page(&scene);
    for wanted in [
        "<b>exact</b> the yardstick",
        "<b>f16</b> 5.00 % of pixels differ, at most 3 codes",
        "<b>f32</b> 5.00 % of pixels differ, at most 1 code<",
        "<b>fixed:8</b> every byte as exact",
        "as it should be; drawn, 15 pixels differ",
        "2 draws, 7 fragments, in this order",
        "3000 Transparent",
        "<td>0.02500</td><td>5.000 %</td><td>1</td>",
        "5 to 16",
    ] {
        assert!(text.contains(wanted), "`{wanted}` in {text}");
    }
    assert_eq!(text.matches("differs from exact").count(), 3, "a heat map for all but the yardstick");
    scene.reference = Some(ReferenceReport { difference: Difference::default(), picture: picture() });
    assert!(page(&scene).contains("</b> as drawn"), "nothing was wrong");
    assert!(!page(&scene).contains("side by side"), "one scene alone");
}
