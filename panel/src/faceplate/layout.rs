//! Lays out the parts of the panel.

use super::{Area, Colour, Outline, Part, Rect, SIZE, What};
use crate::keys::{Key, STRIP};

/// The LCD.
pub(super) const LCD: Rect = Rect::new(28.0, 60.0, 640.0, 480.0);

const BEZEL: Rect = Rect::new(14.0, 46.0, 668.0, 508.0);
const STRIP_PLATE: Rect = Rect::new(14.0, 10.0, 668.0, 30.0);
const NAME_PLATE: Rect = Rect::new(694.0, 10.0, 572.0, 60.0);
const EDIT_PLATE: Rect = Rect::new(694.0, 78.0, 572.0, 372.0);
const PAGE_PLATE: Rect = Rect::new(694.0, 458.0, 572.0, 96.0);
/// Modes, toggles and directions.
const MACHINE_PLATE: Rect = Rect::new(14.0, 562.0, 592.0, 184.0);
/// Spindle and auxiliary functions, overrides, hold and start.
const RUN_PLATE: Rect = Rect::new(614.0, 562.0, 346.0, 184.0);
const ADDITIONAL_PLATE: Rect = Rect::new(970.0, 562.0, 296.0, 184.0);

/// The sections of the panel, each with a margin: LCD, name plate, edit keyboard, modes and
/// directions, spindle and start, additional panel.
pub(super) const APART: [Area; 6] = [
    Area {
        rect: Rect::new(6.0, 2.0, 684.0, 560.0),
    },
    Area {
        rect: Rect::new(686.0, 2.0, 588.0, 76.0),
    },
    Area {
        rect: Rect::new(686.0, 72.0, 588.0, 488.0),
    },
    Area {
        rect: Rect::new(6.0, 555.0, 608.0, 198.0),
    },
    Area {
        rect: Rect::new(606.0, 555.0, 362.0, 198.0),
    },
    Area {
        rect: Rect::new(962.0, 555.0, 312.0, 198.0),
    },
];

/// Space between keys.
const GAP: f32 = 6.0;

/// Layers, from below.
const HOUSING: u8 = 0;
const PLATE: u8 = 1;
const ON_PLATE: u8 = 2;

pub(super) fn parts() -> Vec<Part> {
    let mut parts = vec![Part {
        what: What::Housing,
        rect: Rect::new(0.0, 0.0, SIZE.0, SIZE.1),
        outline: Outline::Rounded(14.0),
        layer: HOUSING,
        colour: Colour::Housing,
    }];
    for rect in [
        STRIP_PLATE,
        NAME_PLATE,
        EDIT_PLATE,
        PAGE_PLATE,
        MACHINE_PLATE,
        RUN_PLATE,
        ADDITIONAL_PLATE,
    ] {
        parts.push(Part {
            what: What::Plate,
            rect,
            outline: Outline::Rounded(8.0),
            layer: PLATE,
            colour: Colour::Plate,
        });
    }
    parts.push(Part {
        what: What::Bezel,
        rect: BEZEL,
        outline: Outline::Rounded(10.0),
        layer: PLATE,
        colour: Colour::Bezel,
    });
    parts.push(Part {
        what: What::Lcd,
        rect: LCD,
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour: Colour::Lcd,
    });
    strip(&mut parts);
    name_plate(&mut parts);
    edit_keyboard(&mut parts);
    page_keys(&mut parts);
    machine_keys(&mut parts);
    additional_panel(&mut parts);
    parts
}

fn key(parts: &mut Vec<Part>, key: Key, rect: Rect, colour: Colour) {
    parts.push(Part {
        what: What::Key(key),
        rect,
        outline: Outline::Rounded(6.0),
        layer: ON_PLATE,
        colour,
    });
}

fn print(parts: &mut Vec<Part>, text: &'static str, size: f32, rect: Rect, colour: Colour) {
    parts.push(Part {
        what: What::Text(text, size),
        rect,
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour,
    });
}

/// The status lamps, a strip above the LCD.
fn strip(parts: &mut Vec<Part>) {
    let width = STRIP_PLATE.w / STRIP.len() as f32;
    for index in 0..STRIP.len() {
        parts.push(Part {
            what: What::Strip(index),
            rect: Rect::new(
                (STRIP_PLATE.x + index as f32 * width).round(),
                STRIP_PLATE.y + 3.0,
                width.floor(),
                24.0,
            ),
            outline: Outline::Rounded(4.0),
            layer: ON_PLATE,
            colour: Colour::Print,
        });
    }
}

fn name_plate(parts: &mut Vec<Part>) {
    let Rect { x, y, w, h } = NAME_PLATE;
    parts.push(Part {
        what: What::Model,
        rect: Rect::new(x + 20.0, y + 4.0, 160.0, h - 8.0),
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour: Colour::Print,
    });
    let right = Rect::new(x + w - 160.0, y + 12.0, 140.0, 16.0);
    print(parts, "车床数控系统", 16.0, right, Colour::Print);
    let below = Rect {
        y: y + 32.0,
        ..right
    };
    let middle = Rect::new(x + 194.0, y + 6.0, 210.0, h - 12.0);
    for (what, rect, radius, colour) in [
        (What::Emulator, below, 0.0, Colour::Hint),
        (What::RealMotion, middle, 6.0, Colour::Danger),
    ] {
        parts.push(Part {
            what,
            rect,
            outline: Outline::Rounded(radius),
            layer: ON_PLATE,
            colour,
        });
    }
}

/// The edit keyboard: RESET, page and cursor keys; addresses; numbers; the row of functions
/// below.
fn edit_keyboard(parts: &mut Vec<Part>) {
    let (w, h) = (47.0, 60.0);
    let left = EDIT_PLATE.x + 14.0;
    let top = EDIT_PLATE.y + 14.0;
    let row = |index: f32| top + index * (h + GAP);

    let both = 2.0 * w + GAP;
    key(
        parts,
        Key::Reset,
        Rect::new(left, top, both, h),
        Colour::Danger,
    );
    // As large as letters, because they are pressed as often.
    let moves = [
        [Key::PageUp, Key::Up],
        [Key::PageDown, Key::Down],
        [Key::Left, Key::Right],
    ];
    let first = Rect::new(left, row(1.0), w, h);
    grid(parts, &moves, first, Colour::Function);

    let addresses = [
        [Key::O, Key::N, Key::G, Key::X, Key::Z],
        [Key::U, Key::W, Key::S, Key::T, Key::M],
        [Key::P, Key::R, Key::I, Key::K, Key::J],
        [Key::F, Key::L, Key::H, Key::Slash, Key::Eob],
    ];
    let start = left + both + 14.0;
    grid(
        parts,
        &addresses,
        Rect::new(start, top, w, h),
        Colour::Address,
    );

    let numbers = [
        [Key::Digit7, Key::Digit8, Key::Digit9],
        [Key::Digit4, Key::Digit5, Key::Digit6],
        [Key::Digit1, Key::Digit2, Key::Digit3],
        [Key::Minus, Key::Digit0, Key::Point],
    ];
    let start = start + 5.0 * (w + GAP) + 8.0;
    grid(parts, &numbers, Rect::new(start, top, w, h), Colour::Number);
    let end = start + 3.0 * (w + GAP) - GAP;

    let functions = [[
        Key::Input,
        Key::Output,
        Key::Change,
        Key::Cancel,
        Key::Insert,
        Key::Delete,
    ]];
    let width = (end - left + GAP) / 6.0 - GAP;
    let first = Rect::new(left, row(4.0) + 14.0, width, 66.0);
    grid(parts, &functions, first, Colour::Function);
}

fn page_keys(parts: &mut Vec<Part>) {
    let pages = [[
        Key::Position,
        Key::Program,
        Key::Offset,
        Key::Alarm,
        Key::Setting,
        Key::Parameter,
        Key::Diagnosis,
    ]];
    let left = PAGE_PLATE.x + 14.0;
    let width = (PAGE_PLATE.w - 28.0 + GAP) / 7.0 - GAP;
    let first = Rect::new(left, PAGE_PLATE.y + 18.0, width, 60.0);
    grid(parts, &pages, first, Colour::Page);
}

/// Rows of keys of one size. The first rectangle is that of the first key.
fn grid<const N: usize>(parts: &mut Vec<Part>, rows: &[[Key; N]], first: Rect, colour: Colour) {
    for (row, keys) in rows.iter().enumerate() {
        for (column, name) in keys.iter().enumerate() {
            let rect = Rect::new(
                first.x + column as f32 * (first.w + GAP),
                first.y + row as f32 * (first.h + GAP),
                first.w,
                first.h,
            );
            let colour = if *name == Key::Eob {
                Colour::Function
            } else {
                colour
            };
            key(parts, *name, rect, colour);
        }
    }
}

/// The machine panel: modes, toggles and increments; directions; spindle and auxiliary
/// functions; overrides, hold and start.
fn machine_keys(parts: &mut Vec<Part>) {
    let (w, h) = (56.0, 50.0);
    let x = MACHINE_PLATE.x + 14.0;
    let y = MACHINE_PLATE.y + 11.0;
    let modes = [[
        Key::Edit,
        Key::Auto,
        Key::Mdi,
        Key::MachineZero,
        Key::Handwheel,
        Key::Jog,
    ]];
    grid(parts, &modes, Rect::new(x, y, w, h), Colour::Mode);
    let toggles = [[
        Key::SingleBlock,
        Key::BlockSkip,
        Key::MachineLock,
        Key::AuxiliaryLock,
        Key::DryRun,
    ]];
    let second = y + h + GAP;
    grid(parts, &toggles, Rect::new(x, second, w, h), Colour::Machine);
    let program_zero = Rect::new(x + 5.0 * (w + GAP), second, w, h);
    key(parts, Key::ProgramZero, program_zero, Colour::Mode);
    let wheel = [[
        Key::Increment1,
        Key::Increment10,
        Key::Increment100,
        Key::WheelX,
        Key::WheelY,
        Key::WheelZ,
    ]];
    let third = second + h + GAP;
    grid(parts, &wheel, Rect::new(x, third, w, h), Colour::Machine);

    let group = 24.0;
    let x = x + 6.0 * (w + GAP) - GAP + group;
    let at = |column: f32, row: f32| Rect::new(x + column * (w + GAP), y + row * (h + GAP), w, h);
    for (name, column, row) in [
        (Key::XUp, 1.0, 0.0),
        (Key::YMinus, 2.0, 0.0),
        (Key::ZLeft, 0.0, 1.0),
        (Key::Rapid, 1.0, 1.0),
        (Key::ZRight, 2.0, 1.0),
        (Key::XDown, 1.0, 2.0),
        (Key::YPlus, 2.0, 2.0),
    ] {
        key(parts, name, at(column, row), Colour::Direction);
    }

    let x = x + 3.0 * (w + GAP) - GAP + group;
    let spindle = [
        [Key::SpindleForward, Key::Coolant],
        [Key::SpindleStop, Key::Lubrication],
        [Key::SpindleReverse, Key::ToolChange],
    ];
    grid(parts, &spindle, Rect::new(x, y, w, h), Colour::Machine);

    let x = x + 2.0 * (w + GAP) - GAP + group;
    let overrides = [
        [
            Key::SpindleOverrideUp,
            Key::RapidOverrideUp,
            Key::FeedOverrideUp,
        ],
        [
            Key::SpindleOverrideDown,
            Key::RapidOverrideDown,
            Key::FeedOverrideDown,
        ],
    ];
    grid(parts, &overrides, Rect::new(x, y, w, h), Colour::Machine);
    let half = (3.0 * (w + GAP) - 2.0 * GAP) / 2.0;
    key(
        parts,
        Key::FeedHold,
        Rect::new(x, third, half, h),
        Colour::Hold,
    );
    let start = Rect::new(x + half + GAP, third, half, h);
    key(parts, Key::CycleStart, start, Colour::Start);
}

/// The additional panel: mushroom button, overtravel release and handwheel.
fn additional_panel(parts: &mut Vec<Part>) {
    let Rect { x, y, .. } = ADDITIONAL_PLATE;
    let mut round = |what: What, rect: Rect, colour: Colour| {
        parts.push(Part {
            what,
            rect,
            outline: Outline::Round,
            layer: ON_PLATE,
            colour,
        });
    };
    let stop = Rect::around(x + 66.0, y + 56.0, 88.0);
    round(What::Key(Key::EmergencyStop), stop, Colour::Danger);
    let release = Rect::around(x + 38.0, y + 152.0, 40.0);
    round(What::Key(Key::OvertravelRelease), release, Colour::Dark);
    let wheel = Rect::around(x + 204.0, y + 92.0, 156.0);
    round(What::Handwheel, wheel, Colour::Dark);
    let label = Rect::new(x + 22.0, y + 104.0, 88.0, 16.0);
    print(parts, "急停", 16.0, label, Colour::Print);
    let label = Rect::new(x + 62.0, y + 136.0, 48.0, 16.0);
    print(parts, "超程", 16.0, label, Colour::Print);
    let label = Rect {
        y: y + 152.0,
        ..label
    };
    print(parts, "解除", 16.0, label, Colour::Print);
}
