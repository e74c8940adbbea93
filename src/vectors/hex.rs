//! Byte strings as lower-case hex.

/// Two digits a byte.
pub(super) fn encode(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    let digit = |nibble: u8| char::from(DIGITS[usize::from(nibble)]);
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

/// The bytes, or the position of the first character that is not a hex digit (the length for an odd length).
pub(super) fn decode(text: &str) -> Result<Vec<u8>, usize> {
    let value = |i: usize, c: u8| match c {
        b'0'..=b'9' => Ok(c - b'0'),
        b'a'..=b'f' => Ok(c - b'a' + 10),
        b'A'..=b'F' => Ok(c - b'A' + 10),
        _ => Err(i),
    };
    let pairs = text.as_bytes().chunks(2).enumerate();
    pairs
        .map(|(i, pair)| match pair {
            [high, low] => Ok(value(2 * i, *high)? << 4 | value(2 * i + 1, *low)?),
            _ => Err(text.len()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive() {
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(decode(&encode(&all)), Ok(all), "every byte");
    }

    #[test]
    fn the_wrong_character_is_named() {
        assert_eq!(decode("00zz"), Err(2), "not a digit");
        assert_eq!(decode("000"), Err(3), "odd length");
        assert_eq!(decode("0é"), Err(1), "not ASCII");
    }
}
