//! The command line: one thin file a subcommand.
//!
//! Results go to stdout, progress to stderr. Exit status: that of the [verdict](crate::verdict), 0 for commands that judge
//! nothing, 2 for an error.

mod bound;
#[cfg(feature = "gpu")]
mod conform;
#[cfg(target_arch = "x86_64")]
mod estimate;
mod explain;
mod fixpoint;
mod identify;
mod judge;
mod limits;
mod lint;
mod list;
mod manual;
mod output;
mod plan;
#[cfg(feature = "gpu")]
mod record;
mod render;
mod report;
mod stability;
mod texture;
mod tradeoff;
mod vectors;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use crate::verdict::Verdict;

/// What bytes must the GPU write here, and why?
#[derive(Debug, Parser)]
#[command(name = "outmerge", version, about, max_term_width = 100, arg_required_else_help = true)]
struct Arguments {
    /// Raise or lower a limit on inputs, e.g. texture-bytes=4G; may be repeated. See docs/limits.md.
    #[arg(long = "limit", global = true, value_name = "NAME=VALUE")]
    limits: Vec<String>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render every bundled scene in every model: a table, and one HTML page. The main job.
    Report(report::Report),
    /// Render a scene to a PNG in one model.
    Render(render::Render),
    /// What each draw of a scene needs, what is left out and why, with bytes and time saved.
    Plan(plan::PlanCommand),
    /// Find the classic mistakes with alpha in a scene or a state, each with a counter-example.
    Lint(lint::Lint),
    /// Compare a device with numeric models, bit for bit, through its real output merger.
    #[cfg(feature = "gpu")]
    Conform(Box<conform::Conform>),
    /// Print every step of one blend, with the numbers substituted, in every numeric model.
    Explain(explain::Explain),
    /// Where a fragment drawn again and again gets stuck: fixed points, limit cycles, smallest useful alpha.
    Fixpoint(fixpoint::Fixpoint),
    /// Error against run time: every model on representative formats, states and depths of stacks.
    Tradeoff(tradeoff::Tradeoff),
    /// A proven bound on how far a stack of translucent layers can drift from real arithmetic.
    Bound(bound::BoundCommand),
    /// Stiff stacks, extreme values, depth ranges and drawing orders: what they do to the result.
    Stability(stability::Stability),
    /// What storing colors premultiplied costs PNG images: levels left, errors, fringes, a verdict.
    Texture(texture::Texture),
    /// Which numeric model is this? From samples of a blender, or by asking one.
    Identify(identify::Identify),
    /// Apply, check, judge or generate test vectors (JSON lines).
    #[command(subcommand)]
    Vectors(vectors::Vectors),
    /// Write this processor's table of reciprocal square root estimates, which llvmpipe's sRGB bytes depend on.
    #[cfg(target_arch = "x86_64")]
    Estimate(estimate::EstimateCommand),
    /// List the numeric models.
    Models(list::Models),
    /// List the color formats.
    Formats(list::Formats),
    /// List the bundled scenes.
    Scenes(list::Scenes),
    /// List the named blend states.
    Presets(list::Presets),
    /// Print a completion script for a shell.
    Completions(manual::Completions),
    /// Write the manual pages.
    Man(manual::Man),
}

/// What a command ended in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// It did what it was asked to, and judges nothing.
    Done,
    /// It compared or searched.
    Judged(Verdict),
}

/// Any error a command ends with: exit status 2.
type Failure = Box<dyn std::error::Error>;

/// Runs the command line and returns its exit status.
#[must_use]
pub fn main() -> ExitCode {
    output::end_cleanly_when_interrupted();
    let arguments = Arguments::parse();
    let result = limits::set(&arguments.limits).and_then(|()| run(arguments.command));
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Judged(verdict)) => {
            if !matches!(verdict, Verdict::Holds | Verdict::Fails) {
                output::complain(&format!("outmerge: {verdict}: {}", verdict.meaning()));
            }
            ExitCode::from(verdict.exit_status())
        }
        Err(error) if output::is_closed_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&format!("outmerge: {error}"));
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<Outcome, Failure> {
    match command {
        Command::Report(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Plan(command) => command.run(),
        Command::Lint(command) => command.run(),
        #[cfg(feature = "gpu")]
        Command::Conform(command) => command.run(),
        Command::Explain(command) => command.run(),
        Command::Fixpoint(command) => command.run(),
        Command::Tradeoff(command) => command.run(),
        Command::Bound(command) => command.run(),
        Command::Stability(command) => command.run(),
        Command::Texture(command) => command.run(),
        Command::Identify(command) => command.run(),
        Command::Vectors(command) => command.run(),
        #[cfg(target_arch = "x86_64")]
        Command::Estimate(command) => command.run(),
        Command::Models(command) => command.run(),
        Command::Formats(command) => command.run(),
        Command::Scenes(command) => command.run(),
        Command::Presets(command) => command.run(),
        Command::Completions(command) => command.run(Arguments::command()),
        Command::Man(command) => command.run(Arguments::command()),
    }
}
