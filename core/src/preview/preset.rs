//! Where a program takes the tool to be: the G50 it begins with against the place
//! where it ends, and the machine zero of G28.
//!
//! ```text
//!   first run   G50 X100 Z50 here --> o ~~~ cuts ~~~ o <-- M30 here
//!   second run                           G50 X100 Z50 here: all is shifted
//! ```

use super::caution::Slip;
use super::written::{has, words};
use super::{End, Walk, snapped};
use crate::command::Source;
use crate::setup::Setup;
use crate::units::Point;

/// The end may be so far from the place of G50, mm (X as a diameter): less comes of a
/// tool offset that is dropped at the end.
const NEAR: f64 = 1.0;

/// The places that a program takes for given.
#[derive(Debug)]
pub(super) struct SetPlace {
    /// Somebody has said where the work lies on the machine.
    zero_known: bool,
    /// G28 went to a machine zero of which nobody has said where it lies.
    returned: bool,
    /// A block with X or Z has moved the tool.
    moved: bool,
    preset: Option<Preset>,
}

/// The G50 before any motion.
#[derive(Clone, Copy, Debug)]
struct Preset {
    source: Source,
    /// Whether it names X, Z.
    x: bool,
    z: bool,
    /// The tool by its coordinates, and their zero.
    at: Point,
    zero: Point,
}

impl SetPlace {
    pub(super) const fn new(setup: &Setup) -> Self {
        Self {
            zero_known: setup.absolute.is_some(),
            returned: false,
            moved: false,
            preset: None,
        }
    }
}

impl Walk<'_> {
    /// A G50 with coordinates was carried out. Increments shift the work on purpose.
    pub(super) fn look_at_preset(&mut self, source: Source) {
        let frame = self.so_far.frame;
        let shifted = self.so_far.parameters.offset_by_shift() && frame.offset != Point::default();
        if self.set_place.moved || shifted {
            return;
        }
        let words = words(self.line_of(source));
        let before = self.set_place.preset;
        let x = has(&words, b'X') || before.is_some_and(|preset| preset.x);
        let z = has(&words, b'Z') || before.is_some_and(|preset| preset.z);
        if !x && !z {
            return;
        }
        self.set_place.preset = Some(Preset {
            source: before.map_or(source, |preset| preset.source),
            x,
            z,
            at: frame.program(self.so_far.machine),
            zero: frame.zero,
        });
    }

    /// A move was commanded, of whatever length.
    pub(super) fn look_at_move(&mut self, source: Source) {
        if !self.set_place.moved {
            let words = words(self.line_of(source));
            let axes = [b'X', b'U', b'Z', b'W'];
            self.set_place.moved = axes.iter().any(|letter| has(&words, *letter));
        }
    }

    /// A G28 was made.
    pub(super) fn look_at_return(&mut self, source: Source) {
        if !self.set_place.zero_known {
            self.set_place.returned = true;
            self.caution(Slip::MachineZero, source);
        }
    }

    /// The program is over.
    pub(super) fn look_at_end(&mut self) {
        let so_far = &self.so_far;
        let offset = match so_far.end {
            End::M99 => so_far.frame.offset,
            End::M30 | End::M02 | End::Text if so_far.parameters.reset_keeps_offset() => {
                so_far.frame.offset
            }
            End::M30 | End::M02 | End::Text => Point::default(),
            End::Alarm | End::Limit => return,
        };
        let Some(preset) = self.set_place.preset.filter(|_| !self.set_place.returned) else {
            return;
        };
        let end = so_far.machine - preset.zero - offset;
        let off = end - preset.at;
        let elsewhere =
            (preset.x && off.diameter().0.abs() > NEAR) || (preset.z && off.z.abs() > NEAR);
        if elsewhere {
            let radius = so_far.parameters.radius_programming();
            let programmed = |point: Point| {
                let point = snapped(point);
                let x = if radius { point.x } else { point.diameter().0 };
                let shown = |value: f64| libm::round(value * 1000.0) / 1000.0 + 0.0;
                (shown(x), shown(point.z))
            };
            let (set, end) = (programmed(preset.at), programmed(end));
            self.caution(Slip::EndElsewhere { set, end }, preset.source);
        }
    }
}
