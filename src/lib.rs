//! # outmerge
//!
//! An exact, fast model of the GPU output-merger stage: *given this state, these fragments and this target, what bytes
//! must the GPU write, and why?*
//!
//! State is `wgpu-types`' own ([`MergerState`] gathers it), results are raw texels ([`Framebuffer`]), and how numbers are
//! rounded is a [numeric model](model) of your choice: real arithmetic, binary32, binary16, fixed point, or a driver's bit
//! for bit.
//!
//! # A fragment's way through the stages
//!
//! The reference merger ([`merger`]) runs one stage a file, in the order of the specifications. Here is one fragment in
//! each of them; [`Merger::trace`] does the same as [`Merger::merge`] and keeps what each stage saw.
//!
//! ```
//! use outmerge::merger::Fate;
//! use outmerge::model::exact::Exact;
//! use outmerge::model::{NumericModel, StepKind};
//! use outmerge::state::{Rect, preset};
//! use outmerge::{AlphaTest, Extent, Fragment, Framebuffer, Merger, MergerState};
//! use wgpu_types::{
//!     ColorTargetState, ColorWrites, CompareFunction, DepthBiasState, DepthStencilState, StencilState, TextureFormat,
//! };
//!
//! // State in: straight alpha over an 8-bit target whose alpha is masked, a depth test, an alpha test, a scissor.
//! let mut state = MergerState::single(ColorTargetState {
//!     format: TextureFormat::Rgba8Unorm,
//!     blend: preset::by_name("fade").unwrap().blend,
//!     write_mask: ColorWrites::COLOR,
//! });
//! state.depth_stencil = Some(DepthStencilState {
//!     format: TextureFormat::Depth24Plus,
//!     depth_write_enabled: Some(true),
//!     depth_compare: Some(CompareFunction::Less),
//!     stencil: StencilState::default(),
//!     bias: DepthBiasState::default(),
//! });
//! state.alpha_test = AlphaTest::On { compare: CompareFunction::Greater, reference: 0.1 };
//! state.dynamic.scissor = Some(Rect { x: 0, y: 0, width: 1, height: 1 });
//!
//! // Target bytes: two texels of opaque grey at the far plane.
//! let mut target = Framebuffer::for_state(Extent::new(2, 1)?, &state)?;
//! target.colors[0].as_mut().unwrap().fill([127, 127, 127, 255]);
//! target.depth_stencil.as_mut().unwrap().depth_mut().fill(0xff_ffff);
//!
//! let model = Exact::default();
//! let merger = Merger::new(&state, &model, &target)?;
//! let orange = Fragment::new([1.0, 0.5, 0.0, 0.5]).at_depth(0.25);
//! let fate = |fragment: &Fragment, x, target: &mut Framebuffer| merger.trace(fragment, x, 0, target).samples[0].fate;
//!
//! // 1. Coverage: outside the scissor, or without a covered sample, a fragment does not reach the target.
//! assert_eq!(fate(&orange, 1, &mut target), Fate::NotCovered);
//! // 2. Discard: the shader's own, then the alpha test, 0.05 > 0.1 being false.
//! assert_eq!(fate(&Fragment { discarded: true, ..orange }, 0, &mut target), Fate::Discarded);
//! assert_eq!(fate(&Fragment::new([1.0, 0.5, 0.0, 0.05]), 0, &mut target), Fate::AlphaTestFailed);
//!
//! let trace = merger.trace(&orange, 0, 0, &mut target);
//! let sample = &trace.samples[0];
//! assert_eq!(sample.fate, Fate::Merged);
//! // 3. Depth and stencil: 0.25 as a 24-bit code is less than what was stored, and replaces it.
//! let (code, before, after) = sample.depth_stencil.unwrap();
//! assert_eq!((code, before.depth, after.depth), (0x40_0000, 0xff_ffff, 0x40_0000));
//! // 4. Load: the blender sees the stored codes,
//! let (inputs, stored) = sample.colors[0].unwrap();
//! assert_eq!(inputs.dst, [127, 127, 127, 255]);
//! // 5. Blend: and computes S * S.a + D * (1 - S.a); every number can be asked for,
//! let steps = model.explain_color(&inputs);
//! let red = |kind| steps.value(kind, 0).unwrap().exact.clone();
//! assert_eq!((red(StepKind::SourceFactor), red(StepKind::Destination)), ("1/2".into(), "127/255".into()));
//! // 6. Encode: rounded once to codes; blue is 63.5, a tie, and goes to the even code.
//! assert_eq!(steps.codes, [191, 127, 64, 191]);
//! // 7. Write mask: alpha keeps its stored bits.
//! assert_eq!(stored, [191, 127, 64, 255]);
//! assert_eq!(target.colors[0].as_ref().unwrap().bytes(), [191, 127, 64, 255, 127, 127, 127, 255]);
//!
//! // The same fragment again lies no longer before the stored depth.
//! assert_eq!(fate(&orange, 0, &mut target), Fate::DepthFailed);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Map
//!
//! | module | what it is |
//! |---|---|
//! | [`state`] | state in: presets, ShaderLab, WebGPU JSON, validation |
//! | [`format`](mod@format) | what a texel's bits mean |
//! | [`target`], [`fragment`](mod@fragment) | target bytes, fragments in |
//! | [`merger`] | the reference, one stage a file |
//! | [`model`] | numeric models: arithmetic only, no equations |
//! | [`plan`] | what a draw needs, and what can be left out unseen |
//! | [`limit`] | bounds on what inputs may ask for |
//! | [`verdict`] | what a comparison may end in: words and exit status |
//! | `scene` (feature `scene`) | a mini fragment pipeline: geometry, textures, materials, draw order |
//! | `vectors` (feature `json`) | test vectors as JSON lines |
//! | `analysis`, `report` (feature `report`) | premultiplied textures, bounds, stability, error against time; HTML |
//! | `crosscheck`, `conform` (feature `gpu`) | the same fragments through a Vulkan driver |
//! | `proptest` (feature `proptest`) | strategies for states, fragments and destinations |
//! | `testkit` (feature `testkit`) | assertions on read-back images, a runner of scene and vector files |
//!
//! # Scope
//!
//! - Every color format that WebGPU can render to and blend, one or four samples, all states of WebGPU's output merger and
//!   the fixed-function alpha test.
//! - Coverage, shader outputs and depths are inputs; the feature `scene` can make them.
//!
//! # Simplifications
//!
//! - Integer, shared-exponent and compressed targets are not modelled, nor is the resolve of several samples.
//! - Depth clipping happens before this stage; a fragment's depth is clamped to the viewport's range.
//! - Alpha to coverage keeps the lowest samples; real devices dither.

pub mod state;

pub mod format;

pub mod target;

pub mod fragment;

pub mod merger;

pub mod model;

pub mod limit;

pub mod verdict;

pub mod plan;

pub mod kernel;

pub mod admissible;

#[cfg(feature = "scene")]
pub mod scene;

#[cfg(feature = "scene")]
pub mod lint;

#[cfg(feature = "json")]
pub mod vectors;

#[cfg(feature = "json")]
pub mod identify;

#[cfg(feature = "report")]
pub mod analysis;

#[cfg(feature = "report")]
pub mod report;

#[cfg(any(feature = "cli", feature = "json"))]
pub mod processor;

#[cfg(feature = "gpu")]
pub mod crosscheck;

#[cfg(feature = "gpu")]
pub mod conform;

#[cfg(feature = "proptest")]
pub mod proptest;

#[cfg(feature = "testkit")]
pub mod testkit;

#[cfg(feature = "cli")]
pub mod cli;

pub use fragment::Fragment;
pub use limit::Limits;
pub use merger::Merger;
pub use model::NumericModel;
pub use state::{AlphaTest, DynamicState, MergerState};
pub use target::{Extent, Framebuffer};
