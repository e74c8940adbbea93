//! Bundled and example scenes drawn by the device itself, shading included, against the model.

use outmerge::crosscheck::drawn::{Agreement, Drawer};
use outmerge::crosscheck::raster::of_llvmpipe_here;

use crate::harness::{llvmpipe, model};
use crate::scenes;

#[test]
fn scenes_are_covered_alike_and_stored_alike_where_fragments_are() {
    let Some(device) = llvmpipe() else { return };
    let mut drawer = Drawer::new(device);
    let (mut wrong, mut all) = (Vec::new(), Agreement::default());
    for (name, mut scene) in scenes::all() {
        scene.target.rasteriser = of_llvmpipe_here(model(device).generation);
        let drawn = drawer.draw(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let agreement = Agreement::of(&scene, &drawn, &model(device)).unwrap_or_else(|e| panic!("{name}: {e}"));
        println!("{name}: {agreement:?}");
        let Agreement {
            texels_covered_differently,
            depths_differing,
            alike_but_stored_differently,
            merged_differently,
            ..
        } = agreement;
        if texels_covered_differently + depths_differing + alike_but_stored_differently + merged_differently > 0 {
            wrong.push(format!("{name}: {agreement:?}"));
        }
        all.absorb(&agreement);
    }
    println!("all: {all:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // Shader arithmetic and texture filters are the device's own: binary32 where the model rounds once.
    assert!(5000 * all.stored_differently <= all.texels, "more than one texel in 5000 looks different: {all:?}");
    assert!(all.texels_alike > 0, "some fragments must be alike for the comparison to mean anything: {all:?}");
}
