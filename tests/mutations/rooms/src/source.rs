//! Places in a file: lines and columns, as cargo-mutants and syn count them, to bytes.

use std::ops::Range;

use syn::spanned::Spanned;

/// A file's text with the starts of its lines.
#[derive(Debug)]
pub struct Source {
    pub text: String,
    lines: Vec<usize>,
}

impl Source {
    pub fn new(text: String) -> Self {
        let ends = text.match_indices('\n').map(|(at, _)| at + 1);
        let lines = std::iter::once(0).chain(ends).collect();
        Self { text, lines }
    }

    /// The byte at a line and a column, both from 1; columns count characters.
    pub fn byte(&self, (line, column): (usize, usize)) -> usize {
        let start = self.lines.get(line - 1).copied().unwrap_or(self.text.len());
        self.text[start..].char_indices().nth(column - 1).map_or(self.text.len(), |(at, _)| start + at)
    }

    /// The bytes of a piece of syntax.
    pub fn range(&self, syntax: &impl Spanned) -> Range<usize> {
        let span = syntax.span();
        let byte = |place: proc_macro2::LineColumn| self.byte((place.line, place.column + 1));
        byte(span.start())..byte(span.end())
    }
}
