//! The block structure: `Shader`, `Properties`, `SubShader`, `Pass`; commands are left to [`super::commands`].

use super::lexer::{Kind, Token, tokens};
use super::property::{Properties, PropertyValue};
use super::{Pass, Position, ShaderLabError};
use crate::state::block::StateBlock;

/// Passes a text may have; a bound for malformed input, far above real shaders.
const MAX_PASSES: usize = 256;

pub(super) fn parse(text: &str, properties: &Properties) -> Result<Vec<Pass>, ShaderLabError> {
    let mut parser = Parser { tokens: tokens(text)?, next: 0, given: properties, defaults: Properties::new() };
    let mut passes = Vec::new();
    let mut state = StateBlock::default();
    if parser.peek_word() == Some("Shader") {
        parser.next += 1;
        parser.text("the shader's name")?;
        parser.mark('{')?;
        parser.body(&mut state, &mut passes, Level::Shader)?;
    } else {
        parser.body(&mut state, &mut passes, Level::Text)?;
    }
    if let Some(token) = parser.tokens.get(parser.next) {
        return Err(error(token.at, "unexpected text after the end"));
    }
    if passes.is_empty() {
        passes.push(Pass { name: None, state });
    }
    Ok(passes)
}

/// What encloses the commands being read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    /// No braces: a bare state block.
    Text,
    Shader,
    SubShader,
    Pass,
}

/// The token stream and the property values.
pub(super) struct Parser<'a> {
    tokens: Vec<Token>,
    next: usize,
    given: &'a Properties,
    defaults: Properties,
}

pub(super) fn error(position: Position, message: impl Into<String>) -> ShaderLabError {
    ShaderLabError { position, message: message.into() }
}

impl Parser<'_> {
    /// Reads items up to the closing brace (or the end, for a bare text). Levels nest in one order, so recursion ends.
    fn body(&mut self, state: &mut StateBlock, passes: &mut Vec<Pass>, level: Level) -> Result<(), ShaderLabError> {
        let start = self.at();
        let mut name = None;
        loop {
            let Some(token) = self.tokens.get(self.next).cloned() else {
                if level == Level::Text {
                    return Ok(());
                }
                return Err(error(start, format!("this {level:?} block is never closed with `}}`")));
            };
            self.next += 1;
            let word = match token.kind {
                Kind::Mark('}') if level != Level::Text => {
                    if level == Level::Pass {
                        if passes.len() == MAX_PASSES {
                            return Err(error(start, format!("more than {MAX_PASSES} passes")));
                        }
                        passes.push(Pass { name, state: state.clone() });
                    }
                    return Ok(());
                }
                Kind::Word(word) => word,
                other => return Err(error(token.at, format!("expected a command, found {}", show(&other)))),
            };
            match (word.as_str(), level) {
                ("Properties", Level::Shader) => self.properties()?,
                ("SubShader" | "Category", Level::Shader | Level::Text) => {
                    self.mark('{')?;
                    self.body(&mut state.clone(), passes, Level::SubShader)?;
                }
                ("Pass", Level::Shader | Level::SubShader | Level::Text) => {
                    self.mark('{')?;
                    self.body(&mut state.clone(), passes, Level::Pass)?;
                }
                ("Name", Level::Pass) => name = Some(self.text("a pass name")?),
                ("Fallback" | "FallBack" | "CustomEditor" | "Dependency" | "UsePass", _) => {
                    while matches!(
                        self.tokens.get(self.next),
                        Some(Token { kind: Kind::Text(_) | Kind::Mark('='), .. })
                    ) {
                        self.next += 1;
                    }
                    if self.peek_word() == Some("Off") {
                        self.next += 1;
                    }
                }
                ("LOD", _) => {
                    self.number("a level of detail")?;
                }
                _ => super::commands::command(self, &word, token.at, state)?,
            }
        }
    }

    /// `Properties { [Attribute] _Name ("Label", Type) = default ... }`: keeps numeric defaults.
    fn properties(&mut self) -> Result<(), ShaderLabError> {
        let start = self.at();
        self.mark('{')?;
        let mut last = None;
        let mut depth = 0_u32;
        loop {
            let Some(token) = self.tokens.get(self.next).cloned() else {
                return Err(error(start, "this Properties block is never closed with `}`"));
            };
            self.next += 1;
            match token.kind {
                Kind::Mark('{') => depth += 1,
                Kind::Mark('}') if depth == 0 => return Ok(()),
                Kind::Mark('}') => depth -= 1,
                Kind::Word(word) if word.starts_with('_') => last = Some(word),
                Kind::Mark('=') => {
                    let value = self.tokens.get(self.next).and_then(|token| match &token.kind {
                        Kind::Word(word) => word.parse().ok().filter(|x: &f64| x.is_finite()),
                        _ => None,
                    });
                    if let (Some(name), Some(value)) = (last.take(), value) {
                        self.defaults.insert(name, PropertyValue::Number(value));
                    }
                }
                _ => {}
            }
        }
    }

    /// Where the next token is, or the last one at the end.
    pub(super) fn at(&self) -> Position {
        let token = self.tokens.get(self.next).or_else(|| self.tokens.last());
        token.map_or(Position { line: 1, column: 1 }, |token| token.at)
    }

    /// The next token if it is a word.
    pub(super) fn peek_word(&self) -> Option<&str> {
        match &self.tokens.get(self.next)?.kind {
            Kind::Word(word) => Some(word),
            _ => None,
        }
    }

    /// Takes the next token if it is this mark.
    pub(super) fn accept(&mut self, mark: char) -> bool {
        let found = self.tokens.get(self.next).is_some_and(|token| token.kind == Kind::Mark(mark));
        self.next += usize::from(found);
        found
    }

    /// Skips a word.
    pub(super) fn skip(&mut self) {
        self.next += 1;
    }

    pub(super) fn mark(&mut self, mark: char) -> Result<(), ShaderLabError> {
        let at = self.at();
        if self.accept(mark) { Ok(()) } else { Err(error(at, format!("expected `{mark}`"))) }
    }

    pub(super) fn text(&mut self, what: &str) -> Result<String, ShaderLabError> {
        let at = self.at();
        let found = match self.tokens.get(self.next) {
            Some(Token { kind: Kind::Text(text), .. }) => Some(text.clone()),
            _ => None,
        };
        self.next += usize::from(found.is_some());
        found.ok_or_else(|| error(at, format!("expected {what} in quotes")))
    }

    /// A word, or a property's value as a name; numbers index `names`.
    pub(super) fn name(&mut self, what: &str, names: &[&str]) -> Result<(String, Position), ShaderLabError> {
        let at = self.at();
        let kind = self.tokens.get(self.next).map(|token| token.kind.clone());
        self.next += 1;
        match kind {
            Some(Kind::Word(word)) => Ok((word, at)),
            Some(Kind::Property(property)) => match self.value(&property, at)? {
                PropertyValue::Name(name) => Ok((name, at)),
                PropertyValue::Number(number) => {
                    let found = names.iter().enumerate().find(|(i, _)| index_is(*i, number));
                    let last = names.len().saturating_sub(1);
                    found.map(|(_, name)| ((*name).to_owned(), at)).ok_or_else(|| {
                        error(
                            at,
                            format!("`[{property}]` is {number}; {what} by number is a whole number from 0 to {last}"),
                        )
                    })
                }
            },
            other => {
                let found = other.map_or("the end".to_owned(), |kind| show(&kind));
                Err(error(at, format!("expected {what} or a [_Property], found {found}")))
            }
        }
    }

    /// A finite number, written or from a property.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, ShaderLabError> {
        let at = self.at();
        let kind = self.tokens.get(self.next).map(|token| token.kind.clone());
        self.next += 1;
        let number = match kind {
            Some(Kind::Word(word)) => word.parse().ok(),
            Some(Kind::Property(property)) => match self.value(&property, at)? {
                PropertyValue::Number(number) => Some(number),
                PropertyValue::Name(name) => name.parse().ok(),
            },
            _ => None,
        };
        number.filter(|x: &f64| x.is_finite()).ok_or_else(|| error(at, format!("expected {what}, a finite number")))
    }

    fn value(&self, property: &str, at: Position) -> Result<PropertyValue, ShaderLabError> {
        let value = self.given.get(property).or_else(|| self.defaults.get(property));
        value.cloned().ok_or_else(|| {
            error(at, format!("property `[{property}]` has no value; supply one, e.g. `--set {property}=1`"))
        })
    }
}

/// Whether a property's number is this index.
fn index_is(i: usize, number: f64) -> bool {
    u32::try_from(i).is_ok_and(|i| f64::from(i) == number)
}

/// A token as people read it.
fn show(kind: &Kind) -> String {
    match kind {
        Kind::Word(word) => format!("`{word}`"),
        Kind::Text(text) => format!("\"{text}\""),
        Kind::Property(name) => format!("`[{name}]`"),
        Kind::Mark(mark) => format!("`{mark}`"),
    }
}
