//! Checks the position that a program assumes for the tool: its first G50 against its end
//! position, and the machine zero of G28.
//!
//! ```text
//!   first run   G50 X100 Z50 here --> o ~~~ cuts ~~~ o <-- M30 here
//!   second run                           G50 X100 Z50 here: all moves are shifted
//! ```

use super::caution::Slip;
use super::written::{has, words};
use super::{End, Walk, snapped};
use crate::command::{Action, Command, Source, Unplaced};
use crate::setup::Setup;
use crate::units::{PerAxis, Point};

/// Allowed distance between the end and the position of G50, mm (X as a diameter): a tool
/// offset that is cancelled at the end causes such a distance.
const NEAR: f64 = 1.0;

/// The positions that a program assumes.
#[derive(Debug)]
pub(super) struct SetPlace {
    /// The position of the work on the machine is known.
    zero_known: bool,
    /// G28 went to a machine zero at an unknown position.
    returned: bool,
    /// Axes that are at such a machine zero, or have only moved by increments since.
    unplaced: PerAxis<bool>,
    /// A block with X or Z has moved the tool.
    moved: bool,
    preset: Option<Preset>,
}

/// The G50 before the first motion.
#[derive(Clone, Copy, Debug)]
struct Preset {
    source: Source,
    /// Whether it has an X word, a Z word.
    x: bool,
    z: bool,
    /// Position of the tool in its coordinates, and their zero.
    at: Point,
    zero: Point,
}

impl SetPlace {
    pub(super) const fn new(setup: &Setup) -> Self {
        Self {
            zero_known: setup.absolute.is_some(),
            returned: false,
            unplaced: PerAxis::new(false, false),
            moved: false,
            preset: None,
        }
    }
}

impl Walk<'_> {
    /// Records a G50 with coordinates. Increments shift the work on purpose.
    pub(super) fn look_at_preset(&mut self, source: Source) {
        let frame = self.so_far.frame;
        // The current position of the tool has known coordinates from here, wherever it is
        // on the machine.
        self.set_place.unplaced = PerAxis::new(false, false);
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

    /// Records a commanded move of any length.
    pub(super) fn look_at_move(&mut self, source: Source) {
        if !self.set_place.moved {
            let words = words(self.line_of(source));
            let axes = [b'X', b'U', b'Z', b'W'];
            self.set_place.moved = axes.iter().any(|letter| has(&words, *letter));
        }
    }

    /// Records a G28 of these axes.
    pub(super) fn look_at_return(&mut self, source: Source, axes: PerAxis<bool>) {
        if !self.set_place.zero_known {
            self.set_place.returned = true;
            self.set_place.unplaced.x |= axes.x;
            self.set_place.unplaced.z |= axes.z;
            self.caution(Slip::MachineZero, source);
        }
    }

    /// Whether a rapid within its block may lead to an unknown machine zero.
    pub(super) const fn may_return(&self, command: &Command) -> bool {
        !self.set_place.zero_known && !command.block_end
    }

    /// Reports a rapid that may have led to a machine zero. The next command determines
    /// whether it has.
    pub(super) fn show_return(&mut self, next: Option<&Command>) {
        let Some((mut executed, explanation)) = self.returning.take() else {
            return;
        };
        if let Some(Command {
            action: Action::ZeroReturn { x, z } | Action::Referenced { x, z },
            source,
            ..
        }) = next
            && *source == executed.source
        {
            executed.conditions.unplaced.to.x |= *x;
            executed.conditions.unplaced.to.z |= *z;
        }
        let next = core::mem::replace(&mut self.explanation, explanation);
        self.show(&executed);
        self.explanation = next;
    }

    /// The axes whose coordinates are unknown during a move. An axis with an absolute word
    /// is known again after it.
    pub(super) fn unplaced(&mut self, source: Source) -> Unplaced {
        let from = self.set_place.unplaced;
        if !from.x && !from.z {
            return Unplaced::default();
        }
        let words = words(self.line_of(source));
        let to = PerAxis::new(from.x && !has(&words, b'X'), from.z && !has(&words, b'Z'));
        self.set_place.unplaced = to;
        Unplaced { from, to }
    }

    /// Compares the end position with that of G50.
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
