//! A pixel's layers as one sum: what each contributes to the final color.
//!
//! Every blend is `result = a S + b D` with numbers a and b: factors and operation settle them (min and max take one side
//! whole). Unrolled over the layers, the final value is the sum of each layer's source times its weight, the weight being
//! its own a times the b of all later layers. The sum is real arithmetic; what the target stores differs from it by the
//! roundings and clamps of every layer.

use wgpu_types::{BlendOperation, ColorWrites};

use super::{Event, History};
use crate::merger::blend::component;
use crate::model::exact::Exact;
use crate::model::{ColorInputs, NumericModel, StepKind};
use crate::scene::draw::Draw;

/// One layer's part of the final color.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Share {
    /// Index of the event; `None` is the cleared target.
    pub event: Option<usize>,
    /// The layer's color as the blender took it in, RGBA.
    pub source: [f64; 4],
    /// How much of it is left at the end.
    pub weight: [f64; 4],
}

/// The layers of one color target, from the cleared target up.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Stack {
    /// Index of the color target.
    pub target: usize,
    /// The shares, in drawing order.
    pub shares: Vec<Share>,
    /// Their sum in real arithmetic, as binary64 has it.
    pub sum: [f64; 4],
    /// What the target holds.
    pub stored: [f64; 4],
}

impl History {
    /// Each color target's layers. `draws` are those of the scene, in drawing order.
    #[must_use]
    pub fn stacks(&self, draws: &[Draw]) -> Vec<Stack> {
        (0..self.cleared.colors.len()).map(|target| self.stack(draws, target)).collect()
    }

    fn stack(&self, draws: &[Draw], target: usize) -> Stack {
        let first = Share { event: None, source: self.cleared.colors[target].values, weight: [1.0; 4] };
        let mut shares = vec![first];
        for (index, event) in self.events.iter().enumerate() {
            let Some(layer) = layer(event, draws, target) else { continue };
            for share in &mut shares {
                share.weight = std::array::from_fn(|i| share.weight[i] * layer.keeps[i]);
            }
            shares.push(Share { event: Some(index), source: layer.source, weight: layer.adds });
        }
        let term =
            |share: &Share, i: usize| if share.weight[i] == 0.0 { 0.0 } else { share.weight[i] * share.source[i] };
        let sum = std::array::from_fn(|i| shares.iter().map(|share| term(share, i)).sum());
        Stack { target, shares, sum, stored: self.last.colors[target].values }
    }
}

/// `result = adds x source + keeps x destination`, RGBA.
struct Layer {
    source: [f64; 4],
    adds: [f64; 4],
    keeps: [f64; 4],
}

/// A merged fragment as a layer; `None` where it did not reach the target.
fn layer(event: &Event, draws: &[Draw], target: usize) -> Option<Layer> {
    let inputs = event.inputs.get(target)?.as_ref()?;
    let mask = draws[event.draw].state.targets.get(target)?.as_ref()?.write_mask;
    let explained = Exact::default().explain_color(inputs);
    let number = |kind, i| explained.value(kind, i).map(|number| number.decimal);
    let mut layer = Layer { source: [0.0; 4], adds: [0.0; 4], keeps: [1.0; 4] };
    for i in 0..4 {
        layer.source[i] = number(StepKind::Source, i).unwrap_or(f64::from(inputs.src[i]));
        if mask.contains(ColorWrites::from_bits_truncate(1 << i)) {
            (layer.adds[i], layer.keeps[i]) = weights(inputs, i, &number);
        }
    }
    Some(layer)
}

fn weights(inputs: &ColorInputs, i: usize, number: &impl Fn(StepKind, usize) -> Option<f64>) -> (f64, f64) {
    let Some(blend) = &inputs.blend else { return (1.0, 0.0) };
    let factor = |kind| number(kind, i).unwrap_or(0.0);
    let (src, dst) = (factor(StepKind::SourceFactor), factor(StepKind::DestinationFactor));
    match component(blend, i).operation {
        BlendOperation::Add => (src, dst),
        BlendOperation::Subtract => (src, -dst),
        BlendOperation::ReverseSubtract => (-src, dst),
        operation => {
            let (s, d) = (number(StepKind::Source, i), number(StepKind::Destination, i));
            let takes_source = if operation == BlendOperation::Min { s <= d } else { s >= d };
            if takes_source { (1.0, 0.0) } else { (0.0, 1.0) }
        }
    }
}
