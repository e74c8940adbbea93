//! Fragments computed on the device from the texel's number, so that exhaustive work uploads nothing.
//!
//! The host computes the same values ([`Program::fragment`]); a test holds both together.

use super::shader::{Expressions, Written};
use crate::fragment::Fragment;
use crate::state::MAX_COLOR_TARGETS;

/// One `f32` as a function of the texel's number n, a `u32`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// Always these bits.
    Bits(u32),
    /// Bits n * `stride` + `add`, modulo 2^32: raw sweeps.
    Number {
        /// Factor of n.
        stride: u32,
        /// Summand.
        add: u32,
    },
    /// The binary32 nearest to k / 255 with k = min((n / `divisor`) mod `modulus` + `add`, 255): every 8-bit code,
    /// without a look-up.
    Unorm8 {
        /// At least 1.
        divisor: u32,
        /// At least 1.
        modulus: u32,
        /// Summand.
        add: u32,
    },
    /// Entry (n / `divisor`) mod `modulus` + `add` of the table; the last entry where the table is shorter.
    Table {
        /// At least 1.
        divisor: u32,
        /// At least 1.
        modulus: u32,
        /// Summand.
        add: u32,
    },
}

/// All outputs of a fragment shader as functions of the texel's number.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Program {
    /// Output colors by location, RGBA. States may use fewer.
    pub outputs: Vec<[Input; 4]>,
    /// The second source, RGBA; needed by states that read it.
    pub second_source: Option<[Input; 4]>,
    /// Depth; needed where there is a depth attachment.
    pub depth: Option<Input>,
}

/// Bits of k / 255, without a division, which WGSL does not round correctly: k / 255 = 0.kkkk... in base 256. Four of
/// these digits and a one for the rest (which would overflow at 255, where rounding carries to 1 anyway) round to 24
/// bits as the whole does; scaling by 2^-32 is exact.
const DECLARATIONS: &str = "struct Records { header: vec4<u32>, table: array<u32> }
@group(0) @binding(0) var<storage, read> records: Records;
fn unorm8(code: u32) -> u32 {
    let k = min(code, 255u);
    return bitcast<u32>(f32(k * 0x01010101u + min(min(k, 1u), 255u - k)) * 0x1p-32f);
}
";

impl Input {
    /// The value for texel number `n`.
    #[must_use]
    pub fn value(self, n: u32, table: &[f32]) -> f32 {
        match self {
            Self::Bits(bits) => f32::from_bits(bits),
            Self::Number { stride, add } => f32::from_bits(n.wrapping_mul(stride).wrapping_add(add)),
            Self::Unorm8 { divisor, modulus, add } => {
                let code = pick(n, divisor, modulus, add).min(255);
                f32::from(u8::try_from(code).unwrap_or(u8::MAX)) / 255.0
            }
            Self::Table { divisor, modulus, add } => {
                let entry = pick(n, divisor, modulus, add) as usize;
                table.get(entry).or(table.last()).copied().unwrap_or(0.0)
            }
        }
    }

    fn wgsl(self) -> String {
        match self {
            // A runtime value: WGSL refuses constant NaN and infinity.
            Self::Bits(bits) => format!("(records.header.z + {bits}u)"),
            Self::Number { stride, add } => format!("(index * {stride}u + {add}u)"),
            Self::Unorm8 { divisor, modulus, add } => format!("unorm8({})", pick_wgsl(divisor, modulus, add)),
            Self::Table { divisor, modulus, add } => {
                format!("records.table[min({}, records.header.w)]", pick_wgsl(divisor, modulus, add))
            }
        }
    }
}

fn pick(n: u32, divisor: u32, modulus: u32, add: u32) -> u32 {
    ((n / divisor.max(1)) % modulus.max(1)).wrapping_add(add)
}

fn pick_wgsl(divisor: u32, modulus: u32, add: u32) -> String {
    format!("((index / {}u) % {}u + {add}u)", divisor.max(1), modulus.max(1))
}

impl Program {
    /// What the device computes for texel number `n`.
    #[must_use]
    pub fn fragment(&self, n: u32, table: &[f32]) -> Fragment {
        let vector = |inputs: &[Input; 4]| inputs.map(|input| input.value(n, table));
        let mut fragment = Fragment::default();
        for (output, inputs) in fragment.outputs.iter_mut().zip(self.outputs.iter().take(MAX_COLOR_TARGETS)) {
            *output = vector(inputs);
        }
        fragment.src1 = self.second_source.as_ref().map_or([0.0; 4], vector);
        fragment.depth = self.depth.map_or(0.0, |depth| depth.value(n, table));
        fragment
    }

    /// Header word 2 is 0, word 3 the index of the table's last entry.
    pub(super) fn expressions(&self, written: Written) -> Expressions {
        let vector = |inputs: &[Input; 4]| {
            let [r, g, b, a] = inputs.map(Input::wgsl);
            format!("bitcast<vec4<f32>>(vec4<u32>({r}, {g}, {b}, {a}))")
        };
        let zeros = [Input::Bits(0); 4];
        Expressions {
            declarations: DECLARATIONS.to_owned(),
            colors: written.locations().map(|at| vector(self.outputs.get(at).unwrap_or(&zeros))).collect(),
            second_source: vector(self.second_source.as_ref().unwrap_or(&zeros)),
            depth: format!("bitcast<f32>({})", self.depth.unwrap_or(Input::Bits(0)).wgsl()),
            ..Expressions::default()
        }
    }
}
