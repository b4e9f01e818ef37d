//! A page in a browser: one thread, no files on a disk, no serial ports.

mod broker_stream;
mod clock;
mod course;
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
mod volumes;

pub use broker_stream::BrokerStream;
pub use clock::{shared_time, time_with_sleep};
pub use course::{course_page, report_course};
pub use desktop::{close_own_console, has_display, has_file_dialog, has_listeners};
pub use disk::{
    Lock, has_folders, is_link, is_persistent, is_taken, list, make_folder, path_facts, read,
    remove, remove_folder, rename, sync_folder, write_new,
};
pub use display::{DisplayServer, display_server, watch_display};
pub use download::{open_page_file, print_page_as_pdf};
pub use files::{is_device, is_serial_port, same_file};
pub use log_file::{LogFile, LogGuard, log_file};
pub use page::{PageParameters, open_page};
pub use process::{
    before_panic, ignore_termination, own_executable, processor_time, register_termination_flag,
    set_process_name,
};
pub use serial::{Serial, UNPLUGGED_ERRORS, has_ports, persistent_names, pseudo_terminal};
pub use sound::{Player, has_sound};
pub use tie::{HolderConnection, ProgramConnection};
pub use turns::{
    LARGEST_PREVIEW, TaskHandle, pause, receive, run_in_background, start_task, wait_for_answer,
};
pub use view::{
    choose_file, close_error_dialog, data_folder, data_folder_in_use, home_folder, open_window,
    publish_screen_text, sent_folder, startup_message, take_dropped,
};
pub use volumes::{mounted_volumes, write_to_drive};
