//! Arrays of a fixed length. The TOML reader takes the elements that are asked for and passes over the rest; here one
//! element too many is an error, as one too few is.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, SeqAccess, Visitor};

/// An array of exactly N elements.
struct Tuple<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Tuple<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Elements<T, const N: usize>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Elements<T, N> {
            type Value = Tuple<T, N>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "an array of {N} elements")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Self::Value, A::Error> {
                let mut taken = Vec::with_capacity(N);
                while taken.len() < N {
                    let element = elements.next_element()?;
                    taken.push(element.ok_or_else(|| A::Error::invalid_length(taken.len(), &self))?);
                }
                let mut more = 0;
                while elements.next_element::<IgnoredAny>()?.is_some() {
                    more += 1;
                }
                let array = taken.try_into().ok().filter(|_| more == 0);
                array.map(Tuple).ok_or_else(|| A::Error::invalid_length(N + more, &self))
            }
        }
        deserializer.deserialize_seq(Elements(PhantomData))
    }
}

/// For members of type `[T; N]`.
pub(super) fn one<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    Tuple::deserialize(deserializer).map(|tuple| tuple.0)
}

/// For members of type `Option<[T; N]>`.
pub(super) fn optional<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[T; N]>, D::Error> {
    Ok(Option::<Tuple<T, N>>::deserialize(deserializer)?.map(|tuple| tuple.0))
}

/// For members of type `Vec<[T; N]>`.
pub(super) fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    deserializer: D,
) -> Result<Vec<[T; N]>, D::Error> {
    Ok(Vec::<Tuple<T, N>>::deserialize(deserializer)?.into_iter().map(|tuple| tuple.0).collect())
}
