//! Lists when and where an alarm was raised.

use egui::{RichText, Ui};
use gsk_core::command::ProgramId;
use gsk_messages::{Language, say};
use gsk_panel::alarm_log::AlarmRecord;

use super::HelpRequest;
use crate::widgets::alarm_text;

/// Maximum number of earlier occurrences of an alarm that are listed.
const MAX_LISTED: usize = 5;

/// Draws the last occurrences of an alarm, the newest first; nothing if there are none. `number` is
/// the first alarm number of its row in the alarm table. Returns the operator's request to show a
/// block; `None` without one.
pub fn show_occurrences(
    ui: &mut Ui,
    number: u16,
    history: &[AlarmRecord],
    language: Language,
) -> Option<HelpRequest> {
    let is_same_alarm = |it: &&AlarmRecord| it.alarm.row().map(|row| row.number) == Some(number);
    let mut occurrences = history
        .iter()
        .filter(is_same_alarm)
        .take(MAX_LISTED)
        .peekable();
    occurrences.peek()?;
    ui.add_space(4.0);
    ui.label(RichText::new(say::window_help_occurrences().text(language)).strong());
    let mut request = None;
    for occurrence in occurrences {
        ui.label(time_text(occurrence, language));
        ui.label(alarm_text::one_line(&occurrence.alarm, language));
        ui.horizontal_wrapped(|ui| {
            if !occurrence.block.is_empty() {
                ui.monospace(&occurrence.block);
            }
            let source = occurrence.alarm.source;
            let is_readable = source.is_some_and(|source| {
                matches!(source.program, ProgramId::Stored(_) | ProgramId::External)
            });
            let link_text = say::window_help_to_block().text(language);
            if is_readable && ui.link(link_text).clicked() {
                request = Some(HelpRequest::Block(Box::new(occurrence.clone())));
            }
        });
        ui.add_space(4.0);
    }
    request
}

/// Formats the time of an occurrence: `2024-02-29 23:59:58, 0:12:03 after power-on`.
fn time_text(occurrence: &AlarmRecord, language: Language) -> String {
    let AlarmRecord {
        date, time, at_ms, ..
    } = occurrence;
    let (date, time) = (
        format!(
            "{:04}-{:02}-{:02}",
            date / 10_000,
            date / 100 % 100,
            date % 100
        ),
        format!(
            "{:02}:{:02}:{:02}",
            time / 10_000,
            time / 100 % 100,
            time % 100
        ),
    );
    let seconds = at_ms / 1000;
    let since_power_on = format!(
        "{}:{:02}:{:02}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60
    );
    say::window_help_occurred(date, time, since_power_on).text(language)
}
