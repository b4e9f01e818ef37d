//! Switches spindle, spindle speed and coolant in step with the motion.

use core::time::Duration;

use super::StepLink;
use crate::step_queue::commands::Command;
use crate::step_queue::step_compress::Ticks;
use crate::step_queue::wiring::OutputPin;
use crate::{BoardOutputs, HostTime, LinkState, MotionRefused, Output, RunTime, SpindleDirection};

/// Least interval between two spindle speed commands: G96 changes the speed in each tick.
const SPEED_EVERY: Duration = Duration::from_millis(20);
/// Time by which an output command is sent earlier than motion for the same board clock.
const AHEAD: Duration = Duration::from_millis(30);
/// Voltage of the spindle speed output at the greatest speed, mV.
const FULL_MV: i64 = 10_000;

/// The states of spindle and coolant: those that the kernel wants, and those sent to the board.
#[derive(Clone, Debug, Default)]
pub(super) struct StepQueueOutputs {
    /// The states of the outputs that the kernel requests.
    pub(super) wanted: BoardOutputs,
    /// The states of the outputs that were sent to the board.
    pub(super) sent: BoardOutputs,
    /// Kernel time and host time of the last spindle speed that was sent.
    speed_sent: (RunTime, HostTime),
    /// The last value sent to each output pin, and the board clock at which it takes effect, ticks.
    pins: Vec<(OutputPin, i64, u64)>,
}

impl StepLink {
    /// Sends the outputs whose wanted state differs from the state sent before. Returns false if
    /// none differs or the link cannot send.
    pub(super) fn send_wanted(&mut self) -> bool {
        let (mut wanted, sent) = (self.periodic.outputs.wanted, self.periodic.outputs.sent);
        if wanted == sent || !self.is_running() || self.session.state == LinkState::Lost {
            return false;
        }
        let at = self.motion.path.newest.end;
        let (run, host) = self.periodic.outputs.speed_sent;
        let soon = at.saturating_sub(run) < SPEED_EVERY && self.session.since(host) < SPEED_EVERY;
        if wanted.spindle == sent.spindle && soon {
            wanted.millivolts = sent.millivolts;
        } else if wanted.millivolts != sent.millivolts {
            self.periodic.outputs.speed_sent = (at, self.session.now);
        }
        let turns = |way| i32::from(wanted.spindle == way);
        // An output that is not wired remains simulated.
        for (output, value) in [
            (Output::SpindleForward, turns(SpindleDirection::Forward)),
            (Output::SpindleReverse, turns(SpindleDirection::Reverse)),
            (Output::SpindleSpeed, wanted.millivolts.into()),
            (Output::Coolant, wanted.coolant.into()),
        ] {
            let _ = self.switch_output(at, output, value);
        }
        self.periodic.outputs.sent = wanted;
        true
    }

    /// Switches an output to `value` (0 or 1; mV for the spindle speed) when the board has executed
    /// the motion up to the kernel time `at`.
    ///
    /// # Errors
    /// The board is not ready, or the output is not wired.
    pub(super) fn switch_output(
        &mut self,
        at: RunTime,
        output: Output,
        value: i32,
    ) -> Result<(), MotionRefused> {
        if !self.is_running() || self.session.state == LinkState::Lost {
            return Err(MotionRefused::NotReady);
        }
        let wiring = self.wiring.as_ref().ok_or(MotionRefused::NotReady)?;
        let output_pin = wiring
            .outputs
            .iter()
            .find(|output_pin| output_pin.output == output);
        let (output_pin, full) = (
            *output_pin.ok_or(MotionRefused::NotWired)?,
            i64::from(wiring.full),
        );
        let value = if output == Output::SpindleSpeed {
            let part = i64::from(value).clamp(0, FULL_MV) * full / FULL_MV;
            if output_pin.inverted {
                full - part
            } else {
                part
            }
        } else {
            i64::from((value != 0) != output_pin.inverted)
        };
        let sent = self.periodic.outputs.pins.iter();
        if sent
            .copied()
            .any(|sent| (sent.0, sent.1) == (output_pin, value))
        {
            return Ok(());
        }
        // In a thread the clock of the path runs with the spindle.
        let ahead = self.clock.at(self.session.now) as Ticks - self.path_now();
        let made = self.motion.path.piece_at(at).map_or(0, |piece| {
            let rest = at.saturating_sub(piece.sample.end);
            (piece.clock + ahead).unsigned_abs() + self.clock.ticks(rest)
        });
        let earliest = self.clock.at(self.session.now + self.margin() + AHEAD);
        self.switch(output_pin, value, made.max(earliest));
        Ok(())
    }

    fn switch(&mut self, output_pin: OutputPin, value: i64, clock: u64) {
        let sent = self
            .periodic
            .outputs
            .pins
            .iter_mut()
            .find(|(sent, ..)| *sent == output_pin);
        let clock = match sent {
            Some(sent) => {
                let clock = clock.max(sent.2 + 1);
                *sent = (output_pin, value, clock);
                clock
            }
            None => {
                self.periodic.outputs.pins.push((output_pin, value, clock));
                clock
            }
        };
        let command = if output_pin.output == Output::SpindleSpeed {
            Command::QueuePwmOut
        } else {
            Command::QueueDigitalOut
        };
        self.wire.send_timed(
            command,
            &[output_pin.oid, i64::from(clock as u32), value],
            clock,
        );
    }

    /// Sends all outputs again after a stop: earlier commands may not have arrived.
    pub(super) fn resend_outputs(&mut self) {
        let soon = self.soon();
        for (output_pin, value, _) in self.periodic.outputs.pins.clone() {
            self.switch(output_pin, value, soon);
        }
    }
}
