//! Contains the face of the Huaxing 31 and 32 series. Its manual names the main functions PRGRM
//! and OPERT, the soft keys F1 to F5, and the pages; their arrangement is decided here.

use gsk_messages::say;

use super::contacts::{ContactMeaning, ContactRow, contact};
use super::gsk980td as common;
use super::pages::row;
use super::{
    Face, GAP, KeyGrid, PageId as P, PageKey as K, PanelColour, Rect, SoftAction as A, SoftKey,
};
use crate::keys::Key;
use crate::lcd::LcdColours;

/// Width of the main function keys and of the soft keys, panel units.
const WIDTH: f32 = common::PAGE_WIDTH / 8.0 - GAP;

const MAIN_FUNCTIONS: KeyGrid = KeyGrid {
    first: Rect::new(
        common::PAGE_LEFT,
        common::PAGE_ROW.0,
        WIDTH,
        common::PAGE_ROW.1,
    ),
    rows: &[&[Key::MainProgram, Key::MainOperate, Key::MainParameter]],
    colour: PanelColour::Page,
};

const SOFT_KEYS: KeyGrid = KeyGrid {
    first: Rect::new(
        common::PAGE_LEFT + 3.0 * (WIDTH + GAP),
        common::PAGE_ROW.0,
        WIDTH,
        common::PAGE_ROW.1,
    ),
    rows: &[&[Key::Soft1, Key::Soft2, Key::Soft3, Key::Soft4, Key::Soft5]],
    colour: PanelColour::Function,
};

const fn soft(
    group: K,
    (bar, position): (u8, u8),
    label: fn() -> gsk_messages::Message,
    action: A,
) -> SoftKey {
    SoftKey {
        group,
        bar,
        position,
        label,
        action,
    }
}

pub(super) static FACE: Face = Face {
    maker: None,
    version: "31/32",
    product: "31/32",
    versions: None,
    to_go: say::lcd_distance_to_go,
    lcd: LcdColours::BLUE,
    grids: &[
        common::RESET,
        common::CURSOR,
        common::ADDRESSES,
        common::EOB,
        common::NUMBERS,
        common::FUNCTIONS,
        MAIN_FUNCTIONS,
        SOFT_KEYS,
        common::MODE_KEYS,
        common::SWITCHES,
        common::PROGRAM_ZERO,
        common::INCREMENTS,
        common::WHEEL_Z,
        common::UP,
        common::SIDES,
        common::DOWN,
        common::SPINDLE_KEYS,
        common::OVERRIDE_KEYS,
        common::HOLD,
        common::START,
    ],
    printed: &[],
    pages: &[
        row(P::Prg, "prg", K::Program, 0, 1),
        row(P::Dir, "dir", K::Program, 1, 1),
        row(P::Udisk, "udisk", K::Program, 2, 1),
        row(P::PosRel, "pos-rel", K::Operate, 0, 1),
        row(P::PosAbs, "pos-abs", K::Operate, 0, 1),
        row(P::PosAll, "pos-all", K::Operate, 0, 1),
        row(P::PosPrg, "pos-prg", K::Operate, 0, 1),
        row(P::Mdi, "mdi", K::Operate, 1, 1),
        row(P::GraphPar, "graph-par", K::Operate, 2, 1),
        row(P::Graph, "graph", K::Operate, 2, 1),
        row(P::SetCode, "set-code", K::Operate, 3, 1),
        row(P::SetSwitch, "set-switch", K::Operate, 3, 1),
        row(P::Softpanel, "softpanel", K::Operate, 3, 1),
        row(P::Password, "password", K::Operate, 3, 1),
        row(P::Msg, "msg", K::Operate, 4, 1),
        row(P::Alm, "alm", K::Operate, 4, 1),
        row(P::ParModel, "par-model", K::Parameter, 0, 1),
        row(P::ParData, "par-data", K::Parameter, 0, 7),
        row(P::ParBit, "par-bit", K::Parameter, 1, 2),
        row(P::Oft, "oft", K::Parameter, 2, 5),
        row(P::Macro, "macro", K::Parameter, 2, 3),
        row(P::Coordinates, "coordinates", K::Parameter, 3, 1),
        row(P::Pitch, "pitch", K::Parameter, 4, 32),
        row(P::Inputs, "inputs", K::Parameter, 5, 2),
        row(P::Outputs, "outputs", K::Parameter, 5, 2),
        row(P::Dgn, "dgn", K::Parameter, 5, 8),
        row(P::PlcBits, "plc-bits", K::Parameter, 5, 104),
        row(P::PlcValues, "plc-values", K::Parameter, 5, 151),
        row(P::Version, "version", K::Parameter, 5, 1),
        row(P::Edisk, "edisk", K::Parameter, 6, 1),
        row(P::Reset, "reset", K::Parameter, 7, 1),
    ],
    soft_keys: &[
        soft(K::Program, (0, 0), say::lcd_soft_edit, A::Open(P::Prg)),
        soft(K::Program, (0, 1), say::lcd_soft_list, A::Open(P::Dir)),
        soft(K::Program, (0, 2), say::lcd_soft_copy, A::CopyProgram),
        soft(K::Program, (0, 3), say::lcd_soft_rename, A::RenameProgram),
        soft(K::Program, (0, 4), say::lcd_soft_udisk, A::Open(P::Udisk)),
        soft(
            K::Operate,
            (0, 0),
            say::lcd_soft_position,
            A::Open(P::PosRel),
        ),
        soft(K::Operate, (0, 1), say::lcd_soft_mdi, A::Open(P::Mdi)),
        soft(K::Operate, (0, 2), say::lcd_soft_graphic, A::Open(P::Graph)),
        soft(K::Operate, (0, 3), say::lcd_soft_state, A::Open(P::SetCode)),
        soft(K::Operate, (0, 4), say::lcd_soft_alarm, A::Open(P::Alm)),
        soft(
            K::Parameter,
            (0, 0),
            say::lcd_soft_p_parameters,
            A::Open(P::ParModel),
        ),
        soft(
            K::Parameter,
            (0, 1),
            say::lcd_soft_bit_parameters,
            A::Open(P::ParBit),
        ),
        soft(K::Parameter, (0, 2), say::lcd_soft_tool, A::Open(P::Oft)),
        soft(
            K::Parameter,
            (0, 3),
            say::lcd_soft_coordinates,
            A::Open(P::Coordinates),
        ),
        soft(K::Parameter, (0, 4), say::lcd_soft_more, A::NextBar),
        soft(K::Parameter, (1, 0), say::lcd_soft_pitch, A::Open(P::Pitch)),
        soft(
            K::Parameter,
            (1, 1),
            say::lcd_soft_diagnosis,
            A::Open(P::Inputs),
        ),
        soft(
            K::Parameter,
            (1, 2),
            say::lcd_soft_backup,
            A::Open(P::Edisk),
        ),
        soft(K::Parameter, (1, 3), say::lcd_soft_reset, A::Open(P::Reset)),
        soft(K::Parameter, (1, 4), say::lcd_soft_more, A::NextBar),
    ],
    inputs: &[FREE; 24],
    outputs: &[FREE; 17],
    spare_signals: &[],
};

/// A contact of which the manual gives only the count: 24 inputs, 17 outputs.
const FREE: ContactRow = contact(0, ContactMeaning::Free);
