//! Spans of fragments under any state: kernels where they fit, the reference for everything else.

use crate::format::depth::DepthKind;
use crate::fragment::Fragment;
use crate::merger::MergerError;
use crate::merger::depth_stencil::stencil_matters;
use crate::model::NumericModel;
use crate::plan::{Planned, TargetPlan};
use crate::state::{AlphaTest, MAX_COLOR_TARGETS, MergerState};
use crate::target::Framebuffer;

use super::unorm8::numbers::Numbers;
use super::{Isa, Kernel, TEXEL, depth, half};

/// The same output of all fragments of a span, in order from left to right.
#[derive(Clone, Copy, Debug)]
pub enum Colors<'a> {
    /// RGBA codes, four bytes a fragment; the code k is the number k / 255, linear.
    Unorm8(&'a [u8]),
    /// Red, green, blue and alpha, any number, as long as the span each.
    Planes([&'a [f32]; 4]),
}

impl Colors<'_> {
    /// Fragments.
    fn len(&self) -> usize {
        match self {
            Self::Unorm8(codes) => codes.len() / 4,
            Self::Planes([red, ..]) => red.len(),
        }
    }

    fn fits(&self, len: usize) -> bool {
        match self {
            Self::Unorm8(codes) => codes.len() == 4 * len,
            Self::Planes(planes) => planes.iter().all(|plane| plane.len() == len),
        }
    }

    /// As planes; codes are written to `memory` first.
    fn planes<'m>(self, range: std::ops::Range<usize>, memory: &'m mut [Vec<f32>; 4]) -> [&'m [f32]; 4]
    where
        Self: 'm,
    {
        match self {
            Self::Planes(planes) => planes.map(|plane| &plane[range.clone()]),
            Self::Unorm8(codes) => {
                let codes = &codes[TEXEL * range.start..TEXEL * range.end];
                for (channel, plane) in memory.iter_mut().enumerate() {
                    plane.clear();
                    plane.extend(codes.chunks_exact(TEXEL).map(|texel| f32::from(texel[channel]) / 255.0));
                }
                memory.each_ref().map(Vec::as_slice)
            }
        }
    }

    fn alpha(&self, i: usize) -> f32 {
        match self {
            Self::Unorm8(codes) => f32::from(codes[4 * i + 3]) / 255.0,
            Self::Planes(planes) => planes[3][i],
        }
    }

    fn rgba(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Unorm8(codes) => std::array::from_fn(|channel| f32::from(codes[4 * i + channel]) / 255.0),
            Self::Planes(planes) => planes.map(|plane| plane[i]),
        }
    }
}

/// Fragments side by side on one row of the target, structure of arrays; all fully cover their texels.
#[derive(Clone, Copy, Debug)]
pub struct Span<'a> {
    /// Column of the first fragment.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Outputs by location; missing ones are zeros. The first one's length is the span's, and every span has it.
    pub colors: &'a [Colors<'a>],
    /// The second source of dual-source blending; zeros if missing.
    pub src1: Option<Colors<'a>>,
    /// Depth; zeros if missing.
    pub depth: Option<&'a [f32]>,
    /// 0 where the shader discarded the fragment; none if missing.
    pub keep: Option<&'a [u8]>,
    /// Whether the primitive faces the viewer.
    pub front_facing: bool,
}

impl<'a> Span<'a> {
    /// Front-facing fragments of one output, none discarded, at depth 0.
    #[must_use]
    pub fn new(x: u32, y: u32, colors: &'a [Colors<'a>]) -> Self {
        Self { x, y, colors, src1: None, depth: None, keep: None, front_facing: true }
    }

    fn len(&self) -> usize {
        self.colors[0].len()
    }

    fn kept(&self, i: usize) -> bool {
        self.keep.is_none_or(|keep| keep[i] != 0)
    }

    /// Fragment `i` as the reference takes it.
    fn fragment(&self, i: usize) -> Fragment {
        let mut outputs = [[0.0; 4]; MAX_COLOR_TARGETS];
        for (output, colors) in outputs.iter_mut().zip(self.colors) {
            *output = colors.rgba(i);
        }
        Fragment {
            outputs,
            src1: self.src1.map_or([0.0; 4], |src1| src1.rgba(i)),
            depth: self.depth.map_or(0.0, |depth| depth[i]),
            front_facing: self.front_facing,
            discarded: !self.kept(i),
            ..Fragment::default()
        }
    }

    fn check(&self, width: u32) {
        let len = self.len();
        assert!(self.colors.iter().chain(&self.src1).all(|colors| colors.fits(len)), "outputs as long as the span");
        assert!(self.depth.is_none_or(|depth| depth.len() == len), "a depth a fragment");
        assert!(self.keep.is_none_or(|keep| keep.len() == len), "a byte of `keep` a fragment");
        assert!(self.x as usize + len <= width as usize, "the span ends inside the target");
    }
}

/// Merges spans as [`crate::merger::Merger`] merges their fragments one by one, and faster.
///
/// Stencil tests, several samples and alpha to coverage are left to the reference; so are targets without a
/// [`Kernel`], and fragments whose numbers no source of a kernel stands for: an 8-bit code on sRGB targets, a half on
/// half-float ones. On 8-bit unorm targets with four channels every number has a kernel, in `exact` and `f32` too.
#[derive(Debug)]
pub struct SpanMerger<'a> {
    planned: Planned<'a>,
    state: &'a MergerState,
    /// By color target.
    kernels: Vec<Option<Kernel>>,
    /// Those that take any number as it is.
    numbers: Vec<Option<Numbers>>,
    /// Whether alpha test and depth test are all that can stop a fragment.
    by_rows: bool,
    rows: Rows,
}

/// Memory for the rows of a span, kept between spans.
#[derive(Debug, Default)]
struct Rows {
    /// 255 where a fragment lives.
    keep: Vec<u8>,
    /// The same, less those that the reference merged.
    left: Vec<u8>,
    codes: Vec<u32>,
    src: Vec<u8>,
    src1: Vec<u8>,
    /// Numbers that came as codes.
    planes: [Vec<f32>; 4],
    planes1: [Vec<f32>; 4],
}

impl<'a> SpanMerger<'a> {
    /// Compiles a state for a model and a set of targets.
    ///
    /// # Errors
    /// As [`crate::merger::Merger::new`].
    pub fn new(
        state: &'a MergerState,
        model: &'a dyn NumericModel,
        targets: &Framebuffer,
    ) -> Result<Self, MergerError> {
        let planned = Planned::new(state, model, targets)?;
        let constant = state.dynamic.blend_constant;
        let kernel = |target: &Option<_>| target.as_ref().and_then(|target| Kernel::new(target, constant, model));
        let tests_stencil = state.depth_stencil.as_ref().is_some_and(|state| stencil_matters(&state.stencil));
        let by_rows = targets.extent.samples == 1 && !state.multisample.alpha_to_coverage_enabled && !tests_stencil;
        let kernels = state.targets.iter().map(kernel).collect();
        let numbers = state.targets.iter().map(|target| Numbers::new(target.as_ref()?, constant, model.float_rule()?));
        let numbers = numbers.collect();
        Ok(Self { planned, state, kernels, numbers, by_rows, rows: Rows::default() })
    }

    /// The color targets that kernels write, by location.
    pub fn kernels(&self) -> impl Iterator<Item = bool> + '_ {
        let both = self.kernels.iter().zip(&self.numbers);
        both.map(|(kernel, numbers)| self.by_rows && (kernel.is_some() || numbers.is_some()))
    }

    /// Merges a span.
    ///
    /// # Panics
    /// When the span has no output, its slices differ in length, it leaves `targets`, or `targets` are not those given to
    /// [`SpanMerger::new`].
    pub fn merge(&mut self, span: &Span<'_>, targets: &mut Framebuffer) {
        self.merge_on(Isa::best(), span, targets);
    }

    /// [`merge`](Self::merge) on a given instruction set.
    ///
    /// # Panics
    /// As `merge`, and when the machine lacks the instruction set.
    pub fn merge_on(&mut self, isa: Isa, span: &Span<'_>, targets: &mut Framebuffer) {
        span.check(targets.extent.width);
        let covered = self.covered(span);
        if covered.is_empty() {
            return;
        }
        if !self.by_rows || !compares_as_codes(span, covered.clone(), targets) {
            for i in covered {
                self.planned.merger.merge(&span.fragment(i), column(span, i), span.y, targets);
            }
            return;
        }
        self.test(isa, span, covered.clone(), targets);
        for index in 0..self.kernels.len() {
            if let Some(plan) = self.planned.plan().targets[index]
                && (plan.write || plan.rewrite)
            {
                self.write(isa, span, covered.clone(), index, plan, targets);
            }
        }
    }

    /// Stage 1: fragments inside the scissor, unless the sample mask covers none.
    fn covered(&self, span: &Span<'_>) -> std::ops::Range<usize> {
        let inside = |i: usize| self.state.dynamic.scissor.is_none_or(|s| s.contains(column(span, i), span.y));
        if self.by_rows && self.planned.merger.model.sample_mask(&self.state.multisample) & 1 == 0 {
            return 0..0;
        }
        let len = span.len();
        let first = (0..len).find(|i| inside(*i)).unwrap_or(len);
        first..(first..len).find(|i| !inside(*i)).unwrap_or(len)
    }

    /// Stages 2 and 3: who lives, in `rows.keep`.
    fn test(&mut self, isa: Isa, span: &Span<'_>, covered: std::ops::Range<usize>, targets: &mut Framebuffer) {
        let Rows { keep, codes, .. } = &mut self.rows;
        keep.clear();
        match (self.state.alpha_test, span.keep) {
            (AlphaTest::Off, None) => keep.resize(covered.len(), u8::MAX),
            (test, _) => {
                let lives = |i: usize| span.kept(i) && test.passes(span.colors[0].alpha(i));
                keep.extend(covered.clone().map(|i| if lives(i) { u8::MAX } else { 0 }));
            }
        }
        let (Some(state), Some(target)) = (&self.state.depth_stencil, &mut targets.depth_stencil) else { return };
        let Some(kind) = target.format().depth() else { return };
        let model = self.planned.merger.model();
        let range = self.state.dynamic.depth_range;
        let z = |i: usize| span.depth.map_or(0.0, |depth| depth[i]);
        codes.clear();
        codes.extend(covered.clone().map(|i| model.depth_code(kind, z(i), range)));
        let first = target.extent().index(column(span, covered.start), span.y, 0);
        let stored = &mut target.depth_mut()[first..first + covered.len()];
        let write = state.depth_write_enabled == Some(true);
        depth::test_row_on(isa, state.depth_compare.unwrap_or_default(), write, codes, stored, keep);
    }

    /// Stages 4 to 7 on one target.
    fn write(
        &mut self,
        isa: Isa,
        span: &Span<'_>,
        covered: std::ops::Range<usize>,
        index: usize,
        plan: TargetPlan,
        targets: &mut Framebuffer,
    ) {
        let kernel = self.kernels[index].as_ref().filter(|_| plan.write);
        let numbers = self.numbers[index].as_ref().filter(|_| plan.write);
        let output = span.colors.get(index);
        if let (Some(numbers), Some(output), Some(Some(target))) = (numbers, output, targets.colors.get_mut(index))
            && (kernel.is_none() || matches!(output, Colors::Planes(_)))
        {
            let Rows { keep, planes, planes1, .. } = &mut self.rows;
            let first = target.extent().index(column(span, covered.start), span.y, 0) * TEXEL;
            let dst = &mut target.bytes_mut()[first..][..covered.len() * TEXEL];
            let src = output.planes(covered.clone(), planes);
            let src1 = span.src1.filter(|_| numbers.reads_second_source()).map(|src1| src1.planes(covered, planes1));
            let keep = keep.contains(&0).then_some(keep.as_slice());
            return numbers.merge(isa, src, src1, keep, dst);
        }
        let planned = &self.planned;
        let Rows { keep, left, src, src1, .. } = &mut self.rows;
        left.clone_from(keep);
        let straight = kernel.and_then(|kernel| match output {
            Some(Colors::Unorm8(codes)) if kernel.takes_rgba_codes() && !kernel.reads_second_source() => {
                Some(&codes[TEXEL * covered.start..TEXEL * covered.end])
            }
            _ => None,
        });
        let converted = match (kernel, output) {
            (Some(kernel), Some(Colors::Planes(planes))) if !kernel.reads_second_source() => {
                kernel.sources(planes.map(|plane| &plane[covered.clone()]), src)
            }
            _ => false,
        };
        if straight.is_none() && !converted {
            src.clear();
            src1.clear();
            for (place, i) in covered.clone().enumerate() {
                let lives = keep[place] != 0;
                let texels = kernel.and_then(|kernel| {
                    if !lives {
                        return Some(([0; half::TEXEL], [0; half::TEXEL]));
                    }
                    let first = kernel.source(output.map_or([0.0; 4], |output| output.rgba(i)))?;
                    let second = if kernel.reads_second_source() {
                        kernel.source(span.src1.map_or([0.0; 4], |src1| src1.rgba(i)))?
                    } else {
                        [0; half::TEXEL]
                    };
                    Some((first, second))
                });
                if texels.is_none() {
                    // The reference goes first: a kernel may rewrite what it leaves alone.
                    planned.write_color(&span.fragment(i), index, &plan, lives, (column(span, i), span.y, 0), targets);
                    left[place] = 0;
                }
                if let Some(kernel) = kernel {
                    let (first, second) = texels.unwrap_or_default();
                    src.extend_from_slice(&first[..kernel.texel()]);
                    src1.extend_from_slice(&second[..kernel.texel()]);
                }
            }
        }
        let (Some(kernel), Some(Some(target))) = (kernel, targets.colors.get_mut(index)) else { return };
        let first = target.extent().index(column(span, covered.start), span.y, 0) * kernel.texel();
        let dst = &mut target.bytes_mut()[first..][..covered.len() * kernel.texel()];
        let second = kernel.reads_second_source().then_some(src1.as_slice());
        let all = left.iter().all(|byte| *byte != 0);
        kernel.merge_row_on(isa, straight.unwrap_or(src), second, (!all).then_some(left), dst);
    }
}

fn column(span: &Span<'_>, i: usize) -> u32 {
    span.x + u32::try_from(i).expect("inside the target")
}

/// Whether what is stored under the fragments compares as its bits do: all but negative numbers and NaN.
fn compares_as_codes(span: &Span<'_>, covered: std::ops::Range<usize>, targets: &Framebuffer) -> bool {
    let Some(target) = &targets.depth_stencil else { return true };
    if target.format().depth() != Some(DepthKind::Float32) {
        return true;
    }
    let first = target.extent().index(column(span, covered.start), span.y, 0);
    target.depth()[first..first + covered.len()].iter().all(|bits| *bits <= f32::INFINITY.to_bits())
}
