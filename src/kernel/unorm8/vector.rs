//! Rows in vectors.
//!
//! A factor is `(shuffled source | shuffled destination | constant) ^ invert`: one byte shuffle picks a channel itself, its
//! texel's alpha or nothing, so no state needs a branch. States that need less take a shorter way, chosen before the row:
//!
//! - one factor is 1: the other term's product is rounded by itself and added, since adding an integer number of codes
//!   moves no rounding;
//! - `exact`, factors f and 1 - f: with the codes less 128 the sum of two products fits a signed 16-bit multiply-add, and
//!   128 (f + (255 - f)) = 32,640 is what has to be given back, which together with the rounding's 128 is 2^15;
//! - straight over, whose alpha has factors 1 and 1 - a, is the latter with factors a and 1 - a and a source alpha of 255.
//!
//! In all of them (x + 128) x 257 >> 16 is x / 255 to the nearest: a unit test of [`rule`](super::rule) tries every x.

use wgpu_types::BlendOperation as Op;

use super::row::{Operand, Side};
use super::shape::Shape;
use super::{Rule, Unorm8};
use crate::kernel::simd::Simd;
use crate::kernel::{Row, TEXEL};
use crate::model::llvmpipe::generation::Product;

/// How far ahead rows are asked for, in bytes.
const AHEAD: usize = 2048;

/// A factor without second source or saturation.
#[derive(Clone, Copy)]
struct Factor<V> {
    from_src: V,
    from_dst: V,
    constant: V,
    invert: V,
}

impl<V: Copy> Factor<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(s: S, kernel: &Unorm8, side: &Side) -> Self {
        let operand = |i: usize| side.operands[usize::from(i % TEXEL == 3)];
        let constant = |i: usize| if operand(i) == Operand::Constant { kernel.constant[i % TEXEL] } else { 0 };
        Self {
            from_src: s.lanes(picked(side, Operand::Src, Operand::SrcAlpha)),
            from_dst: s.lanes(picked(side, Operand::Dst, Operand::DstAlpha)),
            constant: s.lanes(std::array::from_fn(constant)),
            invert: s.splat32(side.invert),
        }
    }

    #[inline(always)]
    fn of<S: Simd<V = V>>(&self, s: S, src: V, dst: V) -> V {
        s.xor(self.plain(s, src, dst), self.invert)
    }

    /// Where the destination is no operand.
    #[inline(always)]
    fn of_source<S: Simd<V = V>>(&self, s: S, src: V) -> V {
        s.xor(s.or(s.shuffle8(src, self.from_src), self.constant), self.invert)
    }

    #[inline(always)]
    fn plain<S: Simd<V = V>>(&self, s: S, src: V, dst: V) -> V {
        s.or(s.or(s.shuffle8(src, self.from_src), s.shuffle8(dst, self.from_dst)), self.constant)
    }
}

/// Shuffle of a lane: the byte itself for `own`, its texel's alpha for `alpha`, nothing for other operands.
fn picked(side: &Side, own: Operand, alpha: Operand) -> [u8; 16] {
    std::array::from_fn(|i| {
        let operand = side.operands[usize::from(i % TEXEL == 3)];
        let at = if operand == own {
            i
        } else if operand == alpha {
            i | 3
        } else {
            0x80
        };
        u8::try_from(at).expect("below 256")
    })
}

/// What any factor needs besides.
#[derive(Clone, Copy)]
struct AnyFactor<V> {
    factor: Factor<V>,
    from_src1: V,
    saturate: V,
}

impl<V: Copy> AnyFactor<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(s: S, kernel: &Unorm8, side: &Side) -> Self {
        let saturates = |i: usize| side.operands[usize::from(i % TEXEL == 3)] == Operand::Saturate;
        Self {
            factor: Factor::new(s, kernel, side),
            from_src1: s.lanes(picked(side, Operand::Src1, Operand::Src1Alpha)),
            saturate: s.lanes(std::array::from_fn(|i| if saturates(i) { u8::MAX } else { 0 })),
        }
    }

    /// Without a second source.
    #[inline(always)]
    fn saturated<S: Simd<V = V>>(&self, s: S, src: V, dst: V, room: V) -> V {
        s.xor(s.or(self.factor.plain(s, src, dst), s.and(room, self.saturate)), self.factor.invert)
    }

    #[inline(always)]
    fn of<S: Simd<V = V>>(&self, s: S, src: V, src1: V, dst: V, room: V) -> V {
        let more = s.or(s.shuffle8(src1, self.from_src1), s.and(room, self.saturate));
        s.xor(s.or(self.factor.plain(s, src, dst), more), self.factor.invert)
    }
}

/// Products and sums by a rule, as bytes.
#[derive(Clone, Copy)]
struct Products<S: Simd> {
    s: S,
    rule: Rule,
    half: S::V,
    ratio: S::V,
    zero: S::V,
    even: S::V,
    odd: S::V,
}

impl<S: Simd> Products<S> {
    #[inline(always)]
    fn new(s: S, rule: Rule) -> Self {
        let (even, odd) = (s.splat16(0x00ff), s.splat16(0xff00));
        Self { s, rule, half: s.splat16(128), ratio: s.splat16(257), zero: s.splat8(0), even, odd }
    }

    /// x f in units of 1/255 code: the lower and the upper halves of all lanes.
    #[inline(always)]
    fn raw(&self, x: S::V, factor: S::V) -> [S::V; 2] {
        let s = self.s;
        [
            s.multiply16(s.interleave_low8(x, self.zero), s.interleave_low8(factor, self.zero)),
            s.multiply16(s.interleave_high8(x, self.zero), s.interleave_high8(factor, self.zero)),
        ]
    }

    /// Divided by 255 to the nearest; what exceeds 255 becomes 255.
    #[inline(always)]
    fn divided(&self, [low, high]: [S::V; 2]) -> S::V {
        let s = self.s;
        let low = s.multiply_high16(s.add_saturating16(low, self.half), self.ratio);
        let high = s.multiply_high16(s.add_saturating16(high, self.half), self.ratio);
        s.pack16(low, high)
    }

    /// One product as a code.
    #[inline(always)]
    fn code(&self, x: S::V, factor: S::V) -> S::V {
        let s = self.s;
        if self.rule != Rule::Llvmpipe(Product::Near) {
            return self.divided(self.raw(x, factor));
        }
        // Even bytes are multiplied where they are; odd ones as multiples of 256, whose product's high half is theirs.
        let even = s.multiply16(s.and(x, self.even), s.and(factor, self.even));
        let odd = s.multiply_high16(s.and(x, self.odd), s.and(factor, self.odd));
        let even = s.high_bytes16(s.add16(s.add16(even, self.half), s.high_bytes16(even)));
        let odd = s.add16(s.add16(odd, self.half), s.high_bytes16(odd));
        s.or(even, s.and(odd, self.odd))
    }

    /// s f + d g.
    #[inline(always)]
    fn add(&self, (src, f): (S::V, S::V), (dst, g): (S::V, S::V)) -> S::V {
        let s = self.s;
        if self.rule == Rule::Exact {
            let ([a, b], [c, d]) = (self.raw(src, f), self.raw(dst, g));
            return self.divided([s.add_saturating16(a, c), s.add_saturating16(b, d)]);
        }
        s.add_saturating8(self.code(src, f), self.code(dst, g))
    }

    /// x f - y g.
    #[inline(always)]
    fn subtract(&self, (x, f): (S::V, S::V), (y, g): (S::V, S::V)) -> S::V {
        let s = self.s;
        if self.rule == Rule::Exact {
            let ([a, b], [c, d]) = (self.raw(x, f), self.raw(y, g));
            return self.divided([s.subtract_saturating16(a, c), s.subtract_saturating16(b, d)]);
        }
        s.subtract_saturating8(self.code(x, f), self.code(y, g))
    }

    #[inline(always)]
    fn signed16(&self, p: S::V, q: S::V, [less_p, less_q]: [S::V; 2]) -> S::V {
        let s = self.s;
        let sum = s.add_saturating16(s.xor(p, less_p), s.xor(q, less_q));
        s.xor(s.xor(sum, less_p), less_q)
    }

    /// s f + d g, or where `signs` say so its difference or the reverse: p - q is the complement of (not p) + q, so the
    /// saturated sum serves all three.
    #[inline(always)]
    fn combine(&self, signs: &Signs<S::V>, (src, f): (S::V, S::V), (dst, g): (S::V, S::V)) -> S::V {
        let s = self.s;
        if self.rule == Rule::Exact {
            let ([a, b], [c, d]) = (self.raw(src, f), self.raw(dst, g));
            return self.divided([self.signed16(a, c, signs.low), self.signed16(b, d, signs.high)]);
        }
        let [less_p, less_q] = signs.bytes;
        let sum = s.add_saturating8(s.xor(self.code(src, f), less_p), s.xor(self.code(dst, g), less_q));
        s.xor(s.xor(sum, less_p), less_q)
    }
}

/// All ones where the source's term, and where the destination's, is subtracted from the other: in bytes, and in the
/// 16-bit elements of both halves.
#[derive(Clone, Copy)]
struct Signs<V> {
    bytes: [V; 2],
    low: [V; 2],
    high: [V; 2],
}

impl<V: Copy> Signs<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(s: S, kernel: &Unorm8) -> Self {
        // p - q complements p, and q - p complements q.
        let bytes = [chosen(s, kernel, Op::Subtract), chosen(s, kernel, Op::ReverseSubtract)];
        let [p, q] = bytes;
        Self {
            bytes,
            low: [s.interleave_low8(p, p), s.interleave_low8(q, q)],
            high: [s.interleave_high8(p, p), s.interleave_high8(q, q)],
        }
    }
}

/// All ones in the channels with an operation.
#[inline(always)]
fn chosen<S: Simd>(s: S, kernel: &Unorm8, operation: Op) -> S::V {
    let [color, alpha] = kernel.operations.map(|o| if o == operation { u8::MAX } else { 0 });
    s.splat32([color, color, color, alpha])
}

/// Merges a row.
#[inline(always)]
pub(super) fn row<S: Simd>(s: S, kernel: &Unorm8, row: Row<'_>) {
    // A rule is a constant inside each of the three.
    match kernel.rule {
        Rule::Exact => by_shape(s, kernel, row, Products::new(s, Rule::Exact)),
        Rule::RoundedProducts | Rule::Llvmpipe(Product::Nearest) => {
            by_shape(s, kernel, row, Products::new(s, Rule::RoundedProducts));
        }
        Rule::Llvmpipe(Product::Near) => by_shape(s, kernel, row, Products::new(s, Rule::Llvmpipe(Product::Near))),
    }
}

#[inline(always)]
fn by_shape<S: Simd>(s: S, kernel: &Unorm8, row: Row<'_>, products: Products<S>) {
    let f = Factor::new(s, kernel, &kernel.src);
    let g = Factor::new(s, kernel, &kernel.dst);
    let mask = (s.splat32(kernel.write_mask), kernel.write_mask == [u8::MAX; TEXEL]);
    match kernel.shape {
        Shape::Replace => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, _| src,
        ),
        Shape::Least => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| s.min8(src, dst),
        ),
        Shape::Most => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| s.max8(src, dst),
        ),
        Shape::SourceOne => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| s.add_saturating8(src, products.code(dst, g.of(s, src, dst))),
        ),
        Shape::DestinationOne => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| s.add_saturating8(dst, products.code(src, f.of(s, src, dst))),
        ),
        Shape::Lerp { opaque } => {
            let opaque = s.splat32([0, 0, 0, if opaque { u8::MAX } else { 0 }]);
            let (offset, sign, ones) = (s.splat8(0x80), s.splat16(0x8000), s.splat8(u8::MAX));
            each(
                s,
                row,
                mask,
                #[inline(always)]
                |src, _, dst| {
                    let rest = g.of(s, src, dst);
                    let factor = s.xor(rest, ones);
                    let (x, y) = (s.xor(s.or(src, opaque), offset), s.xor(dst, offset));
                    let low = s.multiply_add8(s.interleave_low8(factor, rest), s.interleave_low8(x, y));
                    let high = s.multiply_add8(s.interleave_high8(factor, rest), s.interleave_high8(x, y));
                    let low = s.multiply_high16(s.xor(low, sign), products.ratio);
                    let high = s.multiply_high16(s.xor(high, sign), products.ratio);
                    s.pack16(low, high)
                },
            );
        }
        Shape::AddBySource => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| products.add((src, f.of_source(s, src)), (dst, g.of_source(s, src))),
        ),
        Shape::Add => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| products.add((src, f.of(s, src, dst)), (dst, g.of(s, src, dst))),
        ),
        Shape::Subtract => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| products.subtract((src, f.of(s, src, dst)), (dst, g.of(s, src, dst))),
        ),
        Shape::ReverseSubtract => each(
            s,
            row,
            mask,
            #[inline(always)]
            |src, _, dst| products.subtract((dst, g.of(s, src, dst)), (src, f.of(s, src, dst))),
        ),
        Shape::Mixed { saturates: false } => mixed::<S, false>(s, kernel, row, products, mask),
        Shape::Mixed { saturates: true } => mixed::<S, true>(s, kernel, row, products, mask),
        Shape::Any => any(s, kernel, row, products, mask),
    }
}

/// Sums of any signs.
#[inline(always)]
fn mixed<S: Simd, const SATURATES: bool>(s: S, kernel: &Unorm8, row: Row<'_>, products: Products<S>, mask: Mask<S>) {
    let f = AnyFactor::new(s, kernel, &kernel.src);
    let g = AnyFactor::new(s, kernel, &kernel.dst);
    let signs = Signs::new(s, kernel);
    let room = Room::new(s);
    each(
        s,
        row,
        mask,
        #[inline(always)]
        |src, _, dst| {
            let (x, y) = if SATURATES {
                let room = room.of(s, src, dst);
                (f.saturated(s, src, dst, room), g.saturated(s, src, dst, room))
            } else {
                (f.factor.of(s, src, dst), g.factor.of(s, src, dst))
            };
            products.combine(&signs, (src, x), (dst, y))
        },
    );
}

/// All factors, and every operation.
#[inline(always)]
fn any<S: Simd>(s: S, kernel: &Unorm8, row: Row<'_>, products: Products<S>, mask: Mask<S>) {
    let f = AnyFactor::new(s, kernel, &kernel.src);
    let g = AnyFactor::new(s, kernel, &kernel.dst);
    let signs = Signs::new(s, kernel);
    let room = Room::new(s);
    let (least, most) = (chosen(s, kernel, Op::Min), chosen(s, kernel, Op::Max));
    each(
        s,
        row,
        mask,
        #[inline(always)]
        |src, src1, dst| {
            let room = room.of(s, src, dst);
            let x = f.of(s, src, src1, dst, room);
            let y = g.of(s, src, src1, dst, room);
            let sum = products.combine(&signs, (src, x), (dst, y));
            s.select(least, s.min8(src, dst), s.select(most, s.max8(src, dst), sum))
        },
    );
}

/// min(source alpha, 1 - destination alpha).
#[derive(Clone, Copy)]
struct Room<V> {
    alpha: V,
    ones: V,
}

impl<V: Copy> Room<V> {
    #[inline(always)]
    fn new<S: Simd<V = V>>(s: S) -> Self {
        let alpha = std::array::from_fn(|i| u8::try_from(i | 3).expect("below 16"));
        Self { alpha: s.lanes(alpha), ones: s.splat8(u8::MAX) }
    }

    #[inline(always)]
    fn of<S: Simd<V = V>>(&self, s: S, src: V, dst: V) -> V {
        s.min8(s.shuffle8(src, self.alpha), s.xor(s.shuffle8(dst, self.alpha), self.ones))
    }
}

/// The write mask, and whether it is all ones.
type Mask<S> = (<S as Simd>::V, bool);

/// Every vector of a row, then what is left in a vector of its own.
#[inline(always)]
fn each<S: Simd>(s: S, row: Row<'_>, (mask, all): Mask<S>, merge: impl Fn(S::V, S::V, S::V) -> S::V) {
    let Row { src, src1, keep, dst } = row;
    let zero = s.splat8(0);
    let whole = dst.len() - dst.len() % S::BYTES;
    let (dst, rest) = dst.split_at_mut(whole);
    if all && keep.is_none() && src1.is_none() {
        for (src, dst) in src.chunks_exact(S::BYTES).zip(dst.chunks_exact_mut(S::BYTES)) {
            s.prefetch(src.as_ptr().wrapping_add(AHEAD));
            s.prefetch(dst.as_ptr().wrapping_add(AHEAD));
            let merged = merge(s.load(src), zero, s.load(dst));
            s.store(dst, merged);
        }
    } else {
        for (i, (src, dst)) in src.chunks_exact(S::BYTES).zip(dst.chunks_exact_mut(S::BYTES)).enumerate() {
            s.prefetch(src.as_ptr().wrapping_add(AHEAD));
            s.prefetch(dst.as_ptr().wrapping_add(AHEAD));
            let second = src1.map_or(
                zero,
                #[inline(always)]
                |src1| s.load(&src1[i * S::BYTES..]),
            );
            let kept = keep.map_or(
                mask,
                #[inline(always)]
                |keep| s.and(mask, s.spread(&keep[i * (S::BYTES / TEXEL)..])),
            );
            let before = s.load(dst);
            s.store(dst, s.select(kept, merge(s.load(src), second, before), before));
        }
    }
    if !rest.is_empty() {
        let padded = |bytes: &[u8]| {
            let mut buffer = [0; 64];
            buffer[..bytes.len()].copy_from_slice(bytes);
            buffer
        };
        let mut target = padded(rest);
        let second = src1.map_or([0; 64], |src1| padded(&src1[whole..]));
        let kept = keep.map_or([u8::MAX; 64], |keep| padded(&keep[whole / TEXEL..]));
        let before = s.load(&target);
        let merged = merge(s.load(&padded(&src[whole..])), s.load(&second), before);
        s.store(&mut target, s.select(s.and(mask, s.spread(&kept)), merged, before));
        rest.copy_from_slice(&target[..rest.len()]);
    }
}
