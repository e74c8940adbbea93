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
    /// What engines call it: `Engine: name`.
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
pub const PRESETS: [Preset; 12] = [
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
        known_as: &["Unity: Fade", "GL tutorials: SRC_ALPHA, ONE_MINUS_SRC_ALPHA"],
        about: "Straight alpha; one equation for color and alpha, which squares the source alpha in the target's.",
    },
    Preset {
        name: "alpha-blending",
        blend: Some(BlendState::ALPHA_BLENDING),
        depth_write: false,
        known_as: &["wgpu: ALPHA_BLENDING", "Bevy: AlphaMode::Blend", "Godot: blend_mix", "three.js: NormalBlending"],
        about: "Straight alpha with a correct alpha channel: Blend SrcAlpha OneMinusSrcAlpha, One OneMinusSrcAlpha.",
    },
    Preset {
        name: "transparent",
        blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        depth_write: false,
        known_as: &["Unity: Transparent", "Bevy: AlphaMode::Premultiplied", "Godot: blend_premul_alpha"],
        about: "Premultiplied alpha: Blend One OneMinusSrcAlpha.",
    },
    Preset {
        name: "premultiplied",
        blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        depth_write: false,
        known_as: &["wgpu: PREMULTIPLIED_ALPHA_BLENDING", "three.js: premultipliedAlpha + NormalBlending"],
        about: "The same state as transparent.",
    },
    Preset {
        name: "additive",
        blend: same(F::One, F::One, O::Add),
        depth_write: false,
        known_as: &["wgpu: ADDITIVE", "Unity: Particles/Additive (premultiplied)", "Unity: light pass"],
        about: "Adds the source: Blend One One.",
    },
    Preset {
        name: "additive-alpha",
        blend: same(F::SrcAlpha, F::One, O::Add),
        depth_write: false,
        known_as: &[
            "Unity: Particles/Additive",
            "Godot: blend_add",
            "three.js: AdditiveBlending",
            "Bevy: AlphaMode::Add",
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
        name: "multiply",
        blend: same(F::Dst, F::Zero, O::Add),
        depth_write: false,
        known_as: &[
            "Unity: multiplicative",
            "Godot: blend_mul",
            "three.js: MultiplyBlending",
            "Bevy: AlphaMode::Multiply",
        ],
        about: "Multiplies: Blend DstColor Zero.",
    },
    Preset {
        name: "multiply-2x",
        blend: same(F::Dst, F::Src, O::Add),
        depth_write: false,
        known_as: &["Unity: 2x multiplicative"],
        about: "Multiplies and doubles: Blend DstColor SrcColor.",
    },
    Preset {
        name: "subtractive",
        blend: same(F::SrcAlpha, F::One, O::ReverseSubtract),
        depth_write: false,
        known_as: &["Godot: blend_sub", "three.js: SubtractiveBlending (nearest)"],
        about: "Subtracts the source scaled by its alpha: BlendOp RevSub, Blend SrcAlpha One.",
    },
];

/// The preset with this name, in any case.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name.eq_ignore_ascii_case(name))
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
}
