//! The specifications' rules and the crate's invariants, as tests.
//!
//! `rules` has one test for each rule the core implements, named by the rule and with its source: V is the Vulkan
//! specification, D the Direct3D 11.3 functional specification, W WebGPU. `invariants` are properties of any state,
//! searched for counter-examples by proptest.

mod invariants;
mod rules;
mod texel;
