//! Contains the table of pages: the key that opens them, the order of the page keys, and the
//! title (manual III-2).

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Identifies a page of the LCD.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum PageId {
    /// Position page with the relative coordinates.
    #[default]
    PosRel,
    /// Position page with the absolute coordinates.
    PosAbs,
    /// Position page with all coordinates (综合).
    PosAll,
    /// Position page with coordinates and program text.
    PosPrg,
    /// Program text, and its editor in EDIT.
    Prg,
    /// MDI page: words of the block and modal values.
    Mdi,
    /// Directory of the stored programs.
    Dir,
    /// Table of the tool offsets.
    Oft,
    /// Values of the macro variables.
    Macro,
    /// Active messages of the PLC ladder (外部信息).
    Msg,
    /// Active alarms of the control (报警信息).
    Alm,
    /// Setting page with TV check, ISO code, inch and automatic numbering.
    SetCode,
    /// Setting page with the parameter switch and the program switch.
    SetSwitch,
    /// Page that saves data to the electronic disk and reads it.
    Edisk,
    /// Page that enters and changes the password of the operation level.
    Password,
    /// Settings of the graphic page: plane, scale, centre, extents.
    GraphPar,
    /// Picture of the tool path.
    Graph,
    /// State parameters: eight bits a number.
    ParBit,
    /// Data parameters: one decimal value a number.
    ParData,
    /// Pitch error compensation table.
    Pitch,
    /// Diagnosis page: contacts, drives, current tool.
    Dgn,
    /// PLC signals, as bits.
    PlcBits,
    /// PLC values: timers, counters and data.
    PlcValues,
    /// Switches of the soft machine panel, operated by number keys.
    Softpanel,
    /// Versions of control and ladder.
    Version,
}

/// A page key of the panel. Each opens a group of pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum PageKey {
    /// 位置 POS: opens the position pages.
    Pos,
    /// 程序 PRG: opens the program pages.
    Prg,
    /// 刀补 OFT: opens the pages of offsets and macro variables.
    Oft,
    /// 报警 ALM: opens the message and alarm pages.
    Alm,
    /// 设置 SET: opens the setting and graphic pages.
    Set,
    /// 参数 PAR: opens the parameter pages.
    Par,
    /// 诊断 DGN: opens the diagnosis and PLC pages.
    Dgn,
}

/// A row of the page table: how a page is reached and named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageRow {
    /// The page that this row describes.
    pub page: PageId,
    /// The page's name on the command line.
    pub name: &'static str,
    /// The page key that opens the page's group.
    pub key: PageKey,
    /// The display that the page belongs to, from 0. Pressing the page key again selects the
    /// next display. The page-up and page-down keys stay inside one.
    pub display: u8,
    /// Number of screens of the page. The page-up and page-down keys step through them first.
    pub screens: u16,
}

const fn row(page: PageId, name: &'static str, key: PageKey, display: u8, screens: u16) -> PageRow {
    PageRow {
        page,
        name,
        key,
        display,
        screens,
    }
}

/// Number of pages of the LCD.
pub(crate) const PAGE_COUNT: usize = 25;

/// The table of pages, in the order of [`PageId`] and of the page-up and page-down keys.
pub const PAGES: [PageRow; PAGE_COUNT] = {
    use PageId as P;
    use PageKey as K;
    [
        row(P::PosRel, "pos-rel", K::Pos, 0, 1),
        row(P::PosAbs, "pos-abs", K::Pos, 0, 1),
        row(P::PosAll, "pos-all", K::Pos, 0, 1),
        row(P::PosPrg, "pos-prg", K::Pos, 0, 1),
        row(P::Prg, "prg", K::Prg, 0, 1),
        row(P::Mdi, "mdi", K::Prg, 0, 1),
        row(P::Dir, "dir", K::Prg, 0, 1),
        row(P::Oft, "oft", K::Oft, 0, 5),
        row(P::Macro, "macro", K::Oft, 0, 3),
        row(P::Msg, "msg", K::Alm, 0, 1),
        row(P::Alm, "alm", K::Alm, 0, 1),
        row(P::SetCode, "set-code", K::Set, 0, 1),
        row(P::SetSwitch, "set-switch", K::Set, 0, 1),
        row(P::Edisk, "edisk", K::Set, 0, 1),
        row(P::Password, "password", K::Set, 0, 1),
        row(P::GraphPar, "graph-par", K::Set, 1, 1),
        row(P::Graph, "graph", K::Set, 1, 1),
        row(P::ParBit, "par-bit", K::Par, 0, 2),
        row(P::ParData, "par-data", K::Par, 1, 7),
        row(P::Pitch, "pitch", K::Par, 2, 32),
        row(P::Dgn, "dgn", K::Dgn, 0, 8),
        row(P::PlcBits, "plc-bits", K::Dgn, 1, 104),
        row(P::PlcValues, "plc-values", K::Dgn, 2, 151),
        row(P::Softpanel, "softpanel", K::Dgn, 3, 1),
        row(P::Version, "version", K::Dgn, 4, 1),
    ]
};

impl PageId {
    /// Returns the row of the page table that describes this page.
    pub fn row(self) -> &'static PageRow {
        &PAGES[self as usize]
    }

    /// Returns the page's name on the command line, for example `pos-rel`.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the title that the LCD shows in its first row.
    pub fn title(self) -> Message {
        match self {
            Self::PosRel => say::lcd_position_relative(),
            Self::PosAbs => say::lcd_position_absolute(),
            Self::PosAll | Self::PosPrg => say::lcd_position(),
            Self::Prg | Self::Mdi | Self::Dir => say::lcd_program(),
            Self::Oft => say::lcd_offset(),
            Self::Macro => say::lcd_macro_variables(),
            Self::Msg => say::lcd_messages(),
            Self::Alm => say::lcd_alarms(),
            Self::SetCode | Self::SetSwitch => say::lcd_setting(),
            Self::Edisk => say::lcd_disk(),
            Self::Password => say::lcd_password(),
            Self::GraphPar | Self::Graph => say::lcd_graphic(),
            Self::ParBit => say::lcd_state_parameters(),
            Self::ParData => say::lcd_data_parameters(),
            Self::Pitch => say::lcd_pitch_errors(),
            Self::Dgn => say::lcd_diagnosis(),
            Self::PlcBits => say::lcd_plc_signals(),
            Self::PlcValues => say::lcd_plc_values(),
            Self::Softpanel => say::lcd_machine_panel(),
            Self::Version => say::lcd_version(),
        }
    }

    /// Returns the page with this name on the command line; `None` if no page has it.
    pub fn from_name(name: &str) -> Option<Self> {
        PAGES
            .iter()
            .find(|row| row.name == name)
            .map(|row| row.page)
    }

    /// Returns the next (`forward`) or previous page of the same display, wrapping at both
    /// ends.
    pub(crate) fn neighbour(self, forward: bool) -> Self {
        let own = self.row();
        let group: Vec<Self> = PAGES
            .iter()
            .filter(|row| row.key == own.key && row.display == own.display)
            .map(|row| row.page)
            .collect();
        let at = group.iter().position(|page| *page == self).unwrap_or(0);
        let step = if forward { 1 } else { group.len() - 1 };
        group[(at + step) % group.len()]
    }

    /// Returns the first page of a display (from 0) that a page key opens. A display number
    /// beyond the last one continues with the first.
    pub fn first_of(key: PageKey, display: u8) -> Self {
        let displays = PAGES
            .iter()
            .filter(|row| row.key == key)
            .map(|row| row.display)
            .max()
            .map_or(1, |last| last + 1);
        PAGES
            .iter()
            .find(|row| row.key == key && row.display == display % displays)
            .map_or(Self::PosRel, |row| row.page)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_order_of_the_ids() {
        for (index, row) in PAGES.iter().enumerate() {
            assert_eq!(row.page as usize, index, "{}", row.name);
            assert_eq!(PageId::from_name(row.name), Some(row.page));
        }
    }

    #[test]
    fn page_keys_wrap_inside_one_display() {
        assert_eq!(PageId::PosRel.neighbour(true), PageId::PosAbs);
        assert_eq!(PageId::PosRel.neighbour(false), PageId::PosPrg);
        assert_eq!(PageId::GraphPar.neighbour(true), PageId::Graph);
        assert_eq!(PageId::Graph.neighbour(true), PageId::GraphPar);
        assert_eq!(PageId::Password.neighbour(true), PageId::SetCode);
        assert_eq!(PageId::Version.neighbour(true), PageId::Version);
    }

    #[test]
    fn displays_of_a_key_follow_each_other() {
        assert_eq!(PageId::first_of(PageKey::Set, 1), PageId::GraphPar);
        assert_eq!(PageId::first_of(PageKey::Set, 2), PageId::SetCode);
        assert_eq!(PageId::first_of(PageKey::Dgn, 4), PageId::Version);
        assert_eq!(PageId::first_of(PageKey::Par, 3), PageId::ParBit);
        assert_eq!(PageId::first_of(PageKey::Alm, 0), PageId::Msg);
    }
}
