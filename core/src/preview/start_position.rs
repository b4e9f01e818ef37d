//! Checks the position that a program assumes for the tool: its first G50 against its end
//! position, and the machine zero of G28.
//!
//! ```text
//!   first run   G50 X100 Z50 here --> o ~~~ cuts ~~~ o <-- M30 here
//!   second run                           G50 X100 Z50 here: all moves are shifted
//! ```

use super::caution::CautionKind;
use super::line_words::{has_letter, split_line};
use super::{PreviewEnd, PreviewRun, remove_noise};
use crate::command::{Action, ControlCommand, SourcePosition, Unplaced};
use crate::setup::Setup;
use crate::units::{PerAxis, Point};

/// Distance, mm (X as a diameter), that is allowed between the end of the program and the
/// position of G50: a tool offset that is cancelled at the end causes it.
const END_TOLERANCE_MM: f64 = 1.0;

/// State of the check of the positions that a program assumes for the tool.
#[derive(Debug)]
pub(super) struct StartPositionCheck {
    /// Whether the position of the work on the machine is known.
    is_zero_known: bool,
    /// Whether G28 went to a machine zero whose position is unknown.
    has_returned: bool,
    /// Axes that are at such a machine zero, or have only moved by increments since.
    unknown_axes: PerAxis<bool>,
    /// Whether a block with X or Z has moved the tool.
    has_moved: bool,
    preset: Option<InitialPreset>,
}

/// The G50 that sets the tool position before the first motion.
#[derive(Clone, Copy, Debug)]
struct InitialPreset {
    source: SourcePosition,
    /// Whether the G50 has an X word; the next one: a Z word.
    sets_x: bool,
    sets_z: bool,
    /// Position of the tool that the G50 sets, and the work zero that follows from it, mm.
    tool_position: Point,
    zero: Point,
}

impl StartPositionCheck {
    pub(super) const fn new(setup: &Setup) -> Self {
        Self {
            is_zero_known: setup.absolute.is_some(),
            has_returned: false,
            unknown_axes: PerAxis::new(false, false),
            has_moved: false,
            preset: None,
        }
    }
}

impl PreviewRun<'_> {
    /// Records a G50 that sets coordinates before the first motion. A G50 with increments only
    /// is ignored: it shifts the work on purpose.
    pub(super) fn record_preset(&mut self, source: SourcePosition) {
        let frame = self.preview.frame;
        // The current position of the tool has known coordinates from here, wherever it is
        // on the machine.
        self.position_check.unknown_axes = PerAxis::new(false, false);
        let shifted =
            self.preview.parameters.is_offset_by_shift() && frame.offset != Point::default();
        if self.position_check.has_moved || shifted {
            return;
        }
        let words = split_line(self.line_text(source));
        let before = self.position_check.preset;
        let x = has_letter(&words, b'X') || before.is_some_and(|preset| preset.sets_x);
        let z = has_letter(&words, b'Z') || before.is_some_and(|preset| preset.sets_z);
        if !x && !z {
            return;
        }
        self.position_check.preset = Some(InitialPreset {
            source: before.map_or(source, |preset| preset.source),
            sets_x: x,
            sets_z: z,
            tool_position: frame.to_program(self.preview.machine),
            zero: frame.zero,
        });
    }

    /// Records that a block has commanded a move, even one without length.
    pub(super) fn record_move(&mut self, source: SourcePosition) {
        if !self.position_check.has_moved {
            let words = split_line(self.line_text(source));
            let axes = [b'X', b'U', b'Z', b'W'];
            self.position_check.has_moved = axes.iter().any(|letter| has_letter(&words, *letter));
        }
    }

    /// Records a G28 of the axes `axes`, and adds a caution if the machine zero is unknown.
    pub(super) fn record_return(&mut self, source: SourcePosition, axes: PerAxis<bool>) {
        if !self.position_check.is_zero_known {
            self.position_check.has_returned = true;
            self.position_check.unknown_axes.x |= axes.x;
            self.position_check.unknown_axes.z |= axes.z;
            self.add_caution(CautionKind::MachineZero, source);
        }
    }

    /// Whether a rapid, which is not the last command of its block, may lead to an unknown
    /// machine zero.
    pub(super) const fn can_reach_machine_zero(&self, command: &ControlCommand) -> bool {
        !self.position_check.is_zero_known && !command.block_end
    }

    /// Reports the rapid that may have led to a machine zero. `next`, the following command,
    /// determines whether it has.
    pub(super) fn report_return(&mut self, next: Option<&ControlCommand>) {
        let Some((mut executed, explanation)) = self.pending_return.take() else {
            return;
        };
        if let Some(ControlCommand {
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
        self.report_move(&executed);
        self.explanation = next;
    }

    /// The axes whose coordinates are unknown before and after a move. An absolute word makes
    /// an axis known again.
    pub(super) fn update_unplaced(&mut self, source: SourcePosition) -> Unplaced {
        let from = self.position_check.unknown_axes;
        if !from.x && !from.z {
            return Unplaced::default();
        }
        let words = split_line(self.line_text(source));
        let to = PerAxis::new(
            from.x && !has_letter(&words, b'X'),
            from.z && !has_letter(&words, b'Z'),
        );
        self.position_check.unknown_axes = to;
        Unplaced { from, to }
    }

    /// Adds a caution if the program does not end at the position that its first G50 sets.
    pub(super) fn check_end_position(&mut self) {
        let so_far = &self.preview;
        let offset = match so_far.end {
            PreviewEnd::M99 => so_far.frame.offset,
            PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::Text
                if so_far.parameters.reset_keeps_offset() =>
            {
                so_far.frame.offset
            }
            PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::Text => Point::default(),
            PreviewEnd::Alarm | PreviewEnd::Limit => return,
        };
        let Some(preset) = self
            .position_check
            .preset
            .filter(|_| !self.position_check.has_returned)
        else {
            return;
        };
        let end = so_far.machine - preset.zero - offset;
        let off = end - preset.tool_position;
        let is_elsewhere = (preset.sets_x && off.diameter().0.abs() > END_TOLERANCE_MM)
            || (preset.sets_z && off.z.abs() > END_TOLERANCE_MM);
        if is_elsewhere {
            let radius = so_far.parameters.is_radius_programming();
            let programmed = |point: Point| {
                let point = remove_noise(point);
                let x = if radius { point.x } else { point.diameter().0 };
                let shown = |value: f64| libm::round(value * 1000.0) / 1000.0 + 0.0;
                (shown(x), shown(point.z))
            };
            let (set, end) = (programmed(preset.tool_position), programmed(end));
            self.add_caution(CautionKind::EndElsewhere { set, end }, preset.source);
        }
    }
}
