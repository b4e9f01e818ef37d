//! Ports lathe programs of other controls to this one: Fanuc, Haas, Fusion 360, Mach3 and
//! LinuxCNC. Each code and word becomes what has the same meaning here, or a reason why not.
//! Comments, sequence numbers and layout are kept.
//!
//! ```
//! use gsk_port::{ForeignDialect, PortOptions, port_program};
//!
//! let foreign = "G21 G99\nG71 P10 Q20 U0.4 W0.1 D2000 F0.2\n";
//! let ported = port_program(foreign, ForeignDialect::Fanuc10t, PortOptions::default());
//! assert_eq!(
//!     ported.text,
//!     "G99\nG71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2\n"
//! );
//! ```

mod angle;
mod block;
mod calls;
mod canned;
mod corner;
mod cycles;
mod detect;
mod dialect;
mod drilling;
mod machine_codes;
mod motion;
mod needs;
mod number;
mod o_words;
mod porter;
mod program_numbers;
mod single_codes;
mod source;
mod state;
mod table;
#[cfg(test)]
mod tests;
mod thread_cycles;

pub use detect::{DialectGuess, guess_dialect};
pub use dialect::{CodeSet, ForeignDialect, PlainNumbers, PortFinding, PortOptions};
pub use needs::MachineNeeds;
pub use porter::{PortedProgram, port_program};
pub use table::code_table;
