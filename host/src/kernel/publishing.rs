//! Publishes what the window shows: snapshots of the panel, of machine and PLC, the part.

use gsk_core::cnc::Event;
use gsk_core::operation::OperatingMode;
use gsk_core::simulation::Simulation;
use gsk_runner::machining::live_part::running_block;

use super::drive::Drive;
use super::monitor::MachineView;
use super::practice_session::PracticeSession;
use super::program::start::waits_at_end;
use super::{
    ForcedState, Kernel, KeysReversed, MACHINE_VIEW_TICKS, MachineMotion, Notice, PanelSnapshot,
    active_alarm,
};

impl Kernel {
    /// Publishes a snapshot if anything has changed since the last one; returns true if there
    /// is something new to show.
    pub fn publish(&mut self) -> bool {
        let timeline_shown = self.publish_timeline();
        let views_shown = self.publish_machine() || timeline_shown;
        self.wait_watch
            .update(self.tick, self.emulator.simulation());
        let snapshot = self.snapshot();
        let has_request = self.follow_class(&snapshot);
        if self.last_snapshot.as_ref() == Some(&snapshot) {
            return views_shown || has_request;
        }
        self.snapshots.force_push(snapshot.clone());
        self.last_snapshot = Some(snapshot);
        true
    }

    /// Publishes the state of machine and PLC if a view shows them, a publication is due and they
    /// have changed; returns true if so.
    pub(super) fn publish_machine(&mut self) -> bool {
        let hides_faults = self.hides_faults();
        let Some(monitor) = &mut self.machine_monitor else {
            return false;
        };
        if self.tick < monitor.next_tick {
            return false;
        }
        monitor.next_tick = self.tick + MACHINE_VIEW_TICKS;
        let shown = self.timeline.past_machine().unwrap_or(&self.emulator);
        let now = MachineView {
            hides_faults,
            ..MachineView::from_emulator(shown)
        };
        if monitor.last_view.as_ref() == Some(&now) {
            return false;
        }
        self.machine.force_push(now.clone());
        monitor.last_view = Some(now);
        true
    }

    /// Reports to the window what happened in the control in the last tick: advice, and the end of
    /// a program.
    pub(super) fn report_events(&mut self) {
        let cnc = self.emulator.cnc();
        for event in cnc.events() {
            match event {
                Event::Advised(text) => {
                    self.key_refusals.record_advice();
                    self.notify(Notice::KeyRefusal(Some((None, text.clone()))));
                }
                Event::ProgramEnded { m30: true, .. } => {
                    if let Some(program) = cnc.programs().selected() {
                        let parts = cnc.counters().parts;
                        self.notify(Notice::ProgramEnded(program, parts));
                    }
                }
                _ => {}
            }
        }
    }

    /// Returns the current state of the panel.
    pub fn snapshot(&self) -> PanelSnapshot {
        let shown = self.shown_machine();
        let (panel, cnc) = (shown.panel(), shown.cnc());
        let is_present = !self.timeline.shows_past();
        let own = self.emulator.cnc();
        let is_internal = self.part.is_tool_internal(&self.emulator);
        let away = self.start_watch.distance(own, is_internal);
        let away = away.filter(|_| is_present);
        PanelSnapshot {
            screen: shown.screen(),
            translated: self
                .translate_screen
                .then(|| Box::new(shown.translated_screen())),
            page: panel.page(),
            model: cnc.model().id(),
            keys_reversed: KeysReversed {
                x: cnc.parameters().is_up_positive(),
                z: cnc.parameters().is_left_positive(),
            },
            brightness: panel.view().brightness,
            y_memory: shown.lamps(),
            pressed: panel.pressed(),
            wheel: panel.wheel(),
            speed_percent: self.speed_percent,
            speed: self.speed,
            speed_ratio: self.speed_ratio,
            alarm: active_alarm(cnc),
            position_unknown: cnc.is_position_unknown(),
            board: self.drive.as_ref().map(Drive::state),
            run_state: cnc.run_state(),
            running_block: running_block(shown.simulation()),
            halt: self.program_breakpoints.halt().filter(|_| is_present),
            watches: self.read_watches(),
            program_wait: self
                .wait_watch
                .report(self.tick, cnc.run_state())
                .filter(|_| is_present),
            is_away_from_start: away.is_some(),
            start_distance: away.filter(|_| own.mode() == OperatingMode::Auto),
            waits_at_end: is_present && waits_at_end(self.emulator.cnc()),
            resumes_at: self
                .start_watch
                .resumes_at(self.emulator.cnc())
                .filter(|_| is_present),
            crash: (self.part)
                .crash_message(&self.emulator)
                .filter(|_| is_present && !self.hides_faults()),
            is_moving: (is_present || self.has_real_slides)
                && (self.emulator.cnc().is_moving() || self.motion().spindle_rpm > 0.0),
            program: cnc.programs().selected(),
            lesson: self.lesson.as_ref().and_then(PracticeSession::state),
            exercise: (self.lesson.as_ref())
                .and_then(PracticeSession::exercise)
                .map(|run| run.state(&self.emulator)),
            asks_help: self.asks_help(),
            alarm_records: self.alarm_history.records(),
            motion: (self.publish_motion && is_present).then(|| self.motion()),
            past: self.timeline.past_moment(),
            forced: ForcedState {
                forced_bits: cnc.plc().forces().len(),
                forced_inputs: shown.lathe().forced_input_count(),
                faults: match self.hides_faults() {
                    true => 0,
                    false => shown.lathe().fault_count(),
                },
            },
        }
    }

    /// Returns slide positions and spindle speed: of the board if one is connected, else of
    /// the simulated lathe.
    pub(super) fn motion(&self) -> MachineMotion {
        /// Step to which the displayed spindle speed is rounded, r/min.
        const STEP: f64 = 10.0;
        let Simulation { cnc, lathe, .. } = self.emulator.simulation();
        let (slides, spindle) = match cnc.has_board() {
            true => (cnc.position_machine(), cnc.board_spindle_rpm()),
            false => (lathe.slide_position(), Some(lathe.spindle_rpm())),
        };
        let spindle = spindle.unwrap_or_else(|| cnc.spindle_switched()).abs();
        MachineMotion {
            slides,
            spindle_rpm: (spindle / STEP).round() * STEP,
        }
    }
}
