//! The PC side of the serial port (manual V) at a port of the computer: for the command
//! `transfer`, and in a thread for the window.

mod error;
pub mod folder;
mod ladder;
mod names;
mod session;
mod transfer_settings;
pub mod worker;

pub use error::{FilesError, PcError};
pub use ladder::{read_ladder, send_ladder};
pub use names::free_name;
pub use session::{TransferObserver, TransferSession, TransferTotals};
pub use transfer_settings::{SendListItem, TransferSettings, load_window_settings};
pub use worker::port_names;
