//! Arbitrary fragments into arbitrary targets: the planned merger stores what the reference stores, in every model, and
//! the reference keeps what may not change; what the models that claim it store is admitted by Vulkan.

use outmerge::admissible::{Class, Judge, Spec, Verdict};
use outmerge::merger::{Fate, Merger, SampleTrace};
use outmerge::model::NumericModel;
use outmerge::plan::Planned;
use outmerge::{Framebuffer, MergerState};
use wgpu_types::ColorWrites;

use super::case::{Case, models};
use super::input::Input;

pub fn check(data: &[u8]) {
    let case = Case::read(&mut Input::new(data));
    for model in models() {
        merge(&case, model.as_ref());
    }
}

fn merge(case: &Case, model: &dyn NumericModel) {
    let Case { state, before, fragments } = case;
    let Ok(reference) = Merger::new(state, model, before) else {
        assert!(
            Planned::new(state, model, before).is_err(),
            "{}: only the planned merger takes {state:?}",
            model.name()
        );
        return;
    };
    let planned = Planned::new(state, model, before).expect("the reference takes it");
    let (mut expected, mut got) = (before.clone(), before.clone());
    for (fragment, x, y) in fragments {
        let previous = expected.clone();
        for sample in reference.trace(fragment, *x, *y, &mut expected).samples {
            is_admissible(state, model, &sample);
            keeps_what_it_must(state, model, &sample, (*x, *y), &previous, &expected);
        }
        planned.merge(fragment, *x, *y, &mut got);
    }
    assert_eq!(got, expected, "{}: planned and reference differ in {state:?} after {fragments:?}", model.name());
}

/// What the models that conform store is admitted by Vulkan, in the class they claim.
fn is_admissible(state: &MergerState, model: &dyn NumericModel, trace: &SampleTrace) {
    let claim = match model.name().as_str() {
        "exact" => Class::Exact,
        "f32" => Class::Wide,
        _ => return,
    };
    for (target, color) in state.targets.iter().zip(&trace.colors) {
        let (Some(target), Some((inputs, stored))) = (target, color) else { continue };
        let judged = Judge::new(Spec::Vulkan).judge(inputs, target.write_mask, *stored);
        let holds = match judged.verdict {
            Verdict::Undefined => true,
            Verdict::Within(class) => class <= claim,
            Verdict::Outside => false,
        };
        assert!(holds, "{}: {judged:?} for {stored:x?} from {inputs:?}", model.name());
    }
}

/// Failed tests leave color alone, and masked channels keep their bits, unless the model says that it rewrites texels.
fn keeps_what_it_must(
    state: &MergerState,
    model: &dyn NumericModel,
    trace: &SampleTrace,
    (x, y): (u32, u32),
    before: &Framebuffer,
    after: &Framebuffer,
) {
    for (index, target) in state.targets.iter().enumerate() {
        let (Some(target), Some(old), Some(new)) = (target, &before.colors[index], &after.colors[index]) else {
            continue;
        };
        if model.rewrites_untouched(old.format()) {
            continue;
        }
        let (old, new) = (old.codes(x, y, trace.sample), new.codes(x, y, trace.sample));
        for channel in 0..4 {
            let written = target.write_mask.contains(ColorWrites::from_bits_truncate(1 << channel));
            if trace.fate != Fate::Merged || !written {
                assert_eq!(
                    old[channel],
                    new[channel],
                    "{}: {:?}, channel {channel} of {state:?}",
                    model.name(),
                    trace.fate
                );
            }
        }
    }
    let tested = matches!(trace.fate, Fate::StencilFailed | Fate::DepthFailed | Fate::Merged);
    if let (Some(old), Some(new)) = (&before.depth_stencil, &after.depth_stencil) {
        let at = old.extent().index(x, y, trace.sample);
        if trace.fate != Fate::Merged {
            assert_eq!(old.depth().get(at), new.depth().get(at), "{:?} leaves depth alone: {state:?}", trace.fate);
        }
        if !tested {
            assert_eq!(old.stencil().get(at), new.stencil().get(at), "{:?} leaves stencil alone", trace.fate);
        }
    }
}
