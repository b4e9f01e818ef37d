//! The platform code of Linux, macOS and other Unix systems.

mod clock;
mod desktop;
#[cfg(not(target_os = "macos"))]
mod display;
mod files;
#[cfg(target_os = "macos")]
mod no_display;
#[cfg(not(target_os = "macos"))]
mod portal;
mod process;
mod serial;
mod sound;
mod tie;

pub use clock::{shared_time, time_with_sleep};
pub use desktop::{file_dialog_answers, has_display, leave_console};
#[cfg(not(target_os = "macos"))]
pub use display::{DisplayServer, display_server, watch_display};
pub use files::{for_owner_alone, is_device, is_serial_port, same_file};
#[cfg(target_os = "macos")]
pub use no_display::{DisplayServer, display_server, watch_display};
pub use process::{hear_ending, name_process, outlive_ending, own_program, processor_time};
pub use serial::{PULLED, Serial, has_ports, pseudo_terminal, unchanging_names};
pub use sound::{Player, has_sound};
pub use tie::{ToHolder, ToProgram};
