//! Lines' states and texels in words, for people.

use wgpu_types::{BlendState, ColorWrites};

use super::{DepthLine, LayersLine};
use crate::format::{Codes, ColorFormat, DepthFormat};
use crate::merger::depth_stencil::DepthStencil;
use crate::merger::write_mask;
use crate::model::{ColorInputs, NumericModel};
use crate::state::spelling;

/// Format, equations and mask.
pub(super) fn color_state(format: ColorFormat, blend: Option<&BlendState>, mask: ColorWrites) -> String {
    format!("{} {}, mask {}", format.name(), equations(blend), mask.bits())
}

/// A blend state in words.
#[must_use]
pub fn equations(blend: Option<&BlendState>) -> String {
    let equation = |c: &wgpu_types::BlendComponent| {
        let (src, dst) = (spelling::factor_name(c.src_factor), spelling::factor_name(c.dst_factor));
        format!("{} {src} {dst}", spelling::operation_name(c.operation))
    };
    match blend {
        None => "blending off".to_owned(),
        Some(blend) => format!("color {}, alpha {}", equation(&blend.color), equation(&blend.alpha)),
    }
}

/// What the blender sees.
pub(super) fn inputs(inputs: &ColorInputs) -> String {
    let ColorInputs { src, src1, constant, dst, .. } = inputs;
    format!("src {src:?}, src1 {src1:?}, constant {constant:?}, dst {}", codes(*dst))
}

/// Codes in hexadecimal.
pub(super) fn codes(codes: Codes) -> String {
    codes.map(|code| format!("{code:#x}")).join(" ")
}

/// The tests of a depth line.
pub(super) fn depth_state(line: &DepthLine) -> String {
    let state = &line.state;
    let compare = state.depth_compare.map_or("no test", spelling::comparison_name);
    let write = if state.depth_write_enabled == Some(true) { "written" } else { "not written" };
    let mut text = format!("{} {compare}, {write}", line.format.name());
    if line.format.has_stencil() {
        let face = |face: &wgpu_types::StencilFaceState| {
            let operation = spelling::stencil_operation_name;
            let (fail, depth_fail, pass) = (face.fail_op, face.depth_fail_op, face.pass_op);
            let compare = spelling::comparison_name(face.compare);
            format!("{compare} {}/{}/{}", operation(fail), operation(depth_fail), operation(pass))
        };
        let stencil = &state.stencil;
        text += &format!(
            "; stencil front {}, back {}, reference {}, masks {:#x} {:#x}",
            face(&stencil.front),
            face(&stencil.back),
            line.reference,
            stencil.read_mask,
            stencil.write_mask
        );
    }
    text
}

/// A fragment's depth and what it meets.
pub(super) fn depth_inputs(line: &DepthLine, i: usize) -> String {
    let (z, facing) = (line.z[i], if line.front(i) { "front" } else { "back" });
    format!("z {z:?} (bits {:#x}), {facing} face, dst {}", z.to_bits(), stored(line.format, line.dst[i]))
}

/// What is stored, and whether the fragment passed.
pub(super) fn depth_result(format: DepthFormat, result: DepthStencil, passed: bool) -> String {
    format!("{} {}", stored(format, result), if passed { "passed" } else { "failed" })
}

fn stored(format: DepthFormat, stored: DepthStencil) -> String {
    let depth = format.depth().map(|_| format!("depth {:#x}", stored.depth));
    let stencil = format.has_stencil().then(|| format!("stencil {}", stored.stencil));
    depth.into_iter().chain(stencil).collect::<Vec<_>>().join(" ")
}

/// Every layer's state.
pub(super) fn layers_state(line: &LayersLine) -> String {
    let states: Vec<String> = line
        .layers
        .iter()
        .map(|layer| format!("{}, mask {}", equations(layer.blend.as_ref()), layer.mask.bits()))
        .collect();
    format!("{} layers: {}", line.format.name(), states.join("; "))
}

/// What each layer's blender sees, by the model.
pub(super) fn layers_inputs(line: &LayersLine, model: &dyn NumericModel, i: usize) -> String {
    let mut texel = line.codes(&line.dst, i);
    let mut layers = Vec::new();
    for layer in &line.layers {
        let seen = layer.inputs(line.format, i, texel);
        layers.push(inputs(&seen));
        texel = write_mask::select(layer.mask, texel, model.merge_color(&seen));
    }
    layers.join("; then ")
}
