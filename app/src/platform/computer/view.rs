//! The window on the desktop, and the dialogs for files.

use std::path::{Path, PathBuf};

use eframe::egui::{Context, DroppedFileHandle, ViewportBuilder, ViewportCommand};
use eframe::{AppCreator, NativeOptions};
use gsk_messages::{Message, say};

use super::super::FileDialog;

/// What stands for the program in lists of windows.
const ICON: &[u8] = include_bytes!("../../../../assets/icon/gsk980td.png");

/// Opens a window and returns when it is closed.
///
/// # Errors
/// The system opens none.
pub fn open_window(
    name: &str,
    viewport: ViewportBuilder,
    application: AppCreator<'static>,
) -> Result<(), Message> {
    // A picture that cannot be read leaves the one of the library.
    let viewport = match eframe::icon_data::from_png_bytes(ICON) {
        Ok(icon) => viewport.with_icon(icon),
        Err(_) => viewport,
    };
    let options = NativeOptions {
        viewport,
        centered: true,
        ..NativeOptions::default()
    };
    eframe::run_native(name, options, application).map_err(say::window_cannot_be_opened)
}

/// The system's own folder for data of this name; some have none.
pub fn data_folder(name: &str) -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", name)?;
    Some(folders.data_dir().to_owned())
}

/// What is said when another process has the folder of the data.
pub fn in_use(path: &Path) -> Message {
    say::data_dir_in_use(path.display())
}

/// What is to be said before all else; here there is nothing.
pub const fn first_word() -> Option<Message> {
    None
}

/// The user's own folder; some have none.
pub fn home_folder() -> Option<PathBuf> {
    let folders = directories::BaseDirs::new()?;
    Some(folders.home_dir().to_owned())
}

/// Where files go that the control sends, in the folder of its data.
pub fn sent_folder(data: &Path, name: &str) -> PathBuf {
    data.join(name)
}

/// Shows the desktop's dialog and waits; what is chosen goes to `then`. Giving up is
/// silent.
pub fn choose_file(dialog: FileDialog, then: impl FnOnce(PathBuf) + Send + 'static) {
    let desktop = rfd::FileDialog::new();
    let chosen = match dialog {
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
    if let Some(path) = chosen {
        then(path);
    }
}

/// The first of the files that were dropped on the window goes to `then`.
pub fn take_dropped(files: &[DroppedFileHandle], then: impl FnOnce(PathBuf) + 'static) {
    if let Some(file) = files.first() {
        then(file.path().to_owned());
    }
}

/// A dialog in place of the window is closed.
pub fn leave_refusal(context: &Context) {
    context.send_viewport_cmd(ViewportCommand::Close);
}

/// What stands on the LCD, for those who do not see it; a computer has the accessibility
/// tree for them.
pub fn tell_screen(_text: impl FnOnce() -> String) {}
