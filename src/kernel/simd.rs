//! One row function, compiled for each instruction set, and the choice between them at run time.
//!
//! The only unsafe code of the crate: calls of functions that were compiled for instructions the build's target may lack.
//! Each is made only after the processor was asked for them ([`Isa::available`]), which is all that such a call requires;
//! the functions themselves are ordinary safe Rust.

use super::row::row;
use super::rule::{Exact, Llvmpipe, RoundedProducts};
use super::{Kernel, Rule};

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Isa {
    /// What the build's target has anyway: SSE2 on x86-64, NEON on 64-bit ARM.
    Baseline,
    /// x86-64 with AVX2.
    Avx2,
    /// x86-64 with AVX-512 BW and VL.
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
            Self::Avx2 => std::is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                std::is_x86_feature_detected!("avx512bw")
                    && std::is_x86_feature_detected!("avx512vl")
                    && std::is_x86_feature_detected!("avx2")
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

/// Merges a row; lengths were checked by the caller.
pub(super) fn run(isa: Isa, kernel: &Kernel, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
    assert!(isa.available(), "this machine has no {isa:?}");
    match isa {
        Isa::Baseline => by_rule(kernel, src, src1, keep, dst),
        #[cfg(target_arch = "x86_64")]
        #[expect(unsafe_code, reason = "the processor has AVX2: asserted above")]
        Isa::Avx2 => unsafe { avx2(kernel, src, src1, keep, dst) },
        #[cfg(target_arch = "x86_64")]
        #[expect(unsafe_code, reason = "the processor has AVX-512 BW and VL: asserted above")]
        Isa::Avx512 => unsafe { avx512(kernel, src, src1, keep, dst) },
        #[cfg(not(target_arch = "x86_64"))]
        Isa::Avx2 | Isa::Avx512 => by_rule(kernel, src, src1, keep, dst),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn avx2(kernel: &Kernel, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
    by_rule(kernel, src, src1, keep, dst);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512bw,avx512vl")]
fn avx512(kernel: &Kernel, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
    by_rule(kernel, src, src1, keep, dst);
}

/// The rule is chosen once a row.
#[inline(always)]
fn by_rule(kernel: &Kernel, src: &[u8], src1: Option<&[u8]>, keep: Option<&[u8]>, dst: &mut [u8]) {
    match kernel.rule {
        Rule::Exact => row(Exact, kernel, src, src1, keep, dst),
        Rule::RoundedProducts => row(RoundedProducts, kernel, src, src1, keep, dst),
        Rule::Llvmpipe => row(Llvmpipe, kernel, src, src1, keep, dst),
    }
}
