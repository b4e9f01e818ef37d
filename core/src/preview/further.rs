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
//! A block that defines an uncertain fact ([`Facts`]) again makes it certain. An alarm that
//! depends on an uncertain fact is not reported.

use gsk_messages::{Id, Message};

use super::facts::{Facts, is_thread};
use super::written::{self, Written, has, numbers};
use super::{Progress, Walk};
use crate::alarm::{Alarm, groups, number};
use crate::command::{Command, Source};
use crate::interpreter::Immediate;
use crate::interpreter::Interpreter;
use crate::interpreter::Modal;
use crate::interpreter::PassedOver;
use crate::memory::Parameters;
use crate::program::{Syntax, parse_block};

/// Greatest number of alarms that are listed after the first one.
pub const MOST_FURTHER: usize = 20;

/// Greatest number of refused blocks: a loop may reach the same one forever.
const MOST_REFUSED: u32 = 1000;

/// Further errors of a program that ends with an alarm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Further {
    /// Alarms after the first one: one per line and [`MOST_FURTHER`] at most.
    pub alarms: Vec<Alarm>,
    /// The block after which no further errors were searched; `None`: the program was
    /// searched to its end.
    pub ends_at: Option<Source>,
}

/// Bytes of a line that are searched for words: a line may contain a whole program.
const LONGEST_LINE: usize = 4096;

/// The stage at which an alarm was raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Raised {
    /// The block was refused while it was read.
    Reading,
    /// The command of the block was refused when it was executed.
    Making,
}

/// State of the search after the first alarm.
#[derive(Debug, Default)]
pub(super) struct Behind {
    doubt: Facts,
    /// The first alarm and the listed ones.
    alarms: Vec<Alarm>,
    refused: u32,
}

impl Walk<'_> {
    /// Continues after the alarm that ended the program.
    pub(super) fn look_on(
        &mut self,
        first: (Alarm, Raised),
        interpreter: &mut Interpreter,
        host: &mut Immediate<'_>,
        go_on: &mut dyn FnMut(&Progress) -> bool,
    ) -> Further {
        self.behind = Some(Behind::default());
        let mut met = Some(first);
        let mut ends_at = None;
        while let Some((alarm, raised)) = met {
            let Some(source) = alarm.source else { break };
            ends_at = Some(source);
            if !self.passes(alarm, raised, source, interpreter, &host.parameters) {
                break;
            }
            ends_at = None;
            met = self.run(interpreter, host, go_on);
            if met.is_none() && !self.ended {
                // The caller has cancelled.
                ends_at = self.source;
            }
        }
        let behind = self.behind.take().unwrap_or_default();
        Further {
            alarms: behind.alarms.into_iter().skip(1).collect(),
            ends_at,
        }
    }

    /// Lists an alarm if it is new. Returns whether the program can be followed after it.
    fn passes(
        &mut self,
        alarm: Alarm,
        raised: Raised,
        source: Source,
        interpreter: &mut Interpreter,
        parameters: &Parameters,
    ) -> bool {
        let line = self.line_of(source);
        let words = written::words(line);
        let syntax = self.programs.get(source.program).map_or_else(
            || Syntax::from(parameters),
            |program| interpreter.syntax(source.program, program, parameters),
        );
        let modal = *interpreter.modal();
        let by_itself = alarm.detail.as_ref().is_some_and(is_of_column)
            || written::is_one_block(line) && parse_block(line, syntax).is_err();
        let Some(behind) = &mut self.behind else {
            return false;
        };
        let number = alarm.number;
        let rests_on = if by_itself {
            Facts::NONE
        } else {
            Facts::behind(number, is_thread(&words, modal.motion))
                .without(Facts::given(&words, modal.motion))
        };
        if behind.is_news(&alarm, rests_on) {
            behind.alarms.push(alarm);
        }
        behind.refused += 1;
        if behind.alarms.len() > MOST_FURTHER || behind.refused > MOST_REFUSED {
            return false;
        }
        let lost = match raised {
            // Each later block would raise it too.
            Raised::Making if groups::is_of_spindle(number) => Facts::TURNING.and(Facts::SPEED),
            Raised::Making => Facts::NONE,
            Raised::Reading => match interpreter.pass_over() {
                PassedOver::Contour => Facts::NOSE,
                PassedOver::Block if !steers(number, by_itself, &words, parameters) => {
                    lost_with(number, &words, &modal)
                }
                PassedOver::Block | PassedOver::Nothing => return false,
            },
        };
        behind.doubt = behind.doubt.and(lost);
        true
    }

    /// Makes the facts certain that a command after an alarm defines.
    pub(super) fn settle_uncertainty(&mut self, command: &Command) {
        let nothing = |behind: &Behind| behind.doubt == Facts::NONE;
        if self.behind.as_ref().is_none_or(nothing) {
            return;
        }
        let line = self.line_of(command.source);
        if !written::is_one_block(line) {
            return;
        }
        let words = written::words(line);
        let Some(behind) = &mut self.behind else {
            return;
        };
        behind.doubt = behind
            .doubt
            .without(Facts::given(&words, command.modal.motion));
        if !behind.doubt.meets(Facts::MOTION) {
            let reached = Facts::reached(command, &words);
            behind.doubt = behind.doubt.without(reached);
        }
    }

    /// Whether facts are certain; before the first alarm they always are.
    pub(super) fn is_sure_of(&self, facts: Facts) -> bool {
        let doubt = self.behind.as_ref().map(|behind| behind.doubt);
        !doubt.is_some_and(|doubt| doubt.meets(facts))
    }

    /// The text of a line, as far as it is searched for words.
    pub(super) fn line_of(&self, source: Source) -> &str {
        let program = self.programs.get(source.program);
        let line = program.map_or("", |program| program.line(source.line));
        &line[..line.floor_char_boundary(LONGEST_LINE)]
    }
}

impl Behind {
    /// Whether an alarm is new and does not depend on uncertain facts.
    fn is_news(&self, alarm: &Alarm, rests_on: Facts) -> bool {
        let detail = alarm.detail.as_ref();
        let profile = detail.filter(|detail| detail.id() == Id::InProfile);
        let profile_line = profile.and_then(|detail| detail.plain_value("line")?.parse().ok());
        let told = |listed: &Alarm| {
            let (Some(one), Some(other)) = (listed.source, alarm.source) else {
                return false;
            };
            let same_block = (one.program, one.line) == (other.program, other.line);
            let same_words = (listed.number, &listed.detail) == (alarm.number, &alarm.detail);
            same_block
                || profile_line == Some(one.line)
                || (same_words && rests_on_parameters(alarm.number))
        };
        !self.doubt.meets(rests_on) && !self.alarms.iter().any(told)
    }
}

/// The facts that are unknown after a refused block.
fn lost_with(alarm: u16, words: &[Written], modal: &Modal) -> Facts {
    let missing = match alarm {
        11 if is_thread(words, modal.motion) => Facts::LEAD,
        11 => Facts::FEED,
        _ => Facts::NONE,
    };
    let contour = modal.nose_compensation != 40;
    let nose = if contour { Facts::NOSE } else { Facts::NONE };
    Facts::lost(words).and(missing).and(nose)
}

/// Whether a refused block branches, so that the next block is unknown.
fn steers(alarm: u16, by_itself: bool, words: &[Written], parameters: &Parameters) -> bool {
    let by_word = |letter, codes: fn(u32) -> bool| {
        numbers(words, letter).any(|number| number.is_none_or(codes))
    };
    let special = parameters.special_codes_call()
        && [b'M', b'S', b'T'].iter().any(|letter| has(words, *letter));
    special
        || by_word(b'M', |code| matches!(code, 30 | 98 | 99))
        || by_word(b'G', |code| matches!(code, 65))
        // A profile after a cycle with an invalid word runs as a contour.
        || !by_itself && by_word(b'G', |code| matches!(code, 70..=73))
        || groups::leads_elsewhere(alarm) && !has_no_profile(alarm, words)
}

/// Whether the alarm is about the text of a block and has a column.
fn is_of_column(detail: &Message) -> bool {
    detail.id() == Id::AtColumn
}

/// For the encoder lines each thread raises the same alarm.
const fn rests_on_parameters(alarm: u16) -> bool {
    alarm == number::ENCODER_LINES
}

/// 062 of G74 to G76, which have no profile.
fn has_no_profile(alarm: u16, words: &[Written]) -> bool {
    alarm == number::CYCLE_DATA && numbers(words, b'G').any(|code| matches!(code, Some(74..=76)))
}
