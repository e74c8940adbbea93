//! A trail that never fades: each frame draws black with a small alpha over the last one. In 8 bits the trail stops
//! just under 1 / (2 alpha) codes above black; in half floats it goes on.
//!
//!     cargo run --example trail

use outmerge::merger::Merger;
use outmerge::model::exact::Exact;
use outmerge::state::preset;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{ColorTargetState, TextureFormat};

const ALPHA: f32 = 0.05;
const FRAMES: usize = 1000;

/// The red code of a white texel after each frame.
fn trail(format: TextureFormat) -> Result<Vec<u32>, Box<dyn std::error::Error>> {
    let blend = preset::by_name("fade").ok_or("a preset")?.blend;
    let state = MergerState::single(ColorTargetState { blend, ..format.into() });
    let mut framebuffer = Framebuffer::for_state(Extent::new(1, 1)?, &state)?;
    let model = Exact::default();
    let merger = Merger::new(&state, &model, &framebuffer)?;
    merger.merge(&Fragment::new([1.0; 4]), 0, 0, &mut framebuffer);
    let mut codes = Vec::new();
    for _ in 0..FRAMES {
        merger.merge(&Fragment::new([0.0, 0.0, 0.0, ALPHA]), 0, 0, &mut framebuffer);
        codes.push(framebuffer.colors[0].as_ref().ok_or("a target")?.codes(0, 0, 0)[0]);
    }
    Ok(codes)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let eight = trail(TextureFormat::Rgba8Unorm)?;
    let rest = eight[FRAMES - 1];
    let frame = eight.iter().position(|code| *code == rest).ok_or("it comes to rest")?;
    println!("rgba8unorm: stuck at code {rest} of 255 from frame {}", frame + 1);
    // Half a code is lost to rounding as soon as alpha d is below it: d < 1 / (2 alpha).
    assert_eq!(rest, 9, "the largest code below 1 / (2 * 0.05) = 10, for ever");

    let bits = u16::try_from(trail(TextureFormat::Rgba16Float)?[FRAMES - 1])?;
    let left = half::f16::from_bits(bits).to_f32() * 255.0;
    println!("rgba16float: {left} of 255 after {FRAMES} frames");
    assert!(left < 0.01, "invisible");
    Ok(())
}
