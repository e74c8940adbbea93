// The fragment shader of crate::scene::material::surface, operation by operation, in binary32. Switches of a shader
// variant are overrides, so what a pass does not need is not compiled in.

// Keywords of the pass.
override COLOR: bool;
override ALPHA: bool;
override CLIP: bool;
override TEXTURE: bool;
override LIGHT: bool;
override PREMULTIPLY: bool;
// What the pass computes: flat color, or one further light.
override FLAT: bool;
override ADDS_LIGHT: bool;
// The material.
override LIT: bool;
override SMOOTHNESS_IN_ALPHA: bool;
override PREMULTIPLIED_TEXTURE: bool;
override OUTPUTS_ALPHA: bool;
// The sampler: filter, mips (0 none, 1 nearest, 2 linear), addressing (0 clamp, 1 repeat, 2 mirror, 3 border).
override LINEAR: bool;
override MIPS: u32;
override ADDRESS_U: u32;
override ADDRESS_V: u32;
// The fixed-function alpha test, which today's APIs leave to the shader: 0 off, then the comparisons in order.
override ALPHA_TEST: u32;

const DIELECTRIC_SPECULAR: f32 = 0.04;

struct Draw {
    tint: vec4<f32>,
    eye: vec3<f32>,
    cutoff: f32,
    ambient: vec3<f32>,
    metallic: f32,
    // Towards a directional light, or a point light's position.
    light: vec3<f32>,
    // 0 none, 1 directional, 2 point.
    light_kind: u32,
    light_color: vec3<f32>,
    light_range: f32,
    smoothness: f32,
    alpha_reference: f32,
    number: u32,
    unused: u32,
}

struct Log {
    next: atomic<u32>,
    words: array<u32>,
}

@group(0) @binding(0) var<uniform> draw: Draw;
@group(0) @binding(1) var image: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> log: Log;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) world: vec3<f32>,
    @location(3) @interpolate(flat) triangle: u32,
}

@vertex
fn corner(
    @location(0) position: vec4<f32>,
    @location(1) a: vec4<f32>,
    @location(2) b: vec4<f32>,
    @location(3) triangle: u32,
) -> Corner {
    return Corner(position, a.xy, vec3(a.zw, b.x), b.yzw, triangle);
}

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// A vector of length 1; `otherwise` where there is none.
fn normalized(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let squared = dot3(v, v);
    if !(squared > 0.0) {
        return otherwise;
    }
    return v * (1.0 / sqrt(squared));
}

// A texel coordinate brought into 0 .. size; -1 on the border.
fn wrap(i: i32, size: i32, mode: u32) -> i32 {
    switch mode {
        case 0u: { return clamp(i, 0, size - 1); }
        case 1u: { return ((i % size) + size) % size; }
        case 2u: {
            let j = ((i % (2 * size)) + 2 * size) % (2 * size);
            return min(j, 2 * size - 1 - j);
        }
        default: { return select(-1, i, i >= 0 && i < size); }
    }
}

fn fetch(level: i32, x: i32, y: i32) -> vec4<f32> {
    let size = vec2<i32>(textureDimensions(image, level));
    let at = vec2(wrap(x, size.x, ADDRESS_U), wrap(y, size.y, ADDRESS_V));
    if at.x < 0 || at.y < 0 {
        return vec4(0.0);
    }
    return textureLoad(image, at, level);
}

fn blend(a: vec4<f32>, b: vec4<f32>, t: f32) -> vec4<f32> {
    return a + t * (b - a);
}

fn sample_level(level: i32, uv: vec2<f32>) -> vec4<f32> {
    let at = uv * vec2<f32>(textureDimensions(image, level));
    if !LINEAR {
        return fetch(level, i32(floor(at.x)), i32(floor(at.y)));
    }
    let corner = floor(at - 0.5);
    let t = at - 0.5 - corner;
    let x = i32(corner.x);
    let y = i32(corner.y);
    let upper = blend(fetch(level, x, y), fetch(level, x + 1, y), t.x);
    let lower = blend(fetch(level, x, y + 1), fetch(level, x + 1, y + 1), t.x);
    return blend(upper, lower, t.y);
}

fn sample(uv: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>) -> vec4<f32> {
    if MIPS == 0u {
        return sample_level(0, uv);
    }
    let size = vec2<f32>(textureDimensions(image, 0));
    let last = i32(textureNumLevels(image)) - 1;
    let x = dx * size;
    let y = dy * size;
    var rho = max(sqrt(x.x * x.x + x.y * x.y), sqrt(y.x * y.x + y.y * y.y));
    var level = 0;
    while rho >= 2.0 && level < last {
        rho /= 2.0;
        level += 1;
    }
    let fraction = select(0.0, min(rho, 2.0) - 1.0, rho > 1.0 && level < last);
    if MIPS == 1u {
        return sample_level(select(level + 1, level, fraction < 0.5), uv);
    }
    if fraction == 0.0 {
        return sample_level(level, uv);
    }
    return blend(sample_level(level, uv), sample_level(level + 1, uv), fraction);
}

fn one_minus_reflectivity() -> f32 {
    return (1.0 - DIELECTRIC_SPECULAR) * (1.0 - draw.metallic);
}

fn premultiplier(alpha: f32) -> f32 {
    if !PREMULTIPLY {
        return 1.0;
    }
    return select(alpha, draw.tint.a, PREMULTIPLIED_TEXTURE && !FLAT);
}

fn alpha_output(alpha: f32) -> f32 {
    if !OUTPUTS_ALPHA {
        return 1.0;
    }
    if LIT && PREMULTIPLY && !FLAT {
        return 1.0 - one_minus_reflectivity() * (1.0 - alpha);
    }
    return alpha;
}

struct Reflected {
    diffuse: vec3<f32>,
    specular: vec3<f32>,
}

fn reflect_light(position: vec3<f32>, normal: vec3<f32>, view: vec3<f32>, roughness: f32) -> Reflected {
    var toward = draw.light;
    var radiance = draw.light_color;
    if draw.light_kind == 2u {
        let offset = draw.light - position;
        let fall = max(1.0 - dot3(offset, offset) / (draw.light_range * draw.light_range), 0.0);
        toward = normalized(offset, normal);
        radiance = draw.light_color * (fall * fall);
    }
    let diffuse = radiance * max(dot3(normal, toward), 0.0);
    let halfway = normalized(toward + view, normal);
    let n_h = max(dot3(normal, halfway), 0.0);
    let l_h = max(dot3(toward, halfway), 0.0);
    let r = max(roughness, 0.002);
    let spread = n_h * n_h * (r * r - 1.0) + 1.0;
    let specular = r * r / (4.0 * spread * spread * max(l_h * l_h, 0.1) * (r + 0.5));
    return Reflected(diffuse, diffuse * specular);
}

fn lit(in: Corner, front: bool, albedo: vec3<f32>, alpha: f32, smoothness: f32) -> vec3<f32> {
    let normal = normalized(in.normal, vec3(0.0, 0.0, 1.0)) * select(-1.0, 1.0, front);
    let view = normalized(draw.eye - in.world, normal);
    let rough = 1.0 - smoothness;
    let diffuse_color = albedo * one_minus_reflectivity() * premultiplier(alpha);
    let specular_color = DIELECTRIC_SPECULAR + (albedo - DIELECTRIC_SPECULAR) * draw.metallic;
    var light = Reflected(vec3(0.0), vec3(0.0));
    if draw.light_kind != 0u {
        light = reflect_light(in.world, normal, view, rough * rough);
    }
    return diffuse_color * (draw.ambient + light.diffuse) + specular_color * light.specular;
}

struct Surface {
    color: vec4<f32>,
    discarded: bool,
}

fn surface(in: Corner, front: bool, dx: vec2<f32>, dy: vec2<f32>) -> Surface {
    var texel = vec4(1.0);
    if TEXTURE {
        texel = sample(in.uv, dx, dy);
    }
    var alpha = 1.0;
    if ALPHA {
        alpha = draw.tint.a;
        if !SMOOTHNESS_IN_ALPHA {
            alpha = draw.tint.a * texel.a;
        }
    }
    if CLIP && alpha - draw.cutoff < 0.0 {
        return Surface(vec4(0.0), true);
    }
    if !COLOR {
        return Surface(vec4(0.0, 0.0, 0.0, alpha_output(alpha)), false);
    }
    var albedo = draw.tint.rgb;
    if !FLAT {
        albedo = draw.tint.rgb * texel.rgb;
    }
    var color = albedo * premultiplier(alpha);
    if LIT && LIGHT {
        var smoothness = draw.smoothness;
        if SMOOTHNESS_IN_ALPHA {
            smoothness = draw.smoothness * texel.a;
        }
        color = lit(in, front, albedo, alpha, smoothness);
    } else if ADDS_LIGHT {
        color = vec3(0.0);
    }
    return Surface(vec4(color, alpha_output(alpha)), false);
}

fn normal_output(in: Corner, color: vec4<f32>) -> vec4<f32> {
    return vec4(normalized(in.normal, vec3(0.0, 0.0, 1.0)) * 0.5 + 0.5, color.a);
}

fn passes_alpha_test(alpha: f32) -> bool {
    let reference = draw.alpha_reference;
    switch ALPHA_TEST {
        case 1u: { return false; }
        case 2u: { return alpha < reference; }
        case 3u: { return alpha == reference; }
        case 4u: { return alpha <= reference; }
        case 5u: { return alpha > reference; }
        case 6u: { return alpha != reference; }
        case 7u: { return alpha >= reference; }
        default: { return true; }
    }
}

// Takes a record for this fragment, writes what comes before its colors, and returns where those go.
fn open_record(in: Corner, front: bool, discarded: bool, words: u32) -> u32 {
    let at = atomicAdd(&log.next, 1u) * words;
    if at + words <= arrayLength(&log.words) {
        log.words[at] = draw.number;
        log.words[at + 1u] = in.triangle;
        log.words[at + 2u] = u32(in.position.x) | u32(in.position.y) << 16u;
        log.words[at + 3u] = select(0u, 1u, front) | select(0u, 2u, discarded);
        log.words[at + 4u] = bitcast<u32>(in.position.z);
    }
    return at + 5u;
}

fn write_record(at: u32, color: vec4<f32>) {
    if at + 4u <= arrayLength(&log.words) {
        let bits = bitcast<vec4<u32>>(color);
        log.words[at] = bits.x;
        log.words[at + 1u] = bits.y;
        log.words[at + 2u] = bits.z;
        log.words[at + 3u] = bits.w;
    }
}
