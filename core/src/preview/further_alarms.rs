//! Continues a preview after the alarm at which the control would stop, to find further
//! errors.
//!
//! ```text
//!   refused block       is skipped; the facts that its words define are uncertain
//!   compensation 05x    the contour continues without compensation
//!   spindle, PLC        the move counts as executed
//!   calls, jumps, M30, macros, profiles of G70 to G73: the search ends
//! ```
//!
//! A block that defines an uncertain fact ([`ProgramFacts`]) again makes it certain. An alarm that
//! depends on an uncertain fact is not reported.

use gsk_messages::{Id, Message};

use super::certainty::{ProgramFacts, is_thread};
use super::line_words::{self, WrittenWord, has_letter, numbers_of};
use super::{PreviewProgress, PreviewRun};
use crate::alarm::{Alarm, groups, number};
use crate::command::{ControlCommand, SourcePosition};
use crate::interpreter::ImmediateHost;
use crate::interpreter::Interpreter;
use crate::interpreter::ModalState;
use crate::interpreter::PassedOver;
use crate::memory::ControlParameters;
use crate::program::{Syntax, parse_block};

/// Greatest number of alarms that are listed after the first one.
pub const MAX_FURTHER_ALARMS: usize = 20;

/// Greatest number of refused blocks in a search: a loop may reach the same block forever.
const MAX_REFUSED_BLOCKS: u32 = 1000;

/// Further alarms of a program that ends with an alarm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FurtherAlarms {
    /// Alarms after the first one: one per line, and at most [`MAX_FURTHER_ALARMS`].
    pub alarms: Vec<Alarm>,
    /// Position of the block at which the search ended early; `None` if it reached the end of
    /// the program.
    pub ends_at: Option<SourcePosition>,
}

/// Number of bytes of a line that are searched for words: a line may contain a whole program.
const MAX_LINE_BYTES: usize = 4096;

/// The stage at which an alarm was raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AlarmStage {
    /// The block was refused while it was read.
    Reading,
    /// The command of the block was refused when it was executed.
    Executing,
}

/// State of the search for alarms after the first one.
#[derive(Debug, Default)]
pub(super) struct AlarmSearch {
    uncertain_facts: ProgramFacts,
    /// The first alarm, followed by the further ones.
    alarms: Vec<Alarm>,
    refused_blocks: u32,
}

impl PreviewRun<'_> {
    /// Continues the preview after the alarm `first` and collects further alarms until the
    /// program ends, cannot be followed, or `should_continue` returns `false`.
    pub(super) fn search_further_alarms(
        &mut self,
        first: (Alarm, AlarmStage),
        interpreter: &mut Interpreter,
        host: &mut ImmediateHost<'_>,
        should_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
    ) -> FurtherAlarms {
        self.alarm_search = Some(AlarmSearch::default());
        let mut next_alarm = Some(first);
        let mut ends_at = None;
        while let Some((alarm, raised)) = next_alarm {
            let Some(source) = alarm.source else { break };
            ends_at = Some(source);
            if !self.record_alarm(alarm, raised, source, interpreter, &host.parameters) {
                break;
            }
            ends_at = None;
            next_alarm = self.run(interpreter, host, should_continue);
            if next_alarm.is_none() && !self.ended {
                // The caller has cancelled.
                ends_at = self.source;
            }
        }
        let search = self.alarm_search.take().unwrap_or_default();
        FurtherAlarms {
            alarms: search.alarms.into_iter().skip(1).collect(),
            ends_at,
        }
    }

    /// Adds an alarm to the list if it is new. Returns whether the blocks after it can still
    /// be followed.
    fn record_alarm(
        &mut self,
        alarm: Alarm,
        raised: AlarmStage,
        source: SourcePosition,
        interpreter: &mut Interpreter,
        parameters: &ControlParameters,
    ) -> bool {
        let line = self.line_text(source);
        let words = line_words::split_line(line);
        let syntax = self.programs.get(source.program).map_or_else(
            || Syntax::from(parameters),
            |program| interpreter.syntax(source.program, program, parameters),
        );
        let modal = *interpreter.modal();
        let is_block_invalid = alarm.detail.as_ref().is_some_and(has_column)
            || line_words::is_one_block(line) && parse_block(line, syntax).is_err();
        let Some(search) = &mut self.alarm_search else {
            return false;
        };
        let number = alarm.number;
        let required_facts = if is_block_invalid {
            ProgramFacts::NONE
        } else {
            ProgramFacts::required_by(number, is_thread(&words, modal.motion))
                .minus(ProgramFacts::defined_by(&words, modal.motion))
        };
        if search.is_new_alarm(&alarm, required_facts) {
            search.alarms.push(alarm);
        }
        search.refused_blocks += 1;
        if search.alarms.len() > MAX_FURTHER_ALARMS || search.refused_blocks > MAX_REFUSED_BLOCKS {
            return false;
        }
        let uncertain = match raised {
            // Each later block would raise it too.
            AlarmStage::Executing if groups::is_spindle_alarm(number) => {
                ProgramFacts::SPINDLE_DIRECTION.union(ProgramFacts::SPINDLE_SPEED)
            }
            AlarmStage::Executing => ProgramFacts::NONE,
            AlarmStage::Reading => match interpreter.pass_over_refused() {
                PassedOver::Contour => ProgramFacts::COMPENSATION,
                PassedOver::Block if !is_branch(number, is_block_invalid, &words, parameters) => {
                    facts_lost_with_block(number, &words, &modal)
                }
                PassedOver::Block | PassedOver::Nothing => return false,
            },
        };
        search.uncertain_facts = search.uncertain_facts.union(uncertain);
        true
    }

    /// Makes the facts certain that a command after an alarm defines again.
    pub(super) fn settle_uncertainty(&mut self, command: &ControlCommand) {
        let is_certain = |search: &AlarmSearch| search.uncertain_facts == ProgramFacts::NONE;
        if self.alarm_search.as_ref().is_none_or(is_certain) {
            return;
        }
        let line = self.line_text(command.source);
        if !line_words::is_one_block(line) {
            return;
        }
        let words = line_words::split_line(line);
        let Some(search) = &mut self.alarm_search else {
            return;
        };
        search.uncertain_facts = search
            .uncertain_facts
            .minus(ProgramFacts::defined_by(&words, command.modal.motion));
        if !search.uncertain_facts.intersects(ProgramFacts::MOTION) {
            let confirmed = ProgramFacts::confirmed_by(command, &words);
            search.uncertain_facts = search.uncertain_facts.minus(confirmed);
        }
    }

    /// Whether none of `facts` is uncertain; always `true` before the first alarm.
    pub(super) fn is_certain(&self, facts: ProgramFacts) -> bool {
        let doubt = self
            .alarm_search
            .as_ref()
            .map(|search| search.uncertain_facts);
        !doubt.is_some_and(|doubt| doubt.intersects(facts))
    }

    /// The first [`MAX_LINE_BYTES`] bytes of the line of a block.
    pub(super) fn line_text(&self, source: SourcePosition) -> &str {
        let program = self.programs.get(source.program);
        let line = program.map_or("", |program| program.line(source.line));
        &line[..line.floor_char_boundary(MAX_LINE_BYTES)]
    }
}

impl AlarmSearch {
    /// Whether an alarm is not listed yet and depends on no uncertain fact.
    fn is_new_alarm(&self, alarm: &Alarm, required_facts: ProgramFacts) -> bool {
        let detail = alarm.detail.as_ref();
        let profile = detail.filter(|detail| detail.id() == Id::InProfile);
        let profile_line = profile.and_then(|detail| detail.plain_value("line")?.parse().ok());
        let is_listed = |listed: &Alarm| {
            let (Some(one), Some(other)) = (listed.source, alarm.source) else {
                return false;
            };
            let same_block = (one.program, one.line) == (other.program, other.line);
            let same_words = (listed.number, &listed.detail) == (alarm.number, &alarm.detail);
            same_block
                || profile_line == Some(one.line)
                || (same_words && is_parameter_alarm(alarm.number))
        };
        !self.uncertain_facts.intersects(required_facts) && !self.alarms.iter().any(is_listed)
    }
}

/// The facts that are uncertain after a block was refused with the alarm `alarm`.
fn facts_lost_with_block(alarm: u16, words: &[WrittenWord], modal: &ModalState) -> ProgramFacts {
    let missing = match alarm {
        11 if is_thread(words, modal.motion) => ProgramFacts::LEAD,
        11 => ProgramFacts::FEED,
        _ => ProgramFacts::NONE,
    };
    let contour = modal.nose_compensation != 40;
    let nose = if contour {
        ProgramFacts::COMPENSATION
    } else {
        ProgramFacts::NONE
    };
    ProgramFacts::uncertain_after(words)
        .union(missing)
        .union(nose)
}

/// Whether a refused block branches, so that the next block is unknown.
fn is_branch(
    alarm: u16,
    is_block_invalid: bool,
    words: &[WrittenWord],
    parameters: &ControlParameters,
) -> bool {
    let by_word = |letter, codes: fn(u32) -> bool| {
        numbers_of(words, letter).any(|number| number.is_none_or(codes))
    };
    let special = parameters.special_codes_call()
        && [b'M', b'S', b'T']
            .iter()
            .any(|letter| has_letter(words, *letter));
    special
        || by_word(b'M', |code| matches!(code, 30 | 98 | 99))
        || by_word(b'G', |code| matches!(code, 65))
        // A profile after a cycle with an invalid word runs as a contour.
        || !is_block_invalid && by_word(b'G', |code| matches!(code, 70..=73))
        || groups::is_control_flow_alarm(alarm) && !has_no_profile(alarm, words)
}

/// Whether the detail of an alarm gives a column, so that the text of the block is wrong.
fn has_column(detail: &Message) -> bool {
    detail.id() == Id::AtColumn
}

/// Whether the alarm is about a parameter (encoder lines), so that each thread raises it
/// again.
const fn is_parameter_alarm(alarm: u16) -> bool {
    alarm == number::ENCODER_LINES
}

/// Whether the alarm is 062 of a G74, G75 or G76, cycles that have no profile.
fn has_no_profile(alarm: u16, words: &[WrittenWord]) -> bool {
    alarm == number::CYCLE_DATA && numbers_of(words, b'G').any(|code| matches!(code, Some(74..=76)))
}
