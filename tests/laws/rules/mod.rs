//! One test for each rule, in the order a fragment meets them.

mod clamps;
mod coverage;
mod depth;
mod depth_bias;
mod factors;
mod fixed_point_store;
mod float_store;
mod missing_channels;
mod special_values;
mod srgb;
mod stencil;
mod webgpu;
mod write_mask;
