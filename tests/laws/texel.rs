//! One texel through the blender, in few words.

use outmerge::format::{Codes, ColorFormat};
use outmerge::model::{ColorInputs, NumericModel, registry};
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

/// A format by its WebGPU name.
pub fn format(name: &str) -> ColorFormat {
    ColorFormat::from_name(name).expect("a format of the crate")
}

/// A model by its name.
pub fn model(name: &str) -> Box<dyn NumericModel> {
    registry::by_name(name).expect("a model of the crate")
}

/// The models that follow the specifications' equation step by step; drivers have habits of their own.
pub fn textbook_models() -> Vec<Box<dyn NumericModel>> {
    ["exact", "f32", "f16", "fixed:8"].map(model).into()
}

/// Those of `models` that cover the inputs' format and state.
pub fn covering(models: Vec<Box<dyn NumericModel>>, inputs: &ColorInputs) -> Vec<Box<dyn NumericModel>> {
    models.into_iter().filter(|model| model.supports(inputs.format, inputs.blend.as_ref()).is_ok()).collect()
}

/// One equation for color and alpha.
pub fn equation(src_factor: BlendFactor, dst_factor: BlendFactor, operation: BlendOperation) -> Option<BlendState> {
    let both = BlendComponent { src_factor, dst_factor, operation };
    Some(BlendState { color: both, alpha: both })
}

/// `s Fs + d Fd` for color and alpha.
pub fn add(src_factor: BlendFactor, dst_factor: BlendFactor) -> Option<BlendState> {
    equation(src_factor, dst_factor, BlendOperation::Add)
}

/// A texel of zeros in a format, blending off.
pub fn texel(name: &str) -> ColorInputs {
    ColorInputs { format: format(name), blend: None, constant: [0.0; 4], src: [0.0; 4], src1: [0.0; 4], dst: [0; 4] }
}

/// The codes the exact model stores.
pub fn exact(inputs: &ColorInputs) -> Codes {
    model("exact").merge_color(inputs)
}

/// Bits of four numbers, as a 32-bit float target stores them.
pub fn bits(values: [f32; 4]) -> Codes {
    values.map(f32::to_bits)
}

/// The numbers a 32-bit float target holds.
pub fn floats(codes: Codes) -> [f32; 4] {
    codes.map(f32::from_bits)
}

/// The binary32 number nearest to x.
pub fn narrow(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let rounded = x as f32;
    rounded
}
