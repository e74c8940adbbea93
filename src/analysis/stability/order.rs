//! Order sensitivity: the draws of a scene in other orders, and the pixels that notice.

use std::fmt::Display;

use serde::Serialize;

use crate::merger::Merger;
use crate::model::NumericModel;
use crate::report::difference::{Difference, Differences};
use crate::scene::{Draw, Layer, Picture, Scene, SceneError};
use crate::target::Framebuffer;

/// Shuffles tried beside the reverse and the swaps of neighbours.
const SHUFFLES: u64 = 16;

/// Swaps of neighbouring draws tried at most.
const SWAPS: usize = 32;

/// One other order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Permutation {
    /// What was done.
    pub name: String,
    /// The order, as indices into the scene's own.
    pub order: Vec<usize>,
    /// How color target 0 differs from the scene's own order.
    pub difference: Difference,
}

/// A scene in other orders.
#[derive(Clone, Debug, Serialize)]
pub struct OrderReport {
    /// The scene's title.
    pub scene: String,
    /// The numeric model.
    pub model: String,
    /// The draws in the scene's order: object and pass.
    pub draws: Vec<String>,
    /// The other orders: reversed, neighbours swapped, shuffled.
    pub permutations: Vec<Permutation>,
    /// Pixels that differ in some order.
    pub pixels_sensitive: u64,
    /// Pixels in all.
    pub pixels: u64,
    /// The largest difference of any pixel in any order, in codes.
    pub worst: u32,
    /// That pixel, column and row; of the first if several are.
    pub worst_at: [u32; 2],
    /// The largest difference of each pixel over all orders, in the heat maps' colors.
    #[serde(skip)]
    pub heat_map: Picture,
}

/// Draws a scene in its own and in other orders. Shuffles come of a fixed seed.
///
/// # Errors
/// [`SceneError`].
pub fn sensitivity(scene: &Scene, model: &dyn NumericModel) -> Result<OrderReport, SceneError> {
    let draws = scene.draws();
    let layers = scene.layers(&draws)?;
    let own: Vec<usize> = (0..draws.len()).collect();
    let base = render(scene, &draws, &layers, &own, model)?;
    let mut permutations = Vec::new();
    let extent = scene.target.extent;
    let mut largest = vec![0_u32; extent.width as usize * extent.height as usize];
    for (name, order) in orders(draws.len()) {
        let other = render(scene, &draws, &layers, &order, model)?;
        let mut difference = Difference::default();
        if let (Some(Some(mine)), Some(Some(theirs))) = (other.colors.first(), base.colors.first()) {
            let differences = Differences::between(mine, theirs);
            difference = differences.summary();
            for (most, codes) in largest.iter_mut().zip(differences.largest()) {
                *most = (*most).max(*codes);
            }
        }
        permutations.push(Permutation { name, order, difference });
    }
    let (at, worst) =
        largest.iter().copied().enumerate().fold((0, 0), |best, (i, n)| if n > best.1 { (i, n) } else { best });
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let width = extent.width as usize;
    Ok(OrderReport {
        scene: scene.title.clone(),
        model: model.name(),
        draws: draws.iter().map(Draw::label).collect(),
        permutations,
        pixels_sensitive: largest.iter().filter(|codes| **codes > 0).count() as u64,
        pixels: largest.len() as u64,
        worst,
        worst_at: [side(at % width), side(at / width)],
        heat_map: crate::report::difference::heat_map(extent.width, extent.height, &largest),
    })
}

/// The orders tried, each once.
fn orders(count: usize) -> Vec<(String, Vec<usize>)> {
    let own: Vec<usize> = (0..count).collect();
    let mut orders: Vec<(String, Vec<usize>)> = Vec::new();
    let mut add = |name: &dyn Display, order: Vec<usize>| {
        if order != own && orders.iter().all(|(_, known)| *known != order) {
            orders.push((name.to_string(), order));
        }
    };
    add(&"reversed", own.iter().rev().copied().collect());
    for i in 0..count.saturating_sub(1).min(SWAPS) {
        let mut order = own.clone();
        order.swap(i, i + 1);
        add(&format!("draws {} and {} swapped", i + 1, i + 2), order);
    }
    for seed in 1..=SHUFFLES {
        let mut order = own.clone();
        fastrand::Rng::with_seed(seed).shuffle(&mut order);
        add(&format!("shuffle {seed}"), order);
    }
    orders
}

/// The scene with its draws in this order.
fn render(
    scene: &Scene,
    draws: &[Draw],
    layers: &[Layer],
    order: &[usize],
    model: &dyn NumericModel,
) -> Result<Framebuffer, SceneError> {
    let mut targets = scene.cleared()?;
    for &index in order {
        let draw = &draws[index];
        let merger = Merger::new(&draw.state, model, &targets).map_err(|source| SceneError::Merger {
            index,
            draw: draw.label(),
            source,
        })?;
        for layer in layers.iter().filter(|layer| layer.draw == index) {
            for pixel in &layer.fragments {
                merger.merge(&pixel.fragment, pixel.x, pixel.y, &mut targets);
            }
        }
    }
    Ok(targets)
}
