//! What the fragment shader noted: a counter, then one record a fragment in no particular order.
//!
//! Words of a record: number of the draw, of the triangle, `x | y << 16`, flags (1 front facing, 2 discarded by the
//! shader), depth bits, then four words a color output.

use crate::fragment::Fragment;
use crate::state::MAX_COLOR_TARGETS;

/// Words before the colors.
const HEAD: usize = 5;

/// A fragment made by the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnFragment {
    /// Index of the draw.
    pub draw: usize,
    /// Index of the triangle within the draw.
    pub triangle: u32,
    /// Column.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// What the shader handed over.
    pub fragment: Fragment,
}

/// Words a record takes with this many color outputs.
#[must_use]
pub fn record_words(outputs: usize) -> usize {
    HEAD + 4 * outputs
}

/// How many fragments were made; more than there are records if the log overflowed.
#[must_use]
pub fn count(bytes: &[u8]) -> usize {
    words(bytes).next().map_or(0, to_usize)
}

/// The records, sorted by texel (rows from the top), draw and triangle: the order the output merger keeps.
#[must_use]
pub fn fragments(bytes: &[u8], outputs: usize) -> Vec<DrawnFragment> {
    let words: Vec<u32> = words(bytes).skip(1).collect();
    let records = words.chunks_exact(record_words(outputs)).take(count(bytes));
    let mut fragments: Vec<_> = records.map(|record| decode(record, outputs)).collect();
    fragments.sort_by_key(|fragment| (fragment.y, fragment.x, fragment.draw, fragment.triangle));
    fragments
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u32> + '_ {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
}

fn decode(record: &[u32], outputs: usize) -> DrawnFragment {
    let mut fragment = Fragment {
        depth: f32::from_bits(record[4]),
        front_facing: record[3] & 1 != 0,
        discarded: record[3] & 2 != 0,
        ..Fragment::default()
    };
    for location in 0..outputs.min(MAX_COLOR_TARGETS) {
        let first = HEAD + 4 * location;
        fragment.outputs[location] = std::array::from_fn(|channel| f32::from_bits(record[first + channel]));
    }
    DrawnFragment {
        draw: to_usize(record[0]),
        triangle: record[1],
        x: record[2] & 0xffff,
        y: record[2] >> 16,
        fragment,
    }
}

fn to_usize(x: u32) -> usize {
    usize::try_from(x).expect("an index of 32 bits")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_sorted_by_texel_then_draw_then_triangle() {
        let record = |draw: u32, triangle: u32, x: u32, y: u32| {
            [draw, triangle, x | y << 16, 3, 0.5_f32.to_bits(), 0, 1.0_f32.to_bits(), 0, 0]
        };
        let records = [record(1, 0, 2, 0), record(0, 1, 2, 0), record(0, 0, 2, 0), record(0, 0, 1, 1)];
        let mut log: Vec<u32> = vec![4];
        log.extend(records.iter().flatten());
        let bytes: Vec<u8> = log.iter().flat_map(|word| word.to_le_bytes()).collect();
        let fragments = fragments(&bytes, 1);
        let keys: Vec<_> = fragments.iter().map(|f| (f.y, f.x, f.draw, f.triangle)).collect();
        assert_eq!(keys, [(0, 2, 0, 0), (0, 2, 0, 1), (0, 2, 1, 0), (1, 1, 0, 0)], "order");
        let fragment = fragments[0].fragment;
        assert_eq!((fragment.depth, fragment.front_facing, fragment.discarded), (0.5, true, true), "head");
        assert_eq!(fragment.outputs[0], [0.0, 1.0, 0.0, 0.0], "color");
    }
}
