//! Where things stand in a scene file: the text as a tree of spans, for messages.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::error::{FieldPath, Segment};

/// A value of the text with its place; TOML and JSON alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Node {
    span: Range<usize>,
    children: Vec<(Segment, Range<usize>, Node)>,
}

impl Node {
    /// The tree of a TOML document.
    pub(super) fn from_toml(table: &DeTable<'_>, span: Range<usize>) -> Self {
        let child = |(key, value): (&toml::Spanned<toml::de::DeString<'_>>, &toml::Spanned<DeValue<'_>>)| {
            (Segment::Key(key.get_ref().to_string()), key.span(), Self::from_value(value))
        };
        Self { span, children: table.iter().map(child).collect() }
    }

    fn from_value(value: &toml::Spanned<DeValue<'_>>) -> Self {
        match value.get_ref() {
            DeValue::Table(table) => Self::from_toml(table, value.span()),
            DeValue::Array(array) => {
                let child = |(i, value): (usize, &toml::Spanned<DeValue<'_>>)| {
                    (Segment::Index(i), value.span(), Self::from_value(value))
                };
                Self { span: value.span(), children: array.iter().enumerate().map(child).collect() }
            }
            _ => Self { span: value.span(), children: Vec::new() },
        }
    }

    /// The tree of a JSON text that is known to be well-formed.
    #[cfg(feature = "json")]
    pub(super) fn from_json(text: &str) -> Self {
        Json { text: text.as_bytes(), at: 0 }.value()
    }

    /// Byte at which the field stands; a missing one stands where its table does.
    pub(super) fn offset(&self, path: &FieldPath) -> usize {
        let (mut node, mut offset) = (self, self.span.start);
        for segment in &path.0 {
            let Some((_, key, child)) = node.children.iter().find(|(name, ..)| name == segment) else { break };
            (node, offset) = (child, key.start);
        }
        offset
    }

    /// The field with the smallest span around a byte, key included.
    pub(super) fn field_at(&self, offset: usize) -> FieldPath {
        let mut best = (usize::MAX, FieldPath::default());
        self.visit(&FieldPath::default(), &mut |path, span| {
            if (span.contains(&offset) || span.start == offset) && span.len() < best.0 {
                best = (span.len(), path.clone());
            }
        });
        best.1
    }

    fn visit(&self, path: &FieldPath, found: &mut impl FnMut(&FieldPath, &Range<usize>)) {
        for (segment, key, child) in &self.children {
            let path = match segment {
                Segment::Key(key) => path.key(key),
                Segment::Index(index) => path.index(*index),
            };
            found(&path, key);
            found(&path, &child.span);
            child.visit(&path, found);
        }
    }
}

/// Line of a byte, from 1.
pub(super) fn line(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// A walk over well-formed JSON that keeps nothing but places.
#[cfg(feature = "json")]
struct Json<'a> {
    text: &'a [u8],
    at: usize,
}

#[cfg(feature = "json")]
impl Json<'_> {
    fn value(&mut self) -> Node {
        self.skip(|byte| byte.is_ascii_whitespace());
        let start = self.at;
        let mut children = Vec::new();
        match self.peek() {
            b'{' => self.members(b'}', |json, _| {
                let (start, name) = (json.at, json.string());
                json.skip(|byte| byte.is_ascii_whitespace() || byte == b':');
                children.push((Segment::Key(name), start..json.at, json.value()));
            }),
            b'[' => self.members(b']', |json, i| {
                let start = json.at;
                let value = json.value();
                children.push((Segment::Index(i), start..json.at, value));
            }),
            b'"' => {
                self.string();
            }
            _ => self.skip(|byte| !matches!(byte, b',' | b']' | b'}') && !byte.is_ascii_whitespace()),
        }
        Node { span: start..self.at, children }
    }

    fn members(&mut self, end: u8, mut member: impl FnMut(&mut Self, usize)) {
        self.at += 1;
        for i in 0.. {
            self.skip(|byte| byte.is_ascii_whitespace() || byte == b',');
            if self.peek() == end || self.at >= self.text.len() {
                break;
            }
            member(self, i);
        }
        self.at += 1;
    }

    /// Steps over a string and gives its raw text, which for the field names of a scene is the name.
    fn string(&mut self) -> String {
        let start = self.at + 1;
        self.at = start;
        while self.at < self.text.len() && self.peek() != b'"' {
            self.at += if self.peek() == b'\\' { 2 } else { 1 };
        }
        let end = self.at.min(self.text.len());
        self.at = end + 1;
        String::from_utf8_lossy(&self.text[start.min(end)..end]).into_owned()
    }

    fn skip(&mut self, skipped: impl Fn(u8) -> bool) {
        while self.at < self.text.len() && skipped(self.peek()) {
            self.at += 1;
        }
    }

    /// The byte ahead; 0 at the end.
    fn peek(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }
}
