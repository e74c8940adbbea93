//! Normalised targets: integer arithmetic on 8- or 16-bit codes. The source becomes a code before blending.

use wgpu_types::{BlendFactor, BlendOperation, BlendState};

use super::generation::{Interpolation, Product, Rules};
use super::state::{channel_count, complementary, is_inverted, rewrite};
use super::steps::{Equation, Steps};
use super::{Generation, VectorWidth};
use crate::format::{ChannelKind, Codes};
use crate::merger::blend::component;
use crate::model::ColorInputs;

/// Integer arithmetic of one width in one generation.
#[derive(Clone, Copy)]
struct Width {
    bits: u32,
    product: Product,
    interpolation: Interpolation,
}

impl Width {
    fn new(bits: u32, rules: &Rules) -> Self {
        Self { bits, product: rules.product, interpolation: rules.interpolation }
    }

    fn one(self) -> u32 {
        (1 << self.bits) - 1
    }

    fn multiply(self, a: u32, b: u32) -> u32 {
        let (n, half, t) = (self.bits, 1 << (self.bits - 1), a * b);
        match self.product {
            Product::Near => (t + (t >> n) + half) >> n,
            Product::Nearest => {
                let u = t + half;
                (u + (u >> n)) >> n
            }
        }
    }

    fn saturating_add(self, a: u32, b: u32) -> u32 {
        (a + b).min(self.one())
    }

    /// The operation on the two terms, or on the raw codes for min and max.
    fn combine(
        self,
        operation: BlendOperation,
        src: u32,
        dst: u32,
        src_term: impl Fn() -> u32,
        dst_term: impl Fn() -> u32,
    ) -> u32 {
        match operation {
            BlendOperation::Add => self.saturating_add(src_term(), dst_term()),
            BlendOperation::Subtract => src_term().saturating_sub(dst_term()),
            BlendOperation::ReverseSubtract => dst_term().saturating_sub(src_term()),
            BlendOperation::Min => src.min(dst),
            BlendOperation::Max => src.max(dst),
        }
    }

    /// v0 + x (v1 - v0), as the driver interpolates single-channel targets, modulo 2^n.
    fn lerp(self, x: u32, v0: u32, v1: u32) -> u32 {
        let x = i64::from(x + (x >> (self.bits - 1)));
        let delta = i64::from(v1) - i64::from(v0);
        let step = match (self.interpolation, self.bits) {
            (Interpolation::Floor, 8) => (x * delta + 128) >> 8,
            (Interpolation::Floor, bits) => (x * delta) >> bits,
            (Interpolation::NearestEven, bits) => {
                let floor = (x * delta) >> bits;
                let (rest, half) = (x * delta - (floor << bits), 1 << (bits - 1));
                floor + i64::from(rest > half || (rest == half && floor & 1 == 1))
            }
        };
        let wrapped = (i64::from(v0) + step).rem_euclid(1 << self.bits);
        u32::try_from(wrapped).expect("reduced to the width")
    }
}

/// A shader output or constant as an 8-bit code: min(x, 1) * 255 in binary32, to nearest even, clamped; NaN gives 0.
///
/// Without the min of wide vectors, products beyond the 32-bit integers wrap to the lowest one and clamp to 0.
#[must_use]
pub fn quantize8(x: f32, width: VectorWidth) -> u32 {
    let bounded = match width {
        // x86 MINPS: the second operand where they do not compare, and NaN converts to the lowest integer below.
        VectorWidth::Bits256 if x > 1.0 => 1.0,
        _ => x,
    };
    let scaled = (bounded * 255.0).round_ties_even();
    if scaled.is_nan() || scaled >= 2_147_483_648.0 {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^31, clamped right after")]
    let code = scaled as i32;
    code.clamp(0, 255).unsigned_abs()
}

/// A shader output or constant as a 16-bit code: the low mantissa bits of x * 65535/65536 + 128, whose last place is
/// 2^-16; NaN gives 0.
#[must_use]
pub fn quantize16(x: f32) -> u32 {
    let clamped = if x > 0.0 { x.min(1.0) } else { 0.0 };
    (clamped * (65535.0 / 65536.0) + 128.0).to_bits() & 0xffff
}

/// 8-bit four-channel targets, codes in and codes out: the arithmetic of `merge8` without the record of its steps, for
/// sweeps over every code.
#[must_use]
pub fn merge_codes8(
    generation: Generation,
    state: &BlendState,
    src: Codes,
    src1: Codes,
    constant: Codes,
    dst: Codes,
) -> Codes {
    let operands = Operands { src, src1, constant, dst };
    let width = Width::new(8, generation.rules());
    std::array::from_fn(|i| {
        let c = component(state, i);
        let term = |x, factor| width.multiply(x, operands.factor(width, factor, i));
        width.combine(c.operation, src[i], dst[i], || term(src[i], c.src_factor), || term(dst[i], c.dst_factor))
    })
}

/// 8-bit unorm targets.
pub(super) fn merge8(inputs: &ColorInputs, vector_width: VectorWidth, rules: &Rules) -> Steps {
    // An alpha that the target lacks is taken in on its own, bounded at every width.
    let lacks_alpha = inputs.format.channels()[3] == ChannelKind::Absent;
    let width = |i: usize| if i == 3 && lacks_alpha { VectorWidth::Bits256 } else { vector_width };
    let quantize = |color: [f32; 4]| std::array::from_fn(|i| quantize8(color[i], width(i)));
    // Constants are prepared outside the vectorised shader and always bounded.
    let constant = inputs.constant.map(|x| quantize8(x, VectorWidth::Bits256));
    let operands = Operands { src: quantize(inputs.src), src1: quantize(inputs.src1), constant, dst: inputs.dst };
    merge(Width::new(8, rules), inputs, &operands, |_, code| code)
}

/// 16-bit unorm and 10-10-10-2 targets, the latter widened to 16 bits and truncated again.
pub(super) fn merge16(inputs: &ColorInputs, rules: &Rules) -> Steps {
    let channels = inputs.format.channels();
    let operands = Operands {
        src: inputs.src.map(quantize16),
        src1: inputs.src1.map(quantize16),
        constant: inputs.constant.map(quantize16),
        dst: std::array::from_fn(|i| match channels[i] {
            ChannelKind::Unorm(10) => inputs.dst[i] << 6 | inputs.dst[i] >> 4,
            ChannelKind::Unorm(2) => inputs.dst[i] * 0x5555,
            _ => inputs.dst[i],
        }),
    };
    merge(Width::new(16, rules), inputs, &operands, |i, code| narrow16(channels[i].bits(), code))
}

/// A 16-bit code as the driver stores it in a channel of 16, 10 or 2 bits.
pub(super) fn narrow16(bits: u32, code: u32) -> u32 {
    match bits {
        10 => code >> 6,
        2 => ((code >> 2) * 3 + 8192) >> 14,
        _ => code,
    }
}

/// What the equation reads, as codes of the width.
struct Operands {
    src: Codes,
    src1: Codes,
    constant: Codes,
    dst: Codes,
}

impl Operands {
    fn factor(&self, width: Width, factor: BlendFactor, i: usize) -> u32 {
        let one = width.one();
        match factor {
            BlendFactor::Zero => 0,
            BlendFactor::One => one,
            BlendFactor::Src => self.src[i],
            BlendFactor::OneMinusSrc => one - self.src[i],
            BlendFactor::SrcAlpha => self.src[3],
            BlendFactor::OneMinusSrcAlpha => one - self.src[3],
            BlendFactor::Dst => self.dst[i],
            BlendFactor::OneMinusDst => one - self.dst[i],
            BlendFactor::DstAlpha => self.dst[3],
            BlendFactor::OneMinusDstAlpha => one - self.dst[3],
            BlendFactor::SrcAlphaSaturated if i == 3 => one,
            BlendFactor::SrcAlphaSaturated => self.src[3].min(one - self.dst[3]),
            BlendFactor::Constant => self.constant[i],
            BlendFactor::OneMinusConstant => one - self.constant[i],
            BlendFactor::Src1 => self.src1[i],
            BlendFactor::OneMinusSrc1 => one - self.src1[i],
            BlendFactor::Src1Alpha => self.src1[3],
            BlendFactor::OneMinusSrc1Alpha => one - self.src1[3],
        }
    }
}

/// The equation over codes of one width; `store` narrows a channel's result to the target's code.
fn merge(width: Width, inputs: &ColorInputs, operands: &Operands, store: impl Fn(usize, u32) -> u32) -> Steps {
    let count = channel_count(inputs.format);
    let channels = inputs.format.channels();
    let mut equation = [None; 4];
    let mut result = operands.src;
    if let Some(state) = inputs.blend.map(|state| rewrite(state, inputs.format)) {
        for i in (0..4).filter(|&i| channels[i] != ChannelKind::Absent) {
            let c = component(&state, i);
            let (src, dst) = (operands.src[i], operands.dst[i]);
            let src_factor = operands.factor(width, c.src_factor, i);
            let dst_factor = operands.factor(width, c.dst_factor, i);
            let fused = count == 1 && c.operation == BlendOperation::Add && complementary(c.src_factor, c.dst_factor);
            let rule;
            let mut terms = None;
            (result[i], rule) = if fused {
                if is_inverted(c.src_factor) {
                    (width.lerp(dst_factor, src, dst), "S + Fd (D - S), interpolated")
                } else {
                    (width.lerp(src_factor, dst, src), "D + Fs (S - D), interpolated")
                }
            } else {
                let (s, d) = (width.multiply(src, src_factor), width.multiply(dst, dst_factor));
                if !matches!(c.operation, BlendOperation::Min | BlendOperation::Max) {
                    terms = Some((f64::from(s), f64::from(d)));
                }
                let rule = match c.operation {
                    BlendOperation::Add => "S Fs + D Fd, each product rounded, saturating",
                    BlendOperation::Subtract => "S Fs - D Fd, each product rounded, saturating",
                    BlendOperation::ReverseSubtract => "D Fd - S Fs, each product rounded, saturating",
                    BlendOperation::Min => "min(S, D)",
                    BlendOperation::Max => "max(S, D)",
                };
                (width.combine(c.operation, src, dst, || s, || d), rule)
            };
            equation[i] =
                Some(Equation { src_factor: f64::from(src_factor), dst_factor: f64::from(dst_factor), terms, rule });
        }
    }
    Steps {
        steps: Some(width.one()),
        rule: if width.bits == 8 { "an 8-bit code" } else { "a 16-bit code" },
        src: operands.src.map(f64::from),
        dst: operands.dst.map(f64::from),
        equation,
        result: result.map(f64::from),
        codes: std::array::from_fn(|i| if channels[i] == ChannelKind::Absent { 0 } else { store(i, result[i]) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widths() -> impl Iterator<Item = Width> {
        Generation::ALL.into_iter().flat_map(|generation| [8, 16].map(|bits| Width::new(bits, generation.rules())))
    }

    #[test]
    fn one_is_the_identity_of_every_multiply() {
        for width in widths() {
            for a in (0..=width.one()).step_by(if width.bits == 8 { 1 } else { 7 }) {
                assert_eq!(width.multiply(a, width.one()), a, "{a} at {} bits", width.bits);
                assert_eq!(width.multiply(a, 0), 0, "{a} at {} bits", width.bits);
            }
        }
    }

    /// a b / (2^n - 1) to the nearest; there are no ties, for the divisor is odd.
    fn nearest(width: Width, a: u32, b: u32) -> u32 {
        let (t, one) = (u64::from(a) * u64::from(b), u64::from(width.one()));
        u32::try_from((2 * t + one) / (2 * one)).expect("a code")
    }

    #[test]
    fn the_newest_products_are_the_nearest_codes_and_older_ones_miss_24_of_65536() {
        let wrong = |generation: Generation| {
            let width = Width::new(8, generation.rules());
            let pairs = (0..=255).flat_map(|a| (0..=255).map(move |b| (a, b)));
            pairs.filter(|(a, b)| width.multiply(*a, *b) != nearest(width, *a, *b)).count()
        };
        assert_eq!(Generation::ALL.map(wrong), [24, 24, 0]);
    }

    #[test]
    fn products_of_16_bits_near_a_tie_tell_generations_apart() {
        let [old, _, new] = Generation::ALL.map(|generation| Width::new(16, generation.rules()));
        let mut apart = 0;
        // They differ only where the product's top bit is set, just above a tie.
        for a in old.one() - 32..=old.one() {
            for b in 0..=old.one() {
                assert_eq!(new.multiply(a, b), nearest(new, a, b), "{a} {b}");
                apart += u32::from(old.multiply(a, b) != new.multiply(a, b));
            }
        }
        assert!(apart > 0, "some pair differs");
    }

    /// By rational arithmetic: the newest generation rounds X delta / 2^n to the nearest, ties to even.
    #[test]
    fn interpolation_rounds_ties_to_even_in_the_newest_generation_and_down_in_older_ones() {
        let [old, _, new] = Generation::ALL.map(|generation| Width::new(8, generation.rules()));
        // X = 128 + (128 >> 7) = 129; 129 * 64 / 256 = 32.25, 129 * 128 / 256 = 64.5.
        assert_eq!([old, new].map(|width| width.lerp(128, 0, 64)), [32, 32], "no tie");
        assert_eq!([old, new].map(|width| width.lerp(128, 0, 128)), [65, 64], "half up, half to even");
        assert_eq!([old, new].map(|width| width.lerp(128, 128, 0)), [64, 64], "-64.5");
        let [old, _, new] = Generation::ALL.map(|generation| Width::new(16, generation.rules()));
        // X = 40000 + 1; 40001 * 3 / 65536 = 1.83.
        assert_eq!([old, new].map(|width| width.lerp(40_000, 0, 3)), [1, 2], "down, to the nearest");
    }

    #[test]
    fn sources_clamp_and_nan_is_zero() {
        let wide = |x| quantize8(x, VectorWidth::Bits256);
        assert_eq!([f32::NAN, f32::NEG_INFINITY, -1.0, 0.0].map(wide), [0; 4], "low end");
        assert_eq!([1.0, 2.0, 1e30, f32::INFINITY].map(wide), [255; 4], "high end");
        assert_eq!(quantize8(f32::INFINITY, VectorWidth::Bits128), 0, "narrow vectors lack the min");
        assert_eq!(quantize8(2.0, VectorWidth::Bits128), 255, "and clamp what fits an integer");
        assert_eq!([f32::NAN, -1.0, 0.0, 1.0, 2.0].map(quantize16), [0, 0, 0, 65535, 65535], "16 bits");
    }

    #[test]
    fn codes_survive_quantising() {
        for code in 0..=255_u16 {
            assert_eq!(quantize8(f32::from(code) / 255.0, VectorWidth::Bits256), u32::from(code), "code {code}");
        }
        for code in 0..=u16::MAX {
            assert_eq!(quantize16(f32::from(code) / 65535.0), u32::from(code), "code {code}");
        }
    }
}
