//! Encoded values of an image to linear values and back.
//!
//! The sRGB curve is evaluated with additions, multiplications and divisions only, so that a scene gives the same
//! fragments on every machine. Source: IEC 61966-2-1.

use serde::Deserialize;

/// Encoded values up to here are linear. Source: IEC 61966-2-1.
const LINEAR_UP_TO: f64 = 0.04045;

/// What the stored values of an image mean; alpha is always linear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorSpace {
    /// Stored values are the values.
    #[default]
    Linear,
    /// RGB is sRGB-encoded.
    Srgb,
}

impl ColorSpace {
    /// The linear value of an encoded RGB value in `[0, 1]`.
    #[must_use]
    pub fn decode(self, encoded: f64) -> f64 {
        match self {
            Self::Linear => encoded,
            Self::Srgb => srgb_to_linear(encoded),
        }
    }

    /// The nearest of `top + 1` evenly spaced codes for a linear RGB value, ties up; clamped, NaN gives 0.
    #[must_use]
    pub fn encode(self, linear: f64, top: u32) -> u32 {
        // The code is the number of thresholds between neighbouring codes that the value reaches.
        let (mut low, mut high) = (0, top);
        while low < high {
            let middle = (low + high).div_ceil(2);
            if linear >= self.decode((f64::from(middle) - 0.5) / f64::from(top)) {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        low
    }
}

/// `((e + 0.055) / 1.055)^2.4` above the linear segment, `e / 12.92` in it, to about 2 ulp of binary64. Increasing.
fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= LINEAR_UP_TO {
        return encoded / 12.92;
    }
    let u = (encoded + 0.055) / 1.055;
    let (u2, u4) = (u * u, u * u * u * u);
    // x^2.4 is the fifth root of x^12; Newton's iteration falls towards it from u^2, which is above for u <= 1.
    let power = u4 * u4 * u4;
    let mut root = if u < 1.0 { u2 } else { power };
    loop {
        let next = (4.0 * root + power / (root * root * root * root)) / 5.0;
        if next < root {
            root = next;
        } else {
            // Arrived, or NaN.
            return root;
        }
    }
}
