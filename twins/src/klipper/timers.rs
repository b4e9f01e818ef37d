//! What happens at its clock: steps, looks at switches, time-outs, outputs.

use super::dictionary::Response;
use super::{KlipperTwin, Made, Object, RATE, STATS_S, STEP_NS, TOO_LATE_NS};

const fn ticks(ns: i64) -> i64 {
    ns * (RATE as i64 / 1_000_000) / 1000
}

impl Object {
    fn due(&self) -> Option<i64> {
        match self {
            Self::Stepper(stepper) => stepper.due(),
            Self::Endstop(endstop) => endstop.next,
            Self::Group(group) => group.expires.into_iter().chain(group.report).min(),
            Self::Output(output, _) => output.due(),
            Self::Counter(counter) => counter.next,
        }
    }
}

impl KlipperTwin {
    /// Clock of the next thing that happens by itself.
    pub(super) fn next_timer(&self) -> Option<i64> {
        let objects = self.oids.values().filter_map(Object::due);
        objects.chain([self.stats_at]).min()
    }

    pub(super) fn run_timers(&mut self) {
        loop {
            let now = self.clock();
            if now >= self.stats_at {
                self.stats_at += STATS_S * i64::from(RATE);
                self.say(Response::Stats, &[1000, 50_000, 2_000_000]);
            }
            let due = |(oid, object): (&u32, &Object)| object.due().map(|at| (at, *oid));
            let next = self.oids.iter().filter_map(due).min();
            let Some((at, oid)) = next.filter(|(at, _)| *at <= now) else {
                return;
            };
            self.run_timer(oid, at);
        }
    }

    fn run_timer(&mut self, oid: u32, at: i64) {
        let Some(object) = self.oids.get_mut(&oid) else {
            return;
        };
        match object {
            Object::Stepper(stepper) => {
                // One processor makes all steps, one after the other.
                let when = at.max(self.free_at);
                self.free_at = when + ticks(STEP_NS);
                if when - at > ticks(TOO_LATE_NS) {
                    self.shut_down("Rescheduled timer in the past");
                    return;
                }
                let (up, _) = stepper.step();
                let place = self
                    .oids
                    .range(..oid)
                    .filter(|(_, object)| matches!(object, Object::Stepper(_)))
                    .count();
                self.figures.steps += 1;
                self.last_pulse = self.moment(when);
                let due = self.moment(at);
                if let Some(count) = self.pulses.get_mut(place) {
                    *count += if up { 1 } else { -1 };
                    if let Some(recorded) = &mut self.recorded {
                        recorded.push(Made {
                            at: self.last_pulse,
                            due,
                            axis: place,
                            place: *count,
                        });
                    }
                }
            }
            Object::Endstop(endstop) => {
                let pin = endstop.pin;
                let level = self.level(pin);
                if let Some(Object::Endstop(endstop)) = self.oids.get_mut(&oid)
                    && endstop.look(level)
                {
                    let (group, reason) = (endstop.group, endstop.reason);
                    self.trigger(group, reason);
                }
            }
            Object::Group(group) => {
                if group.expires == Some(at) {
                    group.expires = None;
                    let reason = group.expire_reason;
                    self.trigger(oid, reason);
                } else {
                    group.report = Some(at + group.report_ticks.max(1));
                    self.report(oid);
                }
            }
            Object::Output(output, value) => {
                let Some((clock, new)) = output.queue.pop_front() else {
                    let missed = output.missed();
                    self.shut_down(missed);
                    return;
                };
                *value = new;
                output.until = None;
                if new != output.default && output.longest > 0 {
                    let until = clock + output.longest;
                    if output.queue.front().is_some_and(|(next, _)| *next > until) {
                        let exceeds = output.exceeds();
                        self.shut_down(exceeds);
                        return;
                    }
                    output.until = output.queue.is_empty().then_some(until);
                }
                let moment = self.moment(clock).min(self.now);
                self.drive_spindle(moment);
            }
            Object::Counter(counter) => {
                let pin = counter.pin;
                let level = self.level(pin);
                let Some(Object::Counter(counter)) = self.oids.get_mut(&oid) else {
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
                    self.say(
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
        }
    }

    /// Stops all steppers of a group, once.
    pub(super) fn trigger(&mut self, oid: u32, reason: u32) {
        let Some(Object::Group(group)) = self.oids.get_mut(&oid) else {
            return;
        };
        if !group.can_trigger {
            return;
        }
        group.can_trigger = false;
        group.reason = reason;
        group.expires = None;
        group.report = None;
        for object in self.oids.values_mut() {
            if let Object::Stepper(stepper) = object
                && stepper.group == Some(oid)
            {
                stepper.stop();
            }
        }
        self.report(oid);
    }

    pub(super) fn report(&mut self, oid: u32) {
        let clock = self.clock();
        if let Some(Object::Group(group)) = self.oids.get(&oid) {
            let numbers = [
                oid.into(),
                i64::from(group.can_trigger),
                group.reason.into(),
                i64::from(clock as u32),
            ];
            self.say(Response::TrsyncState, &numbers);
        }
    }
}
