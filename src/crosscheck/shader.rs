//! WGSL that hands arbitrary bits to the output merger.
//!
//! A fragment's record lies in a storage buffer as 32-bit words and reaches the outputs through `bitcast`, so NaN
//! payloads, infinities and denormals pass unchanged. Vertex positions come ready-made from the host.

use std::fmt::Write as _;

/// Entry point of the vertex stage.
pub const VERTEX_ENTRY: &str = "place";

/// Entry point of the fragment stage.
pub const FRAGMENT_ENTRY: &str = "hand_over";

/// Words of the header before the records: the width of the targets, then padding.
pub const HEADER_WORDS: usize = 4;

/// What a fragment shader must write; equal keys share a shader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ShaderKey {
    /// Locations written, bit i = location i.
    pub outputs: u8,
    /// Location 0 has a second source.
    pub dual_source: bool,
    /// The shader writes `frag_depth`.
    pub depth: bool,
    /// Some fragment is discarded.
    pub discard: bool,
}

impl ShaderKey {
    /// The locations written, ascending.
    pub fn locations(self) -> impl Iterator<Item = usize> {
        (0..8).filter(move |location| self.outputs >> location & 1 == 1)
    }

    /// Whether a record ends with a quadruple (depth bits, discard flag, 0, 0).
    #[must_use]
    pub fn has_tail(self) -> bool {
        self.depth || self.discard
    }

    /// Quadruples of words a record takes, at least 1.
    #[must_use]
    pub fn quads(self) -> usize {
        let quads = self.locations().count() + usize::from(self.dual_source) + usize::from(self.has_tail());
        quads.max(1)
    }

    /// Whether the shader returns anything.
    fn returns(self) -> bool {
        self.outputs != 0 || self.depth
    }

    /// The shader's text.
    #[must_use]
    pub fn wgsl(self) -> String {
        let mut fields = String::new();
        let mut body = String::new();
        let mut quad = 0;
        for location in self.locations() {
            let source = if self.dual_source { " @blend_src(0)" } else { "" };
            let _ = writeln!(fields, "    @location({location}){source} color{location}: vec4<f32>,");
            let _ = writeln!(body, "    out.color{location} = bitcast<vec4<f32>>(records.quads[first + {quad}u]);");
            quad += 1;
        }
        if self.dual_source {
            let _ = writeln!(fields, "    @location(0) @blend_src(1) second: vec4<f32>,");
            let _ = writeln!(body, "    out.second = bitcast<vec4<f32>>(records.quads[first + {quad}u]);");
            quad += 1;
        }
        if self.depth {
            let _ = writeln!(fields, "    @builtin(frag_depth) depth: f32,");
            let _ = writeln!(body, "    out.depth = bitcast<f32>(records.quads[first + {quad}u].x);");
        }
        let discard = if self.discard {
            format!("    if records.quads[first + {quad}u].y != 0u {{ discard; }}\n")
        } else {
            String::new()
        };
        let enable = if self.dual_source { "enable dual_source_blending;\n" } else { "" };
        let (outputs, result, declare, give) = if self.returns() {
            (format!("struct Outputs {{\n{fields}}}\n"), " -> Outputs", "    var out: Outputs;\n", "    return out;\n")
        } else {
            (String::new(), "", "", "")
        };
        let quads = self.quads();
        format!(
            "{enable}struct Records {{ header: vec4<u32>, quads: array<vec4<u32>> }}
@group(0) @binding(0) var<storage, read> records: Records;
{outputs}
@vertex fn {VERTEX_ENTRY}(@location(0) position: vec4<f32>) -> @builtin(position) vec4<f32> {{
    return position;
}}
@fragment fn {FRAGMENT_ENTRY}(@builtin(position) at: vec4<f32>){result} {{
    let first = (u32(at.y) * records.header.x + u32(at.x)) * {quads}u;
{discard}{declare}{body}{give}}}
"
        )
    }
}
