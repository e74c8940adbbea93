//! The state while its commands are being read: factors and operations apart, as ShaderLab keeps them.

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use crate::state::{MAX_COLOR_TARGETS, StateBlock};

/// Source and destination factor.
pub(super) type Factors = (BlendFactor, BlendFactor);

/// What the commands read so far have set.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    /// Everything but blending.
    pub(super) block: StateBlock,
    /// `Blend` by target, color and alpha; `None` is off.
    pub(super) factors: [Option<(Factors, Factors)>; MAX_COLOR_TARGETS],
    /// `BlendOp` by target, color and alpha. Without a `Blend` it has no effect (Unity manual, *BlendOp*).
    pub(super) operations: [(BlendOperation, BlendOperation); MAX_COLOR_TARGETS],
}

impl Default for Draft {
    fn default() -> Self {
        Self {
            block: StateBlock::default(),
            factors: [None; MAX_COLOR_TARGETS],
            operations: [(BlendOperation::Add, BlendOperation::Add); MAX_COLOR_TARGETS],
        }
    }
}

impl Draft {
    /// The state block, factors and operations joined.
    pub(super) fn finish(&self) -> StateBlock {
        let mut block = self.block.clone();
        for (i, blend) in block.blend.iter_mut().enumerate() {
            let component =
                |(src_factor, dst_factor): Factors, operation| BlendComponent { src_factor, dst_factor, operation };
            *blend = self.factors[i].map(|(color, alpha)| BlendState {
                color: component(color, self.operations[i].0),
                alpha: component(alpha, self.operations[i].1),
            });
        }
        block.ignore_extreme_factors();
        block
    }
}
