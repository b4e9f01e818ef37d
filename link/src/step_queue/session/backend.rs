//! Implements [`Backend`] for boards with timed steps.

use core::time::Duration;

use super::opening::Phase;
use super::samples::{FLUSH_EVERY, MOST_WAITING};
use super::{PositionQuery, QueryPurpose, StepLink};
use crate::position::Positioned;
use crate::session::LinkSession;
use crate::step_queue::commands::Command;
use crate::step_queue::send_queue::Ack;
use crate::step_queue::step_compress::Ticks;
use crate::step_queue::{block, describe};
use crate::{
    AwaitedInput, Backend, BoardInfo, BoardOutputs, EncoderReading, HostTime, Input, LinkState,
    MissingForThreads, MotionRefused, Output, PassError, Pins, PulseRates, RunTime, Sample,
    SpindleView, Stop, TapCapability, TapOrder, ThreadCapability, ThreadPlan, Traffic, Uncertainty,
};
use gsk_messages::Message;
use gsk_units::{Axis, PerAxis, Pulses};

impl Positioned for StepLink {
    fn session(&self) -> &LinkSession {
        &self.session
    }

    fn session_mut(&mut self) -> &mut LinkSession {
        &mut self.session
    }

    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        let by_limit =
            self.session.state == LinkState::Tripped && self.motion.limits.is_any_operated();
        let standing = (matches!(self.session.state, LinkState::Locked | LinkState::Ready)
            || by_limit)
            && self.stopping.is_none()
            && !self.opening.is_shut_down()
            && !self.motion.is_under_way()
            && self.periodic.switches.all_reported(self.wiring.as_ref());
        let (true, Some(board)) = (standing, self.motion.count.board) else {
            return Err(MotionRefused::NotReady);
        };
        self.motion.align(kernel, board, at);
        self.periodic.enable.on = true;
        self.group.forget_edges();
        self.arm_group();
        Ok(())
    }

    fn lose_position(&mut self, uncertainty: Uncertainty) {
        self.session.lose_position(uncertainty);
        self.motion.count.mark_stale();
    }

    fn forget_count(&mut self) {
        self.motion.count.forget();
    }
}

impl Backend for StepLink {
    fn add_dictionaries(&mut self, dictionaries: Vec<Vec<u8>>) {
        for packed in dictionaries {
            self.opening.dictionary_cache.insert(packed);
        }
    }

    fn board(&self) -> &BoardInfo {
        &self.opening.info
    }

    fn threads(&self) -> ThreadCapability {
        if self.sees_spindle() {
            return ThreadCapability::Followed;
        }
        ThreadCapability::None(MissingForThreads {
            index: true,
            ..MissingForThreads::default()
        })
    }

    fn pulses_per_mm(&self) -> [f64; 2] {
        self.pulses_per_mm
    }

    fn pins(&self) -> Pins {
        let operated = |input| self.input(input) == Some(true);
        Pins {
            x: operated(Input::LimitX),
            z: operated(Input::LimitZ),
            emergency: operated(Input::EmergencyStop),
            ..Pins::default()
        }
    }

    fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.motion.count.counted()
    }

    fn standing_since(&self) -> Option<HostTime> {
        let last = self.motion.queue.last_step()?;
        let at = self.clock.moment(last);
        (at <= self.session.now).then_some(at)
    }

    fn traffic(&self) -> Traffic {
        self.wire.traffic()
    }

    fn executed(&self) -> RunTime {
        self.motion.path.executed
    }

    fn outstanding(&self) -> Duration {
        let now = self.path_now();
        let end = self.motion.path.end.map_or(0, |end| (end - now).max(0));
        self.clock.duration(end.unsigned_abs())
    }

    fn free_lookahead(&self) -> Duration {
        if !self.is_prepared() || self.angle.blocks_motion() {
            return Duration::ZERO;
        }
        if !self.motion.queue.backlog.is_empty() || self.wire.send_queue.backlog() > MOST_WAITING {
            return Duration::ZERO;
        }
        let most = self.farthest();
        let lead = self.clock.ticks(self.margin() + FLUSH_EVERY) as Ticks;
        let end = self.motion.path.end.unwrap_or(most - lead);
        self.clock.duration((most - end).max(0).unsigned_abs())
    }

    fn rates(&self) -> PulseRates {
        self.motion.rates.most
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
        self.open_further();
        if self.is_running() {
            self.run_periodic();
            self.watch_group();
            self.repeat_position_query();
            self.advance_motion();
            self.repeat_level_queries();
        }
        if self.opening.is_shut_down() {
            self.repeat_position_query();
        }
        // Send nothing to a restarting board.
        if !matches!(self.opening.phase, Phase::Restarting { .. }) {
            self.send();
        }
    }

    fn rx(&mut self, bytes: &[u8], now: HostTime) {
        self.advance_time(now);
        self.wire.traffic.received += bytes.len() as u64;
        if self.session.is_closed() {
            return;
        }
        self.wire.reader.give(bytes);
        while let Some(block) = self.wire.reader.next() {
            let ack = self.wire.send_queue.block_received(
                block.sequence,
                block.content.is_empty(),
                self.session.now,
            );
            let Some(Ack::Expects(expects)) = ack else {
                if ack.is_some() {
                    self.unexpected_sequence(&block.content);
                }
                continue;
            };
            if block.content.is_empty() {
                continue;
            }
            match self.wire.dictionary.replies(&block.content) {
                Some(replies) => {
                    for reply in replies {
                        self.take(&reply, expects);
                    }
                }
                None => self.wire.reader.garbage += 1,
            }
        }
    }

    fn lost(&mut self, cause: Message) {
        self.lose_board(cause);
    }

    fn compare(&mut self) -> bool {
        let asks = self.may_look();
        if asks {
            self.query_position(QueryPurpose::Look { requested: true });
        }
        asks
    }

    fn close(&mut self) {
        self.give_up_motion();
        if self.is_running() {
            self.wire.send_urgent(Command::EmergencyStop, &[]);
            // Ignore the receive window: the emergency stop must be sent.
            self.wire.send_queue.set_window(None);
            self.send();
        }
        self.lose_position(Uncertainty::Unheard);
        self.session.enter(LinkState::Off);
    }

    fn stop_bytes(&self) -> Vec<u8> {
        if !self.is_running() {
            return Vec::new();
        }
        let stop = self.wire.dictionary.message(Command::EmergencyStop, &[]);
        let mut bytes = block::ENDS.to_vec();
        for sequence in 0..block::NUMBERS {
            bytes.extend(block::encode_block(sequence, &stop));
        }
        bytes
    }

    fn last_position(&self) -> Option<PerAxis<Pulses>> {
        self.motion.count.position()
    }

    fn is_stopping(&self) -> bool {
        let reads_count = |query: &PositionQuery| query.purpose == QueryPurpose::ShutDown;
        self.stopping.is_some() || self.query.pending.as_ref().is_some_and(reads_count)
    }

    fn takes_motion(&self) -> bool {
        let by_hand = matches!(self.session.state, LinkState::Locked | LinkState::Tripped);
        (self.session.state.takes_motion() || by_hand && self.session.released)
            && self.stopping.is_none()
            && !self.opening.is_shut_down()
    }

    fn is_prepared(&self) -> bool {
        self.takes_motion()
    }

    fn homes_alone(&self) -> bool {
        true
    }

    fn set_outputs(&mut self, outputs: BoardOutputs) {
        self.periodic.outputs.wanted = outputs;
        if self.send_wanted() {
            // Send immediately: the next call may be too late.
            self.send();
        }
    }

    fn times_outputs(&self) -> bool {
        true
    }

    fn switched(&self) -> Option<BoardOutputs> {
        Some(self.periodic.outputs.sent)
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

    fn arm(&mut self, awaited: AwaitedInput) -> Result<(), MotionRefused> {
        self.arm_input(awaited)
    }

    fn awaited(&self, axis: Axis) -> Option<AwaitedInput> {
        self.group.awaited(axis)
    }

    fn is_armed(&self, axis: Axis) -> bool {
        self.group.watches(axis, self.clock.at(self.session.now))
    }

    fn disarm(&mut self, axis: Axis) {
        self.forget_awaited(axis);
    }

    fn retreat(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        if !(self.session.state == LinkState::Tripped
            && self.session.knows_position()
            && self.motion.limits.is_any_operated())
        {
            return Err(MotionRefused::NotReady);
        }
        self.align(kernel, at)?;
        self.session.released = true;
        Ok(())
    }

    fn keeps_count(&self) -> bool {
        self.motion.count.is_exact()
    }

    fn output(&mut self, at: RunTime, output: Output, value: i32) -> Result<(), MotionRefused> {
        self.switch_output(at, output, value)
    }

    fn input(&self, input: Input) -> Option<bool> {
        self.periodic.switches.input(input)
    }

    fn plan_thread(&mut self, plan: Option<ThreadPlan>) {
        self.plan_thread_angle(plan);
    }

    fn taps(&self) -> TapCapability {
        self.tap_capability()
    }

    fn tap(&mut self, order: &TapOrder) -> Result<(), PassError> {
        self.begin_tap(order)
    }

    fn tap_distance(&self) -> Option<f64> {
        self.tap_distance()
    }

    fn waits_for_spindle(&self) -> bool {
        self.has_spindle_encoder() && (self.angle.is_planned() || self.angle.is_engaged())
    }

    fn spindle(&mut self, max_correction: Option<f64>) -> Option<SpindleView> {
        if self.has_spindle_encoder() {
            return Some(self.next_angle_view());
        }
        self.sees_spindle()
            .then(|| self.next_spindle(max_correction))
    }

    fn encoder(&self) -> Option<EncoderReading> {
        self.encoder_reading()
    }

    fn spindle_reversed(&mut self) {
        self.spindle.reversed();
    }

    fn keep_time(&mut self, on: bool) {
        self.motion.path.keeps_time = on;
    }

    fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        let block = describe::next_block(collected)?;
        Some(describe::block(&self.wire.dictionary, outward, &block))
    }
}
