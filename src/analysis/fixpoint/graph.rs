//! The dynamics of a map of codes to codes: limits, basins, steps.

use std::ops::RangeInclusive;

use serde::Serialize;

/// A set of codes the map permutes in a circle: one code is a fixed point, several are a limit cycle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Limit {
    /// The codes in the order they follow each other, the smallest first.
    pub codes: Vec<u32>,
    /// How many codes end here, those of the limit included.
    pub basin: u32,
    /// The largest number of steps a code of the basin takes to get here.
    pub steps: u32,
}

/// Everything a map does in the long run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dynamics {
    /// The limits, by their smallest code.
    pub limits: Vec<Limit>,
    /// By code: index of the limit it ends in.
    #[serde(skip)]
    pub limit_of: Vec<usize>,
    /// By code: steps until it is in its limit.
    #[serde(skip)]
    pub steps: Vec<u32>,
}

impl Dynamics {
    /// Follows every code of `map`, where `map[code]` is the next code.
    ///
    /// # Panics
    /// When an entry of the map is not an index into it.
    #[must_use]
    pub fn of(map: &[u32]) -> Self {
        const UNSEEN: usize = usize::MAX;
        const ON_PATH: usize = usize::MAX - 1;
        let mut limit_of = vec![UNSEEN; map.len()];
        let mut steps = vec![0; map.len()];
        let mut limits: Vec<Limit> = Vec::new();
        for start in 0..map.len() {
            let mut path = Vec::new();
            let mut code = start;
            while limit_of[code] == UNSEEN {
                limit_of[code] = ON_PATH;
                path.push(code);
                code = map[code] as usize;
            }
            if limit_of[code] == ON_PATH {
                // The path has met itself: what follows its first visit to `code` is a new limit.
                let first = path.iter().position(|&c| c == code).expect("the code is on the path");
                for &c in &path[first..] {
                    limit_of[c] = limits.len();
                }
                limits.push(Limit { codes: in_order(map, &path[first..]), basin: 0, steps: 0 });
                path.truncate(first);
            }
            let mut next = code;
            for &c in path.iter().rev() {
                limit_of[c] = limit_of[next];
                steps[c] = steps[next] + 1;
                next = c;
            }
        }
        for (limit, step) in limit_of.iter().zip(&steps) {
            limits[*limit].basin += 1;
            limits[*limit].steps = limits[*limit].steps.max(*step);
        }
        let mut order: Vec<usize> = (0..limits.len()).collect();
        order.sort_by_key(|&i| limits[i].codes[0]);
        let mut place = vec![0; limits.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        limit_of.iter_mut().for_each(|limit| *limit = place[*limit]);
        let limits = order.iter().map(|&i| limits[i].clone()).collect();
        Self { limits, limit_of, steps }
    }

    /// The limit a code ends in, and after how many steps.
    ///
    /// # Panics
    /// When the code is not one of the map's.
    #[must_use]
    pub fn from(&self, code: u32) -> (&Limit, u32) {
        let code = code as usize;
        (&self.limits[self.limit_of[code]], self.steps[code])
    }

    /// The fixed points, as ranges of consecutive codes.
    #[must_use]
    pub fn fixed_points(&self) -> Vec<RangeInclusive<u32>> {
        let mut ranges: Vec<RangeInclusive<u32>> = Vec::new();
        for code in self.limits.iter().filter(|limit| limit.codes.len() == 1).map(|limit| limit.codes[0]) {
            match ranges.last_mut() {
                Some(last) if *last.end() + 1 == code => *last = *last.start()..=code,
                _ => ranges.push(code..=code),
            }
        }
        ranges
    }

    /// The limits that are no fixed points.
    pub fn cycles(&self) -> impl Iterator<Item = &Limit> {
        self.limits.iter().filter(|limit| limit.codes.len() > 1)
    }
}

/// The codes of a cycle from its smallest one on.
fn in_order(map: &[u32], cycle: &[usize]) -> Vec<u32> {
    let smallest = cycle.iter().min().copied().unwrap_or(0);
    let mut codes = vec![u32::try_from(smallest).expect("codes are 32-bit")];
    while codes.len() < cycle.len() {
        codes.push(map[codes[codes.len() - 1] as usize]);
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_basins_and_steps_of_a_map_drawn_by_hand() {
        // 4 -> 3 -> 1 -> 2 -> 1, 5 -> 5, 0 -> 5, 6 -> 4.
        let dynamics = Dynamics::of(&[5, 2, 1, 1, 3, 5, 4]);
        let expected = [Limit { codes: vec![1, 2], basin: 5, steps: 3 }, Limit { codes: vec![5], basin: 2, steps: 1 }];
        assert_eq!(dynamics.limits, expected, "a cycle of two and a fixed point");
        assert_eq!(dynamics.from(6), (&expected[0], 3), "6, 4, 3, then the cycle at 1");
        assert_eq!(dynamics.fixed_points(), [5..=5], "fixed points");
        assert_eq!(dynamics.cycles().count(), 1, "cycles");
    }

    #[test]
    fn every_map_of_four_codes_agrees_with_walking_it() {
        for index in 0..256_u32 {
            let map: Vec<u32> = (0..4).map(|digit| index >> (2 * digit) & 3).collect();
            let dynamics = Dynamics::of(&map);
            for start in 0..4 {
                let after = |steps: u32| (0..steps).fold(start, |code, _| map[code as usize]);
                let (limit, steps) = dynamics.from(start);
                let inside = |steps| limit.codes.contains(&after(steps));
                assert!(inside(steps) && inside(steps + 1), "{map:?} from {start}: in its limit after {steps}");
                assert!(steps == 0 || !inside(steps - 1), "{map:?} from {start}: not earlier than {steps}");
            }
            let basins: u32 = dynamics.limits.iter().map(|limit| limit.basin).sum();
            assert_eq!(basins, 4, "{map:?}: every code ends somewhere");
        }
    }

    #[test]
    fn consecutive_fixed_points_are_one_range() {
        assert_eq!(Dynamics::of(&[0, 1, 2, 2, 4]).fixed_points(), [0..=2, 4..=4], "3 falls to 2");
    }
}
