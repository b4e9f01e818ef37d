//! Formats the current alarm with more than its page on the control shows: block, reason and
//! remedy.

use gsk_core::alarm::Alarm;
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::model::ProgramNaming;
use gsk_host::kernel::monitor::MachineAlarms;

use gsk_messages::{Language, say};

/// Formats an alarm as one line: number, text, block, reason.
pub fn one_line(alarm: &Alarm, language: Language) -> String {
    let mut line = match language {
        Language::Zh => alarm.line_text(),
        Language::En => format!("{}: {}", alarm.number_text(), alarm.text(language)),
    };
    if let Some(block) = block_text(alarm, language) {
        line.push_str(&format!("  {block}"));
    }
    if let Some(detail) = alarm.further_detail() {
        line.push_str(&format!("  ({})", detail.text(language)));
    }
    line
}

/// Formats the active alarms and messages of the PLC in one row.
pub fn joined_row(active: &MachineAlarms, language: Language) -> String {
    let alarms = active.alarms.iter().map(|it| one_line(it, language));
    let messages = active.plc_messages.iter().cloned();
    alarms.chain(messages).collect::<Vec<_>>().join("   ")
}

/// Formats an alarm as one line, followed by lines with its cause and its remedy.
pub fn with_remedy(alarm: &Alarm, language: Language) -> String {
    let mut lines = vec![one_line(alarm, language)];
    let Some(row) = alarm.row() else {
        return lines.join("\n");
    };
    match (row.advice, language) {
        (Some(advice), Language::Zh) => {
            lines.push(say::window_alarm_cause(advice.cause_zh).text(language));
            lines.push(say::window_alarm_way_out(advice.remedy_zh).text(language));
        }
        (Some(advice), Language::En) => {
            lines.push(say::window_alarm_cause(row.cause_en).text(language));
            lines.push(say::window_alarm_way_out(advice.remedy_en).text(language));
        }
        (None, Language::En) => {
            lines.push(say::window_alarm_cause(row.cause_en).text(language));
            lines.push(say::window_alarm_cleared_by(row.cleared_by_en).text(language));
        }
        (None, Language::Zh) => {}
    }
    lines.join("\n")
}

fn block_text(alarm: &Alarm, language: Language) -> Option<String> {
    let source = alarm.source.as_ref();
    source.map(|it| source_text(it, alarm.naming, language))
}

/// Formats the position of a block: program, sequence number, line.
pub fn source_text(source: &SourcePosition, naming: ProgramNaming, language: Language) -> String {
    let program = match source.program {
        ProgramId::Stored(number) => naming.name(number) + " ",
        ProgramId::External => String::new(),
        ProgramId::Mdi => "MDI ".to_owned(),
        ProgramId::Dnc => "DNC ".to_owned(),
    };
    let sequence = source
        .sequence
        .map_or_else(String::new, |it| format!("N{:04} ", u32::from(it)));
    let line = say::window_at_line(source.line).text(language);
    format!("{program}{sequence}{line}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_have_the_name_of_the_model() {
        let source = SourcePosition {
            program: ProgramId::Stored(21),
            line: 3,
            sequence: None,
        };
        for (naming, name) in [
            (ProgramNaming::Percent, "%P21 "),
            (ProgramNaming::Letter, "O0021 "),
        ] {
            let text = source_text(&source, naming, Language::En);
            assert!(text.starts_with(name), "{text}");
        }
    }

    #[test]
    fn a_row_has_alarms_in_the_language_of_the_window_and_messages_as_written() {
        let active = MachineAlarms {
            alarms: vec![Alarm::new(207), Alarm::new(1000)],
            plc_messages: vec!["2000 润滑油位低".to_owned()],
        };
        assert_eq!(
            joined_row(&active, Language::Zh),
            "207: 超程或急停开关报警   1000: 换刀时间过长   2000 润滑油位低"
        );
        let en = joined_row(&active, Language::En);
        assert!(en.starts_with("207: Over"), "{en}");
        assert!(en.ends_with("   2000 润滑油位低"), "{en}");
        assert_eq!(en.matches(|it: char| !it.is_ascii()).count(), 5, "{en}");
    }

    #[test]
    fn block_reason_and_remedy_use_the_language_of_the_window() {
        let alarm = Alarm::new(13)
            .with_detail(say::arc_radius_or_center_missing())
            .with_source(SourcePosition {
                program: ProgramId::Stored(12),
                line: 7,
                sequence: Some(60.into()),
            });
        let zh = one_line(&alarm, Language::Zh);
        assert_eq!(
            zh,
            "P/S 013: 圆弧数据有错误!  O0012 N0060 第 7 行  (没有指定 R，也没有指定 I、K)"
        );
        let en = with_remedy(&alarm, Language::En);
        assert!(en.starts_with("013: "), "{en}");
        assert!(
            en.contains("O0012 N0060 line 7  (neither R nor I, K is given)"),
            "{en}"
        );
        assert!(en.contains("\nRemedy: "), "{en}");
        assert!(with_remedy(&alarm, Language::Zh).contains("\n处理："));
    }
}
