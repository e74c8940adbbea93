//! The byte strings of a line: raw bytes, and binary32 numbers in them.

use super::hex;
use super::line::LineError;

/// A byte string of a known length.
pub(super) fn bytes(member: &'static str, text: &str, expected: usize) -> Result<Vec<u8>, LineError> {
    let bytes = hex::decode(text).map_err(|at| LineError::Hex { member, at })?;
    if bytes.len() != expected {
        return Err(LineError::Length { member, got: bytes.len(), expected });
    }
    Ok(bytes)
}

/// n x 4 binary32; `count` where the number of colors is known.
pub(super) fn colors(member: &'static str, text: &str, count: Option<usize>) -> Result<Vec<[f32; 4]>, LineError> {
    let floats = floats(member, text, 4, count)?;
    Ok(floats.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]]).collect())
}

/// n groups of `each` binary32 numbers; `count` where n is known.
pub(super) fn floats(
    member: &'static str,
    text: &str,
    each: usize,
    count: Option<usize>,
) -> Result<Vec<f32>, LineError> {
    let bytes = hex::decode(text).map_err(|at| LineError::Hex { member, at })?;
    let expected = count.map_or(bytes.len().next_multiple_of(4 * each), |count| 4 * each * count);
    if bytes.len() != expected {
        return Err(LineError::Length { member, got: bytes.len(), expected });
    }
    Ok(bytes.chunks_exact(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect())
}

/// One byte a texel, each 0 or 1.
pub(super) fn flags(member: &'static str, text: &str, expected: usize) -> Result<Vec<bool>, LineError> {
    let bytes = bytes(member, text, expected)?;
    match bytes.iter().position(|byte| *byte > 1) {
        Some(texel) => Err(LineError::Flag { member, texel }),
        None => Ok(bytes.into_iter().map(|byte| byte == 1).collect()),
    }
}

/// Flags as hex.
pub(super) fn flag_hex(flags: &[bool]) -> String {
    hex::encode(&flags.iter().map(|flag| u8::from(*flag)).collect::<Vec<_>>())
}

/// Numbers as hex.
pub(super) fn float_hex<'a>(numbers: impl IntoIterator<Item = &'a f32>) -> String {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(|x| x.to_le_bytes()).collect();
    hex::encode(&bytes)
}

/// Colors as hex.
pub(super) fn color_hex(colors: &[[f32; 4]]) -> String {
    float_hex(colors.iter().flatten())
}
