use std::path::Path;

use base64::Engine;
use proptest::prelude::*;
use wgpu_types::BlendFactor;

use super::*;
use crate::limit::Limits;
use crate::scene::material::{RenderingMode, Shading};

/// A square of two triangles, first facing +z, and a lone triangle without normals.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
                   f 1/1/1 2/2/1 3/3/1 4/4/1\nv 0 0 2\nv 1 0 2\nv 0 1 2\nf 5 6 7\n";

/// A triangle whose material has this alpha mode; 36 bytes of positions, 6 of indices.
fn gltf_text(alpha_mode: &str, extra: &str) -> String {
    let positions: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"name":"root","translation":[1,2,3],"children":[1]}},{{"name":"leaf","mesh":0,"scale":[2,2,2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
        "materials":[{{"name":"m","alphaMode":"{alpha_mode}",{extra}"doubleSided":true,
            "pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.25,1,0.5],"metallicFactor":0.25,"roughnessFactor":0.75}}}}],
        "buffers":[{{"byteLength":42,"uri":"data:application/octet-stream;base64,{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}]}}"#
    )
}

fn parse(text: &str) -> Result<Model, ImportError> {
    gltf::parse(text.as_bytes(), Path::new("test.gltf"), &Limits::default())
}

#[test]
fn obj_faces_become_triangles_with_flat_normals_where_none_are_given() {
    let mesh = obj::parse(OBJ.as_bytes(), Path::new("test.obj")).expect("a correct file");
    assert_eq!(mesh.faces.len(), 3, "a square and a triangle");
    assert!(mesh.vertices.iter().all(|vertex| (vertex.normal - glam::DVec3::Z).length() < 1e-12), "all face +z");
    assert_eq!(mesh.vertices[0].uv, glam::DVec2::new(0.0, 1.0), "OBJ's v points up, images' down");
    for (text, why) in [("v 0 0\n", "test.obj"), ("f 1 2 3\n", "test.obj"), ("", "no faces"), ("v a b c\n", "test.obj")]
    {
        let error = obj::parse(text.as_bytes(), Path::new("test.obj")).expect_err(why);
        assert!(error.to_string().contains(why), "`{text}`: {error}");
    }
}

#[test]
fn gltf_alpha_modes_map_to_rendering_modes_and_cutoffs() {
    for (alpha_mode, extra, mode, cutoff) in [
        ("OPAQUE", "", RenderingMode::Opaque, 0.5),
        ("MASK", "", RenderingMode::Cutout, 0.5),
        ("MASK", "\"alphaCutoff\":0.25,", RenderingMode::Cutout, 0.25),
        ("BLEND", "", RenderingMode::Fade, 0.5),
    ] {
        let model = parse(&gltf_text(alpha_mode, extra)).unwrap_or_else(|error| panic!("{error}"));
        let material = &model.materials[0];
        assert_eq!((material.mode, material.cutoff), (mode, cutoff), "{alpha_mode} {extra}");
        assert_eq!(material.tint, [0.5, 0.25, 1.0, 0.5], "base color factor");
        assert_eq!(material.shading, Shading::Lit { metallic: 0.25, smoothness: 0.25 }, "smoothness is 1 - roughness");
        let passes = material.passes();
        assert!(passes.iter().all(|pass| pass.state.cull.is_none()), "double-sided is Cull Off");
        let src = passes[0].state.blend[0].map(|blend| blend.color.src_factor);
        assert_eq!(
            src,
            (mode == RenderingMode::Fade).then_some(BlendFactor::SrcAlpha),
            "{alpha_mode}: the mode's state"
        );
    }
}

#[test]
fn gltf_samplers_map_to_filters_mips_and_addressing() {
    use wgpu_types::AddressMode as A;
    use wgpu_types::{FilterMode as F, MipmapFilterMode as M};
    let png = crate::scene::Picture { width: 1, height: 1, rgba: vec![255; 4] }.to_png().expect("a small picture");
    let png = base64::engine::general_purpose::STANDARD.encode(png);
    for (sampler, filter, mips, address) in [
        ("", F::Linear, Some(M::Linear), [A::Repeat; 2]),
        (r#""magFilter":9728"#, F::Nearest, None, [A::Repeat; 2]),
        (r#""magFilter":9728,"minFilter":9984"#, F::Nearest, Some(M::Nearest), [A::Repeat; 2]),
        (r#""magFilter":9729,"minFilter":9729"#, F::Linear, None, [A::Repeat; 2]),
        (r#""magFilter":9729,"minFilter":9985"#, F::Linear, Some(M::Nearest), [A::Repeat; 2]),
        (r#""minFilter":9986,"wrapS":33071"#, F::Linear, Some(M::Linear), [A::ClampToEdge, A::Repeat]),
        (r#""minFilter":9987,"wrapT":33648"#, F::Linear, Some(M::Linear), [A::Repeat, A::MirrorRepeat]),
    ] {
        let textures = format!(
            r#""textures":[{{"source":0,"sampler":0}}],"samplers":[{{{sampler}}}],
            "images":[{{"uri":"data:image/png;base64,{png}"}}],"buffers""#
        );
        let text = gltf_text("OPAQUE", "").replacen("\"buffers\"", &textures, 1);
        let model = parse(&text).unwrap_or_else(|error| panic!("{sampler}: {error}"));
        let read = model.textures[0].sampler();
        assert_eq!((read.filter, read.mips, read.address), (filter, mips, address), "{sampler}");
    }
}

#[test]
fn gltf_nodes_place_their_meshes() {
    let model = parse(&gltf_text("OPAQUE", "")).unwrap_or_else(|error| panic!("{error}"));
    let [object] = model.objects.as_slice() else { panic!("one object") };
    assert_eq!((object.name.as_str(), object.mesh, object.material), ("leaf 0", 0, 0), "the leaf node's primitive");
    let corner = object.transform.transform_point3(model.meshes[0].vertices[1].position);
    assert_eq!(corner, glam::DVec3::new(3.0, 2.0, 3.0), "scaled by 2, then moved by (1, 2, 3)");
}

#[test]
fn gltf_faults_are_errors_that_name_the_file() {
    let text = gltf_text("OPAQUE", "");
    for (from, to, why) in [
        ("\"byteLength\":36", "\"byteLength\":360", "beyond"),
        ("\"count\":3,\"type\":\"SCALAR\"", "\"count\":4,\"type\":\"SCALAR\"", "beyond"),
        ("\"scenes\":[{\"nodes\":[0]}]", "\"scenes\":[]", ""),
        ("data:application/octet-stream;base64,", "https://example.org/", "network"),
        ("data:application/octet-stream;base64,", "missing/", "cannot read"),
        ("\"indices\":1", "\"indices\":1,\"mode\":1", "triangles only"),
        ("\"children\":[1]", "\"children\":[0]", ""),
        ("\"VEC3\"", "\"VEC2\"", "wrong type"),
        ("{\"asset\"", "{asset", ""),
    ] {
        assert!(text.contains(from), "the test replaces `{from}`");
        let error = parse(&text.replace(from, to)).map(|model| model.objects.len()).expect_err(to);
        let message = error.to_string();
        assert!(message.contains(why), "`{to}`: {message}");
    }
}

proptest! {
    #[test]
    fn damaged_files_never_panic(start in 0_usize..2000, length in 0_usize..30, insert in "[ -~]{0,8}") {
        for text in [gltf_text("MASK", ""), OBJ.to_owned()] {
            let mut bytes = text.into_bytes();
            let start = start.min(bytes.len());
            let end = (start + length).min(bytes.len());
            bytes.splice(start..end, insert.bytes());
            let _ = gltf::parse(&bytes, Path::new("damaged.gltf"), &Limits::default());
            let _ = obj::parse(&bytes, Path::new("damaged.obj"));
        }
    }
}
