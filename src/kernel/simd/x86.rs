//! AVX2 and AVX-512.
#![expect(unsafe_code, reason = "see the parent module: a token proves that the processor has the instructions")]

use std::arch::x86_64::*;

use super::{Simd, Task};

/// The processor has AVX2, FMA and F16C.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

/// The processor has these and AVX-512 F, BW, DQ and VL.
#[derive(Clone, Copy)]
pub(super) struct Avx512(());

/// Runs a task on AVX2, which the caller asked the processor for.
pub(super) fn run_avx2(task: impl Task) {
    #[target_feature(enable = "avx2,fma,f16c")]
    fn inside(task: impl Task, token: Avx2) {
        task.on_vectors(token);
    }
    assert!(super::Isa::Avx2.available(), "asked before");
    // SAFETY: the processor has the features, by the assertion.
    unsafe { inside(task, Avx2(())) }
}

/// Runs a task on AVX-512, which the caller asked the processor for.
pub(super) fn run_avx512(task: impl Task) {
    #[target_feature(enable = "avx2,fma,f16c,avx512f,avx512bw,avx512dq,avx512vl")]
    fn inside(task: impl Task, token: Avx512) {
        task.on_vectors(token);
    }
    assert!(super::Isa::Avx512.available(), "asked before");
    // SAFETY: the processor has the features, by the assertion.
    unsafe { inside(task, Avx512(())) }
}

/// The processor's estimate of 1 / sqrt(x): `RSQRTSS`.
pub(super) fn reciprocal_square_root_estimate(x: f32) -> f32 {
    // SAFETY: every x86-64 processor has SSE, and no memory is touched.
    unsafe { _mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(x))) }
}

/// Operations that are one instruction.
macro_rules! instructions {
    ($vector:ty; $($name:ident($($argument:ident),+) = $instruction:ident $(::<$constant:literal>)?;)+) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $vector),+) -> $vector {
            // SAFETY: `self` proves that the processor has the instruction; it touches no memory.
            unsafe { $instruction $(::<$constant>)? ($($argument),+) }
        }
    )+};
}

impl Simd for Avx2 {
    type V = __m256i;
    type F = __m256;
    const BYTES: usize = 32;

    #[inline(always)]
    fn load(self, bytes: &[u8]) -> __m256i {
        let bytes = &bytes[..Self::BYTES];
        // SAFETY: `self` proves the instruction, and the slice has a vector's bytes.
        unsafe { _mm256_loadu_si256(bytes.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(self, bytes: &mut [u8], v: __m256i) {
        let bytes = &mut bytes[..Self::BYTES];
        // SAFETY: `self` proves the instruction, and the slice has a vector's bytes.
        unsafe { _mm256_storeu_si256(bytes.as_mut_ptr().cast(), v) }
    }

    #[inline(always)]
    fn lanes(self, bytes: [u8; 16]) -> __m256i {
        // SAFETY: `self` proves the instruction, and the array has 16 bytes.
        unsafe { _mm256_broadcastsi128_si256(_mm_loadu_si128(bytes.as_ptr().cast())) }
    }

    #[inline(always)]
    fn spread(self, texels: &[u8]) -> __m256i {
        let texels = i64::from_le_bytes(texels[..8].try_into().expect("eight bytes"));
        let index: [u8; 32] = std::array::from_fn(|i| FOURFOLD[i]);
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_shuffle_epi8(_mm256_set1_epi64x(texels), self.load(&index)) }
    }

    #[inline(always)]
    fn load32(self, elements: &[u32]) -> __m256i {
        let elements = &elements[..Self::BYTES / 4];
        // SAFETY: `self` proves the instruction, and the slice has a vector's elements.
        unsafe { _mm256_loadu_si256(elements.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store32(self, elements: &mut [u32], v: __m256i) {
        let elements = &mut elements[..Self::BYTES / 4];
        // SAFETY: `self` proves the instruction, and the slice has a vector's elements.
        unsafe { _mm256_storeu_si256(elements.as_mut_ptr().cast(), v) }
    }

    #[inline(always)]
    fn load_mask(self, bytes: &[u8]) -> __m256i {
        let bytes = i64::from_le_bytes(bytes[..8].try_into().expect("eight bytes"));
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_cvtepi8_epi32(_mm_cvtsi64_si128(bytes)) }
    }

    #[inline(always)]
    fn store_mask(self, bytes: &mut [u8], v: __m256i) {
        // SAFETY: `self` proves the instructions.
        let packed = unsafe {
            let words = _mm_packs_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
            _mm_cvtsi128_si64(_mm_packs_epi16(words, words))
        };
        bytes[..8].copy_from_slice(&packed.to_le_bytes());
    }

    #[inline(always)]
    fn less_mask32(self, a: __m256i, b: __m256i) -> __m256i {
        let sign = self.splat_u32(1 << 31);
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_cmpgt_epi32(self.xor(b, sign), self.xor(a, sign)) }
    }

    #[inline(always)]
    fn equal_mask32(self, a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_cmpeq_epi32(a, b) }
    }

    #[inline(always)]
    fn prefetch(self, address: *const u8) {
        // SAFETY: a prefetch has no effect but on caches, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
    }

    #[inline(always)]
    fn equal32(self, a: __m256i, b: __m256i) -> u32 {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b))) }.cast_unsigned()
    }

    #[inline(always)]
    fn greater32(self, a: __m256i, b: __m256i) -> u32 {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b))) }.cast_unsigned()
    }

    #[inline(always)]
    fn gather32<const LENGTH: usize>(self, table: &[u32; LENGTH], index: __m256i) -> __m256i {
        const { assert!(LENGTH.is_power_of_two() && LENGTH <= 1 << 16, "indices are masked") };
        #[expect(clippy::cast_possible_truncation, reason = "at most 2^16")]
        let index = self.and(index, self.splat_u32(LENGTH as u32 - 1));
        // SAFETY: `self` proves the instruction, and the mask keeps every index inside the table.
        unsafe { _mm256_i32gather_epi32::<4>(table.as_ptr().cast(), index) }
    }

    #[inline(always)]
    fn shift_left32<const BITS: u32>(self, a: __m256i) -> __m256i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_sll_epi32(a, _mm_cvtsi32_si128(BITS.cast_signed())) }
    }

    #[inline(always)]
    fn shift_right32<const BITS: u32>(self, a: __m256i) -> __m256i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm256_srl_epi32(a, _mm_cvtsi32_si128(BITS.cast_signed())) }
    }

    #[inline(always)]
    fn to_f32(self, a: __m256i) -> __m256 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_cvtepi32_ps(a) }
    }

    #[inline(always)]
    fn round_f32(self, a: __m256) -> __m256i {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_cvtps_epi32(a) }
    }

    #[inline(always)]
    fn bits_f32(self, a: __m256) -> __m256i {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_castps_si256(a) }
    }

    #[inline(always)]
    fn as_f32(self, a: __m256i) -> __m256 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_castsi256_ps(a) }
    }

    #[inline(always)]
    fn alpha_f32(self, a: __m256) -> __m256 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm256_permute_ps::<0xff>(a) }
    }

    #[inline(always)]
    fn load_f16(self, bytes: &[u8]) -> __m256 {
        let bytes = &bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm256_cvtph_ps(_mm_loadu_si128(bytes.as_ptr().cast())) }
    }

    #[inline(always)]
    fn store_f16(self, bytes: &mut [u8], a: __m256) {
        let bytes = &mut bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm_storeu_si128(bytes.as_mut_ptr().cast(), _mm256_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(a)) }
    }

    #[inline(always)]
    fn store_f16_truncated(self, bytes: &mut [u8], a: __m256) {
        let bytes = &mut bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm_storeu_si128(bytes.as_mut_ptr().cast(), _mm256_cvtps_ph::<_MM_FROUND_TO_ZERO>(a)) }
    }

    instructions! { __m256;
        add_f32(a, b) = _mm256_add_ps;
        subtract_f32(a, b) = _mm256_sub_ps;
        multiply_f32(a, b) = _mm256_mul_ps;
        multiply_add_f32(a, b, c) = _mm256_fmadd_ps;
        min_f32(a, b) = _mm256_min_ps;
        max_f32(a, b) = _mm256_max_ps;
    }

    instructions! { __m256i;
        and(a, b) = _mm256_and_si256;
        or(a, b) = _mm256_or_si256;
        xor(a, b) = _mm256_xor_si256;
        shuffle8(a, index) = _mm256_shuffle_epi8;
        min8(a, b) = _mm256_min_epu8;
        max8(a, b) = _mm256_max_epu8;
        add_saturating8(a, b) = _mm256_adds_epu8;
        subtract_saturating8(a, b) = _mm256_subs_epu8;
        interleave_low8(a, b) = _mm256_unpacklo_epi8;
        interleave_high8(a, b) = _mm256_unpackhi_epi8;
        pack16(low, high) = _mm256_packus_epi16;
        add16(a, b) = _mm256_add_epi16;
        add_saturating16(a, b) = _mm256_adds_epu16;
        subtract_saturating16(a, b) = _mm256_subs_epu16;
        multiply16(a, b) = _mm256_mullo_epi16;
        multiply_high16(a, b) = _mm256_mulhi_epu16;
        high_bytes16(a) = _mm256_srli_epi16::<8>;
        multiply_add8(unsigned, signed) = _mm256_maddubs_epi16;
        add32(a, b) = _mm256_add_epi32;
        subtract32(a, b) = _mm256_sub_epi32;
    }
}

impl Simd for Avx512 {
    type V = __m512i;
    type F = __m512;
    const BYTES: usize = 64;

    #[inline(always)]
    fn load(self, bytes: &[u8]) -> __m512i {
        let bytes = &bytes[..Self::BYTES];
        // SAFETY: `self` proves the instruction, and the slice has a vector's bytes.
        unsafe { _mm512_loadu_si512(bytes.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store(self, bytes: &mut [u8], v: __m512i) {
        let bytes = &mut bytes[..Self::BYTES];
        // SAFETY: `self` proves the instruction, and the slice has a vector's bytes.
        unsafe { _mm512_storeu_si512(bytes.as_mut_ptr().cast(), v) }
    }

    #[inline(always)]
    fn lanes(self, bytes: [u8; 16]) -> __m512i {
        // SAFETY: `self` proves the instruction, and the array has 16 bytes.
        unsafe { _mm512_broadcast_i32x4(_mm_loadu_si128(bytes.as_ptr().cast())) }
    }

    #[inline(always)]
    fn spread(self, texels: &[u8]) -> __m512i {
        let texels: [u8; 16] = texels[..16].try_into().expect("sixteen bytes");
        self.shuffle8(self.lanes(texels), self.load(&FOURFOLD))
    }

    #[inline(always)]
    fn load32(self, elements: &[u32]) -> __m512i {
        let elements = &elements[..Self::BYTES / 4];
        // SAFETY: `self` proves the instruction, and the slice has a vector's elements.
        unsafe { _mm512_loadu_si512(elements.as_ptr().cast()) }
    }

    #[inline(always)]
    fn store32(self, elements: &mut [u32], v: __m512i) {
        let elements = &mut elements[..Self::BYTES / 4];
        // SAFETY: `self` proves the instruction, and the slice has a vector's elements.
        unsafe { _mm512_storeu_si512(elements.as_mut_ptr().cast(), v) }
    }

    #[inline(always)]
    fn load_mask(self, bytes: &[u8]) -> __m512i {
        let bytes = &bytes[..16];
        // SAFETY: `self` proves the instructions, and the slice has 16 bytes.
        unsafe { _mm512_cvtepi8_epi32(_mm_loadu_si128(bytes.as_ptr().cast())) }
    }

    #[inline(always)]
    fn store_mask(self, bytes: &mut [u8], v: __m512i) {
        let bytes = &mut bytes[..16];
        // SAFETY: `self` proves the instructions, and the slice has 16 bytes.
        unsafe { _mm_storeu_si128(bytes.as_mut_ptr().cast(), _mm512_cvtepi32_epi8(v)) }
    }

    #[inline(always)]
    fn less_mask32(self, a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm512_movm_epi32(_mm512_cmplt_epu32_mask(a, b)) }
    }

    #[inline(always)]
    fn equal_mask32(self, a: __m512i, b: __m512i) -> __m512i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm512_movm_epi32(_mm512_cmpeq_epi32_mask(a, b)) }
    }

    #[inline(always)]
    fn prefetch(self, address: *const u8) {
        // SAFETY: a prefetch has no effect but on caches, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
    }

    #[inline(always)]
    fn equal32(self, a: __m512i, b: __m512i) -> u32 {
        // SAFETY: `self` proves the instruction.
        u32::from(unsafe { _mm512_cmpeq_epi32_mask(a, b) })
    }

    #[inline(always)]
    fn greater32(self, a: __m512i, b: __m512i) -> u32 {
        // SAFETY: `self` proves the instruction.
        u32::from(unsafe { _mm512_cmpgt_epi32_mask(a, b) })
    }

    #[inline(always)]
    fn gather32<const LENGTH: usize>(self, table: &[u32; LENGTH], index: __m512i) -> __m512i {
        const { assert!(LENGTH.is_power_of_two() && LENGTH <= 1 << 16, "indices are masked") };
        #[expect(clippy::cast_possible_truncation, reason = "at most 2^16")]
        let index = self.and(index, self.splat_u32(LENGTH as u32 - 1));
        // SAFETY: `self` proves the instruction, and the mask keeps every index inside the table.
        unsafe { _mm512_i32gather_epi32::<4>(index, table.as_ptr().cast()) }
    }

    #[inline(always)]
    fn shift_left32<const BITS: u32>(self, a: __m512i) -> __m512i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm512_sll_epi32(a, _mm_cvtsi32_si128(BITS.cast_signed())) }
    }

    #[inline(always)]
    fn shift_right32<const BITS: u32>(self, a: __m512i) -> __m512i {
        // SAFETY: `self` proves the instructions.
        unsafe { _mm512_srl_epi32(a, _mm_cvtsi32_si128(BITS.cast_signed())) }
    }

    #[inline(always)]
    fn to_f32(self, a: __m512i) -> __m512 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm512_cvtepi32_ps(a) }
    }

    #[inline(always)]
    fn round_f32(self, a: __m512) -> __m512i {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm512_cvtps_epi32(a) }
    }

    #[inline(always)]
    fn bits_f32(self, a: __m512) -> __m512i {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm512_castps_si512(a) }
    }

    #[inline(always)]
    fn as_f32(self, a: __m512i) -> __m512 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm512_castsi512_ps(a) }
    }

    #[inline(always)]
    fn alpha_f32(self, a: __m512) -> __m512 {
        // SAFETY: `self` proves the instruction.
        unsafe { _mm512_permute_ps::<0xff>(a) }
    }

    #[inline(always)]
    fn load_f16(self, bytes: &[u8]) -> __m512 {
        let bytes = &bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm512_cvtph_ps(_mm256_loadu_si256(bytes.as_ptr().cast())) }
    }

    #[inline(always)]
    fn store_f16(self, bytes: &mut [u8], a: __m512) {
        let bytes = &mut bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm256_storeu_si256(bytes.as_mut_ptr().cast(), _mm512_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(a)) }
    }

    #[inline(always)]
    fn store_f16_truncated(self, bytes: &mut [u8], a: __m512) {
        let bytes = &mut bytes[..Self::BYTES / 2];
        // SAFETY: `self` proves the instructions, and the slice has half a vector's bytes.
        unsafe { _mm256_storeu_si256(bytes.as_mut_ptr().cast(), _mm512_cvtps_ph::<_MM_FROUND_TO_ZERO>(a)) }
    }

    instructions! { __m512;
        add_f32(a, b) = _mm512_add_ps;
        subtract_f32(a, b) = _mm512_sub_ps;
        multiply_f32(a, b) = _mm512_mul_ps;
        multiply_add_f32(a, b, c) = _mm512_fmadd_ps;
        min_f32(a, b) = _mm512_min_ps;
        max_f32(a, b) = _mm512_max_ps;
    }

    instructions! { __m512i;
        and(a, b) = _mm512_and_si512;
        or(a, b) = _mm512_or_si512;
        xor(a, b) = _mm512_xor_si512;
        shuffle8(a, index) = _mm512_shuffle_epi8;
        min8(a, b) = _mm512_min_epu8;
        max8(a, b) = _mm512_max_epu8;
        add_saturating8(a, b) = _mm512_adds_epu8;
        subtract_saturating8(a, b) = _mm512_subs_epu8;
        interleave_low8(a, b) = _mm512_unpacklo_epi8;
        interleave_high8(a, b) = _mm512_unpackhi_epi8;
        pack16(low, high) = _mm512_packus_epi16;
        add16(a, b) = _mm512_add_epi16;
        add_saturating16(a, b) = _mm512_adds_epu16;
        subtract_saturating16(a, b) = _mm512_subs_epu16;
        multiply16(a, b) = _mm512_mullo_epi16;
        multiply_high16(a, b) = _mm512_mulhi_epu16;
        high_bytes16(a) = _mm512_srli_epi16::<8>;
        multiply_add8(unsigned, signed) = _mm512_maddubs_epi16;
        add32(a, b) = _mm512_add_epi32;
        subtract32(a, b) = _mm512_sub_epi32;
    }
}

/// Byte i / 4: every texel's byte four times.
const FOURFOLD: [u8; 64] = {
    let mut index = [0; 64];
    let mut i = 0;
    while i < 64 {
        #[expect(clippy::cast_possible_truncation, reason = "below 16")]
        let texel = (i / 4) as u8;
        index[i] = texel;
        i += 1;
    }
    index
};
