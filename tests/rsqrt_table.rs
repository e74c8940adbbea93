//! The recorded table of the reciprocal square root estimate against the processor the tests run on.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::{_mm_cvtss_f32, _mm_rsqrt_ss, _mm_set_ss};

use outmerge::model::llvmpipe::{RSQRT_CPU, rsqrt};

/// The makers choose their tables: this one is an Intel's.
#[test]
fn the_recorded_table_is_this_processors_or_another_makers() {
    let estimate = |x: f32| _mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(x)));
    // Every step of [1, 4), both ends, at several scales, and all over the range.
    let steps = (0..2048_u32).flat_map(|step| {
        let start = 0x3f80_0000 + (step << 13);
        [start, start + 1, start + 0x1fff]
    });
    let scaled = steps.flat_map(|bits| [-62, -2, 0, 2, 62].map(|e| f32::from_bits(bits) * 2.0_f32.powi(e)));
    let all_over = (0x0080_0000..0x7f80_0000_u32).step_by(9973).map(f32::from_bits);
    let (mut tried, mut differ) = (0, Vec::new());
    for x in scaled.chain(all_over) {
        tried += 1;
        if estimate(x).to_bits() != rsqrt(x).to_bits() {
            differ.push(x);
        }
    }
    let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    if processor.contains("GenuineIntel") {
        assert!(
            differ.is_empty(),
            "{} of {tried} differ from {RSQRT_CPU}, first at {:?}",
            differ.len(),
            differ.first()
        );
    } else {
        println!("{} of {tried} estimates differ from {RSQRT_CPU}; this processor is of another maker", differ.len());
    }
    assert_eq!(tried, 2048 * 3 * 5 + (0x7f80_0000_u32 - 0x0080_0000).div_ceil(9973), "all of them");
}
