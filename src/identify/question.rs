//! Inputs that show how a blender rounds: codes and ties of every width, products close to a tie, powers of two.

use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState};

use super::candidates::WIDTHS;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, TargetClass, unorm};
use crate::model::ColorInputs;

/// A seeded source of questions about one format.
#[derive(Clone, Debug)]
pub struct Questions {
    format: ColorFormat,
    random: fastrand::Rng,
    states: Vec<Option<BlendState>>,
    constant: [f32; 4],
}

/// States that between them use every step of a blender: none, one product, two, their sum and difference, a complement,
/// a stored factor, the constant.
fn states() -> Vec<Option<BlendState>> {
    let both = |src_factor, dst_factor, operation| {
        let component = BlendComponent { src_factor, dst_factor, operation };
        Some(BlendState { color: component, alpha: component })
    };
    vec![
        None,
        both(F::SrcAlpha, F::OneMinusSrcAlpha, Op::Add),
        both(F::One, F::OneMinusSrcAlpha, Op::Add),
        both(F::SrcAlpha, F::One, Op::Add),
        both(F::One, F::One, Op::Add),
        both(F::Dst, F::Zero, Op::Add),
        both(F::OneMinusDst, F::One, Op::Add),
        both(F::Constant, F::OneMinusConstant, Op::Add),
        both(F::Zero, F::Src, Op::Add),
        both(F::SrcAlpha, F::DstAlpha, Op::ReverseSubtract),
        both(F::SrcAlpha, F::Zero, Op::Add),
        both(F::One, F::One, Op::Subtract),
    ]
}

impl Questions {
    /// Equal seeds give equal questions.
    #[must_use]
    pub fn new(format: ColorFormat, seed: u64) -> Self {
        let mut questions =
            Self { format, random: fastrand::Rng::with_seed(seed), states: states(), constant: [0.0; 4] };
        questions.renew_constant();
        questions
    }

    /// The same without states the blender does not run.
    #[must_use]
    pub fn only(mut self, runs: impl Fn(Option<&BlendState>) -> bool) -> Self {
        self.states.retain(|state| runs(state.as_ref()));
        self
    }

    /// The states asked about.
    #[must_use]
    pub fn states(&self) -> &[Option<BlendState>] {
        &self.states
    }

    /// Another blend constant for the questions to come: a device sets it once a draw, so it changes by batches.
    pub fn renew_constant(&mut self) {
        self.constant = std::array::from_fn(|_| self.number());
    }

    /// The next question.
    pub fn ask(&mut self) -> ColorInputs {
        let blend = self.states.get(self.random.usize(..self.states.len().max(1))).copied().flatten();
        let alpha = self.number();
        let channels = self.format.channels();
        let dst = std::array::from_fn(|i| self.code(channels[i]));
        let src = std::array::from_fn(|i| match i {
            3 => alpha,
            _ if self.random.u8(..3) == 0 => self.near_tied_product(alpha),
            _ => self.number(),
        });
        ColorInputs { format: self.format, blend, constant: self.constant, src, src1: [0.0; 4], dst }
    }

    fn code(&mut self, kind: ChannelKind) -> u32 {
        match kind {
            ChannelKind::Absent => 0,
            ChannelKind::Float(layout) if layout != FloatLayout::SINGLE => {
                layout.encode(f64::from(self.number()), crate::format::Rounding::NearestEven)
            }
            ChannelKind::Float(_) => self.number().to_bits(),
            kind => match self.random.u8(..8) {
                0 => 0,
                1 => unorm::steps(kind.bits()),
                _ => self.random.u32(..=unorm::steps(kind.bits())),
            },
        }
    }

    /// A shader output whose product with alpha comes close to half a code of the target.
    fn near_tied_product(&mut self, alpha: f32) -> f32 {
        let steps = f64::from(self.steps());
        let tie = (f64::from(self.random.u32(..self.steps())) + 0.5) / steps;
        let quotient = tie / f64::from(alpha);
        if alpha > 0.0 && quotient <= 1.0 { self.jitter(quotient) } else { self.number() }
    }

    fn steps(&self) -> u32 {
        match self.format.channels()[0] {
            ChannelKind::Unorm(bits) | ChannelKind::Snorm(bits) => unorm::steps(bits),
            _ => 255,
        }
    }

    /// A number in [0, 1] for the most part: a code or a tie of some width give or take an ulp, a multiple of a power of
    /// two, or any; now and then one beyond, or none.
    ///
    /// What becomes of NaN and the infinities tells drivers apart that agree otherwise.
    fn number(&mut self) -> f32 {
        const SPECIAL: [f32; 4] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0];
        if self.random.u8(..64) == 0 {
            return SPECIAL[self.random.usize(..SPECIAL.len())];
        }
        let x = match self.random.u8(..8) {
            0 => f64::from(self.random.u32(..=64)) / 64.0,
            1 => self.random.f64(),
            2..5 => f64::from(self.random.u32(..=2 * self.steps())) / f64::from(2 * self.steps()),
            5 | 6 => {
                let steps = unorm::steps(WIDTHS[self.random.usize(..WIDTHS.len())]);
                f64::from(self.random.u32(..=2 * steps)) / f64::from(2 * steps)
            }
            _ if self.format.class() == TargetClass::Unorm => self.random.f64() * 2.0 - 0.5,
            _ => (self.random.f64() * 2.0 - 1.0) * 2.0_f64.powi(i32::from(self.random.i8(-20..16))),
        };
        self.jitter(x)
    }

    /// The nearest binary32 number or a neighbour of it.
    fn jitter(&mut self, x: f64) -> f32 {
        let near = crate::model::binary32::narrow(x);
        [near, near, near.next_down(), near.next_up()][self.random.usize(..4)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_seeds_ask_equal_questions_about_every_state() {
        let format = ColorFormat::from_name("rgba8unorm").expect("a format");
        let ask = |seed| {
            let mut questions = Questions::new(format, seed);
            (0..500).map(|_| questions.ask()).collect::<Vec<_>>()
        };
        // NaN is among the inputs, so bits are compared.
        let bits = |seed| ask(seed).iter().map(|question| question.src.map(f32::to_bits)).collect::<Vec<_>>();
        assert!(bits(3) == bits(3), "reproducible");
        assert!(bits(3) != bits(4), "but not constant");
        for state in states() {
            assert!(ask(3).iter().any(|question| question.blend == state), "{state:?}");
        }
    }
}
