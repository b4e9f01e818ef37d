//! Contains the face of the GSK980TD (manual III-1.2). Other models share its grids of keys.

use gsk_messages::say;

use super::pages::PAGES;
use super::{Face, GAP, KeyGrid, PanelColour, Rect};
use crate::keys::Key as K;
use crate::lcd::LcdColours;

/// Width and height of the keys of the edit keyboard, panel units.
const EDIT_KEY: (f32, f32) = (47.0, 60.0);
/// Left edge of the edit keyboard, panel units.
const LEFT: f32 = 708.0;
const TOP: f32 = 92.0;
/// Left edge of the address keys, panel units.
const ADDRESS_LEFT: f32 = 822.0;
const NUMBER_LEFT: f32 = 1095.0;
/// Upper edge and height of the page keys, panel units.
pub(super) const PAGE_ROW: (f32, f32) = (476.0, 60.0);
/// Width of the plate of the page keys without its margins, and one gap, panel units.
pub(super) const PAGE_WIDTH: f32 = 550.0;
pub(super) const PAGE_LEFT: f32 = LEFT;

/// Width and height of the machine keys, panel units.
const MACHINE_KEY: (f32, f32) = (56.0, 50.0);
/// Upper edges of the three rows of machine keys, panel units.
const FIRST: f32 = 573.0;
const SECOND: f32 = FIRST + MACHINE_KEY.1 + GAP;
const THIRD: f32 = SECOND + MACHINE_KEY.1 + GAP;
/// Left edges of modes, directions, spindle keys and overrides, panel units.
const MODES: f32 = 28.0;
const DIRECTIONS: f32 = 418.0;
const SPINDLE: f32 = 622.0;
const OVERRIDES: f32 = 764.0;
/// Width of the keys feed hold and cycle start, panel units.
const HALF: f32 = 87.0;

/// Returns the rectangle of a machine key in a column (from 0) after a left edge.
pub(super) const fn machine_key(left: f32, column: f32, top: f32) -> Rect {
    let (w, h) = MACHINE_KEY;
    Rect::new(left + column * (w + GAP), top, w, h)
}

const fn edit_key(x: f32, y: f32) -> Rect {
    Rect::new(x, y, EDIT_KEY.0, EDIT_KEY.1)
}

const fn grid(first: Rect, rows: &'static [&'static [K]], colour: PanelColour) -> KeyGrid {
    KeyGrid {
        first,
        rows,
        colour,
    }
}

pub(super) const RESET: KeyGrid = grid(
    Rect::new(LEFT, TOP, 100.0, EDIT_KEY.1),
    &[&[K::Reset]],
    PanelColour::Danger,
);
/// The cursor keys, which are as large as letter keys because they are pressed as often.
pub(super) const CURSOR: KeyGrid = grid(
    edit_key(LEFT, TOP + EDIT_KEY.1 + GAP),
    &[
        &[K::PageUp, K::Up],
        &[K::PageDown, K::Down],
        &[K::Left, K::Right],
    ],
    PanelColour::Function,
);
pub(super) const ADDRESSES: KeyGrid = grid(
    edit_key(ADDRESS_LEFT, TOP),
    &[
        &[K::O, K::N, K::G, K::X, K::Z],
        &[K::U, K::W, K::S, K::T, K::M],
        &[K::P, K::R, K::I, K::K, K::J],
        &[K::F, K::L, K::H, K::Slash],
    ],
    PanelColour::Address,
);
pub(super) const EOB: KeyGrid = grid(
    edit_key(
        ADDRESS_LEFT + 4.0 * (EDIT_KEY.0 + GAP),
        TOP + 3.0 * (EDIT_KEY.1 + GAP),
    ),
    &[&[K::Eob]],
    PanelColour::Function,
);
pub(super) const NUMBERS: KeyGrid = grid(
    edit_key(NUMBER_LEFT, TOP),
    &[
        &[K::Digit7, K::Digit8, K::Digit9],
        &[K::Digit4, K::Digit5, K::Digit6],
        &[K::Digit1, K::Digit2, K::Digit3],
        &[K::Minus, K::Digit0, K::Point],
    ],
    PanelColour::Number,
);
pub(super) const FUNCTIONS: KeyGrid = grid(
    Rect::new(LEFT, 370.0, 85.0, 66.0),
    &[&[
        K::Input,
        K::Output,
        K::Change,
        K::Cancel,
        K::Insert,
        K::Delete,
    ]],
    PanelColour::Function,
);
const PAGE_KEYS: KeyGrid = grid(
    Rect::new(PAGE_LEFT, PAGE_ROW.0, PAGE_WIDTH / 7.0 - GAP, PAGE_ROW.1),
    &[&[
        K::Position,
        K::Program,
        K::Offset,
        K::Alarm,
        K::Setting,
        K::Parameter,
        K::Diagnosis,
    ]],
    PanelColour::Page,
);
pub(super) const MODE_KEYS: KeyGrid = grid(
    machine_key(MODES, 0.0, FIRST),
    &[&[
        K::Edit,
        K::Auto,
        K::Mdi,
        K::MachineZero,
        K::Handwheel,
        K::Jog,
    ]],
    PanelColour::Mode,
);
pub(super) const SWITCHES: KeyGrid = grid(
    machine_key(MODES, 0.0, SECOND),
    &[&[
        K::SingleBlock,
        K::BlockSkip,
        K::MachineLock,
        K::AuxiliaryLock,
        K::DryRun,
    ]],
    PanelColour::Machine,
);
pub(super) const PROGRAM_ZERO: KeyGrid = grid(
    machine_key(MODES, 5.0, SECOND),
    &[&[K::ProgramZero]],
    PanelColour::Mode,
);
pub(super) const INCREMENTS: KeyGrid = grid(
    machine_key(MODES, 0.0, THIRD),
    &[&[K::Increment1, K::Increment10, K::Increment100, K::WheelX]],
    PanelColour::Machine,
);
const WHEEL_Y: KeyGrid = grid(
    machine_key(MODES, 4.0, THIRD),
    &[&[K::WheelY]],
    PanelColour::Machine,
);
pub(super) const WHEEL_Z: KeyGrid = grid(
    machine_key(MODES, 5.0, THIRD),
    &[&[K::WheelZ]],
    PanelColour::Machine,
);
pub(super) const UP: KeyGrid = grid(
    machine_key(DIRECTIONS, 1.0, FIRST),
    &[&[K::XUp]],
    PanelColour::Direction,
);
pub(super) const SIDES: KeyGrid = grid(
    machine_key(DIRECTIONS, 0.0, SECOND),
    &[&[K::ZLeft, K::Rapid, K::ZRight]],
    PanelColour::Direction,
);
pub(super) const DOWN: KeyGrid = grid(
    machine_key(DIRECTIONS, 1.0, THIRD),
    &[&[K::XDown]],
    PanelColour::Direction,
);
/// The corners of the direction keys, above and below on the right.
pub(super) const UPPER_CORNER: Rect = machine_key(DIRECTIONS, 2.0, FIRST);
pub(super) const LOWER_CORNER: Rect = machine_key(DIRECTIONS, 2.0, THIRD);
pub(super) const SPINDLE_KEYS: KeyGrid = grid(
    machine_key(SPINDLE, 0.0, FIRST),
    &[
        &[K::SpindleForward, K::Coolant],
        &[K::SpindleStop, K::Lubrication],
        &[K::SpindleReverse, K::ToolChange],
    ],
    PanelColour::Machine,
);
pub(super) const OVERRIDE_KEYS: KeyGrid = grid(
    machine_key(OVERRIDES, 0.0, FIRST),
    &[
        &[K::SpindleOverrideUp, K::RapidOverrideUp, K::FeedOverrideUp],
        &[
            K::SpindleOverrideDown,
            K::RapidOverrideDown,
            K::FeedOverrideDown,
        ],
    ],
    PanelColour::Machine,
);
pub(super) const HOLD: KeyGrid = grid(
    Rect::new(OVERRIDES, THIRD, HALF, MACHINE_KEY.1),
    &[&[K::FeedHold]],
    PanelColour::Hold,
);
pub(super) const START: KeyGrid = grid(
    Rect::new(OVERRIDES + HALF + GAP, THIRD, HALF, MACHINE_KEY.1),
    &[&[K::CycleStart]],
    PanelColour::Start,
);

pub(super) static FACE: Face = Face {
    maker: Some(say::lcd_maker),
    version: "Gsk-980TD V05.05.12",
    product: "GSK-980TD-1",
    versions: Some(("V05.01.15", "RS")),
    to_go: say::lcd_distance_to_go,
    lcd: LcdColours::BLUE,
    grids: &[
        RESET,
        CURSOR,
        ADDRESSES,
        EOB,
        NUMBERS,
        FUNCTIONS,
        PAGE_KEYS,
        MODE_KEYS,
        SWITCHES,
        PROGRAM_ZERO,
        INCREMENTS,
        WHEEL_Y,
        WHEEL_Z,
        UP,
        grid(UPPER_CORNER, &[&[K::YMinus]], PanelColour::Direction),
        SIDES,
        DOWN,
        grid(LOWER_CORNER, &[&[K::YPlus]], PanelColour::Direction),
        SPINDLE_KEYS,
        OVERRIDE_KEYS,
        HOLD,
        START,
    ],
    printed: &[],
    pages: &PAGES,
    soft_keys: &[],
    inputs: &[],
    outputs: &[],
    spare_signals: &[],
};
