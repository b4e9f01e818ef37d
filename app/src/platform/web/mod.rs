//! A page in a browser: one thread, no files on a disk, no serial ports.

mod clock;
mod desktop;
mod disk;
mod display;
mod download;
mod files;
mod log_file;
mod page;
mod process;
mod serial;
mod sound;
mod tie;
mod turns;
mod view;

pub use clock::{shared_time, time_with_sleep};
pub use desktop::{file_dialog_answers, has_display, leave_console};
pub use disk::{
    Lock, facts, has_folders, is_link, is_taken, lasts, list, make_folder, read, remove,
    remove_folder, rename, sync_folder, write_new,
};
pub use display::{DisplayServer, display_server, watch_display};
pub use files::{is_device, is_serial_port, same_file};
pub use log_file::{LogFile, LogGuard, log_file};
pub use page::{Asked, begin};
pub use process::{
    before_panic, hear_ending, name_process, outlive_ending, own_program, processor_time,
};
pub use serial::{PULLED, Serial, has_ports, pseudo_terminal, unchanging_names};
pub use sound::{Player, has_sound};
pub use tie::{ToHolder, ToProgram};
pub use turns::{LARGEST_LOOK, Turning, answer, beside, receive, turn};
pub use view::{
    choose_file, data_folder, first_word, home_folder, in_use, leave_refusal, open_window,
    sent_folder, take_dropped, tell_screen,
};
