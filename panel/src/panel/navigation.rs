//! Selects pages, and moves the cursor on list pages (manual III-1.2.5).

use gsk_core::cnc::{Cnc, ControlRequest};

use super::{Panel, page_group};
use crate::face::face_of;
use crate::keys::Key;
use crate::pages::{self, PageId, PageKey};

/// Number of tool offsets and of diagnosis bytes in their lists.
const OFFSETS: usize = 33;
const DIAGNOSES: usize = 128;

impl Panel {
    /// Selects a page, and clears the input line of the page before.
    pub(super) fn go_to(&mut self, page: PageId, cnc: &Cnc) {
        let face = face_of(cnc.model().id());
        let Some(row) = face.page(page).filter(|_| page != self.page) else {
            return;
        };
        if face
            .page(self.page)
            .is_none_or(|shown| shown.key != row.key)
        {
            self.view.soft_bar = 0;
        }
        self.page = page;
        self.clear_input();
        self.view.flashing = None;
        if page == PageId::Password {
            // The cursor starts on the row of the password.
            self.view.cursors.get_mut(page).item = 1;
        }
        self.view.disk_done = None;
        let slot = match row.key {
            PageKey::Pos => 0,
            PageKey::Prg => 1,
            PageKey::Oft => 2,
            PageKey::Alm => 3,
            _ => return,
        };
        self.last_shown[slot] = page;
    }

    /// Handles a page key. POS, PRG, OFT and ALM open the last page of their group. SET, PAR
    /// and DGN open their first display, and step through the displays when pressed again. A
    /// main function opens its first page and its first bar of soft keys.
    pub(super) fn page_key(&mut self, key: Key, cnc: &Cnc) {
        let Some(group) = page_group(key) else {
            return;
        };
        let face = face_of(cnc.model().id());
        let shown = face.page(self.page).filter(|shown| shown.key == group);
        let page = match (group, shown) {
            (PageKey::Pos | PageKey::Prg | PageKey::Oft | PageKey::Alm, Some(_)) => return,
            (PageKey::Pos, None) => self.last_shown[0],
            (PageKey::Prg, None) if cnc.mode().edits() => PageId::Prg,
            (PageKey::Prg, None) => self.last_shown[1],
            (PageKey::Oft, None) => self.last_shown[2],
            (PageKey::Alm, None) => self.last_shown[3],
            // Points are taught by hand; other modes show the graphic first.
            (PageKey::Teach, None) if !pages::teaches(cnc) => face.first_of(group, 1),
            (PageKey::Program | PageKey::Operate | PageKey::Parameter, _) => {
                self.view.soft_bar = 0;
                face.first_of(group, 0)
            }
            (_, None) => face.first_of(group, 0),
            (_, Some(shown)) => face.first_of(group, shown.display + 1),
        };
        self.go_to(page, cnc);
    }

    /// Handles page up and page down: steps through the screens of a page, then to the next
    /// page.
    pub(super) fn turn_page(
        &mut self,
        forward: bool,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        if self.page == PageId::Prg && cnc.mode().edits() {
            self.turn_text_page(forward, cnc, requests);
            return;
        }
        if self.page == PageId::Dir {
            if self.turn_directory(forward, cnc) {
                return;
            }
        } else if let Some(screen) = list_screen(self.page, cnc)
            && let Some(item) = screen.turn(self.view.cursors.get(self.page).item, forward)
        {
            self.view.cursors.get_mut(self.page).item = item;
            return;
        }
        let face = face_of(cnc.model().id());
        let mut next = face.neighbour(self.page, forward);
        // The page of the password is entered while nothing is machined (manual III-2.5.1.4).
        if next == PageId::Password && cnc.rights().check_password().is_err() {
            next = face.neighbour(next, forward);
        }
        self.go_to(next, cnc);
        self.enter(forward, cnc);
    }

    /// Shows the first screen of a page entered forward, and the last screen of one entered
    /// backward.
    fn enter(&mut self, forward: bool, cnc: &Cnc) {
        let page = self.page;
        if page == PageId::Dir {
            let last = pages::directory_screens(cnc) - 1;
            self.view.directory_screen = if forward { 0 } else { last };
        }
        if let Some(list) = list_screen(page, cnc) {
            let item = if forward {
                0
            } else {
                list.start(list.items - 1)
            };
            self.view.cursors.get_mut(page).item = item;
        }
    }

    /// Shows the next or previous screen of the directory. Returns `false` at its end.
    fn turn_directory(&mut self, forward: bool, cnc: &Cnc) -> bool {
        let shown = self.view.directory_screen;
        let last = pages::directory_screens(cnc) - 1;
        let next = if forward {
            Some(shown + 1)
        } else {
            shown.checked_sub(1)
        };
        let Some(next) = next.filter(|next| *next <= last) else {
            return false;
        };
        self.view.directory_screen = next;
        true
    }

    /// Shows the next screen of the directory; after the last the first.
    pub(super) fn next_directory_screen(&mut self, cnc: &Cnc) {
        let screens = pages::directory_screens(cnc);
        self.view.directory_screen = (self.view.directory_screen + 1) % screens;
    }

    /// Moves the cursor of a list page to the next (`forward`) or previous item, wrapping at
    /// both ends.
    pub(super) fn move_item(&mut self, forward: bool, cnc: &Cnc) {
        let items = match (self.page, &self.view.udisk) {
            (PageId::Udisk, Some(disk)) => disk.files.len(),
            _ => item_count(self.page, cnc),
        };
        if items == 0 {
            return;
        }
        let cursor = self.view.cursors.get_mut(self.page);
        let item = cursor.item.min(items - 1);
        let step = if forward { 1 } else { items - 1 };
        cursor.item = (item + step) % items;
    }

    /// Moves the bit cursor to the next higher or lower bit, wrapping at both ends.
    pub(super) fn move_bit(&mut self, next: bool) {
        let cursor = self.view.cursors.get_mut(self.page);
        cursor.bit = (cursor.bit + if next { 1 } else { 7 }) % 8;
    }
}

/// Returns the number of items that the cursor of a page can select; 0 on a page without
/// items.
pub(super) fn item_count(page: PageId, cnc: &Cnc) -> usize {
    match page {
        PageId::Oft => OFFSETS,
        PageId::Macro => cnc.variable_numbers().len(),
        PageId::SetCode | PageId::Password => 4,
        PageId::SetSwitch => 2,
        PageId::GraphPar => 8,
        PageId::ParBit => pages::state_numbers().count(),
        PageId::ParData => pages::data_numbers().count(),
        PageId::Pitch => pages::PITCH_POINTS,
        PageId::Dgn => DIAGNOSES,
        PageId::PlcBits => pages::bit_items(),
        PageId::PlcValues => pages::value_items(),
        PageId::ParModel => pages::model_parameter_numbers(cnc).len(),
        PageId::Inputs => face_of(cnc.model().id()).inputs.len(),
        PageId::Outputs => face_of(cnc.model().id()).outputs.len(),
        _ => 0,
    }
}

/// A page whose list needs several screens.
#[derive(Clone, Copy, Debug)]
struct ListScreen {
    page: PageId,
    size: usize,
    items: usize,
    /// Whether the page has no neighbours in its group, so that paging wraps around within its
    /// list.
    alone: bool,
}

fn list_screen(page: PageId, cnc: &Cnc) -> Option<ListScreen> {
    let size = match page {
        PageId::Oft | PageId::Pitch | PageId::PlcValues | PageId::ParModel => 8,
        PageId::Macro
        | PageId::ParBit
        | PageId::ParData
        | PageId::Dgn
        | PageId::PlcBits
        | PageId::Inputs
        | PageId::Outputs => 16,
        _ => return None,
    };
    let items = item_count(page, cnc).max(1);
    let face = face_of(cnc.model().id());
    let alone = face.neighbour(page, true) == page;
    Some(ListScreen {
        page,
        size,
        items,
        alone,
    })
}

impl ListScreen {
    /// Returns the first item of the screen that shows `item`. Each PLC area starts a new
    /// screen.
    fn start(self, item: usize) -> usize {
        let within = match self.page {
            PageId::PlcBits => usize::from(pages::bit_item(item).byte),
            PageId::PlcValues => usize::from(pages::value_item(item).byte),
            _ => item,
        };
        item - within % self.size
    }

    /// Returns the first item of the next or previous screen. Beyond an end it wraps, or
    /// returns `None` if the page has a neighbour.
    fn turn(self, item: usize, forward: bool) -> Option<usize> {
        let items = self.items;
        let start = self.start(item.min(items - 1));
        let alone = self.alone;
        if forward {
            let next = (start + 1..items).find(|next| self.start(*next) != start);
            return next.or_else(|| alone.then_some(0));
        }
        match start.checked_sub(1) {
            Some(before) => Some(self.start(before)),
            None => alone.then(|| self.start(items - 1)),
        }
    }
}
