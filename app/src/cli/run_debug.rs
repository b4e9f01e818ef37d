//! Options of `run` that stop, watch and record a run.

use std::path::PathBuf;

use clap::Args;

/// Breakpoints, watches and traces of `run`.
#[derive(Args, Debug)]
pub struct RunDebugArgs {
    /// Report each time the run reaches this event: a line (12, sub.CNC:12, O12:3), a block (N50),
    /// a program (O12), alarm, message, collision, pass, tick 5000, or the change of a value (#100,
    /// X, Y1.2, P22, T1.X), or a comparison of it with =, <>, <, <=, >, >= and a number; a
    /// condition may follow: if #100 GT 5
    #[arg(long = "break", value_name = "WHERE")]
    pub break_at: Vec<String>,
    /// Add this value to each report of --break and --until: #100, X, Z, XM, ZM, G, M, F, S, T,
    /// feed, spindle, angle, Y1.2, P22, T1.X
    #[arg(long, value_name = "WHAT")]
    pub watch: Vec<String>,
    /// End the run when it reaches this, written as for --break
    #[arg(long, value_name = "WHERE")]
    pub until: Option<String>,
    /// Write values of every millisecond (name ends in .csv, .vcd or .mcap)
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// The values of the trace, separated by commas, written as for --watch [default:
    /// XM,ZM,X,Z,feed,spindle,angle,line]
    #[arg(long, value_name = "LIST", requires = "trace")]
    pub signals: Option<String>,
    /// Begin the trace when the run reaches this, written as for --break
    #[arg(long, value_name = "WHERE", requires = "trace")]
    pub trace_from: Option<String>,
    /// Stop at the first collision of the simulated lathe (exit code 3)
    #[arg(long, conflicts_with = "link")]
    pub stop_on_collision: bool,
}
