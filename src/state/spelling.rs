//! Names of blend factors, blend operations, comparisons and stencil operations as the graphics APIs spell them.
//!
//! A name is compared without case, `-`, `_`, blanks, Rust path and its API's prefix, so `one-minus-src-alpha`,
//! `OneMinusSrcAlpha`, `GL_ONE_MINUS_SRC_ALPHA`, `VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA`, `D3D12_BLEND_INV_SRC_ALPHA` and
//! `wgpu::BlendFactor::OneMinusSrcAlpha` are one factor.

use wgpu_types::{BlendFactor as F, BlendOperation as O, CompareFunction as C, StencilOperation as S};

/// A name that spells nothing of its kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpellingError {
    /// No such name.
    #[error("unknown {kind} `{name}`{hint}; use one of: {list}")]
    Unknown {
        /// What was asked for: `blend factor`, `blend operation`, `comparison`, `stencil operation`.
        kind: &'static str,
        /// The name as written.
        name: String,
        /// `; did you mean ...` or nothing.
        hint: String,
        /// The WebGPU names.
        list: String,
    },
    /// A factor other APIs have and WebGPU lacks.
    #[error(
        "blend factor `{0}` has no WebGPU form: WebGPU's constant factors read the color in the color equation; use \
         `constant` with the constant's alpha copied into its R, G and B"
    )]
    ConstantAlpha(String),
}

/// A value, its WebGPU name, its formula, and the other keys that spell it.
type Row<T> = (T, &'static str, &'static str, &'static [&'static str]);

const FACTORS: [Row<F>; 17] = [
    (F::Zero, "zero", "0", &[]),
    (F::One, "one", "1", &[]),
    (F::Src, "src", "S", &["srccolor"]),
    (F::OneMinusSrc, "one-minus-src", "1 - S", &["oneminussrccolor", "invsrccolor"]),
    (F::SrcAlpha, "src-alpha", "S.a", &[]),
    (F::OneMinusSrcAlpha, "one-minus-src-alpha", "1 - S.a", &["invsrcalpha"]),
    (F::Dst, "dst", "D", &["dstcolor", "destcolor"]),
    (F::OneMinusDst, "one-minus-dst", "1 - D", &["oneminusdstcolor", "invdestcolor", "invdstcolor"]),
    (F::DstAlpha, "dst-alpha", "D.a", &["destalpha"]),
    (F::OneMinusDstAlpha, "one-minus-dst-alpha", "1 - D.a", &["invdestalpha", "invdstalpha"]),
    (F::SrcAlphaSaturated, "src-alpha-saturated", "min(S.a, 1 - D.a)", &["srcalphasaturate", "srcalphasat"]),
    (F::Constant, "constant", "K", &["constantcolor", "blendfactor"]),
    (F::OneMinusConstant, "one-minus-constant", "1 - K", &["oneminusconstantcolor", "invblendfactor"]),
    (F::Src1, "src1", "S1", &["src1color", "srccolor2"]),
    (F::OneMinusSrc1, "one-minus-src1", "1 - S1", &["oneminussrc1color", "invsrc1color", "invsrccolor2"]),
    (F::Src1Alpha, "src1-alpha", "S1.a", &[]),
    (F::OneMinusSrc1Alpha, "one-minus-src1-alpha", "1 - S1.a", &["invsrc1alpha"]),
];

const OPERATIONS: [Row<O>; 5] = [
    (O::Add, "add", "S Fs + D Fd", &[]),
    (O::Subtract, "subtract", "S Fs - D Fd", &["sub"]),
    (O::ReverseSubtract, "reverse-subtract", "D Fd - S Fs", &["revsub", "revsubtract"]),
    (O::Min, "min", "min(S, D)", &[]),
    (O::Max, "max", "max(S, D)", &[]),
];

const COMPARISONS: [Row<C>; 8] = [
    (C::Never, "never", "false", &[]),
    (C::Less, "less", "new < stored", &[]),
    (C::Equal, "equal", "new = stored", &[]),
    (C::LessEqual, "less-equal", "new <= stored", &["lequal", "lessorequal"]),
    (C::Greater, "greater", "new > stored", &[]),
    (C::NotEqual, "not-equal", "new != stored", &[]),
    (C::GreaterEqual, "greater-equal", "new >= stored", &["gequal", "greaterorequal"]),
    (C::Always, "always", "true", &[]),
];

/// `INCR` is left out on purpose: GL's clamps and Direct3D's wraps, so it means something only with its prefix.
const STENCIL_OPERATIONS: [Row<S>; 8] = [
    (S::Keep, "keep", "stored", &[]),
    (S::Zero, "zero", "0", &[]),
    (S::Replace, "replace", "reference", &[]),
    (S::Invert, "invert", "~stored", &[]),
    (
        S::IncrementClamp,
        "increment-clamp",
        "min(stored + 1, 255)",
        &["incrsat", "incrementsaturate", "incrementandclamp", "glincr"],
    ),
    (
        S::DecrementClamp,
        "decrement-clamp",
        "max(stored - 1, 0)",
        &["decrsat", "decrementsaturate", "decrementandclamp", "gldecr"],
    ),
    (
        S::IncrementWrap,
        "increment-wrap",
        "(stored + 1) mod 256",
        &["incrwrap", "incrementandwrap", "d3d11stencilopincr", "d3d12stencilopincr", "d3dstencilopincr"],
    ),
    (
        S::DecrementWrap,
        "decrement-wrap",
        "(stored - 1) mod 256",
        &["decrwrap", "decrementandwrap", "d3d11stencilopdecr", "d3d12stencilopdecr", "d3dstencilopdecr"],
    ),
];

/// The prefixes the APIs put before a name; one that begins another comes after it.
const PREFIXES: [&str; 25] = [
    "vkblendfactor",
    "vkblendop",
    "vkcompareop",
    "vkstencilop",
    "blendfactor",
    "blendop",
    "compareop",
    "stencilop",
    "d3d11stencilop",
    "d3d12stencilop",
    "d3dstencilop",
    "d3d11blendop",
    "d3d12blendop",
    "d3d11blend",
    "d3d12blend",
    "d3d11comparison",
    "d3d12comparisonfunc",
    "d3dblendop",
    "d3dblend",
    "d3dcmp",
    "comparisonfunc",
    "comparison",
    "glfunc",
    "func",
    "gl",
];

/// The blend factor a name spells in WebGPU, GL, Vulkan, Direct3D or ShaderLab.
///
/// # Errors
/// [`SpellingError`], with the nearest name and the list.
pub fn blend_factor(name: &str) -> Result<F, SpellingError> {
    // Direct3D 12 calls them ALPHA_FACTOR and INV_ALPHA_FACTOR.
    let constant_alpha =
        ["constantalpha", "oneminusconstantalpha", "invconstantalpha", "alphafactor", "invalphafactor"];
    if constant_alpha.contains(&without_prefix(&key(name))) {
        return Err(SpellingError::ConstantAlpha(name.to_owned()));
    }
    find("blend factor", &FACTORS, name)
}

/// The blend operation a name spells.
///
/// # Errors
/// [`SpellingError`], with the nearest name and the list.
pub fn blend_operation(name: &str) -> Result<O, SpellingError> {
    find("blend operation", &OPERATIONS, name)
}

/// The comparison a name spells.
///
/// # Errors
/// [`SpellingError`], with the nearest name and the list.
pub fn compare_function(name: &str) -> Result<C, SpellingError> {
    find("comparison", &COMPARISONS, name)
}

/// The stencil operation a name spells.
///
/// # Errors
/// [`SpellingError`], with the nearest name and the list.
pub fn stencil_operation(name: &str) -> Result<S, SpellingError> {
    find("stencil operation", &STENCIL_OPERATIONS, name)
}

/// WebGPU's name of a factor.
#[must_use]
pub fn factor_name(factor: F) -> &'static str {
    FACTORS.iter().find(|row| row.0 == factor).map_or("", |row| row.1)
}

/// The formula of a factor: S source, D destination, K constant, S1 second source.
#[must_use]
pub fn factor_formula(factor: F) -> &'static str {
    FACTORS.iter().find(|row| row.0 == factor).map_or("", |row| row.2)
}

/// WebGPU's name of an operation.
#[must_use]
pub fn operation_name(operation: O) -> &'static str {
    OPERATIONS.iter().find(|row| row.0 == operation).map_or("", |row| row.1)
}

/// The formula of an operation: S source, Fs its factor, D destination, Fd its factor.
#[must_use]
pub fn operation_formula(operation: O) -> &'static str {
    OPERATIONS.iter().find(|row| row.0 == operation).map_or("", |row| row.2)
}

/// WebGPU's name of a comparison.
#[must_use]
pub fn comparison_name(compare: C) -> &'static str {
    COMPARISONS.iter().find(|row| row.0 == compare).map_or("", |row| row.1)
}

/// The formula of a comparison between the new value (left) and the stored one.
#[must_use]
pub fn comparison_formula(compare: C) -> &'static str {
    COMPARISONS.iter().find(|row| row.0 == compare).map_or("", |row| row.2)
}

/// WebGPU's name of a stencil operation.
#[must_use]
pub fn stencil_operation_name(operation: S) -> &'static str {
    STENCIL_OPERATIONS.iter().find(|row| row.0 == operation).map_or("", |row| row.1)
}

/// The formula of a stencil operation, on 8 bits.
#[must_use]
pub fn stencil_operation_formula(operation: S) -> &'static str {
    STENCIL_OPERATIONS.iter().find(|row| row.0 == operation).map_or("", |row| row.2)
}

/// All blend factors, in WebGPU's order.
pub fn blend_factors() -> impl Iterator<Item = F> {
    FACTORS.iter().map(|row| row.0)
}

/// All blend operations, in WebGPU's order.
pub fn blend_operations() -> impl Iterator<Item = O> {
    OPERATIONS.iter().map(|row| row.0)
}

/// All comparisons, in WebGPU's order.
pub fn compare_functions() -> impl Iterator<Item = C> {
    COMPARISONS.iter().map(|row| row.0)
}

/// All stencil operations.
pub fn stencil_operations() -> impl Iterator<Item = S> {
    STENCIL_OPERATIONS.iter().map(|row| row.0)
}

/// The name in lower case, without separators and path. Other characters stay, so that they match nothing.
fn key(name: &str) -> String {
    let last = name.rsplit("::").next().unwrap_or(name);
    last.chars().filter(|c| !matches!(c, '-' | '_' | ' ')).map(|c| c.to_ascii_lowercase()).collect()
}

/// A key without an API's prefix.
fn without_prefix(key: &str) -> &str {
    let bare = PREFIXES.iter().find_map(|prefix| key.strip_prefix(prefix)).filter(|rest| !rest.is_empty());
    bare.unwrap_or(key)
}

fn find<T: Copy>(kind: &'static str, rows: &[Row<T>], name: &str) -> Result<T, SpellingError> {
    let whole = key(name);
    let bare = without_prefix(&whole);
    // The whole key first: a few names mean something else without their prefix.
    for wanted in [whole.as_str(), bare] {
        if let Some(row) = rows.iter().find(|row| key(row.1) == wanted || row.3.contains(&wanted)) {
            return Ok(row.0);
        }
    }
    let spellings = rows.iter().flat_map(|row| {
        std::iter::once(key(row.1)).chain(row.3.iter().map(|&s| s.to_owned())).map(move |spelling| (spelling, row.1))
    });
    let nearest = spellings.map(|(spelling, shown)| (distance(&spelling, bare), shown)).min();
    let hint = match nearest {
        // A third of the letters wrong is no misspelling any more.
        Some((steps, near)) if 3 * steps <= bare.chars().count() => format!("; did you mean `{near}`?"),
        _ => String::new(),
    };
    let list = rows.iter().map(|row| row.1).collect::<Vec<_>>().join(", ");
    Err(SpellingError::Unknown { kind, name: name.chars().take(60).collect(), hint, list })
}

/// Levenshtein distance; long inputs are cut, since only near names matter.
pub(super) fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(40).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_api_spells_the_same_factor() {
        for name in [
            "one-minus-src-alpha",
            "OneMinusSrcAlpha",
            "ONE_MINUS_SRC_ALPHA",
            "GL_ONE_MINUS_SRC_ALPHA",
            "VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA",
            "INV_SRC_ALPHA",
            "D3D11_BLEND_INV_SRC_ALPHA",
            "D3D12_BLEND_INV_SRC_ALPHA",
            "D3DBLEND_INVSRCALPHA",
        ] {
            assert_eq!(blend_factor(name), Ok(F::OneMinusSrcAlpha), "{name}");
        }
        for name in
            ["wgpu::BlendFactor::Src1Alpha", "VK_BLEND_FACTOR_SRC1_ALPHA", "GL_SRC1_ALPHA", "BLEND_FACTOR_SRC1_ALPHA"]
        {
            assert_eq!(blend_factor(name), Ok(F::Src1Alpha), "{name}");
        }
        for name in ["D3DBLEND_INVSRCCOLOR2", "D3D11_BLEND_INV_SRC1_COLOR", "GL_ONE_MINUS_SRC1_COLOR"] {
            assert_eq!(blend_factor(name), Ok(F::OneMinusSrc1), "{name}");
        }
        assert_eq!(blend_factor("BLEND_FACTOR"), Ok(F::Constant), "D3D's name of the constant");
        assert_eq!(blend_factor("INV_BLEND_FACTOR"), Ok(F::OneMinusConstant), "D3D's name of its complement");
        assert_eq!(blend_factor("D3D12_BLEND_BLEND_FACTOR"), Ok(F::Constant), "D3D12's");
        assert_eq!(blend_factor("DstColor"), Ok(F::Dst), "ShaderLab's");
        assert_eq!(blend_factor("SrcAlphaSaturate"), Ok(F::SrcAlphaSaturated), "ShaderLab's");
    }

    #[test]
    fn every_name_reads_back() {
        for factor in blend_factors() {
            assert_eq!(blend_factor(factor_name(factor)), Ok(factor), "{factor:?}");
        }
        for operation in blend_operations() {
            assert_eq!(blend_operation(operation_name(operation)), Ok(operation), "{operation:?}");
        }
        for compare in compare_functions() {
            assert_eq!(compare_function(comparison_name(compare)), Ok(compare), "{compare:?}");
        }
        for operation in stencil_operations() {
            assert_eq!(stencil_operation(stencil_operation_name(operation)), Ok(operation), "{operation:?}");
        }
    }

    #[test]
    fn operations_and_comparisons_have_their_synonyms() {
        for name in [
            "RevSub",
            "GL_FUNC_REVERSE_SUBTRACT",
            "FUNC_REVERSE_SUBTRACT",
            "VK_BLEND_OP_REVERSE_SUBTRACT",
            "D3D11_BLEND_OP_REV_SUBTRACT",
            "D3DBLENDOP_REVSUBTRACT",
        ] {
            assert_eq!(blend_operation(name), Ok(O::ReverseSubtract), "{name}");
        }
        for name in [
            "LEqual",
            "GL_LEQUAL",
            "VK_COMPARE_OP_LESS_OR_EQUAL",
            "D3D11_COMPARISON_LESS_EQUAL",
            "D3D12_COMPARISON_FUNC_LESS_EQUAL",
            "D3DCMP_LESSEQUAL",
        ] {
            assert_eq!(compare_function(name), Ok(C::LessEqual), "{name}");
        }
    }

    #[test]
    fn incr_clamps_in_gl_wraps_in_direct3d_and_means_nothing_alone() {
        assert_eq!(stencil_operation("GL_INCR"), Ok(S::IncrementClamp), "GL");
        assert_eq!(stencil_operation("GL_INCR_WRAP"), Ok(S::IncrementWrap), "GL");
        assert_eq!(stencil_operation("VK_STENCIL_OP_INCREMENT_AND_CLAMP"), Ok(S::IncrementClamp), "Vulkan");
        assert_eq!(stencil_operation("D3D11_STENCIL_OP_INCR"), Ok(S::IncrementWrap), "D3D11");
        assert_eq!(stencil_operation("D3D12_STENCIL_OP_DECR_SAT"), Ok(S::DecrementClamp), "D3D12");
        assert!(stencil_operation("INCR").is_err(), "ambiguous");
    }

    #[test]
    fn characters_that_are_no_separator_are_not_overlooked() {
        for name in ["src%alpha", "srcälpha", "one!", "ö", "", "-", "gl", "GL_"] {
            assert!(blend_factor(name).is_err(), "{name}");
        }
    }

    #[test]
    fn an_unknown_name_gets_the_nearest_and_the_list() {
        let message = blend_factor("SrcAlhpa").expect_err("misspelt").to_string();
        assert!(message.contains("did you mean `src-alpha`?"), "{message}");
        assert!(message.contains("one-minus-src1-alpha"), "{message}");
        let message = blend_factor("OneMinusDstColr").expect_err("misspelt").to_string();
        assert!(message.contains("did you mean `one-minus-dst`?"), "synonyms count: {message}");
        let message = blend_factor("nonsense").expect_err("no name").to_string();
        assert!(!message.contains("did you mean"), "nothing is near: {message}");
        for name in ["GL_CONSTANT_ALPHA", "VK_BLEND_FACTOR_ONE_MINUS_CONSTANT_ALPHA", "D3D12_BLEND_ALPHA_FACTOR"] {
            let constant = blend_factor(name).expect_err("not in WebGPU").to_string();
            assert!(constant.contains("no WebGPU form"), "{constant}");
        }
    }
}
