//! The X-ray of a cycle: why the selected pass is where it is, and the words of the cycle as
//! fields. A changed word moves the passes in the picture.
//!
//! A change is only tried out: the control keeps its program until the text is taken over in
//! the program view.

use std::ops::Range;

use egui::{DragValue, RichText, Ui};
use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_core::units::parse_finite;
use gsk_messages::{Language, say};

use super::path::{BlockRef, DrawnPath};
use crate::theme;
use gsk_language::words::{spans, word_of};

/// A changed text of a program that is executed instead of the control's.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The program in which one block is changed on trial.
    pub program_id: ProgramId,
    /// The text that the program has in the control.
    pub control_text: Program,
    /// The changed text that is executed on trial.
    pub trial_text: Program,
}

impl Trial {
    /// Converts the trial to the id of the program and the text to execute.
    pub fn to_program(&self) -> (ProgramId, Program) {
        (self.program_id, self.trial_text.clone())
    }
}

/// The action of the user on the words of a cycle.
pub enum TrialAction {
    /// Execute this changed text on trial.
    Try(Trial),
    /// End the trial and return to the text of the control.
    Discard,
    /// Copy the text of the trial into the program view.
    TakeOver(Trial),
}

/// Draws the words of the cycle in a block, and the buttons that take over or discard a trial.
/// Returns the action of the user; `None` without one.
pub fn show(
    ui: &mut Ui,
    path: &DrawnPath,
    block: Option<BlockRef>,
    trial: Option<&Trial>,
    language: Language,
) -> Option<TrialAction> {
    let mut action = None;
    if let Some(block) = block {
        let current_trial = trial.filter(|trial| trial.program_id == block.program);
        let own = path.programs.get(block.program);
        let program = current_trial.map(|trial| &trial.trial_text).or(own)?;
        for line in cycle_lines(program, block.line) {
            if let Some(changed) = show_words(ui, program, line, language) {
                action = Some(TrialAction::Try(Trial {
                    program_id: block.program,
                    control_text: current_trial
                        .map_or(program, |trial| &trial.control_text)
                        .clone(),
                    trial_text: Program::new(changed),
                }));
            }
        }
    }
    if let Some(trial) = trial {
        ui.horizontal_wrapped(|ui| {
            let words = say::xray_tried().text(language);
            ui.label(RichText::new(words).color(theme::WARNING));
            if ui.button(say::xray_take().text(language)).clicked() {
                action = Some(TrialAction::TakeOver(trial.clone()));
            }
            if ui.button(say::xray_discard().text(language)).clicked() {
                action = Some(TrialAction::Discard);
            }
        });
    }
    action
}

/// Draws a field for each measure in line `number` of the program. Returns the program's text
/// after a change; `None` without one.
fn show_words(ui: &mut Ui, program: &Program, number: u32, language: Language) -> Option<String> {
    let (text, line) = (program.text(), program.line(number));
    let start = line_start(text, line)?;
    let code = find_cycle_code(line)?;
    let mut changed = None;
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(format!("{number}:")).monospace());
        for span in spans(line) {
            let Some(word) = word_of(line, &span) else {
                continue;
            };
            let value = parse_finite(&word.value);
            let value = value.filter(|_| is_measure(code, word.address));
            let Some(mut value) = value else {
                ui.label(RichText::new(&line[span.range]).monospace());
                continue;
            };
            let is_integer = matches!(word.address, 'P' | 'Q');
            let address = ui.label(RichText::new(word.address).monospace());
            let drag = DragValue::new(&mut value)
                .speed(if is_integer { 50.0 } else { 0.05 })
                .max_decimals(if is_integer { 0 } else { 3 })
                .range(-9999.999..=9_999_999.0);
            let hint = say::xray_hint().text(language);
            let drag = ui.add(drag).labelled_by(address.id);
            if drag.on_hover_text(hint).changed() {
                let range = start + span.range.start..start + span.range.end;
                changed = Some(replace_value(text, range, word.address, value));
            }
        }
    });
    changed
}

/// Whether the word `address` of a cycle is a measure that can be changed; `code` is the G
/// code. P and Q of G70 to G73 are sequence numbers and cannot.
const fn is_measure(code: u32, address: char) -> bool {
    match address {
        'P' | 'Q' => !matches!(code, 70..=73),
        'X' | 'Z' | 'U' | 'W' | 'R' | 'I' | 'K' | 'J' | 'F' => true,
        _ => false,
    }
}

/// Returns the text with the number `value` in the word at the byte range `range`.
fn replace_value(text: &str, range: Range<usize>, address: char, value: f64) -> String {
    // A word has three decimals.
    let value = (value * 1000.0).round() / 1000.0;
    let mut changed = text.to_owned();
    changed.replace_range(range, &format!("{address}{value}"));
    changed
}

/// The lines, from 1, of the cycle with a block in `line`; a compound cycle may have two
/// blocks. Empty if the line has no cycle.
fn cycle_lines(program: &Program, line: u32) -> Vec<u32> {
    let code = |number: u32| find_cycle_code(program.line(number));
    // Line numbers of a program cut out of a larger file are those of the file.
    let is_whole_file = line_start(program.text(), program.line(1)) == Some(0);
    let Some(own) = code(line).filter(|_| is_whole_file) else {
        return Vec::new();
    };
    let is_compound = matches!(own, 71..=76);
    let before = line.checked_sub(1).filter(|before| *before > 0);
    let before = before.filter(|before| is_compound && code(*before) == Some(own));
    before.into_iter().chain([line]).collect()
}

/// Returns the program without the cycles G70 to G73, so that the rest draws their profile.
/// Lines keep their numbers, and the cycles' feed words stay.
pub fn remove_profile_cycles(program: &Program) -> Program {
    let lines = program.text().split_inclusive(['\n', '\r']);
    let left = lines.map(|line| match find_cycle_code(line) {
        Some(70..=73) => {
            let end = line.trim_end_matches(['\n', '\r']).len();
            let spans = spans(line);
            let mut words = spans.iter().map(|span| &line[span.range.clone()]);
            let feed = words.find(|word| word.starts_with(['F', 'f']));
            format!("{}{}", feed.unwrap_or_default(), &line[end..])
        }
        _ => line.to_owned(),
    });
    Program::new(left.collect::<String>())
}

/// The line of the profile, from 1, that breaks a rule, read from the alarm of a cycle G70 to
/// G73; `None` for other alarms.
pub fn profile_line(alarm: &Alarm, program: &Program) -> Option<u32> {
    let cycle = find_cycle_code(program.line(alarm.source?.line))?;
    let line = alarm.detail.as_ref()?.plain_value("line")?.parse().ok()?;
    matches!(cycle, 70..=73).then_some(line)
}

/// The G code of the cycle in a line; `None` if the line has no cycle.
fn find_cycle_code(line: &str) -> Option<u32> {
    let spans = spans(line);
    let mut words = spans.iter().filter_map(|span| word_of(line, span));
    words.find_map(|word| {
        let code = word.value.parse().ok().filter(|_| word.address == 'G')?;
        matches!(code, 70..=76 | 90 | 92 | 94).then_some(code)
    })
}

/// Byte offset of a line in its text; `None` if the line is not a slice of the text.
fn line_start(text: &str, line: &str) -> Option<usize> {
    let start = (line.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    (start + line.len() <= text.len()).then_some(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "O0001\r\nG00 X44 Z2\r\nG71 U3 R1\r\nG71 P1 Q2 U0.5(fine U9) F100\r\nN1 G00 X20\r\n";

    #[test]
    fn a_cycle_in_two_blocks_is_changed_in_either() {
        let program = Program::new(TEXT);
        assert_eq!(cycle_lines(&program, 4), [3, 4]);
        assert_eq!(cycle_lines(&program, 2), [0; 0]);
        let line = program.line(3);
        assert_eq!(line, "G71 U3 R1");
        let start = line_start(program.text(), line).unwrap();
        let changed = replace_value(TEXT, start + 4..start + 6, 'U', 2.499_96);
        assert_eq!(changed, TEXT.replace("G71 U3 R1", "G71 U2.5 R1"));
    }

    #[test]
    fn a_profile_is_drawn_without_the_cycles_over_it() {
        let program = remove_profile_cycles(&Program::new(TEXT));
        assert_eq!(
            program.text(),
            "O0001\r\nG00 X44 Z2\r\n\r\nF100\r\nN1 G00 X20\r\n"
        );
    }

    #[test]
    fn sequence_numbers_are_no_measures_and_depths_of_threads_are() {
        assert!(!is_measure(71, 'P') && is_measure(76, 'P') && is_measure(71, 'U'));
        assert!(!is_measure(92, 'G') && !is_measure(71, 'N') && is_measure(92, 'J'));
        assert_eq!(find_cycle_code("N5 g76 P010060"), Some(76));
        assert_eq!(find_cycle_code("(G71) G01 X5"), None);
    }
}
