//! Questions that two models answer differently, found by search.
//!
//! Random inputs do not see every rule: on 16-bit targets two generations of llvmpipe multiply 5,006 of 2^32 pairs of codes
//! differently, and denormals of binary32 show in a half float only where something large multiplies them. So the search
//! draws from several sources of questions, each aimed at one kind of rule, and keeps what the two models answer differently.

use fastrand::Rng;
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as Op, BlendState};

use super::Questions;
use crate::format::{ChannelKind, Codes, ColorFormat, FloatLayout, Rounding, unorm};
use crate::model::binary32::narrow;
use crate::model::{ColorInputs, NumericModel, same_codes};

/// Questions looked at for each source before it counts as exhausted.
const POOL: usize = 8192;

/// Constants a search goes through: a device sets the blend constant once a draw.
const CONSTANTS: usize = 4;

/// Questions, at most `count`, that `a` and `b` answer differently on a format: neither answer is possible for the other
/// model. None where no question found is such. Equal seeds give equal questions.
#[must_use]
pub fn telling(
    a: &dyn NumericModel,
    b: &dyn NumericModel,
    format: ColorFormat,
    count: usize,
    seed: u64,
) -> Vec<ColorInputs> {
    let mut found = Vec::new();
    let supported =
        |inputs: &ColorInputs| [a, b].into_iter().all(|model| model.supports(format, inputs.blend.as_ref()).is_ok());
    for (number, source) in SOURCES.iter().enumerate() {
        let mut aim = Aim::new(format, seed.wrapping_mul(31).wrapping_add(number as u64));
        // Each source gives a share, so that no kind of rule crowds the others out.
        let wanted = count.div_ceil(SOURCES.len()).max(1);
        let mut kept = 0;
        for turn in 0..POOL {
            if kept == wanted {
                break;
            }
            if turn % (POOL / CONSTANTS) == 0 {
                aim.questions.renew_constant();
            }
            let Some(inputs) = source(&mut aim).filter(supported) else { continue };
            if tells(a, b, &inputs) {
                found.push(inputs);
                kept += 1;
            }
        }
    }
    found.truncate(count);
    found
}

/// Questions of every source, `count` of each, told or not: what is likely to show a rule that no candidate has.
#[must_use]
pub fn aimed(format: ColorFormat, count: usize, seed: u64) -> Vec<ColorInputs> {
    let of = |(number, source): (usize, &Source)| {
        let mut aim = Aim::new(format, seed.wrapping_add(number as u64) ^ 0xa13d);
        // Some sources have nothing to ask on a format, and some attempts find nothing.
        (0..4 * count).filter_map(|_| source(&mut aim)).take(count).collect::<Vec<_>>()
    };
    SOURCES.iter().enumerate().flat_map(of).collect()
}

/// Whether no answer of one model is a possible answer of the other.
#[must_use]
pub fn tells(a: &dyn NumericModel, b: &dyn NumericModel, inputs: &ColorInputs) -> bool {
    let possible = |model: &dyn NumericModel| -> Vec<Codes> {
        std::iter::once(model.merge_color(inputs)).chain(model.alternative(inputs)).collect()
    };
    let (of_a, of_b) = (possible(a), possible(b));
    !of_a.iter().any(|x| of_b.iter().any(|y| same_codes(inputs.format, *x, *y)))
}

/// What sources draw from.
struct Aim {
    format: ColorFormat,
    questions: Questions,
    random: Rng,
}

type Source = fn(&mut Aim) -> Option<ColorInputs>;

/// The sources: any question; products of codes next to a tie; factors f and 1 - f; denormals times what makes them large;
/// numbers beyond the integers; linear colors of [0, 1].
const SOURCES: [Source; 6] = [Aim::any, Aim::tied_product, Aim::complementary, Aim::denormal, Aim::huge, Aim::linear];

impl Aim {
    fn new(format: ColorFormat, seed: u64) -> Self {
        Self { format, questions: Questions::new(format, seed), random: Rng::with_seed(seed ^ 0x7e11) }
    }

    fn any(&mut self) -> Option<ColorInputs> {
        Some(self.questions.ask())
    }

    /// Two codes of the driver's width whose product lies just above or below the middle between two codes.
    fn tied_product(&mut self) -> Option<ColorInputs> {
        let width = match self.format.channels()[0] {
            ChannelKind::Unorm(8) => 8,
            // Narrower codes are blended as 16-bit ones.
            ChannelKind::Unorm(_) => 16,
            _ => return None,
        };
        let one = unorm::steps(width);
        let (a, start) = (self.random.u32(1..=one), self.random.u32(..=one));
        // Twice the product modulo twice the divisor is the divisor at a tie, which it never is: one of them is even.
        let near = |b: &u32| {
            let rest = 2 * u64::from(a) * u64::from(*b) % (2 * u64::from(one));
            rest.abs_diff(u64::from(one)) == 1
        };
        let b = (0..=one).map(|i| (start + i) % (one + 1)).find(near)?;
        let value = |code: u32| narrow(f64::from(code) / f64::from(one));
        let mut inputs = self.questions.ask();
        let product = BlendComponent { src_factor: F::SrcAlpha, dst_factor: F::Zero, operation: Op::Add };
        let alpha = BlendComponent { src_factor: F::Src, ..product };
        inputs.blend = Some(BlendState { color: product, alpha });
        inputs.src = [value(a), value(a), value(a), value(b)];
        if self.format.channels()[0] == ChannelKind::Unorm(10) {
            // Only the top ten bits are stored. A destination of which the low six bits are what the product lacks to the next
            // stored code makes its last bit show; they are the code's top six, as the code is repeated below itself.
            let product = BlendComponent { dst_factor: F::One, ..product };
            inputs.blend = Some(BlendState { color: product, alpha });
            let floor = u32::try_from(u64::from(a) * u64::from(b) / u64::from(one)).unwrap_or(0);
            let code = (63 - floor % 64) << 4 | self.random.u32(..16);
            inputs.dst = [code, code, code, inputs.dst[3]];
        }
        Some(inputs)
    }

    /// Factors f and 1 - f, which drivers may interpolate.
    fn complementary(&mut self) -> Option<ColorInputs> {
        const PAIRS: [(F, F); 6] = [
            (F::SrcAlpha, F::OneMinusSrcAlpha),
            (F::OneMinusSrcAlpha, F::SrcAlpha),
            (F::Src, F::OneMinusSrc),
            (F::OneMinusDst, F::Dst),
            (F::Constant, F::OneMinusConstant),
            (F::One, F::Zero),
        ];
        let (src_factor, dst_factor) = PAIRS[self.random.usize(..PAIRS.len())];
        let component = BlendComponent { src_factor, dst_factor, operation: Op::Add };
        let mut inputs = self.questions.ask();
        inputs.blend = Some(BlendState { color: component, alpha: component });
        Some(inputs)
    }

    /// A denormal of binary32 times a number that brings it into the target's range, and results that are denormal.
    fn denormal(&mut self) -> Option<ColorInputs> {
        if !matches!(self.format.channels()[0], ChannelKind::Float(_)) {
            return None;
        }
        let product = BlendComponent { src_factor: F::SrcAlpha, dst_factor: F::Zero, operation: Op::Add };
        let sum = BlendComponent { src_factor: F::One, dst_factor: F::One, operation: Op::Add };
        let mut inputs = self.questions.ask();
        let component = if self.random.bool() { product } else { sum };
        inputs.blend = Some(BlendState { color: component, alpha: component });
        let tiny = |random: &mut Rng| f32::from_bits(random.u32(1..0x0080_0000) | random.u32(..2) << 31);
        inputs.src = std::array::from_fn(|_| tiny(&mut self.random));
        inputs.src[3] = f32::from_bits(self.random.u32(0x7e00_0000..0x7f00_0000));
        for (i, kind) in self.format.channels().into_iter().enumerate() {
            inputs.dst[i] = match kind {
                ChannelKind::Float(FloatLayout::SINGLE) => tiny(&mut self.random).to_bits(),
                ChannelKind::Float(layout) => layout.encode(f64::from(self.random.f32()), Rounding::TowardZero),
                _ => inputs.dst[i],
            };
        }
        Some(inputs)
    }

    /// Sources that overflow a 32-bit integer when they are scaled.
    fn huge(&mut self) -> Option<ColorInputs> {
        let mut inputs = self.questions.ask();
        let large = |random: &mut Rng| match random.u8(..3) {
            0 => f32::INFINITY,
            1 => f32::from_bits(random.u32(0x4b00_0000..0x7f00_0000)),
            _ => random.f32(),
        };
        inputs.src = std::array::from_fn(|_| large(&mut self.random));
        Some(inputs)
    }

    /// Unblended colors between 0 and 1, for curves.
    fn linear(&mut self) -> Option<ColorInputs> {
        let mut inputs = self.questions.ask();
        inputs.blend = None;
        inputs.src = std::array::from_fn(|_| self.random.f32());
        Some(inputs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::layout::FORMATS;
    use crate::model::llvmpipe::{Estimate, Generation, Llvmpipe, VectorWidth};

    fn format(name: &str) -> ColorFormat {
        ColorFormat::from_name(name).expect("a format")
    }

    fn formats_that_tell(a: &Llvmpipe, b: &Llvmpipe) -> Vec<&'static str> {
        FORMATS
            .iter()
            .filter(|(name, _)| !telling(a, b, format(name), 8, 1).is_empty())
            .map(|(name, _)| *name)
            .collect()
    }

    #[test]
    fn generations_are_told_apart_on_every_format_whose_rules_differ() {
        let of = |generation| Llvmpipe { generation, ..Llvmpipe::default() };
        let [old, middle, new] = Generation::ALL.map(of);
        for (name, _) in FORMATS {
            let words = |model: &Llvmpipe| model.generation.rules().words(format(name));
            let differ = words(&middle) != words(&new);
            assert_eq!(!telling(&middle, &new, format(name), 8, 1).is_empty(), differ, "{name}: 25.0 and 26.1");
            assert_eq!(!telling(&old, &new, format(name), 8, 1).is_empty(), differ, "{name}: 22.3 and 26.1");
        }
        assert!(formats_that_tell(&old, &middle).is_empty(), "22.3 and 25.0 blend alike where both are decided");
    }

    #[test]
    fn widths_and_processors_are_told_apart_where_they_show() {
        let narrow = Llvmpipe { vector_width: VectorWidth::Bits128, ..Llvmpipe::default() };
        let wide = formats_that_tell(&Llvmpipe::default(), &narrow);
        assert_eq!(wide, ["r8unorm", "rg8unorm", "rgba8unorm", "bgra8unorm"], "8-bit unorm");
        let amd = Llvmpipe { estimate: Estimate::AmdZen5, ..Llvmpipe::default() };
        assert_eq!(formats_that_tell(&Llvmpipe::default(), &amd), ["rgba8unorm-srgb", "bgra8unorm-srgb"], "sRGB");
    }

    #[test]
    fn equal_seeds_find_equal_questions() {
        let old = Llvmpipe { generation: Generation::Mesa22_3, ..Llvmpipe::default() };
        let find = |seed| telling(&old, &Llvmpipe::default(), format("rg16unorm"), 6, seed);
        let bits = |found: Vec<ColorInputs>| found.iter().map(|q| q.src.map(f32::to_bits)).collect::<Vec<_>>();
        assert!(!find(1).is_empty());
        assert_eq!(bits(find(3)), bits(find(3)));
    }
}
