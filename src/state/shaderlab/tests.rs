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
    let state = block("Blend SrcAlpha OneMinusSrcAlpha, One Zero\nBlendOp RevSub, Max\nBlend 1 Off ColorMask RB 2");
    let blend = state.blend[0].expect("on");
    assert_eq!(blend.color.operation, O::ReverseSubtract, "color operation");
    assert_eq!((blend.alpha.operation, blend.alpha.src_factor), (O::Max, F::One), "max has factors one");
    assert_eq!(blend.alpha.dst_factor, F::One, "max has factors one");
    assert_eq!(state.blend[1], None, "target 1 is off");
    assert_eq!(state.write_mask[2], ColorWrites::RED | ColorWrites::BLUE, "target 2's mask");
    assert_eq!(state.write_mask[0], ColorWrites::ALL, "target 0's mask");
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
    let [Pass { name, state: first }, Pass { state: second, .. }] = passes.as_slice() else { panic!("two passes") };
    assert_eq!(name.as_deref(), Some("Tested"), "name");
    assert_eq!((first.cull, second.cull), (None, None), "inherited");
    assert_eq!(first.alpha_test, AlphaTest::On { compare: C::Greater, reference: 0.5 }, "default property");
    assert!(first.depth_write && !second.depth_write, "each pass has its own");
    assert_eq!(first.blend[0], None, "the second pass's blend does not leak");
    assert_eq!(second.tag("Queue"), Some("AlphaTest"), "tags are inherited");
}

#[test]
fn mistakes_are_reported_with_line_and_column() {
    for (text, expected) in [
        ("ZWrite Off\n  Blnd One One", "line 2, column 3: unknown command `Blnd`"),
        ("Blend SrcAlhpa One", "line 1, column 7: unknown blend factor `SrcAlhpa`; did you mean `src-alpha`?"),
        ("Pass { ZWrite On", "never closed with `}`"),
        ("Tags { \"Queue\" = \"Sky\" }", "line 1, column 18: unknown render queue `Sky`"),
        ("HLSLPROGRAM x", "never closed with ENDHLSL"),
        ("ZWrite Maybe", "write On or Off"),
        ("Blend One", "expected a blend factor or a [_Property], found the end"),
        ("AlphaTest Greater nan", "a finite number"),
        ("Blend 9 One One", "there is no target 9"),
        ("}", "expected a command"),
        ("ZWrite On ;", "unexpected character `;`"),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text}: {message}");
    }
}

proptest::proptest! {
    #[test]
    fn no_text_panics(text in "(Blend|ZWrite|Off|One|Pass|\\{|\\}|Tags|\"|Stencil|Ref|\\[|_A|\\]|=|,|//|/\\*|HLSLPROGRAM|[ \n]|.){0,60}") {
        let _ = parse(&text, &Properties::new());
    }
}
