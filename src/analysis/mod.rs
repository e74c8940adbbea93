//! Analyses: what the numbers of the output merger do over many frames, layers and texels.
//!
//! Each analysis is a plain data result that serialises; the command line and the report only show it.
//!
//! - [`fixpoint`]: where repeated blending of one fragment gets stuck;
//! - [`texture`]: what storing colors premultiplied costs an image;
//! - [`departure`]: where a model first differs from `exact`.

pub mod departure;
pub mod fixpoint;
pub mod texture;
