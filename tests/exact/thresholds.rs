//! Values that stand on a threshold: codes that a blend keeps, which toward zero are thresholds themselves, and numbers
//! half-way between two codes.

use outmerge::format::{ChannelKind, ColorFormat};
use outmerge::model::exact::Exact;
use outmerge::model::{ColorInputs, NumericModel};
use rayon::prelude::*;
use wgpu_types::{BlendComponent, BlendFactor as F, BlendOperation as O, BlendState};

use super::{ROUNDINGS, oracle, same};

/// Every format whose channels have at most 16 bits, one for each kind of channel.
const FORMATS: [&str; 8] = [
    "rgba8unorm",
    "rgba8snorm",
    "rgba8unorm-srgb",
    "rgb10a2unorm",
    "rgba16unorm",
    "rgba16snorm",
    "rgba16float",
    "rg11b10ufloat",
];

/// Source in every channel, factors and operation that leave the target alone; the numbers of the last two cancel.
const KEEPING: [(f32, F, F, O); 8] = [
    (0.2, F::Zero, F::One, O::Add),
    (1.0, F::Dst, F::Zero, O::Add),
    (1.0, F::Zero, F::Src, O::Add),
    (0.0, F::One, F::One, O::Add),
    (0.0, F::One, F::One, O::ReverseSubtract),
    (1.0, F::One, F::One, O::Min),
    (1.0, F::OneMinusDst, F::One, O::Subtract),
    (1.0, F::OneMinusDst, F::OneMinusSrc, O::Subtract),
];

fn inputs(format: ColorFormat, (source, src_factor, dst_factor, operation): (f32, F, F, O), code: u32) -> ColorInputs {
    let component = BlendComponent { src_factor, dst_factor, operation };
    let dst = format.channels().map(|kind| match kind {
        ChannelKind::Absent => 0,
        kind => code & (u32::MAX >> (32 - kind.bits())),
    });
    let blend = Some(BlendState { color: component, alpha: component });
    ColorInputs { format, blend, constant: [0.0; 4], src: [source; 4], src1: [0.0; 4], dst }
}

/// Every code under every state of [`KEEPING`]; 16-bit channels take every 97th.
pub fn kept() {
    FORMATS.into_par_iter().for_each(|name| {
        let format = ColorFormat::from_name(name).expect("known");
        let bits = format.channels().map(ChannelKind::bits).into_iter().max().expect("four channels");
        let step = if bits > 11 { 97 } else { 1 };
        for (place, state) in KEEPING.into_iter().enumerate() {
            for code in (0..1_u32 << bits).step_by(step) {
                let inputs = inputs(format, state, code);
                for rounding in ROUNDINGS {
                    let exact = Exact { rounding };
                    let got = exact.merge_color(&inputs);
                    let expected = oracle::merge(&inputs, rounding);
                    assert!(same(format, got, expected), "{} {got:x?}, {expected:x?}: {inputs:?}", exact.name());
                    assert_eq!(exact.explain_color(&inputs).codes, got, "{}, explained: {inputs:?}", exact.name());
                    // The plain ones keep every unsigned normalised code, by any rounding.
                    if place < 6 && name.contains("unorm") {
                        assert_eq!(got, inputs.dst, "{} keeps codes: {inputs:?}", exact.name());
                    }
                }
            }
        }
    });
}

/// Half a code above every code, and numbers that stand exactly between two.
pub fn ties() {
    for (name, last, half) in [("rgba8unorm", 254_u32, 1.0 / 510.0), ("rgba8snorm", 126, 1.0 / 254.0)] {
        let format = ColorFormat::from_name(name).expect("known");
        for code in 0..=last {
            // The half is rounded to binary32: the result lies beside the tie, on the side that the half was rounded to.
            let state = (half, F::One, F::One, O::Add);
            let inputs = inputs(format, state, code);
            for rounding in ROUNDINGS {
                let exact = Exact { rounding };
                let got = exact.merge_color(&inputs);
                assert_eq!(got, oracle::merge(&inputs, rounding), "{}: {inputs:?}", exact.name());
            }
        }
    }
    // Exactly half-way: half of code 1 of a 16-bit float's smallest numbers, and 0.5 on 8 bits.
    for (name, source, codes) in [
        ("rgba8unorm", 0.5, [128, 128, 127]),
        ("rgba8snorm", -0.5, [0xc0, 0xc0, 0xc1]),
        ("rgba16float", f32::from_bits(0x3300_0000), [0, 1, 0]),
        ("rgba16float", f32::from_bits(0x33c0_0000), [2, 2, 1]),
    ] {
        let format = ColorFormat::from_name(name).expect("known");
        let inputs = inputs(format, (source, F::One, F::Zero, O::Add), 0);
        for (rounding, code) in ROUNDINGS.into_iter().zip(codes) {
            let exact = Exact { rounding };
            assert_eq!(exact.merge_color(&inputs), [code; 4], "{}: {source} on {name}", exact.name());
        }
    }
}
