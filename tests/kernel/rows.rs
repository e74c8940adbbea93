//! What a row may be, what has no kernel, and depth.

use outmerge::kernel::{Isa, Kernel, depth};
use outmerge::merger::discard::compare;
use wgpu_types::{BlendFactor as F, BlendOperation as Op, BlendState, CompareFunction, TextureFormat};

use super::{Bytes, MODELS, equation, instruction_sets, kernel, model, target};

#[test]
fn texels_that_are_not_kept_keep_their_bytes_and_the_others_are_merged() {
    for name in MODELS {
        let kernel = kernel(&target(Some(BlendState::ALPHA_BLENDING)), [0.0; 4], name);
        for isa in instruction_sets() {
            for texels in [0, 1, 31, 32, 33, 100] {
                let mut bytes = Bytes(texels as u64);
                let (src, before) = (bytes.fill(4 * texels), bytes.fill(4 * texels));
                let keep: Vec<u8> = (0..texels).map(|i| if i % 3 == 0 { 0 } else { 255 }).collect();
                let (mut all, mut some) = (before.clone(), before.clone());
                kernel.merge_row_on(isa, &src, None, None, &mut all);
                kernel.merge_row_on(isa, &src, None, Some(&keep), &mut some);
                for i in 0..4 * texels {
                    let expected = if keep[i / 4] == 0 { before[i] } else { all[i] };
                    assert_eq!(some[i], expected, "{name} on {isa:?}, {texels} texels, byte {i}");
                }
            }
        }
    }
}

#[test]
fn depth_rows_are_the_depth_test() {
    let mut bytes = Bytes(5);
    let code = |bytes: &mut Bytes| u32::from(bytes.next() % 4);
    for function in [
        CompareFunction::Never,
        CompareFunction::Less,
        CompareFunction::Equal,
        CompareFunction::LessEqual,
        CompareFunction::Greater,
        CompareFunction::NotEqual,
        CompareFunction::GreaterEqual,
        CompareFunction::Always,
    ] {
        for write in [false, true] {
            let codes: Vec<u32> = (0..300).map(|_| code(&mut bytes)).collect();
            let before: Vec<u32> = (0..300).map(|_| code(&mut bytes)).collect();
            let alive: Vec<u8> = (0..300).map(|i| if i % 5 == 0 { 0 } else { 255 }).collect();
            for isa in instruction_sets() {
                let (mut stored, mut keep) = (before.clone(), alive.clone());
                depth::test_row_on(isa, function, write, &codes, &mut stored, &mut keep);
                for i in 0..300 {
                    let passes = alive[i] != 0 && compare(function, &codes[i], &before[i]);
                    let (kept, left) =
                        (if passes { 255 } else { 0 }, if passes && write { codes[i] } else { before[i] });
                    let (z, d) = (codes[i], before[i]);
                    assert_eq!(keep[i], kept, "{function:?} on {isa:?}: {z} and {d}");
                    assert_eq!(stored[i], left, "{function:?} on {isa:?}, write {write}: {z} and {d}");
                }
            }
        }
    }
}

#[test]
fn what_has_no_rule_has_no_kernel() {
    let over = Some(BlendState::ALPHA_BLENDING);
    for name in ["f16", "swiftshader", "fixed:10", "exact:toward-zero"] {
        assert!(Kernel::new(&target(over), [0.0; 4], &*model(name)).is_none(), "{name}");
    }
    for format in [TextureFormat::R8Unorm, TextureFormat::Rg16Float] {
        let state = wgpu_types::ColorTargetState { format, ..target(over) };
        assert!(Kernel::new(&state, [0.0; 4], &*model("exact")).is_none(), "{format:?}");
    }
}

#[test]
fn exact_has_no_kernel_for_constants_between_codes_and_models_that_quantise_them_do() {
    let both = equation(F::Constant, F::Zero, Op::Add);
    let target = target(Some(BlendState { color: both, alpha: both }));
    assert!(Kernel::new(&target, [0.5; 4], &*model("exact")).is_none(), "0.5 is no code");
    assert!(Kernel::new(&target, [0.2; 4], &*model("exact")).is_some(), "51/255 is");
    assert!(Kernel::new(&target, [0.5; 4], &*model("llvmpipe")).is_some(), "quantised anyway");
}

#[test]
#[should_panic(expected = "second source")]
fn a_missing_second_source_is_refused() {
    let both = equation(F::Src1, F::Zero, Op::Add);
    let kernel = kernel(&target(Some(BlendState { color: both, alpha: both })), [0.0; 4], "exact");
    kernel.merge_row_on(Isa::Baseline, &[0; 4], None, None, &mut [0; 4]);
}
