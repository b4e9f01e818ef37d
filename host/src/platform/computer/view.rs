//! The window on the desktop, and file dialogs.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, DroppedFileHandle, ViewportBuilder, ViewportCommand};
use eframe::{AppCreator, NativeOptions};
use gsk_messages::{Message, say};

use super::super::FileDialog;

/// The icon of the program, a PNG.
const ICON: &[u8] = include_bytes!("../../../../assets/icon/gsk980td.png");

/// Opens a window and returns when it is closed.
///
/// # Errors
/// The system opens no window.
pub fn open_window(
    name: &str,
    viewport: ViewportBuilder,
    application: AppCreator<'static>,
) -> Result<(), Message> {
    // With an unreadable icon the library shows its own.
    let viewport = match eframe::icon_data::from_png_bytes(ICON) {
        Ok(icon) => viewport.with_icon(icon),
        Err(_) => viewport,
    };
    let options = NativeOptions {
        viewport,
        centered: true,
        // Exact pixels: the panel has no gradients. It is a quarter of the time of a frame that
        // the processor draws.
        dithering: false,
        ..NativeOptions::default()
    };
    eframe::run_native(name, options, application).map_err(say::window_cannot_be_opened)
}

/// Returns the system's data folder for an application of this name; `None` if the system has
/// none.
pub fn data_folder(name: &str) -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", name)?;
    Some(folders.data_dir().to_owned())
}

/// Returns the message that another process holds the data folder `path`.
pub fn data_folder_in_use(path: &Path) -> Message {
    say::data_dir_in_use(path.display())
}

/// Returns `None`: on a computer the window shows no message first.
pub const fn startup_message() -> Option<Message> {
    None
}

/// Returns the user's home folder; `None` if the user has none.
pub fn home_folder() -> Option<PathBuf> {
    let folders = directories::BaseDirs::new()?;
    Some(folders.home_dir().to_owned())
}

/// Returns the folder `name` in the data folder, for files that the control sends.
pub fn sent_folder(data: &Path, name: &str) -> PathBuf {
    data.join(name)
}

/// Shows the desktop's file dialog and passes the chosen path to `then`. A cancelled dialog
/// does nothing.
pub fn choose_file(dialog: FileDialog, then: impl FnOnce(PathBuf) + Send + 'static) {
    let desktop = rfd::FileDialog::new();
    let chosen_path = match dialog {
        FileDialog::Open { kind, endings, all } => {
            let upper: Vec<String> = endings.iter().map(|it| it.to_ascii_uppercase()).collect();
            let all_endings: Vec<&str> = endings
                .iter()
                .copied()
                .chain(upper.iter().map(String::as_str))
                .collect();
            desktop
                .add_filter(kind, &all_endings)
                .add_filter(all, &["*"])
                .pick_file()
        }
        FileDialog::Folder => desktop.pick_folder(),
        FileDialog::Save { name, ending } => desktop
            .set_file_name(name)
            .add_filter(ending, &[ending])
            .save_file(),
    };
    if let Some(path) = chosen_path {
        then(path);
    }
}

/// Passes the first of the files dropped on the window to `then`.
pub fn take_dropped(files: &[DroppedFileHandle], then: impl FnOnce(PathBuf) + 'static) {
    if let Some(file) = files.first() {
        then(file.path().to_owned());
    }
}

/// Closes the window, whose error dialog the user has closed.
pub fn close_error_dialog(context: &Context) {
    context.send_viewport_cmd(ViewportCommand::Close);
}

/// Does nothing: screen readers use the accessibility tree of the window.
pub fn publish_screen_text(_text: impl FnOnce() -> String) {}
