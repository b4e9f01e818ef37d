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
mod volumes;

pub use clock::{shared_time, time_with_sleep};
pub use desktop::{
    browser_candidates, close_own_console, has_display, has_file_dialog, has_listeners,
    open_file_command,
};
#[cfg(not(target_os = "macos"))]
pub use display::{DisplayServer, display_server, watch_display};
pub use files::{for_owner_alone, is_device, is_serial_port, same_file};
#[cfg(target_os = "macos")]
pub use no_display::{DisplayServer, display_server, watch_display};
pub use process::{
    ignore_termination, own_executable, processor_time, register_termination_flag, set_process_name,
};
pub use serial::{Serial, UNPLUGGED_ERRORS, has_ports, persistent_names, pseudo_terminal};
pub use sound::{Player, has_sound};
pub use tie::{HolderConnection, ProgramConnection};
pub use volumes::mounted_volumes;
