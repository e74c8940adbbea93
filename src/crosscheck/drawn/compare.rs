//! How a drawn scene agrees with the model: coverage, fragment outputs, and stored colors.

use crate::merger::Merger;
use crate::model::NumericModel;
use crate::scene::{Draw, Scene, SceneError};
use crate::target::Framebuffer;

use super::{Drawn, DrawnFragment};
use crate::fragment::Fragment;

/// The two sides, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct Agreement {
    /// Texels of the targets.
    pub texels: u64,
    /// Fragments of the model.
    pub fragments: u64,
    /// Texels that some draw covers a different number of times.
    pub texels_covered_differently: u64,
    /// Fragments that only one side discards, on texels covered alike; as all counts of fragments below.
    pub discarded_differently: u64,
    /// Fragments whose output colors differ in some bit.
    pub outputs_differing: u64,
    /// Fragments whose depth differs in some bit.
    pub depths_differing: u64,
    /// The largest difference of an output channel, where neither side discards.
    pub largest_output: f32,
    /// The largest difference of a depth.
    pub largest_depth: f32,
    /// Texels all of whose fragments are alike: colors, depth and discards.
    pub texels_alike: u64,
    /// Texels that are alike but store other colors. Zero, if the model models this device.
    pub alike_but_stored_differently: u64,
    /// Texels that store other colors than the model would from the device's own fragments. Zero, if the model models
    /// this device.
    pub merged_differently: u64,
    /// Texels that store other colors than in the model's picture.
    pub stored_differently: u64,
}

impl Agreement {
    /// Compares what a device made of `scene` with what `model` makes of it.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn of(scene: &Scene, drawn: &Drawn, model: &dyn NumericModel) -> Result<Self, SceneError> {
        let draws = scene.draws();
        let fragments = shaded(scene, &draws);
        let rendered = scene.render(model)?.framebuffer;
        let merged = merge(scene, &draws, &drawn.fragments, model)?;
        let extent = scene.target.extent;
        let mut agreement = Self { fragments: fragments.len() as u64, ..Self::default() };
        let (mut ours, mut theirs) = (&fragments[..], &drawn.fragments[..]);
        for y in 0..extent.height {
            for x in 0..extent.width {
                let (mine, device) = (texel(&mut ours, x, y), texel(&mut theirs, x, y));
                let alike = agreement.add_fragments(mine, device);
                let same = |other: &Framebuffer| same_colors(other, &drawn.framebuffer, x, y);
                let stored = same(&rendered);
                agreement.texels += 1;
                agreement.texels_alike += u64::from(alike);
                agreement.alike_but_stored_differently += u64::from(alike && !stored);
                agreement.stored_differently += u64::from(!stored);
                agreement.merged_differently += u64::from(!same(&merged));
            }
        }
        Ok(agreement)
    }

    /// Counts the fragments of one texel, and says whether they are all alike.
    fn add_fragments(&mut self, ours: &[DrawnFragment], theirs: &[DrawnFragment]) -> bool {
        if !ours.iter().map(|f| f.draw).eq(theirs.iter().map(|f| f.draw)) {
            self.texels_covered_differently += 1;
            return false;
        }
        let mut alike = true;
        for (a, b) in ours.iter().zip(theirs).map(|(a, b)| (&a.fragment, &b.fragment)) {
            let outputs = bits(a) == bits(b);
            let depth = a.depth.to_bits() == b.depth.to_bits();
            self.discarded_differently += u64::from(a.discarded != b.discarded);
            self.outputs_differing += u64::from(!outputs);
            self.depths_differing += u64::from(!depth);
            self.largest_depth = self.largest_depth.max((a.depth - b.depth).abs());
            if !a.discarded && !b.discarded {
                let channels = a.outputs.iter().flatten().zip(b.outputs.iter().flatten());
                self.largest_output = channels.fold(self.largest_output, |top, (a, b)| top.max((a - b).abs()));
            }
            alike &= outputs && depth && a.discarded == b.discarded && a.front_facing == b.front_facing;
        }
        alike
    }

    /// Adds another scene's counts.
    pub fn absorb(&mut self, other: &Self) {
        self.texels += other.texels;
        self.fragments += other.fragments;
        self.texels_covered_differently += other.texels_covered_differently;
        self.discarded_differently += other.discarded_differently;
        self.outputs_differing += other.outputs_differing;
        self.depths_differing += other.depths_differing;
        self.largest_output = self.largest_output.max(other.largest_output);
        self.largest_depth = self.largest_depth.max(other.largest_depth);
        self.texels_alike += other.texels_alike;
        self.alike_but_stored_differently += other.alike_but_stored_differently;
        self.merged_differently += other.merged_differently;
        self.stored_differently += other.stored_differently;
    }
}

fn bits(fragment: &Fragment) -> impl PartialEq {
    fragment.outputs.map(|color| color.map(f32::to_bits))
}

/// The model's fragments in the order of the device's.
fn shaded(scene: &Scene, draws: &[Draw]) -> Vec<DrawnFragment> {
    let mut fragments = Vec::new();
    for (draw, given) in draws.iter().enumerate() {
        scene.shade(given, None, |pixels| {
            fragments.extend(pixels.iter().map(|pixel| DrawnFragment {
                draw,
                // Triangles are not told apart here; a stable sort keeps their order.
                triangle: 0,
                x: pixel.x,
                y: pixel.y,
                fragment: pixel.fragment,
            }));
        });
    }
    fragments.sort_by_key(|fragment| (fragment.y, fragment.x));
    fragments
}

/// The device's fragments through the model's merger.
fn merge(
    scene: &Scene,
    draws: &[Draw],
    fragments: &[DrawnFragment],
    model: &dyn NumericModel,
) -> Result<Framebuffer, SceneError> {
    let mut framebuffer = scene.cleared()?;
    let blank = framebuffer.clone();
    let mergers = draws.iter().enumerate().map(|(index, draw)| {
        Merger::new(&draw.state, model, &blank).map_err(|source| SceneError::Merger {
            index,
            draw: draw.label(),
            source,
        })
    });
    let mergers: Vec<_> = mergers.collect::<Result<_, _>>()?;
    for fragment in fragments {
        mergers[fragment.draw].merge(&fragment.fragment, fragment.x, fragment.y, &mut framebuffer);
    }
    Ok(framebuffer)
}

/// Takes the fragments of one texel off the front.
fn texel<'f>(rest: &mut &'f [DrawnFragment], x: u32, y: u32) -> &'f [DrawnFragment] {
    let count = rest.iter().take_while(|fragment| (fragment.x, fragment.y) == (x, y)).count();
    let (texel, others) = rest.split_at(count);
    *rest = others;
    texel
}

fn same_colors(a: &Framebuffer, b: &Framebuffer, x: u32, y: u32) -> bool {
    let codes = |framebuffer: &Framebuffer| -> Vec<_> {
        framebuffer.colors.iter().map(|color| color.as_ref().map(|color| color.codes(x, y, 0))).collect()
    };
    codes(a) == codes(b)
}
