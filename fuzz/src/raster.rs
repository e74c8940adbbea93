//! Triangles of arbitrary floats: no panic, spans inside the target, coverage that does not depend on the winding, and a
//! shared edge without double coverage.

use std::collections::HashSet;

use outmerge::Extent;
use outmerge::format::depth::DepthKind;
use outmerge::model::llvmpipe::Generation;
use outmerge::scene::raster::{RasterState, Rasteriser, Vertex, assemble};
use wgpu_types::{DepthBiasState, Face, FrontFace};

use super::input::Input;

type Pixels = HashSet<(u32, u32)>;

pub fn check(data: &[u8]) {
    let mut input = Input::new(data);
    let extent = Extent::new(1 + u32::from(input.byte()) % 64, 1 + u32::from(input.byte()) % 64).expect("small");
    let mut state = RasterState::new(extent);
    state.depth_range = input.pick(&[[0.0, 1.0], [0.25, 0.75], [0.5, 0.5]]);
    state.primitive.front_face = input.pick(&[FrontFace::Ccw, FrontFace::Cw]);
    state.primitive.cull_mode = input.pick(&[None, None, Some(Face::Front), Some(Face::Back)]);
    state.primitive.unclipped_depth = input.bool();
    state.depth = input.pick(&[None, Some(DepthKind::Unorm(16)), Some(DepthKind::Unorm(24)), Some(DepthKind::Float32)]);
    let constant = i32::from_le_bytes(input.array());
    state.bias = DepthBiasState { constant, slope_scale: input.number(), clamp: input.number() };
    let [a, b, c, d] = std::array::from_fn(|_| vertex(&mut input));
    let drawn = pixels([a, b, c], &state);

    state.primitive.cull_mode = None;
    let all = pixels([a, b, c], &state);
    let whole = [a, b, c, d].iter().all(inside);
    if whole {
        assert_eq!(all, pixels([a, c, b], &state), "winding changes coverage of {a:?} {b:?} {c:?} in {extent:?}");
        assert_eq!(all, pixels([b, c, a], &state), "the first vertex changes coverage of {a:?} {b:?} {c:?}");
        if on_both_sides(a, b, c, d) {
            let other = pixels([b, a, d], &state);
            assert!(
                all.is_disjoint(&other),
                "both sides of an edge own a pixel: {a:?} {b:?} {c:?} {d:?} in {extent:?}"
            );
        }
    }
    assert!(drawn.is_subset(&all), "culling only removes");
    for rasteriser in
        Generation::ALL.into_iter().flat_map(|g| [Rasteriser::Llvmpipe(g), Rasteriser::LlvmpipeUnfused(g)])
    {
        pixels([a, b, c], &RasterState { rasteriser, ..state });
    }
}

/// The covered pixels; checks every primitive on the way.
fn pixels(triangle: [Vertex<2>; 3], state: &RasterState) -> Pixels {
    let mut covered = Pixels::new();
    for primitive in assemble(triangle, state) {
        let mut above = None;
        for span in primitive.spans() {
            assert!(span.start < span.end && span.end <= state.extent.width, "{span:?} of {triangle:?}");
            assert!(span.y < state.extent.height && above.is_none_or(|y| y < span.y), "{span:?} of {triangle:?}");
            above = Some(span.y);
            let bias = state.bias.constant == 0 && state.bias.slope_scale == 0.0;
            for x in span.start..span.end {
                let depth = primitive.depth(x, span.y);
                // Where an area rounds to 0 in binary32, the driver's planes are NaN.
                let planes = state.rasteriser != Rasteriser::Reference;
                assert!(planes || !bias || !depth.is_nan(), "finite vertices have a depth: {triangle:?}");
                let _ = primitive.varyings(x, span.y);
                covered.insert((x, span.y));
            }
        }
    }
    covered
}

fn vertex(input: &mut Input) -> Vertex<2> {
    let number = |input: &mut Input| match input.byte() {
        0..=127 => f32::from(i16::from_le_bytes(input.array())) / 16384.0,
        _ => input.number(),
    };
    let w = if input.bool() { 1.0 } else { number(input) };
    Vertex { position: [number(input), number(input), number(input), w], varyings: [number(input), number(input)] }
}

/// In front of every clipping plane, with a w and coordinates of ordinary size.
fn inside(vertex: &Vertex<2>) -> bool {
    let [x, y, z, w] = vertex.position;
    (1e-3..1e3).contains(&w) && x.abs() <= 4.0 * w && y.abs() <= 4.0 * w && (0.0..=w).contains(&z)
}

/// Whether c and d lie well on different sides of the line through a and b, on the screen.
fn on_both_sides(a: Vertex<2>, b: Vertex<2>, c: Vertex<2>, d: Vertex<2>) -> bool {
    let at = |v: Vertex<2>| {
        let [x, y, _, w] = v.position.map(f64::from);
        [x / w, y / w]
    };
    let ([ax, ay], [bx, by]) = (at(a), at(b));
    let side = |v| {
        let [x, y] = at(v);
        (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    };
    // Far enough from the line that snapping to 1/256 of a pixel cannot carry a vertex across it.
    let length = (bx - ax).hypot(by - ay);
    let (c, d) = (side(c) / length, side(d) / length);
    c.min(d) < -0.02 && c.max(d) > 0.02 && length > 0.1
}
