//! Parameters of macro B that make codes call a program (manual of macro B, 9).
//!
//! ```text
//!   220–229   a G code    O9010–O9019   with arguments, as G65
//!   230–239   an M code   O9020–O9029   with arguments, as G65
//!   240–242   an M code   O9001–O9003   as M98
//!   243       every T     O9000         as M98, T in #149 (of the mill 040.5)
//! ```
//!
//! These codes are ordinary ones in a program that a G code calls, and in one that an M or a T
//! calls as M98 does.

use serde::{Deserialize, Serialize};

use crate::interpreter::flow::program_position::ProgramCall;
use crate::interpreter::words::SortedWords;
use crate::model::code_calls::{
    FIRST_G_PROGRAM, FIRST_M_PROGRAM, FIRST_PLAIN_M_PROGRAM, T_PROGRAM,
};
use crate::model::{ControlModel, code_calls};

/// Macro variable that holds T when T calls a program.
pub const T_VARIABLE: u16 = 149;
/// G65 to G67: always codes of macro B, which no parameter can make call another program.
const MACRO_CALL_CODES: core::ops::RangeInclusive<u16> = 65..=67;

/// The G, M and T codes that call a program, as parameters of macro B set them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct CodeCalls {
    g: [u16; 10],
    m: [u16; 10],
    plain_m: [u16; 3],
    t: bool,
}

/// A subprogram call by an M or T word, as M98 does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainCall {
    /// Number of the program that is called.
    pub program: u16,
    /// The letter of the word that calls: M or T.
    pub address: char,
    /// The number in the word that calls, 6 for M06.
    pub code: i64,
}

impl CodeCalls {
    /// Reads the codes that call a program from the parameters of a model; `None` if no code
    /// calls.
    pub(crate) fn from_model(model: &ControlModel) -> Option<Box<Self>> {
        let read_codes = |first: u16, to: &mut [u16]| {
            for (number, code) in (first..).zip(to) {
                *code = u16::try_from(model.calling_code(number)).unwrap_or(0);
            }
        };
        let mut calls = Self::default();
        read_codes(code_calls::FIRST_G_PARAMETER, &mut calls.g);
        read_codes(code_calls::FIRST_M_PARAMETER, &mut calls.m);
        read_codes(code_calls::FIRST_PLAIN_M_PARAMETER, &mut calls.plain_m);
        calls.t = model.has_t_calls();
        (calls != Self::default()).then(|| Box::new(calls))
    }

    /// The number of the program that a G or M code calls with arguments, as G65 does; `None`
    /// if the code calls none.
    pub(crate) fn find_macro(&self, letter: char, code: u16) -> Option<u16> {
        let (codes, first) = match letter {
            'G' if MACRO_CALL_CODES.contains(&code) => return None,
            'G' => (&self.g, FIRST_G_PROGRAM),
            _ => (&self.m, FIRST_M_PROGRAM),
        };
        find_program(codes, code, first)
    }

    /// The subprogram that the M word of a block calls, or else its T word; `None` if neither
    /// calls.
    pub(crate) fn find_subprogram(&self, words: &SortedWords) -> Option<PlainCall> {
        self.find_subprogram_by_number(words.m.map(u16::from), words.t)
    }

    /// The subprogram that the M code `m` calls, or else the T code `t`; `None` if neither
    /// calls.
    pub(crate) fn find_subprogram_by_number(
        &self,
        m: Option<u16>,
        t: Option<i64>,
    ) -> Option<PlainCall> {
        let m = m.and_then(|code| {
            let program = find_program(&self.plain_m, code, FIRST_PLAIN_M_PROGRAM)?;
            let (address, code) = ('M', code.into());
            Some(PlainCall {
                program,
                address,
                code,
            })
        });
        let t = t.filter(|_| self.t).map(|code| PlainCall {
            program: T_PROGRAM,
            address: 'T',
            code,
        });
        m.or(t)
    }
}

fn find_program(codes: &[u16], code: u16, first: u16) -> Option<u16> {
    // A parameter of 0 sets no call.
    let entry = (first..).zip(codes).find(|(_, it)| **it == code)?;
    (code != 0).then_some(entry.0)
}

/// Whether one of the running calls makes the codes of [`CodeCalls`] ordinary ones, which call
/// no program.
pub(crate) fn are_ordinary(calls: &[ProgramCall]) -> bool {
    calls.iter().any(|call| call.codes_ordinary)
}
