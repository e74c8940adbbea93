//! The shader of one draw: a variant compiled with what the pass needs, and the values it reads.

use std::fmt::Write as _;

use wgpu::{AddressMode, CompareFunction, FilterMode, MipmapFilterMode};

use super::log::record_words;
use crate::scene::Scene;
use crate::scene::description::Output;
use crate::scene::draw::Draw;
use crate::scene::material::{Light, Shader, Shading};
use crate::scene::texture::Sampler;
use crate::state::AlphaTest;

/// Everything but the entry point.
const SURFACE: &str = include_str!("surface.wgsl");

/// Bytes of a draw's values: `Draw` of `surface.wgsl`.
pub const UNIFORM_BYTES: u64 = 4 * UNIFORM_WORDS as u64;

/// Words of the same.
const UNIFORM_WORDS: usize = 24;

/// What the overrides of the shader are set to, in the order of [`NAMES`].
pub type Constants = [u32; NAMES.len()];

/// The shader's overrides.
pub const NAMES: [&str; 17] = [
    "COLOR",
    "ALPHA",
    "CLIP",
    "TEXTURE",
    "LIGHT",
    "PREMULTIPLY",
    "FLAT",
    "ADDS_LIGHT",
    "LIT",
    "SMOOTHNESS_IN_ALPHA",
    "PREMULTIPLIED_TEXTURE",
    "OUTPUTS_ALPHA",
    "LINEAR",
    "MIPS",
    "ADDRESS_U",
    "ADDRESS_V",
    "ALPHA_TEST",
];

/// The shader's text for targets with these outputs.
#[must_use]
pub fn wgsl(outputs: &[Output]) -> String {
    let (mut fields, mut body) = (String::new(), String::new());
    for (location, output) in outputs.iter().enumerate() {
        let value = match output {
            Output::Color => "done.color",
            Output::Normal => "normal_output(in, done.color)",
        };
        let _ = writeln!(fields, "    @location({location}) color{location}: vec4<f32>,");
        let _ = writeln!(body, "    out.color{location} = {value};");
        let _ = writeln!(body, "    write_record(at + {}u, out.color{location});", 4 * location);
    }
    let words = record_words(outputs.len());
    format!(
        "{SURFACE}
struct Outputs {{
{fields}}}

@fragment
fn shade(in: Corner, @builtin(front_facing) front: bool) -> Outputs {{
    let dx = dpdxCoarse(in.uv);
    let dy = dpdyCoarse(in.uv);
    let done = surface(in, front, dx, dy);
    let at = open_record(in, front, done.discarded, {words}u);
    var out: Outputs;
{body}    if done.discarded || !passes_alpha_test(out.color0.a) {{
        discard;
    }}
    return out;
}}
"
    )
}

/// What distinguishes the shader variant of a draw.
#[must_use]
pub fn constants(scene: &Scene, draw: &Draw) -> Constants {
    let (keywords, material) = (draw.keywords, &draw.material);
    let sampler = material.texture.map_or_else(Sampler::default, |index| scene.textures[index].sampler());
    let mips = match sampler.mips {
        None => 0,
        Some(MipmapFilterMode::Nearest) => 1,
        Some(MipmapFilterMode::Linear) => 2,
    };
    let alpha_test = match draw.state.alpha_test {
        AlphaTest::Off => 0,
        AlphaTest::On { compare, .. } => comparison(compare),
    };
    let on = u32::from;
    [
        on(keywords.color),
        on(keywords.alpha),
        on(keywords.clip),
        on(keywords.texture),
        on(keywords.light),
        on(keywords.premultiply),
        on(draw.shader == Shader::Flat),
        on(draw.shader == Shader::Light),
        on(matches!(material.shading, Shading::Lit { .. })),
        on(material.smoothness_in_alpha),
        on(material.premultiplied_texture),
        on(material.mode.settings().outputs_alpha),
        on(sampler.filter == FilterMode::Linear),
        mips,
        addressing(sampler.address[0]),
        addressing(sampler.address[1]),
        alpha_test,
    ]
}

fn addressing(mode: AddressMode) -> u32 {
    match mode {
        AddressMode::ClampToEdge => 0,
        AddressMode::Repeat => 1,
        AddressMode::MirrorRepeat => 2,
        AddressMode::ClampToBorder => 3,
    }
}

/// As `passes_alpha_test` of the shader counts.
fn comparison(compare: CompareFunction) -> u32 {
    match compare {
        CompareFunction::Never => 1,
        CompareFunction::Less => 2,
        CompareFunction::Equal => 3,
        CompareFunction::LessEqual => 4,
        CompareFunction::Greater => 5,
        CompareFunction::NotEqual => 6,
        CompareFunction::GreaterEqual => 7,
        CompareFunction::Always => 8,
    }
}

/// The values of a draw, as words.
#[must_use]
pub fn uniform(scene: &Scene, draw: &Draw, number: u32) -> [u32; UNIFORM_WORDS] {
    let material = &draw.material;
    let (metallic, smoothness) = match material.shading {
        Shading::Unlit => (0.0, 0.0),
        Shading::Lit { metallic, smoothness } => (metallic, smoothness),
    };
    let reference = match draw.state.alpha_test {
        AlphaTest::Off => 0.0,
        AlphaTest::On { reference, .. } => reference,
    };
    let further = draw.shader == Shader::Light;
    let ambient = if further { [0.0; 3] } else { scene.lighting.ambient.to_array() };
    let light = scene.lighting.lights.get(if further { draw.light } else { 0 });
    let (kind, place, color, range) = match light {
        None => (0, [0.0; 3], [0.0; 3], 1.0),
        Some(Light::Directional { toward, color }) => (1, toward.to_array(), color.to_array(), 1.0),
        Some(Light::Point { position, color, range }) => (2, position.to_array(), color.to_array(), *range),
    };
    let quad = |[x, y, z]: [f32; 3], w: u32| [x.to_bits(), y.to_bits(), z.to_bits(), w];
    let quads = [
        material.tint.map(f32::to_bits),
        quad(scene.eye().to_array(), material.cutoff.to_bits()),
        quad(ambient, metallic.to_bits()),
        quad(place, kind),
        quad(color, range.to_bits()),
        [smoothness.to_bits(), reference.to_bits(), number, 0],
    ];
    std::array::from_fn(|i| quads[i / 4][i % 4])
}
