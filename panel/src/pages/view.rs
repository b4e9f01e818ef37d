//! Stores the panel's state that drawing needs beside that of the control.

use gsk_core::program::ProgramEditor;
use gsk_core::units::Axis;
use serde::{Deserialize, Serialize};

use super::graphic_settings::GraphicSettings;
use super::password_entry::PasswordEntry;
use super::taught::TaughtProgram;
use crate::face::{PAGE_COUNT, PageId, STORED_PAGES};
use crate::trace::PathTrace;

/// Duration for which flashing texts are visible, and then invisible, ticks (ms).
pub const FLASH_TICKS: u64 = 500;

/// Number of brightness steps of the LCD.
pub const BRIGHTNESS_STEPS: u8 = 16;

/// Brightness of a new panel, as a step from 0 (darkest) to 15.
pub(crate) const DEFAULT_BRIGHTNESS: u8 = 8;

/// The state of the panel that the pages draw, beside that of the control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PageView {
    /// Ticks (ms) since power-on; determine when texts flash.
    pub ticks: u64,
    /// Brightness of the LCD, 0 (darkest) to 15.
    pub brightness: u8,
    /// Characters in the input line that have not been entered yet.
    pub input: String,
    /// The axis whose letter flashes on the relative page after key U or W; `None` if none
    /// does.
    pub flashing: Option<Axis>,
    /// Whether the position pages show the spindle override instead of the rapid override (转换).
    pub spindle_override: bool,
    /// The cursor of each page of the LCD.
    pub cursors: PageCursors,
    /// The program editor: text, cursor and mode.
    pub editor: EditorState,
    /// Index of the screen of 36 programs that the directory page shows, from 0.
    pub directory_screen: usize,
    /// The digits typed on the password page, and its response.
    pub password: PasswordEntry,
    /// Whether the last operation on the electronic disk was permitted; `None` if there was
    /// none since the page was opened.
    pub disk_done: Option<bool>,
    /// Settings of the graphic page: plane, scale, centre, extents.
    pub graphic: GraphicSettings,
    /// The tool path that the graphic page draws.
    pub trace: PathTrace,
    /// State of serial communication that the status row shows.
    pub communication: Communication,
    /// The program that is taught by moving the axes.
    #[serde(default)]
    pub teaching: TaughtProgram,
    /// Content of the inserted U disk; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub udisk: Option<Udisk>,
    /// Index of the row of soft keys that is shown, from 0.
    #[serde(default, skip_serializing_if = "is_first_bar")]
    pub soft_bar: u8,
}

/// The content of a U disk.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Udisk {
    /// The files on the U disk, by name.
    pub files: Vec<UdiskFile>,
    /// Names of the files that the control has stored and the host has not taken yet.
    pub stored: Vec<String>,
}

/// A file on the U disk.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UdiskFile {
    /// Name of the file without its folder.
    pub name: String,
    /// Content of the file as text.
    pub text: String,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // The signature is that of serde.
const fn is_first_bar(bar: &u8) -> bool {
    *bar == 0
}

impl Default for PageView {
    fn default() -> Self {
        Self {
            ticks: 0,
            brightness: DEFAULT_BRIGHTNESS,
            input: String::new(),
            flashing: None,
            spindle_override: false,
            cursors: PageCursors::default(),
            editor: EditorState::default(),
            directory_screen: 0,
            password: PasswordEntry::default(),
            disk_done: None,
            graphic: GraphicSettings::default(),
            trace: PathTrace::default(),
            communication: Communication::Idle,
            teaching: TaughtProgram::default(),
            udisk: None,
            soft_bar: 0,
        }
    }
}

impl PageView {
    /// Returns whether flashing texts are currently visible.
    pub(crate) const fn flash_on(&self) -> bool {
        (self.ticks / FLASH_TICKS).is_multiple_of(2)
    }
}

/// The cursor of one page with items.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PageCursor {
    /// The selected item, from 0. The page shows the screen that contains it.
    pub item: usize,
    /// The selected bit of the item, 0 to 7, on pages with bits.
    pub bit: u8,
    /// Whether `转换` has switched the page to entering single bits.
    pub bit_entry: bool,
}

/// The cursor of each page, in the order of [`PageId`]. A recording stores those of the GSK980TD's
/// pages, and the others only if one has moved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<PageCursor>", into = "Vec<PageCursor>")]
pub struct PageCursors([PageCursor; PAGE_COUNT]);

impl From<Vec<PageCursor>> for PageCursors {
    fn from(stored: Vec<PageCursor>) -> Self {
        let mut cursors = Self::default();
        for (cursor, stored) in cursors.0.iter_mut().zip(stored) {
            *cursor = stored;
        }
        cursors
    }
}

impl From<PageCursors> for Vec<PageCursor> {
    fn from(cursors: PageCursors) -> Self {
        let moved = cursors.0[STORED_PAGES..]
            .iter()
            .any(|cursor| *cursor != PageCursor::default());
        let count = if moved { PAGE_COUNT } else { STORED_PAGES };
        cursors.0[..count].to_vec()
    }
}

impl Default for PageCursors {
    /// Returns cursors on the first item, but on the second item of the password page.
    fn default() -> Self {
        let mut cursors = Self([PageCursor::default(); PAGE_COUNT]);
        cursors.get_mut(PageId::Password).item = 1;
        cursors
    }
}

impl PageCursors {
    /// Returns a copy of a page's cursor.
    pub const fn get(&self, page: PageId) -> PageCursor {
        self.0[page as usize]
    }

    /// Returns a page's cursor, to move it.
    pub const fn get_mut(&mut self, page: PageId) -> &mut PageCursor {
        &mut self.0[page as usize]
    }
}

/// The state of the program editor: text, cursor and mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EditorState {
    /// The text in the editor with its cursor. `None` shows the stored program at the
    /// control's cursor.
    pub editing: Option<ProgramEditor>,
    /// Whether alter mode is on (inverse cursor) instead of insert mode (bar).
    pub alter: bool,
    /// Whether `转换` has started a search, which changes the prompt of the input line.
    pub searching: bool,
}

/// The state of the serial port in the status row (manual III-9.8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Communication {
    /// No transfer and no error; the status row shows nothing.
    #[default]
    Idle,
    /// The control is receiving a file.
    Receiving,
    /// The control is sending a file. The text flashes.
    Sending,
    /// No partner answers, or the baud rate is too low.
    NotConnected,
    /// The file could not be received, or the connection was lost during a transfer.
    Failed,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recordings of the GSK980TD keep their form, and old ones are read.
    #[test]
    fn cursors_of_other_models_are_stored_only_when_moved() {
        let mut cursors = PageCursors::default();
        cursors.get_mut(PageId::Dgn).item = 7;
        let stored = Vec::from(cursors.clone());
        assert_eq!(stored.len(), STORED_PAGES);
        assert_eq!(PageCursors::from(stored), cursors);
        cursors.get_mut(PageId::Outputs).item = 3;
        let stored = Vec::from(cursors.clone());
        assert_eq!(stored.len(), PAGE_COUNT);
        assert_eq!(PageCursors::from(stored), cursors);
    }
}
