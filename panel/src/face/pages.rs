//! Defines the pages of all models with their titles, and contains the page table of the
//! GSK980TD: the key that opens each page, and the order of the page keys (manual III-2).

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
    /// Program page: the program text, and in edit mode its editor.
    Prg,
    /// MDI page: words of the block and modal values.
    Mdi,
    /// Directory page of the stored programs.
    Dir,
    /// Page with the table of the tool offsets.
    Oft,
    /// Page with the values of the macro variables.
    Macro,
    /// Page with the active messages of the PLC ladder (外部信息).
    Msg,
    /// Page with the active alarms of the control (报警信息).
    Alm,
    /// Setting page with TV check, ISO code, inch and automatic numbering.
    SetCode,
    /// Setting page with the parameter switch and the program switch.
    SetSwitch,
    /// Page that saves data to the electronic disk and reads it.
    Edisk,
    /// Page that enters and changes the password of the operation level.
    Password,
    /// Setting page of the graphic display: plane, scale, centre, extents.
    GraphPar,
    /// Page with the picture of the tool path.
    Graph,
    /// State parameters page: eight bits per number.
    ParBit,
    /// Data parameters page: one decimal value per number.
    ParData,
    /// Page with the pitch error compensation table.
    Pitch,
    /// Diagnosis page: contacts, drives, current tool.
    Dgn,
    /// Page with PLC signals, as bits.
    PlcBits,
    /// Page with PLC values: timers, counters and data.
    PlcValues,
    /// Page with the switches of the soft machine panel, operated by number keys.
    Softpanel,
    /// Page with the versions of control and ladder.
    Version,
    /// Blocks that the operator teaches by moving the axes (示教, NC-B08).
    Teach,
    /// Page with the parameters that only this model has (P 参数).
    ParModel,
    /// Page with the inputs of the model: pins, meanings and levels.
    Inputs,
    /// Page with the outputs of the model: pins, meanings and levels.
    Outputs,
    /// Programs on the U disk, and those to be stored there.
    Udisk,
    /// Page on which zero offset and coordinates can be set (坐标修调, Huaxing).
    Coordinates,
    /// Page that clears programs and restores delivered values (系统置零, Huaxing).
    Reset,
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
    /// 示教 (NC-B08): opens the pages for teaching and graphic.
    Teach,
    /// PRGRM (Huaxing): opens the main function for programs.
    Program,
    /// OPERT (Huaxing): opens the main function for machining.
    Operate,
    /// PARAM (Huaxing): opens the main function for parameters.
    Parameter,
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

pub(super) const fn row(
    page: PageId,
    name: &'static str,
    key: PageKey,
    display: u8,
    screens: u16,
) -> PageRow {
    PageRow {
        page,
        name,
        key,
        display,
        screens,
    }
}

/// Number of pages of the GSK980TD, which are the first of [`PageId`]. A recording always stores
/// their cursors.
pub(crate) const STORED_PAGES: usize = 25;
/// Total number of pages of all models.
pub(crate) const PAGE_COUNT: usize = STORED_PAGES + MODEL_PAGE_NAMES.len();

/// Names on the command line of the pages that only other models have, in the order of
/// [`PageId`].
const MODEL_PAGE_NAMES: [&str; 7] = [
    "teach",
    "par-model",
    "inputs",
    "outputs",
    "udisk",
    "coordinates",
    "reset",
];

/// Returns the names of the pages of all models.
pub(crate) fn page_names() -> impl Iterator<Item = &'static str> {
    PAGES.iter().map(|row| row.name).chain(MODEL_PAGE_NAMES)
}

/// The pages of the GSK980TD, in the order of [`PageId`] and of the page-up and page-down keys.
pub const PAGES: [PageRow; STORED_PAGES] = {
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
    /// Returns the page's name on the command line, for example `pos-rel`.
    pub fn name(self) -> &'static str {
        let index = self as usize;
        match PAGES.get(index) {
            Some(row) => row.name,
            None => MODEL_PAGE_NAMES[index - STORED_PAGES],
        }
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
            Self::Teach => say::lcd_teaching(),
            Self::ParModel => say::lcd_model_parameters(),
            Self::Inputs => say::lcd_inputs(),
            Self::Outputs => say::lcd_outputs(),
            Self::Udisk => say::lcd_udisk(),
            Self::Coordinates => say::lcd_coordinate_trim(),
            Self::Reset => say::lcd_system_reset(),
        }
    }
}
