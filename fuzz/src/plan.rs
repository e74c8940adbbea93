//! What a plan leaves out is neither read nor written and cannot be seen: the same bytes as with everything evaluated,
//! and never more traffic.

use outmerge::model::NumericModel;
use outmerge::plan::{Counted, Part, Plan, Planned, Traffic};

use super::case::{Case, models};
use super::input::Input;

pub fn check(data: &[u8]) {
    let case = Case::read(&mut Input::new(data));
    for model in models() {
        omit(&case, model.as_ref());
    }
}

fn omit(case: &Case, model: &dyn NumericModel) {
    let Case { state, before, fragments } = case;
    let Ok(full) = Planned::everything(state, model, before) else { return };
    let lean = Planned::new(state, model, before).expect("everything fits");
    let (mut all, mut some) = (before.clone(), before.clone());
    let run = |merger: &Planned<'_>, framebuffer| {
        let mut memory = Counted::new(framebuffer);
        for (fragment, x, y) in fragments {
            merger.merge(fragment, *x, *y, &mut memory);
        }
        memory.traffic
    };
    let (everything, planned) = (run(&full, &mut all), run(&lean, &mut some));
    assert_eq!(some, all, "{}: an omission shows in {state:?} after {fragments:?}", model.name());
    for (name, full, lean) in [
        ("color read", everything.color_read, planned.color_read),
        ("color written", everything.color_written, planned.color_written),
        ("depth read", everything.depth_read, planned.depth_read),
        ("depth written", everything.depth_written, planned.depth_written),
        ("stencil read", everything.stencil_read, planned.stencil_read),
        ("stencil written", everything.stencil_written, planned.stencil_written),
    ] {
        assert!(lean <= full, "{}: {name}: {lean} bytes planned, {full} without a plan in {state:?}", model.name());
    }
    matches_decisions(lean.plan(), planned, model);
}

/// What the plan calls needless did not happen; a model that rewrites texels reads and writes them all the same.
fn matches_decisions(plan: &Plan, traffic: Traffic, model: &dyn NumericModel) {
    let needed = |part| plan.decisions.iter().any(|decision| decision.part == part && decision.needed);
    let rewrites = plan.targets.iter().flatten().any(|target| target.rewrite);
    for (part, bytes) in [
        (Part::DepthRead, traffic.depth_read),
        (Part::DepthWrite, traffic.depth_written),
        (Part::StencilRead, traffic.stencil_read),
        (Part::StencilWrite, traffic.stencil_written),
        (Part::DestinationRead, if rewrites { 0 } else { traffic.color_read }),
        (Part::ColorWrite, if rewrites { 0 } else { traffic.color_written }),
    ] {
        assert!(needed(part) || bytes == 0, "{}: {} is left out and moved {bytes} bytes", model.name(), part.name());
    }
}
