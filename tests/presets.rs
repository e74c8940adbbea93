//! The presets as a table of engines' names, docs/presets.md, made from the code.
//!
//! After a wanted change: `OUTMERGE_BLESS=1 cargo test --test presets`, then read `git diff docs/presets.md`.

use std::fmt::Write as _;
use std::path::Path;

use outmerge::state::preset::{PRESETS, Preset, by_name};
use outmerge::state::spelling::{factor_name, operation_name};
use wgpu_types::BlendComponent;

const ENGINES: [&str; 4] = ["Unity", "Bevy", "Godot", "three.js"];

fn equation(component: &BlendComponent) -> String {
    let (src, dst) = (factor_name(component.src_factor), factor_name(component.dst_factor));
    format!("{} {src} {dst}", operation_name(component.operation))
}

/// What an engine calls it; with `None` what everyone else does, with the engine.
fn names(preset: &Preset, engine: Option<&str>) -> String {
    let named = preset.known_as.iter().filter_map(|known| {
        let (owner, name) = known.split_once(": ").expect("engine, colon, name");
        match engine {
            Some(engine) => (owner == engine).then(|| name.to_owned()),
            None => (!ENGINES.contains(&owner)).then(|| (*known).to_owned()),
        }
    });
    named.collect::<Vec<_>>().join("; ")
}

fn table() -> String {
    let mut text = "# Presets\n\nNamed blend states and what engines call them; made from `src/state/preset.rs` by `tests/presets.rs`. Every name\n\
                    below works where a state is asked for: `outmerge explain --state 'Godot: blend_mul' ...`, with or without the engine.\n\n\
                    | preset | color | alpha | depth write | Unity | Bevy | Godot | three.js | others |\n|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for preset in &PRESETS {
        let (color, alpha) = match &preset.blend {
            None => ("blending off".to_owned(), String::new()),
            Some(blend) if blend.color == blend.alpha => (equation(&blend.color), "as color".to_owned()),
            Some(blend) => (equation(&blend.color), equation(&blend.alpha)),
        };
        let depth = if preset.depth_write { "yes" } else { "no" };
        let engines = ENGINES.map(|engine| names(preset, Some(engine))).join(" | ");
        let _ =
            writeln!(text, "| `{}` | {color} | {alpha} | {depth} | {engines} | {} |", preset.name, names(preset, None));
    }
    text.push_str("\n## What they do\n\n");
    for preset in &PRESETS {
        let _ = writeln!(text, "- `{}`: {}", preset.name, preset.about);
    }
    text
}

#[test]
fn the_table_of_presets_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/presets.md");
    if std::env::var_os("OUTMERGE_BLESS").is_some() {
        std::fs::write(&path, table()).expect("writable");
    }
    let stored = std::fs::read_to_string(&path).expect("the table is committed");
    for (number, (stored, now)) in stored.lines().zip(table().lines()).enumerate() {
        assert_eq!(stored, now, "docs/presets.md:{}: left is stored, right is now", number + 1);
    }
    assert_eq!(stored, table(), "docs/presets.md has other lines at its end");
}

#[test]
fn every_engine_names_a_blended_state_of_its_own() {
    for engine in ENGINES {
        let named = PRESETS.iter().filter(|preset| !names(preset, Some(engine)).is_empty());
        let blended = named.filter(|preset| preset.blend.is_some()).count();
        assert!(blended >= 3, "{engine}: {blended} blended states");
    }
    let state = |name: &str| by_name(name).unwrap_or_else(|| panic!("{name}")).blend;
    assert_eq!(state("Bevy: AlphaMode::Blend"), state("Godot: blend_mix"), "straight alpha is the same everywhere");
    assert_eq!(state("Unity: Transparent"), state("Godot: blend_premul_alpha"), "and so is premultiplied");
}
