//! Stage 4: the stored texel as the blend equation sees it.
//!
//! Codes are decoded, sRGB channels linearised, and channels the format lacks read as (0, 0, 0, 1). Sources: Vulkan,
//! *Framebuffer / Blending* and *Images / Component Substitution*; D3D11.3 19.1.3.3.

use crate::format::{ChannelKind, Codes, ColorFormat};
use crate::model::Arithmetic;

/// Decodes all four channels.
pub fn load<A: Arithmetic>(arithmetic: &A, format: ColorFormat, codes: Codes) -> [A::Value; 4] {
    let channels = format.channels();
    std::array::from_fn(|i| match (channels[i], i) {
        (ChannelKind::Absent, 3) => arithmetic.one(),
        (ChannelKind::Absent, _) => arithmetic.zero(),
        (kind, _) => arithmetic.decode(codes[i], kind),
    })
}
