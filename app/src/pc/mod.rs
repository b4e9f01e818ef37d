//! The PC side of the serial port (manual V) at a port of the computer: for the command
//! `transfer`, and in a thread for the window.

mod error;
pub mod folder;
mod names;
mod remembered;
mod talk;
pub mod worker;

pub use error::{FilesError, PcError};
pub use names::free_name;
pub use remembered::{Item, Remembered, of_window};
pub use talk::{Talk, Traffic, Watch};
