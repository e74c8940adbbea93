//! A row without vectors of known width, in blocks that stay in registers and first-level cache: operands, factors, terms, write mask.
//!
//! Every factor is `operand ^ invert`: 1 - x of an 8-bit code is its bitwise complement, zero is the operand 0, and one its
//! complement. Color and alpha may differ; then the bytes are picked by a constant mask. All loops run over whole blocks of
//! bytes without a branch, so that the compiler turns them into vector code.

use wgpu_types::{BlendFactor as F, BlendOperation};

use super::Unorm8;
use super::rule::Arithmetic;
use crate::kernel::{Row, TEXEL};

/// Texels of a block.
pub(super) const TEXELS: usize = 32;

/// Bytes of a block.
const BYTES: usize = TEXELS * TEXEL;

type Block = [u8; BYTES];

/// What a factor is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    Zero,
    Src,
    SrcAlpha,
    Dst,
    DstAlpha,
    /// min(source alpha, 1 - destination alpha).
    Saturate,
    Constant,
    Src1,
    Src1Alpha,
}

/// The factor of the source's or the destination's term: for color, then alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Side {
    pub(super) operands: [Operand; 2],
    /// 255 for the bytes whose factor is the complement.
    pub(super) invert: [u8; TEXEL],
}

impl Side {
    pub(super) fn new(color: F, alpha: F) -> Self {
        let (color, color_inverted) = operand(color);
        let (alpha, alpha_inverted) = match alpha {
            // Its alpha is 1, the complement of 0.
            F::SrcAlphaSaturated => (Operand::Zero, true),
            other => operand(other),
        };
        let byte = |inverted| if inverted { u8::MAX } else { 0 };
        let (c, a) = (byte(color_inverted), byte(alpha_inverted));
        Self { operands: [color, alpha], invert: [c, c, c, a] }
    }
}

/// A factor as an operand, and whether it is the operand's complement.
fn operand(factor: F) -> (Operand, bool) {
    match factor {
        F::Zero => (Operand::Zero, false),
        F::One => (Operand::Zero, true),
        F::Src => (Operand::Src, false),
        F::OneMinusSrc => (Operand::Src, true),
        F::SrcAlpha => (Operand::SrcAlpha, false),
        F::OneMinusSrcAlpha => (Operand::SrcAlpha, true),
        F::Dst => (Operand::Dst, false),
        F::OneMinusDst => (Operand::Dst, true),
        F::DstAlpha => (Operand::DstAlpha, false),
        F::OneMinusDstAlpha => (Operand::DstAlpha, true),
        F::SrcAlphaSaturated => (Operand::Saturate, false),
        F::Constant => (Operand::Constant, false),
        F::OneMinusConstant => (Operand::Constant, true),
        F::Src1 => (Operand::Src1, false),
        F::OneMinusSrc1 => (Operand::Src1, true),
        F::Src1Alpha => (Operand::Src1Alpha, false),
        F::OneMinusSrc1Alpha => (Operand::Src1Alpha, true),
    }
}

/// Factors and results of one block, kept from block to block.
struct Scratch {
    /// Alpha of the source, the destination and the second source, or what else an operand computes.
    operands: [Block; 2],
    fs: Block,
    fd: Block,
    result: Block,
    /// The other result where color and alpha have different operations.
    other: Block,
    keep: Block,
}

const EMPTY: Block = [0; BYTES];

/// A row: blocks, then what is left in a block of its own.
#[inline(always)]
pub(super) fn row<A: Arithmetic>(a: A, kernel: &Unorm8, row: Row<'_>) {
    let Row { src, src1, keep, dst } = row;
    let constants = Constants::new(kernel);
    let mut scratch = Scratch { operands: [EMPTY; 2], fs: EMPTY, fd: EMPTY, result: EMPTY, other: EMPTY, keep: EMPTY };
    let (sources, rest_src) = src.as_chunks::<BYTES>();
    let (seconds, rest_src1) = src1.unwrap_or(&[]).as_chunks::<BYTES>();
    let (targets, rest_dst) = dst.as_chunks_mut::<BYTES>();
    for (i, (src, dst)) in sources.iter().zip(targets).enumerate() {
        let keep = keep.map(|keep| &keep[i * TEXELS..(i + 1) * TEXELS]);
        let second = seconds.get(i).unwrap_or(&EMPTY);
        block(a, kernel, &constants, &mut scratch, (src, second), keep, dst);
    }
    if !rest_dst.is_empty() {
        let padded = |bytes: &[u8]| {
            let mut block = EMPTY;
            block[..bytes.len()].copy_from_slice(bytes);
            block
        };
        let mut target = padded(rest_dst);
        let kept = keep.map(|keep| {
            let left = &keep[sources.len() * TEXELS..];
            let mut texels = [0; TEXELS];
            texels[..left.len()].copy_from_slice(left);
            texels
        });
        let sources = (&padded(rest_src), &padded(rest_src1));
        block(a, kernel, &constants, &mut scratch, sources, kept.as_ref().map(<[u8; TEXELS]>::as_slice), &mut target);
        rest_dst.copy_from_slice(&target[..rest_dst.len()]);
    }
}

/// What is the same for every block of a row.
struct Constants {
    /// 255 for color bytes.
    color: Block,
    invert_src: Block,
    invert_dst: Block,
    constant: Block,
    write_mask: Block,
}

impl Constants {
    #[inline(always)]
    fn new(kernel: &Unorm8) -> Self {
        Self {
            color: repeat([255, 255, 255, 0]),
            invert_src: repeat(kernel.src.invert),
            invert_dst: repeat(kernel.dst.invert),
            constant: repeat(kernel.constant),
            write_mask: repeat(kernel.write_mask),
        }
    }
}

/// One byte a texel, four times.
#[inline(always)]
fn spread(texels: &[u8], out: &mut Block) {
    for (out, texel) in out.as_chunks_mut::<TEXEL>().0.iter_mut().zip(texels) {
        *out = (u32::from(*texel) * 0x0101_0101).to_le_bytes();
    }
}

/// Every texel's alpha, four times.
#[inline(always)]
fn alpha(texels: &Block, out: &mut Block) {
    for (out, texel) in out.as_chunks_mut::<TEXEL>().0.iter_mut().zip(texels.as_chunks::<TEXEL>().0) {
        let a = u32::from_le_bytes(*texel) >> 24;
        let a = a | a << 8;
        *out = (a | a << 16).to_le_bytes();
    }
}

/// Four bytes for every texel.
#[inline(always)]
fn repeat(texel: [u8; TEXEL]) -> Block {
    let mut block = EMPTY;
    for out in block.as_chunks_mut::<TEXEL>().0 {
        *out = texel;
    }
    block
}

/// The bytes of `a` where `mask` is 255, those of `b` where it is 0.
#[inline(always)]
fn pick(mask: u8, a: u8, b: u8) -> u8 {
    a & mask | b & !mask
}

/// One block.
#[inline(always)]
fn block<A: Arithmetic>(
    a: A,
    kernel: &Unorm8,
    constants: &Constants,
    scratch: &mut Scratch,
    (src, src1): (&Block, &Block),
    keep: Option<&[u8]>,
    dst: &mut Block,
) {
    let [color, alpha] = kernel.operations;
    let whole = kernel.write_mask == [u8::MAX; TEXEL] && keep.is_none();
    if !kernel.replace {
        let inputs = Inputs { src, src1, dst, constant: &constants.constant };
        inputs.factor(&kernel.src, &constants.color, &constants.invert_src, &mut scratch.operands, &mut scratch.fs);
        inputs.factor(&kernel.dst, &constants.color, &constants.invert_dst, &mut scratch.operands, &mut scratch.fd);
        combined(a, color, (src, &scratch.fs), (dst, &scratch.fd), &mut scratch.result);
        if color != alpha {
            combined(a, alpha, (src, &scratch.fs), (dst, &scratch.fd), &mut scratch.other);
            for i in 0..BYTES {
                scratch.result[i] = pick(constants.color[i], scratch.result[i], scratch.other[i]);
            }
        }
    }
    let result = if kernel.replace { src } else { &scratch.result };
    if whole {
        *dst = *result;
        return;
    }
    match keep {
        None => {
            for i in 0..BYTES {
                dst[i] = pick(constants.write_mask[i], result[i], dst[i]);
            }
        }
        Some(keep) => {
            spread(keep, &mut scratch.keep);
            for i in 0..BYTES {
                dst[i] = pick(constants.write_mask[i] & scratch.keep[i], result[i], dst[i]);
            }
        }
    }
}

/// What factors are made of.
struct Inputs<'a> {
    src: &'a Block,
    src1: &'a Block,
    dst: &'a Block,
    constant: &'a Block,
}

impl<'a> Inputs<'a> {
    /// The factors of one side.
    #[inline(always)]
    fn factor(&self, side: &Side, color: &Block, invert: &Block, scratch: &mut [Block; 2], out: &mut Block) {
        let [of_color, of_alpha] = side.operands;
        let [first, second] = scratch;
        let c = self.operand(of_color, first);
        if of_color == of_alpha {
            for i in 0..BYTES {
                out[i] = c[i] ^ invert[i];
            }
            return;
        }
        let a = self.operand(of_alpha, second);
        for i in 0..BYTES {
            out[i] = pick(color[i], c[i], a[i]) ^ invert[i];
        }
    }

    /// An operand: something that is there, or computed into `scratch`.
    #[inline(always)]
    fn operand<'s>(&self, operand: Operand, scratch: &'s mut Block) -> &'s Block
    where
        'a: 's,
    {
        match operand {
            Operand::Zero => &EMPTY,
            Operand::Src => self.src,
            Operand::Dst => self.dst,
            Operand::Constant => self.constant,
            Operand::Src1 => self.src1,
            Operand::SrcAlpha => {
                alpha(self.src, scratch);
                scratch
            }
            Operand::DstAlpha => {
                alpha(self.dst, scratch);
                scratch
            }
            Operand::Src1Alpha => {
                alpha(self.src1, scratch);
                scratch
            }
            Operand::Saturate => {
                let mut room = EMPTY;
                alpha(self.dst, &mut room);
                alpha(self.src, scratch);
                for i in 0..BYTES {
                    scratch[i] = scratch[i].min(!room[i]);
                }
                scratch
            }
        }
    }
}

/// The operation on all bytes; the match is outside the loops.
#[inline(always)]
fn combined<A: Arithmetic>(a: A, operation: BlendOperation, s: (&Block, &Block), d: (&Block, &Block), out: &mut Block) {
    match operation {
        BlendOperation::Add => each(
            s,
            d,
            out,
            #[inline(always)]
            |s, f, d, g| a.add(a.product(s, f), a.product(d, g)),
        ),
        BlendOperation::Subtract => each(
            s,
            d,
            out,
            #[inline(always)]
            |s, f, d, g| a.subtract(a.product(s, f), a.product(d, g)),
        ),
        BlendOperation::ReverseSubtract => each(
            s,
            d,
            out,
            #[inline(always)]
            |s, f, d, g| a.subtract(a.product(d, g), a.product(s, f)),
        ),
        BlendOperation::Min => each(
            s,
            d,
            out,
            #[inline(always)]
            |s, _, d, _| s.min(d),
        ),
        BlendOperation::Max => each(
            s,
            d,
            out,
            #[inline(always)]
            |s, _, d, _| s.max(d),
        ),
    }
}

/// One channel's equation on every byte.
#[inline(always)]
fn each(
    (src, fs): (&Block, &Block),
    (dst, fd): (&Block, &Block),
    out: &mut Block,
    equation: impl Fn(u8, u8, u8, u8) -> u8,
) {
    for i in 0..BYTES {
        out[i] = equation(src[i], fs[i], dst[i], fd[i]);
    }
}
