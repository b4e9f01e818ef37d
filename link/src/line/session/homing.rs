//! The reference return that the board makes by itself.

use core::time::Duration;

use super::LineLink;
use crate::line::FirmwareFamily;
use crate::line::response::BoardState;
use crate::{HostTime, LinkEvent, LinkState, MotionRefused, Uncertainty};
use gsk_messages::{Message, say};
use gsk_units::{Axis, PerAxis, alarm};

/// A reference return ends within this.
const HOMING_WAIT: Duration = Duration::from_secs(120);

/// A reference return that the board makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Homing {
    since: HostTime,
    axes: PerAxis<bool>,
    /// The board has named them as being home.
    named: PerAxis<bool>,
}

impl LineLink {
    /// Whether the board can seek the switch of one axis alone.
    pub const fn homes_single_axes(&self) -> bool {
        self.opening.alone
    }

    /// Begins the reference return of these axes, of all where the board knows no other.
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
        if let Some(axis) = self.stands_beyond(axes) {
            self.session
                .alarm(alarm::BOARD_ZERO_RETURN, say::limit_switch_off_return(axis));
            return Err(MotionRefused::TowardLimit(axis));
        }
        self.limits.forget();
        self.motion.forget_directions();
        self.session.lose_position(Uncertainty::Unreferenced);
        // It counts anew from its switches.
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

    /// An axis upon the limit switch of its other end: the board would take it for that of
    /// its reference, and go farther when it means to go off it.
    fn stands_beyond(&self, axes: PerAxis<bool>) -> Option<Axis> {
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

    /// The board has answered its reference return.
    pub(super) fn homed(&mut self, error: Option<u16>) {
        let Some(homing) = self.homing.take() else {
            return;
        };
        // A report that was under way when the return began gives the old position.
        self.reports.forget();
        let names = self.opening.family == FirmwareFamily::FluidNc;
        let why = match error {
            Some(number) => say::board_refuses_return(number),
            // It answers so whatever came of it.
            None if names && homing.named != homing.axes => say::board_return_not_confirmed(),
            None => {
                self.session.events.push(LinkEvent::Homed(homing.axes));
                self.enter(LinkState::Locked);
                self.startup.unlocks = names;
                return;
            }
        };
        if names {
            // It plans from the position before the return until it is reset.
            self.restart();
        }
        self.enter(LinkState::Locked);
        self.session.alarm(alarm::BOARD_ZERO_RETURN, why);
    }

    /// FluidNC names each axis that has come home.
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

    /// Stops a reference return; `why` for one that was not stopped by the operator.
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
