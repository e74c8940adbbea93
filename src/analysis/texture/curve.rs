//! An image's transfer curve, ready for many texels: thresholds instead of an inverse.

use super::source::Space;

/// Decoding and encoding of one image's colors.
#[derive(Clone, Debug)]
pub struct Curve {
    space: Space,
    top: u32,
    /// Linear values half-way (on the encoded side) between neighbouring codes of 8 bits.
    eight: Vec<f64>,
    /// The same for codes of the image.
    own: Vec<f64>,
    /// Linear values of the image's codes.
    values: Vec<f64>,
}

impl Curve {
    /// The curve of an image whose largest code is `top`, 255 or 65535.
    #[must_use]
    pub fn new(space: Space, top: u32) -> Self {
        let color_space = space.color_space();
        let thresholds = |top: u32| -> Vec<f64> {
            (0..top).map(|code| color_space.decode((f64::from(code) + 0.5) / f64::from(top))).collect()
        };
        let values = (0..=top).map(|code| color_space.decode(f64::from(code) / f64::from(top))).collect();
        Self { space, top, eight: thresholds(255), own: thresholds(top), values }
    }

    /// The image's space.
    #[must_use]
    pub fn space(&self) -> Space {
        self.space
    }

    /// The linear value of a code of the image.
    #[must_use]
    pub fn linear(&self, code: u16) -> f64 {
        self.values[usize::from(code)]
    }

    /// The 8-bit code nearest to a linear value, ties up.
    #[must_use]
    pub fn encode8(&self, linear: f64) -> u32 {
        rank(&self.eight, linear)
    }

    /// The code of the image nearest to a linear value, ties up.
    #[must_use]
    pub fn encode_own(&self, linear: f64) -> u32 {
        rank(&self.own, linear)
    }

    /// The linear value of an 8-bit code.
    #[must_use]
    pub fn linear8(&self, code: u32) -> f64 {
        match (self.space, self.top) {
            (Space::Linear, _) => f64::from(code) / 255.0,
            // 65535 = 257 * 255: every 8-bit code is one of 16 bits.
            (Space::Srgb, top) => self.values[(code * (top / 255)) as usize],
        }
    }
}

/// How many thresholds a value reaches.
fn rank(thresholds: &[f64], value: f64) -> u32 {
    u32::try_from(thresholds.partition_point(|threshold| *threshold <= value)).expect("at most 65535 thresholds")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::texture::ColorSpace;

    #[test]
    fn every_code_survives() {
        for (space, top) in [(Space::Srgb, 255), (Space::Srgb, 65535), (Space::Linear, 65535)] {
            let curve = Curve::new(space, top);
            for code in 0..=u16::try_from(top).expect("16 bits") {
                assert_eq!(curve.encode_own(curve.linear(code)), u32::from(code), "{space:?}, code {code} of {top}");
            }
            for code in 0..=255 {
                assert_eq!(curve.encode8(curve.linear8(code)), code, "{space:?}, 8-bit code {code}");
            }
        }
    }

    #[test]
    fn encoding_agrees_with_the_color_space() {
        let curve = Curve::new(Space::Srgb, 255);
        for i in 0..=10_000 {
            let x = f64::from(i) / 10_000.0;
            assert_eq!(curve.encode8(x), ColorSpace::Srgb.encode(x, 255), "{x}");
        }
    }
}
