//! Threads and taps without ticks.

use super::{Walk, snapped};
use crate::alarm::Alarm;
use crate::command::{Command, ExecutedMove, MoveKind, ThreadStart};
use crate::motion::{ThreadMove, path_length};
use crate::operation::{check_encoder, check_standing, check_thread_speed};
use crate::units::{Axis, Feed, Point};

/// Delay from an M code to the spindle contactor: strobe, scan and output, s.
const M_LATENCY_S: f64 = 0.04;

impl Walk<'_> {
    /// Executes a thread. On average it waits half a turn for the one-turn signal.
    pub(super) fn thread(&mut self, command: &Command, thread: &ThreadMove) -> Result<(), Alarm> {
        let from = self.so_far.machine;
        let rpm = self.thread_speed(thread)?;
        if from == thread.to {
            return Ok(());
        }
        if let ThreadStart::AtIndex { degrees } = thread.start {
            self.clock.advance((0.5 + degrees / 360.0) * 60.0 / rpm);
        }
        let (took, stopping) = thread.duration(from, rpm, &self.limits);
        let kind = if thread.run_out {
            MoveKind::RunOut
        } else {
            MoveKind::Thread
        };
        self.tied_move(command, kind, thread.to, thread.lead, took);
        // Added to the clock unless a thread follows that continues in phase.
        self.owed = stopping;
        Ok(())
    }

    /// Checks the start of a cycle of threads (alarms 092 and 094).
    pub(super) fn check_thread_cycle(&self, per_revolution: Point) -> Result<(), Alarm> {
        check_encoder(&self.so_far.parameters)?;
        let rpm = self.rpm_here();
        check_standing(rpm)?;
        check_thread_speed(per_revolution * rpm, rpm, &self.limits)
    }

    /// Turns the spindle as before, for a further start of G33.
    pub(super) fn restart_spindle(&mut self) {
        self.spindle.turn_again();
        self.clock.advance(self.clock.m_time().max(self.settle_s));
    }

    /// Executes a tap: in, the spindle stops and reverses, out, it stops again.
    pub(super) fn tap(&mut self, command: &Command, to: Point, lead: f64) -> Result<(), Alarm> {
        let start = self.so_far.machine;
        let inwards = ThreadMove {
            to,
            long: Axis::Z,
            lead,
            increase: 0.0,
            start: ThreadStart::AtIndex { degrees: 0.0 },
            run_out: false,
        };
        let rpm = self.thread_speed(&inwards)?;
        let spin = rpm / 60.0;
        let settle = self.settle_s / libm::log(100.0);
        let m_s = self.clock.m_time() + M_LATENCY_S;
        let stop = m_s.max(settle * libm::log(rpm));
        let (down, _) = inwards.duration(start, rpm, &self.limits);
        let beyond = (M_LATENCY_S + settle) * spin;
        let up = M_LATENCY_S + settle + (inwards.turns(start) + beyond) / spin;
        self.clock.advance(0.5 / spin);
        self.tied_move(command, MoveKind::Thread, to, lead, down + stop);
        self.tied_move(command, MoveKind::Thread, start, lead, up.max(m_s));
        self.clock.advance(stop);
        self.spindle.stop_for_tap();
        Ok(())
    }

    fn rpm_here(&self) -> f64 {
        let at = self.so_far.frame.program(self.so_far.machine);
        self.spindle.rpm(at.x)
    }

    /// The spindle speed of a thread, r/min (alarms 092 and 094).
    fn thread_speed(&self, thread: &ThreadMove) -> Result<f64, Alarm> {
        check_encoder(&self.so_far.parameters)?;
        let from = self.so_far.machine;
        let rpm = self.rpm_here();
        let top = thread.top_speed(from, rpm, &self.limits);
        check_standing(rpm)?;
        check_thread_speed(top, rpm, &self.limits)?;
        Ok(rpm)
    }

    /// Executes a move that follows the spindle.
    fn tied_move(&mut self, command: &Command, kind: MoveKind, to: Point, lead: f64, took: f64) {
        let from = self.so_far.machine;
        let frame = self.so_far.frame;
        self.so_far.machine = to;
        self.look_at_move(command.source);
        self.motionless = 0;
        self.so_far.lengths.thread += path_length(kind, from, to, None);
        self.so_far.cutting_s += took;
        let executed = ExecutedMove {
            source: command.source,
            kind,
            from: snapped(frame.program(from)),
            to: snapped(frame.program(to)),
            center: None,
            feed: Some(Feed::PerRevolution(lead)),
            start_s: self.clock.now(),
            duration_s: took,
            conditions: self.conditions(command),
        };
        self.count(&executed);
        self.show(&executed);
    }
}
