//! Chooses the most important message for the message line.

use egui::Ui;
use gsk_messages::say;
use gsk_panel::keys::Key;

use super::message::Message;
use super::{Window, alarm_line, focus, key_label, top_bar};
use crate::kernel::Command;

impl Window {
    /// Draws the message line.
    pub(super) fn status(&self, ui: &mut Ui) {
        let language = self.settings.language;
        if let Some(key) = self.held.kept() {
            let text = say::window_key_is_kept_hint(key_label(key)).text(language);
            return top_bar::status(ui, Some(&text), true, "");
        }
        let faults = self.picture.as_ref().map_or(0, |it| it.imposed.faults);
        if let Some(crash @ Message::Collided(_)) = &self.message
            && faults > 0
        {
            if top_bar::crash(ui, &crash.text(language), language) {
                self.console.send(Command::FreeLathe);
            }
            return;
        }
        let speed = self
            .picture
            .as_ref()
            .map_or(100, |picture| picture.speed_percent);
        if speed < 100 {
            let text = say::window_too_slow(speed).text(language);
            return top_bar::status(ui, Some(&text), true, "");
        }
        let pressed = self
            .picture
            .as_ref()
            .is_some_and(|picture| picture.pressed.contains(&Key::EmergencyStop));
        let alarm = self.picture.as_ref().and_then(|it| it.alarm.as_ref());
        // With a board the alarm's detail reports the position of the slides.
        if pressed && alarm.is_none_or(|alarm| alarm.detail.is_none()) {
            return top_bar::status(
                ui,
                Some(&say::window_hint_emergency_stop().text(language)),
                true,
                "",
            );
        }
        if let Some(alarm) = alarm
            && self.message.is_none()
        {
            return top_bar::alarm(ui, alarm, language, self.lcd.place());
        }
        let warned = self.message.as_ref().is_some_and(Message::is_warning);
        if focus::keeps_keys(ui.ctx()) && !warned {
            let text = say::window_hint_list().text(language);
            return top_bar::status(ui, Some(&text), false, "");
        }
        let waits = self.picture.as_ref().and_then(|it| it.waits.as_ref());
        if let Some(waits) = waits.filter(|_| !warned) {
            let place = waits.block.as_ref();
            let place = place.map(|it| alarm_line::place_of(it, language));
            let what = waits.what.clone();
            let text = say::window_waits(place.unwrap_or_default(), what).text(language);
            return top_bar::status(ui, Some(&text), false, "");
        }
        let unknown = self.picture.as_ref().is_some_and(|it| it.place_unknown);
        let program = self.picture.as_ref().and_then(|it| it.program);
        // A lesson shows its own instructions.
        let in_lesson = self.picture.as_ref().is_some_and(|it| it.lesson.is_some());
        if in_lesson && self.message.is_none() {
            return top_bar::status(ui, None, false, "");
        }
        let hint = match (unknown, program) {
            (true, _) => say::window_hint_machine_zero(),
            (false, Some(_)) => say::window_hint_start(),
            (false, None) => say::window_hint(),
        };
        let message = self.message.as_ref();
        let text = message.map(|message| message.text(language));
        let warning = message.is_some_and(Message::is_warning);
        top_bar::status(ui, text.as_deref(), warning, &hint.text(language));
    }
}
