//! Runs the timers: steps, switch samples, timeouts, outputs and counters.

use super::dictionary::Response;
use super::{CLOCK_HZ, ConfigObject, KlipperTwin, MadeStep, STATS_S, STEP_NS, TOO_LATE_NS};

const fn ticks(ns: i64) -> i64 {
    ns * (CLOCK_HZ as i64 / 1_000_000) / 1000
}

impl ConfigObject {
    fn due(&self) -> Option<i64> {
        match self {
            Self::Stepper(stepper) => stepper.due(),
            Self::Endstop(endstop) => endstop.next,
            Self::Trsync(trsync) => trsync.expires.into_iter().chain(trsync.report).min(),
            Self::Output(output, _) => output.due(),
            Self::EdgeCounter(counter) => counter.next,
        }
    }
}

impl KlipperTwin {
    /// Returns the clock at which the next timer is due, ticks; `None` if no timer is active.
    pub(super) fn next_timer(&self) -> Option<i64> {
        let objects = self.oids.values().filter_map(ConfigObject::due);
        objects.chain([self.stats_at]).min()
    }

    pub(super) fn run_timers(&mut self) {
        loop {
            let now = self.clock();
            if now >= self.stats_at {
                self.stats_at += STATS_S * i64::from(CLOCK_HZ);
                self.send_response(Response::Stats, &[1000, 50_000, 2_000_000]);
            }
            let due = |(oid, object): (&u32, &ConfigObject)| object.due().map(|at| (at, *oid));
            let next = self.oids.iter().filter_map(due).min();
            let Some((at, oid)) = next.filter(|(at, _)| *at <= now) else {
                return;
            };
            self.run_timer(oid, at);
        }
    }

    fn run_timer(&mut self, oid: u32, at: i64) {
        match self.oids.get_mut(&oid) {
            Some(ConfigObject::Stepper(_)) => self.make_step(oid, at),
            Some(ConfigObject::Endstop(_)) => self.sample_endstop(oid),
            Some(ConfigObject::Trsync(trsync)) if trsync.expires == Some(at) => {
                trsync.expires = None;
                let reason = trsync.expire_reason;
                self.trigger_trsync(oid, reason);
            }
            Some(ConfigObject::Trsync(trsync)) => {
                trsync.report = Some(at + trsync.report_ticks.max(1));
                self.report_trsync(oid);
            }
            Some(ConfigObject::Output(..)) => self.switch_output(oid),
            Some(ConfigObject::EdgeCounter(_)) => self.sample_edge_counter(oid, at),
            None => {}
        }
    }

    /// Makes the step of the stepper `oid` that is due at clock `at`, ticks.
    fn make_step(&mut self, oid: u32, at: i64) {
        // One processor makes all steps, one after the other.
        let when = at.max(self.processor_free_at);
        self.processor_free_at = when + ticks(STEP_NS);
        if when - at > ticks(TOO_LATE_NS) {
            self.shut_down("Rescheduled timer in the past");
            return;
        }
        let Some(ConfigObject::Stepper(stepper)) = self.oids.get_mut(&oid) else {
            return;
        };
        let (up, _) = stepper.step();
        let index = self
            .oids
            .range(..oid)
            .filter(|(_, object)| matches!(object, ConfigObject::Stepper(_)))
            .count();
        self.statistics.step_count += 1;
        self.last_pulse_ns = self.clock_to_ns(when);
        let due_ns = self.clock_to_ns(at);
        if let Some(count) = self.pulses.get_mut(index) {
            *count += if up { 1 } else { -1 };
            if let Some(recorded) = &mut self.recorded_steps {
                recorded.push(MadeStep {
                    at_ns: self.last_pulse_ns,
                    due_ns,
                    stepper: index,
                    position: *count,
                });
            }
        }
    }

    /// Samples the pin of the endstop `oid`. Triggers its trsync if the pin has had the
    /// expected level for long enough.
    fn sample_endstop(&mut self, oid: u32) {
        let Some(ConfigObject::Endstop(endstop)) = self.oids.get(&oid) else {
            return;
        };
        let level = self.pin_level(endstop.pin);
        if let Some(ConfigObject::Endstop(endstop)) = self.oids.get_mut(&oid)
            && endstop.sample_level(level)
        {
            let (trsync, reason) = (endstop.trsync, endstop.reason);
            self.trigger_trsync(trsync, reason);
        }
    }

    /// Switches the output `oid` to the next value of its queue, or shuts down if no value is
    /// queued.
    fn switch_output(&mut self, oid: u32) {
        let Some(ConfigObject::Output(output, value)) = self.oids.get_mut(&oid) else {
            return;
        };
        let Some((clock, new)) = output.queue.pop_front() else {
            let missed = output.missed_reason();
            self.shut_down(missed);
            return;
        };
        *value = new;
        output.max_duration_end = None;
        if new != output.default && output.max_duration > 0 {
            let max_duration_end = clock + output.max_duration;
            if output
                .queue
                .front()
                .is_some_and(|(next, _)| *next > max_duration_end)
            {
                let exceeds = output.exceeded_reason();
                self.shut_down(exceeds);
                return;
            }
            output.max_duration_end = output.queue.is_empty().then_some(max_duration_end);
        }
        let moment = self.clock_to_ns(clock).min(self.now);
        self.drive_spindle(moment);
    }

    /// Samples the pin of the edge counter `oid` at clock `at`, and sends its count if a
    /// report is due.
    fn sample_edge_counter(&mut self, oid: u32, at: i64) {
        let Some(ConfigObject::EdgeCounter(counter)) = self.oids.get(&oid) else {
            return;
        };
        let level = self.pin_level(counter.pin);
        let Some(ConfigObject::EdgeCounter(counter)) = self.oids.get_mut(&oid) else {
            return;
        };
        if level != counter.level {
            counter.level = level;
            counter.count = counter.count.wrapping_add(1);
            counter.count_clock = at;
        }
        counter.next = Some(at + counter.poll.max(1));
        if at >= counter.report {
            counter.report = at + counter.report_every;
            let (count, clock) = (counter.count, counter.count_clock);
            let next = at + counter.report_every;
            self.send_response(
                Response::CounterState,
                &[
                    oid.into(),
                    i64::from(next as u32),
                    count.into(),
                    i64::from(clock as u32),
                ],
            );
        }
    }

    /// Stops all steppers of the trsync `oid` with a reason, unless the trsync has already
    /// triggered.
    pub(super) fn trigger_trsync(&mut self, oid: u32, reason: u32) {
        let Some(ConfigObject::Trsync(trsync)) = self.oids.get_mut(&oid) else {
            return;
        };
        if !trsync.can_trigger {
            return;
        }
        trsync.can_trigger = false;
        trsync.reason = reason;
        trsync.expires = None;
        trsync.report = None;
        for object in self.oids.values_mut() {
            if let ConfigObject::Stepper(stepper) = object
                && stepper.trsync == Some(oid)
            {
                stepper.stop();
            }
        }
        self.report_trsync(oid);
    }

    pub(super) fn report_trsync(&mut self, oid: u32) {
        let clock = self.clock();
        if let Some(ConfigObject::Trsync(trsync)) = self.oids.get(&oid) {
            let numbers = [
                oid.into(),
                i64::from(trsync.can_trigger),
                trsync.reason.into(),
                i64::from(clock as u32),
            ];
            self.send_response(Response::TrsyncState, &numbers);
        }
    }
}
