//! Words, strings, property references and punctuation, with their places.

use super::{Position, ShaderLabError};

/// A token's content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A command, name or number.
    Word(String),
    /// A quoted string, without quotes.
    Text(String),
    /// `[_Property]`, without brackets.
    Property(String),
    /// `{ } ( ) , =`.
    Mark(char),
}

/// A token and where it starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    pub at: Position,
}

/// Shader programs: what opens one, and what closes it.
const PROGRAMS: [(&str, &str); 5] = [
    ("HLSLPROGRAM", "ENDHLSL"),
    ("HLSLINCLUDE", "ENDHLSL"),
    ("CGPROGRAM", "ENDCG"),
    ("CGINCLUDE", "ENDCG"),
    ("GLSLPROGRAM", "ENDGLSL"),
];

/// Splits a text into tokens, and tells where it ends; comments and shader programs are left out.
pub(super) fn tokens(text: &str) -> Result<(Vec<Token>, Position), ShaderLabError> {
    // Unity's own shader files begin with a byte-order mark now and then.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut cursor = Cursor { rest: text, at: Position { line: 1, column: 1 } };
    let mut out = Vec::new();
    while let Some(c) = cursor.peek() {
        let at = cursor.at;
        let error = |message: &str| ShaderLabError { position: at, message: message.to_owned() };
        match c {
            _ if c.is_whitespace() => cursor.skip(1),
            '/' if cursor.rest.starts_with("//") => {
                cursor.take_while(|c| c != '\n');
            }
            '/' if cursor.rest.starts_with("/*") => {
                cursor.skip_past("*/").ok_or_else(|| error("this comment is never closed with `*/`"))?;
            }
            '"' => {
                cursor.skip(1);
                let content = cursor.take_while(|c| c != '"' && c != '\n').to_owned();
                if cursor.peek() != Some('"') {
                    return Err(error("this string is never closed with `\"`"));
                }
                cursor.skip(1);
                out.push(Token { kind: Kind::Text(content), at });
            }
            '[' => {
                cursor.skip(1);
                let name = cursor.take_while(|c| c != ']' && c != '\n').trim().to_owned();
                if cursor.peek() != Some(']') {
                    return Err(error("this property reference is never closed with `]`"));
                }
                cursor.skip(1);
                out.push(Token { kind: Kind::Property(name), at });
            }
            '{' | '}' | '(' | ')' | ',' | '=' => {
                cursor.skip(1);
                out.push(Token { kind: Kind::Mark(c), at });
            }
            _ if is_word(c) => {
                let word = cursor.take_while(is_word).to_owned();
                match PROGRAMS.iter().find(|(open, _)| *open == word) {
                    Some((open, close)) => cursor
                        .skip_past(close)
                        .ok_or_else(|| error(&format!("this {open} is never closed with {close}")))?,
                    None => out.push(Token { kind: Kind::Word(word), at }),
                }
            }
            _ => return Err(error(&format!("unexpected character `{}`", c.escape_default()))),
        }
    }
    Ok((out, cursor.at))
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+')
}

struct Cursor<'a> {
    rest: &'a str,
    at: Position,
}

impl<'a> Cursor<'a> {
    fn peek(&self) -> Option<char> {
        self.rest.chars().next()
    }

    /// Moves over `bytes` bytes of the rest.
    fn advance(&mut self, bytes: usize) -> &'a str {
        let (passed, rest) = self.rest.split_at(bytes);
        for c in passed.chars() {
            if c == '\n' {
                self.at = Position { line: self.at.line.saturating_add(1), column: 1 };
            } else {
                self.at.column = self.at.column.saturating_add(1);
            }
        }
        self.rest = rest;
        passed
    }

    fn skip(&mut self, characters: usize) {
        let bytes = self.rest.chars().take(characters).map(char::len_utf8).sum();
        self.advance(bytes);
    }

    fn take_while(&mut self, wanted: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !wanted(c)).unwrap_or(self.rest.len());
        self.advance(end)
    }

    fn skip_past(&mut self, end: &str) -> Option<()> {
        let at = self.rest.find(end)?;
        self.advance(at + end.len());
        Some(())
    }
}
