//! The message line: what is most dangerous now, with its sign; beside it the newest message,
//! and at the right the history.

use egui::{Align, Label, Layout, RichText, Ui};
use gsk_core::command::ProgramId;
use gsk_core::model::ProgramNaming;
use gsk_core::operation::RunState;
use gsk_host::kernel::{Command, PanelSnapshot, StartDistance};
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::Key;

use super::message_history::{HistoryRequest, LineMessage, LineText};
use super::network_pane::show_help_request;
use super::top_bar;
use super::way_back::{WayBack, is_lit};
use crate::Window;
use crate::focus;
use crate::fonts;
use crate::theme;
use crate::view::ViewId;
use crate::views::{halt_text, show_halt_buttons};
use crate::widgets::alarm_text;
use crate::widgets::key_label::key_label;
use crate::widgets::severity::MessageSeverity;
use crate::widgets::status_message::StatusMessage;

/// Minimum width for a second message beside the first, points.
const SECOND_MESSAGE_WIDTH: f32 = 240.0;

impl Window {
    /// Draws the message line at the bottom of the window.
    pub(crate) fn show_message_line(&mut self, ui: &mut Ui) {
        let top = self.top_message(focus::are_cursor_keys_reserved(ui.ctx()));
        self.message_history.record(top.as_ref());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            self.show_history_button(ui);
            self.show_why_button(ui);
            if let Some(asks) = self.snapshot.as_ref().and_then(|it| it.asks_help) {
                show_help_request(ui, self.settings.language, &self.console, asks);
            }
            let speed = self.snapshot.as_ref().map(|it| it.speed_percent);
            if let Some(speed) = speed.filter(|speed| *speed < 100) {
                top_bar::show_slow_computer(ui, speed, self.settings.language);
            }
            let rest = ui.available_size();
            ui.allocate_ui_with_layout(rest, Layout::left_to_right(Align::Center), |ui| {
                self.show_messages(ui, top.as_ref());
            });
        });
    }

    fn show_history_button(&mut self, ui: &mut Ui) {
        let language = self.settings.language;
        let records = self.snapshot.as_ref().map(|it| it.alarm_records.clone());
        let records = records.as_deref().map_or(&[][..], Vec::as_slice);
        let history = &self.message_history;
        let name = say::window_history(history.len()).text(language);
        let menu = ui.menu_button(name, |ui| {
            ui.set_min_width(520.0);
            history.show(ui, records, language)
        });
        self.message_history.set_open(menu.inner.is_some());
        match menu.inner.flatten() {
            Some(HistoryRequest::ShowBlock(record)) => self.show_block(*record),
            Some(HistoryRequest::ShowCollisions) => {
                self.show_view(ViewId::Machine);
                self.views.lathe().show_newest_collision();
            }
            None => {}
        }
    }

    /// Draws the most dangerous message and, if there is space, a newer one beside it.
    fn show_messages(&mut self, ui: &mut Ui, top: Option<&LineMessage>) {
        let language = self.settings.language;
        let Some(LineMessage { severity, text }) = top else {
            let hint = self.next_step().map(|hint| hint.text(language));
            return top_bar::show_hint(ui, &hint.unwrap_or_default());
        };
        severity.show_sign(ui, severity.name().text(language));
        if self.is_stopped_by_crash() {
            if top_bar::show_crash(ui, &text.text(language), language) {
                self.console.send(Command::FreeLathe);
                // It explains an alarm that is gone.
                self.why.close();
            }
            return;
        }
        let is_halted = self.snapshot.as_ref().is_some_and(|it| it.halt.is_some());
        if is_halted && *severity == MessageSeverity::Hint {
            if let Some(command) = show_halt_buttons(ui, language) {
                self.console.send(command);
            }
        } else if self.is_start_hint(*severity) {
            self.show_way_back_button(ui);
        }
        let words = text.text(language);
        let font = egui::TextStyle::Body.resolve(ui.style());
        let width = ui.available_width();
        let second = self.message.as_ref().map(StatusMessage::severity);
        let second =
            second.filter(|second| second < severity && width > 2.0 * SECOND_MESSAGE_WIDTH);
        if let LineText::Alarm(alarm) = text {
            let width = if second.is_some() {
                width - SECOND_MESSAGE_WIDTH
            } else {
                width
            };
            ui.scope(|ui| {
                ui.set_max_width(width);
                top_bar::show_alarm(ui, alarm, language, self.lcd.bounds());
            });
        } else {
            let label = Label::new(fonts::layout_text(&words, font, severity.color())).truncate();
            ui.add(label).on_hover_text(&words);
        }
        if let (Some(severity), Some(message)) = (second, &self.message) {
            let words = message.text(language);
            severity.show_sign(ui, severity.name().text(language));
            let newer = RichText::new(&words).color(theme::HINT_TEXT);
            ui.add(Label::new(newer).truncate()).on_hover_text(words);
        }
    }

    /// Returns what the message lines of separate windows show: the most dangerous message and,
    /// if it is another one, the newest.
    pub(crate) fn messages_for_separate_windows(&self) -> Vec<(MessageSeverity, String)> {
        let language = self.settings.language;
        let top = self
            .top_message(false)
            .map(|it| (it.severity, it.text.text(language)));
        let newest = self
            .message
            .as_ref()
            .map(|it| (it.severity(), it.text(language)));
        let newest = newest.filter(|newest| top.as_ref() != Some(newest));
        top.into_iter().chain(newest).collect()
    }

    /// Whether the hint in the message line is that of a start away from the last one.
    fn is_start_hint(&self, severity: MessageSeverity) -> bool {
        let snapshot = self.snapshot.as_ref();
        severity == MessageSeverity::Hint
            && snapshot.is_some_and(|it| {
                (it.start_distance.is_some() || it.resumes_at.is_some())
                    && it.program_wait.is_none()
                    && self.way_back.is_none()
            })
    }

    /// Draws the button that marks on the panel the keys that return the machine to the start point
    /// of the program.
    fn show_way_back_button(&mut self, ui: &mut Ui) {
        let language = self.settings.language;
        let words = RichText::new(say::window_way_back().text(language));
        let button =
            ui.add(egui::Button::new(words.color(theme::TEXT_ON_BRIGHT)).fill(theme::WARNING));
        let hint = say::window_way_back_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            self.way_back = self.snapshot.as_ref().map(WayBack::new);
            // The summary of the program would stand beside each step.
            self.message
                .take_if(|message| message.severity() < MessageSeverity::Hint);
        }
    }

    /// The crash that has stopped the lathe, until the lathe is free.
    fn crash(&self) -> Option<&Message> {
        self.snapshot.as_ref()?.crash.as_ref()
    }

    fn is_stopped_by_crash(&self) -> bool {
        self.crash().is_some()
    }

    /// Returns the message with the highest severity; `None` if there is only a hint. `in_list`:
    /// the cursor keys move in a list.
    fn top_message(&self, in_list: bool) -> Option<LineMessage> {
        let status = self.message.as_ref().map(|message| LineMessage {
            severity: message.severity(),
            text: LineText::Status(message.clone()),
        });
        let candidates = [
            self.safety_message(),
            self.crash_message(),
            self.alarm_message(),
            status,
            self.state_message(in_list),
        ];
        // Of two equal ones the first counts.
        let mut top: Option<LineMessage> = None;
        for candidate in candidates.into_iter().flatten() {
            if (top.as_ref()).is_none_or(|top| top.severity < candidate.severity) {
                top = Some(candidate);
            }
        }
        top
    }

    /// A key that stays down, or the emergency stop. With a board the alarm's detail reports
    /// the position of the slides and says more than the emergency stop.
    fn safety_message(&self) -> Option<LineMessage> {
        let fixed = |message| LineMessage {
            severity: MessageSeverity::Safety,
            text: LineText::Fixed(message),
        };
        if let Some(key) = self.held_keys.latched_key() {
            let language = self.settings.language;
            return Some(fixed(say::window_key_is_kept_hint(key_label(
                key, language,
            ))));
        }
        let snapshot = self.snapshot.as_ref()?;
        let is_pressed = snapshot.pressed.contains(&Key::EmergencyStop);
        let alarm = snapshot.alarm.as_ref();
        let says_position = alarm.is_some_and(|alarm| alarm.detail.is_some());
        (is_pressed && !says_position && !self.is_stopped_by_crash())
            .then(|| fixed(say::window_hint_emergency_stop()))
    }

    /// The crash that has stopped the lathe; `None` without one. Its alarm and its fault are the
    /// same event.
    fn crash_message(&self) -> Option<LineMessage> {
        let crash = self.crash()?.clone();
        Some(LineMessage {
            severity: MessageSeverity::Alarm,
            text: LineText::Status(StatusMessage::Collided(crash)),
        })
    }

    fn alarm_message(&self) -> Option<LineMessage> {
        let alarm = self.snapshot.as_ref()?.alarm.clone()?;
        Some(LineMessage {
            severity: MessageSeverity::Alarm,
            text: LineText::Alarm(alarm),
        })
    }

    /// Returns a message that explains how the state of the control affects the next key; `None` in
    /// a usual state.
    fn state_message(&self, in_list: bool) -> Option<LineMessage> {
        let language = self.settings.language;
        let naming = self.console.naming();
        let hint = |severity, message| {
            let text = LineText::Fixed(message);
            Some(LineMessage { severity, text })
        };
        if in_list {
            return hint(MessageSeverity::Hint, say::window_hint_list());
        }
        let snapshot = self.snapshot.as_ref()?;
        if let Some(halt) = &snapshot.halt {
            return hint(MessageSeverity::Hint, halt_text(halt, naming, language));
        }
        if let Some(waits) = &snapshot.program_wait {
            let block = waits.block.as_ref();
            let place = block.map(|it| alarm_text::source_text(it, naming, language));
            let condition = waits.condition.clone();
            let text = say::window_waits(place.unwrap_or_default(), condition);
            return hint(MessageSeverity::Hint, text);
        }
        if let Some(text) = self
            .way_back
            .and_then(|it| it.step_text(snapshot, language))
        {
            return hint(MessageSeverity::Hint, text);
        }
        if let Some(block) = &snapshot.resumes_at {
            let block = alarm_text::source_text(block, naming, language);
            return hint(MessageSeverity::Hint, say::window_resumes_at(block));
        }
        let start = snapshot.start_distance?;
        hint(
            MessageSeverity::Hint,
            Self::start_distance_text(start, naming, language),
        )
    }

    /// Returns a hint about the next action of the operator; in an exercise its title and time.
    /// `None` in a lesson, which has its own instructions.
    fn next_step(&self) -> Option<Message> {
        let snapshot = self.snapshot.as_ref();
        let exercise = snapshot.and_then(|it| it.exercise.as_ref());
        if let Some(exercise) = exercise.filter(|exercise| !exercise.is_handed_in) {
            let title = exercise.title.in_language(self.settings.language);
            return Some(say::exercise_line(title, exercise.remaining_text()));
        }
        if snapshot.is_some_and(PanelSnapshot::is_at_practice_machine) {
            return None;
        }
        let is_position_unknown = snapshot.is_some_and(|it| it.position_unknown);
        let program = snapshot.and_then(|it| it.program);
        let is_running = snapshot.is_some_and(|it| it.run_state == RunState::Run);
        let waits_at_end = snapshot.is_some_and(|it| it.waits_at_end);
        let is_in_auto = snapshot.is_some_and(|it| is_lit(Key::Auto, it));
        let is_away = snapshot.is_some_and(|it| it.is_away_from_start);
        Some(match (is_position_unknown, program) {
            (true, _) => say::window_hint_machine_zero(),
            (false, Some(_)) if is_running => say::window_hint_running(),
            (false, Some(_)) if waits_at_end => say::window_hint_program_end(),
            (false, Some(_)) if is_in_auto => say::window_hint_cycle_start(),
            // The way back comes before the cycle start.
            (false, Some(_)) if is_away => say::window_hint_start_away(),
            (false, Some(_)) => say::window_hint_start(),
            (false, None) => say::window_hint(),
        })
    }

    /// The sentence about a program that would start away from its last start point.
    fn start_distance_text(
        start: StartDistance,
        naming: ProgramNaming,
        language: Language,
    ) -> Message {
        let name = match start.program {
            ProgramId::Stored(number) => naming.name(number),
            _ => say::window_this_program().text(language),
        };
        let (x, z) = (start.distance.diameter().0, start.distance.z);
        say::window_start_differs(name, x, z)
    }
}
