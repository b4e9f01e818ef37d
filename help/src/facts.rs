//! Reads what the control's tables contain about a subject.

use gsk_core::memory::{self, EffectiveTime, ElectronicDisk, ParameterRow};
use gsk_core::{alarm, alarm::AlarmRow};
use gsk_messages::{Language, say};
use gsk_panel::face::find_page;
use gsk_panel::keys::{Bit, Key, KeyRole, KeyRow, STRIP, StripLamp};
use gsk_panel::signals::{self, Signal};

use crate::subject::Subject;

/// Returns the name of a subject from its table; empty for codes, fields, diagnosis numbers
/// and notions.
pub fn subject_name(subject: Subject<'_>, language: Language) -> String {
    let text = |zh: &str, en: &str| by_language(language, zh, en).to_owned();
    match subject {
        Subject::Alarm(number) => alarm::row(number).map(|row| text(row.text_zh, row.meaning_en)),
        Subject::Parameter(number) => {
            parameter(number, None).map(|row| text(row.meaning_zh, row.meaning_en))
        }
        Subject::Bit(number, bit) => {
            parameter(number, Some(bit)).map(|row| text(row.meaning_zh, row.meaning_en))
        }
        Subject::Key(id) => key(id).map(|row| text(row.name_zh, row.name_en)),
        Subject::Lamp(id) => lamp(id).map(|row| text(row.name_zh, row.name_en)),
        Subject::Page(id) => find_page(id).map(|row| row.page.title().text(language)),
        Subject::Signal(address) => {
            signals::find(address).map(|row| text(row.text_zh, row.text_en))
        }
        Subject::Code(_) | Subject::Field(..) | Subject::Diagnosis(_) | Subject::Notion(_) => None,
    }
    .unwrap_or_default()
}

/// Returns what the control's tables contain about a subject besides its name, one sentence an
/// entry.
pub fn facts(subject: Subject<'_>, language: Language) -> Vec<String> {
    match subject {
        Subject::Alarm(number) => alarm::row(number).map(|row| alarm_facts(row, language)),
        Subject::Parameter(number) => {
            parameter(number, None).map(|row| parameter_facts(row, language))
        }
        Subject::Bit(number, bit) => {
            parameter(number, Some(bit)).map(|row| parameter_facts(row, language))
        }
        Subject::Key(id) => key(id).map(|row| key_facts(row, language)),
        Subject::Lamp(id) => lamp(id).map(|row| vec![lamp_signal(row.lamp, language)]),
        Subject::Signal(address) => signals::find(address).map(|row| signal_facts(row, language)),
        _ => None,
    }
    .unwrap_or_default()
}

fn by_language<'a>(language: Language, zh: &'a str, en: &'a str) -> &'a str {
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}

fn parameter(number: u16, bit: Option<u8>) -> Option<&'static ParameterRow> {
    memory::parameter_rows()
        .iter()
        .find(|row| row.number == number && row.bit == bit)
}

fn key(id: &str) -> Option<&'static KeyRow> {
    Key::from_id(id).map(Key::row)
}

fn lamp(id: &str) -> Option<&'static StripLamp> {
    STRIP.iter().find(|row| row.id == id)
}

fn alarm_facts(row: &AlarmRow, language: Language) -> Vec<String> {
    let advice = row.advice.as_ref();
    let messages = match language {
        Language::Zh => [
            advice.map(|it| say::window_alarm_cause(it.cause_zh)),
            advice.map(|it| say::window_alarm_way_out(it.remedy_zh)),
            None,
        ],
        Language::En => [
            Some(say::window_alarm_cause(row.cause_en)),
            advice.map(|it| say::window_alarm_way_out(it.remedy_en)),
            Some(say::window_alarm_cleared_by(row.cleared_by_en)),
        ],
    };
    messages
        .into_iter()
        .flatten()
        .map(|it| it.text(language))
        .collect()
}

fn parameter_facts(row: &ParameterRow, language: Language) -> Vec<String> {
    let mut facts = Vec::new();
    if !row.symbol.is_empty() {
        facts.push(say::help_on_the_screen(row.symbol).text(language));
    }
    if row.state {
        let bits = format!("{:08b}", row.factory_value(ElectronicDisk::N0));
        facts.push(say::help_as_delivered(bits).text(language));
        return facts;
    }
    let unit = match row.unit {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    facts.push(say::help_range(format!("{}{unit}", row.range)).text(language));
    facts.push(
        say::help_as_delivered(format!("{}{unit}", row.factory_value(ElectronicDisk::N0)))
            .text(language),
    );
    if let EffectiveTime::AtPowerOn { alarm } = row.effective {
        let message = match alarm {
            true => say::help_at_power_on_alarm(),
            false => say::help_at_power_on(),
        };
        facts.push(message.text(language));
    }
    facts
}

fn key_facts(row: &KeyRow, language: Language) -> Vec<String> {
    let mut facts = vec![say::help_printed_on_it(row.legend.join(" ")).text(language)];
    if let KeyRole::Machine(contact) = row.role {
        facts.push(say::help_contact(address('X', contact)).text(language));
    }
    facts.extend(row.lamp.map(|lamp| lamp_signal(lamp, language)));
    facts
}

fn signal_facts(row: &Signal, language: Language) -> Vec<String> {
    let mut facts = Vec::new();
    if !row.symbol.is_empty() {
        facts.push(say::help_symbol(row.symbol).text(language));
    }
    facts.push(say::help_direction(signal_direction(row, language)).text(language));
    facts
}

/// Returns the sender and the receiver of a PLC signal, joined with an arrow: `CNC → PLC`.
pub fn signal_direction(row: &Signal, language: Language) -> String {
    let ends = row
        .direction
        .split('>')
        .map(|end| endpoint_name(end, language));
    ends.collect::<Vec<_>>().join(" → ")
}

/// Returns the name of a sender or receiver in a language, from its word in the signal table.
fn endpoint_name(end: &str, language: Language) -> String {
    let message = match end {
        "machine" => say::help_end_machine(),
        "panel" => say::help_end_panel(),
        "display" => say::help_end_display(),
        "CNC parameter" => say::help_end_parameter(),
        "PLC internal" => say::help_end_internal(),
        "PLC retained" => say::help_end_retained(),
        end => return end.to_owned(),
    };
    message.text(language)
}

fn lamp_signal(lamp: Bit, language: Language) -> String {
    say::help_lit_by(address('Y', lamp)).text(language)
}

fn address(area: char, bit: Bit) -> String {
    format!("{area}{}.{}", bit.byte, bit.bit)
}
