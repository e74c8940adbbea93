//! `Stencil { Ref 1 ReadMask 255 WriteMask 255 Comp Equal Pass Keep Fail Keep ZFail Keep }`.
//!
//! `Comp`, `Pass`, `Fail` and `ZFail` set both faces; with `Front` or `Back` behind them, one.

use wgpu_types::{CompareFunction, StencilFaceState, StencilOperation, StencilState};

use super::commands::comparison;
use super::parser::{Parser, error};
use super::property::STENCIL_OPERATIONS;
use super::{Position, ShaderLabError};
use crate::state::{StateBlock, spelling};

type Result<T> = std::result::Result<T, ShaderLabError>;

/// Reads the block after `Stencil`.
pub(super) fn stencil(parser: &mut Parser<'_>, opened: Position, state: &mut StateBlock) -> Result<()> {
    parser.mark('{')?;
    let mut stencil = StencilState {
        front: StencilFaceState::IGNORE,
        back: StencilFaceState::IGNORE,
        read_mask: 255,
        write_mask: 255,
    };
    let mut reference = 0;
    while !parser.accept('}') {
        let at = parser.at();
        let Some(word) = parser.peek_word().map(str::to_ascii_lowercase) else {
            return Err(match parser.peek() {
                None => error(opened, "this Stencil block is never closed with `}`"),
                Some(_) => error(at, "expected a stencil command or `}`"),
            });
        };
        parser.take();
        match word.as_str() {
            "ref" => reference = byte(parser)?,
            "readmask" => stencil.read_mask = byte(parser)?,
            "writemask" => stencil.write_mask = byte(parser)?,
            _ => face_command(parser, &word, at, &mut stencil)?,
        }
    }
    state.stencil = Some((stencil, reference));
    Ok(())
}

/// A command of one face or both; `word` is in lower case.
fn face_command(parser: &mut Parser<'_>, word: &str, at: Position, stencil: &mut StencilState) -> Result<()> {
    let (command, faces): (&str, &mut [&mut StencilFaceState]) =
        match (word.strip_suffix("front"), word.strip_suffix("back")) {
            (Some(command), _) => (command, &mut [&mut stencil.front]),
            (_, Some(command)) => (command, &mut [&mut stencil.back]),
            _ => (word, &mut [&mut stencil.front, &mut stencil.back]),
        };
    match command {
        "comp" => {
            let compare = comparison(parser, "a comparison")?.unwrap_or(CompareFunction::Always);
            faces.iter_mut().for_each(|face| face.compare = compare);
        }
        "pass" => {
            let operation = operation(parser)?;
            faces.iter_mut().for_each(|face| face.pass_op = operation);
        }
        "fail" => {
            let operation = operation(parser)?;
            faces.iter_mut().for_each(|face| face.fail_op = operation);
        }
        "zfail" => {
            let operation = operation(parser)?;
            faces.iter_mut().for_each(|face| face.depth_fail_op = operation);
        }
        _ => {
            let word: String = word.chars().take(60).collect();
            let known =
                "Ref, ReadMask, WriteMask, Comp, Pass, Fail, ZFail, each of the last four also with Front or Back";
            return Err(error(at, format!("unknown stencil command `{word}`; known are {known}")));
        }
    }
    Ok(())
}

fn byte(parser: &mut Parser<'_>) -> Result<u32> {
    let at = parser.at();
    let number = parser.number("a number from 0 to 255")?;
    let found = (0..=255_u32).find(|i| f64::from(*i) == number);
    found.ok_or_else(|| error(at, format!("{number} is not a whole number from 0 to 255")))
}

fn operation(parser: &mut Parser<'_>) -> Result<StencilOperation> {
    let (name, at) = parser.name("a stencil operation", &STENCIL_OPERATIONS)?;
    spelling::stencil_operation(&name).map_err(|e| error(at, e.to_string()))
}
