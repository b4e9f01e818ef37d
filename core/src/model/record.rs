//! Records of the control models: that of the GSK980TD, the others from `assets/models/`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gsk_messages::Message;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::contacts::{ContactAssignment, EdgeAction};
use super::conventions::Conventions;
use super::program_calls::CallRange;
use super::program_capacity::ProgramCapacity;
use super::program_naming::ProgramNaming;
use super::{GCode, MCode, ModelId};

/// Number of possible G codes: they have two digits.
const G_CODES: usize = 100;

/// The record of a control model: its codes, conventions, ranges and parameters. A field that a
/// file omits has the value of the GSK980TD.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct ModelRecord {
    /// The id of the model that the record describes.
    #[serde(skip)]
    pub(super) id: ModelId,
    /// An example of a program name, such as `O0001`.
    pub program_name: String,
    /// What the program memory of the model holds.
    pub(crate) capacity: ProgramCapacity,
    /// The letter before the numbers of the model's alarms; `None` without a letter.
    pub alarm_letter: Option<char>,
    /// The lowest step of the rapid override, %; `None` if it is F0.
    pub(crate) least_rapid_override: Option<u8>,
    /// Number of digits of a T word; tool and offset number have half of them each.
    pub(crate) tool_digits: u8,
    /// Whether a tool offset shifts the coordinates in every block, without moving the slides.
    pub(crate) offsets_by_shift: bool,
    /// Whether an N word after a G code is a block, a subprogram or a count instead of a
    /// sequence number.
    pub(crate) n_after_g: bool,
    /// Whether the model has separate variables #1 to #99, with formulas and assignments but
    /// no other statements.
    pub own_variables: bool,
    /// Contact of the model's input 0, counted in bits of the X area from X0.0 (16 is X2.0).
    pub(crate) first_input: u8,
    /// The assignment of signals to inputs and outputs; `None` if they cannot be assigned.
    pub(super) contacts: Option<ContactAssignment>,
    /// The action that a press of each model-specific key triggers in manual modes, by the bit of
    /// the key's contact in X27.
    pub(crate) key_edges: BTreeMap<u8, EdgeAction>,
    /// Outputs of the ladder whose changes, from any cause, switch outputs of the model as M
    /// codes do.
    pub(crate) followers: Vec<OutputFollower>,
    /// Outputs of the ladder that an output of the model follows, with the number of the latter.
    pub(crate) followed: Vec<(LadderOutput, u8)>,
    /// Whether the operator can teach points on the graphic page.
    pub teaches: bool,
    /// The greatest sequence number (N) of a block.
    pub(crate) last_sequence: u32,
    /// The greatest program number in `%P99`, G20 and G22 of the model.
    pub(crate) last_program: u16,
    /// Least and greatest number of words, by letter, whose range differs from the GSK980TD.
    pub(crate) word_limits: BTreeMap<char, (i64, i64)>,
    /// Least and greatest time of G04, ms; `None` if they are those of the GSK980TD.
    pub(crate) dwell_limits: Option<(i64, i64)>,
    /// Delivered values of control parameters, by number, that differ from the GSK980TD.
    pub(crate) delivered: BTreeMap<u16, i32>,
    /// Least and greatest values of control parameters, by number, that differ from the
    /// GSK980TD.
    pub(super) ranges: BTreeMap<u16, (i32, i32)>,
    /// The greatest absolute coordinate in a program, in 0.001 mm.
    pub(crate) greatest_coordinate: i64,
    /// Letters that are addresses of the model but not of the GSK980TD.
    pub(super) addresses: String,
    /// Letters that are accepted only as arguments of macro calls.
    pub(super) argument_addresses: String,
    /// The conventions by which the model reads words and codes, besides the effect of each code.
    pub conventions: Conventions,
    /// The meanings of the model's G codes, by number.
    pub g: BTreeMap<u8, GCode>,
    /// The G codes whose effect was decided for this program, because the manual of the model does
    /// not give it.
    pub g_decided: Vec<u8>,
    /// First and last M code of a range whose codes, if the model does not define them, are
    /// passed to the ladder; `None` without such a range.
    pub ladder_m: Option<(u8, u8)>,
    /// A range of M codes that call subprograms, set by parameters; `None` without one.
    pub(crate) m_calls: Option<CallRange>,
    /// First and last M code that calls the program with the same number as a macro; `None`
    /// without such codes.
    pub(crate) m_macros: Option<(i64, i64)>,
    /// The functions of the model's M codes, by number.
    pub m: BTreeMap<u8, MFunction>,
    /// The M codes whose effect was decided for this program, because the manual of the model does
    /// not give it.
    pub m_decided: Vec<u8>,
    /// The meanings of `g` in an array, for fast access by number.
    #[serde(skip)]
    pub(super) g_table: Vec<Option<GCode>>,
}

/// An output of the ladder whose changes switch outputs of the model as M codes do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) struct OutputFollower {
    /// The output of the ladder whose changes count.
    pub(crate) output: LadderOutput,
    /// The M code whose outputs are switched when `output` switches on.
    pub(crate) on: u8,
    /// The M code whose outputs are switched when `output` switches off.
    pub(crate) off: u8,
}

/// An output of the standard ladder, by its function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum LadderOutput {
    /// Output that switches the coolant on, as after M08.
    Coolant,
    /// Output that turns the spindle forward, as after M03.
    SpindleForward,
    /// Output that turns the spindle in reverse, as after M04.
    SpindleReverse,
    /// Output that applies the spindle brake.
    Brake,
    /// Output that switches the lubrication, as after M32.
    Lubrication,
}

/// The function of an M code of a model, and the outputs that it switches.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct MFunction {
    /// The function of the M code for the control.
    #[serde(rename = "does")]
    pub meaning: MCode,
    /// Numbers of the model's outputs that the code switches on.
    #[serde(default)]
    pub on: Vec<u8>,
    /// Numbers of the model's outputs that the code switches off.
    #[serde(default)]
    pub off: Vec<u8>,
}

impl MFunction {
    /// A function that switches no outputs.
    pub(super) const fn without_outputs(meaning: MCode) -> Self {
        Self {
            meaning,
            on: Vec::new(),
            off: Vec::new(),
        }
    }
}

impl ModelRecord {
    /// The record of the model `id`, read at the first call.
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

    /// Returns the id of the model that the record describes.
    pub const fn id(&self) -> ModelId {
        self.id
    }

    /// The name of the model in the language of the operator.
    pub fn name(&self) -> Message {
        self.id.name()
    }

    /// The X byte and bit of the model's input `number`, from 0.
    pub const fn input_contact(&self, number: u8) -> (u16, u8) {
        let contact = self.first_input as u16 + number as u16;
        (contact / 8, (contact % 8) as u8)
    }

    /// How the model writes the names of programs.
    pub fn program_naming(&self) -> ProgramNaming {
        match self.program_name.starts_with('%') {
            true => ProgramNaming::Percent,
            false => ProgramNaming::Letter,
        }
    }

    /// The number of the G code that sets the coordinates; `None` if the model has none.
    pub fn coordinate_code(&self) -> Option<u8> {
        let mut codes = self.g.iter();
        let found = codes.find(|(_, meaning)| **meaning == GCode::Coordinates);
        found.map(|(number, _)| *number)
    }

    /// The meaning of the G code `number`; `None` if the model has no such code.
    #[inline]
    pub fn g_code(&self, number: i64) -> Option<GCode> {
        let index = usize::try_from(number).ok()?;
        self.g_table.get(index).copied().flatten()
    }

    /// Least and greatest value of the control parameter `number`; `None` if they are those of
    /// the GSK980TD.
    pub fn parameter_range(&self, number: u16) -> Option<(i32, i32)> {
        self.ranges.get(&number).copied()
    }

    /// The number of the first G code with this meaning; `None` if the model has no such code.
    pub fn g_number(&self, meaning: GCode) -> Option<u8> {
        let mut codes = self.g.iter();
        codes.find_map(|(number, it)| (*it == meaning).then_some(*number))
    }

    /// The function of the M code `number`; `None` if the model has no such code.
    pub fn m_function(&self, number: u8) -> Option<&MFunction> {
        self.m.get(&number)
    }

    /// Whether `letter` is an address of this model but not of the GSK980TD.
    pub(crate) fn has_address(&self, letter: u8) -> bool {
        self.addresses.bytes().any(|it| it == letter)
    }

    /// Whether `letter` is an address in blocks other than macro calls.
    pub fn is_address(&self, letter: u8) -> bool {
        let of_lathe = matches!(letter, b'F'..=b'U' | b'W' | b'X' | b'Z');
        (of_lathe || self.has_address(letter)) && !self.is_argument_only(letter)
    }

    /// Whether `letter` is accepted only as an argument of macro calls.
    pub fn is_argument_only(&self, letter: u8) -> bool {
        self.argument_addresses.bytes().any(|it| it == letter)
    }

    /// Least and greatest number of the words with the address `letter`; `None` if they are
    /// those of the GSK980TD.
    pub fn word_limits(&self, letter: u8) -> Option<(i64, i64)> {
        self.word_limits.get(&char::from(letter)).copied()
    }

    /// The greatest absolute coordinate in a program, mm.
    pub fn greatest_coordinate_mm(&self) -> f64 {
        self.greatest_coordinate as f64 / 1000.0
    }

    /// Whether a G code of the model returns to the position where the run started.
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
    let mut record: ModelRecord = match id {
        ModelId::Gsk980td => ModelRecord::default(),
        ModelId::Gsk980mdi => read_ron(include_str!("../../../assets/models/gsk980mdi.ron")),
        ModelId::Hx31 => read_ron(include_str!("../../../assets/models/hx31.ron")),
        ModelId::Ncb08 => read_ron(include_str!("../../../assets/models/ncb08.ron")),
    };
    record.id = id;
    record.g_table = vec![None; G_CODES];
    for (number, meaning) in &record.g {
        if let Some(entry) = record.g_table.get_mut(usize::from(*number)) {
            *entry = Some(*meaning);
        }
    }
    record
}

/// Parses a RON text of the program itself; an optional value is written without `Some`.
pub(super) fn read_ron<T: DeserializeOwned>(text: &str) -> T {
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    match options.from_str(text) {
        Ok(value) => value,
        Err(error) => unreachable!("this text is part of the program: {error}"),
    }
}
