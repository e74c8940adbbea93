//! 8-bit unorm targets with four channels, sources that are any numbers, in planes: `exact` and `f32`.
//!
//! The equation runs on [`LANES`] texels at a time, channel by channel, in binary64 for `exact` and in binary32 for `f32`;
//! the loops have no branches and are left to the compiler's vectors.
//!
//! `f32` performs the model's own operations. `exact`: sources and constants are in [0, 1] and exact, a decoded code is off
//! by at most 2^-52, and so is each of the at most six operations on numbers up to 2. That is less than 2^-48 in all, and
//! less than [`DOUBT`] in codes. A sum that near to the middle between two codes is decided by the model's equation in
//! binary64 operations that are seen to be exact ([`held`](super::held)), or else by the reference.

use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState, ColorTargetState, TextureFormat};

use super::held::Held;
use super::{ordered, write_mask};
use crate::format::{Codes, ColorFormat};
use crate::kernel::simd::{self, Isa, Simd};
use crate::kernel::{FloatRule, TEXEL};
use crate::merger::blend::clamp::clamp_input;
use crate::merger::blend::component;
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel, evaluate};
use crate::state::reads_second_source;

/// Texels at a time.
const LANES: usize = 32;

/// Bound on the error of a sum in binary64, in codes.
const DOUBT: f64 = 1.0 / (1_u64 << 38) as f64;

/// The kernel of one state.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Numbers {
    exact: bool,
    format: ColorFormat,
    swap: bool,
    blend: Option<BlendState>,
    /// In [0, 1].
    constant: [f32; 4],
    /// All ones for the bytes that are written.
    write_mask: u32,
}

/// A span's numbers, one plane a channel, all of one length.
pub(in crate::kernel) type Planes<'a> = [&'a [f32]; 4];

/// The slices of a row.
struct Row<'a> {
    src: Planes<'a>,
    src1: Option<Planes<'a>>,
    keep: Option<&'a [u8]>,
    dst: &'a mut [u8],
}

impl Numbers {
    /// `None` for other formats and models.
    pub(in crate::kernel) fn new(target: &ColorTargetState, constant: [f32; 4], rule: FloatRule) -> Option<Self> {
        let swap = match target.format {
            TextureFormat::Rgba8Unorm => false,
            TextureFormat::Bgra8Unorm => true,
            _ => return None,
        };
        let format = ColorFormat::new(target.format).ok()?;
        Some(Self {
            exact: match rule {
                FloatRule::Exact => true,
                FloatRule::Binary32 => false,
                FloatRule::Llvmpipe(_) => return None,
            },
            format,
            swap,
            blend: target.blend,
            constant: constant.map(|x| clamp_input(x, format.class())),
            write_mask: u32::from_le_bytes(write_mask(target.write_mask, swap)),
        })
    }

    /// Whether the second source is read.
    pub(in crate::kernel) fn reads_second_source(&self) -> bool {
        self.blend.as_ref().is_some_and(reads_second_source)
    }

    /// Merges a row. `keep`, one byte a texel, is not 0 where the fragment is merged.
    pub(in crate::kernel) fn merge(
        &self,
        isa: Isa,
        src: Planes<'_>,
        src1: Option<Planes<'_>>,
        keep: Option<&[u8]>,
        dst: &mut [u8],
    ) {
        simd::run(isa, Task { kernel: self, row: Row { src, src1, keep, dst } });
    }

    #[inline(always)]
    fn row(&self, row: Row<'_>) {
        if self.exact { self.parts::<f64>(row) } else { self.parts::<f32>(row) }
    }

    #[inline(always)]
    fn parts<R: Real>(&self, row: Row<'_>) {
        let Row { src, src1, keep, dst } = row;
        for (part, dst) in dst.chunks_mut(LANES * TEXEL).enumerate() {
            let first = part * LANES;
            let texels = dst.len() / TEXEL;
            let mut before = [0_u32; LANES];
            for (bits, texel) in before.iter_mut().zip(dst.chunks_exact(TEXEL)) {
                *bits = u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]);
            }
            let mut operands = Operands {
                src: [[R::ZERO; LANES]; 4],
                src1: [[R::ZERO; LANES]; 4],
                dst: [[R::ZERO; LANES]; 4],
                constant: self.constant.map(R::of),
            };
            for channel in 0..4 {
                load(&src[channel][first..first + texels], &mut operands.src[channel]);
                if let Some(src1) = src1 {
                    load(&src1[channel][first..first + texels], &mut operands.src1[channel]);
                }
                decode(&before, self.shift(channel), &mut operands.dst[channel]);
            }
            let mut merged = [0_u32; LANES];
            let mut doubt = [0.0; LANES];
            for channel in 0..4 {
                let sum = operands.channel(self.blend.as_ref(), channel);
                encode(&sum, self.shift(channel), &mut merged, &mut doubt);
            }
            let mut written = [self.write_mask; LANES];
            if let Some(keep) = keep {
                for (mask, keep) in written.iter_mut().zip(&keep[first..first + texels]) {
                    *mask = if *keep == 0 { 0 } else { *mask };
                }
            }
            if R::DOUBTS && doubt.iter().any(|x| *x > 0.5 - DOUBT) {
                for i in (0..texels).filter(|i| doubt[*i] > 0.5 - DOUBT && written[*i] != 0) {
                    let color = |planes: Planes<'_>| planes.map(|plane| plane[first + i]);
                    merged[i] = self.decide(color(src), src1.map_or([0.0; 4], color), before[i]);
                }
            }
            for i in 0..LANES {
                merged[i] = merged[i] & written[i] | before[i] & !written[i];
            }
            for (texel, merged) in dst.chunks_exact_mut(TEXEL).zip(&merged) {
                texel.copy_from_slice(&merged.to_le_bytes());
            }
        }
    }

    /// Where a channel's byte begins.
    #[inline(always)]
    fn shift(&self, channel: usize) -> u32 {
        [[0, 8, 16, 24], [16, 8, 0, 24]][usize::from(self.swap)][channel]
    }

    /// A texel with a channel in doubt.
    #[cold]
    #[inline(never)]
    fn decide(&self, src: [f32; 4], src1: [f32; 4], before: u32) -> u32 {
        let dst: Codes = ordered(before.to_le_bytes(), self.swap).map(u32::from);
        let (format, blend, constant) = (self.format, self.blend, self.constant);
        let inputs = ColorInputs { format, blend, constant, src, src1, dst };
        let held = Held::default();
        let codes = match evaluate(&held, &inputs) {
            codes if !held.in_doubt() => codes,
            _ => Exact::default().merge_color(&inputs),
        };
        codes.into_iter().enumerate().fold(0, |texel, (channel, code)| texel | code << self.shift(channel))
    }
}

struct Task<'a> {
    kernel: &'a Numbers,
    row: Row<'a>,
}

impl simd::Task for Task<'_> {
    /// The plain loop once more, compiled for the vectors' instructions.
    #[inline(always)]
    fn on_vectors<S: Simd>(self, _: S) {
        self.kernel.row(self.row);
    }

    fn plain(self) {
        self.kernel.row(self.row);
    }
}

/// The numbers of an arithmetic.
trait Real:
    Copy + PartialOrd + std::ops::Add<Output = Self> + std::ops::Sub<Output = Self> + std::ops::Mul<Output = Self>
{
    const ZERO: Self;
    const ONE: Self;
    /// Whether a sum may be too near to the middle between two codes.
    const DOUBTS: bool;
    fn of(x: f32) -> Self;
    fn unit(code: u32) -> Self;
    /// The nearest code of a number in [0, 1], and how far from it the number is.
    fn code(self) -> (u32, f64);

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const DOUBTS: bool = true;

    #[inline(always)]
    fn of(x: f32) -> Self {
        Self::from(x)
    }

    #[inline(always)]
    fn unit(code: u32) -> Self {
        // Signed integers convert in fewer instructions.
        Self::from(code.cast_signed()) * (1.0 / 255.0)
    }

    #[inline(always)]
    fn code(self) -> (u32, f64) {
        /// Beside it, numbers below 2^51 have no bits behind the point.
        const WHOLE: f64 = 4_503_599_627_370_496.0;
        let codes = self * 255.0;
        let whole = codes + WHOLE;
        (low_half(whole.to_bits()), (codes - (whole - WHOLE)).abs())
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const DOUBTS: bool = false;

    #[inline(always)]
    fn of(x: f32) -> Self {
        x
    }

    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "a code of 8 bits")]
    fn unit(code: u32) -> Self {
        code.cast_signed() as Self / 255.0
    }

    #[inline(always)]
    fn code(self) -> (u32, f64) {
        ((self * 255.0 + 8_388_608.0).to_bits() & 0xff, 0.0)
    }
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "a code is in the low bits")]
fn low_half(bits: u64) -> u32 {
    bits as u32 & 0xff
}

/// Numbers of a plane, clamped to [0, 1], NaN as 0.
#[inline(always)]
fn load<R: Real>(plane: &[f32], numbers: &mut [R; LANES]) {
    const ONE: u32 = 1.0_f32.to_bits();
    const INFINITY: u32 = f32::INFINITY.to_bits();
    for (number, x) in numbers.iter_mut().zip(plane) {
        // Bits of numbers that are not negative are in the numbers' order, and all others are larger. A comparison of the
        // numbers would become ARM's maximum, which gives 1 in the end for a signalling NaN.
        let bits = x.to_bits();
        *number = R::of(f32::from_bits(if bits <= INFINITY { bits.min(ONE) } else { 0 }));
    }
}

#[inline(always)]
fn decode<R: Real>(texels: &[u32; LANES], shift: u32, numbers: &mut [R; LANES]) {
    for (number, texel) in numbers.iter_mut().zip(texels) {
        *number = R::unit(texel >> shift & 0xff);
    }
}

/// Codes into their byte of the texels, and the larger of the channels' doubts.
#[inline(always)]
fn encode<R: Real>(sum: &[R; LANES], shift: u32, texels: &mut [u32; LANES], doubt: &mut [f64; LANES]) {
    for i in 0..LANES {
        let (code, away) = sum[i].most(R::ZERO).least(R::ONE).code();
        texels[i] |= code << shift;
        if R::DOUBTS {
            doubt[i] = doubt[i].most(away);
        }
    }
}

/// What the equation reads, a plane a channel.
struct Operands<R> {
    src: [[R; LANES]; 4],
    src1: [[R; LANES]; 4],
    dst: [[R; LANES]; 4],
    constant: [R; 4],
}

impl<R: Real> Operands<R> {
    /// The equation's result in one channel, not clamped.
    #[inline(always)]
    fn channel(&self, blend: Option<&BlendState>, channel: usize) -> [R; LANES] {
        let (src, dst) = (&self.src[channel], &self.dst[channel]);
        let Some(blend) = blend else { return *src };
        let equation = component(blend, channel);
        match equation.operation {
            Op::Min => return each(src, dst, R::least),
            Op::Max => return each(src, dst, R::most),
            Op::Add | Op::Subtract | Op::ReverseSubtract => {}
        }
        let s = each(src, &self.factor(equation.src_factor, channel), std::ops::Mul::mul);
        let d = each(dst, &self.factor(equation.dst_factor, channel), std::ops::Mul::mul);
        match equation.operation {
            Op::Subtract => each(&s, &d, std::ops::Sub::sub),
            Op::ReverseSubtract => each(&d, &s, std::ops::Sub::sub),
            _ => each(&s, &d, std::ops::Add::add),
        }
    }

    #[inline(always)]
    fn factor(&self, factor: F, channel: usize) -> [R; LANES] {
        let ones = &[R::ONE; LANES];
        match factor {
            F::Zero => [R::ZERO; LANES],
            F::One => *ones,
            F::Src => self.src[channel],
            F::OneMinusSrc => each(ones, &self.src[channel], std::ops::Sub::sub),
            F::SrcAlpha => self.src[3],
            F::OneMinusSrcAlpha => each(ones, &self.src[3], std::ops::Sub::sub),
            F::Dst => self.dst[channel],
            F::OneMinusDst => each(ones, &self.dst[channel], std::ops::Sub::sub),
            F::DstAlpha => self.dst[3],
            F::OneMinusDstAlpha => each(ones, &self.dst[3], std::ops::Sub::sub),
            F::SrcAlphaSaturated if channel == 3 => *ones,
            F::SrcAlphaSaturated => each(&self.src[3], &each(ones, &self.dst[3], std::ops::Sub::sub), R::least),
            F::Constant => [self.constant[channel]; LANES],
            F::OneMinusConstant => [R::ONE - self.constant[channel]; LANES],
            F::Src1 => self.src1[channel],
            F::OneMinusSrc1 => each(ones, &self.src1[channel], std::ops::Sub::sub),
            F::Src1Alpha => self.src1[3],
            F::OneMinusSrc1Alpha => each(ones, &self.src1[3], std::ops::Sub::sub),
        }
    }
}

/// An operation on every lane.
#[inline(always)]
fn each<R: Real>(a: &[R; LANES], b: &[R; LANES], operation: impl Fn(R, R) -> R) -> [R; LANES] {
    let mut result = [R::ZERO; LANES];
    for i in 0..LANES {
        result[i] = operation(a[i], b[i]);
    }
    result
}
