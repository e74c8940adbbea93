//! `outmerge estimate`: the running machine's table of reciprocal square root estimates, in the form the project records.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, Outcome, output};
use crate::model::llvmpipe::rsqrt::Recording;
use crate::processor::Processor;

/// Arguments of `estimate`.
#[derive(Debug, Args)]
pub(super) struct EstimateCommand {
    /// Where to write the table; `-` is stdout.
    #[arg(long, short, default_value = "-")]
    output: PathBuf,
}

impl EstimateCommand {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let processor = Processor::of_this_machine();
        let recording = Recording::of_this_machine();
        if recording.outside > 0 {
            return Err(format!(
                "{processor}: {} of 2^24 estimates are not constant over steps of 2048 numbers, so the recorded form cannot \
                 hold this processor; use rsqrt=host on the machine itself, and report this",
                recording.outside
            )
            .into());
        }
        let known = recording.known_as();
        output::complain(&match known {
            Some(known) => format!("{processor}: the same as rsqrt={}, {}", known.name(), known.processor()),
            None => format!("{processor}: none of the recorded tables; rsqrt=host uses it on this machine"),
        });
        let comments = [format!("Reciprocal square root estimates of {processor}.")];
        output::write_file(&self.output, |file| Ok(file.write_all(recording.to_text(&comments).as_bytes())?))?;
        Ok(Outcome::Done)
    }
}
