//! Blend states by name, with the names engines give them.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as O, BlendState};

/// A named blend state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// The name.
    pub name: &'static str,
    /// The state; `None` is blending off.
    pub blend: Option<BlendState>,
    /// Whether depth is written with it by convention.
    pub depth_write: bool,
    /// What engines call it: `Engine: name`, perhaps with a remark after a semicolon.
    pub known_as: &'static [&'static str],
    /// What it does, in a sentence.
    pub about: &'static str,
}

const fn component(src_factor: F, dst_factor: F, operation: O) -> BlendComponent {
    BlendComponent { src_factor, dst_factor, operation }
}

/// One equation for color and alpha, as `Blend A B` has it.
const fn same(src_factor: F, dst_factor: F, operation: O) -> Option<BlendState> {
    let both = component(src_factor, dst_factor, operation);
    Some(BlendState { color: both, alpha: both })
}

/// Every preset.
pub const PRESETS: [Preset; 18] = [
    Preset {
        name: "opaque",
        blend: None,
        depth_write: true,
        known_as: &["Unity: Opaque", "Bevy: AlphaMode::Opaque", "three.js: NoBlending", "glTF: OPAQUE"],
        about: "The source replaces the destination.",
    },
    Preset {
        name: "cutout",
        blend: None,
        depth_write: true,
        known_as: &["Unity: Cutout", "Bevy: AlphaMode::Mask", "Godot: alpha scissor", "glTF: MASK"],
        about: "Opaque where the alpha test passes, nothing elsewhere.",
    },
    Preset {
        name: "fade",
        blend: same(F::SrcAlpha, F::OneMinusSrcAlpha, O::Add),
        depth_write: false,
        known_as: &["Unity: Fade", "Unity: Particles/Alpha Blended"],
        about: "Straight alpha; one equation for color and alpha, which squares the source alpha in the target's.",
    },
    Preset {
        name: "alpha-blending",
        blend: Some(BlendState::ALPHA_BLENDING),
        depth_write: false,
        known_as: &[
            "wgpu: ALPHA_BLENDING",
            "Bevy: AlphaMode::Blend",
            "Godot: blend_mix",
            "three.js: NormalBlending",
            "glTF: BLEND",
        ],
        about: "Straight alpha with a correct alpha channel: Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha.",
    },
    Preset {
        name: "transparent",
        blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        depth_write: false,
        known_as: &[
            "Unity: Transparent",
            "Bevy: AlphaMode::Premultiplied",
            "Bevy: AlphaMode::Add; its shader writes alpha 0",
            "Godot: blend_premul_alpha",
        ],
        about: "Premultiplied alpha: Blend One OneMinusSrcAlpha.",
    },
    Preset {
        name: "premultiplied",
        blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        depth_write: false,
        known_as: &[
            "wgpu: PREMULTIPLIED_ALPHA_BLENDING",
            "Unity: Particles/Alpha Blended Premultiply",
            "three.js: NormalBlending + premultipliedAlpha",
        ],
        about: "The same state as transparent.",
    },
    Preset {
        name: "additive",
        blend: same(F::One, F::One, O::Add),
        depth_write: false,
        known_as: &[
            "wgpu: ADDITIVE",
            "Unity: ForwardAdd; the light pass of opaque materials",
            "three.js: AdditiveBlending + premultipliedAlpha",
        ],
        about: "Adds the source: Blend One One.",
    },
    Preset {
        name: "additive-alpha",
        blend: same(F::SrcAlpha, F::One, O::Add),
        depth_write: false,
        known_as: &[
            "Unity: Particles/Additive",
            "Godot: blend_add",
            "three.js: AdditiveBlending; newer releases add alpha unscaled",
        ],
        about: "Adds the source scaled by its alpha: Blend SrcAlpha One.",
    },
    Preset {
        name: "soft-additive",
        blend: same(F::OneMinusDst, F::One, O::Add),
        depth_write: false,
        known_as: &["Unity: soft additive"],
        about: "Adds less where the destination is bright: Blend OneMinusDstColor One.",
    },
    Preset {
        name: "screen",
        blend: same(F::One, F::OneMinusSrc, O::Add),
        depth_write: false,
        known_as: &["Unity: Particles/Additive (Soft)"],
        about: "Multiplies the complements: Blend One OneMinusSrcColor.",
    },
    Preset {
        name: "multiply",
        blend: same(F::Dst, F::Zero, O::Add),
        depth_write: false,
        known_as: &["Unity: multiplicative", "Godot: blend_mul"],
        about: "Multiplies: Blend DstColor Zero.",
    },
    Preset {
        name: "modulate",
        blend: same(F::Zero, F::Src, O::Add),
        depth_write: false,
        known_as: &["Unity: Particles/Multiply", "three.js: MultiplyBlending"],
        about: "Multiplies, the destination scaled by the source: Blend Zero SrcColor.",
    },
    Preset {
        name: "multiply-premultiplied",
        blend: Some(BlendState {
            color: component(F::Dst, F::OneMinusSrcAlpha, O::Add),
            alpha: component(F::One, F::OneMinusSrcAlpha, O::Add),
        }),
        depth_write: false,
        known_as: &["Bevy: AlphaMode::Multiply"],
        about: "Multiplies by a premultiplied source where it covers: Blend DstColor OneMinusSrcAlpha, One OneMinusSrcAlpha.",
    },
    Preset {
        name: "multiply-2x",
        blend: same(F::Dst, F::Src, O::Add),
        depth_write: false,
        known_as: &["Unity: 2x multiplicative", "Unity: Particles/Multiply (Double)"],
        about: "Multiplies and doubles: Blend DstColor SrcColor.",
    },
    Preset {
        name: "subtractive",
        blend: same(F::SrcAlpha, F::One, O::ReverseSubtract),
        depth_write: false,
        known_as: &["Godot: blend_sub"],
        about: "Subtracts the source scaled by its alpha: BlendOp RevSub, Blend SrcAlpha One.",
    },
    Preset {
        name: "inverse-multiply",
        blend: same(F::Zero, F::OneMinusSrc, O::Add),
        depth_write: false,
        known_as: &["three.js: SubtractiveBlending"],
        about: "Multiplies by one minus the source: Blend Zero OneMinusSrcColor.",
    },
    Preset {
        name: "lighten",
        blend: same(F::One, F::One, O::Max),
        depth_write: false,
        known_as: &["GL: GL_MAX"],
        about: "The larger of source and destination, channel by channel: BlendOp Max.",
    },
    Preset {
        name: "darken",
        blend: same(F::One, F::One, O::Min),
        depth_write: false,
        known_as: &["GL: GL_MIN"],
        about: "The smaller of source and destination, channel by channel: BlendOp Min.",
    },
];

/// The preset an engine's name stands for, `Godot: blend_mul` or `blend_mul`, or the preset with this name; in any case.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Preset> {
    let own = PRESETS.iter().find(|preset| preset.name.eq_ignore_ascii_case(name));
    own.or_else(|| PRESETS.iter().find(|preset| preset.known_as.iter().any(|known| is_alias(known, name))))
}

/// Whether `name` is this `Engine: name; remark`, with or without the engine, without the remark.
fn is_alias(known: &str, name: &str) -> bool {
    let full = known.split("; ").next().unwrap_or(known);
    let short = full.split_once(": ").map_or(full, |(_, short)| short);
    name.eq_ignore_ascii_case(full) || name.eq_ignore_ascii_case(short)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for (i, preset) in PRESETS.iter().enumerate() {
            assert_eq!(by_name(preset.name), Some(&PRESETS[i]), "{}", preset.name);
        }
        assert_eq!(by_name("no such preset"), None, "unknown");
    }

    #[test]
    fn every_engine_name_stands_for_one_preset() {
        for preset in &PRESETS {
            for known in preset.known_as {
                let full = known.split("; ").next().expect("split yields one part");
                let (_, short) = full.split_once(": ").unwrap_or_else(|| panic!("{known}: engine, colon, name"));
                for name in [full, short, &short.to_uppercase()] {
                    assert_eq!(by_name(name).map(|found| found.name), Some(preset.name), "{name}");
                }
            }
        }
    }

    #[test]
    fn presets_pass_validation() {
        for preset in &PRESETS {
            let format = wgpu_types::TextureFormat::Rgba8Unorm;
            let target = wgpu_types::ColorTargetState { blend: preset.blend, ..format.into() };
            let state = crate::state::MergerState::single(target);
            assert_eq!(crate::state::validate::validate(&state), Ok(vec![]), "{}", preset.name);
        }
    }
}
