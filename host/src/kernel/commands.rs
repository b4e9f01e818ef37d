//! Executes the commands of the window.

use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheConfig;
use gsk_core::memory::OperationLevel;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_messages::say;
use gsk_panel::emulator::EmulatorInput;
use gsk_panel::keys::Key;
use gsk_panel::why::{self, BitLog, CauseSubject};
use gsk_project::ProjectState;
use gsk_runner::machining::slide_shift;

use super::edges::{self, KeyEdge};
use super::part::{self, KernelPart};
use super::probe::{ActiveProbe, Probe};
use super::{Command, Kernel, MachineMonitor, Notice, PreviewSetup, WHEEL_REST_TIME};
use crate::job::SelectedJob;
use crate::platform;
use crate::preview::setup::make_preview_setup;
use crate::retained;

impl Kernel {
    pub(super) fn execute_command(&mut self, command: Command) {
        self.command_count += 1;
        if self.is_late(&command) {
            self.notify(Notice::Message(say::key_came_late()));
            return;
        }
        if let Command::Turn(graduations) = command
            && self.turn_through_time(graduations)
        {
            return;
        }
        self.grant_key_ticks(&command);
        if self.is_refused_in_past(&command)
            || self.is_settled_in_exercise(&command)
            || self.is_settled_in_halt(&command)
        {
            return;
        }
        if matches!(
            command,
            Command::Key { down: true, .. } | Command::Tap(_) | Command::Type(_) | Command::Turn(_)
        ) {
            self.interrupt_demonstration();
        }
        match command {
            Command::Key { key, down: true } => self.press_key(key, KeyEdge::Down(key)),
            Command::Key { key, down: false } => self.key_edges.push(KeyEdge::Up(key)),
            Command::Tap(key) => self.press_key(key, KeyEdge::Tap(key)),
            Command::Type(character) => self.key_edges.push(KeyEdge::Type(character)),
            Command::Turn(detents) => self.turn_handwheel(detents),
            Command::Open(opened) => {
                self.open(*opened);
            }
            Command::OpenSample { program, starts } => self.open_sample(*program, starts),
            Command::Receive(file) => {
                if let Err(refused) = self.emulator.receive(*file) {
                    self.notify(Notice::Message(refused.message()));
                }
            }
            Command::TransferFailed => {
                self.emulator.apply(EmulatorInput::TransferFailed);
            }
            Command::FitGraphic { least, greatest } => self.emulator.fit_graphic(least, greatest),
            Command::Probe(probe) => self.set_probe(probe),
            Command::Monitor(on) => self.machine_monitor = on.then(MachineMonitor::default),
            Command::Fault(fault, on) => self.emulator.set_fault(fault, on),
            Command::Request(request) => self.execute_request(*request),
            Command::Write(requests) => self.write_all_or_none(requests),
            Command::Job(chosen) => self.set_job(chosen.map(|chosen| *chosen)),
            Command::Tools(chosen) => self.change_tools(*chosen),
            Command::FreshStock => {
                self.part.fresh_stock();
                self.notify(Notice::FreshStock);
            }
            Command::Timeline(command) => self.execute_timeline_command(command),
            Command::Breakpoints(command) => self.execute_breakpoint_command(command),
            Command::Watch(targets) => self.watches = targets,
            Command::CrashStops(stops) => self.part.set_crash_stops(stops),
            Command::Overload(is_on) => self.part.set_overload(is_on),
            Command::ShowPart(visible) => self.show_part(visible),
            Command::PlugUdisk(files) => self.emulator.plug_udisk(Some(files)),
            Command::PowerCycle => self.emulator.power_cycle(),
            Command::ForceInput(address, state) => {
                self.emulator.force_input(address, state);
            }
            Command::ReleaseForcedBits => self.release_forced_bits(),
            Command::Lesson(order) => self.execute_lesson_command(order),
            Command::Exercise(action) => self.execute_exercise_command(action),
            Command::Speed(speed) => self.speed = speed,
            Command::ClearFaults => {
                self.emulator.apply(EmulatorInput::ClearFaults);
            }
            Command::FreeLathe => {
                part::end_crash_faults(&mut self.emulator);
                self.key_edges.push(KeyEdge::Tap(Key::Reset));
                self.notify(Notice::Message(say::window_lathe_is_free()));
            }
            Command::Link(order) => self.execute_link_command(order),
            Command::Translate(on) => self.translate_screen = on,
            Command::Explain(subject) => self.explain(subject),
            Command::PublishMotion(on) => self.publish_motion = on,
            Command::WatchLink(on) => self.watch_link(on),
            Command::Seat(action) => self.execute_seat_action(action),
            Command::Network(settings, language) => self.set_network(&settings, language),
            Command::Store(text, to) => {
                let _ = to.try_send(self.store(&Program::new(text)));
            }
            Command::SendSetup(to) => {
                let setup = PreviewSetup {
                    setup: make_preview_setup(self.emulator.simulation()),
                    is_practice: self.lesson.is_some(),
                    is_running: self.emulator.cnc().run_state() != RunState::Reset,
                    slide_shift: slide_shift::measure(self.emulator.simulation()),
                };
                // The receiver may be gone.
                let _ = to.try_send(Box::new(setup));
            }
            Command::SendState(to) => {
                // The receiver may be gone.
                let _ = to.try_send(Box::new(self.project_state()));
            }
            Command::SendMachine(to) => {
                let part = self.part.state().live().cloned();
                // The receiver may be gone.
                let _ = to.try_send(Box::new((self.emulator.simulation().clone(), part)));
            }
            Command::ReleaseAll => self.release_all_keys(),
            Command::Alive => {}
            Command::Quit => self.quit_requested = true,
        }
    }

    /// Passes a request to the control, and reports why it is refused.
    fn execute_request(&mut self, request: ControlRequest) {
        let is_restart = matches!(request, ControlRequest::Restart(_));
        if is_restart && let Some(why) = self.emulator.cnc().request_refusal(&request) {
            return self.notify(Notice::Message(why));
        }
        if let Err(alarm) = self.emulator.request(request) {
            self.notify(Notice::Refused(alarm));
        } else if is_restart {
            // The next cycle start does something else now.
            self.notify(Notice::Message(say::restart_start_again()));
        }
    }

    /// Queues a key event. The emergency stop waits for no other key.
    pub(super) fn press_key(&mut self, key: Key, edge: KeyEdge) {
        match key {
            Key::EmergencyStop => {
                self.emulator.key_down(Key::EmergencyStop);
            }
            _ => self.key_edges.push(edge),
        }
    }

    pub(super) fn set_probe(&mut self, probe: Option<Probe>) {
        match (probe, self.active_probe.as_mut()) {
            (Some(probe), Some(probing)) => probing.replace_probe(probe),
            (probe, _) => self.active_probe = probe.map(ActiveProbe::new),
        }
    }

    /// Sends the chain of causes of a state to the window. A look at the past has no times.
    pub(super) fn explain(&self, subject: CauseSubject) {
        let log = match self.timeline.shows_past() {
            true => &BitLog::default(),
            false => &self.bit_log,
        };
        let chain = why::explain(self.shown_machine(), subject, log);
        self.notify(Notice::Explained(Box::new(chain)));
    }

    pub(super) fn show_part(&mut self, visible: bool) {
        self.part.set_visible(visible);
        self.timeline.set_part_visible(visible);
    }

    pub(super) fn set_job(&mut self, chosen: Option<SelectedJob>) {
        if self.is_job_of_restored_part(chosen.as_ref()) {
            return;
        }
        self.report_tool_minutes();
        let (part, lathe) = self.own_part();
        part.set_job(chosen, lathe);
    }

    fn change_tools(&mut self, chosen: SelectedJob) {
        self.report_tool_minutes();
        self.own_part().0.change_tools(chosen);
    }

    /// The part of the learner's own lathe, which may wait beside a practice machine, and that
    /// lathe.
    fn own_part(&mut self) -> (&mut KernelPart, &LatheConfig) {
        match &mut self.lesson {
            Some(lesson) => lesson.own_part(),
            None => (&mut self.part, self.emulator.lathe().config()),
        }
    }

    pub(super) fn release_forced_bits(&mut self) {
        let forces = self.emulator.cnc().plc().forces().to_vec();
        for force in forces {
            self.execute_command(Command::Request(Box::new(ControlRequest::ForceBit(
                force.bit, None,
            ))));
        }
    }

    pub(super) fn watch_link(&mut self, on: bool) {
        self.link_watched = on;
        if let Some(drive) = &mut self.drive {
            drive.request_view(on);
        }
    }

    /// Returns the state of the learner's own machine that a project stores, and its operation
    /// level.
    pub(super) fn project_state(&self) -> (ProjectState, OperationLevel) {
        let own = self.own_machine();
        let level = own.cnc().battery_memory().authority.level();
        (retained::project::state_of_emulator(own), level)
    }

    /// Whether the command would move a real machine although the window may have sent it long ago,
    /// because the display has hung.
    pub(super) fn is_late(&mut self, command: &Command) -> bool {
        let turns = matches!(command, Command::Turn(_));
        let moves = match command {
            Command::Key { key, down: true } | Command::Tap(key) => edges::starts_motion(*key),
            _ => turns,
        };
        if !moves || self.drive.is_none() {
            return false;
        }
        let now = platform::time_with_sleep();
        let late = !self.input_watch.is_fresh(now) || turns && now < self.wheel_rests_until;
        if turns && late {
            // A wheel that keeps turning does not take the axis along again.
            self.wheel_rests_until = now + WHEEL_REST_TIME;
        }
        late
    }

    /// Writes parameters, pitch errors, offsets and variables if the operator is permitted to
    /// change all of them; otherwise writes none and sends a notice.
    pub(super) fn write_all_or_none(&mut self, requests: Vec<ControlRequest>) {
        let rights = self.emulator.cnc().rights();
        let taken = |request: &ControlRequest| match request {
            ControlRequest::SetOffset { .. } => rights.check_offsets(),
            ControlRequest::SetVariable { .. } | ControlRequest::SetMacroVariable { .. } => {
                rights.check_variables()
            }
            _ => rights.check_parameters(),
        };
        if let Err(refusal) = requests.iter().try_for_each(taken) {
            let why = gsk_project::refusal_message(refusal);
            self.notify(Notice::Message(say::commission_refused(why)));
            return;
        }
        for request in requests {
            if let Err(alarm) = self.emulator.request(request) {
                self.notify(Notice::Refused(alarm));
                return;
            }
        }
    }
}
