//! Lays out the parts of the panel.

use super::{Outline, PanelArea, PanelColour, PanelPart, PartKind, Rect, SIZE, text};
use crate::face::{Face, GAP, KeyGrid};
use crate::keys::{Key, STRIP, StripLamp};

/// Rectangle of the LCD on the panel, panel units.
pub(super) const LCD: Rect = Rect::new(28.0, 60.0, 640.0, 480.0);

const BEZEL: Rect = Rect::new(14.0, 46.0, 668.0, 508.0);
const STRIP_PLATE: Rect = Rect::new(14.0, 10.0, 668.0, 30.0);
const NAME_PLATE: Rect = Rect::new(694.0, 10.0, 572.0, 60.0);
const EDIT_PLATE: Rect = Rect::new(694.0, 78.0, 572.0, 372.0);
const PAGE_PLATE: Rect = Rect::new(694.0, 458.0, 572.0, 96.0);
/// Line height of the small print on the name plate, panel units.
pub(super) const PLATE_PRINT: f32 = 21.0;
/// Distance of the status lamps from the left and right edge of their plate, panel units.
const STRIP_MARGIN: f32 = 2.0;
/// Line height of the name of a status lamp, panel units: 11 pixels on an LCD with one pixel per
/// dot.
pub(super) const LAMP_NAME_HEIGHT: f32 = 24.0;
/// Distance of the name from the left edge of its lamp, panel units.
pub(super) const LAMP_NAME_LEFT: f32 = 18.0;
/// Plate of the mode, toggle and increment keys, panel units.
const MACHINE_PLATE: Rect = Rect::new(14.0, 562.0, 388.0, 184.0);
const DIRECTION_PLATE: Rect = Rect::new(410.0, 562.0, 196.0, 184.0);
/// Plate of the keys of spindle, auxiliary functions, overrides, hold and start, panel units.
const RUN_PLATE: Rect = Rect::new(614.0, 562.0, 346.0, 184.0);
const ADDITIONAL_PLATE: Rect = Rect::new(970.0, 562.0, 296.0, 184.0);

/// The sections of the panel, each with a margin: LCD, name plate, edit keyboard, modes,
/// directions, spindle and start, additional panel.
pub(super) const SECTIONS: [PanelArea; 7] = [
    PanelArea::new(Rect::new(9.0, 4.0, 677.0, 554.0)),
    PanelArea::new(Rect::new(686.0, 2.0, 588.0, 76.0)),
    PanelArea::new(Rect::new(686.0, 72.0, 588.0, 488.0)),
    PanelArea::new(Rect::new(9.0, 555.0, 398.0, 198.0)),
    PanelArea::new(Rect::new(405.0, 555.0, 206.0, 198.0)),
    PanelArea::new(Rect::new(606.0, 555.0, 362.0, 198.0)),
    PanelArea::new(Rect::new(962.0, 555.0, 312.0, 198.0)),
];

/// Number of the lowest drawing layer, for the background of the panel.
const HOUSING: u8 = 0;
const PLATE: u8 = 1;
const ON_PLATE: u8 = 2;

pub(super) fn parts(face: &Face) -> Vec<PanelPart> {
    let mut parts = vec![PanelPart {
        what: PartKind::Housing,
        rect: Rect::new(0.0, 0.0, SIZE.0, SIZE.1),
        outline: Outline::Rounded(14.0),
        layer: HOUSING,
        colour: PanelColour::Housing,
        print: &[],
    }];
    for rect in [
        STRIP_PLATE,
        NAME_PLATE,
        EDIT_PLATE,
        PAGE_PLATE,
        MACHINE_PLATE,
        DIRECTION_PLATE,
        RUN_PLATE,
        ADDITIONAL_PLATE,
    ] {
        parts.push(PanelPart {
            what: PartKind::Plate,
            rect,
            outline: Outline::Rounded(8.0),
            layer: PLATE,
            colour: PanelColour::Plate,
            print: &[],
        });
    }
    parts.push(PanelPart {
        what: PartKind::Bezel,
        rect: BEZEL,
        outline: Outline::Rounded(10.0),
        layer: PLATE,
        colour: PanelColour::Bezel,
        print: &[],
    });
    parts.push(PanelPart {
        what: PartKind::Lcd,
        rect: LCD,
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour: PanelColour::Lcd,
        print: &[],
    });
    strip(&mut parts);
    name_plate(&mut parts);
    for keys in face.grids {
        grid(&mut parts, face, keys);
    }
    additional_panel(&mut parts);
    parts
}

fn print(
    parts: &mut Vec<PanelPart>,
    text: &'static str,
    size: f32,
    rect: Rect,
    colour: PanelColour,
) {
    parts.push(PanelPart {
        what: PartKind::Text(text, size),
        rect,
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour,
        print: &[],
    });
}

/// Adds the strip of status lamps above the LCD to the parts. The width of a lamp depends on its
/// name, so that the names are as large as they fit.
fn strip(parts: &mut Vec<PanelPart>) {
    // Away from the edges of the plate: a lamp that changes repaints no edge.
    let mut left = STRIP_PLATE.x + STRIP_MARGIN;
    let used: f32 = STRIP.iter().map(lamp_width).sum();
    let fitted = STRIP.iter().filter(|lamp| lamp.fitted).count() as f32;
    let gap = (STRIP_PLATE.w - 2.0 * STRIP_MARGIN - used) / fitted;
    for (index, lamp) in STRIP.iter().enumerate() {
        let gap = if lamp.fitted { gap } else { 0.0 };
        let end = left + lamp_width(lamp) + gap;
        parts.push(PanelPart {
            what: PartKind::Strip(index),
            rect: Rect::new(
                left.ceil(),
                STRIP_PLATE.y + 3.0,
                end.floor() - left.ceil(),
                24.0,
            ),
            outline: Outline::Rounded(4.0),
            layer: ON_PLATE,
            colour: PanelColour::Print,
            print: &[],
        });
        left = end;
    }
}

/// Width of a lamp with its name; a lamp that is not fitted is as narrow as a mark.
fn lamp_width(lamp: &StripLamp) -> f32 {
    match lamp.fitted {
        true => LAMP_NAME_LEFT + text::width(lamp.label, LAMP_NAME_HEIGHT),
        false => 4.0,
    }
}

fn name_plate(parts: &mut Vec<PanelPart>) {
    let Rect { x, y, w, h } = NAME_PLATE;
    parts.push(PanelPart {
        what: PartKind::Model,
        rect: Rect::new(x + 20.0, y + 4.0, 160.0, h - 8.0),
        outline: Outline::Rounded(0.0),
        layer: ON_PLATE,
        colour: PanelColour::Print,
        print: &[],
    });
    let right = Rect::new(x + w - 190.0, y + 7.0, 180.0, PLATE_PRINT);
    print(
        parts,
        "车床数控系统",
        PLATE_PRINT,
        right,
        PanelColour::Print,
    );
    let below = Rect {
        y: y + 32.0,
        ..right
    };
    let middle = Rect::new(x + 188.0, y + 6.0, 190.0, h - 12.0);
    for (what, rect, radius, colour) in [
        (PartKind::Emulator, below, 0.0, PanelColour::Hint),
        (PartKind::RealMotion, middle, 6.0, PanelColour::Danger),
    ] {
        parts.push(PanelPart {
            what,
            rect,
            outline: Outline::Rounded(radius),
            layer: ON_PLATE,
            colour,
            print: &[],
        });
    }
}

/// Adds rows of equally large keys to the parts.
fn grid(parts: &mut Vec<PanelPart>, face: &Face, grid: &KeyGrid) {
    let first = grid.first;
    for (row, keys) in grid.rows.iter().enumerate() {
        for (column, key) in keys.iter().enumerate() {
            let rect = Rect::new(
                first.x + column as f32 * (first.w + GAP),
                first.y + row as f32 * (first.h + GAP),
                first.w,
                first.h,
            );
            let Some(row) = face.key(*key) else {
                continue;
            };
            parts.push(PanelPart {
                what: PartKind::Key(*key),
                rect,
                outline: Outline::Rounded(6.0),
                layer: ON_PLATE,
                colour: grid.colour,
                print: row.legend,
            });
        }
    }
}

/// Adds the parts of the additional panel: mushroom button, overtravel release and handwheel.
fn additional_panel(parts: &mut Vec<PanelPart>) {
    let Rect { x, y, .. } = ADDITIONAL_PLATE;
    let mut round = |what: PartKind, rect: Rect, colour: PanelColour| {
        parts.push(PanelPart {
            what,
            rect,
            outline: Outline::Round,
            layer: ON_PLATE,
            colour,
            print: &[],
        });
    };
    let stop = Rect::around(x + 66.0, y + 56.0, 88.0);
    round(PartKind::Key(Key::EmergencyStop), stop, PanelColour::Danger);
    let release = Rect::around(x + 38.0, y + 152.0, 40.0);
    round(
        PartKind::Key(Key::OvertravelRelease),
        release,
        PanelColour::Dark,
    );
    let wheel = Rect::around(x + 204.0, y + 92.0, 156.0);
    round(PartKind::Handwheel, wheel, PanelColour::Dark);
    let label = Rect::new(x + 22.0, y + 104.0, 88.0, 16.0);
    print(parts, "急停", 16.0, label, PanelColour::Print);
    let label = Rect::new(x + 62.0, y + 136.0, 48.0, 16.0);
    print(parts, "超程", 16.0, label, PanelColour::Print);
    let label = Rect {
        y: y + 152.0,
        ..label
    };
    print(parts, "解除", 16.0, label, PanelColour::Print);
}
