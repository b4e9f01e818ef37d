//! The platform code of Windows.

mod clock;
mod desktop;
mod display;
mod files;
mod process;
mod serial;
mod sound;
mod tie;

pub use clock::{shared_time, time_with_sleep};
pub use desktop::{file_dialog_answers, has_display, leave_console};
pub use display::{DisplayServer, display_server, watch_display};
pub use files::{for_owner_alone, is_device, is_serial_port, same_file};
pub use process::{hear_ending, name_process, outlive_ending, own_program, processor_time};
pub use serial::{PULLED, Serial, has_ports, pseudo_terminal, unchanging_names};
pub use sound::{Player, has_sound};
pub use tie::{ToHolder, ToProgram};
