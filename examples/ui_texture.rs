//! A user interface drawn into a texture, which is then drawn over the screen. With one equation for color and alpha the
//! texture's alpha comes out squared and the screen shows through; with a separate alpha equation and premultiplied
//! composition the picture is that of drawing straight to the screen.
//!
//!     cargo run --example ui_texture

use outmerge::merger::Merger;
use outmerge::model::exact::Exact;
use outmerge::state::preset;
use outmerge::{Extent, Fragment, Framebuffer, MergerState};
use wgpu_types::{ColorTargetState, TextureFormat};

type Error = Box<dyn std::error::Error>;

/// A half-transparent white panel.
const PANEL: [f32; 4] = [1.0, 1.0, 1.0, 0.5];
/// The screen behind it: dark grey, opaque.
const SCREEN: [u32; 4] = [51, 51, 51, 255];

/// Draws one fragment with a preset's blend state over a texel of 8 bits.
fn draw(name: &str, source: [f32; 4], over: [u32; 4]) -> Result<[u32; 4], Error> {
    let blend = preset::by_name(name).ok_or("a preset")?.blend;
    let state = MergerState::single(ColorTargetState { blend, ..TextureFormat::Rgba8Unorm.into() });
    let mut framebuffer = Framebuffer::for_state(Extent::new(1, 1)?, &state)?;
    framebuffer.colors[0].as_mut().ok_or("a target")?.set_codes(0, 0, 0, over);
    Merger::new(&state, &Exact::default(), &framebuffer)?.merge(&Fragment::new(source), 0, 0, &mut framebuffer);
    Ok(framebuffer.colors[0].as_ref().ok_or("a target")?.codes(0, 0, 0))
}

/// A stored texel as a shader samples it.
fn sample(codes: [u32; 4]) -> Result<[f32; 4], Error> {
    let mut color = [0.0; 4];
    for (value, code) in color.iter_mut().zip(codes) {
        *value = f32::from(u8::try_from(code)?) / 255.0;
    }
    Ok(color)
}

fn main() -> Result<(), Error> {
    let direct = draw("alpha-blending", PANEL, SCREEN)?;
    println!("straight to the screen:        {direct:?}");

    // Wrong: the texture's alpha is 0.5 * 0.5, and its color, multiplied once already, is multiplied again.
    let texture = draw("fade", PANEL, [0; 4])?;
    let wrong = draw("fade", sample(texture)?, SCREEN)?;
    println!("one equation, straight again:  {wrong:?} through a texture of {texture:?}");
    assert_eq!(texture, [128, 128, 128, 64], "alpha 0.5 was multiplied by itself");
    assert!(wrong[0] + 50 < direct[0], "much too dark");

    // Right: alpha by `One OneMinusSrcAlpha`; the texture then holds premultiplied color.
    let texture = draw("alpha-blending", PANEL, [0; 4])?;
    let right = draw("premultiplied", sample(texture)?, SCREEN)?;
    println!("alpha kept, premultiplied:     {right:?} through a texture of {texture:?}");
    assert_eq!(texture, [128, 128, 128, 128], "coverage as it is");
    assert!(right.iter().zip(direct).all(|(a, b)| a.abs_diff(b) <= 1), "within the texture's rounding");
    Ok(())
}
