//! Sample masks on a target with one sample: APIs look at bit 0 alone, a driver may not.

use wgpu_types::{ColorTargetState, ColorWrites, TextureFormat};

use super::run::{Compared, Subject, Tally};
use crate::crosscheck::{Batch, Device, Layer, Replay, ReplayError};
use crate::fragment::Fragment;
use crate::state::MergerState;
use crate::target::{Extent, Framebuffer};

/// Masks with and without bit 0.
const MASKS: [u64; 7] = [0, 1, 2, 3, 0xfffe, 0xffff_fffe, 0xffff_ffff];

/// Draws a white fragment under each mask; a model's mask says whether it is drawn.
pub(super) fn run(device: &Device, subjects: &[Subject], tally: &mut Tally<'_>) -> Result<(), ReplayError> {
    tally.leave_out_specifications("sample masks are not judged");
    let target = ColorTargetState { format: TextureFormat::R8Unorm, blend: None, write_mask: ColorWrites::ALL };
    let mut replay = Replay::new(device);
    for mask in MASKS {
        let mut state = MergerState::single(target.clone());
        state.multisample.mask = mask;
        let initial = Framebuffer::for_state(Extent::new(1, 1)?, &state)?;
        let multisample = state.multisample;
        let layers = vec![Layer::new(state, vec![Fragment::new([1.0; 4])])];
        let result = replay.run(&Batch { initial, layers })?;
        let got = result.colors[0].as_ref().map_or(0, |color| color.codes(0, 0, 0)[0]);
        tally.texels += 1;
        tally.states += 1;
        for (s, subject) in subjects.iter().enumerate() {
            let covers = subject.model.sample_mask(&multisample) & 1 == 1;
            let expected = if covers { 255 } else { 0 };
            let same = got == expected;
            let compared = Compared { mismatches: u64::from(!same), undecided: 0, first: (!same).then_some(0) };
            tally.add(s, compared, |_| format!("mask {mask:#x}: expected {expected}, got {got}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::MASKS;
    use crate::model::NumericModel;
    use crate::model::llvmpipe::{Generation, Llvmpipe};
    use wgpu_types::MultisampleState;

    #[test]
    fn the_sweep_tells_who_obeys_the_mask() {
        let drawn = |generation| {
            let model = Llvmpipe { generation, ..Llvmpipe::default() };
            MASKS.map(|mask| model.sample_mask(&MultisampleState { mask, ..MultisampleState::default() }) & 1 == 1)
        };
        let [old, middle, new] = Generation::ALL.map(drawn);
        assert_eq!(old, MASKS.map(|mask| mask != 0), "any mask but 0");
        assert_eq!([middle, new], [MASKS.map(|mask| mask & 1 == 1); 2], "bit 0");
    }
}
