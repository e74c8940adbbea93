//! One color over many texels, where no factor reads the destination.
//!
//! Then the source's term is a number, the destination's factor a code, and nothing is loaded or computed of a source: what
//! is left is d g + k, divided by 255. Bytes are multiplied where they are: the even ones as 16-bit numbers, the odd ones
//! as multiples of 256, whose product's high half is theirs. A stack of colors is merged group by group of vectors, which
//! stay in registers for all colors of a batch.

use wgpu_types::BlendOperation as Op;

use super::row::{Operand, Side};
use super::rule::{Arithmetic, NearProducts, RoundedProducts, divide, low};
use super::{Rule, Unorm8};
use crate::kernel::TEXEL;
use crate::kernel::simd::{self, Isa, Simd};
use crate::model::llvmpipe::generation::Product;

/// Colors merged while a group of vectors is in registers: their maps fit the first-level cache.
const BATCH: usize = 32;

/// Vectors of a group: enough that the latency of one's multiplications is hidden behind the others'.
const GROUP: usize = 4;

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
                Rule::RoundedProducts | Rule::Llvmpipe(Product::Nearest) => {
                    flat.after[i] = u8::try_from(RoundedProducts.product(color[i], f)).ok()?;
                }
                Rule::Llvmpipe(Product::Near) => {
                    flat.after[i] = u8::try_from(NearProducts.product(color[i], f)).ok()?;
                }
            }
        }
        Some(flat)
    }

    /// The code that channel `i` of a destination is mapped to.
    fn code(&self, d: u8, i: usize) -> u8 {
        let g = self.factor[i];
        match self.rule {
            Rule::Exact => low(divide(u16::from(d) * u16::from(g) + self.before[i])),
            Rule::RoundedProducts | Rule::Llvmpipe(Product::Nearest) => {
                low(RoundedProducts.product(d, g)).saturating_add(self.after[i])
            }
            Rule::Llvmpipe(Product::Near) => low(NearProducts.product(d, g)).saturating_add(self.after[i]),
        }
    }
}

/// Maps every texel of `dst` by each of `stack` in turn.
pub(crate) fn merge(isa: Isa, stack: &[Flat], dst: &mut [u8]) {
    for stack in stack.chunk_by(|a, b| a.rule == b.rule) {
        for stack in stack.chunks(BATCH) {
            simd::run(isa, Task { stack, dst: &mut *dst });
        }
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

/// At most [`BATCH`] colors under one rule.
struct Task<'a> {
    stack: &'a [Flat],
    dst: &'a mut [u8],
}

impl simd::Task for Task<'_> {
    #[inline(always)]
    fn on_vectors<S: Simd>(self, simd: S) {
        // A rule is a constant inside each of the three.
        match self.stack.first().map(|flat| flat.rule) {
            Some(Rule::Exact) => each(simd, self, Rule::Exact),
            Some(Rule::RoundedProducts | Rule::Llvmpipe(Product::Nearest)) => each(simd, self, Rule::RoundedProducts),
            Some(Rule::Llvmpipe(Product::Near)) => each(simd, self, Rule::Llvmpipe(Product::Near)),
            None => {}
        }
    }

    fn plain(self) {
        for flat in self.stack {
            for texel in self.dst.chunks_exact_mut(TEXEL) {
                texel.iter_mut().enumerate().for_each(|(i, code)| *code = flat.code(*code, i));
            }
        }
    }
}

/// A map in vectors.
#[derive(Clone, Copy)]
struct Map<S: Simd> {
    even_factor: S::V,
    odd_factor: S::V,
    even_before: S::V,
    odd_before: S::V,
    after: S::V,
}

impl<S: Simd> Map<S> {
    #[inline(always)]
    fn new(s: S, flat: &Flat) -> Self {
        let [a, b, c, d] = flat.factor;
        let half = s.splat16(128);
        let [before_a, before_b, before_c, before_d] = flat.before.map(u16::to_le_bytes);
        let words = |low: [u8; 2], high: [u8; 2]| [low[0], low[1], high[0], high[1]];
        Self {
            even_factor: s.splat32([a, 0, c, 0]),
            odd_factor: s.splat32([0, b, 0, d]),
            even_before: s.add16(s.splat32(words(before_a, before_c)), half),
            odd_before: s.add16(s.splat32(words(before_b, before_d)), half),
            after: s.splat32(flat.after),
        }
    }

    #[inline(always)]
    fn of(&self, s: S, rule: Rule, d: S::V) -> S::V {
        let odd_bytes = s.splat16(0xff00);
        let even = s.multiply16(s.and(d, s.splat16(0x00ff)), self.even_factor);
        let odd = s.multiply_high16(s.and(d, odd_bytes), self.odd_factor);
        let (even, odd) = if rule == Rule::Llvmpipe(Product::Near) {
            let half = s.splat16(128);
            let even = s.high_bytes16(s.add16(s.add16(even, half), s.high_bytes16(even)));
            (even, s.add16(s.add16(odd, half), s.high_bytes16(odd)))
        } else {
            let odd = s.add16(odd, self.odd_before);
            let even = s.multiply_high16(s.add16(even, self.even_before), s.splat16(257));
            (even, s.add16(odd, s.high_bytes16(odd)))
        };
        let codes = s.or(even, s.and(odd, odd_bytes));
        if rule == Rule::Exact { codes } else { s.add_saturating8(codes, self.after) }
    }
}

#[inline(always)]
fn each<S: Simd>(s: S, task: Task<'_>, rule: Rule) {
    let Some(first) = task.stack.first() else { return };
    let mut maps = [Map::new(s, first); BATCH];
    for (map, flat) in maps.iter_mut().zip(task.stack).skip(1) {
        *map = Map::new(s, flat);
    }
    let maps = &maps[..task.stack.len()];
    // Loops, not adapters: a closure would not have the instruction set.
    let mut groups = task.dst.chunks_exact_mut(GROUP * S::BYTES);
    for group in &mut groups {
        let mut vectors = [s.load(group); GROUP];
        for (bytes, v) in group.chunks_exact(S::BYTES).zip(&mut vectors) {
            *v = s.load(bytes);
        }
        for map in maps {
            for v in &mut vectors {
                *v = map.of(s, rule, *v);
            }
        }
        for (bytes, v) in group.chunks_exact_mut(S::BYTES).zip(vectors) {
            s.store(bytes, v);
        }
    }
    for bytes in groups.into_remainder().chunks_mut(S::BYTES) {
        let mut padded = [0; 64];
        padded[..bytes.len()].copy_from_slice(bytes);
        let mut v = s.load(&padded);
        for map in maps {
            v = map.of(s, rule, v);
        }
        s.store(&mut padded, v);
        bytes.copy_from_slice(&padded[..bytes.len()]);
    }
}
