//! Implements [`Backend`] for line boards.

use core::time::Duration;

use super::{LineLink, MODES};
use crate::contacts;
use crate::line::FirmwareFamily;
use crate::line::describe::next_line;
use crate::line::realtime::SOFT_RESET;
use crate::line::response::{BoardState, LineResponse};
use crate::position::Positioned;
use crate::session::LinkSession;
use crate::{
    Backend, BoardInfo, BoardOutputs, HostTime, Input, LinkState, MotionRefused, PassError, Pins,
    PulseRates, RunTime, Sample, Stop, ThreadCapability, ThreadPass, Traffic, Uncertainty,
};
use gsk_messages::Message;
use gsk_units::{PerAxis, Pulses};

impl Positioned for LineLink {
    fn session(&self) -> &LinkSession {
        &self.session
    }

    fn session_mut(&mut self) -> &mut LinkSession {
        &mut self.session
    }

    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        let standing = self
            .reports
            .status
            .filter(|status| status.state == BoardState::Idle);
        let (LinkState::Locked | LinkState::Ready, Some(board)) = (
            self.session.state,
            standing.and_then(|status| self.motion.board_count(status)),
        ) else {
            return Err(MotionRefused::NotReady);
        };
        self.motion.align(kernel, board, at);
        self.reports.align(kernel);
        for modes in MODES {
            self.send(modes, false);
        }
        Ok(())
    }

    fn forget_count(&mut self) {
        self.reports.forget_count();
    }
}

impl Backend for LineLink {
    fn board(&self) -> &BoardInfo {
        &self.opening.board
    }

    fn threads(&self) -> ThreadCapability {
        self.thread_rights()
    }

    fn cut(&mut self, pass: &ThreadPass) -> Result<(), PassError> {
        self.begin_pass(pass)
    }

    fn pulses_per_mm(&self) -> [f64; 2] {
        self.required.pulses_per_mm
    }

    fn pins(&self) -> Pins {
        self.reports.pins
    }

    fn counted(&self) -> Option<PerAxis<Pulses>> {
        let status = self.reports.status?;
        self.motion.kernel_count(status)
    }

    fn standing_since(&self) -> Option<HostTime> {
        self.reports.still_since()
    }

    fn traffic(&self) -> Traffic {
        self.wire.traffic
    }

    fn executed(&self) -> RunTime {
        self.motion.executed
    }

    fn outstanding(&self) -> Duration {
        self.motion.outstanding(self.session.now)
    }

    fn free_lookahead(&self) -> Duration {
        if !self.is_prepared() || !self.motion.backlog.is_empty() {
            return Duration::ZERO;
        }
        // With a full queue FluidNC checks for `!` and Ctrl-X only 20 times a second, and
        // executes waiting lines after the reset.
        let blocks = usize::from(self.board().blocks);
        if self.opening.family == FirmwareFamily::FluidNc && self.motion.queued.len() + 2 >= blocks
        {
            return Duration::ZERO;
        }
        self.config.lookahead().saturating_sub(self.outstanding())
    }

    fn rates(&self) -> PulseRates {
        let each = f64::from(self.config.line.max_rate);
        PulseRates {
            each: [each; 2],
            both: 2.0 * each,
        }
    }

    fn tx(&self) -> &[u8] {
        self.wire.tx()
    }

    fn consumed(&mut self, count: usize) {
        self.wire.consumed(count);
    }

    fn tick(&mut self, now: HostTime) {
        self.advance_time(now);
        if self.session.is_closed() {
            return;
        }
        if !self.opening.is_done() {
            if self.session.state == LinkState::Fault {
                return;
            }
            let action = self.opening.tick(self.session.now);
            self.open_further(action);
            return;
        }
        self.motion.settle(false, self.session.now);
        self.watch_silence();
        self.watch_pass();
        self.watch_halt();
        self.watch_homing();
        self.query_status_if_due();
        self.verify();
        self.switch();
    }

    fn rx(&mut self, bytes: &[u8], now: HostTime) {
        self.advance_time(now);
        self.wire.traffic.received += bytes.len() as u64;
        if !bytes.is_empty() {
            self.opening.bytes_received(self.session.now);
        }
        for &byte in bytes {
            if let Some(text) = self.wire.receive(byte) {
                self.opening.take_text(&text);
                self.take(&LineResponse::parse(&text));
            }
        }
    }

    fn stop_after_absence(&mut self) {
        self.wake();
    }

    fn lost(&mut self, cause: Message) {
        self.lose_board(cause);
    }

    fn write_settings(&mut self) {
        let action = self.opening.write_settings(self.session.now);
        self.open_further(action);
    }

    fn close(&mut self) {
        self.wire.drop_outgoing();
        if self.opening.is_done() {
            self.wire.send_realtime(SOFT_RESET);
        }
        self.session.lose_position(Uncertainty::Unheard);
        self.enter(LinkState::Off);
    }

    fn stop_bytes(&self) -> Vec<u8> {
        if self.opening.is_done() {
            vec![SOFT_RESET]
        } else {
            Vec::new()
        }
    }

    fn has_answered_stop(&self, answered: &[u8]) -> bool {
        let text = String::from_utf8_lossy(answered);
        let mut lines = text.lines().map(LineResponse::parse);
        lines.any(|line| matches!(line, LineResponse::Banner(_)))
    }

    fn last_position(&self) -> Option<PerAxis<Pulses>> {
        self.reports.position()
    }

    fn is_stopping(&self) -> bool {
        let state = self.session.state;
        let broken = matches!(state, LinkState::Fault | LinkState::Tripped);
        let may_move = broken && self.reports.is_settling(self.session.now);
        let unread = self.reports.counts() && (self.reports.status.is_none() || may_move);
        state != LinkState::Lost
            && (!self.stopping.is_none() || self.stopping.limit.is_some() || unread)
    }

    fn has_answered_since(&self, moment: HostTime) -> bool {
        self.reports.has_answered_since(moment)
    }

    fn takes_motion(&self) -> bool {
        let state = self.session.state;
        (state.takes_motion() || state == LinkState::Locked && self.session.released)
            && self.stopping.is_none()
    }

    fn is_prepared(&self) -> bool {
        self.takes_motion() && !self.thread.is_cutting() && self.wire.only_segments()
    }

    fn homes(&self) -> bool {
        true
    }

    fn homes_alone(&self) -> bool {
        self.opening.alone
    }

    fn home(&mut self, axes: PerAxis<bool>) -> Result<(), MotionRefused> {
        self.begin_homing(axes)
    }

    fn set_outputs(&mut self, outputs: BoardOutputs) {
        self.outputs.wanted = outputs;
    }

    fn switched(&self) -> Option<BoardOutputs> {
        self.wire.only_segments().then_some(self.outputs.switched)
    }

    fn push(&mut self, sample: Sample) -> Result<(), MotionRefused> {
        self.take_sample(sample)
    }

    fn finish(&mut self) -> Result<(), MotionRefused> {
        self.take_rest()
    }

    fn stop(&mut self, stop: Stop) {
        self.stop_at_once(stop);
    }

    fn reset(&mut self) {
        self.reset_faults();
    }

    fn input(&self, input: Input) -> Option<bool> {
        self.reports.status?;
        let pins = self.reports.pins;
        match input {
            Input::LimitX => Some(pins.x),
            Input::LimitZ => Some(pins.z),
            Input::EmergencyStop => Some(pins.emergency),
            Input::Contact { .. } => {
                let mut wired = contacts::wired(&self.config.inputs);
                let (_, pin) = wired.find(|(contact, _)| *contact == input)?;
                let letter = pin.chars().last()?;
                Some(pins.letter(letter) != pin.contains('!'))
            }
            _ => None,
        }
    }

    fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        next_line(outward, collected)
    }
}
