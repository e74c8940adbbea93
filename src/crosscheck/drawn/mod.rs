//! Whole scenes drawn by the device itself: its rasteriser, its interpolation, and the fragment shader in WGSL.
//!
//! One render pass over the scene's cleared targets, with the state of every draw. Vertices come transformed from the
//! host, because WGSL has no binary64 to repeat that in. The fragment shader does what
//! [`crate::scene::material::surface`] does and also notes what it hands over in a storage buffer: a shader with side
//! effects runs before the depth and stencil tests, so every fragment is noted, hidden ones included.
//!
//! - [`variant`]: the shader of one draw and its constants; [`mod@image`]: textures as they are sampled;
//! - [`drawer`]: pipelines, buffers and the pass; [`mod@log`]: the noted fragments;
//! - [`compare`]: how all that agrees with the model.

pub mod compare;
pub mod drawer;
pub mod image;
pub mod log;
pub mod variant;

pub use compare::Agreement;
pub use drawer::{Drawer, Drawn};
pub use log::DrawnFragment;

use super::batch::ReplayError;
use crate::scene::SceneError;

/// A scene that cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    /// The scene contradicts itself or is too large.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The device lacks something or failed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The log of fragments does not fit the device.
    #[error("the scene's fragments need {bytes} bytes, the device binds at most {limit}; draw it smaller")]
    TooLarge {
        /// Bytes needed.
        bytes: u64,
        /// Bytes the device binds.
        limit: u64,
    },
    /// The device made more fragments than the log has room for.
    #[error("the device made {made} fragments where the model's rasteriser makes {expected}")]
    Overflow {
        /// Fragments made.
        made: usize,
        /// Fragments expected.
        expected: usize,
    },
}
