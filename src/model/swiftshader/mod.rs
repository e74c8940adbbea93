//! The `swiftshader` model: SwiftShader's Vulkan driver as Chromium ships it, bit for bit.
//!
//! Provenance: the libraries of Debian's `chromium-common` package and of other builds (Subzero backend, x86-64 with SSE4.1),
//! whose public source tells the method; checked by `outmerge conform --adapter SwiftShader --model swiftshader`. Builds store
//! alike by [`Generation`].
//!
//! The driver follows the specification's equation in binary32 on every format, nothing fused, so this model is an
//! [`Arithmetic`] and differs from the `f32` model in its conversions only:
//!
//! | conversion | what is particular |
//! |---|---|
//! | load unorm | the code is repeated to 16 bits, then multiplied by 1/65535 rounded to binary32 |
//! | load and store sRGB | the curve by polynomials for log2 and exp2 ([`srgb`]) |
//! | load half | exponent 31 is an ordinary exponent: no Inf, no NaN ([`half`]) |
//! | store half | Inf and overflow become NaN; denormals are cut before they are rounded ([`half`]) |
//! | store 11/10-bit float | rounded to half first, then cut ([`half`]) |
//! | min, max, clamps | comparisons: the second operand where they do not compare |
//! | arithmetic | denormal operands and results are zeros |
//! | NaN | 0 from the shader and in unorm stores; the largest code after the sRGB curve, where a blend constant brought it |
//! | constant factors 0 and 1 | some equations are shortened before drawing (`shortcut`) |

pub mod generation;
pub mod half;
mod shortcut;
pub mod srgb;

pub use generation::{Generation, GenerationError};

use wgpu_types::BlendState;

use super::binary32::{encode_scaled, small_to_f32};
use super::{Arithmetic, ColorInputs, Explanation, Number, NumericModel, Unsupported};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, TargetClass, unorm};
use crate::merger::blend::{self, Steps, blend};
use crate::merger::encode::encode;
use crate::state::reads_second_source;

/// The SwiftShader model, of the present generation by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SwiftShader {
    /// Builds of the driver.
    pub generation: Generation,
}

/// Denormal operands and results are zeros of the same sign: the driver computes with FTZ and DAZ set.
fn flush(x: f32) -> f32 {
    if x.is_subnormal() { 0.0_f32.copysign(x) } else { x }
}

/// The driver's `Min`: the second operand where the two do not compare, or are equal.
fn lower(x: f32, y: f32) -> f32 {
    let (x, y) = (flush(x), flush(y));
    if x < y { x } else { y }
}

/// The driver's `Max`, likewise.
fn higher(x: f32, y: f32) -> f32 {
    let (x, y) = (flush(x), flush(y));
    if x > y { x } else { y }
}

/// To [0, 1]; NaN gives 0.
fn unit(x: f32) -> f32 {
    lower(higher(x, 0.0), 1.0)
}

/// The code repeated from the top of 16 bits downwards.
fn repeat_to_16(code: u32, bits: u32) -> u32 {
    (0..16_u32.div_ceil(bits)).fold(0, |all, i| {
        let from_top = 16 - (i + 1).saturating_mul(bits).min(16);
        // The last repetition is cut at the bottom.
        let cut = ((i + 1) * bits).saturating_sub(16);
        all | (code >> cut) << from_top
    })
}

impl Arithmetic for SwiftShader {
    type Value = f32;

    fn take_in(&self, x: f32, _format: ColorFormat, _channel: usize) -> f32 {
        x
    }

    /// NaN passes the constant's clamp.
    fn take_in_constant(&self, x: f32, format: ColorFormat, _channel: usize) -> f32 {
        let lowest = match format.class() {
            TargetClass::Float => return x,
            TargetClass::Unorm => 0.0,
            TargetClass::Snorm => -1.0,
        };
        // Keeps NaN.
        x.clamp(lowest, 1.0)
    }

    fn decode(&self, code: u32, kind: ChannelKind) -> f32 {
        match kind {
            ChannelKind::Absent => 0.0,
            ChannelKind::Unorm(bits) => small_to_f32(repeat_to_16(code, bits)) * (1.0 / 65535.0),
            ChannelKind::Srgb if self.generation == Generation::Chromium110 => generation::srgb_by_table(code),
            ChannelKind::Srgb => srgb::decode(small_to_f32(repeat_to_16(code, 8)) * (1.0 / 65535.0)),
            ChannelKind::Float(layout) => half::decode(layout, code),
            // Not rendered to by the driver; see `supports`.
            ChannelKind::Snorm(_) => super::binary32::decode_binary32(code, kind),
        }
    }

    fn zero(&self) -> f32 {
        0.0
    }

    fn one(&self) -> f32 {
        1.0
    }

    fn complement(&self, x: &f32) -> f32 {
        flush(1.0 - flush(*x))
    }

    fn saturate(&self, src_alpha: &f32, room: &f32) -> f32 {
        lower(*room, *src_alpha)
    }

    fn multiply(&self, x: &f32, factor: &f32) -> f32 {
        let (x, factor) = (flush(*x), flush(*factor));
        // Flushed as if the exponent had no bounds: below (1 - 2^-25) 2^-126, where a denormal may round up to 2^-126.
        let exact = f64::from(x) * f64::from(factor);
        if exact.abs() < f64::from(f32::MIN_POSITIVE) * (1.0 - 2.0_f64.powi(-25)) {
            return 0.0_f32.copysign(x * factor);
        }
        x * factor
    }

    fn add(&self, x: &f32, y: &f32) -> f32 {
        flush(flush(*x) + flush(*y))
    }

    fn subtract(&self, x: &f32, y: &f32) -> f32 {
        flush(flush(*x) - flush(*y))
    }

    fn minimum(&self, x: &f32, y: &f32) -> f32 {
        lower(*x, *y)
    }

    fn maximum(&self, x: &f32, y: &f32) -> f32 {
        higher(*x, *y)
    }

    /// A NaN is left to the store: on sRGB channels the curve comes first.
    fn clamp(&self, x: &f32, class: TargetClass) -> f32 {
        match class {
            TargetClass::Unorm if x.is_nan() => *x,
            TargetClass::Float => *x,
            TargetClass::Unorm => unit(*x),
            TargetClass::Snorm => lower(higher(*x, -1.0), 1.0),
        }
    }

    fn encode(&self, x: &f32, kind: ChannelKind) -> u32 {
        if let Some(code) = self.generation.unorm_code(*x, kind) {
            return code;
        }
        match kind {
            ChannelKind::Srgb => encode_scaled(unit(srgb::encode(*x)), ChannelKind::Unorm(8), |x, steps| x * steps),
            ChannelKind::Float(layout) => half::encode(layout, *x),
            ChannelKind::Unorm(_) => encode_scaled(unit(*x), kind, |x, steps| x * steps),
            _ => encode_scaled(*x, kind, |x, steps| x * steps),
        }
    }

    fn describe(&self, x: &f32) -> Number {
        Number::binary(f64::from(*x))
    }
}

impl SwiftShader {
    fn steps(&self, inputs: &ColorInputs) -> Steps<f32> {
        shortcut::apply(inputs, blend(self, inputs))
    }

    fn stored(&self, inputs: &ColorInputs, steps: &Steps<f32>) -> Codes {
        match inputs.blend {
            Some(blend) if shortcut::keeps_destination(&blend) => self.rewrite_untouched(inputs.format, inputs.dst),
            _ => encode(self, inputs, steps),
        }
    }
}

impl NumericModel for SwiftShader {
    fn name(&self) -> String {
        format!("swiftshader:chromium={}", self.generation)
    }

    fn provenance(&self) -> String {
        let (range, evidence) = (self.generation.range(), self.generation.evidence());
        format!(
            "SwiftShader's Vulkan driver as shipped with Chromium {range}, x86-64; public source, checked through wgpu: {evidence}"
        )
    }

    fn supports(&self, format: ColorFormat, blend: Option<&BlendState>) -> Result<(), Unsupported> {
        let unsupported = |reason| Err(Unsupported { model: self.name(), what: format.name().to_owned(), reason });
        if format.class() == TargetClass::Snorm {
            return unsupported("the driver does not render to signed normalised targets");
        }
        if blend.is_some_and(reads_second_source) {
            return unsupported("the driver has no second blend source");
        }
        Ok(())
    }

    /// They were not measured.
    fn knows_clears(&self) -> bool {
        false
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        self.stored(inputs, &self.steps(inputs))
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        let steps = self.steps(inputs);
        blend::explain(self, inputs, &steps, self.stored(inputs, &steps))
    }

    /// Fragment depth is clamped to `[0, 1]`; the viewport's range matters only with depth clamping on.
    fn depth_code(&self, kind: DepthKind, z: f32, _range: [f32; 2]) -> u32 {
        let z = unit(z);
        match kind {
            DepthKind::Float32 => z.to_bits(),
            DepthKind::Unorm(16) => encode_scaled(z, ChannelKind::Unorm(16), |x, steps| x * steps),
            // The driver has no 24-bit depth; wgpu stores such targets in 32-bit floats, read here as 24-bit codes.
            DepthKind::Unorm(bits) => unorm::encode(f64::from(z), bits, crate::format::Rounding::NearestAway),
        }
    }

    /// A covered texel of r16float is read and stored again even where nothing may change, which turns Inf into NaN.
    fn rewrite_untouched(&self, format: ColorFormat, codes: Codes) -> Codes {
        match format.channels() {
            [ChannelKind::Float(FloatLayout::HALF), ChannelKind::Absent, ..] => {
                let [r, rest @ ..] = codes;
                let [g, b, a] = rest;
                [half::encode(FloatLayout::HALF, half::decode(FloatLayout::HALF, r)), g, b, a]
            }
            _ => codes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unorm_codes_are_repeated_to_16_bits() {
        assert_eq!(repeat_to_16(0xab, 8), 0xabab, "8 bits twice");
        assert_eq!(repeat_to_16(0x3ff, 10), 0xffff, "10 bits and their top 6");
        assert_eq!(repeat_to_16(0x201, 10), 0x8060, "0x201 << 6 | 0x201 >> 4");
        assert_eq!([0, 1, 2, 3].map(|code| repeat_to_16(code, 2)), [0, 0x5555, 0xaaaa, 0xffff], "2 bits eight times");
        assert_eq!(repeat_to_16(0x1234, 16), 0x1234, "16 bits as they are");
    }

    /// Stored by the driver (`conform --level exhaustive`, unit blend/rgba8unorm-srgb/zero).
    #[test]
    fn a_nan_constant_becomes_the_largest_srgb_code_and_a_unorm_0() {
        use wgpu_types::{BlendComponent, BlendFactor, BlendOperation};

        let both = BlendComponent {
            src_factor: BlendFactor::Zero,
            dst_factor: BlendFactor::Constant,
            operation: BlendOperation::Add,
        };
        let stored = |format, src| {
            SwiftShader::default().merge_color(&ColorInputs {
                format: ColorFormat::from_name(format).expect("a format"),
                blend: Some(BlendState { color: both, alpha: both }),
                constant: [f32::NAN, 0.361_641_65, 0.823_628, 0.293_252_2],
                src: [src; 4],
                src1: [0.0; 4],
                dst: [0xe0, 0x70, 0x51, 0x96],
            })
        };
        assert_eq!(stored("rgba8unorm-srgb", 0.5), [0xff, 0x44, 0x4a, 0x2c]);
        assert_eq!(stored("rgba8unorm-srgb", f32::NAN), [0xff, 0x44, 0x4a, 0x2c]);
        assert_eq!(stored("rgba8unorm", 0.5)[0], 0);
    }

    #[test]
    fn where_numbers_do_not_compare_the_second_operand_counts() {
        assert!(SwiftShader::default().minimum(&1.0, &f32::NAN).is_nan(), "second");
        assert_eq!(SwiftShader::default().minimum(&f32::NAN, &1.0), 1.0, "second");
        assert_eq!(SwiftShader::default().saturate(&0.25, &f32::NAN), 0.25, "the room is the first operand");
        assert_eq!(unit(f32::NAN), 0.0, "clamps give 0");
    }

    #[test]
    fn every_8_bit_code_survives_load_and_store() {
        for code in 0..=255 {
            for kind in [ChannelKind::Unorm(8), ChannelKind::Srgb] {
                assert_eq!(
                    SwiftShader::default().encode(&SwiftShader::default().decode(code, kind), kind),
                    code,
                    "{kind:?} {code}"
                );
            }
        }
    }
}
