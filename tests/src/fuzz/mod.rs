//! Fuzz targets: plain functions from bytes, for the driver `fuzz` or any other engine.
//!
//! A target panics when the program violates an invariant. It wraps each unit of work (a
//! parsed block, a tick, a slot of the ladder) in [`watch::run_unit`], so that a driver sees the
//! longest one. It reports what an input reached with [`watch::record_event`], so that a driver keeps
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

/// A fuzz target: a function that takes any bytes and panics on a fault.
pub struct FuzzTarget {
    /// Name of the target, also that of its corpus folder.
    pub name: &'static str,
    /// Runs one input. A panic is a finding.
    pub run: fn(&[u8]),
    /// Words that have a meaning in the target's inputs, one a line.
    pub words: &'static str,
}

/// Words of part programs, one a line.
const PROGRAM_WORDS: &str = include_str!("words-program.txt");

/// All fuzz targets.
pub const TARGETS: [FuzzTarget; 10] = [
    FuzzTarget {
        name: "program",
        run: program::fuzz_program,
        words: PROGRAM_WORDS,
    },
    FuzzTarget {
        name: "interpreter",
        run: interpreter::fuzz_interpreter,
        words: PROGRAM_WORDS,
    },
    FuzzTarget {
        name: "macros",
        run: interpreter::fuzz_macro_b,
        words: include_str!("words-macros.txt"),
    },
    FuzzTarget {
        name: "mill",
        run: mill::fuzz_mill,
        words: include_str!("words-mill.txt"),
    },
    FuzzTarget {
        name: "cycles",
        run: cycles::fuzz_cycles,
        words: include_str!("words-cycles.txt"),
    },
    FuzzTarget {
        name: "simulation",
        run: simulation::fuzz_simulation,
        words: PROGRAM_WORDS,
    },
    FuzzTarget {
        name: "script",
        run: script::fuzz_script,
        words: include_str!("words-script.txt"),
    },
    FuzzTarget {
        name: "ladder",
        run: ladder::fuzz_ladder,
        words: include_str!("words-ladder.txt"),
    },
    FuzzTarget {
        name: "link",
        run: link::fuzz_line_link,
        words: include_str!("words-link.txt"),
    },
    FuzzTarget {
        name: "step_link",
        run: step_link::fuzz_step_link,
        words: "",
    },
];

/// Returns the target with this name; `None` if there is none.
pub fn find_target(name: &str) -> Option<&'static FuzzTarget> {
    TARGETS.iter().find(|target| target.name == name)
}
