//! Whether a texel read back is what a model stores.

use wgpu_types::ColorWrites;

use super::{ColorInputs, NumericModel};
use crate::format::{ChannelKind, Codes, ColorFormat};
use crate::merger::write_mask;

/// How codes that were read back relate to a model's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Agreement {
    /// They are the model's.
    Same,
    /// The model says that the driver's result depends on its history, and they are one of the possible results: neither a
    /// match nor a mismatch.
    Undecided,
    /// They are not the model's.
    Different,
}

impl From<bool> for Agreement {
    fn from(same: bool) -> Self {
        if same { Self::Same } else { Self::Different }
    }
}

/// Whether two texels agree: bit for bit, but any NaN of a float channel equals any NaN.
#[must_use]
pub fn same_codes(format: ColorFormat, a: Codes, b: Codes) -> bool {
    a == b
        || format.channels().into_iter().enumerate().all(|(i, kind)| match kind {
            ChannelKind::Float(layout) => a[i] == b[i] || (layout.is_nan(a[i]) && layout.is_nan(b[i])),
            _ => a[i] == b[i],
        })
}

/// Compares what was stored for `inputs` under a write mask with the model.
#[must_use]
pub fn agreement(model: &dyn NumericModel, inputs: &ColorInputs, mask: ColorWrites, got: Codes) -> Agreement {
    let is = |codes| same_codes(inputs.format, write_mask::select(mask, inputs.dst, codes), got);
    let same = is(model.merge_color(inputs));
    match model.alternative(inputs) {
        None => same.into(),
        // The mask may hide where the two differ.
        Some(other) if same && is(other) => Agreement::Same,
        Some(other) if same || is(other) => Agreement::Undecided,
        Some(_) => Agreement::Different,
    }
}

/// Compares what several draws left of one texel with the model. `draws` are the draws' inputs over given codes and their
/// write masks, in order; `before` are the codes they began with.
#[must_use]
pub fn agreement_of_layers(
    model: &dyn NumericModel,
    format: ColorFormat,
    draws: impl Iterator<Item = (impl Fn(Codes) -> ColorInputs, ColorWrites)>,
    before: Codes,
    got: Codes,
) -> Agreement {
    let mut possible = vec![before];
    for (inputs, mask) in draws {
        let mut next: Vec<Codes> = Vec::new();
        for codes in possible {
            let inputs = inputs(codes);
            for result in std::iter::once(model.merge_color(&inputs)).chain(model.alternative(&inputs)) {
                let result = write_mask::select(mask, codes, result);
                if !next.iter().any(|known| same_codes(format, *known, result)) {
                    next.push(result);
                }
            }
        }
        possible = next;
    }
    match (possible.iter().any(|codes| same_codes(format, *codes, got)), possible.len()) {
        (true, 1) => Agreement::Same,
        (true, _) => Agreement::Undecided,
        (false, _) => Agreement::Different,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::llvmpipe::{Generation, Llvmpipe};
    use wgpu_types::{BlendComponent, BlendFactor, BlendOperation, BlendState};

    /// Blue infinite, multiplied by a factor that is the constant zero.
    fn infinite_blue() -> ColorInputs {
        let component = BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::Zero,
            operation: BlendOperation::Add,
        };
        ColorInputs {
            format: ColorFormat::from_name("rg11b10ufloat").expect("a format"),
            blend: Some(BlendState { color: component, alpha: component }),
            constant: [0.0; 4],
            src: [1.0; 4],
            src1: [0.0; 4],
            dst: [0x3c0, 0x3c0, 0x3e0, 0],
        }
    }

    #[test]
    fn a_result_that_depends_on_history_is_undecided_and_others_differ() {
        let inputs = infinite_blue();
        let (one, nan) = ([0x3c0, 0x3c0, 0x1e0, 0], [0x3c0, 0x3c0, 0x3f0, 0]);
        let of = |generation, mask, got| agreement(&Llvmpipe { generation, ..Llvmpipe::default() }, &inputs, mask, got);
        let all = ColorWrites::ALL;
        assert_eq!([one, nan].map(|got| of(Generation::Mesa22_3, all, got)), [Agreement::Same, Agreement::Different]);
        for newer in [Generation::Mesa25_0, Generation::Mesa26_1] {
            assert_eq!([one, nan].map(|got| of(newer, all, got)), [Agreement::Undecided; 2], "{newer}");
            assert_eq!(of(newer, all, [0x3c1, 0x3c0, 0x1e0, 0]), Agreement::Different, "red is decided");
            let red = ColorWrites::RED;
            assert_eq!(of(newer, red, [0x3c0, 0x3c0, 0x3e0, 0]), Agreement::Same, "blue keeps its infinity");
        }
    }

    #[test]
    fn layers_go_on_from_every_possible_result() {
        let inputs = infinite_blue();
        let model = Llvmpipe::default();
        let of = |got| {
            let over = move |dst| ColorInputs { dst, ..inputs };
            let draws = [(over, ColorWrites::ALL), (over, ColorWrites::ALL)];
            agreement_of_layers(&model, inputs.format, draws.into_iter(), inputs.dst, got)
        };
        // The first draw may leave NaN, which the second multiplies by zero or drops.
        assert_eq!(of([0x3c0, 0x3c0, 0x3f0, 0]), Agreement::Undecided, "NaN");
        assert_eq!(of([0x3c0, 0x3c0, 0x1e0, 0]), Agreement::Undecided, "one");
        assert_eq!(of([0x3c0, 0x3c0, 0x1e1, 0]), Agreement::Different, "neither");
    }
}
