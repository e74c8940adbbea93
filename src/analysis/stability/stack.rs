//! Stacks of translucent layers: how the error grows with their number, and where it stagnates.
//!
//! The stored red channel is compared with the same layers blended in real numbers (carried in binary64, off by less
//! than 2^-50 a layer), in codes of an 8-bit target whatever the format, so that formats compare.

use rayon::prelude::*;
use serde::Serialize;
use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

use super::to_f32;
use crate::format::ColorFormat;
use crate::model::{ColorInputs, NumericModel};
use crate::scene::display::value;

/// The alphas of a stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// 1/255 everywhere, the thinnest layer of 8 bits, and one color.
    Thin,
    /// 1/255 everywhere and colors spread over 0 to 1, whose roundings fall either way.
    ThinSpread,
    /// 0.025 everywhere and one color: a slow fade.
    Fade,
    /// 1/255 and 254/255 in turn; colors spread.
    Stiff,
    /// 1/2, 1/4 ... 2^-16, again and again; colors spread.
    Geometric,
    /// Spread over 0 to 1, colors too.
    Mixed,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 6] = [Self::Thin, Self::ThinSpread, Self::Fade, Self::Stiff, Self::Geometric, Self::Mixed];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Thin => "all 1/255, one color",
            Self::ThinSpread => "all 1/255",
            Self::Fade => "all 0.025, one color",
            Self::Stiff => "1/255, 254/255 in turn",
            Self::Geometric => "1/2 to 2^-16",
            Self::Mixed => "spread over 0 to 1",
        }
    }

    /// Color and alpha of layer `i`, as a shader outputs them.
    fn layer(self, i: u32) -> (f32, f32) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        const SILVER: f64 = 0.414_213_562_373_095_1;
        let alpha = match self {
            Self::Thin | Self::ThinSpread => 1.0 / 255.0,
            Self::Fade => 0.025,
            Self::Stiff if i.is_multiple_of(2) => 1.0 / 255.0,
            Self::Stiff => 254.0 / 255.0,
            Self::Geometric => (-1.0 - f64::from(i % 16)).exp2(),
            Self::Mixed => (f64::from(i + 1) * SILVER).fract(),
        };
        let color = match self {
            Self::Thin | Self::Fade => 0.75,
            _ => (f64::from(i) * GOLDEN).fract(),
        };
        (to_f32(color), to_f32(alpha))
    }
}

/// The direction a stack is drawn in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Straight over: `src-alpha`, `one-minus-src-alpha`.
    BackToFront,
    /// Premultiplied under: `one-minus-dst-alpha`, `one`; needs a stored alpha.
    FrontToBack,
}

impl Direction {
    /// Both directions.
    pub const ALL: [Self; 2] = [Self::BackToFront, Self::FrontToBack];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BackToFront => "back to front",
            Self::FrontToBack => "front to back",
        }
    }

    fn state(self) -> BlendState {
        match self {
            Self::BackToFront => BlendState::ALPHA_BLENDING,
            Self::FrontToBack => {
                let under = BlendComponent {
                    src_factor: BlendFactor::OneMinusDstAlpha,
                    dst_factor: BlendFactor::One,
                    operation: BlendOperation::Add,
                };
                BlendState { color: under, alpha: under }
            }
        }
    }
}

/// One stack in one model on one format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StackRow {
    /// The alphas.
    pub family: Family,
    /// The direction.
    pub direction: Direction,
    /// The format.
    pub format: &'static str,
    /// The numeric model.
    pub model: String,
    /// Layer counts and the error there, in codes of an 8-bit target.
    pub errors: Vec<(u32, f64)>,
    /// The largest error after any layer, in the same codes.
    pub worst: f64,
    /// The last layer that changed the stored color, if the real color moved by more than an 8-bit code after it.
    pub stagnates_at: Option<u32>,
}

/// The formats stacks are drawn on.
pub const FORMATS: [&str; 6] =
    ["rgba8unorm", "rgba8unorm-srgb", "rgb10a2unorm", "rg11b10ufloat", "rgba16float", "rgba32float"];

/// Every family, direction and format in every model that covers it; `layers` is the deepest stack.
#[must_use]
pub fn stacks(models: &[&dyn NumericModel], layers: u32) -> Vec<StackRow> {
    let mut questions = Vec::new();
    for family in Family::ALL {
        for direction in Direction::ALL {
            for name in FORMATS {
                let Ok(format) = ColorFormat::from_name(name) else { continue };
                // Without a stored alpha, front to back draws nothing; with 2 bits of it, nothing of use.
                let alpha = format.channels()[3].bits();
                if direction == Direction::FrontToBack && alpha < 8 {
                    continue;
                }
                let covering = models.iter().filter(|model| model.supports(format, Some(&direction.state())).is_ok());
                questions.extend(covering.map(|model| (family, direction, format, *model)));
            }
        }
    }
    questions
        .into_par_iter()
        .map(|(family, direction, format, model)| stack(family, direction, format, model, layers))
        .collect()
}

/// One stack.
#[must_use]
pub fn stack(
    family: Family,
    direction: Direction,
    format: ColorFormat,
    model: &dyn NumericModel,
    layers: u32,
) -> StackRow {
    let kind = format.channels()[0];
    let mut inputs = ColorInputs {
        format,
        blend: Some(direction.state()),
        constant: [0.0; 4],
        src: [0.0; 4],
        src1: [0.0; 4],
        dst: [0; 4],
    };
    let mut real = Real::default();
    let (mut errors, mut worst) = (Vec::new(), 0.0_f64);
    let mut last_change = (0, 0.0);
    let mut next_shown = 1;
    for count in 1..=layers {
        // The order of one and the same stack: layer 0 is at the back.
        let (color, alpha) = match direction {
            Direction::BackToFront => family.layer(count - 1),
            Direction::FrontToBack => family.layer(layers - count),
        };
        let before = inputs.dst;
        let color = match direction {
            Direction::BackToFront => color,
            Direction::FrontToBack => to_f32(f64::from(color) * f64::from(alpha)),
        };
        inputs.src = [color, color, color, alpha];
        inputs.dst = model.merge_color(&inputs);
        real.draw(direction, f64::from(color), f64::from(alpha));
        let error = 255.0 * (value(kind, inputs.dst[0]) - real.color).abs();
        worst = worst.max(error);
        if inputs.dst[0] != before[0] {
            last_change = (count, real.color);
        }
        if count == next_shown || count == layers {
            errors.push((count, error));
            next_shown = count * 2;
        }
    }
    let moved = 255.0 * (real.color - last_change.1).abs();
    StackRow {
        family,
        direction,
        format: format.name(),
        model: model.name(),
        errors,
        worst,
        stagnates_at: (moved > 1.0).then_some(last_change.0),
    }
}

/// Color and alpha in real numbers.
#[derive(Default)]
struct Real {
    color: f64,
    alpha: f64,
}

impl Real {
    fn draw(&mut self, direction: Direction, color: f64, alpha: f64) {
        match direction {
            Direction::BackToFront => self.color = alpha * color + (1.0 - alpha) * self.color,
            Direction::FrontToBack => {
                let through = 1.0 - self.alpha;
                self.color += through * color;
                self.alpha += through * alpha;
            }
        }
    }
}

/// What the rows show, in a sentence.
#[must_use]
pub fn finding(rows: &[StackRow]) -> String {
    let find = |family, format: &str| {
        rows.iter().find(|row| {
            row.family == family
                && row.model == "exact"
                && row.direction == Direction::BackToFront
                && row.format == format
        })
    };
    let (Some(eight), Some(spread), Some(half)) =
        (find(Family::Thin, "rgba8unorm"), find(Family::ThinSpread, "rgba8unorm"), find(Family::Thin, "rgba16float"))
    else {
        return String::new();
    };
    let layers = eight.errors.last().map_or(0, |(layers, _)| *layers);
    let stop = eight.stagnates_at.map_or(String::new(), |layer| format!(", stuck from layer {layer} on"));
    format!(
        "{layers} layers of alpha 1/255 and one color, each rounded correctly, end up to {:.1} codes off on an 8-bit \
         target{stop}; where colors vary the roundings fall either way and stay within {:.1}; a half target stays within \
         {:.2} of such codes.",
        eight.worst, spread.worst, half.worst
    )
}
