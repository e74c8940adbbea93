//! `--limit NAME=VALUE`: limits of this run, set once before any command reads.

use std::sync::OnceLock;

use super::Failure;
use crate::limit::Limits;

static LIMITS: OnceLock<Limits> = OnceLock::new();

/// Takes the settings of the command line.
pub(super) fn set(settings: &[String]) -> Result<(), Failure> {
    let mut limits = Limits::default();
    settings.iter().try_for_each(|setting| limits.set(setting))?;
    // Only `main` sets them, once.
    let _ = LIMITS.set(limits);
    Ok(())
}

/// The limits of this run.
pub(super) fn get() -> &'static Limits {
    LIMITS.get_or_init(Limits::default)
}
