use glam::Vec3;
use proptest::prelude::*;
use wgpu_types::{AddressMode, ColorWrites, FilterMode};

use super::surface::SurfaceShader;
use super::*;
use crate::scene::texture::{Footprint, Image, Sampler, Texture};

fn texture(texel: [f32; 4]) -> Texture {
    let sampler = Sampler { filter: FilterMode::Nearest, address: [AddressMode::Repeat; 2], mips: None };
    Texture::new(Image::new(1, 1, |_, _| texel).expect("1 x 1 is legal"), sampler)
}

fn input() -> SurfaceInput {
    SurfaceInput { uv: [0.5; 2], normal: Vec3::Z, position: Vec3::ZERO, front_facing: true }
}

fn lighting() -> Lighting {
    let lights = vec![
        Light::Directional { toward: Vec3::Z, color: Vec3::ONE },
        Light::Point { position: Vec3::new(0.5, 0.0, 1.0), color: Vec3::X, range: 4.0 },
    ];
    Lighting { ambient: Vec3::splat(0.1), lights }
}

/// Shades one fragment of `pass`, seen from a little to the side.
fn shade_pass(material: &Material, pass: &Pass, texel: [f32; 4], work: &mut Work) -> SurfaceOutput {
    let (texture, lighting) = (texture(texel), lighting());
    let shader = SurfaceShader {
        material,
        texture: material.texture.map(|_| &texture),
        keywords: Keywords::new(material, pass, 1),
        shader: pass.shader,
        lighting: &lighting,
        light: 1,
        eye: Vec3::new(0.2, 0.1, 2.0),
    };
    shader.shade(&input(), Footprint::default, work)
}

fn shade(material: &Material, texel: [f32; 4]) -> SurfaceOutput {
    shade_pass(material, &Pass::base(material.mode), texel, &mut Work::default())
}

fn textured(mode: RenderingMode) -> Material {
    Material { texture: Some(0), ..Material::new("m", mode) }
}

#[test]
fn alpha_is_tint_times_texture_unless_the_texture_holds_smoothness() {
    let mut material = Material { tint: [1.0, 1.0, 1.0, 0.5], ..textured(RenderingMode::Fade) };
    assert_eq!(shade(&material, [1.0, 1.0, 1.0, 0.25]).color[3], 0.125, "both alphas");
    material.smoothness_in_alpha = true;
    assert_eq!(shade(&material, [1.0, 1.0, 1.0, 0.25]).color[3], 0.5, "the tint's alpha alone");
}

#[test]
fn clip_keeps_an_alpha_equal_to_the_cutoff_and_drops_the_next_one_below() {
    let material = Material { cutoff: 0.3, ..textured(RenderingMode::Cutout) };
    assert!(!shade(&material, [1.0, 1.0, 1.0, 0.3]).discarded, "alpha = cutoff stays");
    assert!(shade(&material, [1.0, 1.0, 1.0, 0.3_f32.next_down()]).discarded, "one ulp below goes");
    assert!(!shade(&material, [1.0, 1.0, 1.0, 0.3_f32.next_up()]).discarded, "one ulp above stays");
}

#[test]
fn only_cutout_clips_and_opaque_evaluates_no_alpha() {
    for settings in &MODES {
        let material = textured(settings.mode);
        let mut work = Work::default();
        let output = shade_pass(&material, &Pass::base(settings.mode), [1.0, 1.0, 1.0, 0.0], &mut work);
        assert_eq!(output.discarded, settings.mode == RenderingMode::Cutout, "{:?}: alpha 0", settings.mode);
        assert_eq!(work.clips, u64::from(settings.clips), "{:?}: clips evaluated", settings.mode);
        assert_eq!(work.alphas, u64::from(settings.mode != RenderingMode::Opaque), "{:?}: alphas", settings.mode);
        assert_eq!(work.lights, 0, "{:?}: unlit", settings.mode);
    }
}

#[test]
fn a_masked_opaque_pass_evaluates_nothing() {
    let material =
        Material { shading: Shading::Lit { metallic: 0.0, smoothness: 0.5 }, ..textured(RenderingMode::Opaque) };
    let mut pass = Pass::base(RenderingMode::Opaque);
    pass.state.write_mask[0] = ColorWrites::empty();
    assert_eq!(Keywords::new(&material, &pass, 1), Keywords::default(), "a depth prepass needs no shader");
    let mut work = Work::default();
    let _ = shade_pass(&material, &pass, [1.0; 4], &mut work);
    assert_eq!(work, Work { fragments: 1, ..Work::default() }, "and runs none");
}

#[test]
fn a_masked_cutout_pass_still_clips() {
    let material = textured(RenderingMode::Cutout);
    let mut pass = Pass::base(RenderingMode::Cutout);
    pass.state.write_mask[0] = ColorWrites::empty();
    let output = shade_pass(&material, &pass, [1.0, 1.0, 1.0, 0.1], &mut Work::default());
    assert!(output.discarded, "holes must stay holes in the depth buffer");
}

#[test]
fn highlights_fade_with_alpha_in_fade_mode_and_stay_in_transparent_mode() {
    let shading = Shading::Lit { metallic: 0.0, smoothness: 0.9 };
    let at = |mode, alpha| {
        let material = Material { tint: [0.5, 0.5, 0.5, alpha], shading, ..Material::new("m", mode) };
        shade(&material, [1.0; 4]).color
    };
    let contribution = |mode, alpha: f32| {
        let [red, _, _, a] = at(mode, alpha);
        if mode == RenderingMode::Fade { red * a } else { red }
    };
    assert_eq!(contribution(RenderingMode::Fade, 0.0), 0.0, "at alpha 0 nothing is left");
    assert!(contribution(RenderingMode::Transparent, 0.0) > 0.0, "at alpha 0 the highlight is left");
    let [.., covered] = at(RenderingMode::Transparent, 0.0);
    assert_eq!(covered, 1.0 - 0.96, "alpha' = 1 - R + aR at a = 0 is the reflectivity");
}

#[test]
fn metals_have_no_diffuse_color_and_cover_fully() {
    let material = |alpha| Material {
        tint: [1.0, 0.8, 0.2, alpha],
        shading: Shading::Lit { metallic: 1.0, smoothness: 0.5 },
        ..Material::new("gold", RenderingMode::Transparent)
    };
    let (solid, clear) = (shade(&material(1.0), [1.0; 4]), shade(&material(0.0), [1.0; 4]));
    assert_eq!(solid, clear, "only reflection is left, which alpha does not touch");
    assert_eq!(clear.color[3], 1.0, "reflectivity 1 covers what lies behind");
}

#[test]
fn each_light_pass_adds_its_own_light_without_ambient() {
    let shading = Shading::Lit { metallic: 0.0, smoothness: 0.3 };
    for settings in &MODES {
        let material = Material { shading, ..Material::new("m", settings.mode) };
        let passes = material.passes();
        assert_eq!(passes.len(), 2, "{:?}: base and light", settings.mode);
        let added = shade_pass(&material, &passes[1], [1.0; 4], &mut Work::default());
        assert!(added.color[0] > 0.0, "{:?}: the red light is seen", settings.mode);
        assert_eq!(added.color[1..3], [0.0, 0.0], "{:?}: no green or blue, so no ambient", settings.mode);
        let state = &passes[1].state;
        assert!(!state.depth_write, "{:?}: light passes leave depth alone", settings.mode);
        let blend = state.blend[0].expect("light passes blend");
        assert_eq!(blend.color.src_factor, settings.src_blend, "{:?}: Blend [_SrcBlend] One", settings.mode);
    }
}

#[test]
fn premultiplied_textures_are_not_multiplied_again() {
    let material =
        Material { premultiplied_texture: true, tint: [1.0, 1.0, 1.0, 0.5], ..textured(RenderingMode::Transparent) };
    let output = shade(&material, [0.4, 0.2, 0.1, 0.5]);
    assert_eq!(output.color, [0.2, 0.1, 0.05, 0.25], "the tint's alpha scales all four");
}

fn unit() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0.0_f32..=1.0, 1 => Just(0.0), 1 => Just(1.0)]
}

proptest! {
    /// Fade: factors (a, 1 - a) at a = 1 are (1, 0). Transparent: the same, and alpha' = 1.
    #[test]
    fn blended_modes_at_alpha_one_shade_like_opaque(
        tint in prop::array::uniform3(unit()), metallic in unit(), smoothness in unit(), lit in any::<bool>()
    ) {
        let shading = if lit { Shading::Lit { metallic, smoothness } } else { Shading::Unlit };
        let color = |mode| {
            let material = Material { tint: [tint[0], tint[1], tint[2], 1.0], shading, ..Material::new("m", mode) };
            shade(&material, [1.0; 4]).color
        };
        let opaque = color(RenderingMode::Opaque);
        prop_assert_eq!(color(RenderingMode::Fade), opaque);
        prop_assert_eq!(color(RenderingMode::Transparent), opaque);
    }

    /// Skipping what keywords leave out changes nothing that is written: evaluating everything gives the same color.
    #[test]
    fn omitted_evaluations_are_unobservable(
        texel in prop::array::uniform4(unit()), tint in prop::array::uniform4(unit()), mode in 0_usize..4,
        smoothness_in_alpha in any::<bool>(), lit in any::<bool>(), mask in 0_u32..16
    ) {
        let mode = MODES[mode].mode;
        let shading = if lit { Shading::Lit { metallic: 0.25, smoothness: 0.5 } } else { Shading::Unlit };
        let material = Material { tint, smoothness_in_alpha, shading, ..textured(mode) };
        let mut pass = Pass::base(mode);
        let full = shade_pass(&material, &pass, texel, &mut Work::default());
        pass.state.write_mask[0] = ColorWrites::from_bits_truncate(mask);
        let lean = shade_pass(&material, &pass, texel, &mut Work::default());
        prop_assert_eq!(full.discarded, lean.discarded);
        let keywords = Keywords::new(&material, &pass, 1);
        if keywords.color {
            prop_assert_eq!(&full.color[..3], &lean.color[..3]);
        }
        let blends_alpha = pass.state.blend[0].is_some() && mask != 0;
        if mask & 8 != 0 || blends_alpha {
            prop_assert_eq!(full.color[3], lean.color[3]);
        }
    }

    /// Fade leaves the lit color alone and lets the blender scale all of it; Transparent scales the diffuse part itself,
    /// keeps the highlight, and gives alpha' = 1 - R + aR.
    #[test]
    fn alpha_scales_everything_in_fade_mode_and_only_diffuse_light_in_transparent_mode(
        tint in prop::array::uniform3(unit()), alpha in unit(), metallic in unit(), smoothness in unit()
    ) {
        let shading = Shading::Lit { metallic, smoothness };
        let at = |mode, alpha| {
            let material = Material { tint: [tint[0], tint[1], tint[2], alpha], shading, ..Material::new("m", mode) };
            shade(&material, [1.0; 4]).color
        };
        let fade = |alpha| at(RenderingMode::Fade, alpha);
        prop_assert_eq!(&fade(alpha)[..3], &fade(1.0)[..3], "the shader's color does not depend on alpha");
        prop_assert_eq!(fade(alpha)[3], alpha);
        let (none, some, all) =
            (at(RenderingMode::Transparent, 0.0), at(RenderingMode::Transparent, alpha), at(RenderingMode::Transparent, 1.0));
        for i in 0..3 {
            let expected = none[i] + alpha * (all[i] - none[i]);
            let tolerance = 1e-5 * all[i].max(1.0);
            prop_assert!((some[i] - expected).abs() <= tolerance, "highlight plus a x diffuse: {} for {}", some[i], expected);
        }
        let reflectivity = 0.96 * (1.0 - metallic);
        prop_assert!((some[3] - (1.0 - reflectivity + alpha * reflectivity)).abs() <= 1e-6, "alpha' {}", some[3]);
        prop_assert_eq!(all[3], 1.0);
    }

    /// The metallic workflow splits an albedo: diffuse falls to nothing, specular goes from 4 % to the albedo.
    #[test]
    fn diffuse_and_specular_from_metallic_share_the_albedo(albedo in prop::array::uniform3(unit()), metallic in unit()) {
        let albedo = Vec3::from(albedo);
        let split = light::diffuse_and_specular_from_metallic(albedo, metallic);
        let left = light::one_minus_reflectivity(metallic);
        prop_assert!((0.0..=0.96).contains(&left));
        prop_assert_eq!(split.diffuse, albedo * left);
        let dielectric = Vec3::splat(light::DIELECTRIC_SPECULAR);
        let (low, high) = (albedo.min(dielectric) - 1e-6, albedo.max(dielectric) + 1e-6);
        prop_assert!(split.specular.cmpge(low).all() && split.specular.cmple(high).all(), "{:?}", split);
        let ends = [0.0, 1.0].map(|metallic| light::diffuse_and_specular_from_metallic(albedo, metallic));
        prop_assert_eq!(ends[0].specular, dielectric);
        prop_assert_eq!(ends[1].diffuse, Vec3::ZERO);
        prop_assert!((ends[1].specular - albedo).abs().max_element() <= 1e-6);
    }
}
