//! The clamps of shader outputs and blend constants before they enter the equation.
//! Factors are clamped by [`Arithmetic::clamp_factor`](crate::model::Arithmetic::clamp_factor).
//!
//! Source: Vulkan, *Framebuffer / Blending* (the paragraph after the basic operations); D3D11.3 17.5. Float targets:
//! Vulkan clamps nothing; D3D may clamp to the format's range, and this model does not.

use crate::format::TargetClass;

/// Clamps a shader output or blend constant for a target class; NaN becomes 0 where a clamp applies.
///
/// D3D's `min(max(NaN, 0), 1)` gives 0, for signed targets as well by its conversion rule; Vulkan leaves NaN undefined.
#[must_use]
pub fn clamp_input(x: f32, class: TargetClass) -> f32 {
    match class {
        TargetClass::Float => x,
        _ if x.is_nan() => 0.0,
        TargetClass::Unorm => x.clamp(0.0, 1.0),
        TargetClass::Snorm => x.clamp(-1.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unorm_targets_clamp_before_blending() {
        assert_eq!(clamp_input(3.0, TargetClass::Unorm), 1.0, "so 3 times a constant of 0.25 is 0.25, not 0.75");
        assert_eq!(clamp_input(-1.0, TargetClass::Unorm), 0.0, "negative");
        assert_eq!(clamp_input(f32::NAN, TargetClass::Unorm), 0.0, "NaN");
    }

    #[test]
    fn snorm_targets_keep_the_sign() {
        assert_eq!(clamp_input(-3.0, TargetClass::Snorm), -1.0, "clamped");
        assert_eq!(clamp_input(-0.25, TargetClass::Snorm), -0.25, "kept");
    }

    #[test]
    fn float_targets_clamp_nothing() {
        assert!(clamp_input(f32::NAN, TargetClass::Float).is_nan(), "NaN");
        assert_eq!(clamp_input(1e30, TargetClass::Float), 1e30, "huge");
    }
}
