use proptest::prelude::*;
use wgpu_types::{DepthBiasState, Face, FrontFace};

use super::*;

const SIZE: u32 = 24;

fn extent() -> Extent {
    Extent::new(SIZE, SIZE).expect("24 x 24 is a legal extent")
}

fn state() -> RasterState {
    RasterState::new(extent())
}

/// A vertex at window position (x, y) in pixels, depth 0.5, w 1.
fn at(x: f64, y: f64) -> Vertex<0> {
    use crate::scene::number::f64_to_f32;
    let half = f64::from(SIZE) / 2.0;
    Vertex { position: [f64_to_f32(x / half - 1.0), f64_to_f32(1.0 - y / half), 0.5, 1.0], varyings: [] }
}

/// How often each pixel is covered, rows from the top.
fn hits<const N: usize>(triangles: &[[Vertex<N>; 3]], state: &RasterState) -> Vec<u32> {
    let mut counts = vec![0; state.extent.sample_total()];
    for triangle in triangles {
        for primitive in assemble(*triangle, state) {
            for span in primitive.spans() {
                assert!(span.end <= state.extent.width, "span {span:?} leaves the target");
                for x in span.start..span.end {
                    counts[state.extent.index(x, span.y, 0)] += 1;
                }
            }
        }
    }
    counts
}

fn quad(x0: f64, y0: f64, x1: f64, y1: f64) -> [[Vertex<0>; 3]; 2] {
    let [a, b, c, d] = [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)];
    [[a, b, c], [a, c, d]]
}

#[test]
fn full_screen_quad_covers_every_pixel_once() {
    let size = f64::from(SIZE);
    for (reach, name) in [(0.0, "exact"), (7.3, "overhanging"), (1e6, "far beyond the guard band")] {
        for rasteriser in rasterisers() {
            let state = RasterState { rasteriser, ..state() };
            let counts = hits(&quad(-reach, -reach, size + reach, size + reach), &state);
            assert!(counts.iter().all(|&count| count == 1), "{name}, {rasteriser:?}: {counts:?}");
        }
    }
}

#[test]
fn pixel_centres_on_top_and_left_edges_are_inside_and_on_bottom_and_right_edges_outside() {
    let counts = hits(&quad(2.5, 3.5, 5.5, 7.5), &state());
    for y in 0..SIZE {
        for x in 0..SIZE {
            let inside = (2..5).contains(&x) && (3..7).contains(&y);
            let index = extent().index(x, y, 0);
            assert_eq!(counts[index], u32::from(inside), "pixel ({x}, {y}): the quad spans [2.5, 5.5) x [3.5, 7.5)");
        }
    }
}

#[test]
fn vertices_snap_to_the_grid_of_the_target_with_ties_to_even() {
    let columns = |left: f64, bits: u8| {
        let state = RasterState { subpixel_bits: bits, ..state() };
        let counts = hits(&quad(left, 0.0, 12.0, 24.0), &state);
        (0..SIZE).find(|x| counts[extent().index(*x, 4, 0)] == 1).expect("something is covered")
    };
    // A quad covers column 2 when its left edge is snapped to 2.5 or less. Steps are 1/16 and 1/256 of a pixel.
    for (sixteenths, four, eight) in [(0.0, 2, 2), (0.49, 2, 3), (0.5, 2, 3), (0.51, 3, 3), (1.0, 3, 3)] {
        let left = 2.5 + sixteenths / 16.0;
        assert_eq!(columns(left, 4), four, "4 bits, {sixteenths} of a step");
        assert_eq!(columns(left, 8), eight, "8 bits, {sixteenths} of a step");
    }
    // Half-way between two steps, the even one: 1.5 steps go up to 2, half a step down to 0.
    let before = |steps: f64| columns(3.5 - steps / 16.0, 4);
    assert_eq!(
        [before(0.5), before(0.51), before(1.5)],
        [3, 3, 3],
        "an edge at or left of column 3's centre covers it"
    );
    assert_eq!(columns(3.5 + 1.5 / 16.0, 4), 4, "2 steps beyond");
}

#[test]
fn culling_removes_exactly_one_of_the_two_windings() {
    let ccw = [at(2.0, 20.0), at(20.0, 20.0), at(2.0, 2.0)];
    let cw = [ccw[0], ccw[2], ccw[1]];
    for (front_face, cull_mode, ccw_drawn, cw_drawn) in [
        (FrontFace::Ccw, None, true, true),
        (FrontFace::Ccw, Some(Face::Back), true, false),
        (FrontFace::Ccw, Some(Face::Front), false, true),
        (FrontFace::Cw, Some(Face::Back), false, true),
        (FrontFace::Cw, Some(Face::Front), true, false),
    ] {
        let mut state = state();
        state.primitive.front_face = front_face;
        state.primitive.cull_mode = cull_mode;
        let drawn = |triangle| !assemble::<0>(triangle, &state).is_empty();
        assert_eq!(drawn(ccw), ccw_drawn, "counter-clockwise, {front_face:?}, cull {cull_mode:?}");
        assert_eq!(drawn(cw), cw_drawn, "clockwise, {front_face:?}, cull {cull_mode:?}");
    }
    let primitive = &assemble(ccw, &state())[0];
    assert!(primitive.front_facing(), "counter-clockwise is the front by default");
}

#[test]
fn clipping_at_the_near_plane_keeps_what_lies_in_front_of_it() {
    // z = 0 at window row 12: the part above it is in front of the near plane's visible side.
    let vertex = |x: f32, y: f32| Vertex { position: [x, y, y, 1.0], varyings: [] };
    let triangles = [
        [vertex(-1.0, 1.0), vertex(1.0, 1.0), vertex(1.0, -1.0)],
        [vertex(-1.0, 1.0), vertex(1.0, -1.0), vertex(-1.0, -1.0)],
    ];
    let counts = hits::<0>(&triangles, &state());
    for (i, count) in counts.iter().enumerate() {
        assert_eq!(*count, u32::from(i < 12 * 24), "pixel {i}: z >= 0 holds in the upper half only");
    }
    let mut unclipped = state();
    unclipped.primitive.unclipped_depth = true;
    assert!(hits::<0>(&triangles, &unclipped).iter().all(|&count| count == 1), "unclipped depth keeps all of it");
}

#[test]
fn varyings_are_perspective_correct() {
    // Left edge at w = 1, right edge at w = 3: u/w and 1/w are linear in x, u is not.
    let vertex = |x: f32, y: f32, w: f32, u: f32| Vertex { position: [x * w, y * w, 0.0, w], varyings: [u] };
    let [a, b, c] = [vertex(-1.0, 1.0, 1.0, 0.0), vertex(1.0, 1.0, 3.0, 1.0), vertex(-1.0, -1.0, 1.0, 0.0)];
    let primitive = &assemble([a, b, c], &state())[0];
    for x in 0..SIZE {
        let t = (f64::from(x) + 0.5) / f64::from(SIZE);
        let expected = (t / 3.0) / ((1.0 - t) + t / 3.0);
        let [got] = primitive.varyings(x, 0);
        assert!((f64::from(got) - expected).abs() < 1e-7, "column {x}: u = {got}, expected {expected}");
    }
}

#[test]
fn depth_is_linear_on_the_screen_and_exact_where_vertices_agree() {
    let vertex = |x: f32, y: f32, z: f32| Vertex { position: [x, y, z, 1.0], varyings: [] };
    let flat = &assemble::<0>([vertex(-1.0, 1.0, 0.3), vertex(1.0, 1.0, 0.3), vertex(-1.0, -1.0, 0.3)], &state())[0];
    let slope = &assemble::<0>([vertex(-1.0, 1.0, 0.0), vertex(1.0, 1.0, 1.0), vertex(-1.0, -1.0, 0.0)], &state())[0];
    for x in 0..SIZE {
        assert_eq!(flat.depth(x, 1).to_bits(), 0.3_f32.to_bits(), "column {x} of a flat triangle");
        let expected = (f64::from(x) + 0.5) / f64::from(SIZE);
        let got = f64::from(slope.depth(x, 1));
        assert!((got - expected).abs() < 1e-7, "column {x}: {got} for {expected}");
    }
}

#[test]
fn depth_bias_counts_units_of_the_depth_format_and_slopes_and_obeys_its_clamp() {
    let vertex = |x: f32, y: f32, z: f32| Vertex { position: [x, y, z, 1.0], varyings: [] };
    let triangle = [vertex(-1.0, 1.0, 0.25), vertex(1.0, 1.0, 0.75), vertex(-1.0, -1.0, 0.25)];
    let bias = |kind, constant, slope_scale, clamp| {
        let mut state = state();
        state.depth = Some(kind);
        state.bias = DepthBiasState { constant, slope_scale, clamp };
        assemble::<0>(triangle, &state)[0].bias
    };
    assert_eq!(bias(DepthKind::Unorm(16), 3, 0.0, 0.0), 3.0 * (1.0 / 65535.0), "three steps of 16-bit depth");
    assert_eq!(bias(DepthKind::Float32, 1, 0.0, 0.0), 2.0_f32.powi(-24), "ulp of the largest depth, 0.75");
    assert_eq!(bias(DepthKind::Unorm(16), 0, 2.0, 0.0), 2.0 * 0.5 / 24.0, "depth rises by 0.5 over 24 pixels");
    assert_eq!(bias(DepthKind::Unorm(16), 0, 2.0, 0.01), 0.01, "a positive clamp limits from above");
    assert_eq!(bias(DepthKind::Unorm(16), 0, -2.0, -0.01), -0.01, "a negative clamp limits from below");
    assert_eq!(bias(DepthKind::Unorm(16), 0, -2.0, 0.01), -2.0 * 0.5 / 24.0, "a positive clamp ignores negative bias");
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -2.0_f32..2.0,
        2 => any::<u32>().prop_map(f32::from_bits),
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(f32::NAN), Just(f32::INFINITY), Just(f32::MIN_POSITIVE), Just(f32::MAX)],
    ]
}

fn any_vertex() -> impl Strategy<Value = Vertex<2>> {
    (prop::array::uniform4(any_float()), prop::array::uniform2(any_float()))
        .prop_map(|(position, varyings)| Vertex { position, varyings })
}

/// A vertex inside the guard band, in front of the near plane.
fn visible_vertex() -> impl Strategy<Value = Vertex<1>> {
    (prop::array::uniform2(-1.5_f32..1.5), 0.0_f32..1.0, 0.01_f32..100.0, -1.0_f32..1.0)
        .prop_map(|([x, y], z, w, u)| Vertex { position: [x * w, y * w, z * w, w], varyings: [u] })
}

/// Positions on a grid of quarter pixels, so that many pixel centres fall on edges.
fn grid_point() -> impl Strategy<Value = (f64, f64)> {
    (-20_i32..120, -20_i32..120).prop_map(|(x, y)| (f64::from(x) / 4.0, f64::from(y) / 4.0))
}

proptest! {
    #[test]
    fn any_floats_rasterise_without_panic_and_within_the_target(
        triangle in prop::array::uniform3(any_vertex()), unclipped in any::<bool>()
    ) {
        for rasteriser in rasterisers() {
            let mut state = RasterState { rasteriser, ..state() };
            state.primitive.unclipped_depth = unclipped;
            for primitive in assemble(triangle, &state) {
                for span in primitive.spans() {
                    prop_assert!(span.start < span.end && span.end <= SIZE && span.y < SIZE, "{:?}", span);
                    let depth = primitive.depth(span.start, span.y);
                    // Where an area rounds to 0 in binary32, the driver's planes are NaN.
                    let planes = rasteriser != Rasteriser::Reference;
                    prop_assert!(planes || !depth.is_nan(), "finite vertices have a depth");
                    let _ = primitive.varyings(span.start, span.y);
                }
            }
        }
    }

    /// A fan around an inner point tiles its convex outline: no gap inside, no pixel twice, whatever the inner point.
    #[test]
    fn shared_edges_are_covered_exactly_once(
        centre in (6_i32..90, 6_i32..90), reach in 1.0_f64..20.0, turns in prop::collection::vec(0.05_f64..1.0, 3..9)
    ) {
        let (cx, cy) = (f64::from(centre.0) / 4.0, f64::from(centre.1) / 4.0);
        let total: f64 = turns.iter().sum();
        // Snapped to the sub-pixel grid, so that the float positions are what is rasterised.
        let grid = |v: f64| (v * 64.0).round() / 64.0;
        let mut angle = 0.0;
        let rim: Vec<_> = turns.iter().map(|turn| {
            angle += turn / total * std::f64::consts::TAU;
            (grid(cx + reach * f64::cos(angle)), grid(cy + reach * f64::sin(angle)))
        }).collect();
        let fan = |inner: (f64, f64)| -> Vec<_> {
            (0..rim.len()).map(|i| {
                let next = rim[(i + 1) % rim.len()];
                [at(inner.0, inner.1), at(rim[i].0, rim[i].1), at(next.0, next.1)]
            }).collect()
        };
        // Fanned from a rim vertex the same outline has other inner edges.
        let from_rim: Vec<_> = (1..rim.len() - 1).map(|i| {
            [at(rim[0].0, rim[0].1), at(rim[i].0, rim[i].1), at(rim[i + 1].0, rim[i + 1].1)]
        }).collect();
        // Inner edges with turns above half a circle would fold the fan over its outline.
        prop_assume!(turns.iter().all(|turn| turn / total < 0.49));
        let inside = hits(&fan((cx, cy)), &state());
        prop_assert!(inside.iter().all(|&count| count <= 1), "a pixel is covered twice");
        prop_assert_eq!(inside, hits(&from_rim, &state()), "two triangulations of one outline differ");
    }

    /// Four random points: the two triangles on either side of a shared edge never both own a pixel.
    #[test]
    fn triangles_on_both_sides_of_an_edge_share_no_pixel(
        a in grid_point(), b in grid_point(), c in grid_point(), d in grid_point()
    ) {
        let side = |p: (f64, f64)| (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
        prop_assume!(side(c) * side(d) < 0.0);
        let p = |p: (f64, f64)| at(p.0, p.1);
        let counts = hits(&[[p(a), p(b), p(c)], [p(a), p(b), p(d)]], &state());
        prop_assert!(counts.iter().all(|&count| count <= 1), "a pixel is covered twice");
    }

    /// Unclipped triangles: clipping may triangulate what is left in another way.
    #[test]
    fn coverage_and_values_do_not_depend_on_the_first_vertex(triangle in prop::array::uniform3(visible_vertex())) {
        let [a, b, c] = triangle;
        let counts = hits(&[[a, b, c]], &state());
        for (order, name) in [([b, c, a], "rotated once"), ([c, a, b], "rotated twice"), ([a, c, b], "mirrored")] {
            prop_assert_eq!(&counts, &hits(&[order], &state()), "{}", name);
            for (p, q) in assemble([a, b, c], &state()).iter().zip(assemble(order, &state())) {
                for span in p.spans() {
                    let (u, v) = (p.varyings(span.start, span.y)[0], q.varyings(span.start, span.y)[0]);
                    prop_assert!((u - v).abs() <= 1e-6 * u.abs().max(1.0), "{}: {} and {}", name, u, v);
                }
            }
        }
    }
}

/// Depth and a varying of a cut triangle as llvmpipe read them back, with fused instructions and without
/// (`GALLIUM_OVERRIDE_CPU_CAPS=sse4.1`). `tests/crosscheck/raster.rs` compares a million more.
#[test]
fn a_cut_triangle_has_the_bits_recorded_from_llvmpipe() {
    let vertex = |x, y, z, w, varying| Vertex { position: [x, y, z, w], varyings: [varying] };
    let triangle =
        [vertex(-0.9, 0.8, 0.3, 1.0, 0.1), vertex(1.7, 0.55, 0.65, 1.3, 0.7), vertex(-0.21, -2.9, 1.1, 2.3, 0.4)];
    let fused = [
        (4, 6, 0x3eae_986a, 0x3e21_3bdb),
        (11, 9, 0x3ecd_db85, 0x3ea0_74c4),
        (20, 7, 0x3ee8_67ad, 0x3f04_ff21),
        (10, 22, 0x3ee8_add1, 0x3eb0_fc9c),
    ];
    let unfused = [
        (4, 6, 0x3eae_986a, 0x3e21_3bdb),
        (11, 9, 0x3ecd_db85, 0x3ea0_74c4),
        (20, 7, 0x3ee8_67ac, 0x3f04_ff20),
        (10, 22, 0x3ee8_add0, 0x3eb0_fc97),
    ];
    let newest = Generation::default();
    for (rasteriser, recorded) in
        [(Rasteriser::Llvmpipe(newest), fused), (Rasteriser::LlvmpipeUnfused(newest), unfused)]
    {
        let parts = assemble(triangle, &RasterState { rasteriser, ..state() });
        assert!(parts.len() > 1, "cut, so a fan: {}", parts.len());
        for (x, y, depth, varying) in recorded {
            let covers =
                |part: &&Primitive<1>| part.spans().any(|span| span.y == y && (span.start..span.end).contains(&x));
            let part = parts.iter().find(covers).expect("the texel is covered");
            let bits = (part.depth(x, y).to_bits(), part.varyings(x, y)[0].to_bits());
            assert_eq!(bits, (depth, varying), "({x}, {y}), {rasteriser:?}");
        }
    }
}

#[test]
fn a_coplanar_bias_unit_of_unorm_depth_is_two_codes_in_older_llvmpipes_and_one_and_a_half_in_the_newest() {
    let depth = Some(DepthKind::Unorm(16));
    let biased = |generation, constant: i32| {
        let bias = DepthBiasState { constant, ..DepthBiasState::default() };
        let state = RasterState { rasteriser: Rasteriser::Llvmpipe(generation), bias, depth, ..state() };
        assemble([at(2.0, 2.0), at(20.0, 2.0), at(2.0, 20.0)], &state)[0].depth(4, 4)
    };
    let code = 1.0 / 65_535.0;
    for older in [Generation::Mesa22_3, Generation::Mesa25_0] {
        // Vulkan admits a minimum resolvable difference of 2 x 2^-16.
        assert_eq!([1, -3].map(|c| biased(older, c)), [0.5 + 2.0 * code, 0.5 - 6.0 * code], "{older}");
    }
    assert_eq!([1, -3].map(|c| biased(Generation::Mesa26_1, c)), [0.5 + 1.5 * code, 0.5 - 3.5 * code]);
}

/// The reference, and every generation's, fused and not.
fn rasterisers() -> impl Iterator<Item = Rasteriser> {
    let of = |generation| [Rasteriser::Llvmpipe(generation), Rasteriser::LlvmpipeUnfused(generation)];
    std::iter::once(Rasteriser::Reference).chain(Generation::ALL.into_iter().flat_map(of))
}

#[test]
fn only_named_formats_alone_have_a_guard_band() {
    use TextureFormat as T;
    for (generation, with) in [
        (Generation::Mesa22_3, &[T::Bgra8Unorm][..]),
        (Generation::Mesa25_0, &[T::Bgra8Unorm, T::Rgba8Unorm]),
        (Generation::Mesa26_1, &[T::Bgra8Unorm, T::Rgba8Unorm]),
    ] {
        for format in [T::Bgra8Unorm, T::Rgba8Unorm, T::Rgba8UnormSrgb, T::R8Unorm, T::Rgba16Float] {
            let has = Rasteriser::Llvmpipe(generation).has_guard_band(Some(format));
            assert_eq!(has, with.contains(&format), "{format:?}, {generation}");
        }
        assert!(!Rasteriser::Llvmpipe(generation).has_guard_band(None), "several targets");
    }
}
