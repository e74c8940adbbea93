//! What every numeric model promises.

use outmerge::format::ChannelKind;
use outmerge::model::registry;
use outmerge::proptest::{state, target};
use proptest::prelude::*;

proptest! {
    /// Results are codes of the format: no stray bits, nothing in missing channels.
    #[test]
    fn results_are_codes_of_the_format(
        inputs in state::format().prop_flat_map(target::color_inputs),
    ) {
        for model in registry::every_generation() {
            if model.supports(inputs.format, inputs.blend.as_ref()).is_err() { continue }
            let codes = model.merge_color(&inputs);
            for (code, kind) in codes.into_iter().zip(inputs.format.channels()) {
                let bits = match kind {
                    ChannelKind::Absent => 0,
                    ChannelKind::Unorm(bits) | ChannelKind::Snorm(bits) => bits,
                    ChannelKind::Srgb => 8,
                    ChannelKind::Float(layout) => {
                        layout.exponent_bits + layout.mantissa_bits + u32::from(layout.signed)
                    }
                };
                prop_assert!(u64::from(code) < 1 << bits, "{}: {:#x} in {} bits", model.name(), code, bits);
            }
        }
    }

    /// Models are pure: the same inputs give the same codes.
    #[test]
    fn equal_inputs_give_equal_codes(inputs in state::format().prop_flat_map(target::color_inputs)) {
        for model in registry::every_generation() {
            if model.supports(inputs.format, inputs.blend.as_ref()).is_err() { continue }
            let again = inputs;
            prop_assert_eq!(model.merge_color(&inputs), model.merge_color(&again), "{}", model.name());
        }
    }

    /// What a model explains is what it stores.
    #[test]
    fn explanations_end_in_the_codes_stored(inputs in state::format().prop_flat_map(target::color_inputs)) {
        for model in registry::every_generation() {
            if model.supports(inputs.format, inputs.blend.as_ref()).is_err() { continue }
            prop_assert_eq!(model.explain_color(&inputs).codes, model.merge_color(&inputs), "{}", model.name());
        }
    }

    /// On normalised targets finite numbers lie within one another's reach: no model is off by more than its own
    /// arithmetic allows (`f32` by one code of 8 bits).
    #[test]
    fn binary32_is_within_one_code_of_exact_on_8_bits(
        inputs in Just(outmerge::format::ColorFormat::from_name("rgba8unorm").expect("a format"))
            .prop_flat_map(target::color_inputs),
    ) {
        let [exact, f32] = ["exact", "f32"].map(|name| registry::by_name(name).expect("a model").merge_color(&inputs));
        for (a, b) in exact.into_iter().zip(f32) {
            prop_assert!(a.abs_diff(b) <= 1, "{:?} and {:?}", exact, f32);
        }
    }
}
