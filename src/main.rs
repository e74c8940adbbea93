//! The `outmerge` command; everything is in [`outmerge::cli`].

fn main() -> std::process::ExitCode {
    outmerge::cli::main()
}
