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

impl Input {
    /// The value for texel number `n`.
    #[must_use]
    pub fn value(self, n: u32, table: &[f32]) -> f32 {
        match self {
            Self::Bits(bits) => f32::from_bits(bits),
            Self::Number { stride, add } => f32::from_bits(n.wrapping_mul(stride).wrapping_add(add)),
            Self::Table { divisor, modulus, add } => {
                let entry = ((n / divisor.max(1)) % modulus.max(1)).wrapping_add(add) as usize;
                table.get(entry).or(table.last()).copied().unwrap_or(0.0)
            }
        }
    }

    fn wgsl(self) -> String {
        match self {
            // A runtime value: WGSL refuses constant NaN and infinity.
            Self::Bits(bits) => format!("(records.header.z + {bits}u)"),
            Self::Number { stride, add } => format!("(index * {stride}u + {add}u)"),
            Self::Table { divisor, modulus, add } => {
                let (divisor, modulus) = (divisor.max(1), modulus.max(1));
                format!("records.table[min((index / {divisor}u) % {modulus}u + {add}u, records.header.w)]")
            }
        }
    }
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
            declarations: "struct Records { header: vec4<u32>, table: array<u32> }
@group(0) @binding(0) var<storage, read> records: Records;\n"
                .to_owned(),
            colors: written.locations().map(|at| vector(self.outputs.get(at).unwrap_or(&zeros))).collect(),
            second_source: vector(self.second_source.as_ref().unwrap_or(&zeros)),
            depth: format!("bitcast<f32>({})", self.depth.unwrap_or(Input::Bits(0)).wgsl()),
            ..Expressions::default()
        }
    }
}
