//! Tasks of a developer, on every platform: `cargo xtask --help` lists them.

mod case;
mod dist;
mod error;
mod figures;
#[path = "../../core/benches/shapes/mod.rs"]
mod shapes;
mod tables;

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use error::TaskError;

use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(name = "cargo xtask", about = "Tasks of a developer")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Everything a change must pass (`.ci/run`)
    Ci,
    /// Cases: folders of data under `tests/cases/`
    #[command(subcommand)]
    Case(CaseTask),
    /// The release files, in `target/dist`
    Dist {
        /// One kind; without it everything that can be built here, with SHA256SUMS
        #[command(subcommand)]
        one: Option<DistTask>,
    },
    /// The documentation of all packages (a warning is an error), and the help as one page for printing
    Docs {
        /// Open it in the browser
        #[arg(long)]
        open: bool,
    },
    /// The figures of speed: every bench, and a program of each kind in the release build
    Figures,
    /// The lists in the sources that come from tables, after a new row of `assets/tables`
    Tables,
}

#[derive(Debug, Subcommand)]
enum DistTask {
    /// The program for this Linux: a portable .tar.gz and a .deb
    Linux,
    /// Release notes of this version, from CHANGELOG.md
    Notes,
    /// The program for Windows on x86-64, built on Debian: an .exe, a .zip with its checksum
    Windows,
    /// The firmware for a pulse board with a Raspberry Pi Pico, built on Debian: a .uf2 with its checksum
    Pico,
    /// The page for browsers, built on Debian: a folder and a .zip with its checksum
    Web,
}

#[derive(Debug, Subcommand)]
enum CaseTask {
    /// Create a case to fill in: `cycles/G71/roughing-small-step`
    New {
        /// Subject, code and name, like the folders
        path: String,
        /// An operator script instead of a part program
        #[arg(long)]
        script: bool,
    },
}

fn main() -> ExitCode {
    let result = match Cli::parse().task {
        Task::Ci => run("bash", &[".ci/run"], &[]),
        Task::Case(CaseTask::New { path, script }) => {
            case::create(&root(), &path, script).map(|next| println!("{next}"))
        }
        Task::Dist { one: None } => dist::all(&root()),
        Task::Dist { one: Some(one) } => match one {
            DistTask::Linux => dist::linux::make(&root()),
            DistTask::Notes => dist::notes::make(&root()),
            DistTask::Windows => dist::windows::make(&root()),
            DistTask::Pico => dist::pico::make(&root()),
            DistTask::Web => dist::web::make(&root()),
        },
        Task::Docs { open } => build_docs(open),
        Task::Figures => figures::print(),
        Task::Tables => tables::write(&root()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the root folder of the repository.
fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest
        .parent()
        .map_or_else(|| manifest.clone(), Into::into)
}

/// Runs a command in the folder of the repository.
fn run(program: &str, arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), TaskError> {
    let line = format!("{program} {}", arguments.join(" "));
    println!("> {line}");
    let status = Command::new(program)
        .args(arguments)
        .envs(environment.iter().copied())
        .current_dir(root())
        .status()
        .map_err(|error| TaskError::Start {
            line: line.clone(),
            error,
        })?;
    if status.success() {
        Ok(())
    } else {
        Err(TaskError::Failed { line, status })
    }
}

fn build_docs(open: bool) -> Result<(), TaskError> {
    let mut arguments = vec!["doc", "--workspace", "--no-deps", "--locked"];
    if open {
        arguments.push("--open");
    }
    run("cargo", &arguments, &[("RUSTDOCFLAGS", "-D warnings")])?;
    dist::write_manuals(&root())
}
