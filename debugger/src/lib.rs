//! Stops a running control at blocks, alarms and values, steps it forwards and backwards,
//! and writes its signals as traces. The state of the debugger is separate from the state of
//! the machine: a breakpoint stays armed when the machine goes back in time.
//!
//! ```text
//!   location, condition --> BreakpointSet --hits--> DebugSession <-- steps
//!   value of the control <-- WatchTarget             |      |
//!                                                    |   StateHistory
//!   TraceWriter <-- WatchTarget                  DebuggedRun: machine, part, keys
//! ```

pub mod breakpoints;
pub mod call_stack;
pub mod debugged_run;
pub mod history;
pub mod location;
pub mod session;
pub mod source_files;
pub mod trace;
pub mod watch;
