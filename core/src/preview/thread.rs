//! Threads and taps without ticks.

use super::{PreviewRun, remove_noise};
use crate::alarm::Alarm;
use crate::command::{ControlCommand, ExecutedMove, MoveKind, ThreadStart};
use crate::motion::{ThreadMove, path_length};
use crate::operation::{check_encoder, check_spindle_turns, check_thread_speed};
use crate::units::{Axis, Feed, Point};

/// Delay from an M code to the spindle contactor: strobe, scan and output, s.
const M_LATENCY_S: f64 = 0.04;

impl PreviewRun<'_> {
    /// Executes a thread. The clock includes half a turn, the average wait for the one-turn signal.
    /// Returns the alarm of a spindle that is at standstill or too fast as error.
    pub(super) fn execute_thread(
        &mut self,
        command: &ControlCommand,
        thread: &ThreadMove,
    ) -> Result<(), Alarm> {
        let from = self.preview.machine;
        let rpm = self.thread_speed(thread)?;
        if from == thread.to {
            return Ok(());
        }
        self.check_thread_pass(command, thread, rpm);
        if let ThreadStart::AtIndex { degrees } = thread.start {
            self.clock.advance((0.5 + degrees / 360.0) * 60.0 / rpm);
        }
        let (took, stopping) = thread.duration(from, rpm, &self.limits);
        let kind = if thread.run_out {
            MoveKind::RunOut
        } else {
            MoveKind::Thread
        };
        self.execute_spindle_move(command, kind, thread.to, thread.lead, took);
        // Added to the clock unless a thread follows that continues in phase.
        self.owed_deceleration_s = stopping;
        Ok(())
    }

    /// Checks the start of a thread cycle. `per_revolution` is the motion per turn, mm. Fails
    /// with alarm 092 or 094.
    pub(super) fn check_thread_cycle(&self, per_revolution: Point) -> Result<(), Alarm> {
        check_encoder(&self.preview.parameters)?;
        let rpm = self.current_rpm();
        check_spindle_turns(rpm)?;
        check_thread_speed(per_revolution * rpm, rpm, &self.limits)
    }

    /// Turns the spindle in its direction before the last tap, for a further start of G33.
    pub(super) fn restart_spindle(&mut self) {
        self.spindle.restart_after_tap();
        self.clock
            .advance(self.clock.m_function_s().max(self.spindle_settle_s));
    }

    /// Executes a tap to `to` with the lead `lead`, mm: in, spindle stop and reversal, out,
    /// stop.
    pub(super) fn execute_tap(
        &mut self,
        command: &ControlCommand,
        to: Point,
        lead: f64,
    ) -> Result<(), Alarm> {
        let start = self.preview.machine;
        let inwards = ThreadMove {
            to,
            lead_axis: Axis::Z,
            lead,
            increase: 0.0,
            start: ThreadStart::AtIndex { degrees: 0.0 },
            run_out: false,
        };
        let rpm = self.thread_speed(&inwards)?;
        let spin = rpm / 60.0;
        let settle = self.spindle_settle_s / libm::log(100.0);
        let m_s = self.clock.m_function_s() + M_LATENCY_S;
        let stop = m_s.max(settle * libm::log(rpm));
        let (down, _) = inwards.duration(start, rpm, &self.limits);
        let beyond = (M_LATENCY_S + settle) * spin;
        let up = M_LATENCY_S + settle + (inwards.turns(start) + beyond) / spin;
        self.clock.advance(0.5 / spin);
        self.execute_spindle_move(command, MoveKind::Thread, to, lead, down + stop);
        self.execute_spindle_move(command, MoveKind::Thread, start, lead, up.max(m_s));
        self.clock.advance(stop);
        self.spindle.stop_for_tap();
        Ok(())
    }

    fn current_rpm(&self) -> f64 {
        let at = self.preview.frame.to_program(self.preview.machine);
        self.spindle.rpm(at.x)
    }

    /// The spindle speed at which a thread is cut, r/min; fails with alarm 092 or 094.
    fn thread_speed(&self, thread: &ThreadMove) -> Result<f64, Alarm> {
        check_encoder(&self.preview.parameters)?;
        let from = self.preview.machine;
        let rpm = self.current_rpm();
        let top = thread.top_speed(from, rpm, &self.limits);
        check_spindle_turns(rpm)?;
        check_thread_speed(top, rpm, &self.limits)?;
        Ok(rpm)
    }

    /// Executes a move to `to` that follows the spindle, with the lead `lead`, mm, and the
    /// duration `took`, s.
    fn execute_spindle_move(
        &mut self,
        command: &ControlCommand,
        kind: MoveKind,
        to: Point,
        lead: f64,
        took: f64,
    ) {
        let from = self.preview.machine;
        let frame = self.preview.frame;
        self.preview.machine = to;
        self.record_move(command.source);
        self.motionless = 0;
        self.preview.lengths.thread += path_length(kind, from, to, None);
        self.preview.cutting_s += took;
        let executed = ExecutedMove {
            source: command.source,
            kind,
            from: remove_noise(frame.to_program(from)),
            to: remove_noise(frame.to_program(to)),
            center: None,
            feed: Some(Feed::PerRevolution(lead)),
            start_s: self.clock.now(),
            duration_s: took,
            conditions: self.conditions(command),
        };
        self.count_move(&executed);
        self.report_move(&executed);
    }
}
