//! Stores the panel's state that drawing needs beside that of the control.

use gsk_core::program::ProgramEditor;
use gsk_core::units::Axis;
use serde::{Deserialize, Serialize};

use super::graphic_settings::GraphicSettings;
use super::password_entry::PasswordEntry;
use super::table::{PAGE_COUNT, PageId};
use super::taught::TaughtProgram;
use crate::trace::PathTrace;

/// Half a period of flashing, ticks.
pub const FLASH_TICKS: u64 = 500;

/// Steps of the LCD's brightness.
pub const BRIGHTNESS_STEPS: u8 = 16;

/// Brightness of a new panel.
pub(crate) const DEFAULT_BRIGHTNESS: u8 = 8;

/// The state of the panel that pages show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PageView {
    /// Ticks since power-on, the phase of flashing.
    pub ticks: u64,
    /// Brightness, 0 (darkest) to 15.
    pub brightness: u8,
    /// Characters typed but not committed.
    pub input: String,
    /// The axis whose letter flashes on the relative page after U or W.
    pub flashing: Option<Axis>,
    /// Whether the position pages show the spindle override instead of the rapid override (转换).
    pub spindle_override: bool,
    /// Cursors of the list pages.
    pub cursors: PageCursors,
    /// The program editor.
    pub editor: EditorState,
    /// The screen of 36 programs that the directory shows, from 0.
    pub directory_screen: usize,
    /// The input of the password page.
    pub password: PasswordEntry,
    /// Whether the last operation on an electronic disk succeeded.
    pub disk_done: Option<bool>,
    /// Settings of the graphic page.
    pub graphic: GraphicSettings,
    /// The path drawn on the graphic page.
    pub trace: PathTrace,
    /// State of serial communication in the status row.
    pub communication: Communication,
    /// Points taught by hand.
    #[serde(default)]
    pub teaching: TaughtProgram,
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
        }
    }
}

impl PageView {
    /// Returns whether flashing texts are visible now.
    pub(crate) const fn flash_on(&self) -> bool {
        (self.ticks / FLASH_TICKS).is_multiple_of(2)
    }
}

/// The cursor of a list page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PageCursor {
    /// The selected item, from 0. Its screen is shown.
    pub item: usize,
    /// The selected bit, on pages with bits.
    pub bit: u8,
    /// Whether `转换` selected the entry of single bits.
    pub bit_entry: bool,
}

/// A cursor for each page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PageCursors([PageCursor; PAGE_COUNT]);

impl Default for PageCursors {
    /// Every cursor is on the first item, but on the second of the password page.
    fn default() -> Self {
        let mut cursors = Self([PageCursor::default(); PAGE_COUNT]);
        cursors.get_mut(PageId::Password).item = 1;
        cursors
    }
}

impl PageCursors {
    /// Returns the cursor of a page.
    pub const fn get(&self, page: PageId) -> PageCursor {
        self.0[page as usize]
    }

    /// Returns the cursor of a page for moving.
    pub const fn get_mut(&mut self, page: PageId) -> &mut PageCursor {
        &mut self.0[page as usize]
    }
}

/// The state of the program editor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EditorState {
    /// Text and cursor. `None` shows the stored program at the control's cursor.
    pub editing: Option<ProgramEditor>,
    /// Whether alter mode (inverse cursor) is on instead of insert mode (bar).
    pub alter: bool,
    /// Whether `转换` has started a search, which changes the prompt.
    pub searching: bool,
}

/// The state of the serial port in the status row (manual III-9.8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Communication {
    /// Nothing is shown.
    #[default]
    Idle,
    /// Receiving.
    Receiving,
    /// Sending. The text flashes.
    Sending,
    /// The connection failed.
    NotConnected,
    /// The connection was lost during a transfer.
    Failed,
}
