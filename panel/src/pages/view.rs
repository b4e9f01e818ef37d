//! What drawing needs to know of the panel besides the control's own state.

use gsk_core::program::Editing;
use gsk_core::units::Axis;
use serde::{Deserialize, Serialize};

use super::graphic_settings::GraphicSettings;
use super::password_entry::PasswordEntry;
use super::table::{PAGE_COUNT, PageId};
use super::taught::Teaching;
use crate::trace::Trace;

/// Ticks of one half of a flashing period.
pub const FLASH_TICKS: u64 = 500;

/// Steps of the LCD's brightness.
pub const BRIGHTNESS_STEPS: u8 = 16;

/// Brightness of a new panel.
pub(crate) const DEFAULT_BRIGHTNESS: u8 = 8;

/// The panel's part of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Ticks since power-on: the phase of everything that flashes.
    pub ticks: u64,
    /// Brightness, 0 (darkest) to 15.
    pub brightness: u8,
    /// Characters keyed in and not yet committed.
    pub input: String,
    /// The axis whose letter flashes on the relative page (U or W was pressed).
    pub flashing: Option<Axis>,
    /// Whether the position pages show the spindle override in place of the
    /// rapid override (转换).
    pub spindle_override: bool,
    /// Cursors of the list pages.
    pub cursors: Cursors,
    /// The program editor.
    pub editor: Editor,
    /// Which 36 programs the directory shows, from 0.
    pub directory_screen: usize,
    /// What is keyed in on the password page.
    pub password: PasswordEntry,
    /// How the last operation with an electronic disk ended.
    pub disk_done: Option<bool>,
    /// Settings of the graphic.
    pub graphic: GraphicSettings,
    /// The path drawn on the graphic page.
    pub trace: Trace,
    /// Serial communication, as the status row shows it.
    pub communication: Communication,
    /// Points taught by hand.
    #[serde(default)]
    pub teaching: Teaching,
}

impl Default for View {
    fn default() -> Self {
        Self {
            ticks: 0,
            brightness: DEFAULT_BRIGHTNESS,
            input: String::new(),
            flashing: None,
            spindle_override: false,
            cursors: Cursors::default(),
            editor: Editor::default(),
            directory_screen: 0,
            password: PasswordEntry::default(),
            disk_done: None,
            graphic: GraphicSettings::default(),
            trace: Trace::default(),
            communication: Communication::Idle,
            teaching: Teaching::default(),
        }
    }
}

impl View {
    /// Whether flashing texts are visible now.
    pub(crate) const fn flash_on(&self) -> bool {
        (self.ticks / FLASH_TICKS).is_multiple_of(2)
    }
}

/// The cursor of one list page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cursor {
    /// The item it stands on, from 0; the screen that holds it is shown.
    pub item: usize,
    /// The bit it stands on, on pages with bits.
    pub bit: u8,
    /// Whether `转换` chose entry of single bits.
    pub bit_entry: bool,
}

/// One cursor for each page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cursors([Cursor; PAGE_COUNT]);

impl Default for Cursors {
    /// Every cursor on the first item, on the password page on the second.
    fn default() -> Self {
        let mut cursors = Self([Cursor::default(); PAGE_COUNT]);
        cursors.get_mut(PageId::Password).item = 1;
        cursors
    }
}

impl Cursors {
    /// The cursor of a page.
    pub const fn get(&self, page: PageId) -> Cursor {
        self.0[page as usize]
    }

    /// The cursor of a page, to be moved.
    pub const fn get_mut(&mut self, page: PageId) -> &mut Cursor {
        &mut self.0[page as usize]
    }
}

/// The program editor as it is seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Editor {
    /// Text and cursor; `None` shows the stored program at the control's cursor.
    pub editing: Option<Editing>,
    /// Alter mode (inverse cursor) instead of insert mode (bar).
    pub alter: bool,
    /// Search state of `转换`: the prompt changes.
    pub searching: bool,
}

/// What the status row says about the serial port (manual III-9.8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Communication {
    /// Nothing to say.
    #[default]
    Idle,
    /// Receiving.
    Receiving,
    /// Sending; flashes.
    Sending,
    /// The link could not be made.
    NotConnected,
    /// The link broke during a transfer.
    Failed,
}
