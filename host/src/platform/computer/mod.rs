//! What Linux and Windows share and a page in a browser does differently.

mod broker_stream;
mod browser;
mod course;
mod disk;
mod log_file;
mod panic;
mod tls;
mod turns;
mod view;

pub use broker_stream::BrokerStream;
pub use browser::{open_page_file, print_page_as_pdf};
pub use course::{course_page, report_course};
pub use disk::{
    Lock, has_folders, is_link, is_persistent, is_taken, list, make_folder, path_facts, read,
    remove, remove_folder, rename, sync_folder, write_new, write_to_drive,
};
pub use log_file::{LogFile, LogGuard, log_file};
pub use panic::before_panic;
pub use turns::{
    LARGEST_PREVIEW, TaskHandle, pause, receive, run_in_background, start_task, wait_for_answer,
};
pub use view::{
    choose_file, close_error_dialog, data_folder, data_folder_in_use, home_folder, open_window,
    publish_screen_text, sent_folder, startup_message, take_dropped,
};
