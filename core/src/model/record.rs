//! The records of the models, as `assets/models/` holds them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gsk_messages::Language;
use serde::Deserialize;

use super::calls::CallRange;
use super::conventions::Conventions;
use super::{GCode, MCode, ModelId};
use crate::units::Axis;

/// G codes have two digits.
const G_CODES: usize = 100;

/// What a model is.
#[derive(Clone, Debug, Deserialize)]
pub struct Record {
    /// Whose it is.
    #[serde(skip)]
    id: ModelId,
    /// How its programs are named.
    #[serde(default = "four_digits")]
    pub program_name: String,
    /// The letter in front of the numbers of its alarms.
    #[serde(default)]
    pub alarm_letter: Option<char>,
    /// The least step of the rapid override, %; without it F0.
    #[serde(default)]
    pub(crate) least_rapid_override: Option<u8>,
    /// Digits of a T word: tool and offset have half of them each.
    #[serde(default = "four")]
    pub(crate) tool_digits: u8,
    /// A tool's offset moves the coordinates, whatever the block is; the slides stay.
    #[serde(default)]
    pub(crate) offsets_by_shift: bool,
    /// N after a G code is a block, a subprogram or a count, no sequence number.
    #[serde(default)]
    pub(crate) n_after_g: bool,
    /// Whether it has variables of its own, #1 to #99, with formulas and no statement
    /// but their values.
    #[serde(default)]
    pub own_variables: bool,
    /// The contact of its input 0.
    #[serde(default)]
    pub(crate) first_input: u8,
    /// What the edge of an input does while the machine is moved by hand.
    #[serde(default)]
    pub(crate) edges: BTreeMap<u8, Edge>,
    /// Inputs that are contacts of the machine, too.
    #[serde(default)]
    pub(crate) wires: BTreeMap<u8, Wire>,
    /// Outputs of the ladder that M codes follow, whoever has switched them.
    #[serde(default)]
    pub(crate) followers: Vec<Follower>,
    /// The output that is the brake of the spindle.
    #[serde(default)]
    pub(crate) brake_output: Option<u8>,
    /// Whether points are taught by hand, on the graphic page.
    #[serde(default)]
    pub teaches: bool,
    /// The greatest number of a block.
    #[serde(default = "last_of_four_digits")]
    pub(crate) last_sequence: u32,
    /// The greatest number of a program that its own words name (`%P99`, G20, G22).
    #[serde(default = "last_of_four_digits_short")]
    pub(crate) last_program: u16,
    /// Least and greatest numbers of words whose range is not that of the GSK980TD.
    #[serde(default)]
    pub(crate) word_limits: BTreeMap<char, (i64, i64)>,
    /// Least and greatest time of G04, ms.
    #[serde(default)]
    pub(crate) dwell_limits: Option<(i64, i64)>,
    /// Parameters of the control that it is delivered with, where they are not those of the
    /// GSK980TD.
    #[serde(default)]
    pub(crate) delivered: BTreeMap<u16, i32>,
    /// Ranges of such parameters.
    #[serde(default)]
    ranges: BTreeMap<u16, (i32, i32)>,
    /// The greatest coordinate, 0.001 mm.
    #[serde(default = "ten_metres")]
    pub(crate) greatest_coordinate: i64,
    /// Letters that are addresses besides those of the GSK980TD.
    #[serde(default)]
    addresses: String,
    /// Letters that only calls of macros take, as arguments.
    #[serde(default)]
    argument_addresses: String,
    /// What it means by words and codes besides what each code does.
    pub conventions: Conventions,
    /// What its G codes mean.
    pub g: BTreeMap<u8, GCode>,
    /// Those of them whose action its manual does not give.
    #[serde(default)]
    pub g_decided: Vec<u8>,
    /// M codes that it leaves to the ladder where it does not know them itself.
    #[serde(default)]
    pub ladder_m: Option<(u8, u8)>,
    /// A range of M codes that calls subprograms, by its parameters.
    #[serde(default)]
    pub(crate) m_calls: Option<CallRange>,
    /// M codes that call the program of their number as a macro.
    #[serde(default)]
    pub(crate) m_macros: Option<(i64, i64)>,
    /// What its M codes mean.
    pub m: BTreeMap<u8, MFunction>,
    /// Those of them whose action its manual does not give.
    #[serde(default)]
    pub m_decided: Vec<u8>,
    /// Parameters that only it has.
    #[serde(default)]
    pub parameters: BTreeMap<u16, ModelParameter>,
    /// The G codes once more, to be found at once.
    #[serde(skip)]
    g_table: Vec<Option<GCode>>,
}

/// What a rising input does in a manual mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum Edge {
    /// One of two M codes, the other one next time.
    Toggles(u8, u8),
    /// An M code.
    Does(u8),
}

/// What an input of a model is at the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum Wire {
    /// An emergency stop button.
    EmergencyStop,
    /// A limit switch.
    Limit(Axis, Side),
    /// A deceleration switch.
    Deceleration(Axis),
}

/// An end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum Side {
    /// The positive one.
    Plus,
    /// The negative one.
    Minus,
}

/// An output of the ladder that switches outputs of a model as an M code does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) struct Follower {
    /// Of the ladder.
    pub(crate) output: LadderOutput,
    /// The M code that acts when it goes on.
    pub(crate) on: u8,
    /// The M code that acts when it goes off.
    pub(crate) off: u8,
}

/// An output of the standard ladder by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum LadderOutput {
    /// M08.
    Coolant,
    /// M03.
    SpindleForward,
    /// M04.
    SpindleReverse,
}

/// What an M code does.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct MFunction {
    /// Its meaning.
    pub does: MCode,
    /// Outputs that it switches on.
    #[serde(default)]
    pub on: Vec<u8>,
    /// Outputs that it switches off.
    #[serde(default)]
    pub off: Vec<u8>,
}

/// A parameter that only one model has.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelParameter {
    /// What it is.
    name: Name,
    /// Its unit.
    pub unit: String,
    /// Lowest and highest value.
    pub range: (i32, i32),
    /// Its value as delivered.
    pub delivered: i32,
}

#[derive(Clone, Debug, Deserialize)]
struct Name {
    en: String,
    zh: String,
}

const fn four() -> u8 {
    4
}

const fn last_of_four_digits() -> u32 {
    9999
}

const fn last_of_four_digits_short() -> u16 {
    9999
}

const fn ten_metres() -> i64 {
    9_999_999
}

fn four_digits() -> String {
    "O0001".to_owned()
}

impl ModelParameter {
    /// What it is, in words.
    pub fn name(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.name.zh,
            Language::En => &self.name.en,
        }
    }
}

impl Record {
    /// The record of a model.
    pub(super) fn of(id: ModelId) -> &'static Self {
        // Each when it is asked for: a run has one model, as a rule.
        static RECORDS: [LazyLock<Record>; 4] = [
            LazyLock::new(|| read(ModelId::Gsk980td)),
            LazyLock::new(|| read(ModelId::Gsk980mdi)),
            LazyLock::new(|| read(ModelId::Hx31)),
            LazyLock::new(|| read(ModelId::Ncb08)),
        ];
        &RECORDS[id as usize]
    }

    /// The name of its model.
    pub const fn name(&self) -> &'static str {
        self.id.name()
    }

    /// What a G code means.
    #[inline]
    pub fn g_code(&self, number: i64) -> Option<GCode> {
        let index = usize::try_from(number).ok()?;
        self.g_table.get(index).copied().flatten()
    }

    /// Least and greatest value of a parameter of the control, where they are not those of
    /// the GSK980TD.
    pub fn parameter_range(&self, number: u16) -> Option<(i32, i32)> {
        self.ranges.get(&number).copied()
    }

    /// The number of a G code.
    pub fn g_number(&self, meaning: GCode) -> Option<u8> {
        let mut codes = self.g.iter();
        codes.find_map(|(number, it)| (*it == meaning).then_some(*number))
    }

    /// What an M code does.
    pub fn m_function(&self, number: u8) -> Option<&MFunction> {
        self.m.get(&number)
    }

    /// Whether a letter is an address that the GSK980TD does not have.
    pub(crate) fn has_address(&self, letter: u8) -> bool {
        self.addresses.bytes().any(|it| it == letter)
    }

    /// Whether a letter is an address of it, other than in a call of a macro.
    pub fn takes_address(&self, letter: u8) -> bool {
        let of_lathe = matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z');
        (of_lathe || self.has_address(letter)) && !self.is_argument_only(letter)
    }

    /// Whether a letter is only an argument of macros.
    pub fn is_argument_only(&self, letter: u8) -> bool {
        self.argument_addresses.bytes().any(|it| it == letter)
    }

    /// Least and greatest number of a word where they are its own: a table of the model.
    pub fn word_limits(&self, letter: u8) -> Option<(i64, i64)> {
        self.word_limits.get(&char::from(letter)).copied()
    }

    /// The greatest coordinate, mm.
    pub fn greatest_coordinate_mm(&self) -> f64 {
        self.greatest_coordinate as f64 / 1000.0
    }

    /// Whether it has a code that leads back to where the run began.
    pub(crate) fn returns_to_start(&self) -> bool {
        matches!(
            self.g_code(76),
            Some(GCode::StartByMachine | GCode::StartByWork)
        )
    }

    /// Whether both axes arrive together in G00.
    pub fn rapids_are_straight(&self) -> bool {
        self.g_code(0) == Some(GCode::StraightRapid)
    }
}

fn read(id: ModelId) -> Record {
    let text = match id {
        ModelId::Gsk980td => include_str!("../../../assets/models/gsk980td.ron"),
        ModelId::Gsk980mdi => include_str!("../../../assets/models/gsk980mdi.ron"),
        ModelId::Hx31 => include_str!("../../../assets/models/hx31.ron"),
        ModelId::Ncb08 => include_str!("../../../assets/models/ncb08.ron"),
    };
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let mut record: Record = match options.from_str(text) {
        Ok(record) => record,
        Err(error) => unreachable!("the record of {id:?} is part of the program: {error}"),
    };
    record.id = id;
    record.g_table = (0..G_CODES)
        .map(|code| record.g.get(&(code as u8)).copied())
        .collect();
    record
}
