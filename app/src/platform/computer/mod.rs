//! What Linux and Windows share and a page in a browser does differently.

mod disk;
mod log_file;
mod panic;
mod turns;
mod view;

pub use disk::{
    Lock, facts, has_folders, is_link, is_taken, lasts, list, make_folder, read, remove,
    remove_folder, rename, sync_folder, write_new,
};
pub use log_file::{LogFile, LogGuard, log_file};
pub use panic::before_panic;
pub use turns::{LARGEST_LOOK, Turning, answer, beside, receive, turn};
pub use view::{
    choose_file, data_folder, first_word, home_folder, in_use, leave_refusal, open_window,
    sent_folder, take_dropped, tell_screen,
};
