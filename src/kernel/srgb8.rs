//! 8-bit sRGB targets, sources that are linear 8-bit codes: over and its kin.
//!
//! A code is decoded by a table of 256 numbers. A number is encoded by a table over the top 16 of its 32 bits: between two
//! such prefixes, from 2^-13 to 1, there is one threshold of the curve at most, and an entry holds the code at the start of
//! its bucket above 2^16 less the threshold's low 16 bits. Adding the number's own low bits carries into the code exactly
//! if they reach the threshold. So `f32` is right for every binary32 number.
//!
//! `exact`'s sum is computed in binary32, to [`MARGIN`] units in the last place: each of its operands, products and sums is
//! off by a relative 2^-24, six of them add up at most, and a unit is at least a relative 2^-24. A sum that near to a
//! threshold, or to the end of a bucket, goes to the reference.

use std::sync::LazyLock;

use wgpu_types::{ColorTargetState, TextureFormat};

use super::over::{FloatRule, Over, Reference};
use super::simd::{self, Isa, Simd};
use super::unorm8::{self, Rule, ordered};
use super::{Row, TEXEL};
use crate::format::{ColorFormat, srgb};
use crate::model::llvmpipe::rsqrt::STEPS;
use crate::model::llvmpipe::{self, Estimate};

/// How far `exact`'s sum in binary32 is from the real one at most, in units in the last place.
const MARGIN: u32 = 8;

/// Numbers that are encoded stay between these: a code of 0, and one of 255, both far from the end of a bucket.
const LEAST: u32 = 0x3900_4000;
const MOST: u32 = 0x3f7f_8000;

/// The curve, both ways.
struct Tables {
    /// Linear values as bits of binary32.
    decode: [u32; 256],
    /// Entries by the top 16 bits of a number, modulo 2048.
    encode: [u32; 2048],
    /// llvmpipe's linear values.
    llvmpipe: [u32; 256],
}

impl Tables {
    /// The code of a number, in units of 2^-16.
    #[inline(always)]
    fn code(&self, x: f32) -> u32 {
        let bits = x.clamp(f32::from_bits(LEAST), f32::from_bits(MOST)).to_bits();
        self.encode[(bits >> 16) as usize % 2048] + (bits & 0xffff)
    }
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let code = |i: usize| u32::try_from(i).expect("a code");
    let mut encode = [0; 2048];
    // What the last number below a prefix encodes to, and the first number of the next code.
    let mut reached = 0;
    let mut next = first_above(srgb::threshold(0).value);
    for prefix in LEAST >> 16..=MOST >> 16 {
        let mut entry = reached << 16;
        if next >> 16 == prefix {
            entry += 0x1_0000 - (next & 0xffff);
            reached += 1;
            next = if reached < 255 { first_above(srgb::threshold(reached).value) } else { u32::MAX };
        }
        encode[prefix as usize % 2048] = entry;
    }
    Tables {
        decode: std::array::from_fn(|i| srgb::decode_f32(code(i)).to_bits()),
        encode,
        llvmpipe: std::array::from_fn(|i| llvmpipe::srgb::decode(code(i)).to_bits()),
    }
});

/// Mantissas of a processor's reciprocal square roots, by the exponent's last bit and the mantissa's first twelve.
type Roots = [u32; STEPS];

/// The table of an estimate, made once.
fn roots(estimate: Estimate) -> &'static Roots {
    static HOST: LazyLock<Roots> = LazyLock::new(|| table_of(Estimate::host()));
    static INTEL_XEON: LazyLock<Roots> = LazyLock::new(|| table_of(Some(Estimate::IntelXeon)));
    static AMD_ZEN5: LazyLock<Roots> = LazyLock::new(|| table_of(Some(Estimate::AmdZen5)));
    match estimate {
        Estimate::IntelXeon => &INTEL_XEON,
        Estimate::AmdZen5 => &AMD_ZEN5,
        #[cfg(target_arch = "x86_64")]
        Estimate::Host => &HOST,
    }
}

fn table_of(estimate: Option<Estimate>) -> Roots {
    let table = estimate.unwrap_or_default().table();
    // The table begins at 1, whose biased exponent is odd; an index's first bit is the exponent's last.
    std::array::from_fn(|i| u32::from(table[i ^ (STEPS / 2)]) << 11)
}

/// The bits of the first binary32 number above a threshold, which is none itself.
fn first_above(threshold: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let near = threshold as f32;
    if f64::from(near) > threshold { near.to_bits() } else { near.next_up().to_bits() }
}

/// The kernel of one state.
#[derive(Clone, Debug)]
pub(super) struct Srgb8 {
    rule: FloatRule,
    over: Over,
    /// The target's bytes are in BGRA order.
    pub(super) swap: bool,
    /// 255 for the bytes that are written.
    write_mask: [u8; TEXEL],
    reference: Reference,
    format: ColorFormat,
}

impl Srgb8 {
    pub(super) fn new(target: &ColorTargetState, rule: FloatRule) -> Option<Self> {
        let blend = target.blend?;
        let swap = target.format == TextureFormat::Bgra8UnormSrgb;
        Some(Self {
            rule,
            over: Over::new(&blend)?,
            swap,
            write_mask: unorm8::write_mask(target.write_mask, swap),
            reference: Reference::new(rule, target.format, blend)?,
            format: ColorFormat::new(target.format).ok()?,
        })
    }

    /// RGBA as codes in the target's byte order.
    pub(super) fn source(&self, rgba: [f32; 4]) -> Option<[u8; TEXEL]> {
        let [r, g, b, a] = rgba.map(|x| Rule::Exact.code(x).filter(|code| unit(*code) == x));
        Some(ordered([r?, g?, b?, a?], self.swap))
    }

    pub(super) fn merge(&self, isa: Isa, row: Row<'_>) {
        simd::run(isa, Task { kernel: self, row });
    }

    /// One texel in binary64, and where that is in doubt as well, by the reference.
    #[cold]
    fn by_reference(&self, src: [u8; TEXEL], dst: [u8; TEXEL]) -> [u8; TEXEL] {
        let tables = &*TABLES;
        let mut out = [0; TEXEL];
        let alpha = f64::from(unit(src[3]));
        let f = if self.over.src_by_alpha[0] { alpha } else { 1.0 };
        let g = if self.over.dst_by_rest[0] { 1.0 - alpha } else { 1.0 };
        let color = |i: usize| {
            let sum = f64::from(unit(src[i])) * f + srgb::decode(u32::from(dst[i])).value * g;
            // The code of its binary32 neighbour, or one beside that. Four roundings of numbers up to 2 are below 2^-50.
            #[expect(clippy::cast_possible_truncation, reason = "only a first guess")]
            let guess = tables.code(sum as f32) >> 16;
            let below = |code: u32| srgb::threshold(code).value - sum;
            if guess > 0 && below(guess - 1) > -1e-12 {
                (below(guess - 1) > 1e-12).then_some(guess - 1)
            } else if guess < 255 && below(guess) < 1e-12 {
                (below(guess) < -1e-12).then_some(guess + 1)
            } else {
                Some(guess)
            }
        };
        if let (Some(r), Some(g), Some(b)) = (color(0), color(1), color(2)) {
            let codes = [r, g, b, u32::from(self.alpha(src[3], dst[3]))];
            return codes.map(|code| u8::try_from(code).expect("8-bit codes"));
        }
        self.reference.merge_bytes(ordered(src, self.swap).map(unit), &dst, &mut out);
        out
    }

    /// One texel at a time.
    #[inline(always)]
    fn texels(&self, row: Row<'_>) {
        let Row { src, keep, dst, .. } = row;
        let tables = &*TABLES;
        for (i, (src, dst)) in src.as_chunks::<TEXEL>().0.iter().zip(dst.as_chunks_mut::<TEXEL>().0).enumerate() {
            let kept = keep.is_none_or(|keep| keep[i] != 0);
            let out = self.texel(tables, *src, *dst);
            for c in 0..TEXEL {
                dst[c] = if kept && self.write_mask[c] != 0 { out[c] } else { dst[c] };
            }
        }
    }

    #[inline(always)]
    fn texel(&self, tables: &Tables, src: [u8; TEXEL], dst: [u8; TEXEL]) -> [u8; TEXEL] {
        let alpha = unit(src[3]);
        let factors = |i: usize| {
            let f = if self.over.src_by_alpha[i] { alpha } else { 1.0 };
            let g = if self.over.dst_by_rest[i] { 1.0 - alpha } else { 1.0 };
            (f, g)
        };
        let (f, g) = factors(0);
        let (f_alpha, g_alpha) = factors(1);
        if let FloatRule::Llvmpipe(model) = self.rule {
            let color = |i: usize| unit(src[i]) * f + f32::from_bits(tables.llvmpipe[usize::from(dst[i])]) * g;
            let result = [color(0), color(1), color(2), alpha * f_alpha + f32::from(dst[3]) * (1.0 / 255.0) * g_alpha];
            // Red and blue are encoded alike, so their order does not matter.
            let codes = model.store(self.format, result);
            return codes.map(|code| u8::try_from(code).expect("8-bit codes"));
        }
        let mut out = [0; TEXEL];
        for i in 0..3 {
            let sum = unit(src[i]) * f + f32::from_bits(tables.decode[usize::from(dst[i])]) * g;
            let carried = tables.code(sum);
            if self.rule == FloatRule::Exact && (carried + MARGIN) & 0xffff < 2 * MARGIN {
                return self.by_reference(src, dst);
            }
            out[i] = carried.to_le_bytes()[2];
        }
        out[3] = self.alpha(src[3], dst[3]);
        out
    }

    /// The alpha channel, which is linear, to the nearest code.
    #[inline(always)]
    fn alpha(&self, src: u8, dst: u8) -> u8 {
        let (s, d) = (u32::from(src), u32::from(dst));
        let f = if self.over.src_by_alpha[1] { s } else { 255 };
        let g = if self.over.dst_by_rest[1] { 255 - s } else { 255 };
        let sum = (s * f + d * g).min(255 * 255) + 128;
        (sum + (sum >> 8)).to_le_bytes()[1]
    }
}

/// A code as the shader's output.
#[inline(always)]
fn unit(code: u8) -> f32 {
    f32::from(code) / 255.0
}

struct Task<'a> {
    kernel: &'a Srgb8,
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
const AHEAD: usize = 1024;

/// A row in vectors of a texel a 32-bit element.
struct Vectors<'a, S: Simd, const RULE: u8> {
    s: S,
    kernel: &'a Srgb8,
    tables: &'static Tables,
    /// Of the driver's processor.
    roots: &'static Roots,
    one: S::F,
    per_code: S::F,
    codes: S::F,
    low_byte: S::V,
    low_half: S::V,
    least: S::F,
    most: S::F,
}

/// A vector's codes before they are bytes, and which texels are in doubt.
struct Channel<V> {
    carried: V,
    doubt: u32,
}

impl<'a, S: Simd, const RULE: u8> Vectors<'a, S, RULE> {
    #[inline(always)]
    fn new(s: S, kernel: &'a Srgb8) -> Self {
        Self {
            s,
            kernel,
            tables: &TABLES,
            roots: roots(if let FloatRule::Llvmpipe(model) = kernel.rule {
                model.estimate
            } else {
                Estimate::default()
            }),
            one: s.splat_f32(1.0),
            per_code: s.splat_f32(1.0 / 255.0),
            codes: s.splat_f32(255.0),
            low_byte: s.splat_u32(0xff),
            low_half: s.splat_u32(0xffff),
            least: s.splat_f32(f32::from_bits(LEAST)),
            most: s.splat_f32(f32::from_bits(MOST)),
        }
    }

    #[inline(always)]
    fn row(&self, row: Row<'_>) {
        let Row { src, src1: _, keep, dst } = row;
        let s = self.s;
        let whole = dst.len() - dst.len() % S::BYTES;
        let (dst, rest) = dst.split_at_mut(whole);
        let mask = s.splat32(self.kernel.write_mask);
        let all = self.kernel.write_mask == [u8::MAX; TEXEL] && keep.is_none();
        for (i, (src, dst)) in src.chunks_exact(S::BYTES).zip(dst.chunks_exact_mut(S::BYTES)).enumerate() {
            s.prefetch(src.as_ptr().wrapping_add(AHEAD));
            s.prefetch(dst.as_ptr().wrapping_add(AHEAD));
            let (source, before) = (s.load(src), s.load(dst));
            let (mut merged, doubt) = self.merged(source, before);
            if doubt != 0 {
                merged = self.mended(doubt, src, dst, merged);
            }
            if !all {
                let kept = keep.map_or(mask, |keep| s.and(mask, s.spread(&keep[i * (S::BYTES / TEXEL)..])));
                merged = s.select(kept, merged, before);
            }
            s.store(dst, merged);
        }
        let keep = keep.map(|keep| &keep[whole / TEXEL..]);
        self.kernel.texels(Row { src: &src[whole..], src1: None, keep, dst: rest });
    }

    /// The texels in doubt by the reference.
    #[inline(always)]
    fn mended(&self, doubt: u32, src: &[u8], dst: &[u8], merged: S::V) -> S::V {
        let mut bytes = [0; 64];
        self.s.store(&mut bytes, merged);
        let mut left = doubt;
        while left != 0 {
            let at = TEXEL * left.trailing_zeros() as usize;
            left &= left - 1;
            let texel = |bytes: &[u8]| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
            bytes[at..at + TEXEL].copy_from_slice(&self.kernel.by_reference(texel(src), texel(dst)));
        }
        self.s.load(&bytes)
    }

    /// A vector of texels.
    #[inline(always)]
    fn merged(&self, src: S::V, dst: S::V) -> (S::V, u32) {
        let (s, over) = (self.s, &self.kernel.over);
        let alpha_code = s.to_f32(s.shift_right32::<24>(src));
        let alpha = self.unit(alpha_code);
        let f = if over.src_by_alpha[0] { alpha } else { self.one };
        let g = if over.dst_by_rest[0] { s.subtract_f32(self.one, alpha) } else { self.one };
        let red = self.channel::<0>(src, dst, f, g);
        let green = self.channel::<8>(src, dst, f, g);
        let blue = self.channel::<16>(src, dst, f, g);
        // 255^2 times alpha's sum is an integer; a 255th of it is never in the middle between two.
        let f = if over.src_by_alpha[1] { alpha_code } else { self.codes };
        let g = if over.dst_by_rest[1] { s.subtract_f32(self.codes, alpha_code) } else { self.codes };
        let before = s.to_f32(s.shift_right32::<24>(dst));
        let sum = if RULE == LLVMPIPE {
            let f = if over.src_by_alpha[1] { alpha } else { self.one };
            let g = if over.dst_by_rest[1] { s.subtract_f32(self.one, alpha) } else { self.one };
            let term = s.multiply_f32(s.multiply_f32(before, self.per_code), g);
            s.multiply_f32(s.min_f32(s.add_f32(s.multiply_f32(alpha, f), term), self.one), self.codes)
        } else {
            let sum = s.multiply_add_f32(before, g, s.multiply_f32(alpha_code, f));
            s.min_f32(s.multiply_f32(sum, self.per_code), self.codes)
        };
        let sum = s.round_f32(sum);
        let low = s.or(s.shift_right32::<16>(red.carried), s.shift_left32::<8>(s.shift_right32::<16>(green.carried)));
        let high = s.or(s.shift_left32::<16>(s.shift_right32::<16>(blue.carried)), s.shift_left32::<24>(sum));
        (s.or(low, high), red.doubt | green.doubt | blue.doubt)
    }

    /// A channel that begins at a bit.
    #[inline(always)]
    fn channel<const BIT: u32>(&self, src: S::V, dst: S::V, f: S::F, g: S::F) -> Channel<S::V> {
        let s = self.s;
        let code = s.to_f32(s.and(s.shift_right32::<BIT>(src), self.low_byte));
        let decode = if RULE == LLVMPIPE { &self.tables.llvmpipe } else { &self.tables.decode };
        let before = s.as_f32(s.gather32(decode, s.shift_right32::<BIT>(dst)));
        let sum = if RULE == EXACT {
            s.multiply_add_f32(before, g, s.multiply_f32(code, s.multiply_f32(f, self.per_code)))
        } else {
            s.add_f32(s.multiply_f32(self.unit(code), f), s.multiply_f32(before, g))
        };
        if RULE == LLVMPIPE {
            let code = self.driver_code(s.min_f32(sum, self.one));
            return Channel { carried: s.shift_left32::<16>(code), doubt: 0 };
        }
        let bits = s.bits_f32(s.min_f32(s.max_f32(sum, self.least), self.most));
        let entry = s.gather32(&self.tables.encode, s.shift_right32::<16>(bits));
        let carried = s.add32(entry, s.and(bits, self.low_half));
        let doubt = if RULE == EXACT {
            // The low half within the margin of zero.
            let shifted = s.add32(carried, s.splat_u32(MARGIN));
            s.equal32(s.and(shifted, s.splat_u32(0x1_0000 - 2 * MARGIN)), s.splat_u32(0))
        } else {
            0
        };
        Channel { carried, doubt }
    }

    /// llvmpipe's code of numbers in [0, 1]; see [`llvmpipe::srgb`].
    #[inline(always)]
    fn driver_code(&self, x: S::F) -> S::V {
        let s = self.s;
        let line = s.multiply_f32(x, s.splat_f32(12.92 * 255.0));
        let root = s.multiply_f32(x, self.rsqrt(x));
        let fourth = self.rsqrt(self.rsqrt(s.multiply_f32(root, x)));
        let [of_fourth, of_root, constant] = llvmpipe::srgb::ENCODE.map(|weight| s.splat_f32(weight * 255.0));
        let sum = s.multiply_add_f32(of_root, root, constant);
        let curve = s.add_f32(s.multiply_f32(of_fourth, fourth), sum);
        // Bits of positive numbers compare as they do.
        let is_line = s.less_mask32(s.bits_f32(x), s.splat_u32(0.003_130_8_f32.to_bits() + 1));
        let scaled = s.as_f32(s.select(is_line, s.bits_f32(line), s.bits_f32(curve)));
        s.round_f32(s.min_f32(scaled, self.codes))
    }

    /// The processor's estimate for positive normal numbers; see [`Estimate`].
    #[inline(always)]
    fn rsqrt(&self, x: S::F) -> S::F {
        let s = self.s;
        let bits = s.bits_f32(x);
        let mantissa = s.gather32(self.roots, s.shift_right32::<11>(bits));
        // With exponent e, x is m 4^h for h = (e + 1) / 2 - 64, rounded down, and the result's exponent is 126 - h.
        let half = s.shift_left32::<23>(s.shift_right32::<24>(s.add32(bits, s.splat_u32(1 << 23))));
        s.as_f32(s.or(s.subtract32(s.splat_u32(190 << 23), half), mantissa))
    }

    /// code / 255 correctly rounded: the product's remainder corrects it. A test tries all codes.
    #[inline(always)]
    fn unit(&self, code: S::F) -> S::F {
        let s = self.s;
        let near = s.multiply_f32(code, self.per_code);
        let remainder = s.multiply_add_f32(near, s.splat_f32(-255.0), code);
        s.multiply_add_f32(remainder, self.per_code, near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thresholds have buckets of their own, and lie further from their ends than the margin.
    #[test]
    fn every_threshold_is_found_and_alone() {
        let mut last = LEAST >> 16;
        for code in 0..255 {
            let first = first_above(srgb::threshold(code).value);
            assert!(first >> 16 > last, "threshold {code} shares a bucket");
            last = first >> 16;
            let encode = |bits: u32| (TABLES.encode[(bits >> 16) as usize % 2048] + (bits & 0xffff)) >> 16;
            assert_eq!(encode(first - 1), code, "below threshold {code}");
            assert_eq!(encode(first), code + 1, "above threshold {code}");
            let low = first & 0xffff;
            assert!(low > 2 * MARGIN && low < 0x1_0000 - 2 * MARGIN, "threshold {code} is near the end of a bucket");
        }
        assert!(last <= MOST >> 16, "the last threshold is inside");
    }

    #[test]
    fn the_table_is_the_curve() {
        for bits in (LEAST..=MOST).step_by(61) {
            let code = (TABLES.encode[(bits >> 16) as usize % 2048] + (bits & 0xffff)) >> 16;
            assert_eq!(Some(code), srgb::encode(f64::from(f32::from_bits(bits))), "{bits:#x}");
        }
    }
}
