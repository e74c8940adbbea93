//! The `llvmpipe` model: Mesa's llvmpipe rasteriser (lavapipe, its Vulkan driver), bit for bit.
//!
//! The driver's bytes depend on three things, and a [`Llvmpipe`] names all of them: the [`Generation`], which is a range of
//! versions of Mesa; the [`VectorWidth`] it compiles for; and the processor's reciprocal square root [`Estimate`], which sRGB
//! targets show. `llvmpipe:mesa=25.0,rsqrt=amd-zen5` is such a name ([`LlvmpipeName`]).
//!
//! Provenance: Debian's packages on x86-64 with AVX2, FMA and F16C, found by experiment through wgpu and checked by `outmerge
//! conform --model llvmpipe`; versions in [`generation`].
//!
//! The driver picks one of four arithmetics by target format and fuses load, blend and encode, so it replaces those
//! stages as one unit:
//!
//! | formats | arithmetic |
//! |---|---|
//! | 8-bit unorm | [`integer`]: 8-bit codes, source quantised before blending |
//! | 16-bit unorm, rgb10a2 | [`integer`]: 16-bit codes |
//! | float | [`float`]: binary32, stores truncate |
//! | 8-bit sRGB | [`srgb`] around the float arithmetic |
//! | snorm | `snorm`: unblended stores only |
//!
//! Channels the format lacks are handled by rewriting the state (`state`) before any arithmetic.

mod clear;
mod depth;
pub mod float;
pub mod generation;
pub mod integer;
mod name;
pub mod rsqrt;
mod snorm;
pub mod srgb;
mod state;
mod steps;

pub use generation::{Footing, Generation};
pub use name::{LlvmpipeName, LlvmpipeNameError};
pub use rsqrt::Estimate;

use wgpu_types::{BlendFactor, BlendState, MultisampleState};

use float::ZeroTerms;
use generation::{SampleMask, ZeroFactor};

use super::{ColorInputs, Explanation, NumericModel, Unsupported};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, TargetClass};

/// Width of the vectors the driver compiles for; it changes the clamp of 8-bit sources, and nothing else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VectorWidth {
    /// 256 bits: a processor with AVX, the usual case.
    #[default]
    Bits256,
    /// 128 bits: no AVX, or `LP_NATIVE_VECTOR_WIDTH=128`.
    Bits128,
}

/// The llvmpipe model: of the newest generation, 256 bits and a recorded processor by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Llvmpipe {
    /// Version of Mesa.
    pub generation: Generation,
    /// Vector width of the driver that is modelled.
    pub vector_width: VectorWidth,
    /// The processor's reciprocal square root estimate.
    pub estimate: Estimate,
}

impl Llvmpipe {
    /// The codes an unblended draw stores for a shader output: the store alone, for sweeps over every `f32`.
    #[must_use]
    pub fn store(self, format: ColorFormat, src: [f32; 4]) -> Codes {
        let channels = format.channels();
        // Alpha beside sRGB channels is stored from the float blender, which clamps at every width.
        let width = if channels[0] == ChannelKind::Srgb { VectorWidth::Bits256 } else { self.vector_width };
        std::array::from_fn(|i| match channels[i] {
            ChannelKind::Absent => 0,
            ChannelKind::Srgb => srgb::encode(srgb::clamp_unit(src[i]), self.estimate),
            ChannelKind::Unorm(8) => integer::quantize8(src[i], width),
            ChannelKind::Unorm(bits) => integer::narrow16(bits, integer::quantize16(src[i])),
            ChannelKind::Snorm(bits) => snorm::store_code(src[i], bits),
            ChannelKind::Float(layout) => float::store(layout, src[i]),
        })
    }

    /// Every intermediate number and the codes.
    fn run(self, inputs: &ColorInputs) -> steps::Steps {
        let format = inputs.format;
        let rules = self.generation.rules();
        match (format.class(), format.channels()[0]) {
            (TargetClass::Unorm, ChannelKind::Srgb) => srgb::merge(inputs, self.estimate),
            (TargetClass::Unorm, ChannelKind::Unorm(8)) => integer::merge8(inputs, self.vector_width, rules),
            (TargetClass::Unorm, _) => integer::merge16(inputs, rules),
            (TargetClass::Snorm, _) => snorm::store(inputs),
            (TargetClass::Float, _) => float::merge(inputs, rules, ZeroTerms::Dropped),
        }
    }
}

impl NumericModel for Llvmpipe {
    fn name(&self) -> String {
        name::name(*self)
    }

    fn provenance(&self) -> String {
        let (range, evidence) = (self.generation.range(), self.generation.facts().evidence);
        let bits = match self.vector_width {
            VectorWidth::Bits256 => 256,
            VectorWidth::Bits128 => 128,
        };
        let processor = self.estimate.processor();
        format!(
            "Mesa {range}'s llvmpipe (lavapipe), {bits}-bit vectors, square roots of {processor}; measured through wgpu: {evidence}"
        )
    }

    fn supports(&self, format: ColorFormat, blend: Option<&BlendState>) -> Result<(), Unsupported> {
        if format.class() == TargetClass::Snorm && blend.is_some() {
            return Err(Unsupported {
                model: self.name(),
                what: format.name().to_owned(),
                reason: "wgpu offers no blending on signed normalised targets of this driver, so nothing could be measured",
            });
        }
        Ok(())
    }

    fn merge_color(&self, inputs: &ColorInputs) -> Codes {
        self.run(inputs).codes
    }

    /// On 11/10-bit float targets, where a factor is the constant zero and its operand is not finite ([`generation::ZeroFactor`]).
    fn alternative(&self, inputs: &ColorInputs) -> Option<Codes> {
        let rules = self.generation.rules();
        if !float::is_undecided(inputs, rules) {
            return None;
        }
        let [one, other] =
            [ZeroTerms::Dropped, ZeroTerms::Multiplied].map(|terms| float::merge(inputs, rules, terms).codes);
        (one != other).then_some(other)
    }

    fn clear_color(&self, format: ColorFormat, color: [f32; 4]) -> Codes {
        let channels = format.channels();
        let rule = self.generation.rules().clear;
        std::array::from_fn(|i| clear::code(channels[i], color[i], rule))
    }

    /// Clears store a float as it is, where a fragment's depth loses its denormals and the sign of a zero.
    fn clear_depth(&self, kind: DepthKind, z: f32) -> u32 {
        match kind {
            DepthKind::Float32 => z.to_bits(),
            DepthKind::Unorm(_) => kind.encode(z, [0.0, 1.0]),
        }
    }

    fn explain_color(&self, inputs: &ColorInputs) -> Explanation {
        steps::explain(inputs, &self.run(inputs))
    }

    /// The oldest generation asks only whether the mask of a single sample is 0 ([`generation::SampleMask`]).
    fn sample_mask(&self, multisample: &MultisampleState) -> u64 {
        let ignored = self.generation.rules().sample_mask == SampleMask::Ignored;
        if ignored && multisample.count == 1 && multisample.mask != 0 { u64::MAX } else { multisample.mask }
    }

    fn float_rule(&self) -> Option<crate::kernel::FloatRule> {
        Some(crate::kernel::FloatRule::Llvmpipe(*self))
    }

    fn unorm8_rule(&self) -> Option<crate::kernel::Rule> {
        Some(crate::kernel::Rule::Llvmpipe(self.generation.rules().product))
    }

    /// The driver clamps fragment depth to `[0, 1]`; the viewport's range matters to it only with depth clamping on.
    fn depth_code(&self, kind: DepthKind, z: f32, _range: [f32; 2]) -> u32 {
        depth::depth_code(kind, z)
    }

    /// Covered texels of half and 11/10-bit float targets are decoded and encoded again even where nothing may change:
    /// a signalling NaN comes back quiet, an 11/10-bit NaN canonical.
    fn rewrite_untouched(&self, format: ColorFormat, codes: Codes) -> Codes {
        let channels = format.channels();
        std::array::from_fn(|i| match channels[i] {
            ChannelKind::Float(layout) if layout == FloatLayout::HALF && layout.is_nan(codes[i]) => codes[i] | 0x200,
            ChannelKind::Float(layout) if !layout.signed && layout.is_nan(codes[i]) => layout.nan(),
            _ => codes[i],
        })
    }

    fn rewrites_untouched(&self, format: ColorFormat) -> bool {
        let rewritten =
            |kind: &ChannelKind| matches!(kind, ChannelKind::Float(layout) if *layout != FloatLayout::SINGLE);
        format.channels().iter().any(rewritten)
    }

    /// A term is dropped when every lane of the vector has factor zero. Single-channel targets interpolate instead:
    /// `One Zero` is fma(1, S - D, D) there, which even a finite destination changes.
    fn drops_zero_destination(&self, format: ColorFormat, blend: &BlendState) -> bool {
        let blend = state::rewrite(*blend, format);
        let packed = matches!(format.channels()[0], ChannelKind::Float(layout) if !layout.signed);
        if packed && self.generation.rules().zero_factor != ZeroFactor::Dropped {
            return false;
        }
        let has_alpha = format.channels()[3] != ChannelKind::Absent;
        let zero = |factor| factor == BlendFactor::Zero;
        state::channel_count(format) > 1 && zero(blend.color.dst_factor) && (!has_alpha || zero(blend.alpha.dst_factor))
    }
}

#[cfg(test)]
mod tests {
    use wgpu_types::TextureFormat;

    use super::*;
    use crate::format::layout::FORMATS;

    #[test]
    fn the_store_alone_is_what_an_unblended_draw_stores() {
        for vector_width in [VectorWidth::Bits256, VectorWidth::Bits128] {
            let model = Llvmpipe { vector_width, ..Llvmpipe::default() };
            for (name, texture_format) in FORMATS {
                let format = ColorFormat::new(texture_format).expect("listed");
                for bits in (0..=u32::MAX).step_by(65_521) {
                    let (src, zeros) = ([f32::from_bits(bits); 4], [0.0; 4]);
                    let inputs = ColorInputs { format, blend: None, constant: zeros, src, src1: zeros, dst: [0; 4] };
                    let expected = model.merge_color(&inputs);
                    assert_eq!(model.store(format, src), expected, "{name}, {vector_width:?}, {bits:#x}");
                }
            }
        }
    }

    #[test]
    fn narrow_vectors_lose_huge_numbers_in_stored_channels_only() {
        let inf = [f32::INFINITY; 4];
        let narrow = Llvmpipe { vector_width: VectorWidth::Bits128, ..Llvmpipe::default() };
        let codes = |model: Llvmpipe, format, dst_factor| {
            let both = wgpu_types::BlendComponent {
                src_factor: BlendFactor::Zero,
                dst_factor,
                operation: wgpu_types::BlendOperation::Add,
            };
            let inputs = ColorInputs {
                format: ColorFormat::new(format).expect("known"),
                blend: Some(BlendState { color: both, alpha: both }),
                constant: inf,
                src: inf,
                src1: inf,
                dst: [200; 4],
            };
            model.merge_color(&inputs)[0]
        };
        use BlendFactor as F;
        for format in [TextureFormat::R8Unorm, TextureFormat::Rg8Unorm, TextureFormat::Rgba8Unorm] {
            let wide = Llvmpipe::default();
            assert_eq!([F::Src, F::SrcAlpha].map(|f| codes(wide, format, f)), [200, 200], "{format:?}: 256 bits");
            assert_eq!(codes(narrow, format, F::Src), 0, "{format:?}: Inf becomes 0");
            assert_eq!(codes(narrow, format, F::Constant), 200, "{format:?}: constants are prepared elsewhere");
            let lacks_alpha = format != TextureFormat::Rgba8Unorm;
            let expected = if lacks_alpha { 200 } else { 0 };
            assert_eq!(codes(narrow, format, F::Src1Alpha), expected, "{format:?}: alpha the target lacks");
        }
    }

    #[test]
    fn the_lean_8_bit_path_is_the_model() {
        Generation::ALL.into_iter().for_each(lean_path_is_the_model);
    }

    fn lean_path_is_the_model(generation: Generation) {
        use crate::state::spelling::{blend_factors, blend_operations};
        let format = ColorFormat::new(TextureFormat::Rgba8Unorm).expect("known");
        let model = Llvmpipe { generation, ..Llvmpipe::default() };
        let mut x = 1_u32;
        let mut codes = || {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            x.to_le_bytes().map(u32::from)
        };
        let output = |codes: Codes| codes.map(|code| crate::model::binary32::narrow(f64::from(code) / 255.0));
        for src_factor in blend_factors() {
            for dst_factor in blend_factors() {
                for operation in blend_operations() {
                    let c = wgpu_types::BlendComponent { src_factor, dst_factor, operation };
                    let state = BlendState { color: c, alpha: c };
                    for _ in 0..64 {
                        let (src, src1, constant, dst) = (codes(), codes(), codes(), codes());
                        let inputs = ColorInputs {
                            format,
                            blend: Some(state),
                            constant: output(constant),
                            src: output(src),
                            src1: output(src1),
                            dst,
                        };
                        let lean = integer::merge_codes8(model.generation, &state, src, src1, constant, dst);
                        assert_eq!(lean, model.merge_color(&inputs), "{state:?} {inputs:?}");
                    }
                }
            }
        }
    }
}
