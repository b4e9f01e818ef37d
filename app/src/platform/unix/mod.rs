//! Linux and its kin.

mod desktop;
mod files;
#[cfg(not(target_os = "macos"))]
mod portal;
mod process;
mod serial;
mod sound;
mod tie;

pub use desktop::{file_dialog_answers, has_display, leave_console};
pub use files::{for_owner_alone, is_device, is_serial_port, same_file};
pub use process::{hear_ending, name_process, outlive_ending, own_program, processor_time};
pub use serial::{PULLED, Serial, has_ports, pseudo_terminal, unchanging_names};
pub use sound::{Player, has_sound};
pub use tie::{ToHolder, ToProgram};
