//! Depth codes of the device against the `llvmpipe` model.

use outmerge::Fragment;
use outmerge::format::depth::DepthKind;
use outmerge::model::NumericModel as _;
use outmerge::{Framebuffer, MergerState};
use wgpu_types::{CompareFunction, DepthBiasState, DepthStencilState, StencilState, TextureFormat};

use crate::harness::{draw, llvmpipe, model};

/// Depths across [0, 1]: a ramp, and values whose scaled code lies next to a half.
fn depths(steps: f64) -> Vec<f32> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is wanted")]
    let narrow = |x: f64| x as f32;
    (0..32_768_u32)
        .flat_map(|i| {
            let t = f64::from(i) / 32_767.0;
            [narrow(t), narrow(((t * steps).floor() + 0.5) / steps)]
        })
        .collect()
}

#[test]
fn depth_codes_are_the_models() {
    let Some(device) = llvmpipe() else { return };
    for (format, kind, steps) in [
        (TextureFormat::Depth16Unorm, DepthKind::Unorm(16), 65_535.0),
        (TextureFormat::Depth24Plus, DepthKind::Unorm(24), 16_777_215.0),
        (TextureFormat::Depth32Float, DepthKind::Float32, 16_777_215.0),
    ] {
        let depth_stencil = DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Always),
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        };
        let state = MergerState { depth_stencil: Some(depth_stencil), ..MergerState::default() };
        let depths = depths(steps);
        let extent = outmerge::Extent::new(256, 256).expect("a legal extent");
        let initial = Framebuffer::for_state(extent, &state).expect("targets for the state");
        let fragments = depths.iter().map(|&z| Fragment::default().at_depth(z)).collect();
        let result = draw(device, initial, state, fragments);
        let got = result.depth_stencil.as_ref().expect("has depth").depth();
        let wrong: Vec<_> = depths
            .iter()
            .zip(got)
            .filter(|(z, code)| model(device).depth_code(kind, **z, [0.0, 1.0]) != **code)
            .map(|(z, code)| format!("{z:?}: model {}, device {code}", model(device).depth_code(kind, *z, [0.0, 1.0])))
            .collect();
        assert!(wrong.is_empty(), "{format:?}: {} of {} differ: {}", wrong.len(), depths.len(), wrong[0]);
    }
}
