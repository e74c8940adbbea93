//! What a driver's rasteriser adds to its output merger: clipping, interpolation and depth bias, as far as models have them.
//!
//! Only llvmpipe's rasteriser is modelled; other models are left out of these units by name.

use fastrand::Rng;
use wgpu_types::{CompareFunction, DepthBiasState, DepthStencilState, StencilState, TextureFormat};

use super::run::{Subject, Tally, compare};
use crate::crosscheck::raster::{of_llvmpipe_here, rasterise_color, rasterise_depth};
use crate::crosscheck::{Device, ReplayError};
use crate::format::depth::DepthKind;
use crate::format::{Codes, ColorFormat, DepthFormat};
use crate::model::llvmpipe::Llvmpipe;
use crate::model::{ColorInputs, NumericModel, same_codes};
use crate::scene::draw::SceneVertex;
use crate::scene::number::f64_to_f32;
use crate::scene::raster::{RasterState, assemble};
use crate::target::{ColorTarget, Extent};

/// Why a model is left out.
const NOT_MODELLED: &str = "only llvmpipe's rasteriser is modelled";

/// The same triangles on every run.
const SEED: u64 = 0x7a57;

/// Batches of triangles, and triangles of each. `REACH` is how many times as far as the target's edges they go.
const REACH: [f32; 4] = [1.0, 1.8, 3.0, 9.0];
const TRIANGLES: usize = 40;

/// Biases: constant, slope scale, clamp.
const BIASES: [(i32, f32, f32); 9] = [
    (0, 0.0, 0.0),
    (1, 0.0, 0.0),
    (-1, 0.0, 0.0),
    (5, 0.0, 0.0),
    (-9, 1.5, 0.0),
    (1000, -2.0, 0.001),
    (-70, -3.0, -0.002),
    (0, 1.0, 0.0),
    (333, 0.25, 0.0),
];

/// A vertex of a triangle that goes `reach` times as far as the target's edges.
fn vertex(random: &mut Rng, reach: f32) -> SceneVertex {
    let w = f64_to_f32(0.5 + 4.0 * random.f64());
    let mut signed = || (2.0 * random.f32() - 1.0) * reach * w;
    let (x, y) = (signed(), signed());
    let z = random.f32() * w;
    SceneVertex { position: [x, y, z, w], varyings: std::array::from_fn(|_| random.f32()) }
}

fn triangles(random: &mut Rng, reach: f32) -> Vec<[SceneVertex; 3]> {
    (0..TRIANGLES).map(|_| std::array::from_fn(|_| vertex(random, reach))).collect()
}

/// Draws triangles into a single color target.
pub(super) fn run(
    device: &Device,
    subjects: &[Subject],
    format: ColorFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    tally.leave_out_specifications("rasterisation is not judged");
    let mut random = Rng::with_seed(SEED);
    for reach in REACH {
        let triangles = triangles(&mut random, reach);
        let state = RasterState::new(Extent::new(120, 70)?);
        let drawn = rasterise_color(device, &triangles, &state, format.texture_format())?;
        let Some(Some(got)) = drawn.colors.first() else { continue };
        tally.texels += state.extent.sample_total() as u64;
        tally.states += 1;
        for (s, subject) in subjects.iter().enumerate() {
            let Some(model) = subject.llvmpipe else {
                tally.leave_out(s, NOT_MODELLED);
                continue;
            };
            let expected = predicted(&model, &triangles, &state, format)?;
            let place = |i: usize| {
                let i = u32::try_from(i).unwrap_or(u32::MAX);
                (i % state.extent.width, i / state.extent.width)
            };
            let codes = |target: &ColorTarget, i: usize| -> Codes {
                let (x, y) = place(i);
                target.codes(x, y, 0)
            };
            let compared =
                compare(state.extent.sample_total(), |i| same_codes(format, codes(&expected, i), codes(got, i)));
            tally.add(s, compared, |i| {
                let (at, expected, got) = (place(i), codes(&expected, i), codes(got, i));
                format!("triangles up to {reach} targets away, texel {at:?}: expected {expected:x?}, got {got:x?}")
            });
        }
    }
    Ok(())
}

/// What the model's rasteriser and stores leave of the triangles.
fn predicted(
    model: &Llvmpipe,
    triangles: &[[SceneVertex; 3]],
    state: &RasterState,
    format: ColorFormat,
) -> Result<ColorTarget, ReplayError> {
    let rasteriser = of_llvmpipe_here(model.generation);
    let guard_band = rasteriser.has_guard_band(Some(format.texture_format()));
    let state = RasterState { rasteriser, guard_band, ..*state };
    let mut target = ColorTarget::new(state.extent, format)?;
    for primitive in triangles.iter().flat_map(|triangle| assemble(*triangle, &state)) {
        for span in primitive.spans() {
            for x in span.start..span.end {
                let [r, g, b, a, ..] = primitive.varyings(x, span.y);
                let zeros = [0.0; 4];
                let dst = target.codes(x, span.y, 0);
                let src = [r, g, b, a];
                let inputs = ColorInputs { format, blend: None, constant: zeros, src, src1: zeros, dst };
                target.set_codes(x, span.y, 0, model.merge_color(&inputs));
            }
        }
    }
    Ok(target)
}

/// Draws biased triangles into a depth target.
pub(super) fn run_bias(
    device: &Device,
    subjects: &[Subject],
    format: TextureFormat,
    tally: &mut Tally<'_>,
) -> Result<(), ReplayError> {
    tally.leave_out_specifications("depth bias is not judged");
    let Some(kind) = DepthFormat::new(format).ok().and_then(DepthFormat::depth) else { return Ok(()) };
    let mut random = Rng::with_seed(SEED);
    for (constant, slope_scale, clamp) in BIASES {
        let bias = DepthBiasState { constant, slope_scale, clamp };
        let state = RasterState { bias, ..RasterState::new(Extent::new(100, 60)?) };
        let triangles = triangles(&mut random, 1.5);
        let depth_stencil = DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Always),
            stencil: StencilState::default(),
            bias,
        };
        let drawn = rasterise_depth(device, &triangles, &state, depth_stencil)?;
        let got = drawn.depth_stencil.as_ref().map_or(&[][..], |target| target.depth());
        tally.texels += got.len() as u64;
        tally.states += 1;
        for (s, subject) in subjects.iter().enumerate() {
            let Some(model) = subject.llvmpipe else {
                tally.leave_out(s, NOT_MODELLED);
                continue;
            };
            let expected = depth_codes(&model, &triangles, &state, kind);
            let compared = compare(got.len(), |i| got[i] == expected[i]);
            tally.add(s, compared, |i| {
                format!("{bias:?}, texel number {i}: expected {:#x}, got {:#x}", expected[i], got[i])
            });
        }
    }
    Ok(())
}

/// What the depth target holds in the end.
fn depth_codes(model: &Llvmpipe, triangles: &[[SceneVertex; 3]], state: &RasterState, kind: DepthKind) -> Vec<u32> {
    let own = RasterState { rasteriser: of_llvmpipe_here(model.generation), depth: Some(kind), ..*state };
    let mut codes = vec![0; state.extent.sample_total()];
    for primitive in triangles.iter().flat_map(|triangle| assemble(*triangle, &own)) {
        for span in primitive.spans() {
            for x in span.start..span.end {
                let z = primitive.depth(x, span.y);
                codes[state.extent.index(x, span.y, 0)] = model.depth_code(kind, z, state.depth_range);
            }
        }
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::llvmpipe::Generation;

    fn model(generation: Generation) -> Llvmpipe {
        Llvmpipe { generation, ..Llvmpipe::default() }
    }

    #[test]
    fn the_sweep_sees_the_guard_band() {
        let [old, middle, new] = Generation::ALL.map(model);
        let state = RasterState::new(Extent::new(120, 70).expect("legal"));
        let told_apart = |name: &str, a: &Llvmpipe, b: &Llvmpipe| {
            let format = ColorFormat::from_name(name).expect("a format");
            let mut random = Rng::with_seed(SEED);
            REACH.into_iter().any(|reach| {
                let triangles = triangles(&mut random, reach);
                let bytes = |model| predicted(model, &triangles, &state, format).expect("memory").bytes().to_vec();
                bytes(a) != bytes(b)
            })
        };
        assert!(told_apart("rgba8unorm", &old, &middle), "22.3 has none");
        for name in ["bgra8unorm", "rgba8unorm-srgb", "r8unorm"] {
            assert!(!told_apart(name, &old, &middle), "{name}: alike");
        }
        assert!(!told_apart("rgba8unorm", &middle, &new), "no change since");
    }

    #[test]
    fn the_sweep_sees_the_unit_of_the_bias() {
        let [old, middle, new] = Generation::ALL.map(model);
        let triangles = triangles(&mut Rng::with_seed(SEED), 1.5);
        for (kind, changed) in [(DepthKind::Unorm(16), true), (DepthKind::Unorm(24), true), (DepthKind::Float32, false)]
        {
            let biases = |changes: bool, a: &Llvmpipe, b: &Llvmpipe| {
                for (constant, slope_scale, clamp) in BIASES {
                    let bias = DepthBiasState { constant, slope_scale, clamp };
                    let state = RasterState { bias, ..RasterState::new(Extent::new(100, 60).expect("legal")) };
                    let [a, b] = [a, b].map(|model| depth_codes(model, &triangles, &state, kind));
                    // Where the clamp is reached the unit does not show.
                    let shows = changes && constant != 0 && clamp == 0.0;
                    assert!(clamp != 0.0 || (a != b) == shows, "{kind:?}, {bias:?}");
                }
            };
            biases(false, &old, &middle);
            biases(changed, &middle, &new);
        }
    }
}
