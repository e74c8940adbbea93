//! `outmerge completions` and `outmerge man`: what a package installs beside the binary.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;

use super::{Failure, Outcome, output};

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub(super) struct Completions {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
pub(super) struct Man {
    /// Folder to write the pages to; made if missing. Without it the main page goes to stdout.
    #[arg(long, short)]
    output: Option<PathBuf>,
}

impl Completions {
    pub(super) fn run(self, mut command: Command) -> Result<Outcome, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, "outmerge", &mut script);
        output::print(&String::from_utf8(script)?)?;
        Ok(Outcome::Done)
    }
}

impl Man {
    pub(super) fn run(self, mut command: Command) -> Result<Outcome, Failure> {
        command.build();
        let Some(folder) = self.output else {
            output::print(&String::from_utf8(page(&command, "outmerge")?)?)?;
            return Ok(Outcome::Done);
        };
        std::fs::create_dir_all(&folder)
            .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
        for (name, page) in pages(&command, "outmerge")? {
            output::write_file(&folder.join(format!("{name}.1")), |file| Ok(file.write_all(&page)?))?;
        }
        Ok(Outcome::Done)
    }
}

fn page(command: &Command, name: &str) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone().display_name(name.to_owned())).render(&mut page)?;
    Ok(page)
}

/// The page of a command and those of its subcommands, `outmerge-vectors-check`.
fn pages(command: &Command, name: &str) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut all = vec![(name.to_owned(), page(command, name)?)];
    for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
        all.extend(pages(subcommand, &format!("{name}-{}", subcommand.get_name()))?);
    }
    Ok(all)
}
