use std::path::Path;

use super::*;
use crate::model::llvmpipe::Generation;
use crate::scene::material::Pass;
use crate::scene::raster::Rasteriser;

const SCENE: &str = r#"version = 1
title = "Test"

[target]
width = 16
height = 16

[[material]]
name = "red"
mode = "fade"
tint = [1.0, 0.0, 0.0, 0.5]

[[object]]
name = "square"
mesh = "quad"
material = "red"
position = [0.0, 0.0, 0.0]
"#;

fn parse(text: &str) -> Result<Scene, SceneFileError> {
    Scene::parse(text, Syntax::Toml, Path::new("folder/test.toml"))
}

/// The message for `SCENE` with `from` replaced by `to`.
fn message(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "the test replaces `{from}`, which is not there");
    match parse(&SCENE.replace(from, to)) {
        Ok(_) => format!("accepted `{to}`"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_small_scene_is_read_with_defaults() {
    let scene = parse(SCENE).expect("a correct scene");
    assert_eq!(scene.title, "Test", "the title");
    assert_eq!(scene.target.colors[0].format.name(), "rgba8unorm", "the default format");
    assert!(scene.target.depth.is_some(), "a depth target by default");
    assert_eq!(scene.target.subpixel_bits, 8, "the usual grid");
    let coarse = parse(&SCENE.replace("width = 16", "width = 16\nsubpixel-bits = 4")).expect("a correct scene");
    assert_eq!(coarse.target.subpixel_bits, 4, "the grid it asks for");
    assert_eq!(scene.target.rasteriser, Rasteriser::Reference, "unless it asks for another");
    let driver = parse(&SCENE.replace("width = 16", "width = 16\nrasteriser = \"llvmpipe\"")).expect("a correct scene");
    assert_eq!(driver.target.rasteriser, Rasteriser::Llvmpipe(Generation::default()), "the newest");
    let older = "width = 16\nrasteriser = \"llvmpipe-unfused:mesa=22.3\"";
    let older = parse(&SCENE.replace("width = 16", older)).expect("a correct scene");
    assert_eq!(older.target.rasteriser, Rasteriser::LlvmpipeUnfused(Generation::Mesa22_3));
    assert_eq!(scene.materials[0].queue().number(), 3000, "the mode's queue");
}

#[test]
fn errors_name_file_line_and_field() {
    for (from, to, line, parts) in [
        ("width = 16", "width = 0", 5, "`target.width`: 0 is out of range; it must be 1 to 8192"),
        ("width = 16", "width = 100000", 5, "`target.width`: 100000 is out of range"),
        (
            "width = 16",
            "width = 16\nsubpixel-bits = 3",
            6,
            "`target.subpixel-bits`: 3 is out of range; it must be 4 to 8",
        ),
        (
            "width = 16",
            "width = 16\nsubpixel-bits = 9",
            6,
            "`target.subpixel-bits`: 9 is out of range; it must be 4 to 8",
        ),
        (
            "width = 16",
            "width = 16\nrasteriser = \"mesa\"",
            6,
            "`target.rasteriser`: unknown rasteriser `mesa`; use reference, llvmpipe",
        ),
        ("0.5]", "nan]", 11, "`material[0].tint`: NaN is not a finite number"),
        ("0.5]", "inf]", 11, "`material[0].tint`: inf is not a finite number"),
        ("0.5]", "1e300]", 11, "`material[0].tint`"),
        ("tint", "tin", 11, "`material[0].tin`: unknown field `tin`, expected one of"),
        ("\"fade\"", "\"fading\"", 10, "`material[0].mode`: unknown variant `fading`, expected one of `opaque`"),
        ("0.5]", "\"a\"]", 11, "`material[0].tint[3]`: invalid type: string \"a\""),
        ("\"quad\"", "\"torus\"", 15, "`object[0].mesh`: there is no mesh `torus`; use quad, cube, sphere"),
        ("material = \"red\"", "material = \"blue\"", 16, "`object[0].material`: there is no material `blue`; use red"),
        ("version = 1", "version = 2", 1, "`version`: this build reads scene version 1, not 2"),
        ("version = 1\n", "", 1, "`version`: a scene starts with `version = 1`"),
        ("[target]", "[target", 4, ""),
        ("height = 16", "height = 16\nformat = \"rgba9\"", 7, "`target.format`: unknown texture format `rgba9`"),
        ("mode = \"fade\"", "queue = \"Solid\"", 10, "`material[0].queue`: unknown render queue `Solid`"),
        ("[[object]]", "[camera]\nfar = 0.05\n[[object]]", 14, "`camera.far`: the far plane at 0.05 must lie behind"),
        ("[[object]]", "[camera]\nup = [0.0, 0.0, 2.0]\n[[object]]", 14, "`camera.up`"),
        ("position = [0.0, 0.0, 0.0]", "scale = [1.0, 0.0, 1.0]", 17, "`object[0].scale`: must not be zero"),
        (
            "[[object]]",
            "[[material.pass]]\nstate = \"Blend One Nothing\"\n[[object]]",
            14,
            "`material[0].pass[0].state`: line 1, column 11:",
        ),
        (
            "[[object]]",
            "[[texture]]\nname = \"t\"\nspace = \"srgb\"\nfile = \"missing.png\"\n[[object]]",
            16,
            "`texture[0].file`: cannot read `folder/missing.png`",
        ),
    ] {
        let message = message(from, to);
        let start = format!("folder/test.toml:{line}: {parts}");
        assert!(message.starts_with(&start), "`{from}` to `{to}`:\n  {message}\nshould start\n  {start}");
        assert!(message.lines().count() == 1, "one paragraph: {message}");
    }
}

#[cfg(feature = "json")]
#[test]
fn json_has_the_same_shape_and_errors() {
    let json = r#"{
  "version": 1,
  "title": "Test",
  "target": {"width": 16, "height": 16},
  "material": [
    {"name": "red", "mode": "fade",
     "tint": [1, 0, 0, 0.5]}
  ],
  "object": [{"name": "square", "mesh": "quad", "material": "red"}]
}"#;
    let read = |text: &str| Scene::parse(text, Syntax::Json, Path::new("test.json"));
    let (from_json, from_toml) = (read(json).expect("a correct scene"), parse(SCENE).expect("a correct scene"));
    assert_eq!(from_json.materials, from_toml.materials, "the same materials");
    assert_eq!(from_json.objects, from_toml.objects, "the same objects");
    for (from, to, start) in [
        ("\"width\": 16", "\"width\": -1", "test.json:4: `target.width`: -1 is out of range"),
        ("0.5]", "1e39]", "test.json:7: `material[0].tint`: inf is not a finite number"),
        ("\"tint\"", "\"tin\"", "test.json:7: `material[0].tin`: unknown field `tin`"),
        ("0.5]", "0.5", "test.json:7: expected"),
        ("\"quad\"", "\"torus\"", "test.json:9: `object[0].mesh`: there is no mesh `torus`"),
    ] {
        let message = read(&json.replace(from, to)).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
        assert!(message.starts_with(start), "`{from}` to `{to}`:\n  {message}\nshould start\n  {start}");
    }
}

#[test]
fn files_are_bounded_and_known_by_their_ending() {
    let long = format!("{SCENE}#{}", "x".repeat(5 << 20));
    assert!(matches!(parse(&long), Err(SceneFileError::TooLarge { .. })), "more than the limit");
    let error = Scene::load(Path::new("scene.yaml")).expect_err("not a scene's ending");
    assert!(error.to_string().contains(".toml or .json"), "{error}");
    let error = Scene::load(Path::new("no/such.toml")).expect_err("no such file");
    assert!(error.to_string().contains("no/such.toml"), "{error}");
}

#[test]
fn queue_minus_one_is_the_modes_own_and_tags_set_it_too() {
    let queue = |text: &str| {
        let scene = parse(&SCENE.replace("mode = \"fade\"", text)).expect("a correct scene");
        scene.materials[0].queue().number()
    };
    assert_eq!(queue("mode = \"cutout\"\nqueue = -1"), 2450, "the mode's own");
    assert_eq!(queue("mode = \"cutout\"\nqueue = 2500"), 2500, "by number");
    assert_eq!(queue("mode = \"cutout\"\nqueue = \"Transparent+1\""), 3001, "by name");
    let tags = SCENE.replace("[[object]]", "[[material.pass]]\nstate = 'Tags { \"Queue\" = \"Overlay\" }'\n[[object]]");
    let scene = parse(&tags).expect("a correct scene");
    assert_eq!(scene.materials[0].queue().number(), 4000, "by the pass's tags");
}

#[test]
fn properties_of_the_mode_fill_references_in_state_texts() {
    let text = "[[material.pass]]\nstate = 'Blend [_SrcBlend] [_DstBlend] ZWrite [_ZWrite]'\n[[object]]";
    let scene = parse(&SCENE.replace("[[object]]", text)).expect("a correct scene");
    let (explicit, preset) = (&scene.materials[0].passes()[0], Pass::base(scene.materials[0].mode));
    assert_eq!(explicit.state, preset.state, "the mode's own state, spelled out");
}

#[test]
fn faces_must_be_planar_and_convex() {
    let scene = |faces: &str| {
        let mesh = format!(
            "[[mesh]]\nname = \"m\"\npositions = [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0.3,0.3,0],[0,0,1]]\nfaces = {faces}\n[[object]]"
        );
        parse(&SCENE.replace("[[object]]", &mesh)).map(|scene| scene.meshes.len()).map_err(|error| error.to_string())
    };
    assert_eq!(scene("[[0, 1, 2, 3]]"), Ok(4), "a square beside the three built-in meshes");
    for (faces, why) in [
        ("[[0, 1]]", "3 to 64 corners"),
        ("[[0, 1, 9]]", "index 9 is out of range"),
        ("[[0, 1, 1]]", "must span a plane"),
        ("[[0, 1, 2, 5]]", "must span a plane"),
        ("[[0, 1, 4, 3]]", "must span a plane"),
    ] {
        let error = scene(faces).expect_err(why);
        assert!(error.contains("mesh[0].faces[0]") && error.contains(why), "{faces}: {error}");
    }
}

/// Every array of fixed length that a scene file may hold.
const ARRAYS: &str = r#"version = 1
title = "Arrays"
ambient = [0.1, 0.1, 0.1]
[target]
width = 16
height = 16
[[target.color]]
format = "rgba8unorm"
clear = [0.0, 0.0, 0.0, 1.0]
[camera]
eye = [0.0, 0.0, 5.0]
look-at = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
[[light]]
direction = [0.0, -1.0, 0.0]
color = [1.0, 1.0, 1.0]
[[light]]
position = [0.0, 1.0, 0.0]
range = 4.0
[[texture]]
name = "checks"
pattern = "checker"
size = [8, 8]
colors = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]]
space = "linear"
address = ["repeat", "repeat"]
[[mesh]]
name = "face"
positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
faces = [[0, 1, 2]]
[[material]]
name = "red"
mode = "fade"
tint = [1.0, 0.0, 0.0, 0.5]
texture = "checks"
[[material.pass]]
blend-constant = [0.0, 0.0, 0.0, 0.0]
[[object]]
mesh = "face"
material = "red"
position = [0.0, 0.0, 0.0]
rotation = [0.0, 0.0, 0.0]
scale = [1.0, 1.0, 1.0]
[replacement]
render-type = "Opaque"
color = [1.0, 0.0, 0.0]
"#;

#[test]
fn an_array_with_one_element_too_many_or_too_few_is_refused() {
    parse(ARRAYS).expect("a correct scene");
    let mut tried = 0;
    // Every innermost array but the corners of a face, whose number is free.
    for (start, _) in ARRAYS.match_indices('[') {
        let rest = &ARRAYS[start..];
        let Some(end) = rest.find(']').filter(|end| !rest[1..*end].contains(['[', '\n'])) else { continue };
        let array = &rest[..=end];
        if !array.contains(',') || array == "[0, 1, 2]" {
            continue;
        }
        let first = array[1..].split(',').next().expect("two elements or more");
        let more = format!("[{first}, {}", &array[1..]);
        let fewer = array.replacen(&format!("{first}, "), "", 1);
        for changed in [more, fewer] {
            let text = format!("{}{changed}{}", &ARRAYS[..start], &rest[end + 1..]);
            let error = parse(&text).expect_err(&changed).to_string();
            assert!(error.contains("expected an array of"), "{changed}: {error}");
            let line = ARRAYS[..start].matches('\n').count() + 1;
            assert!(error.starts_with(&format!("folder/test.toml:{line}:")), "line {line}: {error}");
            tried += 1;
        }
    }
    assert_eq!(tried, 2 * 24, "every array of the sample");
}
