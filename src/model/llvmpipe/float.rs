//! Float targets: binary32 arithmetic, x86 minima, and stores that truncate.

use wgpu_types::{BlendFactor, BlendOperation};

use super::generation::{Rules, SmallDenormals, ZeroFactor};
use super::state::{channel_count, complementary, is_inverted, rewrite};
use super::steps::{Equation, Steps};
use crate::format::{ChannelKind, FloatLayout, Rounding};
use crate::merger::blend::component;
use crate::model::ColorInputs;

/// Binary32 operations as the driver compiles them for one family of formats.
///
/// For 32-bit float and sRGB targets denormal operands count as zero and denormal results become zero; for half and
/// 11/10-bit targets that is so in some generations only ([`SmallDenormals`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ops {
    /// Whether denormals are flushed.
    pub flush: bool,
}

impl Ops {
    /// A denormal operand counts as zero of its sign.
    fn operand(self, x: f32) -> f32 {
        if self.flush && x.abs() < f32::MIN_POSITIVE { 0.0_f32.copysign(x) } else { x }
    }

    pub(super) fn add(self, a: f32, b: f32) -> f32 {
        // A sum of normal numbers below 2^-126 is exact, so tininess needs no look at the rounding.
        self.operand(self.operand(a) + self.operand(b))
    }

    pub(super) fn subtract(self, a: f32, b: f32) -> f32 {
        self.add(a, -b)
    }

    pub(super) fn multiply(self, a: f32, b: f32) -> f32 {
        let (a, b) = (self.operand(a), self.operand(b));
        let product = a * b;
        if self.is_tiny(f64::from(a) * f64::from(b)) { 0.0_f32.copysign(product) } else { product }
    }

    /// a * b + c rounded once.
    #[expect(clippy::disallowed_methods, reason = "the driver emits a fused multiply-add here")]
    fn fused_multiply_add(self, a: f32, b: f32, c: f32) -> f32 {
        let (a, b, c) = (self.operand(a), self.operand(b), self.operand(c));
        let sum = a.mul_add(b, c);
        // The product is exact in f64, and a sum near 2^-126 rounds there at 2^-179, far below what decides.
        if self.is_tiny(f64::from(a) * f64::from(b) + f64::from(c)) { 0.0_f32.copysign(sum) } else { sum }
    }

    /// Whether a result is flushed: below 2^-126 after rounding to 24 bits without a lower limit on the exponent. Half an
    /// ulp (of such numbers) under 2^-126 still rounds up to it.
    fn is_tiny(self, exact: f64) -> bool {
        let limit = f64::from(f32::MIN_POSITIVE) * (1.0 - 1.0 / f64::from(1 << 25));
        self.flush && exact.abs() < limit
    }

    /// x86 MINPS: the second operand unless the first is less.
    fn minimum(self, a: f32, b: f32) -> f32 {
        let (a, b) = (self.operand(a), self.operand(b));
        if a < b { a } else { b }
    }

    /// x86 MAXPS: the second operand unless the first is greater.
    fn maximum(self, a: f32, b: f32) -> f32 {
        let (a, b) = (self.operand(a), self.operand(b));
        if a > b { a } else { b }
    }
}

/// What the equation reads.
pub(super) struct Operands {
    pub src: [f32; 4],
    pub src1: [f32; 4],
    pub constant: [f32; 4],
    pub dst: [f32; 4],
}

/// Float targets. `zero_terms` says what becomes of terms whose factor is the constant zero.
pub(super) fn merge(inputs: &ColorInputs, rules: &Rules, zero_terms: ZeroTerms) -> Steps {
    let channels = inputs.format.channels();
    let decode = |i: usize| match channels[i] {
        ChannelKind::Float(layout) => crate::model::binary32::narrow(layout.decode(inputs.dst[i])),
        // Missing alpha reads as 1.
        _ if i == 3 => 1.0,
        _ => 0.0,
    };
    let operands =
        Operands { src: inputs.src, src1: inputs.src1, constant: inputs.constant, dst: std::array::from_fn(decode) };
    let flush =
        channels[0] == ChannelKind::Float(FloatLayout::SINGLE) || rules.small_denormals == SmallDenormals::Flushed;
    let (result, equation) = blend(inputs, &operands, Ops { flush }, zero_terms);
    let codes = std::array::from_fn(|i| match channels[i] {
        ChannelKind::Float(layout) => store(layout, result[i]),
        _ => 0,
    });
    Steps {
        steps: None,
        rule: "binary32, unclamped",
        src: operands.src.map(f64::from),
        dst: operands.dst.map(f64::from),
        equation,
        result: result.map(f64::from),
        codes,
    }
}

/// The bits stored for a result: toward zero in small floats, as they are in 32 bits.
pub(super) fn store(layout: FloatLayout, x: f32) -> u32 {
    if layout == FloatLayout::SINGLE { x.to_bits() } else { layout.encode(f64::from(x), Rounding::TowardZero) }
}

/// What becomes of a term whose factor is the constant zero in every lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ZeroTerms {
    /// It is left out, and 0 NaN with it.
    Dropped,
    /// It is multiplied as others are.
    Multiplied,
}

/// Whether it may depend on the driver's history what becomes of such terms.
pub(super) fn is_undecided(inputs: &ColorInputs, rules: &Rules) -> bool {
    let packed = matches!(inputs.format.channels()[0], ChannelKind::Float(layout) if !layout.signed);
    packed && inputs.blend.is_some() && rules.zero_factor == ZeroFactor::Undecided
}

/// The driver's equation in binary32; with blending off, the source.
pub(super) fn blend(
    inputs: &ColorInputs,
    operands: &Operands,
    ops: Ops,
    zero_terms: ZeroTerms,
) -> ([f32; 4], [Option<Equation>; 4]) {
    let mut result = operands.src;
    let mut equations = [None; 4];
    let Some(state) = inputs.blend.map(|state| rewrite(state, inputs.format)) else {
        return (result, equations);
    };
    let count = channel_count(inputs.format);
    let has_alpha = inputs.format.channels()[3] != ChannelKind::Absent;
    let both = |wanted: BlendFactor, pick: fn(&wgpu_types::BlendComponent) -> BlendFactor| {
        pick(&state.color) == wanted && (!has_alpha || pick(&state.alpha) == wanted)
    };
    // A multiply by a constant is dropped only when every lane of the vector has that constant.
    let term = |pick: fn(&wgpu_types::BlendComponent) -> BlendFactor, x: f32, factor: f32| {
        if zero_terms == ZeroTerms::Dropped && both(BlendFactor::Zero, pick) {
            None
        } else if both(BlendFactor::One, pick) {
            Some(x)
        } else {
            Some(ops.multiply(x, factor))
        }
    };
    let same_factors = state.color.src_factor == state.color.dst_factor
        && (!has_alpha || state.alpha.src_factor == state.alpha.dst_factor);
    for i in 0..count {
        let c = component(&state, i);
        let (src, dst) = (operands.src[i], operands.dst[i]);
        let src_factor = operands.factor(ops, c.src_factor, i);
        let dst_factor = operands.factor(ops, c.dst_factor, i);
        let complementary = count == 1 && complementary(c.src_factor, c.dst_factor);
        let rule;
        let mut terms = None;
        (result[i], rule) = match c.operation {
            BlendOperation::Min => (ops.minimum(src, dst), "S < D ? S : D"),
            BlendOperation::Max => (ops.maximum(src, dst), "S > D ? S : D"),
            operation if complementary => {
                interpolate(ops, operation, is_inverted(c.dst_factor), src, dst, src_factor, dst_factor)
            }
            operation if same_factors => {
                let combined = combine(ops, operation, Some(src), Some(dst));
                (term(|c| c.src_factor, combined, src_factor).unwrap_or(0.0), "(S op D) F")
            }
            operation => {
                let s = term(|c| c.src_factor, src, src_factor);
                let d = term(|c| c.dst_factor, dst, dst_factor);
                terms = Some((f64::from(s.unwrap_or(0.0)), f64::from(d.unwrap_or(0.0))));
                (combine(ops, operation, s, d), "S Fs op D Fd, each operation rounded; terms with factor 0 dropped")
            }
        };
        equations[i] =
            Some(Equation { src_factor: f64::from(src_factor), dst_factor: f64::from(dst_factor), terms, rule });
    }
    (result, equations)
}

/// Add, subtract or reverse-subtract; a dropped term is a zero that costs no operation where it can be left out.
fn combine(ops: Ops, operation: BlendOperation, src: Option<f32>, dst: Option<f32>) -> f32 {
    let (left, right) = if operation == BlendOperation::ReverseSubtract { (dst, src) } else { (src, dst) };
    match (operation, left, right) {
        (_, None, None) => 0.0,
        (_, Some(x), None) | (BlendOperation::Add, None, Some(x)) => x,
        (BlendOperation::Add, Some(x), Some(y)) => ops.add(x, y),
        (_, None, Some(y)) => ops.subtract(0.0, y),
        (_, Some(x), Some(y)) => ops.subtract(x, y),
    }
}

/// Single-channel targets with factors f and 1 - f.
fn interpolate(
    ops: Ops,
    operation: BlendOperation,
    dst_inverted: bool,
    src: f32,
    dst: f32,
    src_factor: f32,
    dst_factor: f32,
) -> (f32, &'static str) {
    let sum = || ops.add(src, dst);
    match (operation, dst_inverted) {
        (BlendOperation::Add, true) => {
            (ops.fused_multiply_add(src_factor, ops.subtract(src, dst), dst), "fma(Fs, S - D, D)")
        }
        (BlendOperation::Add, false) => {
            (ops.fused_multiply_add(dst_factor, ops.subtract(dst, src), src), "fma(Fd, D - S, S)")
        }
        (BlendOperation::Subtract, true) => (ops.subtract(ops.multiply(sum(), src_factor), dst), "(S + D) Fs - D"),
        (BlendOperation::Subtract, false) => (ops.subtract(src, ops.multiply(sum(), dst_factor)), "S - (S + D) Fd"),
        (_, true) => (ops.subtract(dst, ops.multiply(sum(), src_factor)), "D - (S + D) Fs"),
        (_, false) => (ops.subtract(ops.multiply(sum(), dst_factor), src), "(S + D) Fd - S"),
    }
}

impl Operands {
    fn factor(&self, ops: Ops, factor: BlendFactor, i: usize) -> f32 {
        let complement = |x| ops.subtract(1.0, x);
        match factor {
            BlendFactor::Zero => 0.0,
            BlendFactor::One => 1.0,
            BlendFactor::Src => self.src[i],
            BlendFactor::OneMinusSrc => complement(self.src[i]),
            BlendFactor::SrcAlpha => self.src[3],
            BlendFactor::OneMinusSrcAlpha => complement(self.src[3]),
            BlendFactor::Dst => self.dst[i],
            BlendFactor::OneMinusDst => complement(self.dst[i]),
            BlendFactor::DstAlpha => self.dst[3],
            BlendFactor::OneMinusDstAlpha => complement(self.dst[3]),
            BlendFactor::SrcAlphaSaturated if i == 3 => 1.0,
            BlendFactor::SrcAlphaSaturated => ops.minimum(self.src[3], complement(self.dst[3])),
            BlendFactor::Constant => self.constant[i],
            BlendFactor::OneMinusConstant => complement(self.constant[i]),
            BlendFactor::Src1 => self.src1[i],
            BlendFactor::OneMinusSrc1 => complement(self.src1[i]),
            BlendFactor::Src1Alpha => self.src1[3],
            BlendFactor::OneMinusSrc1Alpha => complement(self.src1[3]),
        }
    }
}
