//! The device's rasteriser against [`outmerge::scene::raster`]: the same triangles, texel by texel.

use outmerge::Extent;
use outmerge::crosscheck::Device;
use outmerge::crosscheck::raster::{Covered, of_llvmpipe_here, rasterise, rasterise_color, rasterise_depth};
use outmerge::format::depth::{DepthFormat, DepthKind};
use outmerge::model::llvmpipe::Llvmpipe;
use outmerge::model::{ColorInputs, NumericModel};
use outmerge::scene::draw::{SceneVertex, VARYINGS};
use outmerge::scene::raster::{RasterState, Rasteriser, Span, assemble};
use outmerge::target::ColorTarget;
use wgpu_types::{
    CompareFunction, DepthBiasState, DepthStencilState, Face, FrontFace, PrimitiveState, StencilState, TextureFormat,
};

use crate::harness::{llvmpipe, model};
use crate::scenes;

/// What the model says of one texel after all triangles, and how steep its values are there.
#[derive(Clone, Copy, Default)]
struct Predicted {
    covered: Covered,
    /// Change of depth, and of each varying, over one sub-pixel to the right plus one down.
    depth_step: f32,
    varying_steps: [f32; VARYINGS],
}

fn predict(triangles: &[[SceneVertex; 3]], state: &RasterState) -> Vec<Predicted> {
    let mut texels = vec![Predicted::default(); state.extent.sample_total()];
    for primitive in triangles.iter().flat_map(|triangle| assemble(*triangle, state)) {
        for span in primitive.spans() {
            for x in span.start..span.end {
                let y = span.y;
                let texel = &mut texels[state.extent.index(x, y, 0)];
                let step = |at: f32, right: f32, down: f32| ((right - at).abs() + (down - at).abs()) / 256.0;
                let [at, right, down] = [(x, y), (x + 1, y), (x, y + 1)].map(|(x, y)| primitive.varyings(x, y));
                *texel = Predicted {
                    covered: Covered {
                        count: texel.covered.count + 1,
                        depth: primitive.depth(x, y),
                        front_facing: primitive.front_facing(),
                        varyings: at,
                    },
                    depth_step: step(primitive.depth(x, y), primitive.depth(x + 1, y), primitive.depth(x, y + 1)),
                    varying_steps: std::array::from_fn(|i| step(at[i], right[i], down[i])),
                };
            }
        }
    }
    texels
}

/// How interpolated values differ.
#[derive(Debug, Default)]
struct Distance {
    values: u64,
    equal_bits: u64,
    sum: f64,
    largest: f32,
    /// The largest difference left over when the value may be taken at a point up to one sub-pixel away; relative to
    /// values above 1, as their rounding is.
    beyond_a_subpixel: f32,
}

impl Distance {
    fn add(&mut self, model: f32, device: f32, step: f32) {
        let distance = (model - device).abs();
        self.values += 1;
        self.equal_bits += u64::from(model.to_bits() == device.to_bits());
        self.sum += f64::from(distance);
        self.largest = self.largest.max(distance);
        self.beyond_a_subpixel = self.beyond_a_subpixel.max((distance - step) / model.abs().max(1.0));
    }
}

impl std::fmt::Display for Distance {
    #[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (values, equal) = (self.values.max(1) as f64, self.equal_bits as f64);
        let (share, mean, largest, rest) =
            (100.0 * equal / values, self.sum / values, self.largest, self.beyond_a_subpixel);
        write!(f, "{share:.1} % equal, mean {mean:.1e}, largest {largest:.1e}, beyond a sub-pixel {rest:.1e}")
    }
}

/// How two lists of texels differ.
#[derive(Debug, Default)]
struct Difference {
    texels: usize,
    coverage: usize,
    facing: usize,
    depth: Distance,
    varyings: Distance,
}

impl Difference {
    fn add(&mut self, model: &[Predicted], device: &[Covered]) {
        for (predicted, device) in model.iter().zip(device).filter(|(a, b)| a.covered.count + b.count > 0) {
            let model = predicted.covered;
            self.texels += 1;
            if model.count != device.count {
                self.coverage += 1;
                continue;
            }
            self.facing += usize::from(model.front_facing != device.front_facing);
            self.depth.add(model.depth, device.depth, predicted.depth_step);
            for i in 0..VARYINGS {
                self.varyings.add(model.varyings[i], device.varyings[i], predicted.varying_steps[i]);
            }
        }
    }
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { texels, coverage, facing, depth, varyings } = self;
        write!(
            f,
            "{texels} texels, {coverage} covered differently, {facing} facing differently; depth: {depth}; varyings: {varyings}"
        )
    }
}

fn compare(device: &Device, triangles: &[[SceneVertex; 3]], state: &RasterState, total: &mut Difference) {
    let got = rasterise(device, triangles, state).unwrap_or_else(|error| panic!("{error}"));
    total.add(&predict(triangles, state), &got);
    expect_bits(device, triangles, state, &got);
}

/// Counts, depths, facing and varyings must have the bits of the driver's own rasteriser.
fn expect_bits(device: &Device, triangles: &[[SceneVertex; 3]], state: &RasterState, got: &[Covered]) {
    // The probe draws into several targets.
    let own = RasterState { rasteriser: of_llvmpipe_here(model(device).generation), guard_band: false, ..*state };
    for (i, (model, device)) in predict(triangles, &own).iter().zip(got).enumerate() {
        let model = &model.covered;
        let bits = |covered: &Covered| {
            let varyings = covered.varyings.map(f32::to_bits);
            (covered.count, covered.front_facing, covered.depth.to_bits(), varyings)
        };
        assert!(bits(model) == bits(device), "texel {i}, {state:?}: expected {model:?}, got {device:?}");
    }
}

/// A fixed sequence of numbers in [0, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f32::from(u16::try_from(self.0 >> 48).expect("16 bits")) / 65_536.0
    }

    /// Two triangles of a rectangle whose varyings are one plane each.
    fn rectangle(&mut self) -> [[SceneVertex; 3]; 2] {
        let mut side = || {
            let (a, b) = (2.0 * self.next() - 1.0, 2.0 * self.next() - 1.0);
            (a.min(b), a.max(b))
        };
        let ((left, right), (bottom, top)) = (side(), side());
        let slopes: [[f32; 2]; VARYINGS] = std::array::from_fn(|_| [0.4 * self.next(), 0.4 * self.next()]);
        let corner = |x: f32, y: f32| SceneVertex {
            position: [x, y, 0.5, 1.0],
            varyings: slopes.map(|[dx, dy]| 0.5 + dx * x + dy * y),
        };
        let [a, b, c, d] = [corner(left, top), corner(left, bottom), corner(right, bottom), corner(right, top)];
        [[a, b, c], [a, c, d]]
    }

    fn triangle(&mut self, reach: f32, perspective: bool, clipped: bool) -> [SceneVertex; 3] {
        std::array::from_fn(|_| {
            let w = if perspective { 0.5 + 4.0 * self.next() } else { 1.0 };
            let mut signed = || (2.0 * self.next() - 1.0) * reach * w;
            let (x, y) = (signed(), signed());
            let z = if clipped { 2.0 * self.next() - 0.5 } else { self.next() } * w;
            SceneVertex { position: [x, y, z, w], varyings: std::array::from_fn(|_| self.next()) }
        })
    }
}

/// Rounding left when both sides interpolate the same plane, relative to values above 1: the device adds the plane up in
/// binary32, some of it cancels.
const ROUNDING: f32 = 3e-6;

#[test]
fn coverage_of_triangles_inside_the_target_is_the_devices() {
    let Some(device) = llvmpipe() else { return };
    let mut numbers = Numbers(1);
    for (width, height, perspective) in [(64, 64, false), (64, 64, true), (100, 37, false), (255, 129, true)] {
        let state = RasterState::new(Extent::new(width, height).expect("a legal extent"));
        let mut total = Difference::default();
        for _ in 0..10 {
            let triangles: Vec<_> = (0..60).map(|_| numbers.triangle(1.0, perspective, false)).collect();
            compare(device, &triangles, &state, &mut total);
        }
        println!("{width} x {height}, perspective {perspective}: {total}");
        // The reference always fuses the viewport's last step.
        let fused = matches!(of_llvmpipe_here(model(device).generation), Rasteriser::Llvmpipe(_));
        let allowed = if fused { 0 } else { 1 };
        assert!(total.coverage <= allowed && total.facing == 0, "texels covered or facing differently: {total}");
        assert!(total.depth.beyond_a_subpixel <= ROUNDING, "depth is linear: {total}");
    }
}

/// llvmpipe cuts triangles at the edges of the target and snaps the new corners to its grid; the model's guard band
/// leaves them whole. Both are allowed, so a few texels along edges that run out of the picture differ.
#[test]
fn triangles_that_leave_the_target_are_covered_alike_but_for_one_texel_in_a_thousand() {
    let Some(device) = llvmpipe() else { return };
    let mut numbers = Numbers(2);
    for (reach, clipped) in [(3.0, false), (1.0, true), (3.0, true), (40.0, false)] {
        let state = RasterState::new(Extent::new(128, 96).expect("a legal extent"));
        let mut total = Difference::default();
        for _ in 0..10 {
            let triangles: Vec<_> = (0..60).map(|_| numbers.triangle(reach, true, clipped)).collect();
            compare(device, &triangles, &state, &mut total);
        }
        println!("reach {reach}, near or far plane {clipped}: {total}");
        assert!(1000 * total.coverage <= total.texels, "more than one texel in a thousand: {total}");
        assert_eq!(total.facing, 0, "facing: {total}");
    }
}

#[test]
fn scenes_are_covered_alike_and_interpolated_within_a_sub_pixel() {
    let Some(device) = llvmpipe() else { return };
    let mut wrong = Vec::new();
    let mut all = Difference::default();
    for (name, scene) in scenes::all() {
        let mut total = Difference::default();
        for draw in scene.draws() {
            let got = rasterise(device, &draw.triangles, &draw.raster).unwrap_or_else(|error| panic!("{error}"));
            let predicted = predict(&draw.triangles, &draw.raster);
            expect_bits(device, &draw.triangles, &draw.raster, &got);
            total.add(&predicted, &got);
            all.add(&predicted, &got);
        }
        println!("{name}: {total}");
        let rest = total.depth.beyond_a_subpixel.max(total.varyings.beyond_a_subpixel);
        if total.coverage + total.facing > 0 || rest > ROUNDING {
            wrong.push(format!("{name}: {total}"));
        }
    }
    println!("all: {all}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn culling_and_depth_ranges_are_the_devices_to_the_bit() {
    let Some(device) = llvmpipe() else { return };
    let mut numbers = Numbers(3);
    let extent = Extent::new(96, 80).expect("a legal extent");
    for front_face in [FrontFace::Ccw, FrontFace::Cw] {
        for cull_mode in [None, Some(Face::Front), Some(Face::Back)] {
            for depth_range in [[0.0, 1.0], [0.25, 0.3], [0.9, 1.0]] {
                let primitive = PrimitiveState { front_face, cull_mode, ..PrimitiveState::default() };
                let state = RasterState { primitive, depth_range, ..RasterState::new(extent) };
                for reach in [1.0, 3.0] {
                    let triangles: Vec<_> = (0..40).map(|_| numbers.triangle(reach, true, reach > 2.0)).collect();
                    let got = rasterise(device, &triangles, &state).unwrap_or_else(|error| panic!("{error}"));
                    assert!(got.iter().any(|texel| texel.count > 0), "something is drawn");
                    expect_bits(device, &triangles, &state, &got);
                }
            }
        }
    }
}

/// What the depth target holds in the end, by the driver's rasteriser and its model's depth codes.
fn depth_codes(model: &Llvmpipe, triangles: &[[SceneVertex; 3]], state: &RasterState, kind: DepthKind) -> Vec<u32> {
    let own = RasterState { rasteriser: of_llvmpipe_here(model.generation), depth: Some(kind), ..*state };
    let mut codes = vec![0; state.extent.sample_total()];
    for primitive in triangles.iter().flat_map(|triangle| assemble(*triangle, &own)) {
        for Span { y, start, end } in primitive.spans() {
            for x in start..end {
                codes[state.extent.index(x, y, 0)] = model.depth_code(kind, primitive.depth(x, y), state.depth_range);
            }
        }
    }
    codes
}

#[test]
fn interpolated_and_biased_depth_is_stored_as_the_device_does_to_the_bit() {
    let Some(device) = llvmpipe() else { return };
    let mut numbers = Numbers(4);
    let biases =
        [(0, 0.0, 0.0), (5, 0.0, 0.0), (-9, 1.5, 0.0), (1000, -2.0, 0.001), (-70, -3.0, -0.002), (0, 1.0, 0.0)];
    for format in [TextureFormat::Depth16Unorm, TextureFormat::Depth24Plus, TextureFormat::Depth32Float] {
        let kind = DepthFormat::new(format).ok().and_then(DepthFormat::depth).expect("a depth format");
        for (constant, slope_scale, clamp) in biases {
            let bias = DepthBiasState { constant, slope_scale, clamp };
            let state = RasterState { bias, ..RasterState::new(Extent::new(100, 60).expect("a legal extent")) };
            let triangles: Vec<_> = (0..60).map(|i| numbers.triangle(1.5, true, i % 2 == 0)).collect();
            let depth_stencil = DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::Always),
                stencil: StencilState::default(),
                bias,
            };
            let got =
                rasterise_depth(device, &triangles, &state, depth_stencil).unwrap_or_else(|error| panic!("{error}"));
            let got = got.depth_stencil.as_ref().expect("a depth target").depth().to_vec();
            let expected = depth_codes(&model(device), &triangles, &state, kind);
            let wrong = expected.iter().zip(&got).filter(|(a, b)| a != b).count();
            let first = expected.iter().zip(&got).find(|(a, b)| a != b);
            assert_eq!(wrong, 0, "{format:?}, {bias:?}: of {} texels; first {first:?}", got.len());
        }
    }
}

/// With 8-bit BGRA, in newer versions RGBA as well, alone and without depth, llvmpipe has a guard band, and may join pairs of
/// triangles to rectangles.
#[test]
fn colors_on_a_single_target_are_the_devices_to_the_byte() {
    let Some(device) = llvmpipe() else { return };
    let mut numbers = Numbers(5);
    for format in [
        TextureFormat::Rgba8Unorm,
        TextureFormat::Rgba8UnormSrgb,
        TextureFormat::R8Unorm,
        TextureFormat::Rgba16Float,
        TextureFormat::Bgra8Unorm,
    ] {
        let extent = Extent::new(120, 70).expect("a legal extent");
        let rasteriser = of_llvmpipe_here(model(device).generation);
        let guard_band = rasteriser.has_guard_band(Some(format));
        let state = RasterState { rasteriser, guard_band, ..RasterState::new(extent) };
        for reach in [0.0, 1.0, 1.8, 3.0, 9.0] {
            let triangles: Vec<_> = if reach == 0.0 {
                (0..20).flat_map(|_| numbers.rectangle()).collect()
            } else {
                (0..60).map(|_| numbers.triangle(reach, reach > 2.0, false)).collect()
            };
            let got = rasterise_color(device, &triangles, &state, format).unwrap_or_else(|error| panic!("{error}"));
            let got = got.colors[0].as_ref().expect("a target");
            let mut expected = ColorTarget::new(state.extent, got.format()).expect("memory");
            for primitive in triangles.iter().flat_map(|triangle| assemble(*triangle, &state)) {
                for Span { y, start, end } in primitive.spans() {
                    for x in start..end {
                        let [r, g, b, a, ..] = primitive.varyings(x, y);
                        let (format, blend) = (got.format(), None);
                        let inputs = ColorInputs {
                            format,
                            blend,
                            constant: [0.0; 4],
                            src: [r, g, b, a],
                            src1: [0.0; 4],
                            dst: expected.codes(x, y, 0),
                        };
                        expected.set_codes(x, y, 0, model(device).merge_color(&inputs));
                    }
                }
            }
            let texels = (0..state.extent.height).flat_map(|y| (0..state.extent.width).map(move |x| (x, y)));
            let wrong: Vec<_> = texels.filter(|(x, y)| expected.codes(*x, *y, 0) != got.codes(*x, *y, 0)).collect();
            let first = wrong.first().map(|(x, y)| (x, y, expected.codes(*x, *y, 0), got.codes(*x, *y, 0)));
            assert!(wrong.is_empty(), "{format:?}, reach {reach}: {} texels; first {first:?}", wrong.len());
        }
    }
}
