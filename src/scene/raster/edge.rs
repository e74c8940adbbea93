//! Exact integer edge functions, the top-left fill rule, and the spans they leave of each row.

use super::SUBPIXELS;

/// A run of covered pixels in one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Row, from the top.
    pub y: u32,
    /// First covered column.
    pub start: u32,
    /// First column after the run.
    pub end: u32,
}

/// One directed edge of a triangle wound so that its inside gives positive values.
///
/// With positions in sub-pixels relative to the centre of pixel (0, 0), y down,
/// `E(x, y) = dx * (y - y0) - dy * (x - x0)`: twice the signed area of the triangle (start, end, point).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    start: [i64; 2],
    delta: [i64; 2],
}

impl Edge {
    pub(super) fn new(start: [i64; 2], end: [i64; 2]) -> Self {
        Self { start, delta: [end[0] - start[0], end[1] - start[1]] }
    }

    /// The edge function at the centre of pixel (x, y).
    pub(super) fn at(self, x: i64, y: i64) -> i64 {
        self.toward([x * SUBPIXELS, y * SUBPIXELS])
    }

    /// Twice the signed area of the triangle (start, end, point), `point` in sub-pixels.
    pub(super) fn toward(self, point: [i64; 2]) -> i64 {
        self.delta[0] * (point[1] - self.start[1]) - self.delta[1] * (point[0] - self.start[0])
    }

    /// Change of the function from one pixel to the next on the right, and to the next below.
    pub(super) fn steps(self) -> [i64; 2] {
        [-self.delta[1] * SUBPIXELS, self.delta[0] * SUBPIXELS]
    }

    /// Least value that counts as inside: 0 on a top or left edge, which own their pixel centres, else 1.
    ///
    /// Source: D3D11.3 3.4.2.1; Vulkan leaves the rule to the implementation but asks for exactly one owner.
    fn threshold(self) -> i64 {
        let [dx, dy] = self.delta;
        i64::from(!(dy < 0 || (dy == 0 && dx > 0)))
    }

    /// The columns `[start, end)` of row `y` inside this edge and inside `columns`; `end <= start` where there are none.
    fn clip_row(self, y: i64, [start, end]: [i64; 2]) -> [i64; 2] {
        let need = self.threshold() - self.at(0, y);
        match self.steps()[0] {
            0 if need <= 0 => [start, end],
            0 => [start, start],
            step if step > 0 => [start.max(-(-need).div_euclid(step)), end],
            step => [start, end.min((-need).div_euclid(-step) + 1)],
        }
    }
}

/// The covered spans of a triangle, rows from the top, within `width` x `height` pixels.
pub(super) fn spans(edges: [Edge; 3], width: u32, height: u32) -> impl Iterator<Item = Span> {
    let ys = edges.map(|edge| edge.start[1]);
    let top = (-(-ys[0].min(ys[1]).min(ys[2])).div_euclid(SUBPIXELS)).max(0);
    let bottom = ys[0].max(ys[1]).max(ys[2]).div_euclid(SUBPIXELS).min(i64::from(height) - 1);
    (top..=bottom).filter_map(move |y| {
        let [start, end] = edges.iter().fold([0, i64::from(width)], |columns, edge| edge.clip_row(y, columns));
        let (start, end) = (u32::try_from(start).ok()?, u32::try_from(end).ok()?);
        (start < end).then_some(Span { y: u32::try_from(y).ok()?, start, end })
    })
}
