//! Names of blend factors, operations and comparisons as the graphics APIs spell them.
//!
//! A name is compared without case, separators and its API's prefix, so `one-minus-src-alpha`, `OneMinusSrcAlpha`,
//! `GL_ONE_MINUS_SRC_ALPHA`, `VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA` and `D3D12_BLEND_INV_SRC_ALPHA` are one factor.

use wgpu_types::{BlendFactor as F, BlendOperation as O, CompareFunction as C};

/// A name that spells nothing of its kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpellingError {
    /// No such name.
    #[error("unknown {kind} `{name}`{hint}; use one of: {list}")]
    Unknown {
        /// What was asked for: `blend factor`, `blend operation`, `comparison`.
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
    (F::Constant, "constant", "K", &["constantcolor", "blendfactor", "blendcolor"]),
    (F::OneMinusConstant, "one-minus-constant", "1 - K", &["oneminusconstantcolor", "invblendfactor"]),
    (F::Src1, "src1", "S1", &["src1color"]),
    (F::OneMinusSrc1, "one-minus-src1", "1 - S1", &["oneminussrc1color", "invsrc1color"]),
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

/// The prefixes the APIs put before a name.
const PREFIXES: [&str; 14] = [
    "vkblendfactor",
    "vkblendop",
    "vkcompareop",
    "d3d11blendop",
    "d3d12blendop",
    "d3d11blend",
    "d3d12blend",
    "d3d11comparison",
    "d3d12comparisonfunc",
    "d3dblendop",
    "d3dblend",
    "d3dcmp",
    "glfunc",
    "gl",
];

/// The blend factor a name spells in WebGPU, GL, Vulkan, Direct3D or ShaderLab.
///
/// # Errors
/// [`SpellingError`], with the nearest name and the list.
pub fn blend_factor(name: &str) -> Result<F, SpellingError> {
    if matches!(key(name).as_str(), "constantalpha" | "oneminusconstantalpha" | "invconstantalpha") {
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

/// WebGPU's name of a comparison.
#[must_use]
pub fn comparison_name(compare: C) -> &'static str {
    COMPARISONS.iter().find(|row| row.0 == compare).map_or("", |row| row.1)
}

/// All blend factors, in WebGPU's order.
pub fn blend_factors() -> impl Iterator<Item = F> {
    FACTORS.iter().map(|row| row.0)
}

/// All blend operations, in WebGPU's order.
pub fn blend_operations() -> impl Iterator<Item = O> {
    OPERATIONS.iter().map(|row| row.0)
}

/// Letters and digits in lower case, without an API's prefix.
fn key(name: &str) -> String {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect();
    let bare = PREFIXES.iter().find_map(|prefix| plain.strip_prefix(prefix)).filter(|rest| !rest.is_empty());
    bare.map_or_else(|| plain.clone(), str::to_owned)
}

fn find<T: Copy>(kind: &'static str, rows: &[Row<T>], name: &str) -> Result<T, SpellingError> {
    let wanted = key(name);
    let spelled = |row: &&Row<T>| key(row.1) == wanted || row.3.contains(&wanted.as_str());
    if let Some(row) = rows.iter().find(spelled) {
        return Ok(row.0);
    }
    let nearest = rows.iter().map(|row| (distance(&key(row.1), &wanted), row.1)).min();
    let hint = match nearest {
        Some((steps, near)) if steps <= 3 => format!("; did you mean `{near}`?"),
        _ => String::new(),
    };
    let list = rows.iter().map(|row| row.1).collect::<Vec<_>>().join(", ");
    Err(SpellingError::Unknown { kind, name: name.chars().take(60).collect(), hint, list })
}

/// Levenshtein distance; long inputs are cut, since only near names matter.
fn distance(a: &str, b: &str) -> usize {
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
        assert_eq!(blend_factor("BLEND_FACTOR"), Ok(F::Constant), "D3D's name of the constant");
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
        for row in COMPARISONS {
            assert_eq!(compare_function(comparison_name(row.0)), Ok(row.0), "{:?}", row.0);
        }
    }

    #[test]
    fn operations_and_comparisons_have_their_synonyms() {
        for name in
            ["RevSub", "GL_FUNC_REVERSE_SUBTRACT", "VK_BLEND_OP_REVERSE_SUBTRACT", "D3D11_BLEND_OP_REV_SUBTRACT"]
        {
            assert_eq!(blend_operation(name), Ok(O::ReverseSubtract), "{name}");
        }
        for name in ["LEqual", "GL_LEQUAL", "VK_COMPARE_OP_LESS_OR_EQUAL", "D3D11_COMPARISON_LESS_EQUAL"] {
            assert_eq!(compare_function(name), Ok(C::LessEqual), "{name}");
        }
    }

    #[test]
    fn an_unknown_name_gets_the_nearest_and_the_list() {
        let message = blend_factor("SrcAlhpa").expect_err("misspelt").to_string();
        assert!(message.contains("did you mean `src-alpha`?"), "{message}");
        assert!(message.contains("one-minus-src1-alpha"), "{message}");
        let constant = blend_factor("GL_CONSTANT_ALPHA").expect_err("not in WebGPU").to_string();
        assert!(constant.contains("no WebGPU form"), "{constant}");
    }
}
