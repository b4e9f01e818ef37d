//! The time line of the simulated machine: keeps the history of the session, shows a past
//! moment of it, and continues the machine from there.
//!
//! While a past moment is shown, [`Kernel::emulator`] stays the present machine, which stands
//! still: only what is published comes from the past. The keeper therefore saves the present.

mod marks;
mod past;
mod saving;
mod slot_step;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_history::history::{DEFAULT_BUDGET_BYTES, History};
use gsk_history::machine_part::MachinePart;
use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;

use super::alarm_history::AlarmHistory;
use super::edges::ends_motion;
use super::program::start::StartWatch;
use super::program::wait::WaitWatch;
use super::{Command, Kernel, Notice};
use crate::job::SelectedJob;
use marks::MarkList;
pub use marks::{TimelineMark, TimelineMarkKind};
use past::PastMachine;

/// Interval between two full states while a pulse board moves the slides, ticks. Its exchange
/// cannot be repeated, so that only these moments can be shown.
const LINKED_STATE_TICKS: u64 = 1000;
/// Machine time between two publications of the time line while nothing else changes, ticks.
const VIEW_TICKS: u64 = 500;
/// Part of a seek that is made before the kernel checks its commands again, ticks.
const SEEK_SLICE_TICKS: u64 = 2000;

/// A command of the window for the time line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TimelineCommand {
    /// Start (`true`) or stop to publish the time line.
    Publish(bool),
    /// Let the program of the simulated lathe follow the handwheel (`true`), or the clock.
    RunByHandwheel(bool),
    /// Show the state of the machine at this tick of the session.
    LookAt(u64),
    /// Show the state after the slot of the ladder before the shown moment (`back`), or after
    /// the next one.
    StepSlot {
        /// Whether the step goes back.
        back: bool,
    },
    /// Continue the machine from the moment that is shown, and abandon what followed.
    ContinueFromHere,
    /// Return from a past moment to the present.
    ReturnToPresent,
    /// Return to the end of the session that was abandoned.
    ReturnToBranch,
    /// Write the last minutes of the session into a file; `None` writes all of it.
    Save {
        /// Number of minutes of machine time to save; `None` for the whole session.
        minutes: Option<u64>,
        /// Path of the recording.
        path: PathBuf,
    },
}

/// The session as the window draws it. Ticks are milliseconds of machine time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineView {
    /// The first tick of the session that can be shown.
    pub start: u64,
    /// The tick of the present.
    pub end: u64,
    /// First and last tick of the abandoned future; `None` if there is none.
    pub branch: Option<(u64, u64)>,
    /// The events of the session, in the order of time.
    pub marks: Arc<Vec<TimelineMark>>,
    /// Whether the machine may continue from a past moment: not with real drives.
    pub can_continue: bool,
    /// Whether the program follows the handwheel.
    pub is_handwheel_run: bool,
}

/// The past moment that a snapshot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PastMoment {
    /// Tick of the session that is shown.
    pub tick: u64,
    /// Machine time from this moment to the present, ms.
    pub age_ms: u64,
    /// Whether the part at that moment is still being computed.
    pub is_part_pending: bool,
}

/// The state to which the operator can return after continuing from a past moment.
#[derive(Debug)]
struct AbandonedFuture {
    marks: MarkList,
    alarms: AlarmHistory,
}

/// History and marks of the session, and the past moment that is shown.
#[derive(Debug)]
pub(super) struct Timeline {
    /// The recorded session; `None` before the first tick.
    history: Option<History>,
    /// Whether the history has only states, because a pulse board moved the slides.
    has_linked_states: bool,
    marks: MarkList,
    abandoned: Option<AbandonedFuture>,
    /// The past moment that is shown; `None` while the present is shown.
    past: Option<PastMachine>,
    /// Whether the next job that the window sends may be that of the restored part.
    expects_job: bool,
    is_published: bool,
    last_view: Option<TimelineView>,
    views: Arc<ArrayQueue<Arc<TimelineView>>>,
}

impl Timeline {
    /// Creates an empty time line; `views` takes its states for the window.
    pub(super) fn new(views: Arc<ArrayQueue<Arc<TimelineView>>>) -> Self {
        Self {
            history: None,
            has_linked_states: false,
            marks: MarkList::default(),
            abandoned: None,
            past: None,
            expects_job: false,
            is_published: false,
            last_view: None,
            views,
        }
    }

    /// Creates an empty time line that is published as this one is.
    pub(super) fn empty_for_same_window(&self) -> Self {
        Self {
            is_published: self.is_published,
            ..Self::new(Arc::clone(&self.views))
        }
    }

    /// Takes over from another time line whether the window shows it.
    pub(super) fn with_switch_of(self, other: &Self) -> Self {
        Self {
            is_published: other.is_published,
            last_view: None,
            ..self
        }
    }

    /// Adds the inputs of a tick to the recorded session, after the tick.
    pub(super) fn follow(
        &mut self,
        machine: &Emulator,
        part: &MachinePart,
        inputs: &[RecordedInput],
        is_linked: bool,
    ) {
        if self.has_linked_states && !is_linked {
            // What the board did is unknown: the session begins anew.
            self.history = None;
            self.marks = MarkList::default();
        }
        let Some(history) = &mut self.history else {
            let start = MachineMoment {
                emulator: machine.clone(),
                part: part.clone(),
            };
            self.history = Some(History::new(start, DEFAULT_BUDGET_BYTES));
            self.has_linked_states = is_linked;
            return;
        };
        self.marks.add_inputs(inputs);
        if is_linked {
            self.has_linked_states = true;
            if machine.ticks() >= history.end() + LINKED_STATE_TICKS {
                history.store_state(machine, part);
            }
            return;
        }
        for recorded in inputs {
            history.record(recorded.clone());
        }
        if inputs.iter().any(|recorded| recorded.input.is_expensive()) {
            history.store_state(machine, part);
        }
        history.follow(machine, part);
    }

    /// Sets whether a view shows the part.
    pub(super) fn set_part_visible(&mut self, visible: bool) {
        if let Some(past) = &mut self.past {
            past.set_part_visible(visible);
        }
    }

    /// Returns the list of marks, to add the events of a tick.
    pub(super) const fn marks(&mut self) -> &mut MarkList {
        &mut self.marks
    }

    /// Returns whether a past moment is shown.
    pub(super) const fn shows_past(&self) -> bool {
        self.past.is_some()
    }

    /// Returns the machine at the past moment that is shown.
    pub(super) fn past_machine(&self) -> Option<&Emulator> {
        self.past.as_ref().map(PastMachine::machine)
    }

    /// Returns the past moment that is shown; `None` in the present.
    pub(super) fn past_moment(&self) -> Option<PastMoment> {
        let past = self.past.as_ref()?;
        let end = self.history.as_ref().map_or(0, History::end);
        Some(PastMoment {
            tick: past.tick(),
            age_ms: end.saturating_sub(past.tick()),
            is_part_pending: past.is_part_pending(),
        })
    }

    /// Publishes the time line if the window shows it and it has changed; returns `true` if so.
    fn publish(&mut self, can_continue: bool, is_handwheel_run: bool) -> bool {
        let Some(history) = self.history.as_ref().filter(|_| self.is_published) else {
            return false;
        };
        let (start, end, branch) = (history.start(), history.end(), history.branch());
        if let Some(last) = &self.last_view {
            let is_soon = end >= last.end && end < last.end + VIEW_TICKS;
            let is_same = last.start == start
                && last.branch == branch
                && last.can_continue == can_continue
                && last.is_handwheel_run == is_handwheel_run;
            if is_soon && is_same {
                return false;
            }
        }
        let view = TimelineView {
            start,
            end,
            branch,
            marks: self.marks.shared(),
            can_continue,
            is_handwheel_run,
        };
        self.views.force_push(Arc::new(view.clone()));
        self.last_view = Some(view);
        true
    }
}

impl Kernel {
    /// Returns the machine that is published: the past one that is shown, else the present one.
    pub(super) fn shown_machine(&self) -> &Emulator {
        self.timeline.past_machine().unwrap_or(&self.emulator)
    }

    /// Publishes the time line and the part of the past moment; returns `true` if something new
    /// is shown.
    pub(super) fn publish_timeline(&mut self) -> bool {
        let can_continue = !self.has_real_slides;
        let part_shown = self.timeline.past.as_mut().map(PastMachine::publish_part);
        let part_shown = match part_shown {
            Some(is_shown) => is_shown,
            None => self.part.publish(&self.emulator),
        };
        let is_handwheel_run = self.is_handwheel_run();
        self.timeline.publish(can_continue, is_handwheel_run) || part_shown
    }

    /// Continues the computation of the past part for a short time.
    pub(super) fn advance_past(&mut self) {
        let timeline = &mut self.timeline;
        if let (Some(past), Some(history)) = (&mut timeline.past, &timeline.history) {
            past.advance(history, SEEK_SLICE_TICKS);
        }
    }

    pub(super) fn execute_timeline_command(&mut self, command: TimelineCommand) {
        self.end_hidden_handwheel_run(&command);
        match command {
            TimelineCommand::RunByHandwheel(on) => self.set_handwheel_run(on),
            TimelineCommand::Publish(on) => {
                self.timeline.is_published = on;
                self.timeline.last_view = None;
            }
            TimelineCommand::LookAt(tick) => self.look_at(tick),
            TimelineCommand::StepSlot { back } => self.step_slot(back),
            TimelineCommand::ContinueFromHere => self.continue_from_past(),
            TimelineCommand::ReturnToPresent => self.return_to_present(),
            TimelineCommand::ReturnToBranch => self.return_to_branch(),
            TimelineCommand::Save { minutes, path } => self.save_session(minutes, path),
        }
    }

    /// Whether the time line follows the machine: not in a lesson.
    pub(super) fn has_timeline(&self) -> bool {
        self.lesson.is_none() || self.is_in_exercise()
    }

    /// Returns the reason why the past of the machine cannot be shown; `None` if it can. The past
    /// of an exercise is shown after the solution was handed in.
    fn look_refusal(&self) -> Option<Message> {
        let session = self.lesson.as_ref()?;
        match session.exercise() {
            None => Some(say::timeline_not_in_lesson()),
            Some(run) if run.is_exam() => Some(say::exam_no_help()),
            Some(run) => (!run.is_handed_in()).then(say::exercise_review_first),
        }
    }

    /// Shows the state of the machine at a tick of the session.
    pub(super) fn look_at(&mut self, tick: u64) {
        if let Some(why) = self.look_refusal() {
            return self.notify(Notice::Message(why));
        }
        if self.has_real_slides && self.emulator.cnc().is_moving() {
            return self.notify(Notice::Message(say::timeline_not_while_moving()));
        }
        if !self.timeline.shows_past() {
            self.release_all_keys();
            self.follow_with_recorders();
        }
        let timeline = &mut self.timeline;
        let Some(history) = &timeline.history else {
            return;
        };
        if tick >= history.end() {
            return self.return_to_present();
        }
        let tick = tick.max(history.start());
        let shown = match timeline.past.take() {
            Some(past) if !timeline.has_linked_states => past.redirect(history, tick),
            _ if timeline.has_linked_states => {
                PastMachine::stored(history, tick, self.part.empty_for_same_window())
            }
            _ => PastMachine::new(history, tick, self.part.empty_for_same_window()),
        };
        timeline.past = shown;
        self.refresh_monitor();
    }

    /// Shows the present again; does nothing while it is shown.
    pub(super) fn return_to_present(&mut self) {
        if self.timeline.past.take().is_some() {
            self.part.force_publish();
            self.refresh_monitor();
        }
    }

    /// Returns `true` if a command would change the machine while the past is shown. The window
    /// is notified. With a board a key that stops it shows the present and acts.
    pub(super) fn is_refused_in_past(&mut self, command: &Command) -> bool {
        if !self.timeline.shows_past() || !changes_machine(command) {
            return false;
        }
        if self.is_in_exercise() && matches!(command, Command::Lesson(_) | Command::Exercise(_)) {
            self.return_to_present();
            return false;
        }
        if let Command::Key { key, down: true } | Command::Tap(key) = command
            && self.has_real_slides
            && (*key == Key::EmergencyStop || ends_motion(*key))
        {
            self.return_to_present();
            return false;
        }
        self.notify(Notice::Message(say::timeline_past_is_shown()));
        true
    }

    /// Returns `true` if the window sends the job that the restored part has already: new stock
    /// would discard the part. The answer counts once.
    pub(super) fn is_job_of_restored_part(&mut self, chosen: Option<&SelectedJob>) -> bool {
        let is_expected = core::mem::take(&mut self.timeline.expects_job);
        let state = self.part.state();
        is_expected
            && chosen.is_some_and(|chosen| state.live().is_some() && **state.job() == chosen.job)
    }

    /// Makes the next publication of machine and PLC due immediately.
    fn refresh_monitor(&mut self) {
        if let Some(monitor) = &mut self.machine_monitor {
            monitor.next_tick = 0;
        }
    }

    /// Ends the current session, and continues from the shown moment.
    fn continue_from_past(&mut self) {
        if self.has_real_slides || self.timeline.has_linked_states {
            return self.notify(Notice::Message(say::timeline_not_with_board()));
        }
        let Some(tick) = self.timeline.past.as_ref().map(PastMachine::tick) else {
            return;
        };
        self.follow_with_recorders();
        let timeline = &mut self.timeline;
        let Some(moment) = (timeline.history.as_mut()).and_then(|it| it.continue_from(tick)) else {
            return;
        };
        timeline.abandoned = Some(AbandonedFuture {
            marks: timeline.marks.split_after(tick),
            alarms: self.alarm_history.clone(),
        });
        self.alarm_history.return_to(tick, moment.emulator.cnc());
        self.restore(moment);
        self.notify(Notice::Message(say::timeline_continued()));
    }

    /// Returns to the end of the session that was abandoned.
    fn return_to_branch(&mut self) {
        if let Some(why) = self.look_refusal() {
            return self.notify(Notice::Message(why));
        }
        if self.has_real_slides || self.timeline.has_linked_states {
            return self.notify(Notice::Message(say::timeline_not_with_board()));
        }
        self.follow_with_recorders();
        let timeline = &mut self.timeline;
        let from = timeline.history.as_ref().and_then(History::branch);
        let moment = timeline
            .history
            .as_mut()
            .and_then(History::return_to_branch);
        let (Some((from, _)), Some(moment)) = (from, moment) else {
            return self.notify(Notice::Message(say::timeline_no_other_future()));
        };
        let replaced = AbandonedFuture {
            marks: timeline.marks.split_after(from),
            alarms: self.alarm_history.clone(),
        };
        if let Some(abandoned) = timeline.abandoned.replace(replaced) {
            timeline.marks.append(abandoned.marks);
            self.alarm_history = abandoned.alarms;
        }
        self.restore(moment);
        self.notify(Notice::Message(say::timeline_returned()));
    }

    /// Replaces the machine and the part by those of a moment. What is connected to the machine
    /// is broken off: it cannot go back.
    fn restore(&mut self, moment: MachineMoment) {
        let selected = |emulator: &Emulator| {
            let programs = emulator.cnc().programs();
            let id = programs.selected()?;
            Some((id, programs.get(id)?.clone()))
        };
        self.timeline.past = None;
        self.timeline.last_view = None;
        self.timeline.expects_job = selected(&self.emulator) != selected(&moment.emulator);
        self.emulator = moment.emulator;
        self.emulator.record_inputs();
        self.part.replace_state(moment.part);
        let is_own = self.lesson.is_none();
        for recorder in self.recorders.iter_mut().filter(|_| is_own) {
            recorder.begin_section();
        }
        self.follow_with_recorders();
        self.release_all_keys();
        self.drop_wheel();
        // They were written before the machine went back.
        self.emulator.take_sent();
        self.emulator.take_port_files();
        self.emulator.take_aborted();
        if let Some(partner) = self.partner.as_mut().filter(|_| is_own) {
            partner.break_off(&mut self.emulator);
        }
        if let Some(serial) = self.serial.as_mut().filter(|_| is_own) {
            serial.break_off(&mut self.emulator);
        }
        self.clear_key_refusals();
        self.start_watch = StartWatch::default();
        self.wait_watch = WaitWatch::default();
        self.program_breakpoints.release();
        self.resync_breakpoints();
        self.last_opened = None;
        self.refresh_monitor();
    }
}

/// Returns whether a command changes the machine or its part.
pub(super) const fn changes_machine(command: &Command) -> bool {
    match command {
        Command::Key { down, .. } => *down,
        Command::Exercise(action) => action.changes_machine(),
        Command::Tap(_)
        | Command::Type(_)
        | Command::Turn(_)
        | Command::Open(_)
        | Command::OpenSample { .. }
        | Command::Receive(_)
        | Command::FitGraphic { .. }
        | Command::Fault(..)
        | Command::Request(_)
        | Command::Write(_)
        | Command::PlugUdisk(_)
        | Command::PowerCycle
        | Command::ForceInput(..)
        | Command::ReleaseForcedBits
        | Command::ClearFaults
        | Command::FreeLathe
        | Command::Lesson(_)
        | Command::Store(..)
        | Command::FreshStock
        | Command::CrashStops(_)
        | Command::Overload(_) => true,
        // The window finds the job of the present program some time after it was opened.
        Command::Job(_)
        | Command::Tools(_)
        | Command::TransferFailed
        | Command::Network(..)
        | Command::Seat(_)
        | Command::Explain(_)
        | Command::Link(_)
        | Command::Probe(_)
        | Command::Monitor(_)
        | Command::Speed(_)
        | Command::Translate(_)
        | Command::PublishMotion(_)
        | Command::WatchLink(_)
        | Command::SendMachine(_)
        | Command::SendSetup(_)
        | Command::SendState(_)
        | Command::ShowPart(_)
        | Command::Timeline(_)
        | Command::Breakpoints(_)
        | Command::Watch(_)
        | Command::Alive
        | Command::ReleaseAll
        | Command::Quit => false,
    }
}
