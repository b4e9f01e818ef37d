//! Chooses the most important message for the message line.

use egui::{Align, Layout, Ui};
use gsk_core::command::ProgramId;
use gsk_host::kernel::{Command, StartDistance};
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::Key;

use super::top_bar;
use crate::focus;
use crate::widgets::alarm_text;
use crate::widgets::status_message::StatusMessage;
use crate::{Window, key_label};

impl Window {
    /// Draws the line at the bottom of the window with what is most important now: a latched
    /// key, a crash, an alarm, a message or a hint.
    pub(crate) fn show_message_line(&self, ui: &mut Ui) {
        let speed = self.snapshot.as_ref().map(|it| it.speed_percent);
        let Some(speed) = speed.filter(|speed| *speed < 100) else {
            return self.show_top_message(ui);
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            top_bar::show_slow_computer(ui, speed, self.settings.language);
            let rest = ui.available_size();
            ui.allocate_ui_with_layout(rest, Layout::left_to_right(Align::Center), |ui| {
                self.show_top_message(ui);
            });
        });
    }

    /// Draws the most important message.
    fn show_top_message(&self, ui: &mut Ui) {
        let language = self.settings.language;
        if let Some(key) = self.held_keys.latched_key() {
            let text = say::window_key_is_kept_hint(key_label(key)).text(language);
            return top_bar::show_message(ui, Some(&text), true, "");
        }
        let faults = self.snapshot.as_ref().map_or(0, |it| it.forced.faults);
        if let Some(crash @ StatusMessage::Collided(_)) = &self.message
            && faults > 0
        {
            if top_bar::show_crash(ui, &crash.text(language), language) {
                self.console.send(Command::FreeLathe);
            }
            return;
        }
        let pressed = self
            .snapshot
            .as_ref()
            .is_some_and(|picture| picture.pressed.contains(&Key::EmergencyStop));
        let alarm = self.snapshot.as_ref().and_then(|it| it.alarm.as_ref());
        // With a board the alarm's detail reports the position of the slides.
        if pressed && alarm.is_none_or(|alarm| alarm.detail.is_none()) {
            return top_bar::show_message(
                ui,
                Some(&say::window_hint_emergency_stop().text(language)),
                true,
                "",
            );
        }
        if let Some(alarm) = alarm
            && self.message.is_none()
        {
            return top_bar::show_alarm(ui, alarm, language, self.lcd.bounds());
        }
        let warned = self.message.as_ref().is_some_and(StatusMessage::is_warning);
        if focus::are_cursor_keys_reserved(ui.ctx()) && !warned {
            let text = say::window_hint_list().text(language);
            return top_bar::show_message(ui, Some(&text), false, "");
        }
        let wait = self
            .snapshot
            .as_ref()
            .and_then(|it| it.program_wait.as_ref());
        if let Some(waits) = wait.filter(|_| !warned) {
            let block = waits.block.as_ref();
            let place = block.map(|it| alarm_text::source_text(it, language));
            let condition = waits.condition.clone();
            let text = say::window_waits(place.unwrap_or_default(), condition).text(language);
            return top_bar::show_message(ui, Some(&text), false, "");
        }
        let start = self.snapshot.as_ref().and_then(|it| it.start_distance);
        if let Some(start) = start.filter(|_| !warned) {
            let text = Self::start_distance_text(start, language).text(language);
            return top_bar::show_message(ui, Some(&text), true, "");
        }
        let is_position_unknown = self.snapshot.as_ref().is_some_and(|it| it.position_unknown);
        let program = self.snapshot.as_ref().and_then(|it| it.program);
        // A lesson shows its own instructions.
        let in_lesson = self.snapshot.as_ref().is_some_and(|it| it.lesson.is_some());
        if in_lesson && self.message.is_none() {
            return top_bar::show_message(ui, None, false, "");
        }
        let hint = match (is_position_unknown, program) {
            (true, _) => say::window_hint_machine_zero(),
            (false, Some(_)) => say::window_hint_start(),
            (false, None) => say::window_hint(),
        };
        let message = self.message.as_ref();
        let text = message.map(|message| message.text(language));
        let warning = message.is_some_and(StatusMessage::is_warning);
        top_bar::show_message(ui, text.as_deref(), warning, &hint.text(language));
    }
    /// The sentence about a program that would start away from its last start point.
    fn start_distance_text(start: StartDistance, language: Language) -> Message {
        let name = match start.program {
            ProgramId::Stored(number) => format!("O{number:04}"),
            _ => say::window_this_program().text(language),
        };
        let (x, z) = (start.distance.diameter().0, start.distance.z);
        say::window_start_differs(name, x, z)
    }
}
