//! Kernels are the reference, byte for byte.
//!
//! Exhaustively over all (source, destination, alpha) of 8 bits for the states that renderers use most, in every rule; for
//! all 1445 states of one equation and for pairs of different ones on random and boundary texels; on every instruction
//! set of the machine; with write masks and discarded texels; for any tiling and number of threads; and for any state by
//! spans; and on sources that are any numbers.

mod exhaustive;
mod flat;
mod halves;
mod numbers;
mod quadruples;
mod rows;
#[cfg(feature = "proptest")]
mod spans;
mod srgb;
mod states;
mod tiles;

use outmerge::format::{Codes, ColorFormat};
use outmerge::kernel::{Isa, Kernel};
use outmerge::model::{ColorInputs, NumericModel, registry};
use wgpu_types::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, TextureFormat,
};

/// The models that have kernels, every generation of a driver among them.
const MODELS: [&str; 6] = ["exact", "f32", "fixed:8", "llvmpipe:mesa=22.3", "llvmpipe:mesa=25.0", "llvmpipe:mesa=26.1"];

fn model(name: &str) -> Box<dyn NumericModel> {
    registry::by_name(name).expect("a model")
}

fn target(blend: Option<BlendState>) -> ColorTargetState {
    ColorTargetState { format: TextureFormat::Rgba8Unorm, blend, write_mask: ColorWrites::ALL }
}

fn equation(src_factor: BlendFactor, dst_factor: BlendFactor, operation: BlendOperation) -> BlendComponent {
    BlendComponent { src_factor, dst_factor, operation }
}

/// What the reference stores for texels of codes.
fn reference(
    model: &dyn NumericModel,
    target: &ColorTargetState,
    constant: [f32; 4],
    [src, src1, dst]: [[u8; 4]; 3],
) -> [u8; 4] {
    let color = |codes: [u8; 4]| codes.map(|code| f32::from(code) / 255.0);
    let inputs = ColorInputs {
        format: ColorFormat::new(target.format).expect("a color format"),
        blend: target.blend,
        constant,
        src: color(src),
        src1: color(src1),
        dst: dst.map(u32::from),
    };
    let codes: Codes = model.merge_color(&inputs);
    std::array::from_fn(|i| {
        let written = target.write_mask.contains(ColorWrites::from_bits_truncate(1 << i));
        if written { u8::try_from(codes[i]).expect("8-bit codes") } else { dst[i] }
    })
}

/// Instruction sets of this machine; those it lacks are named on stderr.
fn instruction_sets() -> Vec<Isa> {
    let (have, lack): (Vec<Isa>, Vec<Isa>) = Isa::ALL.into_iter().partition(|isa| isa.available());
    for isa in lack {
        eprintln!("not run: {isa:?}, which this machine has not");
    }
    have
}

/// Pseudo-random bytes, a third of them 0, 1, 127, 128, 254 or 255: enough for tests, the same in every run.
struct Bytes(u64);

impl Bytes {
    fn next(&mut self) -> u8 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let [.., a, b, c] = self.0.to_be_bytes()[..4] else { unreachable!("eight bytes") };
        match a % 18 {
            0 => 0,
            1 => 1,
            2 => 127,
            3 => 128,
            4 => 254,
            5 => 255,
            _ => b ^ c.rotate_left(3),
        }
    }

    fn fill(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.next()).collect()
    }
}

fn kernel(target: &ColorTargetState, constant: [f32; 4], name: &str) -> Kernel {
    Kernel::new(target, constant, &*model(name)).unwrap_or_else(|| panic!("{name} has a kernel for {target:?}"))
}
