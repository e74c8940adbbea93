//! Vectors made from random states and inputs that look for trouble: boundaries, ties, special values.

use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState, ColorWrites};

use super::VectorLine;
use crate::format::{ChannelKind, ColorFormat, FloatLayout, TargetClass, snorm, unorm};
use crate::state::spelling;

/// A seeded source of vector lines.
#[derive(Clone, Debug)]
pub struct Generator {
    random: fastrand::Rng,
}

/// Lines for each format in turn, without `out`.
pub fn generate<'a>(
    seed: u64,
    formats: &'a [ColorFormat],
    lines_per_format: usize,
    texels: usize,
) -> impl Iterator<Item = VectorLine> + 'a {
    let mut generator = Generator::new(seed);
    formats.iter().flat_map(move |format| {
        let lines: Vec<VectorLine> = (0..lines_per_format).map(|_| generator.line(*format, texels)).collect();
        lines
    })
}

impl Generator {
    /// A generator; equal seeds give equal lines.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { random: fastrand::Rng::with_seed(seed) }
    }

    /// A line with a random state.
    pub fn line(&mut self, format: ColorFormat, texels: usize) -> VectorLine {
        let blend = (self.random.u8(..8) > 0).then(|| self.blend());
        let dual = blend.is_some_and(|blend| {
            [blend.color, blend.alpha]
                .iter()
                .any(|c| c.src_factor.ref_second_blend_source() || c.dst_factor.ref_second_blend_source())
        });
        let mask =
            if self.random.bool() { ColorWrites::ALL } else { ColorWrites::from_bits_truncate(self.random.u32(..16)) };
        let mut colors =
            |n: usize| -> Vec<[f32; 4]> { (0..n).map(|_| std::array::from_fn(|_| self.input(format))).collect() };
        let constant = colors(1)[0];
        let src = colors(texels);
        let src1 = dual.then(|| colors(texels));
        let mut dst = vec![0; texels * format.bytes_per_texel()];
        for texel in dst.chunks_exact_mut(format.bytes_per_texel()) {
            let codes = format.channels().map(|kind| self.code(kind));
            format.pack(codes, texel);
        }
        VectorLine { format, blend, mask, constant, src, src1, dst, out: None }
    }

    /// A random blend state that WebGPU admits: min and max with factors one.
    pub fn blend(&mut self) -> BlendState {
        let color = self.component();
        let alpha = if self.random.bool() { color } else { self.component() };
        BlendState { color, alpha }
    }

    fn component(&mut self) -> BlendComponent {
        let factors: Vec<_> = spelling::blend_factors().collect();
        let operations: Vec<_> = spelling::blend_operations().collect();
        let operation = operations[self.random.usize(..operations.len())];
        if matches!(operation, BlendOperation::Min | BlendOperation::Max) {
            // WebGPU's rule for operations that ignore factors.
            return BlendComponent { src_factor: BlendFactor::One, dst_factor: BlendFactor::One, operation };
        }
        let mut factor = || factors[self.random.usize(..factors.len())];
        BlendComponent { src_factor: factor(), dst_factor: factor(), operation }
    }

    /// A shader output: a code's value or a tie, give or take an ulp; uniform; or, now and then, something extreme.
    pub fn input(&mut self, format: ColorFormat) -> f32 {
        const SPECIAL: [f32; 14] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            -0.0,
            f32::MIN_POSITIVE,
            1e-45,
            -1e-40,
            f32::MAX,
            65504.0,
            65520.0,
            -1.0,
            2.0,
            1.000_000_1,
            0.999_999_94,
        ];
        let steps = match format.channels()[0] {
            ChannelKind::Unorm(bits) => unorm::steps(bits),
            ChannelKind::Snorm(bits) => snorm::steps(bits).unsigned_abs(),
            ChannelKind::Srgb | ChannelKind::Float(_) | ChannelKind::Absent => 255,
        };
        let float = format.class() == TargetClass::Float;
        match self.random.u8(..8) {
            0 => SPECIAL[self.random.usize(..SPECIAL.len())],
            1 | 2 => {
                // Code k or the tie above it, on the code scale.
                let halves = f64::from(self.random.u32(..=2 * steps)) / 2.0;
                let near = narrow(halves / f64::from(steps));
                [near.next_down(), near, near.next_up()][self.random.usize(..3)]
            }
            3 if float => {
                // Any magnitude a half can hold, and either sign.
                let exponent = i32::from(self.random.u8(..34)) - 17;
                narrow((self.random.f64() * 2.0 - 1.0) * 2.0_f64.powi(exponent))
            }
            4 if float => f32::from_bits(self.random.u32(..)),
            5 => narrow(self.random.f64() * 3.0 - 1.0),
            _ => narrow(self.random.f64()),
        }
    }

    /// A stored code, the ends more often than the rest.
    fn code(&mut self, kind: ChannelKind) -> u32 {
        let bits = kind.bits();
        if bits == 0 {
            return 0;
        }
        let any = self.random.u32(..) >> (32 - bits);
        match kind {
            ChannelKind::Float(layout) if self.random.u8(..2) == 0 => self.ordinary(layout),
            _ => match self.random.u8(..16) {
                0 => 0,
                1 => u32::MAX >> (32 - bits),
                _ => any,
            },
        }
    }

    /// The code of a number in [0, 2).
    fn ordinary(&mut self, layout: FloatLayout) -> u32 {
        layout.encode(self.random.f64() * 2.0, crate::format::Rounding::TowardZero)
    }
}

fn narrow(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is the purpose")]
    let rounded = x as f32;
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::layout::FORMATS;

    #[test]
    fn generated_lines_survive_writing_and_reading() {
        let formats: Vec<ColorFormat> = FORMATS.iter().map(|(_, f)| ColorFormat::new(*f).expect("listed")).collect();
        for line in generate(1, &formats, 4, 5) {
            let again = VectorLine::parse(&line.to_json()).expect("written lines parse");
            assert_eq!(again.to_json(), line.to_json(), "{}", line.format.name());
            assert_eq!(again.blend, line.blend, "{}", line.format.name());
        }
    }

    #[test]
    fn equal_seeds_give_equal_lines() {
        let format = ColorFormat::from_name("rgba8unorm").expect("known");
        let line = |seed| Generator::new(seed).line(format, 3).to_json();
        assert_eq!(line(7), line(7), "same seed");
        assert_ne!(line(7), line(8), "another seed");
    }
}
