//! What a developer does often, on every platform: `cargo xtask --help`.

mod case;
mod dist;
mod error;
mod figures;
#[path = "../../core/benches/shapes/mod.rs"]
mod shapes;

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use error::TaskError;

use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(name = "cargo xtask", about = "What a developer does often")]
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
    /// What is given to users, in `target/dist`
    Dist {
        /// One of them; without it everything that can be built here, with SHA256SUMS
        #[command(subcommand)]
        one: Option<DistTask>,
    },
    /// The documentation of all packages, a warning is an error; and the help as one page to be printed
    Docs {
        /// Open it in the browser
        #[arg(long)]
        open: bool,
    },
    /// The figures of speed: every bench, and a program of each kind in the release build
    Figures,
}

#[derive(Debug, Subcommand)]
enum DistTask {
    /// The program for this Linux: a portable .tar.gz and a .deb
    Linux,
    /// What is new in this version, from CHANGELOG.md
    Notes,
    /// The program for Windows on x86-64, built on Debian: an .exe, a .zip with its checksum
    Windows,
    /// The page for browsers, built on Debian: a folder and a .zip with its checksum
    Web,
}

#[derive(Debug, Subcommand)]
enum CaseTask {
    /// A new case to fill in: `cycles/G71/roughing-small-step`
    New {
        /// Subject, code and name, as the folders are
        path: String,
        /// An operator script instead of a part program
        #[arg(long)]
        script: bool,
    },
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Ci => run("bash", &[".ci/run"], &[]),
        Task::Case(CaseTask::New { path, script }) => {
            case::new(&root(), &path, script).map(|said| println!("{said}"))
        }
        Task::Dist { one: None } => dist::all(&root()),
        Task::Dist { one: Some(one) } => match one {
            DistTask::Linux => dist::linux::make(&root()),
            DistTask::Notes => dist::notes::make(&root()),
            DistTask::Windows => dist::windows::make(&root()),
            DistTask::Web => dist::web::make(&root()),
        },
        Task::Docs { open } => docs(open),
        Task::Figures => figures::figures(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(said) => {
            eprintln!("{said}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the repository.
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

fn docs(open: bool) -> Result<(), TaskError> {
    let mut arguments = vec!["doc", "--workspace", "--no-deps", "--locked"];
    if open {
        arguments.push("--open");
    }
    run("cargo", &arguments, &[("RUSTDOCFLAGS", "-D warnings")])?;
    dist::manuals(&root())
}
