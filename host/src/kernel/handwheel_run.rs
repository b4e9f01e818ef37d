//! Handwheel run: in automatic and MDI operation the time of the simulated lathe follows the
//! handwheel, forwards and back.
//!
//! Forwards the machine makes the ticks that the wheel grants. Backwards the window sees the past
//! of the session, and forwards again the same moments until the present is reached.
//!
//! With real slides the control retraces the path of a held run instead.

use gsk_core::cnc::ControlRequest;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_messages::say;
use gsk_panel::keys::Key;

use super::edges::{KeyEdge, is_read_by_ladder};
use super::timeline::TimelineCommand;
use super::{Command, Kernel, Notice};

/// Machine time of one graduation of the handwheel, ticks.
const GRADUATION_TICKS: u64 = 20;
/// Greatest machine time that the wheel may be ahead of the machine, ticks. Beyond it the program
/// runs at the speed of the lathe.
const MAX_DUE_TICKS: u64 = 1000;
/// Machine time that passes for a key of the machine while the program waits for the wheel, ticks:
/// the shortest press and five slots of the ladder.
const MACHINE_KEY_TICKS: u64 = 90;
/// Machine time that passes for any other key, ticks.
const PAGE_KEY_TICKS: u64 = 2;

/// State of the handwheel run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandwheelRun {
    is_on: bool,
    /// Ticks that the wheel or a key has granted and that the machine has not made yet.
    due_ticks: u64,
    /// The last machine time that was not the standstill of a feed hold, ticks. Going back begins
    /// there: the wheel would only pass the time of the hold before it.
    active_until: u64,
}

impl HandwheelRun {
    pub const fn is_on(&self) -> bool {
        self.is_on
    }
}

impl Kernel {
    /// Switches the handwheel run. It is refused in lessons and exercises. With real slides the
    /// control retraces the path of a held run. A program that waits for the wheel is held: only
    /// cycle start continues it.
    pub(super) fn set_handwheel_run(&mut self, on: bool) {
        if on && self.lesson.is_some() {
            return self.notify(Notice::Message(say::handwheel_run_not_in_lesson()));
        }
        if self.has_real_slides {
            return self.set_retrace(on);
        }
        if !on && self.follows_handwheel() {
            self.key_edges.push(KeyEdge::Tap(Key::FeedHold));
        }
        self.handwheel_run = HandwheelRun {
            is_on: on,
            due_ticks: 0,
            ..self.handwheel_run
        };
    }

    fn set_retrace(&mut self, on: bool) {
        if on == self.emulator.cnc().has_retrace() {
            return;
        }
        let request = ControlRequest::SetRetrace(on);
        match self.emulator.cnc().request_refusal(&request) {
            Some(why) => self.notify(Notice::Message(why)),
            // The request raises no alarm.
            None => drop(self.emulator.request(request)),
        }
    }

    /// Returns whether the handwheel run is switched on.
    pub(super) fn is_handwheel_run(&self) -> bool {
        match self.has_real_slides {
            true => self.emulator.cnc().has_retrace(),
            false => self.handwheel_run.is_on(),
        }
    }

    /// Grants machine time for a key, so that the control sees it while the program waits for
    /// the wheel.
    pub(super) fn grant_key_ticks(&mut self, command: &Command) {
        let ticks = match command {
            Command::Key { key, .. } | Command::Tap(key) if is_read_by_ladder(*key) => {
                MACHINE_KEY_TICKS
            }
            Command::Key { .. } | Command::Tap(_) | Command::Type(_) => PAGE_KEY_TICKS,
            _ => return,
        };
        let due = &mut self.handwheel_run.due_ticks;
        *due = ticks.max(*due);
    }

    /// Returns whether the next tick may be made; the wheel or a key must have granted it if the
    /// program follows the wheel.
    pub(super) fn take_handwheel_tick(&mut self) -> bool {
        let cnc = self.emulator.cnc();
        if cnc.run_state() != RunState::Hold || cnc.is_moving() {
            self.handwheel_run.active_until = self.emulator.ticks();
        }
        if !self.follows_handwheel() {
            return true;
        }
        let is_due = self.handwheel_run.due_ticks > 0;
        self.handwheel_run.due_ticks = self.handwheel_run.due_ticks.saturating_sub(1);
        is_due
    }

    /// Moves the machine through its time by a turn of the handwheel; returns `false` if the turn
    /// is for the axes.
    pub(super) fn turn_through_time(&mut self, graduations: i32) -> bool {
        if !self.can_run_by_handwheel() {
            return false;
        }
        let cnc = self.shown_machine().cnc();
        let shows_past = self.timeline.shows_past();
        if !shows_past && !matches!(cnc.mode(), OperatingMode::Auto | OperatingMode::Mdi) {
            return false;
        }
        let ticks = u64::from(graduations.unsigned_abs()) * GRADUATION_TICKS;
        let now = self.shown_machine().ticks();
        match (graduations > 0, shows_past) {
            (true, true) => match now.saturating_add(ticks) {
                tick if self.is_held() && tick >= self.handwheel_run.active_until => {
                    self.return_to_present();
                }
                tick => self.look_at(tick),
            },
            (true, false) => {
                let due = &mut self.handwheel_run.due_ticks;
                *due = due.saturating_add(ticks).min(MAX_DUE_TICKS);
            }
            (false, _) => {
                self.handwheel_run.due_ticks = 0;
                let from = match self.is_held() && !shows_past {
                    true => now.min(self.handwheel_run.active_until),
                    false => now,
                };
                self.look_at(from.saturating_sub(ticks));
            }
        }
        true
    }

    /// Whether the program is held in the present.
    fn is_held(&self) -> bool {
        self.emulator.cnc().run_state() == RunState::Hold
    }

    /// Returns whether the program waits for the wheel now.
    fn follows_handwheel(&self) -> bool {
        self.can_run_by_handwheel() && self.emulator.cnc().run_state() == RunState::Run
    }

    fn can_run_by_handwheel(&self) -> bool {
        self.handwheel_run.is_on && !self.has_real_slides && self.lesson.is_none()
    }

    /// Switches the handwheel run off if the time line, which shows its state, is closed.
    pub(super) fn end_hidden_handwheel_run(&mut self, command: &TimelineCommand) {
        if matches!(command, TimelineCommand::Publish(false)) {
            self.set_handwheel_run(false);
        }
    }
}
