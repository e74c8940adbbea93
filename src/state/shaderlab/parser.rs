//! The block structure: `Shader`, `Category`, `SubShader`, `Pass`; commands are left to [`super::commands`].

use super::draft::Draft;
use super::lexer::{Kind, Token, tokens};
use super::property::{Properties, PropertyValue, property_block};
use super::{Pass, Position, ShaderLabError};

/// Passes a text may have; a bound for malformed input, far above real shaders.
const MAX_PASSES: usize = 256;
/// `Category` blocks inside each other; a bound for malformed input.
const MAX_NESTING: usize = 16;

type Result<T> = std::result::Result<T, ShaderLabError>;

pub(super) fn parse(text: &str, properties: &Properties) -> Result<Vec<Pass>> {
    let (tokens, end) = tokens(text)?;
    let mut parser = Parser { tokens, next: 0, end, given: properties, defaults: Properties::new() };
    let mut found = Found::default();
    let mut draft = Draft::default();
    let start = parser.at();
    if parser.accept_word("Shader") {
        parser.text("the shader's name")?;
        parser.mark('{')?;
        parser.body(&mut draft, &mut found, Block { level: Level::Shader, opened: start, depth: 0 })?;
        if found.passes.is_empty() {
            return Err(error(start, "this shader has no SubShader, so there is nothing to draw with"));
        }
    } else {
        parser.body(&mut draft, &mut found, Block { level: Level::Text, opened: start, depth: 0 })?;
    }
    if let Some(token) = parser.tokens.get(parser.next) {
        return Err(error(token.at, format!("unexpected {} after the end", show(&token.kind))));
    }
    if found.passes.is_empty() {
        found.passes.push(Pass { name: None, sub_shader: 0, state: draft.finish() });
    }
    Ok(found.passes)
}

/// The passes read so far.
#[derive(Default)]
struct Found {
    passes: Vec<Pass>,
    sub_shaders: usize,
}

/// What encloses the commands being read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    /// No braces: a bare state block.
    Text,
    Shader,
    Category,
    SubShader,
    Pass,
}

/// An open block.
#[derive(Clone, Copy, Debug)]
struct Block {
    level: Level,
    opened: Position,
    depth: usize,
}

/// The token stream and the property values.
pub(super) struct Parser<'a> {
    tokens: Vec<Token>,
    next: usize,
    end: Position,
    given: &'a Properties,
    defaults: Properties,
}

pub(super) fn error(position: Position, message: impl Into<String>) -> ShaderLabError {
    ShaderLabError { position, message: message.into() }
}

impl Parser<'_> {
    /// Reads items up to the closing brace (or the end, for a bare text). Nesting is bounded, so recursion is.
    fn body(&mut self, draft: &mut Draft, found: &mut Found, block: Block) -> Result<()> {
        let mut name = None;
        let first = found.passes.len();
        loop {
            let Some(token) = self.take() else {
                if block.level == Level::Text {
                    return Ok(());
                }
                return Err(error(block.opened, format!("this {:?} block is never closed with `}}`", block.level)));
            };
            let word = match token.kind {
                Kind::Mark('}') if block.level != Level::Text => {
                    return Self::close(draft, found, block, name, first);
                }
                Kind::Word(word) => word,
                other => return Err(error(token.at, format!("expected a command, found {}", show(&other)))),
            };
            self.item(&word, token.at, draft, found, block, &mut name)?;
        }
    }

    /// One command or inner block.
    fn item(
        &mut self,
        word: &str,
        at: Position,
        draft: &mut Draft,
        found: &mut Found,
        block: Block,
        name: &mut Option<String>,
    ) -> Result<()> {
        use Level::{Category, Pass, Shader, SubShader, Text};
        let outer = matches!(block.level, Shader | Category | Text);
        let inner = match word.to_ascii_lowercase().as_str() {
            "properties" if matches!(block.level, Shader | Text) => {
                let defaults = property_block(self, at)?;
                self.defaults.extend(defaults);
                return Ok(());
            }
            "category" if outer => Category,
            "subshader" if outer => SubShader,
            "pass" if outer || block.level == SubShader => Pass,
            "name" if block.level == Pass => {
                *name = Some(self.text("a pass name")?);
                return Ok(());
            }
            "fallback" | "customeditor" | "customeditorforrenderpipeline" | "dependency" => {
                self.skip_remark();
                return Ok(());
            }
            "lod" => return self.number("a level of detail").map(|_| ()),
            "grabpass" | "packagerequirements" => return self.skip_block(at),
            "usepass" => {
                return Err(error(at, "UsePass takes a pass from another shader; put that pass here instead"));
            }
            _ => return super::commands::command(self, word, at, draft),
        };
        self.mark('{')?;
        if block.depth == MAX_NESTING {
            return Err(error(at, format!("more than {MAX_NESTING} blocks inside each other")));
        }
        self.body(&mut draft.clone(), found, Block { level: inner, opened: at, depth: block.depth + 1 })
    }

    /// Ends a block whose passes are those from `first` on.
    fn close(draft: &Draft, found: &mut Found, block: Block, name: Option<String>, first: usize) -> Result<()> {
        let sub_shader = found.sub_shaders;
        match block.level {
            // A sub-shader without passes is a surface shader: Unity writes its passes, with this state.
            Level::SubShader if found.passes.len() == first => {
                found.passes.push(Pass { name: None, sub_shader, state: draft.finish() });
            }
            // Tags of a sub-shader are its passes', also when they follow them.
            Level::SubShader => {
                for pass in &mut found.passes[first..] {
                    for (key, value) in &draft.block.tags {
                        if pass.state.tag(key).is_none() {
                            pass.state.tags.push((key.clone(), value.clone()));
                        }
                    }
                }
            }
            Level::Pass => found.passes.push(Pass { name, sub_shader, state: draft.finish() }),
            Level::Text | Level::Shader | Level::Category => {}
        }
        found.sub_shaders += usize::from(block.level == Level::SubShader);
        if found.passes.len() > MAX_PASSES {
            return Err(error(block.opened, format!("more than {MAX_PASSES} passes")));
        }
        Ok(())
    }

    /// Strings after a command that says nothing about the state, or `Off`.
    fn skip_remark(&mut self) {
        while matches!(self.peek(), Some(Kind::Text(_) | Kind::Mark('='))) {
            self.next += 1;
        }
        self.accept_word("Off");
    }

    /// A block in braces that says nothing about the state.
    pub(super) fn skip_block(&mut self, opened: Position) -> Result<()> {
        self.mark('{')?;
        let mut depth = 1_usize;
        while depth > 0 {
            match self.take().map(|token| token.kind) {
                None => return Err(error(opened, "this block is never closed with `}`")),
                Some(Kind::Mark('{')) => depth += 1,
                Some(Kind::Mark('}')) => depth -= 1,
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// Where the next token is, or the end of the text.
    pub(super) fn at(&self) -> Position {
        self.tokens.get(self.next).map_or(self.end, |token| token.at)
    }

    /// The next token's content.
    pub(super) fn peek(&self) -> Option<&Kind> {
        self.tokens.get(self.next).map(|token| &token.kind)
    }

    /// The next token, passed over.
    pub(super) fn take(&mut self) -> Option<Token> {
        let token = self.tokens.get(self.next).cloned();
        self.next += usize::from(token.is_some());
        token
    }

    /// The next token if it is a word.
    pub(super) fn peek_word(&self) -> Option<&str> {
        match self.peek()? {
            Kind::Word(word) => Some(word),
            _ => None,
        }
    }

    /// Takes the next token if it is this mark.
    pub(super) fn accept(&mut self, mark: char) -> bool {
        let found = self.peek() == Some(&Kind::Mark(mark));
        self.next += usize::from(found);
        found
    }

    /// Takes the next token if it is this word, in any case.
    pub(super) fn accept_word(&mut self, word: &str) -> bool {
        let found = self.peek_word().is_some_and(|next| next.eq_ignore_ascii_case(word));
        self.next += usize::from(found);
        found
    }

    pub(super) fn mark(&mut self, mark: char) -> Result<()> {
        let at = self.at();
        if self.accept(mark) { Ok(()) } else { Err(error(at, format!("expected `{mark}`, found {}", self.shown()))) }
    }

    pub(super) fn text(&mut self, what: &str) -> Result<String> {
        match self.peek() {
            Some(Kind::Text(text)) => {
                let text = text.clone();
                self.next += 1;
                Ok(text)
            }
            _ => Err(error(self.at(), format!("expected {what} in quotes, found {}", self.shown()))),
        }
    }

    /// A word, or a property's value as a name; numbers index `names`.
    pub(super) fn name(&mut self, what: &str, names: &[&str]) -> Result<(String, Position)> {
        let at = self.at();
        let found = match self.peek() {
            Some(Kind::Word(word)) => word.clone(),
            Some(Kind::Property(property)) => match self.value(property, at)? {
                PropertyValue::Name(name) => name,
                PropertyValue::Number(number) => {
                    let found = names.iter().enumerate().find(|(i, _)| index_is(*i, number));
                    let last = names.len().saturating_sub(1);
                    let wrong =
                        || format!("`[{property}]` is {number}; {what} by number is a whole number from 0 to {last}");
                    found.map(|(_, name)| (*name).to_owned()).ok_or_else(|| error(at, wrong()))?
                }
            },
            _ => return Err(error(at, format!("expected {what} or a [_Property], found {}", self.shown()))),
        };
        self.next += 1;
        Ok((found, at))
    }

    /// A finite number, written or from a property.
    pub(super) fn number(&mut self, what: &str) -> Result<f64> {
        let at = self.at();
        let number = match self.peek() {
            Some(Kind::Word(word)) => word.parse().ok(),
            Some(Kind::Property(property)) => match self.value(property, at)? {
                PropertyValue::Number(number) => Some(number),
                PropertyValue::Name(name) => name.parse().ok(),
            },
            _ => None,
        };
        let number = number.filter(|x: &f64| x.is_finite());
        let number =
            number.ok_or_else(|| error(at, format!("expected {what}, a finite number; found {}", self.shown())))?;
        self.next += 1;
        Ok(number)
    }

    /// A number that is finite as an `f32` too.
    pub(super) fn number_f32(&mut self, what: &str) -> Result<f32> {
        let at = self.at();
        let number = f64_to_f32(self.number(what)?);
        if number.is_finite() {
            Ok(number)
        } else {
            Err(error(at, format!("{what} is beyond the range of 32-bit floats")))
        }
    }

    fn value(&self, property: &str, at: Position) -> Result<PropertyValue> {
        let value = self.given.get(property).or_else(|| self.defaults.get(property));
        value.cloned().ok_or_else(|| {
            error(
                at,
                format!("property `[{property}]` has no value: supply one, or give it a number in a Properties block"),
            )
        })
    }

    /// The next token as people read it.
    fn shown(&self) -> String {
        self.peek().map_or_else(|| "the end".to_owned(), show)
    }
}

/// The nearest `f32`; infinite beyond its range.
#[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest is what is meant")]
fn f64_to_f32(x: f64) -> f32 {
    x as f32
}

/// Whether a property's number is this index.
fn index_is(i: usize, number: f64) -> bool {
    u32::try_from(i).is_ok_and(|i| f64::from(i) == number)
}

/// A token as people read it, cut where it is long.
fn show(kind: &Kind) -> String {
    let cut = |text: &str| text.chars().take(60).collect::<String>();
    match kind {
        Kind::Word(word) => format!("`{}`", cut(word)),
        Kind::Text(text) => format!("\"{}\"", cut(text)),
        Kind::Property(name) => format!("`[{}]`", cut(name)),
        Kind::Mark(mark) => format!("`{mark}`"),
    }
}
