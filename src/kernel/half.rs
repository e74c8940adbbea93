//! Half-float targets with four channels, sources that are halves: over and its kin.
//!
//! Let s, a, d be halves, a not negative. In binary32 s a is exact, for it has 22 bits; so is 1 - a, a multiple of 2^-24 up
//! to 1 for a up to 1 and otherwise a number of 12 bits; d (1 - a) has 36. So `exact`'s sum is rounded once to binary32 by a fused
//! multiply-add, and then to a half. The two roundings go wrong only where the first lands in the middle between two
//! halves and was not exact: there the sum moves to the side where the real one lies, found in binary64, in which both
//! products are exact and the error of their sum is a number (Knuth's two-sum). Nothing underflows: the least product is
//! 2^-48. NaN, infinity and negative alpha go to the reference, as do NaN and infinity in the other models, whose operations are
//! those of binary32.

use half::f16;
use wgpu_types::{ColorTargetState, ColorWrites};

use super::Row;
use super::over::{FloatRule, Over, Reference};
use super::simd::{self, Isa, Simd};
use crate::format::{FloatLayout, Rounding};

/// Bytes of a texel.
pub(super) const TEXEL: usize = 8;

/// RGBA as halves that are these numbers.
pub(super) fn source(rgba: [f32; 4]) -> Option<[u8; TEXEL]> {
    let mut texel = [0; TEXEL];
    for (bytes, x) in texel.chunks_exact_mut(2).zip(rgba) {
        let near = f16::from_f32(x);
        bytes.copy_from_slice(&near.to_le_bytes());
        if near.to_f32().to_bits() != x.to_bits() {
            return None;
        }
    }
    Some(texel)
}

/// The kernel of one state.
#[derive(Clone, Debug)]
pub(super) struct Half {
    rule: FloatRule,
    over: Over,
    write_mask: ColorWrites,
    reference: Reference,
}

impl Half {
    pub(super) fn new(target: &ColorTargetState, rule: FloatRule) -> Option<Self> {
        let blend = target.blend?;
        let reference = Reference::new(rule, target.format, blend)?;
        Some(Self { rule, over: Over::new(&blend)?, write_mask: target.write_mask, reference })
    }

    pub(super) fn merge(&self, isa: Isa, row: Row<'_>) {
        simd::run(isa, Task { kernel: self, row });
    }

    /// One texel by the reference.
    #[cold]
    fn by_reference(&self, src: &[u8], before: &[u8], out: &mut [u8]) {
        let src: [f32; 4] = std::array::from_fn(|i| decode(&src[2 * i..]));
        self.reference.merge_bytes(src, before, out);
    }

    /// Takes back what may not be written. `kept` says whether the texel's fragment is merged.
    #[inline(always)]
    fn mask(&self, kept: bool, before: &[u8], out: &mut [u8]) {
        for i in 0..4 {
            if kept && self.write_mask.contains(ColorWrites::from_bits_truncate(1 << i)) {
                continue;
            }
            let old = u16::from_le_bytes([before[2 * i], before[2 * i + 1]]);
            // This driver rewrites every texel that a fragment covers, and its conversions make NaNs quiet.
            let quiet = matches!(self.rule, FloatRule::Llvmpipe(_)) && old & 0x7fff > 0x7c00;
            out[2 * i..2 * i + 2].copy_from_slice(&if quiet { old | 0x200 } else { old }.to_le_bytes());
        }
    }

    /// Whether a texel's `alpha` channel or its color is multiplied.
    fn pattern<T: Copy>(choice: [bool; 2], yes: T, no: T) -> [T; 4] {
        let [color, alpha] = choice.map(|by| if by { yes } else { no });
        [color, color, color, alpha]
    }

    /// One texel at a time.
    fn texels(&self, row: Row<'_>) {
        let Row { src, keep, dst, .. } = row;
        for (i, (src, dst)) in src.chunks_exact(TEXEL).zip(dst.chunks_exact_mut(TEXEL)).enumerate() {
            let mut out = [0; TEXEL];
            self.texel(src, dst, &mut out);
            self.mask(keep.is_none_or(|keep| keep[i] != 0), dst, &mut out);
            dst.copy_from_slice(&out);
        }
    }

    fn texel(&self, src: &[u8], dst: &[u8], out: &mut [u8]) {
        let alpha = decode(&src[6..]);
        let f = Self::pattern(self.over.src_by_alpha, alpha, 1.0);
        let g = Self::pattern(self.over.dst_by_rest, 1.0 - alpha, 1.0);
        for i in 0..4 {
            let (s, d) = (decode(&src[2 * i..]), decode(&dst[2 * i..]));
            let code = match self.rule {
                FloatRule::Exact => {
                    let rest = Self::pattern(self.over.dst_by_rest, 1.0 - f64::from(alpha), 1.0)[i];
                    let sum = odd_sum(f64::from(s) * f64::from(f[i]), f64::from(d) * rest);
                    FloatLayout::HALF.encode(sum, Rounding::NearestEven)
                }
                FloatRule::Binary32 => FloatLayout::HALF.encode(f64::from(s * f[i] + d * g[i]), Rounding::NearestEven),
                FloatRule::Llvmpipe(_) => {
                    FloatLayout::HALF.encode(f64::from(s * f[i] + d * g[i]), Rounding::TowardZero)
                }
            };
            if code & 0x7fff >= 0x7c00 {
                return self.by_reference(src, dst, out);
            }
            out[2 * i..2 * i + 2].copy_from_slice(&code.to_le_bytes()[..2]);
        }
    }

    /// Mends the sums of a vector that `doubtful` names: `src` and `before` are its halves, `sums` its results.
    #[cold]
    fn mend(&self, doubtful: u32, src: &[u8], before: &[u8], sums: &mut [u8; 64]) {
        let mut left = doubtful;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let (texel, channel) = (lane / 4, lane % 4);
            let sum = f32::from_le_bytes(std::array::from_fn(|i| sums[4 * lane + i]));
            if !sum.is_finite() || !is_between_halves(sum) {
                continue;
            }
            let alpha = decode(&src[texel * TEXEL + 6..]);
            let f = Self::pattern(self.over.src_by_alpha, alpha, 1.0)[channel];
            let g = Self::pattern(self.over.dst_by_rest, 1.0 - f64::from(alpha), 1.0)[channel];
            let p = f64::from(decode(&src[2 * lane..])) * f64::from(f);
            let q = f64::from(decode(&before[2 * lane..])) * g;
            let exact = odd_sum(p, q);
            let mended = match exact.partial_cmp(&f64::from(sum)) {
                Some(std::cmp::Ordering::Greater) => sum.next_up(),
                Some(std::cmp::Ordering::Less) => sum.next_down(),
                _ => sum,
            };
            sums[4 * lane..4 * lane + 4].copy_from_slice(&mended.to_le_bytes());
        }
    }
}

/// p + q rounded to odd: the real sum, or a number of 53 bits whose last one says that it is not. Such a number lies on the
/// same side of every half, and of every middle between halves, as the real sum.
fn odd_sum(p: f64, q: f64) -> f64 {
    let sum = p + q;
    let part = sum - p;
    let error = (p - (sum - part)) + (q - part);
    if error == 0.0 || !sum.is_finite() || sum.to_bits() & 1 == 1 {
        return sum;
    }
    // An even last bit: one step toward the real sum makes it odd.
    if error > 0.0 { sum.next_up() } else { sum.next_down() }
}

/// Whether a finite number lies in the middle between two halves.
fn is_between_halves(x: f32) -> bool {
    let magnitude = x.to_bits() & 0x7fff_ffff;
    if magnitude >= 0x3880_0000 {
        return magnitude & 0x1fff == 0x1000;
    }
    // Subnormal halves are multiples of 2^-24.
    let scaled = x.abs() * 33_554_432.0;
    scaled.fract() == 0.0 && scaled % 2.0 == 1.0
}

/// The half at the start of a slice.
fn decode(bytes: &[u8]) -> f32 {
    f16::from_bits(u16::from_le_bytes([bytes[0], bytes[1]])).to_f32()
}

struct Task<'a> {
    kernel: &'a Half,
    row: Row<'a>,
}

impl simd::Task for Task<'_> {
    #[inline(always)]
    fn on_vectors<S: Simd>(self, simd: S) {
        match self.kernel.rule {
            FloatRule::Exact => Vectors::<S, EXACT>::new(simd, self.kernel).row(self.row),
            FloatRule::Binary32 => Vectors::<S, BINARY32>::new(simd, self.kernel).row(self.row),
            FloatRule::Llvmpipe(_) => Vectors::<S, LLVMPIPE>::new(simd, self.kernel).row(self.row),
        }
    }

    fn plain(self) {
        self.kernel.texels(self.row);
    }
}

const EXACT: u8 = 0;
const BINARY32: u8 = 1;
const LLVMPIPE: u8 = 2;

/// How far ahead rows are asked for, in bytes.
const AHEAD: usize = 2048;

/// A row in vectors of as many texels as fit with 32 bits a channel.
struct Vectors<'a, S: Simd, const RULE: u8> {
    s: S,
    kernel: &'a Half,
    /// All ones where the source is multiplied by alpha; the destination by one minus alpha.
    src_by_alpha: S::V,
    dst_by_rest: S::V,
    one: S::F,
}

impl<'a, S: Simd, const RULE: u8> Vectors<'a, S, RULE> {
    #[inline(always)]
    fn new(s: S, kernel: &'a Half) -> Self {
        let lanes = |choice| {
            let pattern = Half::pattern(choice, u8::MAX, 0);
            s.lanes(std::array::from_fn(|i| pattern[i / 4]))
        };
        let (src_by_alpha, dst_by_rest) = (lanes(kernel.over.src_by_alpha), lanes(kernel.over.dst_by_rest));
        Self { s, kernel, src_by_alpha, dst_by_rest, one: s.splat_f32(1.0) }
    }

    #[inline(always)]
    fn row(&self, row: Row<'_>) {
        let Row { src, src1: _, keep, dst } = row;
        let bytes = S::BYTES / 2;
        let whole = dst.len() - dst.len() % bytes;
        let (dst, rest) = dst.split_at_mut(whole);
        let s = self.s;
        if self.kernel.write_mask == ColorWrites::ALL && keep.is_none() {
            for (src, dst) in src.chunks_exact(bytes).zip(dst.chunks_exact_mut(bytes)) {
                s.prefetch(src.as_ptr().wrapping_add(AHEAD));
                s.prefetch(dst.as_ptr().wrapping_add(AHEAD));
                self.step(src, dst);
            }
        } else {
            let texels = bytes / TEXEL;
            for (i, (src, dst)) in src.chunks_exact(bytes).zip(dst.chunks_exact_mut(bytes)).enumerate() {
                let mut merged = [0; 32];
                merged[..bytes].copy_from_slice(dst);
                self.step(src, &mut merged[..bytes]);
                for t in 0..texels {
                    let (at, kept) = (t * TEXEL, keep.is_none_or(|keep| keep[i * texels + t] != 0));
                    self.kernel.mask(kept, &dst[at..at + TEXEL], &mut merged[at..at + TEXEL]);
                }
                dst.copy_from_slice(&merged[..bytes]);
            }
        }
        let keep = keep.map(|keep| &keep[whole / TEXEL..]);
        self.kernel.texels(Row { src: &src[whole..], src1: None, keep, dst: rest });
    }

    /// One vector.
    #[inline(always)]
    fn step(&self, src_bytes: &[u8], dst_bytes: &mut [u8]) {
        let s = self.s;
        let (src, dst) = (s.load_f16(src_bytes), s.load_f16(dst_bytes));
        let alpha = s.alpha_f32(src);
        let rest = s.subtract_f32(self.one, alpha);
        let f = self.pick(self.src_by_alpha, alpha);
        let g = self.pick(self.dst_by_rest, rest);
        let p = s.multiply_f32(src, f);
        let sum = if RULE == EXACT { s.multiply_add_f32(dst, g, p) } else { s.add_f32(p, s.multiply_f32(dst, g)) };
        // One test for all that is rare: the sign is alpha's, so that what is not from 2^-14 to the largest binary32, or
        // has a negative alpha, is out of one range.
        let bits = if RULE == EXACT {
            s.select(s.splat_u32(SIGN), s.bits_f32(alpha), s.bits_f32(sum))
        } else {
            s.and(s.bits_f32(sum), s.splat_u32(!SIGN))
        };
        let (low, above) = if RULE == EXACT { (SMALL, INFINITE - SMALL) } else { (0, INFINITE) };
        let out = s.greater32(
            s.add32(bits, s.splat_u32(SIGN.wrapping_sub(low))),
            s.splat_u32(SIGN.wrapping_add(above).wrapping_sub(1)),
        );
        let middle = if RULE == EXACT { s.equal32(s.and(bits, s.splat_u32(0x1fff)), s.splat_u32(0x1000)) } else { 0 };
        if out | middle != 0 {
            return self.doubtful(middle, alpha, src_bytes, dst_bytes, sum);
        }
        self.store(dst_bytes, sum);
    }

    #[inline(always)]
    fn pick(&self, mask: S::V, x: S::F) -> S::F {
        let s = self.s;
        s.as_f32(s.select(mask, s.bits_f32(x), s.bits_f32(self.one)))
    }

    #[inline(always)]
    fn store(&self, bytes: &mut [u8], sum: S::F) {
        if RULE == LLVMPIPE { self.s.store_f16_truncated(bytes, sum) } else { self.s.store_f16(bytes, sum) }
    }

    /// A vector with sums between halves, subnormal halves, zeros, a negative alpha, or what is not finite.
    #[inline(always)]
    fn doubtful(&self, middle: u32, alpha: S::F, src: &[u8], dst: &mut [u8], sum: S::F) {
        let s = self.s;
        let magnitude = s.and(s.bits_f32(sum), s.splat_u32(!SIGN));
        let mut by_reference = s.greater32(magnitude, s.splat_u32(INFINITE - 1));
        let mut mend = 0;
        if RULE == EXACT {
            by_reference |= s.greater32(s.splat_u32(0), s.bits_f32(alpha));
            // Zero is small and in no doubt.
            let small = s.greater32(s.splat_u32(SMALL), magnitude) & s.greater32(magnitude, s.splat_u32(0));
            mend = middle | small;
        }
        if mend | by_reference == 0 {
            return self.store(dst, sum);
        }
        let mut before = [0; 32];
        before[..dst.len()].copy_from_slice(dst);
        let mut sums = [0; 64];
        s.store(&mut sums, s.bits_f32(sum));
        if mend != 0 {
            self.kernel.mend(mend, src, &before, &mut sums);
        }
        self.store(dst, s.as_f32(s.load(&sums)));
        for texel in 0..dst.len() / TEXEL {
            if by_reference >> (4 * texel) & 15 != 0 {
                let at = texel * TEXEL..(texel + 1) * TEXEL;
                self.kernel.by_reference(&src[at.clone()], &before[at.clone()], &mut dst[at]);
            }
        }
    }
}

/// Bits of binary32: the sign, 2^-14 (the least normal half), infinity.
const SIGN: u32 = 1 << 31;
const SMALL: u32 = 0x3880_0000;
const INFINITE: u32 = 0x7f80_0000;
