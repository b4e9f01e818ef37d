//! Texts of the compiler's messages and the control's refusals, in the language of the window.

use gsk_core::memory::WriteRefusal;
use gsk_core::plc::{CompileError, Rule};

use gsk_messages::{Language, Message, say};

/// Formats a compiler error or warning: its code and message, in Chinese with the rule that it
/// breaks.
pub fn finding_text(error: &CompileError, language: Language) -> String {
    let (code, message) = (error.code, error.message.text(language));
    match language {
        Language::Zh => format!("{code} {}: {message}", rule_message(code).text(language)),
        Language::En => format!("{code} {message}"),
    }
}

/// Formats the closing line of a compilation without errors. The Chinese text is that of the
/// manufacturer's tool.
pub fn compiled_text(warnings: usize, language: Language) -> String {
    gsk_core::plc::compile_summary(0, warnings).text(language)
}

fn rule_message(rule: Rule) -> Message {
    match rule {
        Rule::E00 => say::ladder_rule_not_an_instruction(),
        Rule::E01 => say::ladder_rule_end_marks(),
        Rule::E02 => say::ladder_rule_no_single_result(),
        Rule::E03 => say::ladder_rule_operand(),
        Rule::E04 => say::ladder_rule_repeated_or_missing(),
        Rule::E05 => say::ladder_rule_jump_leaves_part(),
        Rule::E06 => say::ladder_rule_operand_count(),
        Rule::E07 => say::ladder_rule_too_long(),
        Rule::W01 => say::ladder_rule_two_outputs(),
        Rule::W02 => say::ladder_rule_label_unused(),
        Rule::W03 => say::ladder_rule_no_effect(),
        Rule::W04 => say::ladder_rule_level_1_long(),
    }
}

/// Returns the message about the reason why the control refuses a ladder, and about the remedy.
pub fn refusal_message(refusal: WriteRefusal) -> Message {
    match refusal {
        WriteRefusal::Mode => say::ladder_save_wants_edit_mode(),
        WriteRefusal::Running => say::ladder_save_wants_standstill(),
        WriteRefusal::ParameterSwitch => say::ladder_save_wants_parameter_switch(),
        WriteRefusal::Level => say::ladder_save_wants_level(),
        WriteRefusal::Alarm | WriteRefusal::ProgramSwitch | WriteRefusal::Locked => {
            say::ladder_save_protected()
        }
    }
}
