//! Checks on single values of a scene file.

use std::fmt::Display;
use std::ops::RangeInclusive;

use super::error::{Fault, FieldPath};

/// The numbers, if all are finite.
pub(super) fn finite<T: Copy + Into<f64>, const N: usize>(field: &FieldPath, numbers: [T; N]) -> Result<[T; N], Fault> {
    match numbers.iter().find(|&&x| !Into::<f64>::into(x).is_finite()) {
        Some(&x) => Err(Fault::new(field, format!("{} is not a finite number of this size", x.into()))),
        None => Ok(numbers),
    }
}

/// The number, if it lies in the range; a NaN does not.
pub(super) fn within<T>(field: &FieldPath, x: T, range: RangeInclusive<T>) -> Result<T, Fault>
where
    T: PartialOrd + Display,
{
    if range.contains(&x) {
        return Ok(x);
    }
    Err(Fault::new(field, format!("{x} is out of range; it must be {} to {}", range.start(), range.end())))
}

/// The number, if it is above 0 and finite.
pub(super) fn positive(field: &FieldPath, x: f64) -> Result<f64, Fault> {
    if x > 0.0 && x.is_finite() {
        return Ok(x);
    }
    Err(Fault::new(field, format!("{x} must be a finite number above 0")))
}

/// Index of the entry called `name`.
pub(super) fn named<'a>(
    field: &FieldPath,
    what: &str,
    name: &str,
    mut names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, Fault> {
    names.clone().position(|known| known == name).ok_or_else(|| {
        let known: Vec<_> = names.by_ref().collect();
        let list = if known.is_empty() { "none is defined".to_owned() } else { format!("use {}", known.join(", ")) };
        Fault::new(field, format!("there is no {what} `{name}`; {list}"))
    })
}

/// Fails if a name stands twice.
pub(super) fn distinct<'a>(section: &FieldPath, names: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
    let mut seen = std::collections::BTreeSet::new();
    for (i, name) in names.enumerate() {
        if !seen.insert(name) {
            return Err(Fault::new(&section.index(i).key("name"), format!("`{name}` is defined twice")));
        }
    }
    Ok(())
}

/// Fails if a section has more than `limit` entries.
pub(super) fn at_most(section: &FieldPath, count: usize, limit: usize) -> Result<(), Fault> {
    if count <= limit {
        return Ok(());
    }
    Err(Fault::new(section, format!("{count} entries are too many; the limit is {limit}")))
}

/// Fails if `amount` is above the limit called `name` (see [`crate::limit::Limits`]).
pub(super) fn within_limit(field: &FieldPath, name: &str, amount: u64, limit: u64) -> Result<(), Fault> {
    if amount <= limit {
        return Ok(());
    }
    Err(Fault::new(field, format!("{amount} are needed so far, and the limit `{name}` is {limit}")))
}
