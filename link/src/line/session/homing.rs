//! Homing by a line board.

use core::time::Duration;

use super::LineLink;
use crate::line::FirmwareFamily;
use crate::line::response::BoardState;
use crate::{HostTime, LinkEvent, LinkState, MotionRefused, Uncertainty};
use gsk_messages::{Message, say};
use gsk_units::{Axis, PerAxis, alarm};

/// Time limit for homing all requested axes.
const HOMING_WAIT: Duration = Duration::from_secs(120);

/// Homing in progress: its start time and the axes that the board is homing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Homing {
    since: HostTime,
    axes: PerAxis<bool>,
    /// The axes that the board has reported as homed during this homing.
    named: PerAxis<bool>,
}

impl LineLink {
    /// Whether the board can home a single axis.
    pub const fn homes_single_axes(&self) -> bool {
        self.opening.alone
    }

    /// Starts homing of the axes that are `true`, or of both if the board cannot home a single
    /// axis.
    ///
    /// # Errors
    /// The board moves, has not reported its state or is busy, no axis is selected, or an axis is
    /// on the limit switch of its other end.
    pub(super) fn begin_homing(&mut self, axes: PerAxis<bool>) -> Result<(), MotionRefused> {
        if !self.stands_in(&[BoardState::Idle, BoardState::Alarm]) || !(axes.x || axes.z) {
            return Err(MotionRefused::NotReady);
        }
        let all = PerAxis::new(true, true);
        let (line, axes) = match (self.opening.alone, axes.x, axes.z) {
            (true, true, false) => ("$HX", axes),
            (true, false, true) => ("$HZ", axes),
            _ => ("$H", all),
        };
        if let Some(axis) = self.axis_at_opposite_limit(axes) {
            self.session
                .alarm(alarm::BOARD_ZERO_RETURN, say::limit_switch_off_return(axis));
            return Err(MotionRefused::TowardLimit(axis));
        }
        self.limits.forget();
        self.motion.forget_directions();
        self.session.lose_position(Uncertainty::Unreferenced);
        // The board counts from its switches after homing.
        self.reports.forget_count();
        self.reports.forget();
        self.homing = Some(Homing {
            since: self.session.now,
            axes,
            named: PerAxis::default(),
        });
        self.send(line, false);
        self.enter(LinkState::Homing);
        Ok(())
    }

    /// Returns an axis on the limit switch of the end opposite to its homing switch; `None` without
    /// one. The board would take that switch for the homing switch and move the axis farther
    /// towards its mechanical stop.
    fn axis_at_opposite_limit(&self, axes: PerAxis<bool>) -> Option<Axis> {
        [
            (Axis::X, self.config.x.home_negative, self.reports.pins.x),
            (Axis::Z, self.config.z.home_negative, self.reports.pins.z),
        ]
        .into_iter()
        .find_map(|(axis, negative, operated)| {
            let away = if negative { 1 } else { -1 };
            let beyond = operated && self.limits.operated_direction(axis as usize) == Some(away);
            (*axes.get(axis) && beyond).then_some(axis)
        })
    }

    /// Handles the board's answer to the homing command: `error` is the number of the error with
    /// which the board has refused it; `None` if homing is finished.
    pub(super) fn homed(&mut self, error: Option<u16>) {
        let Some(homing) = self.homing.take() else {
            return;
        };
        // A report sent before the start of homing has the old position.
        self.reports.forget();
        let names = self.opening.family == FirmwareFamily::FluidNc;
        let why = match error {
            Some(number) => say::board_refuses_return(number),
            // FluidNC answers `ok` also after failed homing.
            None if names && homing.named != homing.axes => say::board_return_not_confirmed(),
            None => {
                self.session.events.push(LinkEvent::Homed(homing.axes));
                self.enter(LinkState::Locked);
                self.startup.unlocks = names;
                return;
            }
        };
        if names {
            // Until a reset it plans from the position before homing.
            self.restart();
        }
        self.enter(LinkState::Locked);
        self.session.alarm(alarm::BOARD_ZERO_RETURN, why);
    }

    /// Handles a message of the board: FluidNC reports each axis that it has homed.
    pub(super) fn board_message(&mut self, text: &str) {
        if let (Some(homing), Some(axes)) = (&mut self.homing, text.strip_prefix("Homed:")) {
            homing.named.x |= axes.contains('X') && homing.axes.x;
            homing.named.z |= axes.contains('Z') && homing.axes.z;
        }
    }

    pub(super) fn watch_homing(&mut self) {
        if let Some(homing) = self.homing
            && self.session.since(homing.since) >= HOMING_WAIT
        {
            self.give_up_homing(Some(say::board_return_too_long()));
        }
    }

    /// Aborts homing by a reset of the board and locks the link. `why` is the cause for the alarm;
    /// `None`, without an alarm, if the operator has aborted homing.
    pub(super) fn give_up_homing(&mut self, why: Option<Message>) {
        if let Some(why) = why {
            self.session.alarm(alarm::BOARD_ZERO_RETURN, why);
        }
        self.forget_motion();
        self.restart();
        self.startup.excuse(self.session.now);
        self.enter(LinkState::Locked);
    }
}
