//! proptest strategies for states, fragments and destinations, for property tests of renderers (feature `proptest`).
//!
//! Uniform random inputs almost never meet the cases that renderers get wrong. These strategies are weighted towards
//! them: codes' values and the ties between them, give or take an ulp; 0 and 1; numbers out of range; NaN, Inf, -0 and
//! denormals; full and empty masks; states that ignore their factors. Every strategy shrinks to something plain: the
//! smallest stack of fragments, the first of each list (factor zero, operation add, mask all, number 0).
//!
//! | module | strategies |
//! |---|---|
//! | [`number`] | shader outputs by channel, colors by format, depths |
//! | [`state`] | formats, factors, equations, whole merger states: any, blendable, valid for WebGPU |
//! | [`fragment`] | fragments that fit a state, stacks of them |
//! | [`target`] | stored codes, filled framebuffers, what the blender sees of one texel |
//! | `scene` | whole small scenes (feature `scene`) |
//! | [`pass`] | a state, its framebuffer and a stack of fragments together |
//! | [`layers`] | several draws, each with a state of its own, over whole targets |
//! | [`every`] | iterators over all equations, states and formats, where there are few enough to try each |
//!
//! A toy blender, checked against the model on inputs that look for trouble:
//!
//! ```
//! use outmerge::format::ColorFormat;
//! use outmerge::model::exact::Exact;
//! use outmerge::model::{ColorInputs, NumericModel};
//! use outmerge::proptest::{number, target};
//! use proptest::prelude::*;
//!
//! /// Additive blending of 8-bit codes.
//! fn toy(src: [f32; 4], dst: [u32; 4]) -> [u32; 4] {
//!     std::array::from_fn(|i| {
//!         // NaN is neither above nor below anything: it ends at 0.
//!         let s = if src[i] > 0.0 { f64::from(src[i].min(1.0)) } else { 0.0 };
//!         let y = (s * 255.0 + f64::from(dst[i])).min(255.0).round_ties_even();
//!         (0..=255).find(|&code| f64::from(code) == y).unwrap()
//!     })
//! }
//!
//! let format = ColorFormat::from_name("rgba8unorm").unwrap();
//! proptest!(|(src in number::color(format), dst in target::codes(format))| {
//!     let blend = outmerge::state::preset::by_name("additive").unwrap().blend;
//!     let inputs = ColorInputs { format, blend, constant: [0.0; 4], src, src1: [0.0; 4], dst };
//!     prop_assert_eq!(toy(src, dst), Exact::default().merge_color(&inputs));
//! });
//! ```

pub mod every;
pub mod fragment;
pub mod layers;
pub mod number;
pub mod pass;
#[cfg(feature = "scene")]
pub mod scene;
pub mod state;
pub mod target;
