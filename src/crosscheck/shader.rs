//! WGSL that hands arbitrary bits to the output merger.
//!
//! A fragment's values reach the outputs through `bitcast` from 32-bit words, so NaN payloads, infinities and denormals
//! pass unchanged. The words are records in a storage buffer ([`RecordShader`]) or computed from the texel's number
//! ([`super::program`]). Vertex positions come ready-made from the host.
//!
//! Every shader has one binding, a storage buffer that begins with a header of [`HEADER_WORDS`] words: the width of the
//! targets, the number of the first texel, and two unused.

use std::fmt::Write as _;

use super::program::Program;

/// Entry point of the vertex stage.
pub const VERTEX_ENTRY: &str = "place";

/// Entry point of the fragment stage.
pub const FRAGMENT_ENTRY: &str = "hand_over";

/// Words before the records or the table.
pub const HEADER_WORDS: usize = 4;

/// What a fragment shader writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Written {
    /// Locations, bit i = location i.
    pub outputs: u8,
    /// Location 0 has a second source.
    pub dual_source: bool,
    /// `frag_depth`.
    pub depth: bool,
    /// Some fragment is discarded.
    pub discard: bool,
}

/// What a record holds, in this order; each part is a quadruple of words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct RecordLayout {
    /// Output colors, bit i = location i, ascending.
    pub outputs: u8,
    /// The second source.
    pub second_source: bool,
    /// Depth bits, discard flag, 0, 0.
    pub tail: bool,
}

/// A shader that reads records; what it writes must be in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct RecordShader {
    /// What it writes.
    pub written: Written,
    /// What it reads.
    pub layout: RecordLayout,
}

/// What distinguishes two shader modules.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Shader {
    /// Values from records.
    Records(RecordShader),
    /// Values from the texel's number.
    Program(Written, Program),
}

impl Written {
    /// The locations written, ascending.
    pub fn locations(self) -> impl Iterator<Item = usize> {
        locations(self.outputs)
    }
}

impl RecordLayout {
    /// The smallest layout that holds what is written.
    #[must_use]
    pub fn of(written: Written) -> Self {
        Self { outputs: written.outputs, second_source: written.dual_source, tail: written.depth || written.discard }
    }

    /// The locations held, ascending.
    pub fn locations(self) -> impl Iterator<Item = usize> {
        locations(self.outputs)
    }

    /// Quadruples of words a record takes, at least 1.
    #[must_use]
    pub fn quads(self) -> usize {
        (self.tail_quad() + usize::from(self.tail)).max(1)
    }

    /// Where an output lies.
    fn quad(self, location: usize) -> usize {
        self.locations().take_while(|held| *held < location).count()
    }

    fn second_source_quad(self) -> usize {
        self.locations().count()
    }

    fn tail_quad(self) -> usize {
        self.second_source_quad() + usize::from(self.second_source)
    }
}

/// The set bits of a location mask.
fn locations(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).filter(move |location| mask >> location & 1 == 1)
}

/// The expressions a shader's frame is filled with.
#[derive(Debug, Default)]
pub(super) struct Expressions {
    /// Further declarations.
    pub declarations: String,
    /// Statements before any output; `index` is the texel's number.
    pub prelude: String,
    /// Each written location's `vec4<f32>`, in ascending order.
    pub colors: Vec<String>,
    /// The second source's `vec4<f32>`.
    pub second_source: String,
    /// The depth's `f32`.
    pub depth: String,
    /// The discard condition.
    pub discard: String,
}

impl Shader {
    /// What the shader writes.
    #[must_use]
    pub fn written(&self) -> Written {
        match self {
            Self::Records(shader) => shader.written,
            Self::Program(written, _) => *written,
        }
    }

    /// The shader's text.
    #[must_use]
    pub fn wgsl(&self) -> String {
        match self {
            Self::Records(shader) => frame(shader.written, &shader.expressions()),
            Self::Program(written, program) => frame(*written, &program.expressions(*written)),
        }
    }
}

impl RecordShader {
    fn expressions(self) -> Expressions {
        let layout = self.layout;
        let quad = |quad: usize| format!("records.quads[first + {quad}u]");
        let vector = |at: usize| format!("bitcast<vec4<f32>>({})", quad(at));
        Expressions {
            declarations: "struct Records { header: vec4<u32>, quads: array<vec4<u32>> }
@group(0) @binding(0) var<storage, read> records: Records;\n"
                .to_owned(),
            prelude: format!("    let first = (index - records.header.y) * {}u;\n", layout.quads()),
            colors: self.written.locations().map(|location| vector(layout.quad(location))).collect(),
            second_source: vector(layout.second_source_quad()),
            depth: format!("bitcast<f32>({}.x)", quad(layout.tail_quad())),
            discard: format!("{}.y != 0u", quad(layout.tail_quad())),
        }
    }
}

/// Entry points around the expressions of what is written.
fn frame(written: Written, expressions: &Expressions) -> String {
    let mut fields = String::new();
    let mut body = String::new();
    for (location, color) in written.locations().zip(&expressions.colors) {
        let source = if written.dual_source { " @blend_src(0)" } else { "" };
        let _ = writeln!(fields, "    @location({location}){source} color{location}: vec4<f32>,");
        let _ = writeln!(body, "    out.color{location} = {color};");
    }
    if written.dual_source {
        let _ = writeln!(fields, "    @location(0) @blend_src(1) second: vec4<f32>,");
        let _ = writeln!(body, "    out.second = {};", expressions.second_source);
    }
    if written.depth {
        let _ = writeln!(fields, "    @builtin(frag_depth) depth: f32,");
        let _ = writeln!(body, "    out.depth = {};", expressions.depth);
    }
    let enable = if written.dual_source { "enable dual_source_blending;\n" } else { "" };
    let (outputs, result, declare, give) = if fields.is_empty() {
        (String::new(), "", "", "")
    } else {
        (format!("struct Outputs {{\n{fields}}}\n"), " -> Outputs", "    var out: Outputs;\n", "    return out;\n")
    };
    let discard =
        if written.discard { format!("    if {} {{ discard; }}\n", expressions.discard) } else { String::new() };
    let (declarations, prelude) = (&expressions.declarations, &expressions.prelude);
    format!(
        "{enable}{declarations}{outputs}
@vertex fn {VERTEX_ENTRY}(@location(0) position: vec4<f32>) -> @builtin(position) vec4<f32> {{
    return position;
}}
@fragment fn {FRAGMENT_ENTRY}(@builtin(position) at: vec4<f32>){result} {{
    let index = records.header.y + u32(at.y) * records.header.x + u32(at.x);
{prelude}{discard}{declare}{body}{give}}}
"
    )
}
