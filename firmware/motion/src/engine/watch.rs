//! Watches inputs, lease, stop groups, counters and encoders, and switches the outputs.

use super::{Engine, EngineState, Moment, SLOW_TURNS, StepPort, WHEEL_ENCODER};
use crate::clock_steps::is_before;
use crate::messages::{Reason, Response};
use crate::stepper::Stepper;
use crate::stops::PlannedStop;

impl Engine {
    #[inline(always)]
    pub(super) fn watch_inputs(
        &mut self,
        moment: Moment,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        if self.objects.guard_levels.needs_check(moment.pins) {
            self.check_guards(moment)?;
        }
        if self.objects.input_levels.needs_check(moment.pins) {
            self.sample_inputs(moment, port);
        }
        Ok(())
    }

    fn check_guards(&mut self, moment: Moment) -> Result<(), Reason> {
        if self.crc.is_none() {
            return Ok(());
        }
        for guard in &mut self.objects.guards {
            if guard.check(moment.pins >> guard.pin & 1 != 0, moment.clock) {
                return Err(Reason::GuardTripped);
            }
        }
        Ok(())
    }

    fn sample_inputs(&mut self, moment: Moment, port: &mut impl StepPort) {
        let mut trigger = None;
        for input in &mut self.objects.inputs {
            let is_high = moment.pins >> input.pin & 1 != 0;
            if input.next.is_some() && input.sample(is_high, moment.clock) {
                trigger = Some((input.trsync, input.reason));
            }
        }
        if let Some((oid, reason)) = trigger {
            self.objects.collect_input_levels();
            self.trigger(oid, reason, port);
        }
    }

    /// Does one part of the work that is not urgent to the microsecond.
    #[inline(always)]
    pub(super) fn work_slowly(
        &mut self,
        moment: Moment,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        self.slow_turn = (self.slow_turn + 1) % SLOW_TURNS;
        if self.slow_turn & 1 == 0 {
            return Ok(());
        }
        self.work_in_turn(moment.clock, port)
    }

    fn work_in_turn(&mut self, now: u32, port: &mut impl StepPort) -> Result<(), Reason> {
        match self.slow_turn >> 1 {
            0 => self.watch_lease(now)?,
            1 => self.watch_groups(now, port),
            2 => self.watch_counters(now, port),
            3 => self.report_encoder(now),
            4 => return self.switch_outputs(now, port),
            5 => return self.compare_encoder(0, port),
            6 => return self.compare_encoder(1, port),
            _ => self.report_wheel(now, port),
        }
        Ok(())
    }

    fn watch_lease(&mut self, now: u32) -> Result<(), Reason> {
        if let EngineState::Stopping(stop) = self.state {
            let is_over = stop.is_over(now);
            return if is_over {
                Err(Reason::LeaseExpired)
            } else {
                Ok(())
            };
        }
        if self.lease.is_some_and(|end| !is_before(now, end)) {
            self.lease = None;
            self.state = EngineState::Stopping(PlannedStop::new(now));
            self.send(Response::LeaseExpired, [now.into(), 0, 0, 0]);
        }
        Ok(())
    }

    fn watch_groups(&mut self, now: u32, port: &mut impl StepPort) {
        for index in 0..self.objects.groups.len() {
            let group = &mut self.objects.groups[index];
            let is_due = |clock: Option<u32>| clock.is_some_and(|clock| !is_before(now, clock));
            if is_due(group.expires) {
                let (oid, reason) = (group.oid, group.expire_reason);
                self.trigger(oid, reason, port);
            } else if is_due(group.report) {
                group.report = Some(now.wrapping_add(group.report_ticks));
                let oid = group.oid;
                self.report_group(oid, now);
            }
        }
    }

    fn watch_counters(&mut self, now: u32, port: &mut impl StepPort) {
        let pins = port.pins();
        for index in 0..self.objects.counters.len() {
            let counter = &mut self.objects.counters[index];
            if counter.next.is_none_or(|next| is_before(now, next)) {
                continue;
            }
            counter.next = Some(now.wrapping_add(counter.poll_ticks));
            let is_high = pins >> counter.pin & 1 != 0;
            if is_high != counter.is_high {
                counter.is_high = is_high;
                counter.count = counter.count.wrapping_add(1);
                counter.count_clock = now;
            }
            if is_before(now, counter.report) {
                continue;
            }
            counter.report = now.wrapping_add(counter.report_ticks);
            let values = [
                counter.oid.into(),
                counter.report.into(),
                counter.count.into(),
                counter.count_clock.into(),
            ];
            self.send(Response::CounterState, values);
        }
    }

    fn report_encoder(&mut self, now: u32) {
        let report = &mut self.encoder_report;
        let Some(spindle) = &self.objects.spindle else {
            return;
        };
        if report.next.is_some_and(|next| !is_before(now, next)) {
            report.next = (report.rest_ticks > 0).then(|| now.wrapping_add(report.rest_ticks));
            let values = [
                spindle.oid.into(),
                now.into(),
                spindle.angle.count.into(),
                spindle.index_count.into(),
            ];
            let oid = spindle.oid;
            self.send(Response::EncoderState, values);
            let steppers = self.objects.steppers.iter_mut();
            let error = steppers.map(Stepper::take_thread_error).max().unwrap_or(0);
            if error > 0 {
                self.send(Response::AngleError, [oid.into(), error.into(), 0, 0]);
            }
        }
    }

    #[inline(never)]
    fn report_wheel(&mut self, now: u32, port: &mut impl StepPort) {
        let Some(wheel) = &mut self.objects.wheel else {
            return;
        };
        if wheel.next.is_some_and(|next| !is_before(now, next)) {
            wheel.next = (wheel.rest_ticks > 0).then(|| now.wrapping_add(wheel.rest_ticks));
            let count = port.encoder(WHEEL_ENCODER);
            let values = [wheel.oid.into(), now.into(), count.into(), 0];
            self.send(Response::WheelState, values);
        }
    }

    fn switch_outputs(&mut self, now: u32, port: &mut impl StepPort) -> Result<(), Reason> {
        for output in &mut self.objects.outputs {
            if let Some(value) = output.due_value(now)? {
                port.write_output(output.pin, output.cycle_ticks > 0, value);
            }
        }
        Ok(())
    }

    fn compare_encoder(&mut self, index: usize, port: &mut impl StepPort) -> Result<(), Reason> {
        let Some(encoder) = self.objects.axis_encoders.get(index) else {
            return Ok(());
        };
        let position = self.position(encoder.axis);
        let raw = port.encoder(1 + encoder.axis);
        if encoder.has_following_error(position, raw) {
            return Err(Reason::FollowingError);
        }
        Ok(())
    }
}
