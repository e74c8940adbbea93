//! Units as logs and result files hold them: one JSON object each, sealed with a checksum, so that a changed digit is
//! noticed. It guards against slips and damage; whoever wants to forge a result can compute it too.

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use super::UnitOutcome;

/// The member that holds it.
const MEMBER: &str = "checksum";

/// Why a sealed object is not what was written.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// No JSON, or JSON of another form.
    #[error(transparent)]
    Form(#[from] serde_json::Error),
    /// No checksum.
    #[error("it has no `{MEMBER}`; results of an earlier version of this program cannot be checked, so run them again")]
    Missing,
    /// A member that this program does not write.
    #[error("it has members, or spellings of numbers, that this program does not write")]
    Unknown,
    /// Another checksum.
    #[error("its checksum is {found}, but {given} is written: a digit was changed, or a line damaged")]
    Changed {
        /// What the content gives.
        found: String,
        /// What it says.
        given: String,
    },
}

/// The first 16 hex digits of the SHA-256 of a text.
pub(super) fn digest(text: &str) -> String {
    Sha256::digest(text).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// A unit with its checksum, in one line without an end.
///
/// # Errors
/// When it cannot be written as JSON.
pub(super) fn seal(unit: &UnitOutcome) -> Result<String, serde_json::Error> {
    #[derive(Serialize)]
    struct Sealed<'a> {
        #[serde(flatten)]
        unit: &'a UnitOutcome,
        checksum: String,
    }
    serde_json::to_string(&Sealed { unit, checksum: checksum(unit)? })
}

/// The checksum of a unit: that of its JSON.
///
/// # Errors
/// When it cannot be written as JSON.
pub(super) fn checksum(unit: &UnitOutcome) -> Result<String, serde_json::Error> {
    serde_json::to_string(unit).map(|json| digest(&json))
}

/// The unit of a sealed object, a line of a log for example.
///
/// # Errors
/// [`SealError`].
pub fn open(mut sealed: Value) -> Result<UnitOutcome, SealError> {
    let given = sealed.as_object_mut().and_then(|members| members.remove(MEMBER)).ok_or(SealError::Missing)?;
    let unit: UnitOutcome = serde_json::from_value(sealed.clone())?;
    if serde_json::to_value(&unit)? != sealed {
        return Err(SealError::Unknown);
    }
    let found = checksum(&unit)?;
    match given.as_str() {
        Some(given) if given == found => Ok(unit),
        given => Err(SealError::Changed { found, given: given.unwrap_or("something else").to_owned() }),
    }
}
