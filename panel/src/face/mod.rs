//! Stores the faces of the control models as data: colours of the LCD, keys with their legends
//! and positions, pages and soft keys. Drawing, pointer, keys and lists read them from here;
//! no other code depends on the model for them.

mod contacts;
mod geometry;
mod gsk980td;
mod hx31;
mod ncb08;
mod pages;

pub use contacts::{ContactMeaning, ContactRow};
pub use geometry::{PanelColour, Rect};
use gsk_core::model::ModelId;
use gsk_messages::Message;
pub(crate) use pages::{PAGE_COUNT, STORED_PAGES, page_names};
pub use pages::{PAGES, PageId, PageKey, PageRow};

use crate::keys::{Key, KeyRole, KeyRow};
use crate::lcd::LcdColours;

/// Space between two keys, panel units.
pub const GAP: f32 = 6.0;

/// The panel of a control model: its LCD colours, keys, pages and labels.
#[derive(Debug)]
pub struct Face {
    /// The maker's name on the self-test picture; `None` if the manual of the model has none.
    pub maker: Option<fn() -> Message>,
    /// The name and version of the software that the directory shows.
    pub version: &'static str,
    /// The type of the control on the page of versions.
    pub product: &'static str,
    /// Versions of software and hardware on the page of versions; `None` if the manual of the model
    /// has none.
    pub versions: Option<(&'static str, &'static str)>,
    /// The heading of the remaining distances on the position pages.
    pub to_go: fn() -> Message,
    /// Colours of the LCD at full brightness.
    pub lcd: LcdColours,
    /// The keys on the panel, by size and position. Emergency stop and overtravel release are on
    /// every panel.
    pub grids: &'static [KeyGrid],
    /// Rows of keys whose legend or name differs from the key table.
    pub printed: &'static [KeyRow],
    /// The pages that the LCD has, in the order of the page-up and page-down keys.
    pub pages: &'static [PageRow],
    /// The soft keys below the LCD; empty for a model without them.
    pub soft_keys: &'static [SoftKey],
    /// The inputs of the model, from number 0; empty if it has no page of them.
    pub inputs: &'static [ContactRow],
    /// The outputs of the model, from number 0; empty if it has no page of them.
    pub outputs: &'static [ContactRow],
    /// Signals of outputs that no output has as delivered, by the number in their parameters.
    pub spare_signals: &'static [(u32, ContactMeaning)],
}

/// Keys of one size and colour, in rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct KeyGrid {
    /// Position and size of the first key of the grid, panel units.
    pub first: Rect,
    /// The keys of each row, from the left.
    pub rows: &'static [&'static [Key]],
    /// The colour of the keys in the grid.
    pub colour: PanelColour,
}

/// A label in the row of soft keys, and the action of its key.
#[derive(Clone, Copy, Debug)]
pub struct SoftKey {
    /// The main function whose row of soft keys has the label.
    pub group: PageKey,
    /// Index of the row of soft keys in the main function, from 0.
    pub bar: u8,
    /// Position of the soft key in its row, 0 (F1) to 4 (F5).
    pub position: u8,
    /// The text of the soft key's label, at most six columns wide.
    pub label: fn() -> Message,
    /// The action that the soft key triggers.
    pub action: SoftAction,
}

/// The action that a soft key triggers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftAction {
    /// Opens a page. On that page it steps through the pages of its display.
    Open(PageId),
    /// Also stores the selected program under the typed number.
    CopyProgram,
    /// Gives the selected program the typed number.
    RenameProgram,
    /// Shows the next row of soft keys of the main function.
    NextBar,
}

/// Returns the panel of a control model. For the mill it is that of the GSK980TD, because mill
/// panels are not simulated.
pub const fn face_of(model: ModelId) -> &'static Face {
    match model {
        ModelId::Gsk980td | ModelId::Gsk980mdi => &gsk980td::FACE,
        ModelId::Hx31 => &hx31::FACE,
        ModelId::Ncb08 => &ncb08::FACE,
    }
}

/// Returns the row of a page by its name on the command line, of the first model that has it;
/// `None` if no model has it.
pub fn find_page(name: &str) -> Option<&'static PageRow> {
    let mut faces = ModelId::ALL.into_iter().map(face_of);
    faces.find_map(|face| face.page_named(name))
}

impl Face {
    /// Returns the row of a key of this panel; `None` if the panel has no such key.
    pub fn key(&self, key: Key) -> Option<&'static KeyRow> {
        if let Some(row) = self.printed.iter().find(|row| row.key == key) {
            return Some(row);
        }
        let row = key.row();
        let round = matches!(
            row.role,
            KeyRole::EmergencyStop | KeyRole::OvertravelRelease
        );
        let mut keys = self.grids.iter().flat_map(|grid| grid.rows).copied();
        (round || keys.any(|keys| keys.contains(&key))).then_some(row)
    }

    /// Returns the rows of the keys on this panel, in the order of [`Key`].
    pub fn keys(&self) -> impl Iterator<Item = &'static KeyRow> + '_ {
        crate::keys::all_rows().filter_map(|row| self.key(row.key))
    }

    /// Returns the row of a page of this model; `None` if the model has no such page.
    pub fn page(&self, page: PageId) -> Option<&'static PageRow> {
        self.pages.iter().find(|row| row.page == page)
    }

    /// Returns the page with this name on the command line; `None` if the model has none.
    pub fn page_named(&self, name: &str) -> Option<&'static PageRow> {
        let mut rows = self.pages.iter();
        rows.find(|row| row.name.eq_ignore_ascii_case(name))
    }

    /// Returns the next (`forward`) or previous page of the same display, wrapping at both
    /// ends.
    pub(crate) fn neighbour(&self, page: PageId, forward: bool) -> PageId {
        let Some(own) = self.page(page) else {
            return page;
        };
        let group: Vec<PageId> = self
            .pages
            .iter()
            .filter(|row| row.key == own.key && row.display == own.display)
            .map(|row| row.page)
            .collect();
        let at = group.iter().position(|it| *it == page).unwrap_or(0);
        let step = if forward { 1 } else { group.len() - 1 };
        group[(at + step) % group.len()]
    }

    /// Returns the first page of a display (from 0) that a page key opens. A display number
    /// beyond the last one continues with the first.
    pub fn first_of(&self, key: PageKey, display: u8) -> PageId {
        let own = || self.pages.iter().filter(|row| row.key == key);
        let displays = own().map(|row| row.display).max();
        let displays = displays.map_or(1, |last| last + 1);
        own()
            .find(|row| row.display == display % displays)
            .map_or(PageId::PosRel, |row| row.page)
    }

    /// Returns the labels of a row of soft keys of a main function, from left to right; empty if
    /// there is no such row.
    pub fn soft_bar(&self, group: PageKey, bar: u8) -> impl Iterator<Item = &'static SoftKey> {
        let keys = self.soft_keys.iter();
        keys.filter(move |key| key.group == group && key.bar == bar)
    }

    /// Returns the number of rows of soft keys of a main function, at least 1.
    pub(crate) fn soft_bars(&self, group: PageKey) -> u8 {
        let keys = self.soft_keys.iter().filter(|key| key.group == group);
        keys.map(|key| key.bar + 1).max().unwrap_or(1)
    }
}

#[cfg(test)]
mod tests;
