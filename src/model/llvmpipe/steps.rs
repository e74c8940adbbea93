//! The driver's intermediate numbers, for explanations.

use crate::format::{ChannelKind, Codes};
use crate::model::{ColorInputs, Explanation, Number, Step};

/// What the driver computed for one texel. Normalised targets hold codes, float targets values.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// The arithmetic, in words.
    pub rule: &'static str,
    /// N where the numbers are codes of N steps; `None` where they are values.
    pub steps: Option<u32>,
    /// Source as taken in.
    pub src: [f64; 4],
    /// Destination as loaded.
    pub dst: [f64; 4],
    /// Factors, terms and the rule of each channel; `None` with blending off.
    pub equation: [Option<Equation>; 4],
    /// The result before the store.
    pub result: [f64; 4],
    /// The codes stored.
    pub codes: Codes,
}

/// One channel's equation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation {
    /// Source factor.
    pub src_factor: f64,
    /// Destination factor.
    pub dst_factor: f64,
    /// Source and destination terms, where the driver forms them.
    pub terms: Option<(f64, f64)>,
    /// How terms are formed and combined.
    pub rule: &'static str,
}

/// Turns the numbers into text.
pub(super) fn explain(inputs: &ColorInputs, steps: Steps) -> Explanation {
    let channels = inputs.format.channels();
    let stored = |i: usize| channels[i] != ChannelKind::Absent;
    let number = |x: f64| match steps.steps {
        Some(n) => Number { decimal: x / f64::from(n), exact: format!("{x}/{n}") },
        None => Number { decimal: x, exact: String::new() },
    };
    let all = |values: [f64; 4]| -> [Option<Number>; 4] {
        std::array::from_fn(|i| (stored(i) || i == 3).then(|| number(values[i])))
    };
    let same = |text: &str| -> [String; 4] { std::array::from_fn(|_| text.to_owned()) };
    let mut out =
        vec![Step { name: "source, taken in".to_owned(), values: all(steps.src), equation: same(steps.rule) }];
    if inputs.blend.is_some() {
        let part = |pick: fn(&Equation) -> f64| -> [Option<Number>; 4] {
            std::array::from_fn(|i| steps.equation[i].as_ref().filter(|_| stored(i)).map(|e| number(pick(e))))
        };
        out.push(Step {
            name: "destination, decoded".to_owned(),
            values: std::array::from_fn(|i| stored(i).then(|| number(steps.dst[i]))),
            equation: Default::default(),
        });
        out.push(Step {
            name: "source factor".to_owned(),
            values: part(|e| e.src_factor),
            equation: Default::default(),
        });
        out.push(Step {
            name: "destination factor".to_owned(),
            values: part(|e| e.dst_factor),
            equation: Default::default(),
        });
        let term = |pick: fn((f64, f64)) -> f64| -> [Option<Number>; 4] {
            std::array::from_fn(|i| {
                steps.equation[i].and_then(|e| e.terms).filter(|_| stored(i)).map(|t| number(pick(t)))
            })
        };
        out.push(Step { name: "source term".to_owned(), values: term(|t| t.0), equation: Default::default() });
        out.push(Step { name: "destination term".to_owned(), values: term(|t| t.1), equation: Default::default() });
        out.push(Step {
            name: "result".to_owned(),
            values: std::array::from_fn(|i| stored(i).then(|| number(steps.result[i]))),
            equation: std::array::from_fn(|i| steps.equation[i].map_or(String::new(), |e| e.rule.to_owned())),
        });
    }
    out.push(Step {
        name: "stored code".to_owned(),
        values: std::array::from_fn(|i| {
            stored(i).then(|| Number { decimal: f64::from(steps.codes[i]), exact: format!("{:#x}", steps.codes[i]) })
        }),
        equation: Default::default(),
    });
    Explanation { steps: out, codes: steps.codes }
}
