//! Contains the face of the SYSViV NC-B08 (its manual, introduction and chapters 1 to 3). It has
//! a green LCD of 320x240 dots and mechanical keys. Their positions are decided here.

use gsk_messages::say;

use super::contacts::{ContactMeaning as M, ContactRow, contact};
use super::gsk980td as common;
use super::pages::row;
use super::{Face, GAP, KeyGrid, PageId as P, PageKey as K, PanelColour, Rect};
use crate::keys::{Key, KeyRole, KeyRow};
use crate::lcd::LcdColours;

const PAGE_KEYS: KeyGrid = KeyGrid {
    first: Rect::new(
        common::PAGE_LEFT,
        common::PAGE_ROW.0,
        common::PAGE_WIDTH / 8.0 - GAP,
        common::PAGE_ROW.1,
    ),
    rows: &[&[
        Key::Position,
        Key::Program,
        Key::Offset,
        Key::Alarm,
        Key::Setting,
        Key::Parameter,
        Key::Diagnosis,
        Key::Teach,
    ]],
    colour: PanelColour::Page,
};

const CHUCK: KeyGrid = KeyGrid {
    first: common::UPPER_CORNER,
    rows: &[&[Key::Chuck]],
    colour: PanelColour::Machine,
};

const TAILSTOCK: KeyGrid = KeyGrid {
    first: common::LOWER_CORNER,
    rows: &[&[Key::Tailstock]],
    colour: PanelColour::Machine,
};

/// Returns a key of the edit keyboard with the legend that this panel has.
const fn printed(key: Key, legend: &'static [&'static str], zh: &'static str) -> KeyRow {
    let row = key.row();
    KeyRow {
        legend,
        name_zh: zh,
        ..*row
    }
}

pub(super) static FACE: Face = Face {
    maker: None,
    version: "NC-B08",
    product: "NC-B08",
    versions: None,
    to_go: say::lcd_distance_to_go_short,
    lcd: LcdColours::GREEN,
    grids: &[
        common::RESET,
        common::CURSOR,
        common::ADDRESSES,
        common::EOB,
        common::NUMBERS,
        common::FUNCTIONS,
        PAGE_KEYS,
        common::MODE_KEYS,
        common::SWITCHES,
        common::PROGRAM_ZERO,
        common::INCREMENTS,
        common::WHEEL_Z,
        common::UP,
        CHUCK,
        common::SIDES,
        common::DOWN,
        TAILSTOCK,
        common::SPINDLE_KEYS,
        common::OVERRIDE_KEYS,
        common::HOLD,
        common::START,
    ],
    printed: &[
        printed(Key::Input, &["输入", "ENTER"], "输入"),
        printed(Key::Change, &["命令", "CMD"], "命令"),
        printed(Key::Cancel, &["取消", "ESC"], "取消"),
        KeyRow {
            role: KeyRole::Page,
            legend: &["示教", "图形"],
            ..*Key::Teach.row()
        },
    ],
    pages: &[
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
        row(P::Udisk, "udisk", K::Set, 1, 1),
        row(P::ParModel, "par-model", K::Par, 0, 8),
        row(P::ParBit, "par-bit", K::Par, 1, 2),
        row(P::ParData, "par-data", K::Par, 2, 7),
        row(P::Pitch, "pitch", K::Par, 3, 32),
        row(P::Inputs, "inputs", K::Dgn, 0, 2),
        row(P::Outputs, "outputs", K::Dgn, 0, 2),
        row(P::Dgn, "dgn", K::Dgn, 1, 8),
        row(P::PlcBits, "plc-bits", K::Dgn, 2, 104),
        row(P::PlcValues, "plc-values", K::Dgn, 3, 151),
        row(P::Softpanel, "softpanel", K::Dgn, 4, 1),
        row(P::Version, "version", K::Dgn, 5, 1),
        row(P::Teach, "teach", K::Teach, 0, 1),
        row(P::GraphPar, "graph-par", K::Teach, 1, 1),
        row(P::Graph, "graph", K::Teach, 1, 1),
    ],
    soft_keys: &[],
    inputs: &INPUTS,
    outputs: &OUTPUTS,
    // The lubrication has no pin in the table of connector C-DO.
    spare_signals: &[(17, M::Signal(say::lcd_contact_lubrication))],
};

/// The inputs X0 to X31. The table of connector C-DI lists X0 to X23 with their pins.
static INPUTS: [ContactRow; 32] = [
    contact(1, M::Free),
    contact(14, M::Free),
    contact(2, M::Free),
    contact(15, M::Free),
    contact(3, M::Free),
    contact(16, M::Free),
    contact(4, M::Free),
    contact(17, M::Free),
    contact(5, M::Code("M80")),
    contact(18, M::Code("M40")),
    contact(6, M::Code("M50")),
    contact(19, M::Code("M60")),
    contact(7, M::Code("M70")),
    contact(20, M::Free),
    contact(8, M::Signal(say::lcd_contact_user)),
    contact(21, M::Signal(say::lcd_contact_reverse)),
    contact(9, M::Signal(say::lcd_contact_stop_1)),
    contact(22, M::Signal(say::lcd_contact_z_minus)),
    contact(10, M::Signal(say::lcd_contact_z_plus)),
    contact(23, M::Signal(say::lcd_contact_x_minus)),
    contact(11, M::Signal(say::lcd_contact_x_plus)),
    contact(24, M::Signal(say::lcd_contact_z_slow)),
    contact(12, M::Signal(say::lcd_contact_x_slow)),
    contact(25, M::Signal(say::lcd_contact_stop_2)),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
];

/// The outputs Y0 to Y23. The table of connector C-DO lists Y0 to Y15 with their pins.
static OUTPUTS: [ContactRow; 24] = [
    contact(1, M::Code("M70")),
    contact(14, M::Code("M60")),
    contact(2, M::Code("M50")),
    contact(15, M::Code("M40")),
    contact(3, M::Code("M21")),
    contact(16, M::Code("M51")),
    contact(4, M::Code("M41")),
    contact(17, M::Code("M08")),
    contact(5, M::Code("M71")),
    contact(18, M::Code("M61")),
    contact(6, M::Code("M81")),
    contact(19, M::Code("M80")),
    contact(7, M::Code("M03")),
    contact(20, M::Code("M04")),
    contact(8, M::Code("M05")),
    contact(21, M::Signal(say::lcd_contact_brake)),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
    contact(0, M::Free),
];
