//! Stage 7: the write mask.
//!
//! Masked channels keep their stored *bits*: no decode and encode, so an sRGB rounding, a snorm spare code or a NaN
//! payload survives. Source: Vulkan, *Framebuffer / Color Write Mask*; D3D11.3 17.15.

use wgpu_types::ColorWrites;

use crate::format::Codes;

/// The codes stored: new where the mask has the channel's bit, old elsewhere.
#[must_use]
pub fn select(mask: ColorWrites, old: Codes, new: Codes) -> Codes {
    std::array::from_fn(|i| if mask.bits() >> i & 1 == 1 { new[i] } else { old[i] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_selects_its_channel() {
        let (old, new) = ([1, 2, 3, 4], [11, 12, 13, 14]);
        assert_eq!(select(ColorWrites::RED, old, new), [11, 2, 3, 4], "bit 0 is red");
        assert_eq!(select(ColorWrites::ALPHA, old, new), [1, 2, 3, 14], "bit 3 is alpha");
        assert_eq!(select(ColorWrites::empty(), old, new), old, "nothing");
        assert_eq!(select(ColorWrites::ALL, old, new), new, "everything");
    }
}
