//! Instruction sets: which there are, the choice at run time, and vectors as safe functions.
//!
//! A kernel is a `Task`: one text for every vector width, over the operations of `Simd`, and a plain loop for machines
//! without such vectors. `run` compiles the task for each instruction set and calls the one that was asked for.
//!
//! The only unsafe code of the crate is in this module: calls of functions and instructions that the build's target may
//! lack. A value of a type that implements `Simd` is made only after the processor was asked for its instructions
//! ([`Isa::available`]), and every operation takes such a value: that is all that calling them requires. Loads and stores
//! check their slices' lengths.

#[cfg(target_arch = "x86_64")]
mod x86;

/// The processor's own estimate of 1 / sqrt(x) (`RSQRTSS`), whose results are its maker's choice.
#[cfg(target_arch = "x86_64")]
#[must_use]
pub fn reciprocal_square_root_estimate(x: f32) -> f32 {
    x86::reciprocal_square_root_estimate(x)
}

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Isa {
    /// What the build's target has anyway: SSE2 on x86-64, NEON on 64-bit ARM.
    Baseline,
    /// x86-64 with AVX2, FMA and F16C.
    Avx2,
    /// The same with AVX-512 F, BW, DQ and VL.
    Avx512,
}

impl Isa {
    /// Every instruction set a kernel is compiled for, narrowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Whether this machine has it.
    #[must_use]
    pub fn available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                std::is_x86_feature_detected!("avx2")
                    && std::is_x86_feature_detected!("fma")
                    && std::is_x86_feature_detected!("f16c")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.available()
                    && std::is_x86_feature_detected!("avx512f")
                    && std::is_x86_feature_detected!("avx512bw")
                    && std::is_x86_feature_detected!("avx512dq")
                    && std::is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// The widest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        static BEST: std::sync::OnceLock<Isa> = std::sync::OnceLock::new();
        *BEST.get_or_init(|| Self::ALL.into_iter().rev().find(|isa| isa.available()).unwrap_or(Self::Baseline))
    }
}

/// Work that is compiled for every instruction set.
pub(super) trait Task {
    /// On vectors; must be `#[inline(always)]`, as must be all that it calls with its vectors.
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "vectors are x86-64's only"))]
    fn on_vectors<S: Simd>(self, simd: S);

    /// On anything.
    fn plain(self);
}

/// Runs a task on an instruction set.
pub(super) fn run(isa: Isa, task: impl Task) {
    assert!(isa.available(), "this machine has no {isa:?}");
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => x86::run_avx2(task),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => x86::run_avx512(task),
        _ => task.plain(),
    }
}

/// Operations on vectors of bytes, of 16-bit and of 32-bit integers, named by the width of their elements. Shuffles, packs
/// and interleavings stay within lanes of 16 bytes.
pub(super) trait Simd: Copy {
    /// A vector of integers.
    type V: Copy;
    /// A vector of binary32 numbers.
    type F: Copy;

    /// Bytes of a vector.
    const BYTES: usize;

    /// The first bytes of a slice that has a vector's at least.
    fn load(self, bytes: &[u8]) -> Self::V;
    /// Into the first bytes of a slice that has a vector's at least.
    fn store(self, bytes: &mut [u8], v: Self::V);
    /// 16 bytes in every lane.
    fn lanes(self, bytes: [u8; 16]) -> Self::V;
    /// One byte a texel of a slice, as many as the vector has 32-bit elements, each four times.
    fn spread(self, texels: &[u8]) -> Self::V;
    /// 32-bit elements.
    fn load32(self, elements: &[u32]) -> Self::V;
    fn store32(self, elements: &mut [u32], v: Self::V);
    /// One byte an element, all ones or none, widened; and back.
    fn load_mask(self, bytes: &[u8]) -> Self::V;
    fn store_mask(self, bytes: &mut [u8], v: Self::V);
    /// All ones where `a` is less, unsigned; where the elements are equal.
    fn less_mask32(self, a: Self::V, b: Self::V) -> Self::V;
    fn equal_mask32(self, a: Self::V, b: Self::V) -> Self::V;
    /// Asks for the cache line at an address, which may be any.
    fn prefetch(self, address: *const u8);

    fn and(self, a: Self::V, b: Self::V) -> Self::V;
    fn or(self, a: Self::V, b: Self::V) -> Self::V;
    fn xor(self, a: Self::V, b: Self::V) -> Self::V;
    /// The byte of each lane that the index's low four bits name; 0 where its top bit is set.
    fn shuffle8(self, a: Self::V, index: Self::V) -> Self::V;
    fn min8(self, a: Self::V, b: Self::V) -> Self::V;
    fn max8(self, a: Self::V, b: Self::V) -> Self::V;
    fn add_saturating8(self, a: Self::V, b: Self::V) -> Self::V;
    fn subtract_saturating8(self, a: Self::V, b: Self::V) -> Self::V;
    /// The lower (upper) halves of all lanes, interleaved: elements of 16 bits with `a` low and `b` high.
    fn interleave_low8(self, a: Self::V, b: Self::V) -> Self::V;
    fn interleave_high8(self, a: Self::V, b: Self::V) -> Self::V;
    /// Signed 16-bit elements saturated to bytes: undoes the interleavings.
    fn pack16(self, low: Self::V, high: Self::V) -> Self::V;
    fn add16(self, a: Self::V, b: Self::V) -> Self::V;
    fn add_saturating16(self, a: Self::V, b: Self::V) -> Self::V;
    fn subtract_saturating16(self, a: Self::V, b: Self::V) -> Self::V;
    /// Low 16 bits of the products.
    fn multiply16(self, a: Self::V, b: Self::V) -> Self::V;
    /// High 16 bits of the unsigned products.
    fn multiply_high16(self, a: Self::V, b: Self::V) -> Self::V;
    /// Each element shifted right by eight.
    fn high_bytes16(self, a: Self::V) -> Self::V;
    /// Unsigned bytes times signed ones, neighbours added into 16 bits with signed saturation.
    fn multiply_add8(self, unsigned: Self::V, signed: Self::V) -> Self::V;

    fn add32(self, a: Self::V, b: Self::V) -> Self::V;
    fn subtract32(self, a: Self::V, b: Self::V) -> Self::V;
    fn shift_left32<const BITS: u32>(self, a: Self::V) -> Self::V;
    fn shift_right32<const BITS: u32>(self, a: Self::V) -> Self::V;
    /// Which elements are equal: a bit each.
    fn equal32(self, a: Self::V, b: Self::V) -> u32;
    /// Which signed elements of `a` are greater.
    fn greater32(self, a: Self::V, b: Self::V) -> u32;
    /// `table[index]` for every element; indices count modulo the table's length, a power of two.
    fn gather32<const LENGTH: usize>(self, table: &[u32; LENGTH], index: Self::V) -> Self::V;

    /// Signed integers as numbers.
    fn to_f32(self, a: Self::V) -> Self::F;
    /// Numbers as integers, to the nearest even.
    fn round_f32(self, a: Self::F) -> Self::V;
    fn bits_f32(self, a: Self::F) -> Self::V;
    fn as_f32(self, a: Self::V) -> Self::F;
    fn add_f32(self, a: Self::F, b: Self::F) -> Self::F;
    fn subtract_f32(self, a: Self::F, b: Self::F) -> Self::F;
    fn multiply_f32(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b + c, rounded once.
    fn multiply_add_f32(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The second operand where either is NaN.
    fn min_f32(self, a: Self::F, b: Self::F) -> Self::F;
    fn max_f32(self, a: Self::F, b: Self::F) -> Self::F;
    /// The last of every four elements, four times.
    fn alpha_f32(self, a: Self::F) -> Self::F;
    /// Binary16 numbers, half a vector's bytes of them.
    fn load_f16(self, bytes: &[u8]) -> Self::F;
    /// To binary16, to the nearest even.
    fn store_f16(self, bytes: &mut [u8], a: Self::F);
    /// To binary16, toward zero.
    fn store_f16_truncated(self, bytes: &mut [u8], a: Self::F);

    /// One number everywhere.
    #[inline(always)]
    fn splat_f32(self, x: f32) -> Self::F {
        self.as_f32(self.splat32(x.to_le_bytes()))
    }

    /// One 32-bit integer everywhere.
    #[inline(always)]
    fn splat_u32(self, x: u32) -> Self::V {
        self.splat32(x.to_le_bytes())
    }

    /// One byte everywhere.
    #[inline(always)]
    fn splat8(self, x: u8) -> Self::V {
        self.lanes([x; 16])
    }

    /// One 16-bit element everywhere.
    #[inline(always)]
    fn splat16(self, x: u16) -> Self::V {
        let [low, high] = x.to_le_bytes();
        self.lanes(std::array::from_fn(|i| if i % 2 == 0 { low } else { high }))
    }

    /// One texel of four bytes everywhere.
    #[inline(always)]
    fn splat32(self, texel: [u8; 4]) -> Self::V {
        self.lanes(std::array::from_fn(|i| texel[i % 4]))
    }

    /// The bits of `a` where `mask` has them, else those of `b`.
    #[inline(always)]
    fn select(self, mask: Self::V, a: Self::V, b: Self::V) -> Self::V {
        self.xor(b, self.and(mask, self.xor(a, b)))
    }
}
