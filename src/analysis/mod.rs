//! Analyses: what the numbers of the output merger do over many frames, layers and texels.
//!
//! Each analysis is a plain data result that serialises; the command line and the report only show it.
//!
//! - [`fixpoint`]: where repeated blending of one fragment gets stuck;
//! - [`texture`]: what storing colors premultiplied costs an image;
//! - [`bound`]: a proven bound on the error of a stack of layers; [`stability`]: stiff stacks, extreme values, order;
//! - [`tradeoff`]: error against run time;
//! - [`trap`]: the first bad number of a scene;
//! - [`departure`]: where a model first differs from `exact`.

pub mod bound;
pub mod departure;
pub mod fixpoint;
pub mod stability;
pub mod texture;
pub mod tradeoff;
pub mod trap;
