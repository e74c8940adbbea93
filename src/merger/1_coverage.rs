//! Stage 1: which samples the fragment reaches at all: scissor, primitive coverage, sample mask.
//!
//! Sources: Vulkan, *Fragment Operations / Scissor Test, Sample Mask Test*; WebGPU, *Rendering Operations*.

use crate::fragment::Fragment;
use crate::state::{DynamicState, Rect};

impl Rect {
    /// Whether texel (x, y) lies inside.
    #[must_use]
    pub fn contains(self, x: u32, y: u32) -> bool {
        x.wrapping_sub(self.x) < self.width && y.wrapping_sub(self.y) < self.height
    }
}

/// Samples left after the scissor test, the primitive's coverage and the pipeline's sample mask; bit i = sample i.
///
/// `mask` is the sample mask ([`crate::model::NumericModel::sample_mask`]). Its bits beyond the sample count are ignored; it
/// applies to single-sampled targets too.
#[must_use]
pub fn covered_samples(count: u32, mask: u64, dynamic: &DynamicState, fragment: &Fragment, (x, y): (u32, u32)) -> u32 {
    if dynamic.scissor.is_some_and(|scissor| !scissor.contains(x, y)) {
        return 0;
    }
    let existing = u32::MAX >> (32 - count.clamp(1, 32));
    let covered = u64::from(fragment.coverage & existing) & mask;
    #[expect(clippy::cast_possible_truncation, reason = "a subset of 32 coverage bits")]
    let covered = covered as u32;
    covered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_mask_applies_to_single_sampled_targets() {
        let covered = covered_samples(1, 0b10, &DynamicState::default(), &Fragment::default(), (0, 0));
        assert_eq!(covered, 0, "bit 0 is off");
    }

    #[test]
    fn mask_bits_beyond_the_sample_count_are_ignored() {
        let covered = covered_samples(4, 0xf5, &DynamicState::default(), &Fragment::default(), (0, 0));
        assert_eq!(covered, 5, "four samples");
    }

    #[test]
    fn the_scissor_keeps_its_edges_half_open() {
        let scissor = Rect { x: 2, y: 3, width: 2, height: 1 };
        let inside = |x, y| scissor.contains(x, y);
        assert!(inside(2, 3) && inside(3, 3), "first and last column");
        assert!(!inside(4, 3) && !inside(1, 3) && !inside(2, 4) && !inside(2, 2), "outside");
    }
}
