//! The first fragment of a scene with a number it should not have: NaN, infinity, or a value that a clamp changes.

use serde::Serialize;

use crate::format::{ChannelKind, Codes};
use crate::merger::blend::blend;
use crate::merger::{Fate, Merger};
use crate::model::binary32::Binary32;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::display::value;
use crate::scene::{Scene, SceneError};

/// What to look for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Trap {
    /// A NaN the shader outputs or the target stores.
    Nan,
    /// An infinity the shader outputs or the target stores.
    Inf,
    /// A finite value outside the target's range, from the shader or as result of the blend equation.
    Clamp,
}

/// Where the number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// The shader's output for a color target.
    Source,
    /// The fragment's depth.
    Depth,
    /// The blend equation's result, computed in binary32, before clamp and store.
    Result,
    /// The code stored.
    Stored,
}

/// A fragment caught.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Caught {
    /// Which trap.
    pub trap: Trap,
    /// Index of the draw, in drawing order.
    pub draw: usize,
    /// Its object and pass.
    pub label: String,
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Color target; 0 for a depth.
    pub target: usize,
    /// Channel, 0 to 3 = R, G, B, A; 0 for a depth.
    pub channel: usize,
    /// Where the number is.
    pub place: Place,
    /// The number; as text, since JSON has neither NaN nor infinity.
    pub value: String,
    /// The blend it happened in; `None` for a depth of a fragment that reached no color target.
    pub blend: Option<Blend>,
}

/// One blend, RGBA each; as text like [`Caught::value`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blend {
    /// The shader's output.
    pub source: [String; 4],
    /// What the target held before.
    pub before: [String; 4],
    /// What it holds after.
    pub after: [String; 4],
}

/// Values this little beyond a range come of binary32 roundings, not of the scene.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// What a search came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Fragments looked at.
    pub fragments: usize,
    /// The first that is caught.
    pub caught: Option<Caught>,
}

/// Renders a scene until a fragment is caught, if one is. Fragments that reach no color target are let pass, but
/// for their depth.
///
/// # Errors
/// [`SceneError`].
pub fn find(scene: &Scene, model: &dyn NumericModel, traps: &[Trap]) -> Result<Search, SceneError> {
    let mut targets = scene.cleared()?;
    let mut seen = 0;
    for (index, draw) in scene.draws().iter().enumerate() {
        let merger = Merger::new(&draw.state, model, &targets).map_err(|source| SceneError::Merger {
            index,
            draw: draw.label(),
            source,
        })?;
        let tests_depth = draw.state.depth_stencil.is_some();
        let mut caught = None;
        let framebuffer = &mut targets;
        scene.shade(draw, None, |fragments| {
            for pixel in fragments {
                if caught.is_some() {
                    return;
                }
                seen += 1;
                let (x, y) = (pixel.x, pixel.y);
                let trace = merger.trace(&pixel.fragment, x, y, framebuffer);
                let merged = trace.samples.iter().filter(|sample| sample.fate == Fate::Merged);
                let blends: Vec<(usize, &(ColorInputs, Codes))> = merged
                    .flat_map(|sample| sample.colors.iter().enumerate())
                    .filter_map(|(target, color)| Some((target, color.as_ref()?)))
                    .collect();
                let depth = f64::from(pixel.fragment.depth);
                let in_depth = trap_of(depth, draw.state.dynamic.depth_range.map(f64::from), traps)
                    .filter(|_| tests_depth)
                    .map(|trap| {
                        (Number { trap, channel: 0, place: Place::Depth, value: depth }, blends.first().copied())
                    });
                let found = in_depth.or_else(|| {
                    blends.iter().copied().find_map(|blend| Some((in_color(blend.1, traps)?, Some(blend))))
                });
                caught = found.map(|(number, blend)| Caught {
                    trap: number.trap,
                    draw: index,
                    label: draw.label(),
                    x,
                    y,
                    target: blend.map_or(0, |(target, _)| target),
                    channel: number.channel,
                    place: number.place,
                    value: number.value.to_string(),
                    blend: blend.map(|(_, blend)| Blend::of(blend)),
                });
            }
        });
        if caught.is_some() {
            return Ok(Search { fragments: seen, caught });
        }
    }
    Ok(Search { fragments: seen, caught: None })
}

impl Blend {
    fn of((inputs, codes): &(ColorInputs, Codes)) -> Self {
        let channels = inputs.format.channels();
        let text = |codes: &Codes| std::array::from_fn(|i| value(channels[i], codes[i]).to_string());
        Self { source: inputs.src.map(|x| x.to_string()), before: text(&inputs.dst), after: text(codes) }
    }
}

/// A bad number.
struct Number {
    trap: Trap,
    channel: usize,
    place: Place,
    value: f64,
}

/// The first bad number of one color target.
fn in_color((inputs, codes): &(ColorInputs, Codes), traps: &[Trap]) -> Option<Number> {
    let channels = inputs.format.channels();
    let result = blend(&Binary32, inputs).result;
    for place in [Place::Source, Place::Result, Place::Stored] {
        // A stored value lies in range; NaN and Inf of the equation count once they are stored.
        let counts = |trap: &Trap| place == Place::Source || (*trap == Trap::Clamp) == (place == Place::Result);
        let traps: Vec<Trap> = traps.iter().copied().filter(counts).collect();
        for channel in (0..4).filter(|&i| channels[i] != ChannelKind::Absent) {
            let value = match place {
                Place::Source => f64::from(inputs.src[channel]),
                Place::Result => f64::from(result[channel]),
                Place::Stored | Place::Depth => value(channels[channel], codes[channel]),
            };
            if let Some(trap) = trap_of(value, channels[channel].range(), &traps) {
                return Some(Number { trap, channel, place, value });
            }
        }
    }
    None
}

/// The trap a number falls into.
fn trap_of(x: f64, [low, high]: [f64; 2], traps: &[Trap]) -> Option<Trap> {
    let falls = |trap: &&Trap| match trap {
        Trap::Nan => x.is_nan(),
        Trap::Inf => x.is_infinite(),
        Trap::Clamp => x.is_finite() && (x < low - SLACK || x > high * (1.0 + SLACK)),
    };
    traps.iter().find(falls).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::exact::Exact;

    const ALL: [Trap; 3] = [Trap::Nan, Trap::Inf, Trap::Clamp];

    /// The bundled scene with the tint of one material changed.
    fn tinted(name: &str, material: usize, tint: [f32; 4]) -> Scene {
        let mut scene = Scene::bundled_by_name(name).expect("bundled").expect("valid");
        scene.materials[material].tint = tint;
        scene
    }

    fn caught(scene: &Scene, traps: &[Trap]) -> Option<Caught> {
        let search = find(scene, &Exact::default(), traps).expect("the scene renders");
        assert!(search.fragments > 0, "something was looked at");
        search.caught
    }

    #[test]
    fn an_ordinary_scene_has_nothing_to_catch() {
        assert_eq!(caught(&tinted("fade-over-opaque", 1, [0.9, 0.2, 0.1, 1.0]), &ALL), None, "every value in range");
    }

    #[test]
    fn nan_is_caught_where_the_shader_makes_it() {
        let scene = tinted("fade-over-opaque", 1, [0.5, f32::NAN, 0.1, 1.0]);
        let found = caught(&scene, &ALL).expect("NaN in green");
        assert_eq!((found.trap, found.place, found.channel), (Trap::Nan, Place::Source, 1), "{found:?}");
        assert!(found.label.starts_with("faded"), "the faded quad: {}", found.label);
        assert_eq!(caught(&scene, &[Trap::Inf]), None, "only what is asked for is caught");
    }

    #[test]
    fn values_beyond_the_target_are_caught_before_the_clamp_hides_them() {
        let found = caught(&tinted("fade-over-opaque", 0, [8.0, 1.0, 1.0, 1.0]), &ALL).expect("8 on a unorm target");
        assert_eq!((found.trap, found.place, found.channel), (Trap::Clamp, Place::Source, 0), "{found:?}");
    }

    #[test]
    fn infinities_are_no_clamps() {
        let found = caught(&tinted("fade-over-opaque", 1, [1.0, 1.0, f32::INFINITY, 1.0]), &ALL).expect("Inf in blue");
        assert_eq!(found.trap, Trap::Inf, "{found:?}");
    }

    #[test]
    fn a_sum_beyond_the_range_is_a_result_not_a_source() {
        let format = crate::format::ColorFormat::from_name("rgba8unorm").expect("a format");
        let inputs = ColorInputs {
            format,
            blend: Some(wgpu_types::BlendState {
                color: wgpu_types::BlendComponent {
                    src_factor: wgpu_types::BlendFactor::One,
                    dst_factor: wgpu_types::BlendFactor::One,
                    operation: wgpu_types::BlendOperation::Add,
                },
                alpha: wgpu_types::BlendComponent::REPLACE,
            }),
            constant: [0.0; 4],
            src: [0.5, 0.75, 0.0, 1.0],
            src1: [0.0; 4],
            dst: [127, 127, 0, 255],
        };
        let found = in_color(&(inputs, [255, 255, 0, 255]), &ALL).expect("0.75 + 127/255");
        assert_eq!((found.channel, found.place), (1, Place::Result), "green passes 1; red stays below");
    }
}
