//! Vectors made from random states and inputs that look for trouble: boundaries, ties, special values.

use wgpu_types::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorWrites, CompareFunction, DepthBiasState,
    DepthStencilState, StencilFaceState, StencilState,
};

use super::{ColorDraw, DepthLine, Kind, LayersLine, Line, VectorLine};
use crate::format::depth::DepthKind;
use crate::format::{ChannelKind, ColorFormat, DepthFormat, FloatLayout, TargetClass, snorm, unorm};
use crate::merger::depth_stencil::DepthStencil;
use crate::state::{reads_second_source, spelling};

/// A seeded source of vector lines.
#[derive(Clone, Debug)]
pub struct Generator {
    random: fastrand::Rng,
}

/// Color lines for each format in turn, without `out`.
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

/// Lines of one kind for each format of that kind, in turn, without results. Equal seeds give equal lines.
#[must_use]
pub fn generate_kind(
    kind: Kind,
    seed: u64,
    colors: &[ColorFormat],
    depths: &[DepthFormat],
    lines_per_format: usize,
    texels: usize,
) -> Vec<Line> {
    let mut generator = Generator::new(seed);
    let mut lines = Vec::new();
    let each = |format: &ColorFormat| std::iter::repeat_n(*format, lines_per_format);
    match kind {
        Kind::Color => {
            lines.extend(colors.iter().flat_map(each).map(|format| Line::Color(generator.line(format, texels))));
        }
        Kind::Layers => {
            lines.extend(colors.iter().flat_map(each).map(|format| Line::Layers(generator.layers(format, texels))));
        }
        Kind::Depth => {
            let formats = depths.iter().flat_map(|format| std::iter::repeat_n(*format, lines_per_format));
            lines.extend(formats.map(|format| Line::Depth(generator.depth(format, texels))));
        }
    }
    lines
}

impl Generator {
    /// A generator; equal seeds give equal lines.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { random: fastrand::Rng::with_seed(seed) }
    }

    /// A line with a random state.
    pub fn line(&mut self, format: ColorFormat, texels: usize) -> VectorLine {
        let ColorDraw { blend, mask, constant, src, src1 } = self.draw(format, texels);
        VectorLine { format, blend, mask, constant, src, src1, dst: self.texels(format, texels), out: None }
    }

    /// Two to five draws with random states.
    pub fn layers(&mut self, format: ColorFormat, texels: usize) -> LayersLine {
        let layers = (0..self.random.u32(2..=5)).map(|_| self.draw(format, texels)).collect();
        LayersLine { format, layers, dst: self.texels(format, texels), out: None }
    }

    /// Depths against stored depths, many of them equal, with random tests and operations.
    pub fn depth(&mut self, format: DepthFormat, texels: usize) -> DepthLine {
        let (has_depth, has_stencil) = (format.depth().is_some(), format.has_stencil());
        let state = DepthStencilState {
            format: format.texture_format(),
            depth_write_enabled: has_depth.then(|| self.random.u8(..4) > 0),
            depth_compare: has_depth.then(|| self.comparison()),
            stencil: if has_stencil { self.stencil() } else { StencilState::default() },
            bias: DepthBiasState::default(),
        };
        let z: Vec<f32> = (0..texels).map(|_| self.z(format)).collect();
        let stored = |generator: &mut Self, z: f32| DepthStencil {
            depth: format.depth().map_or(0, |kind| {
                // As often as not the fragment's own code, so that equality is met.
                let z = if generator.random.bool() { z } else { generator.z(format) };
                generator.reachable(kind, z)
            }),
            stencil: if has_stencil { generator.random.u8(..) } else { 0 },
        };
        let dst = z.iter().map(|z| stored(self, *z)).collect();
        let front = self.random.bool().then(|| (0..texels).map(|_| self.random.bool()).collect());
        let reference = self.random.u8(..);
        DepthLine { format, state, reference, range: [0.0, 1.0], z, front, dst, out: None, passed: None }
    }

    /// A code that a draw can store and that a read-back tells apart on every driver: of the last two 24-bit codes, which
    /// load alike on llvmpipe, only the last; no denormal.
    fn reachable(&mut self, kind: DepthKind, z: f32) -> u32 {
        let code = kind.encode(z, [0.0, 1.0]);
        match kind {
            DepthKind::Unorm(24) if code == 0x00ff_fffe => 0x00ff_ffff,
            DepthKind::Float32 if f32::from_bits(code) < f32::MIN_POSITIVE => 0,
            _ => code,
        }
    }

    /// A fragment's depth: codes and ties, give or take an ulp; uniform; out of range; something extreme.
    fn z(&mut self, format: DepthFormat) -> f32 {
        const SPECIAL: [f32; 10] =
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-45, 1e-40, -0.5, 1.5, 1.0, 0.0];
        let bits = match format.depth() {
            Some(DepthKind::Unorm(bits)) => bits,
            _ => 8,
        };
        let steps = unorm::steps(bits);
        match self.random.u8(..8) {
            0 => SPECIAL[self.random.usize(..SPECIAL.len())],
            1..=3 => {
                let halves = f64::from(self.random.u32(..=2 * steps)) / 2.0;
                let near = narrow(halves / f64::from(steps));
                [near.next_down(), near, near.next_up()][self.random.usize(..3)]
            }
            _ => narrow(self.random.f64()),
        }
    }

    fn comparison(&mut self) -> CompareFunction {
        let all: Vec<_> = spelling::compare_functions().collect();
        all[self.random.usize(..all.len())]
    }

    fn stencil(&mut self) -> StencilState {
        let operations: Vec<_> = spelling::stencil_operations().collect();
        let mut face = || {
            let mut operation = || operations[self.random.usize(..operations.len())];
            let (fail_op, depth_fail_op, pass_op) = (operation(), operation(), operation());
            StencilFaceState { compare: self.comparison(), fail_op, depth_fail_op, pass_op }
        };
        let (front, back) = (face(), face());
        let mut mask = || if self.random.bool() { 0xff } else { u32::from(self.random.u8(..)) };
        let (read_mask, write_mask) = (mask(), mask());
        StencilState { front, back, read_mask, write_mask }
    }

    /// A random state, and fragments for every texel.
    fn draw(&mut self, format: ColorFormat, texels: usize) -> ColorDraw {
        let blend = (self.random.u8(..8) > 0).then(|| self.blend());
        let dual = blend.as_ref().is_some_and(reads_second_source);
        let mask =
            if self.random.bool() { ColorWrites::ALL } else { ColorWrites::from_bits_truncate(self.random.u32(..16)) };
        let mut colors =
            |n: usize| -> Vec<[f32; 4]> { (0..n).map(|_| std::array::from_fn(|_| self.input(format))).collect() };
        let constant = colors(1)[0];
        let src = colors(texels);
        let src1 = dual.then(|| colors(texels));
        ColorDraw { blend, mask, constant, src, src1 }
    }

    /// Raw texels.
    fn texels(&mut self, format: ColorFormat, texels: usize) -> Vec<u8> {
        let mut bytes = vec![0; texels * format.bytes_per_texel()];
        for texel in bytes.chunks_exact_mut(format.bytes_per_texel()) {
            let codes = format.channels().map(|kind| self.code(kind));
            format.pack(codes, texel);
        }
        bytes
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
    use crate::format::depth::DEPTH_FORMATS;
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
    fn lines_of_every_kind_survive_writing_and_reading() {
        let colors: Vec<ColorFormat> = FORMATS.iter().map(|(_, f)| ColorFormat::new(*f).expect("listed")).collect();
        let depths: Vec<DepthFormat> =
            DEPTH_FORMATS.iter().map(|(_, f)| DepthFormat::new(*f).expect("listed")).collect();
        for kind in [Kind::Color, Kind::Depth, Kind::Layers] {
            for mut line in generate_kind(kind, 3, &colors, &depths, 4, 5) {
                let again = Line::parse(&line.to_json()).expect("written lines parse");
                assert_eq!(again.to_json(), line.to_json(), "without results");
                line.reduce_to(&crate::model::llvmpipe::Llvmpipe::default());
                line.fill(&crate::model::llvmpipe::Llvmpipe::default());
                let again = Line::parse(&line.to_json()).expect("filled lines parse");
                assert_eq!(again.to_json(), line.to_json(), "with results");
                assert_eq!(again.len(), 5, "texels");
            }
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
