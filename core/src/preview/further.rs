//! Behind the alarm that the control would stop with: what else is wrong.
//!
//! ```text
//!   refused block       counts as not there; what its words say is in doubt
//!   compensation 05x    the contour goes on without compensation
//!   spindle, PLC        the move counts as made
//!   calls, jumps, M30, macros, profiles of G70 to G73: the look ends
//! ```
//!
//! What is in doubt ([`Facts`]) is settled by the block that says it anew. An alarm
//! that rests on a fact in doubt is passed over in silence.

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

/// Alarms that are listed behind the first one.
pub const MOST_FURTHER: usize = 20;

/// Blocks that are passed over: a loop may come upon the same one for ever.
const MOST_REFUSED: u32 = 1000;

/// What else is wrong with a program that ends with an alarm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Further {
    /// Alarms behind the first one, one a line and [`MOST_FURTHER`] at most.
    pub alarms: Vec<Alarm>,
    /// What comes behind this block was not looked at.
    pub ends_at: Option<Source>,
}

/// Bytes of a line that are looked through for words: a line may hold a whole program.
const LONGEST_LINE: usize = 4096;

/// Who raised an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Raised {
    /// The block was not read.
    Reading,
    /// Its command was not carried out.
    Making,
}

/// The look behind the first alarm.
#[derive(Debug, Default)]
pub(super) struct Behind {
    doubt: Facts,
    /// The first alarm and those listed.
    alarms: Vec<Alarm>,
    refused: u32,
}

impl Walk<'_> {
    /// Goes on behind the alarm that ended the program.
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
                // Whoever watches has given it up.
                ends_at = self.source;
            }
        }
        let behind = self.behind.take().unwrap_or_default();
        Further {
            alarms: behind.alarms.into_iter().skip(1).collect(),
            ends_at,
        }
    }

    /// Takes an alarm down; whether the program can be followed behind it.
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
            // Every block behind says so, too.
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

    /// A command that comes behind an alarm: what it settles is no longer in doubt.
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

    /// Whether facts are as the program says: always so before the first alarm.
    pub(super) fn is_sure_of(&self, facts: Facts) -> bool {
        let doubt = self.behind.as_ref().map(|behind| behind.doubt);
        !doubt.is_some_and(|doubt| doubt.meets(facts))
    }

    /// The text of a line, as far as words are looked for in it.
    pub(super) fn line_of(&self, source: Source) -> &str {
        let program = self.programs.get(source.program);
        let line = program.map_or("", |program| program.line(source.line));
        &line[..line.floor_char_boundary(LONGEST_LINE)]
    }
}

impl Behind {
    /// Whether an alarm says something new, and surely.
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

/// What is not known behind a refused block.
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

/// Whether a block that was refused leads elsewhere, so that nobody knows what comes
/// behind it.
fn steers(alarm: u16, by_itself: bool, words: &[Written], parameters: &Parameters) -> bool {
    let by_word = |letter, codes: fn(u32) -> bool| {
        numbers(words, letter).any(|number| number.is_none_or(codes))
    };
    let special = parameters.special_codes_call()
        && [b'M', b'S', b'T'].iter().any(|letter| has(words, *letter));
    special
        || by_word(b'M', |code| matches!(code, 30 | 98 | 99))
        || by_word(b'G', |code| matches!(code, 65))
        // The profile of a cycle with a foreign word runs as a contour.
        || !by_itself && by_word(b'G', |code| matches!(code, 70..=73))
        || groups::leads_elsewhere(alarm) && !has_no_profile(alarm, words)
}

/// Whether an alarm is one of the text of a block, which knows its column.
fn is_of_column(detail: &Message) -> bool {
    detail.id() == Id::AtColumn
}

/// The lines of the encoder: every thread says so, too.
const fn rests_on_parameters(alarm: u16) -> bool {
    alarm == number::ENCODER_LINES
}

/// 062 of G74 to G76, which have none.
fn has_no_profile(alarm: u16, words: &[Written]) -> bool {
    alarm == number::CYCLE_DATA && numbers(words, b'G').any(|code| matches!(code, Some(74..=76)))
}
