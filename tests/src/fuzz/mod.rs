//! Fuzz targets: plain functions from bytes, for the driver `fuzz` or any other engine.
//!
//! A target panics when the program violates an invariant. It wraps each unit of work (a
//! parsed block, a tick, a slot of the ladder) in [`watch::unit`], so that a driver sees the
//! longest one. It reports what an input reached with [`watch::seen`], so that a driver keeps
//! inputs with new results.
//!
//! Targets that take a program read settings from a comment in its first line: `(SET 13=1
//! 1.4=0 T1=0.4/3 B=1)` sets a parameter, one of its bits, the nose radius and tip of an
//! offset, and the option of macro B.

mod cycles;
mod dry_run;
mod interpreter;
mod ladder;
mod link;
mod mill;
mod minimize;
pub mod mutate;
mod program;
mod script;
mod settings;
mod simulation;
mod step_link;
pub mod watch;

pub use minimize::minimize;

/// A function that takes any bytes.
pub struct Target {
    /// Its name, also that of its corpus folder.
    pub name: &'static str,
    /// Runs one input.
    pub run: fn(&[u8]),
    /// Words with a meaning for it, one per line.
    pub words: &'static str,
}

/// Words of programs.
const PROGRAM_WORDS: &str = include_str!("words-program.txt");

/// All targets.
pub const TARGETS: [Target; 10] = [
    Target {
        name: "program",
        run: program::run,
        words: PROGRAM_WORDS,
    },
    Target {
        name: "interpreter",
        run: interpreter::run,
        words: PROGRAM_WORDS,
    },
    Target {
        name: "macros",
        run: interpreter::run_macro_b,
        words: include_str!("words-macros.txt"),
    },
    Target {
        name: "mill",
        run: mill::run,
        words: include_str!("words-mill.txt"),
    },
    Target {
        name: "cycles",
        run: cycles::run,
        words: include_str!("words-cycles.txt"),
    },
    Target {
        name: "simulation",
        run: simulation::run,
        words: PROGRAM_WORDS,
    },
    Target {
        name: "script",
        run: script::run,
        words: include_str!("words-script.txt"),
    },
    Target {
        name: "ladder",
        run: ladder::run,
        words: include_str!("words-ladder.txt"),
    },
    Target {
        name: "link",
        run: link::run,
        words: include_str!("words-link.txt"),
    },
    Target {
        name: "step_link",
        run: step_link::run,
        words: "",
    },
];

/// The target with a name.
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
