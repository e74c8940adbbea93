//! WebGPU's JSON: an error, or a state that survives writing and reading and that validation and planning take.

use outmerge::plan::Plan;
use outmerge::state::validate::validate;
use outmerge::state::webgpu::{block_from_json, state_from_json, state_to_json};

pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(state) = state_from_json(text) {
        let written = state_to_json(&state);
        let again = state_from_json(&written).unwrap_or_else(|error| panic!("{error} in {written}"));
        assert_eq!(again, state, "{written}");
        let valid = validate(&state);
        let planned = Plan::for_any_model(&state);
        assert!(valid.is_err() || planned.is_ok(), "WebGPU takes {written}, the plan does not: {planned:?}");
    }
    if let Ok(block) = block_from_json(text) {
        assert!(block.tags.is_empty(), "JSON has no tags");
    }
}
