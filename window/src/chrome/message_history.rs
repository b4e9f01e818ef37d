//! The messages of the message line since the program was started: time, text, how often.

use std::collections::VecDeque;

use egui::{Label, RichText, ScrollArea, Ui};
use gsk_core::alarm::Alarm;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};
use gsk_panel::alarm_log::AlarmRecord;

use crate::theme;
use crate::widgets::alarm_text;
use crate::widgets::severity::MessageSeverity;
use crate::widgets::status_message::StatusMessage;

/// Maximum number of messages that the history stores.
const MAX_ENTRIES: usize = 200;

/// The text of a message, which is formatted later in the selected language.
#[derive(Clone, Debug, PartialEq)]
pub enum LineText {
    Fixed(Message),
    Status(StatusMessage),
    Alarm(Alarm),
}

impl LineText {
    /// Formats the text in a language for the message line.
    pub fn text(&self, language: Language) -> String {
        match self {
            Self::Fixed(message) => message.text(language),
            Self::Status(status) => status.text(language),
            Self::Alarm(alarm) => alarm_text::one_line(alarm, language),
        }
    }
}

/// A message of the message line, with its severity.
#[derive(Clone, Debug, PartialEq)]
pub struct LineMessage {
    pub severity: MessageSeverity,
    pub text: LineText,
}

/// An entry of the message history: a message, its time and count.
#[derive(Clone, Debug)]
struct HistoryEntry {
    message: LineMessage,
    /// Local time of the message's last occurrence: `14:03:27`.
    time: String,
    /// Number of times that the message came in succession.
    count: u32,
}

impl HistoryEntry {
    /// Whether a message has the same words, whatever its severity.
    fn has_text_of(&self, message: &LineMessage) -> bool {
        self.message.text.text(Language::En) == message.text.text(Language::En)
    }
}

/// A request of the operator in the message history.
pub enum HistoryRequest {
    /// Show the block that raised this alarm.
    ShowBlock(Box<AlarmRecord>),
    /// Show the list of collisions of the machine view.
    ShowCollisions,
}

/// The messages since the start, the newest first.
#[derive(Debug, Default)]
pub struct MessageHistory {
    entries: VecDeque<HistoryEntry>,
    /// The message that the line shows; `None` while it shows only a hint.
    current: Option<LineMessage>,
    is_open: bool,
    /// Number of times that the list was closed: each opening begins at the newest message.
    closings: u32,
}

impl MessageHistory {
    /// Records the message that the line now shows; `None` if it shows only a hint.
    pub fn record(&mut self, shown: Option<&LineMessage>) {
        let shown = shown.filter(|message| message.severity.is_kept());
        if self.current.as_ref() == shown {
            return;
        }
        self.current = shown.cloned();
        let Some(message) = shown else { return };
        let time = platform::clock_text();
        match self.entries.front_mut() {
            Some(newest) if newest.message == *message => {
                newest.count += 1;
                newest.time = time;
            }
            // A crash is reported first, and then stands as an alarm.
            Some(newest) if newest.has_text_of(message) => {
                newest.message.severity = newest.message.severity.max(message.severity);
                newest.time = time;
            }
            _ => {
                self.entries.push_front(HistoryEntry {
                    message: message.clone(),
                    time,
                    count: 1,
                });
                self.entries.truncate(MAX_ENTRIES);
            }
        }
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Stores whether the list is open in this frame.
    pub fn set_open(&mut self, is_open: bool) {
        self.closings += u32::from(self.is_open && !is_open);
        self.is_open = is_open;
    }

    /// Draws the messages, the newest first. `records` are the alarms with the blocks that raised
    /// them. Returns the request of the operator; `None` without one.
    pub fn show(
        &self,
        ui: &mut Ui,
        records: &[AlarmRecord],
        language: Language,
    ) -> Option<HistoryRequest> {
        let mut request = None;
        if self.entries.is_empty() {
            ui.label(say::window_history_empty().text(language));
        }
        let list = ScrollArea::vertical().id_salt(self.closings);
        let list = list.max_height(320.0);
        list.min_scrolled_height(320.0).show(ui, |ui| {
            for entry in &self.entries {
                ui.horizontal(|ui| {
                    request = show_entry(ui, entry, records, language).or(request.take());
                });
            }
        });
        request
    }
}

fn show_entry(
    ui: &mut Ui,
    entry: &HistoryEntry,
    records: &[AlarmRecord],
    language: Language,
) -> Option<HistoryRequest> {
    let LineMessage { severity, text } = &entry.message;
    ui.label(
        RichText::new(&entry.time)
            .color(theme::HINT_TEXT)
            .monospace(),
    );
    severity.show_sign(ui, severity.name().text(language));
    let words = RichText::new(text.text(language)).color(severity.color());
    ui.add(Label::new(words).wrap());
    if entry.count > 1 {
        let count = format!("{}x", entry.count);
        ui.label(RichText::new(count).color(theme::HINT_TEXT));
    }
    let place = match text {
        LineText::Alarm(alarm) => {
            let record = records.iter().find(|record| record.alarm == *alarm)?;
            record.alarm.source?;
            HistoryRequest::ShowBlock(Box::new(record.clone()))
        }
        LineText::Status(StatusMessage::Collided(_)) => HistoryRequest::ShowCollisions,
        _ => return None,
    };
    let link = ui.link(say::window_history_show_place().text(language));
    link.clicked().then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(severity: MessageSeverity, text: &str) -> LineMessage {
        let text = LineText::Status(StatusMessage::Sent(text.to_owned()));
        LineMessage { severity, text }
    }

    #[test]
    fn a_message_is_recorded_once_while_it_stands_and_counted_when_it_returns() {
        let mut history = MessageHistory::default();
        let refusal = message(MessageSeverity::Refusal, "one");
        for _ in 0..3 {
            history.record(Some(&refusal));
        }
        history.record(None);
        history.record(Some(&refusal));
        assert_eq!(history.len(), 1);
        assert_eq!(history.entries[0].count, 2);
        history.record(Some(&message(MessageSeverity::Alarm, "two")));
        history.record(Some(&refusal));
        assert_eq!(history.len(), 3);
    }

    #[test]
    fn hints_are_not_recorded_and_the_oldest_message_is_dropped_first() {
        let mut history = MessageHistory::default();
        history.record(Some(&message(MessageSeverity::Hint, "hint")));
        assert_eq!(history.len(), 0);
        for number in 0..MAX_ENTRIES + 5 {
            history.record(Some(&message(
                MessageSeverity::Information,
                &number.to_string(),
            )));
        }
        assert_eq!(history.len(), MAX_ENTRIES);
        let oldest = history.entries.back().map(|entry| entry.message.clone());
        assert_eq!(oldest, Some(message(MessageSeverity::Information, "5")));
    }
}
