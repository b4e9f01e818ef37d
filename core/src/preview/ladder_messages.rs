//! Predicts messages with which the ladder of the machine stops a program, as far as program
//! and parameters determine them (manual I-3.3.2, II-2.8).

use super::spindle::SpindleRotation;
use crate::alarm::{Alarm, number};
use crate::setup::{MachineLadder, Setup};

/// The data that determine which messages the ladder can raise: the ladder itself and the
/// equipment.
pub(super) struct LadderMessages {
    ladder: MachineLadder,
    chuck: bool,
    tailstock: bool,
}

impl LadderMessages {
    pub(super) fn new(setup: &Setup) -> Self {
        Self {
            ladder: setup.ladder.clone(),
            chuck: setup.memory.parameters.has_chuck(),
            tailstock: setup.memory.parameters.has_tailstock(),
        }
    }

    /// Fails with the alarm that the ladder raises for an M code at the spindle direction
    /// `spindle`.
    pub(super) fn check_m_code(&self, code: u8, spindle: SpindleRotation) -> Result<(), Alarm> {
        let turns = spindle != SpindleRotation::Stopped;
        let number = match code {
            3 if spindle == SpindleRotation::CounterClockwise => number::OTHER_DIRECTION,
            4 if spindle == SpindleRotation::Clockwise => number::OTHER_DIRECTION,
            10 | 11 if !self.tailstock => number::NO_TAILSTOCK,
            11 if turns => number::TAILSTOCK_WHILE_TURNING,
            12 | 13 if !self.chuck => number::NO_CHUCK,
            13 if turns => number::CHUCK_WHILE_TURNING,
            _ => return Ok(()),
        };
        match self.has_message(number) {
            true => Err(Alarm::new(number)),
            false => Ok(()),
        }
    }

    /// Whether the ladder has a message with this number and the text of the alarm table.
    fn has_message(&self, number: u16) -> bool {
        let ladder = self.ladder.compiled();
        let mut messages = ladder.messages().iter();
        messages.any(|message| {
            message.number == number
                && Alarm::from_ladder_message(number, &message.text)
                    .row()
                    .is_some()
        })
    }
}
