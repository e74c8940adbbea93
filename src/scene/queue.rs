//! Render queues and the order objects are drawn in.
//!
//! Up to 2500 (opaque and cutout) objects go front to back, which spares shading; above, back to front, which blending
//! needs. Equal keys keep their order in the scene. Source: Unity manual, *ShaderLab: SubShader tags*.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use crate::state::block;

/// A place in the drawing order, 0 to 5000.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RenderQueue(u16);

/// A queue that is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueueError {
    /// Not in range.
    #[error("{0} is not a render queue; use 0 to 5000")]
    Range(i64),
    /// No such name.
    #[error(transparent)]
    Name(#[from] block::QueueError),
}

impl RenderQueue {
    /// Before everything else.
    pub const BACKGROUND: Self = Self(1000);
    /// Opaque geometry.
    pub const GEOMETRY: Self = Self(2000);
    /// Geometry with holes, cut by clip or alpha test.
    pub const ALPHA_TEST: Self = Self(2450);
    /// Blended geometry.
    pub const TRANSPARENT: Self = Self(3000);
    /// After everything else.
    pub const OVERLAY: Self = Self(4000);

    /// Last queue that is sorted front to back.
    const LAST_OPAQUE: Self = Self(2500);

    /// The queue with this number.
    ///
    /// # Errors
    /// [`QueueError`] outside 0 to 5000.
    pub fn new(number: i64) -> Result<Self, QueueError> {
        u16::try_from(number).ok().filter(|&n| n <= 5000).map(Self).ok_or(QueueError::Range(number))
    }

    /// The number.
    #[must_use]
    pub fn number(self) -> u16 {
        self.0
    }

    /// Whether its objects are drawn back to front.
    #[must_use]
    pub fn is_transparent(self) -> bool {
        self > Self::LAST_OPAQUE
    }
}

impl FromStr for RenderQueue {
    type Err = QueueError;

    /// Reads a number, or a name with an offset.
    fn from_str(text: &str) -> Result<Self, QueueError> {
        match text.trim().parse::<i64>() {
            Ok(number) => Self::new(number),
            Err(_) => Self::new(i64::from(block::queue_number(text)?)),
        }
    }
}

impl fmt::Display for RenderQueue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = i32::from(self.0);
        let (name, base) = block::QUEUES.iter().rev().find(|(_, base)| *base <= number).unwrap_or(&block::QUEUES[0]);
        match number - base {
            0 => write!(f, "{name}"),
            offset => write!(f, "{name}{offset:+}"),
        }
    }
}

/// What decides an object's place: its queue, then its distance (any key that grows with it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SortKey {
    /// The queue.
    pub queue: RenderQueue,
    /// Distance from the camera; a NaN counts as farther than everything.
    pub distance: f64,
}

impl SortKey {
    /// Which of two objects is drawn first. A total order on keys.
    #[must_use]
    pub fn compare(&self, other: &Self) -> Ordering {
        // total_cmp would put -NaN first and tell -0 from 0.
        let distance = |key: &Self| if key.distance.is_nan() { f64::INFINITY } else { key.distance + 0.0 };
        let by_distance = distance(self).total_cmp(&distance(other));
        let by_distance = if self.queue.is_transparent() { by_distance.reverse() } else { by_distance };
        self.queue.cmp(&other.queue).then(by_distance)
    }
}

/// Indices into `keys` in drawing order: a stable permutation.
#[must_use]
pub fn drawing_order(keys: &[SortKey]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by(|&a, &b| keys[a].compare(&keys[b]));
    order
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn key(queue: &str, distance: f64) -> SortKey {
        SortKey { queue: queue.parse().expect("a queue of the test"), distance }
    }

    #[test]
    fn names_offsets_and_numbers_are_read_and_written() {
        for (text, number, shown) in [
            ("Geometry", 2000, "Geometry"),
            ("Transparent+1", 3001, "Transparent+1"),
            ("transparent-100", 2900, "GeometryLast+400"),
            ("2450", 2450, "AlphaTest"),
            ("Geometry-1", 1999, "Background+999"),
            ("0", 0, "Background-1000"),
        ] {
            let queue: RenderQueue = text.parse().expect("a queue of the test");
            assert_eq!((queue.number(), queue.to_string().as_str()), (number, shown), "{text}");
        }
        for text in ["", "Solid", "Transparent+", "Overlay+1001", "-1", "5001", "99999999999999999999", "Geometry+x"] {
            assert!(text.parse::<RenderQueue>().is_err(), "`{text}` is no queue");
        }
    }

    #[test]
    fn opaque_goes_front_to_back_then_transparent_back_to_front() {
        let keys = [
            key("Transparent", 1.0),
            key("Transparent", 5.0),
            key("Geometry", 9.0),
            key("AlphaTest", 1.0),
            key("Geometry", 2.0),
            key("Transparent-1", 0.0),
        ];
        assert_eq!(drawing_order(&keys), [4, 2, 3, 5, 1, 0], "queues first, then distance by the queue's direction");
    }

    fn any_key() -> impl Strategy<Value = SortKey> {
        let distance = prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(f64::NAN), Just(-f64::NAN), any::<f64>()];
        (prop_oneof![Just(2000), Just(2500), Just(2501), Just(3000), 0_i64..5001], distance)
            .prop_map(|(queue, distance)| SortKey { queue: RenderQueue::new(queue).expect("in range"), distance })
    }

    proptest! {
        #[test]
        fn sorting_is_a_stable_permutation_even_with_nan(keys in prop::collection::vec(any_key(), 0..40)) {
            let order = drawing_order(&keys);
            let mut seen = order.clone();
            seen.sort_unstable();
            prop_assert_eq!(seen, (0..keys.len()).collect::<Vec<_>>(), "a permutation");
            for pair in order.windows(2) {
                let compared = keys[pair[0]].compare(&keys[pair[1]]);
                prop_assert!(compared != Ordering::Greater, "{:?} before {:?}", keys[pair[0]], keys[pair[1]]);
                prop_assert!(compared != Ordering::Equal || pair[0] < pair[1], "equal keys keep their order");
            }
        }
    }
}
