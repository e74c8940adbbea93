//! A layer turned into what the device reads: words of the fragments' records, triangles, and draws.

use std::collections::BTreeMap;

use super::batch::{DepthSource, Layer, state_reads_second_source};
use super::shader::{HEADER_WORDS, RecordLayout, RecordShader, Written};
use crate::fragment::Fragment;
use crate::target::{Extent, Framebuffer};

/// A clip-space position.
pub type Vertex = [f32; 4];

/// One draw of a layer: triangles that share a stencil reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// Three a triangle.
    pub vertices: Vec<Vertex>,
    /// The stencil reference.
    pub stencil_reference: u32,
}

/// A layer ready for the device.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The shader it needs.
    pub shader: RecordShader,
    /// Header and records.
    pub words: Vec<u32>,
    /// Draws in order; none when nothing is covered.
    pub draws: Vec<Draw>,
}

impl Prepared {
    /// Prepares a layer that passed its checks.
    #[must_use]
    pub fn new(layer: &Layer, targets: &Framebuffer) -> Self {
        let written = written_by(layer, targets);
        let shader = RecordShader { written, layout: RecordLayout::of(written) };
        let mut words = vec![0; HEADER_WORDS];
        words[0] = targets.extent.width;
        words.reserve(layer.fragments.len() * shader.layout.quads() * 4);
        for fragment in &layer.fragments {
            push_record(&mut words, layer, shader.layout, fragment);
        }
        Self { shader, words, draws: draws(layer, targets.extent) }
    }
}

/// Whether the fragment dies in the shader: its own discard, or the alpha test, which WebGPU leaves to the shader.
fn dies(layer: &Layer, fragment: &Fragment) -> bool {
    fragment.discarded || !layer.state.alpha_test.passes(fragment.outputs[0][3])
}

fn written_by(layer: &Layer, targets: &Framebuffer) -> Written {
    let has_depth = targets.depth_stencil.as_ref().is_some_and(|target| target.format().depth().is_some());
    let locations = layer.state.targets.iter().enumerate().filter(|(_, target)| target.is_some());
    Written {
        outputs: locations.fold(0, |mask, (location, _)| mask | 1 << location),
        dual_source: state_reads_second_source(&layer.state),
        depth: has_depth && layer.depth_source == DepthSource::Shader,
        discard: layer.fragments.iter().any(|fragment| dies(layer, fragment)),
    }
}

fn push_record(words: &mut Vec<u32>, layer: &Layer, layout: RecordLayout, fragment: &Fragment) {
    let before = words.len();
    for location in layout.locations() {
        words.extend(fragment.outputs[location].map(f32::to_bits));
    }
    if layout.second_source {
        words.extend(fragment.src1.map(f32::to_bits));
    }
    if layout.tail {
        words.extend([fragment.depth.to_bits(), u32::from(dies(layer, fragment)), 0, 0]);
    }
    words.resize(before + layout.quads() * 4, 0);
}

/// One triangle over everything where all fragments agree, else one a fragment, grouped by stencil reference.
fn draws(layer: &Layer, extent: Extent) -> Vec<Draw> {
    let state_reference = layer.state.dynamic.stencil_reference;
    let Some(first) = layer.fragments.first() else { return Vec::new() };
    let alike = |fragment: &Fragment| fragment.coverage & 1 == 1 && fragment.front_facing == first.front_facing;
    let own_references = layer.stencil_references.as_ref();
    let one_reference = own_references.is_none_or(|all| all.iter().all(|reference| *reference == all[0]));
    if layer.depth_source == DepthSource::Shader && one_reference && layer.fragments.iter().all(alike) {
        let stencil_reference = own_references.map_or(state_reference, |all| u32::from(all[0]));
        return vec![Draw { vertices: whole_target(first.front_facing).to_vec(), stencil_reference }];
    }
    let mut groups: BTreeMap<u32, Vec<Vertex>> = BTreeMap::new();
    let texels = (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y)));
    for (index, (fragment, (x, y))) in layer.fragments.iter().zip(texels).enumerate() {
        if fragment.coverage & 1 == 1 {
            let reference = own_references.map_or(state_reference, |all| u32::from(all[index]));
            let z = if layer.depth_source == DepthSource::Rasteriser { fragment.depth } else { 0.0 };
            groups.entry(reference).or_default().extend(one_texel(x, y, extent, z, fragment.front_facing));
        }
    }
    groups.into_iter().map(|(stencil_reference, vertices)| Draw { vertices, stencil_reference }).collect()
}

/// A triangle that covers the whole target; counter-clockwise, so front-facing, or the reverse.
#[must_use]
pub fn whole_target(front_facing: bool) -> [Vertex; 3] {
    let [a, b, c] = [[-1.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0]];
    if front_facing { [a, b, c] } else { [a, c, b] }
}

/// A triangle that stays inside one texel and covers its centre.
fn one_texel(x: u32, y: u32, extent: Extent, z: f32, front_facing: bool) -> [Vertex; 3] {
    #[expect(clippy::cast_precision_loss, reason = "dimensions are at most 2^13")]
    fn exact(n: u32) -> f32 {
        n as f32
    }
    let clip = |dx: f32, dy: f32| {
        [2.0 * (exact(x) + dx) / exact(extent.width) - 1.0, 1.0 - 2.0 * (exact(y) + dy) / exact(extent.height), z, 1.0]
    };
    let (top_left, bottom_left, top_right) = (clip(0.25, 0.25), clip(0.25, 1.0), clip(1.0, 0.25));
    if front_facing { [top_left, bottom_left, top_right] } else { [top_left, top_right, bottom_left] }
}
