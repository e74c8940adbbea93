//! Color results: the sets of each class, and the narrowest class that holds a result.

use wgpu_types::{BlendFactor, BlendState, ColorWrites};

use super::blender::{Blender, Overflow, Precision};
use super::real::Real;
use super::span::Span;
use super::store::{self, CodeSet, Store};
use super::{Api, Class, Policy, Spec, Verdict};
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, TargetClass, snorm, unorm};
use crate::merger::blend::{Operands, clamp::clamp_input, component, equation, operation};
use crate::merger::load::load;
use crate::model::{Arithmetic, ColorInputs};

/// Holds results against a specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judge {
    /// Whose rules.
    pub spec: Spec,
    /// What is assumed where they are silent.
    pub policy: Policy,
}

/// A texel's verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// All channels together.
    pub verdict: Verdict,
    /// The text that gave it: under WebGPU, the one that was met best.
    pub api: Api,
    /// RGBA; masked and missing channels that kept their bits are exact.
    pub channels: [Verdict; 4],
}

/// One kind of blender a class admits, and the channels it counts for.
struct Variant {
    blender: Blender,
    store: Store,
    /// D3D may clamp inputs to a float format's range.
    clamped_inputs: bool,
    channels: [bool; 4],
}

impl Judge {
    /// A judge with the default policy.
    #[must_use]
    pub fn new(spec: Spec) -> Self {
        Self { spec, policy: Policy::default() }
    }

    /// The verdict on the codes `got` that a device stored.
    #[must_use]
    pub fn judge(&self, inputs: &ColorInputs, mask: ColorWrites, got: Codes) -> Judgement {
        let judged = self.spec.apis().iter().map(|api| self.judge_by(*api, inputs, mask, got));
        judged.reduce(|a, b| if a.verdict.or(b.verdict) == a.verdict { a } else { b }).unwrap_or(Judgement {
            verdict: Verdict::Undefined,
            api: Api::Vulkan,
            channels: [Verdict::Undefined; 4],
        })
    }

    fn judge_by(&self, api: Api, inputs: &ColorInputs, mask: ColorWrites, got: Codes) -> Judgement {
        let kinds = inputs.format.channels();
        let mut channels: [Option<Verdict>; 4] = std::array::from_fn(|i| {
            if kinds[i] == ChannelKind::Absent {
                return Some(Verdict::Undefined);
            }
            // Masked channels keep their bits.
            let kept = || CodeSet::only(kinds[i], inputs.dst[i]).contains(kinds[i], got[i]);
            let masked = mask.bits() >> i & 1 == 0;
            masked.then(|| if kept() { Verdict::Within(Class::Exact) } else { Verdict::Outside })
        });
        for class in [Class::Exact, Class::Tight, Class::Wide] {
            if channels.iter().all(Option::is_some) {
                break;
            }
            self.each_set(api, inputs, class, |i, set| {
                if channels[i].is_none() && set.contains(kinds[i], got[i]) {
                    let undefined = set.is_undefined();
                    channels[i] = Some(if undefined { Verdict::Undefined } else { Verdict::Within(class) });
                }
                channels.iter().all(Option::is_some)
            });
        }
        let channels = channels.map(|channel| channel.unwrap_or(Verdict::Outside));
        Judgement { verdict: channels.into_iter().fold(Verdict::Undefined, Verdict::and), api, channels }
    }

    /// The codes each channel may hold in a class, before the write mask; narrower classes are part of wider ones.
    #[must_use]
    pub fn sets(&self, inputs: &ColorInputs, class: Class) -> [CodeSet; 4] {
        let mut sets: [CodeSet; 4] = Default::default();
        for api in self.spec.apis() {
            for part in [Class::Exact, Class::Tight, Class::Wide].into_iter().filter(|part| *part <= class) {
                self.each_set(*api, inputs, part, |i, set| {
                    sets[i].unite(set);
                    false
                });
            }
        }
        sets
    }

    /// Calls `found` with each set that makes up a class, until it returns true.
    fn each_set(&self, api: Api, inputs: &ColorInputs, class: Class, mut found: impl FnMut(usize, CodeSet) -> bool) {
        let kinds = inputs.format.channels();
        for variant in self.variants(api, inputs, class) {
            let stopped = self.each_operands(api, inputs, &variant, &mut |operands| {
                let results = results(&variant.blender, inputs, operands);
                results.iter().enumerate().filter(|(i, _)| variant.channels[*i]).any(|(i, result)| {
                    let float = inputs.format.class() == TargetClass::Float;
                    let undefined = api == Api::Vulkan && result.special && !(float && self.policy.vulkan_specials);
                    let set = match kinds[i] {
                        _ if undefined => CodeSet::anything(),
                        ChannelKind::Float(FloatLayout::SINGLE) if inputs.blend.is_none() => {
                            CodeSet::only(kinds[i], inputs.src[i].to_bits())
                        }
                        ChannelKind::Float(layout) if inputs.blend.is_none() && result.is(0.0) && layout.signed => {
                            CodeSet::only(kinds[i], if inputs.src[i].is_sign_negative() { layout.sign() } else { 0 })
                        }
                        kind => store::store(result, kind, variant.store),
                    };
                    let free_zero = api == Api::Vulkan || inputs.blend.is_some();
                    found(i, if free_zero { set.with_both_zeros(kinds[i]) } else { set })
                })
            });
            if stopped {
                return;
            }
        }
    }

    /// The blenders a class adds to the narrower ones.
    fn variants(&self, api: Api, inputs: &ColorInputs, class: Class) -> Vec<Variant> {
        let blended = inputs.blend.is_some();
        let store = match (api, class, blended) {
            (Api::Vulkan, Class::Exact, _) => Store::Nearest,
            (Api::Vulkan, ..) => Store::VulkanCurve,
            (Api::D3d, Class::Exact, false) => Store::D3dNearest,
            (Api::D3d, Class::Exact, true) => Store::D3dBlendedNearest,
            (Api::D3d, _, false) => Store::D3d,
            (Api::D3d, _, true) => Store::D3dBlended,
        };
        let variant = |precision, overflow| Variant {
            blender: Blender { api, precision, overflow },
            store,
            clamped_inputs: false,
            channels: [true; 4],
        };
        let float = inputs.format.class() == TargetClass::Float;
        match class {
            Class::Exact => vec![variant(Precision::Real, Overflow::Any)],
            Class::Tight if !blended => vec![variant(Precision::Real, Overflow::Any)],
            Class::Tight => {
                let single = variant(Precision::Float(FloatLayout::SINGLE), Overflow::Any);
                if api == Api::D3d && float {
                    vec![Variant { clamped_inputs: true, ..variant(single.blender.precision, Overflow::Any) }, single]
                } else {
                    vec![single]
                }
            }
            Class::Wide if !blended => Vec::new(),
            Class::Wide => self.coarse(api, inputs.format, variant),
        }
    }

    /// Blenders as coarse as the target.
    fn coarse(&self, api: Api, format: ColorFormat, variant: impl Fn(Precision, Overflow) -> Variant) -> Vec<Variant> {
        let kinds = format.channels();
        let mantissa = kinds.iter().filter_map(|kind| match kind {
            ChannelKind::Float(layout) => Some(layout.mantissa_bits),
            _ => None,
        });
        let widest = |bits: fn(ChannelKind) -> Option<u32>| kinds.into_iter().filter_map(bits).max();
        let codes = |steps, channels| Variant { channels, ..variant(Precision::Codes(steps), Overflow::Any) };
        match mantissa.max() {
            Some(23) => Vec::new(),
            Some(bits) => {
                // D3D blends small floats as halves.
                let mantissa_bits = if api == Api::D3d { 10 } else { bits };
                let layout = Precision::Float(FloatLayout { exponent_bits: 5, mantissa_bits, signed: true });
                let overflows: &[Overflow] = match api {
                    Api::Vulkan => &[Overflow::Saturate, Overflow::Infinite],
                    Api::D3d => &[Overflow::Saturate],
                };
                overflows.iter().map(|overflow| variant(layout, *overflow)).collect()
            }
            None => {
                let unorm = widest(|kind| if let ChannelKind::Unorm(bits) = kind { Some(bits) } else { None });
                let snorm = widest(|kind| if let ChannelKind::Snorm(bits) = kind { Some(bits) } else { None });
                if kinds[0] == ChannelKind::Srgb {
                    let linear = unorm::steps(self.policy.srgb_linear_bits.clamp(8, 24));
                    let alpha = unorm::steps(8);
                    return vec![codes(linear, [true, true, true, false]), codes(alpha, [false, false, false, true])];
                }
                let steps =
                    snorm.map_or_else(|| unorm.map(unorm::steps), |bits| Some(snorm::steps(bits).unsigned_abs()));
                steps.map(|steps| codes(steps, [true; 4])).into_iter().collect()
            }
        }
    }

    /// Calls `visit` with what the equation may read, until it returns true, and says whether it did: one set of operands,
    /// or every quantisation of the sources that a blender in codes may start from.
    fn each_operands(
        &self,
        api: Api,
        inputs: &ColorInputs,
        variant: &Variant,
        visit: &mut dyn FnMut(&Operands<Span>) -> bool,
    ) -> bool {
        let mut operands = self.plain(inputs, variant);
        let Some(state) = &inputs.blend else { return visit(&operands) };
        match variant.blender.precision {
            Precision::Codes(steps) => quantised(api, &slots(state), &mut operands, steps, visit),
            Precision::Float(layout) if layout != FloatLayout::SINGLE => {
                for color in [&mut operands.src, &mut operands.src1, &mut operands.constant] {
                    color.iter_mut().for_each(|x| *x = variant.blender.round(*x));
                }
                visit(&operands)
            }
            _ => visit(&operands),
        }
    }

    /// The operands as they come.
    fn plain(&self, inputs: &ColorInputs, variant: &Variant) -> Operands<Span> {
        let class = inputs.format.class();
        let float = class == TargetClass::Float;
        let range = inputs.format.channels().into_iter().find_map(|kind| match kind {
            ChannelKind::Float(layout) if variant.clamped_inputs => {
                let largest = layout.decode(layout.max_finite());
                Some((if layout.signed { -largest } else { 0.0 }, largest))
            }
            _ => None,
        });
        let take = |x: f32| {
            let mut span = Span::exact(f64::from(clamp_input(x, class)));
            // An infinity that a normalised target clamps is undefined only where there are none.
            span.special = if float || !self.policy.vulkan_specials { !x.is_finite() } else { x.is_nan() };
            match range {
                Some((low, high)) if !span.empty => span.clamped(low, high),
                _ => span,
            }
        };
        Operands {
            src: inputs.src.map(take),
            src1: inputs.src1.map(take),
            constant: inputs.constant.map(take),
            dst: load(&variant.blender, inputs.format, inputs.dst),
        }
    }
}

/// One color of the operands.
type Color = fn(&mut Operands<Span>) -> &mut [Span; 4];

/// Channels that are quantised together.
type Slot = (Color, std::ops::Range<usize>);

/// The sources a state reads. Red, green and blue of one source go together: no channel reads another's.
fn slots(state: &BlendState) -> Vec<Slot> {
    let reads = |wanted: fn(BlendFactor) -> bool| {
        [state.color, state.alpha].iter().any(|c| wanted(c.src_factor) || wanted(c.dst_factor))
    };
    let mut colors: Vec<Color> = vec![|o| &mut o.src];
    if reads(|factor| factor.ref_second_blend_source()) {
        colors.push(|o| &mut o.src1);
    }
    if reads(|factor| matches!(factor, BlendFactor::Constant | BlendFactor::OneMinusConstant)) {
        colors.push(|o| &mut o.constant);
    }
    colors.into_iter().flat_map(|color| [(color, 0..3), (color, 3..4)]).collect()
}

/// Visits every combination of the codes that the slots may be quantised to, and of leaving them as they are, which
/// comes first.
fn quantised(
    api: Api,
    slots: &[Slot],
    operands: &mut Operands<Span>,
    steps: u32,
    visit: &mut dyn FnMut(&Operands<Span>) -> bool,
) -> bool {
    let Some(((color, channels), rest)) = slots.split_first() else { return visit(operands) };
    let plain = *color(operands);
    let mut before = None;
    for rule in [Quantise::Not, Quantise::Down, Quantise::Up] {
        let mut values = plain;
        values[channels.clone()].iter_mut().for_each(|x| *x = rule.apply(api, x, steps));
        // What is a code already comes out the same each time.
        if before.is_some_and(|before| before == values) {
            continue;
        }
        *color(operands) = values;
        if quantised(api, rest, operands, steps, visit) {
            return true;
        }
        before = Some(values);
    }
    *color(operands) = plain;
    false
}

#[derive(Clone, Copy)]
enum Quantise {
    Not,
    Down,
    Up,
}

impl Quantise {
    fn apply(self, api: Api, x: &Span, steps: u32) -> Span {
        let scale = i128::from(steps);
        let code = match (self, api) {
            _ if x.empty => return *x,
            (Self::Not, _) => return *x,
            (Self::Down, Api::Vulkan) => x.min.floor_code(scale),
            (Self::Up, Api::Vulkan) => x.max.ceil_code(scale),
            (Self::Down, Api::D3d) => x.min.least_within(scale, super::blender::D3D_TOLERANCE),
            (Self::Up, Api::D3d) => x.max.greatest_within(scale, super::blender::D3D_TOLERANCE),
        };
        Span { special: x.special, ..Span::point(Real::fraction(code, scale)) }
    }
}

/// The equation's results, clamped for the target.
fn results(blender: &Blender, inputs: &ColorInputs, operands: &Operands<Span>) -> [Span; 4] {
    let results: [Span; 4] = match &inputs.blend {
        None => operands.src,
        Some(state) => {
            let equation = equation(blender, state, operands, inputs);
            std::array::from_fn(|i| {
                let (src, dst) = &equation.terms[i];
                let result = operation::apply(blender, component(state, i).operation, src, dst);
                // Denormals may be flushed where nothing was computed, too.
                if inputs.format.class() == TargetClass::Float { blender.round(result) } else { result }
            })
        }
    };
    results.map(|x| blender.clamp(&x, inputs.format.class()))
}
