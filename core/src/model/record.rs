//! Records of the control models, read from `assets/models/`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gsk_messages::Language;
use serde::Deserialize;

use super::conventions::Conventions;
use super::program_calls::CallRange;
use super::{GCode, MCode, ModelId};
use crate::units::Axis;

/// G codes have two digits.
const G_CODES: usize = 100;

/// The data of a control model.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelRecord {
    /// The model of this record.
    #[serde(skip)]
    id: ModelId,
    /// An example of a program name, such as `O0001`.
    #[serde(default = "four_digits")]
    pub program_name: String,
    /// The letter before the numbers of its alarms.
    #[serde(default)]
    pub alarm_letter: Option<char>,
    /// The lowest step of the rapid override, %; `None`: F0.
    #[serde(default)]
    pub(crate) least_rapid_override: Option<u8>,
    /// Number of digits of a T word; tool and offset have half of them each.
    #[serde(default = "four")]
    pub(crate) tool_digits: u8,
    /// A tool offset shifts the coordinates in every block; the slides do not move.
    #[serde(default)]
    pub(crate) offsets_by_shift: bool,
    /// An N word after a G code is a block, a subprogram or a count, not a sequence number.
    #[serde(default)]
    pub(crate) n_after_g: bool,
    /// Whether the model has its own variables #1 to #99, with formulas and assignments but
    /// no other statements.
    #[serde(default)]
    pub own_variables: bool,
    /// Number of the contact of input 0.
    #[serde(default)]
    pub(crate) first_input: u8,
    /// The effect of an input's rising edge in manual modes.
    #[serde(default)]
    pub(crate) edges: BTreeMap<u8, EdgeAction>,
    /// Inputs that are also contacts of the machine.
    #[serde(default)]
    pub(crate) wires: BTreeMap<u8, WiredContact>,
    /// Outputs of the ladder with M codes that act when the output changes, from any cause.
    #[serde(default)]
    pub(crate) followers: Vec<OutputFollower>,
    /// Number of the output of the spindle brake.
    #[serde(default)]
    pub(crate) brake_output: Option<u8>,
    /// Whether the operator teaches points on the graphic page.
    #[serde(default)]
    pub teaches: bool,
    /// The greatest sequence number of a block.
    #[serde(default = "last_of_four_digits")]
    pub(crate) last_sequence: u32,
    /// The greatest program number in the model's own words (`%P99`, G20, G22).
    #[serde(default = "last_of_four_digits_short")]
    pub(crate) last_program: u16,
    /// Least and greatest numbers of words whose range differs from the GSK980TD.
    #[serde(default)]
    pub(crate) word_limits: BTreeMap<char, (i64, i64)>,
    /// Least and greatest time of G04, ms.
    #[serde(default)]
    pub(crate) dwell_limits: Option<(i64, i64)>,
    /// Delivered values of control parameters where they differ from the GSK980TD.
    #[serde(default)]
    pub(crate) delivered: BTreeMap<u16, i32>,
    /// Ranges of control parameters where they differ from the GSK980TD.
    #[serde(default)]
    ranges: BTreeMap<u16, (i32, i32)>,
    /// The greatest coordinate, 0.001 mm.
    #[serde(default = "ten_metres")]
    pub(crate) greatest_coordinate: i64,
    /// Letters that are addresses in addition to those of the GSK980TD.
    #[serde(default)]
    addresses: String,
    /// Letters that only macro calls accept, as arguments.
    #[serde(default)]
    argument_addresses: String,
    /// The meaning of words and codes besides the effect of each code.
    pub conventions: Conventions,
    /// The meanings of its G codes, by number.
    pub g: BTreeMap<u8, GCode>,
    /// The G codes whose effect the manual of the model does not specify.
    #[serde(default)]
    pub g_decided: Vec<u8>,
    /// First and last M code of the range that is passed to the ladder where the model does
    /// not define a code.
    #[serde(default)]
    pub ladder_m: Option<(u8, u8)>,
    /// A range of M codes that calls subprograms according to parameters.
    #[serde(default)]
    pub(crate) m_calls: Option<CallRange>,
    /// First and last M code that calls the program with its own number as a macro.
    #[serde(default)]
    pub(crate) m_macros: Option<(i64, i64)>,
    /// The functions of its M codes, by number.
    pub m: BTreeMap<u8, MFunction>,
    /// The M codes whose effect the manual of the model does not specify.
    #[serde(default)]
    pub m_decided: Vec<u8>,
    /// Parameters that only this model has, by number.
    #[serde(default)]
    pub parameters: BTreeMap<u16, ModelParameter>,
    /// The G codes in an array, for fast access.
    #[serde(skip)]
    g_table: Vec<Option<GCode>>,
}

/// The effect of a rising edge of an input in a manual mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum EdgeAction {
    /// Executes one of two M codes in turn.
    Toggles(u8, u8),
    /// Executes an M code.
    Does(u8),
}

/// The contact of the machine that an input of a model is wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum WiredContact {
    /// An emergency stop button.
    EmergencyStop,
    /// A limit switch.
    Limit(Axis, AxisEnd),
    /// A deceleration switch.
    Deceleration(Axis),
}

/// An end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum AxisEnd {
    /// The positive one.
    Plus,
    /// The negative one.
    Minus,
}

/// An output of the ladder whose changes execute M codes of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) struct OutputFollower {
    /// The output of the ladder.
    pub(crate) output: LadderOutput,
    /// The M code that is executed when the output switches on.
    pub(crate) on: u8,
    /// The M code that is executed when the output switches off.
    pub(crate) off: u8,
}

/// An output of the standard ladder, by its function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum LadderOutput {
    /// Coolant, as after M08.
    Coolant,
    /// Spindle forward, as after M03.
    SpindleForward,
    /// Spindle reverse, as after M04.
    SpindleReverse,
}

/// The function of an M code.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct MFunction {
    /// The meaning of the code.
    #[serde(rename = "does")]
    pub meaning: MCode,
    /// Numbers of the outputs that the code switches on.
    #[serde(default)]
    pub on: Vec<u8>,
    /// Numbers of the outputs that the code switches off.
    #[serde(default)]
    pub off: Vec<u8>,
}

/// A parameter that only one model has.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelParameter {
    /// Name in both languages.
    name: BilingualName,
    /// Unit of the value.
    pub unit: String,
    /// Least and greatest value.
    pub range: (i32, i32),
    /// The value as delivered.
    pub delivered: i32,
}

#[derive(Clone, Debug, Deserialize)]
struct BilingualName {
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
    /// The name of the parameter in a language.
    pub fn name(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.name.zh,
            Language::En => &self.name.en,
        }
    }
}

impl ModelRecord {
    /// The record of a model.
    pub(super) fn for_model(id: ModelId) -> &'static Self {
        // Each record is read at its first use: a run normally has one model.
        static RECORDS: [LazyLock<ModelRecord>; 4] = [
            LazyLock::new(|| read_record(ModelId::Gsk980td)),
            LazyLock::new(|| read_record(ModelId::Gsk980mdi)),
            LazyLock::new(|| read_record(ModelId::Hx31)),
            LazyLock::new(|| read_record(ModelId::Ncb08)),
        ];
        &RECORDS[id as usize]
    }

    /// The name of the model.
    pub const fn name(&self) -> &'static str {
        self.id.name()
    }

    /// The meaning of a G code; `None` if the model does not have it.
    #[inline]
    pub fn g_code(&self, number: i64) -> Option<GCode> {
        let index = usize::try_from(number).ok()?;
        self.g_table.get(index).copied().flatten()
    }

    /// Least and greatest value of a control parameter; `None` if they are those of the
    /// GSK980TD.
    pub fn parameter_range(&self, number: u16) -> Option<(i32, i32)> {
        self.ranges.get(&number).copied()
    }

    /// The number of the G code with a meaning; `None` if the model has none.
    pub fn g_number(&self, meaning: GCode) -> Option<u8> {
        let mut codes = self.g.iter();
        codes.find_map(|(number, it)| (*it == meaning).then_some(*number))
    }

    /// The function of an M code; `None` if the model does not have it.
    pub fn m_function(&self, number: u8) -> Option<&MFunction> {
        self.m.get(&number)
    }

    /// Whether a letter is an address that the GSK980TD does not have.
    pub(crate) fn has_address(&self, letter: u8) -> bool {
        self.addresses.bytes().any(|it| it == letter)
    }

    /// Whether a letter is an address outside macro calls.
    pub fn is_address(&self, letter: u8) -> bool {
        let of_lathe = matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z');
        (of_lathe || self.has_address(letter)) && !self.is_argument_only(letter)
    }

    /// Whether a letter is accepted only as an argument of macros.
    pub fn is_argument_only(&self, letter: u8) -> bool {
        self.argument_addresses.bytes().any(|it| it == letter)
    }

    /// Least and greatest number of a word; `None` if they are those of the GSK980TD.
    pub fn word_limits(&self, letter: u8) -> Option<(i64, i64)> {
        self.word_limits.get(&char::from(letter)).copied()
    }

    /// The greatest coordinate, mm.
    pub fn greatest_coordinate_mm(&self) -> f64 {
        self.greatest_coordinate as f64 / 1000.0
    }

    /// Whether the model has a code that returns to the start position of the run.
    pub(crate) fn returns_to_start(&self) -> bool {
        matches!(
            self.g_code(76),
            Some(GCode::StartByMachine | GCode::StartByWork)
        )
    }

    /// Whether both axes arrive at the same time in G00.
    pub fn are_rapids_straight(&self) -> bool {
        self.g_code(0) == Some(GCode::StraightRapid)
    }
}

fn read_record(id: ModelId) -> ModelRecord {
    let text = match id {
        ModelId::Gsk980td => include_str!("../../../assets/models/gsk980td.ron"),
        ModelId::Gsk980mdi => include_str!("../../../assets/models/gsk980mdi.ron"),
        ModelId::Hx31 => include_str!("../../../assets/models/hx31.ron"),
        ModelId::Ncb08 => include_str!("../../../assets/models/ncb08.ron"),
    };
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let mut record: ModelRecord = match options.from_str(text) {
        Ok(record) => record,
        Err(error) => unreachable!("the record of {id:?} is part of the program: {error}"),
    };
    record.id = id;
    record.g_table = (0..G_CODES)
        .map(|code| record.g.get(&(code as u8)).copied())
        .collect();
    record
}
