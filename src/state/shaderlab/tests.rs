use wgpu_types::{BlendFactor as F, BlendOperation as O, ColorWrites, CompareFunction as C, Face, StencilOperation};

use super::{Pass, Properties, PropertyValue, parse};
use crate::state::{AlphaTest, StateBlock};

fn block(text: &str) -> StateBlock {
    let mut passes = parse(text, &Properties::new()).unwrap_or_else(|e| panic!("{text}: {e}"));
    assert_eq!(passes.len(), 1, "{text}: one pass");
    passes.remove(0).state
}

fn message(text: &str) -> String {
    parse(text, &Properties::new()).expect_err(text).to_string()
}

#[test]
fn blend_without_alpha_factors_uses_the_color_factors_for_alpha() {
    let blend = block("Blend SrcAlpha OneMinusSrcAlpha").blend[0].expect("blending is on");
    assert_eq!((blend.color.src_factor, blend.color.dst_factor), (F::SrcAlpha, F::OneMinusSrcAlpha), "color");
    assert_eq!(blend.alpha, blend.color, "alpha");
}

#[test]
fn separate_alpha_factors_operations_and_targets() {
    let state = block("BlendOp RevSub, Max\nBlend SrcAlpha OneMinusSrcAlpha, One Zero\nBlend 1 Off ColorMask RB 2");
    let blend = state.blend[0].expect("on");
    assert_eq!(blend.color.operation, O::ReverseSubtract, "color operation");
    assert_eq!((blend.alpha.operation, blend.alpha.src_factor), (O::Max, F::One), "max has factors one");
    assert_eq!(blend.alpha.dst_factor, F::One, "max has factors one");
    assert_eq!(state.blend[1], None, "target 1 is off");
    assert_eq!(state.write_mask[2], ColorWrites::RED | ColorWrites::BLUE, "target 2's mask");
    assert_eq!(state.write_mask[0], ColorWrites::ALL, "target 0's mask");
}

#[test]
fn blend_op_does_nothing_without_blend() {
    assert_eq!(block("BlendOp RevSub").blend, [None; 8], "no Blend");
    assert_eq!(block("Blend One One Blend Off BlendOp Max").blend, [None; 8], "off again");
    let blend = block("Blend SrcAlpha One BlendOp Max BlendOp Sub").blend[0].expect("on");
    assert_eq!((blend.color.src_factor, blend.color.operation), (F::SrcAlpha, O::Subtract), "factors survive Max");
    let blend = block("BlendOp Min Blend Off Blend SrcAlpha One").blend[0].expect("on");
    assert_eq!((blend.color.src_factor, blend.color.operation), (F::One, O::Min), "the operation survives Off");
}

#[test]
fn commands_and_values_are_read_in_any_case() {
    assert_eq!(
        block("zwrite OFF blend srcalpha one cull front"),
        block("ZWrite Off Blend SrcAlpha One Cull Front"),
        "case"
    );
    assert_eq!(block("Tags { \"QUEUE\" = \"Transparent\" }").tag("Queue"), Some("Transparent"), "tags");
}

#[test]
fn commands_outside_the_model_pass_where_they_say_the_default() {
    let plain = "Lighting Off Fog { Mode Off } ZClip True AlphaToMask Off Conservative False GrabPass { \"_A\" }";
    assert_eq!(block(plain), StateBlock::default(), "defaults");
    for (text, expected) in [
        ("Lighting On", "write `Lighting Off`"),
        ("AlphaToMask On", "write `AlphaToMask Off`"),
        ("Fog { Color (1,1,1,1) }", "outmerge has no fog"),
        ("SetTexture [_MainTex] { combine primary }", "fixed-function shading"),
        ("UsePass \"Other/PASS\"", "put that pass here"),
    ] {
        assert!(message(text).contains(expected), "{text}: {}", message(text));
    }
}

#[test]
fn every_command_sets_its_state() {
    let state = block(
        "ZWrite Off ZTest Greater Cull Front ColorMask 0 Offset -1, -2 AlphaTest GEqual 0.25
         Stencil { Ref 3 ReadMask 15 WriteMask 7 Comp Equal PassFront Replace ZFail IncrSat FailBack Invert }
         Tags { \"Queue\" = \"Transparent+1\" \"RenderType\" = \"Tree\" }",
    );
    assert!(!state.depth_write, "ZWrite");
    assert_eq!((state.depth_compare, state.cull), (C::Greater, Some(Face::Front)), "ZTest and Cull");
    assert_eq!(state.write_mask[0], ColorWrites::empty(), "ColorMask 0");
    assert_eq!((state.depth_bias.slope_scale, state.depth_bias.constant), (-1.0, -2), "Offset");
    assert_eq!(state.alpha_test, AlphaTest::On { compare: C::GreaterEqual, reference: 0.25 }, "AlphaTest");
    let (stencil, reference) = state.stencil.clone().expect("stencil");
    assert_eq!((reference, stencil.read_mask, stencil.write_mask), (3, 15, 7), "reference and masks");
    assert_eq!(
        (stencil.front.pass_op, stencil.back.pass_op),
        (StencilOperation::Replace, StencilOperation::Keep),
        "Pass"
    );
    assert_eq!(stencil.back.depth_fail_op, StencilOperation::IncrementClamp, "ZFail sets both");
    assert_eq!(
        (stencil.front.fail_op, stencil.back.fail_op),
        (StencilOperation::Keep, StencilOperation::Invert),
        "Fail"
    );
    assert_eq!((state.tag("Queue"), state.tag("RenderType")), (Some("Transparent+1"), Some("Tree")), "Tags");
}

#[test]
fn all_alpha_test_comparisons_and_off() {
    for (name, compare) in [
        ("Greater", C::Greater),
        ("GEqual", C::GreaterEqual),
        ("Less", C::Less),
        ("LEqual", C::LessEqual),
        ("Equal", C::Equal),
        ("NotEqual", C::NotEqual),
        ("Always", C::Always),
        ("Never", C::Never),
    ] {
        let state = block(&format!("AlphaTest {name} 0.5"));
        assert_eq!(state.alpha_test, AlphaTest::On { compare, reference: 0.5 }, "{name}");
    }
    assert_eq!(block("AlphaTest Off").alpha_test, AlphaTest::Off, "Off");
    assert_eq!(
        block("AlphaTest Always ZWrite Off").alpha_test,
        AlphaTest::On { compare: C::Always, reference: 0.0 },
        "bare"
    );
    let text = "Properties { _Cut (\"Cutoff\", Range(0, 1)) = 0.75 } AlphaTest Never [_Cut] ZWrite Off";
    assert_eq!(block(text).alpha_test, AlphaTest::On { compare: C::Never, reference: 0.75 }, "an unused reference");
}

#[test]
fn properties_resolve_by_number_by_name_and_by_default() {
    let text = "Blend [_Src] [_Dst] ZWrite [_ZWrite] AlphaTest Greater [_Cutoff]";
    let values: Properties = [
        ("_Src", PropertyValue::Number(5.0)),
        ("_Dst", PropertyValue::Name("OneMinusSrcAlpha".to_owned())),
        ("_ZWrite", PropertyValue::Number(0.0)),
        ("_Cutoff", PropertyValue::Number(0.5)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    let passes = parse(text, &values).expect("all properties have values");
    let blend = passes[0].state.blend[0].expect("on");
    assert_eq!((blend.color.src_factor, blend.color.dst_factor), (F::SrcAlpha, F::OneMinusSrcAlpha), "5 and a name");
    assert!(!passes[0].state.depth_write, "0 is Off");
    assert!(message(text).contains("line 1, column 7: property `[_Src]` has no value"), "{}", message(text));
}

#[test]
fn a_whole_shader_yields_its_passes_with_inherited_state() {
    let text = r#"
        Shader "Custom/Vegetation" {
            Properties { [Enum(A,1)] _Cutoff ("Cutoff", Range(0,1)) = 0.5  _MainTex ("Tex", 2D) = "white" {} }
            SubShader {
                Tags { "Queue" = "AlphaTest" }  LOD 100
                Cull Off // both sides
                Pass { Name "Tested" AlphaTest Greater [_Cutoff]
                    HLSLPROGRAM
                    float4 frag() { return "}"; }
                    ENDHLSL
                }
                /* then the rest */
                Pass { ZWrite Off ZTest Less AlphaTest LEqual [_Cutoff] Blend SrcAlpha OneMinusSrcAlpha }
            }
            Fallback "Diffuse"
        }"#;
    let passes = parse(text, &Properties::new()).expect("a valid shader");
    let [Pass { name, state: first, .. }, Pass { state: second, .. }] = passes.as_slice() else { panic!("two passes") };
    assert_eq!(name.as_deref(), Some("Tested"), "name");
    assert_eq!((first.cull, second.cull), (None, None), "inherited");
    assert_eq!(first.alpha_test, AlphaTest::On { compare: C::Greater, reference: 0.5 }, "default property");
    assert!(first.depth_write && !second.depth_write, "each pass has its own");
    assert_eq!(first.blend[0], None, "the second pass's blend does not leak");
    assert_eq!(second.tag("Queue"), Some("AlphaTest"), "tags are inherited");
}

#[test]
fn categories_hand_their_state_down_and_sub_shaders_are_counted() {
    let text = "\u{feff}Shader \"x\" { Category { ZWrite Off Category { Cull Off
        SubShader { Pass { Name \"A\" } Tags { \"Queue\" = \"Transparent\" } }
        SubShader { Blend One One CGPROGRAM surface ENDCG } } } Fallback Off }";
    let passes = parse(text, &Properties::new()).expect("a valid shader");
    let [first, second] = passes.as_slice() else { panic!("two passes") };
    assert_eq!((first.sub_shader, second.sub_shader), (0, 1), "sub-shaders");
    assert!(passes.iter().all(|pass| !pass.state.depth_write && pass.state.cull.is_none()), "from the categories");
    assert_eq!(first.state.tag("Queue"), Some("Transparent"), "tags behind the pass are its tags too");
    assert_eq!((first.state.blend[0].is_some(), second.state.blend[0].is_some()), (false, true), "surface shader");
}

#[test]
fn property_defaults_are_read_by_their_grammar() {
    let text = r#"Shader "x" { Properties {
        [Header(Blending)] [Enum(UnityEngine.Rendering.BlendMode)] Source ("Source (A, B)", Float) = 5
        _Color ("Tint", Color) = (1, 0.5, .5, 1)   _Cube ("Cube", Cube) = "_Skybox" { TexGen CubeReflect }
        _Dst ("Dst", Int) = 10.0 }
        SubShader { Blend [Source] [_Dst] } }"#;
    let passes = parse(text, &Properties::new()).expect("a valid shader");
    let blend = passes[0].state.blend[0].expect("on");
    assert_eq!((blend.color.src_factor, blend.color.dst_factor), (F::SrcAlpha, F::OneMinusSrcAlpha), "5 and 10");
    let given: Properties = [("Source".to_owned(), PropertyValue::Number(1.0))].into();
    let passes = parse(text, &given).expect("a valid shader");
    assert_eq!(passes[0].state.blend[0].expect("on").color.src_factor, F::One, "a supplied value wins");
}

#[test]
fn hostile_sizes_are_refused_or_read_in_linear_time() {
    let deep = "Category {".repeat(100_000);
    assert!(message(&deep).contains("more than 16 blocks"), "nesting: {}", message(&deep));
    assert!(message(&"Pass {}".repeat(1000)).contains("more than 256 passes"), "passes");
    let tags: String = (0..100_000).map(|i| format!("\"a{i}\"=\"b\" ")).collect();
    assert!(message(&format!("Tags {{ {tags} }}")).contains("more than 64 tags"), "tags");
    assert!(message(&"a".repeat(1_000_000)).len() < 500, "long names are cut");
    assert!(message(&format!("Properties {{ {}", "(".repeat(100_000))).contains("line 1"), "parentheses");
}

#[test]
fn mistakes_are_reported_with_line_and_column() {
    for (text, expected) in [
        ("ZWrite Off\n  Blnd One One", "line 2, column 3: unknown command `Blnd`; did you mean `Blend`?"),
        ("Blend SrcAlhpa One", "line 1, column 7: unknown blend factor `SrcAlhpa`; did you mean `src-alpha`?"),
        ("ZTest Less\n Pass { ZWrite On", "line 2, column 2: this Pass block is never closed with `}`"),
        ("Stencil { Ref 1", "line 1, column 1: this Stencil block is never closed"),
        ("Tags { \"A\"=\"B\"", "line 1, column 1: this Tags block is never closed"),
        ("Properties { _A (\"a\", Float) = 1", "line 1, column 1: this Properties block is never closed"),
        ("Properties { _A (\"a\", Float = 1 }", "line 1, column 14: this property's parenthesis"),
        ("Properties { _A (\"a\", Float) 1 }", "expected `=`"),
        ("Shader \"x\" { }", "has no SubShader"),
        ("Shader \"x\" { SubShader { } } ZWrite", "unexpected `ZWrite` after the end"),
        ("Tags { \"Queue\" = \"Sky\" }", "line 1, column 18: unknown render queue `Sky`"),
        ("HLSLPROGRAM x", "never closed with ENDHLSL"),
        ("ZWrite Maybe", "write On or Off"),
        ("Blend One", "line 1, column 10: expected a blend factor or a [_Property], found the end"),
        ("Blend One CONSTANT_ALPHA", "has no WebGPU form"),
        ("BlendOp LogicalXor", "unknown blend operation"),
        ("Offset 1e300, 0", "beyond the range"),
        ("Offset 0, 0.5", "a whole number"),
        ("AlphaTest Less 1e39", "beyond the range"),
        ("Stencil { Ref 256 }", "not a whole number from 0 to 255"),
        ("Stencil { Pass Incr }", "unknown stencil operation `Incr`"),
        ("ColorMask RGX", "letters out of R, G, B, A"),
        ("Cull Both", "write Back, Front or Off"),
        ("AlphaTest Greater nan", "a finite number"),
        ("Blend 9 One One", "there is no target 9"),
        ("}", "expected a command"),
        ("ZWrite On ;", "unexpected character `;`"),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text}: {message}");
    }
}

fn name_of_factor(factor: F) -> String {
    format!("{factor:?}")
}

/// The state as ShaderLab commands, target by target.
fn write(state: &StateBlock) -> String {
    let mut text = String::new();
    for (i, blend) in state.blend.iter().enumerate() {
        let mask: String =
            [('R', ColorWrites::RED), ('G', ColorWrites::GREEN), ('B', ColorWrites::BLUE), ('A', ColorWrites::ALPHA)]
                .into_iter()
                .filter_map(|(letter, bit)| state.write_mask[i].contains(bit).then_some(letter))
                .collect();
        text += &format!("ColorMask {} {i}\n", if mask.is_empty() { "0" } else { &mask });
        let Some(blend) = blend else { continue };
        let [cs, cd, al, ad] =
            [blend.color.src_factor, blend.color.dst_factor, blend.alpha.src_factor, blend.alpha.dst_factor]
                .map(name_of_factor);
        text += &format!("Blend {i} {cs} {cd}, {al} {ad}\n");
        text += &format!("BlendOp {i} {:?}, {:?}\n", blend.color.operation, blend.alpha.operation);
    }
    text += if state.depth_write { "ZWrite On\n" } else { "ZWrite Off\n" };
    text += &format!(
        "ZTest {:?}\nCull {}\n",
        state.depth_compare,
        state.cull.map_or("Off".to_owned(), |face| format!("{face:?}"))
    );
    text += &format!("Offset {:?}, {}\n", state.depth_bias.slope_scale, state.depth_bias.constant);
    if let AlphaTest::On { compare, reference } = state.alpha_test {
        text += &format!("AlphaTest {compare:?} {reference:?}\n");
    }
    if let Some((stencil, reference)) = &state.stencil {
        text +=
            &format!("Stencil {{ Ref {reference} ReadMask {} WriteMask {}\n", stencil.read_mask, stencil.write_mask);
        for (face, name) in [(&stencil.front, "Front"), (&stencil.back, "Back")] {
            text += &format!("Comp{name} {:?} Pass{name} {:?} ", face.compare, face.pass_op);
            text += &format!("Fail{name} {:?} ZFail{name} {:?}\n", face.fail_op, face.depth_fail_op);
        }
        text += "}\n";
    }
    text += "Tags {";
    for (key, value) in &state.tags {
        text += &format!(" \"{key}\" = \"{value}\"");
    }
    text + " }"
}

proptest::proptest! {
    #[test]
    fn a_state_block_survives_writing_and_reading(state in crate::state::strategy::state_block()) {
        let text = write(&state);
        let passes = parse(&text, &Properties::new()).map_err(|e| proptest::test_runner::TestCaseError::fail(format!("{e}\n{text}")))?;
        proptest::prop_assert_eq!(&passes[0].state, &state, "{}", text);
    }

    #[test]
    fn no_words_panic(text in "(Blend|ZWrite|Off|One|Pass|Category|SubShader|Properties|\\(|\\)|\\{|\\}|Tags|\"|Stencil|Ref|Comp|Fog|\\[|_A|\\]|=|,|//|/\\*|HLSLPROGRAM|[ \n]|[0-9]|.){0,60}") {
        let _ = parse(&text, &Properties::new());
    }

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..200)) {
        let _ = parse(&String::from_utf8_lossy(&bytes), &Properties::new());
    }
}
