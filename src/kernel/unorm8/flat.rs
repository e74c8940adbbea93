//! One color over many texels, where no factor reads the destination.
//!
//! Then the source's term is a number, the destination's factor a code, and nothing is loaded or computed of a source: what
//! is left is d g + k, divided by 255. Bytes are multiplied where they are: the even ones as 16-bit numbers, the odd ones
//! as multiples of 256, whose product's high half is theirs.

use wgpu_types::BlendOperation as Op;

use super::row::{Operand, Side};
use super::rule::{Arithmetic, Llvmpipe, RoundedProducts};
use super::{Rule, Unorm8};
use crate::kernel::TEXEL;
use crate::kernel::simd::{self, Isa, Simd};

/// A color and a state, reduced to a map of codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Flat {
    rule: Rule,
    /// The destination's factor.
    factor: [u8; TEXEL],
    /// What is added before the division: the source's term in units of 1/255 code, if the rule does not round it alone.
    before: [u16; TEXEL],
    /// What is added after it: the source's rounded term.
    after: [u8; TEXEL],
}

impl Flat {
    /// The map of a color under a state; `None` where the state needs more than this.
    pub(super) fn new(kernel: &Unorm8, color: [u8; TEXEL]) -> Option<Self> {
        if kernel.replace || kernel.operations != [Op::Add; 2] || kernel.write_mask != [u8::MAX; TEXEL] {
            return None;
        }
        let mut flat = Self { rule: kernel.rule, factor: [0; TEXEL], before: [0; TEXEL], after: [0; TEXEL] };
        for i in 0..TEXEL {
            let f = factor(kernel, &kernel.src, color, i)?;
            let g = factor(kernel, &kernel.dst, color, i)?;
            flat.factor[i] = g;
            match kernel.rule {
                Rule::Exact => {
                    // A sum beyond the last code would need a clamp.
                    let term = u16::from(color[i]) * u16::from(f);
                    term.checked_add(255 * u16::from(g)).filter(|most| *most <= 255 * 255)?;
                    flat.before[i] = term;
                }
                Rule::RoundedProducts => flat.after[i] = u8::try_from(RoundedProducts.product(color[i], f)).ok()?,
                Rule::Llvmpipe => flat.after[i] = u8::try_from(Llvmpipe.product(color[i], f)).ok()?,
            }
        }
        Some(flat)
    }

    /// Maps every texel of `dst`; `false`, and nothing done, on an instruction set without vectors.
    pub(super) fn merge(&self, isa: Isa, dst: &mut [u8]) -> bool {
        let mut done = true;
        simd::run(isa, Task { flat: self, dst, done: &mut done });
        done
    }
}

/// A factor as a code, unless it reads the destination or a second source.
fn factor(kernel: &Unorm8, side: &Side, color: [u8; TEXEL], i: usize) -> Option<u8> {
    let operand = match side.operands[usize::from(i == 3)] {
        Operand::Zero => 0,
        Operand::Src => color[i],
        Operand::SrcAlpha => color[3],
        Operand::Constant => kernel.constant[i],
        Operand::Dst | Operand::DstAlpha | Operand::Saturate | Operand::Src1 | Operand::Src1Alpha => return None,
    };
    Some(operand ^ side.invert[i])
}

struct Task<'a> {
    flat: &'a Flat,
    dst: &'a mut [u8],
    done: &'a mut bool,
}

impl simd::Task for Task<'_> {
    #[inline(always)]
    fn on_vectors<S: Simd>(self, simd: S) {
        // A rule is a constant inside each of the three.
        match self.flat.rule {
            Rule::Exact => each(simd, self.flat, self.dst, Rule::Exact),
            Rule::RoundedProducts => each(simd, self.flat, self.dst, Rule::RoundedProducts),
            Rule::Llvmpipe => each(simd, self.flat, self.dst, Rule::Llvmpipe),
        }
    }

    fn plain(self) {
        *self.done = false;
    }
}

/// The map in vectors.
#[derive(Clone, Copy)]
struct Map<S: Simd> {
    s: S,
    rule: Rule,
    even_factor: S::V,
    odd_factor: S::V,
    even_before: S::V,
    odd_before: S::V,
    after: S::V,
    half: S::V,
    ratio: S::V,
    even_bytes: S::V,
    odd_bytes: S::V,
}

impl<S: Simd> Map<S> {
    #[inline(always)]
    fn new(s: S, flat: &Flat, rule: Rule) -> Self {
        let [a, b, c, d] = flat.factor;
        let half = s.splat16(128);
        let [before_a, before_b, before_c, before_d] = flat.before.map(u16::to_le_bytes);
        let words = |low: [u8; 2], high: [u8; 2]| [low[0], low[1], high[0], high[1]];
        Self {
            s,
            rule,
            even_factor: s.splat32([a, 0, c, 0]),
            odd_factor: s.splat32([0, b, 0, d]),
            even_before: s.add16(s.splat32(words(before_a, before_c)), half),
            odd_before: s.add16(s.splat32(words(before_b, before_d)), half),
            after: s.splat32(flat.after),
            half,
            ratio: s.splat16(257),
            even_bytes: s.splat16(0x00ff),
            odd_bytes: s.splat16(0xff00),
        }
    }

    #[inline(always)]
    fn of(&self, d: S::V) -> S::V {
        let s = self.s;
        let even = s.multiply16(s.and(d, self.even_bytes), self.even_factor);
        let odd = s.multiply_high16(s.and(d, self.odd_bytes), self.odd_factor);
        let (even, odd) = if self.rule == Rule::Llvmpipe {
            let even = s.high_bytes16(s.add16(s.add16(even, self.half), s.high_bytes16(even)));
            (even, s.add16(s.add16(odd, self.half), s.high_bytes16(odd)))
        } else {
            let odd = s.add16(odd, self.odd_before);
            (s.multiply_high16(s.add16(even, self.even_before), self.ratio), s.add16(odd, s.high_bytes16(odd)))
        };
        let codes = s.or(even, s.and(odd, self.odd_bytes));
        if self.rule == Rule::Exact { codes } else { s.add_saturating8(codes, self.after) }
    }
}

#[inline(always)]
fn each<S: Simd>(s: S, flat: &Flat, dst: &mut [u8], rule: Rule) {
    let map = Map::new(s, flat, rule);
    let mut vectors = dst.chunks_exact_mut(S::BYTES);
    for d in &mut vectors {
        let mapped = map.of(s.load(d));
        s.store(d, mapped);
    }
    let rest = vectors.into_remainder();
    if !rest.is_empty() {
        let mut padded = [0; 64];
        padded[..rest.len()].copy_from_slice(rest);
        let mapped = map.of(s.load(&padded));
        s.store(&mut padded, mapped);
        rest.copy_from_slice(&padded[..rest.len()]);
    }
}
