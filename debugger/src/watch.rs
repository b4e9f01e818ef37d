//! Values of a control that a debugger watches: their names, and reading them.

use core::fmt;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_core::program::WatchFormula;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Axis, Point};
use gsk_messages::{Message, say};
use gsk_runner::move_output::diameter_z;
use gsk_runner::report::modal_codes;

/// The coordinates in which a position is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchedCoordinates {
    /// Work coordinates of the program: `X`, `Z`.
    Absolute,
    /// Relative coordinates: `U`, `W`.
    Relative,
    /// Machine coordinates: `XM`, `ZM`.
    Machine,
}

/// A column of the offset table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchedColumn {
    /// The X offset of the tool, mm.
    X,
    /// The Z offset of the tool, mm.
    Z,
    /// The nose radius of the tool, mm.
    Radius,
    /// The number of the nose direction of the tool.
    Tip,
}

/// A modal word in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModalWord {
    /// The G codes of all groups.
    G,
    /// The last M code.
    M,
    /// The F word (feed rate) in force.
    F,
    /// The S word (spindle speed) in force.
    S,
    /// Tool and offset number, as four digits.
    T,
}

/// A measured or counted value of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunValue {
    /// `feed`: speed along the path, mm/min.
    Feed,
    /// `spindle`: speed of the spindle, r/min, negative in reverse.
    SpindleSpeed,
    /// `angle`: angle of the spindle, degrees.
    SpindleAngle,
    /// `tick`: milliseconds since power-on.
    Tick,
    /// `line`: line of the block in execution.
    Line,
}

/// The names of the values that stand for themselves.
const RUN_VALUES: [(&str, RunValue); 5] = [
    ("feed", RunValue::Feed),
    ("spindle", RunValue::SpindleSpeed),
    ("angle", RunValue::SpindleAngle),
    ("tick", RunValue::Tick),
    ("line", RunValue::Line),
];
const MODAL_WORDS: [(&str, ModalWord); 5] = [
    ("G", ModalWord::G),
    ("M", ModalWord::M),
    ("F", ModalWord::F),
    ("S", ModalWord::S),
    ("T", ModalWord::T),
];
const POSITIONS: [(&str, WatchedCoordinates, Axis); 6] = [
    ("X", WatchedCoordinates::Absolute, Axis::X),
    ("Z", WatchedCoordinates::Absolute, Axis::Z),
    ("U", WatchedCoordinates::Relative, Axis::X),
    ("W", WatchedCoordinates::Relative, Axis::Z),
    ("XM", WatchedCoordinates::Machine, Axis::X),
    ("ZM", WatchedCoordinates::Machine, Axis::Z),
];

/// The source of the value of a watch target.
#[derive(Clone, Debug, PartialEq)]
enum WatchSource {
    /// A variable that the variable page lists, or a local one.
    Variable(u16),
    /// A formula of macro B.
    Formula(WatchFormula),
    Position(WatchedCoordinates, Axis),
    Modal(ModalWord),
    Run(RunValue),
    Bit(BitAddress),
    Byte(ByteAddress),
    Parameter(u16, Option<u8>),
    Offset(u8, WatchedColumn),
}

/// A value of a control, by its name:
///
/// ```text
///   #100  #100+#101   a variable, a formula of macro B
///   X Z  U W  XM ZM   work, relative, machine coordinates; X is a diameter
///   G M F S T         modal words
///   feed spindle angle tick line
///   Y1.2  R100        a bit or a byte of PLC memory
///   P22  P4.3         a parameter, a bit of a parameter
///   T1.X T1.Z T1.R T1.T   X, Z, radius and tip of an offset
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WatchTarget {
    name: String,
    source: WatchSource,
}

/// The value of a watch target.
#[derive(Clone, Debug, PartialEq)]
pub enum WatchedValue {
    /// The value is a number.
    Number(f64),
    /// A bit of PLC memory or of a parameter.
    Bit(bool),
    /// The value is a text, such as a list of G codes.
    Text(String),
    /// Null: a variable without a value.
    Null,
}

impl WatchedValue {
    /// The value as a number; a bit is 1 or 0, null 0, and a text has none.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(value) => Some(*value),
            Self::Bit(on) => Some(f64::from(u8::from(*on))),
            Self::Null => Some(0.0),
            Self::Text(_) => None,
        }
    }

    /// The value as JSON: a number, a text, or null.
    pub fn to_json(&self) -> serde_json::Value {
        match self {
            Self::Number(value) if value.fract() == 0.0 && value.abs() < 1e15 => {
                (*value as i64).into()
            }
            Self::Number(value) => (*value).into(),
            Self::Bit(on) => u8::from(*on).into(),
            Self::Text(text) => text.as_str().into(),
            Self::Null => serde_json::Value::Null,
        }
    }
}

impl fmt::Display for WatchedValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Six decimals: 399.99999999999994 r/min are 400.
            Self::Number(value) if value.abs() < 1e9 => {
                write!(f, "{}", (value * 1e6).round() / 1e6)
            }
            Self::Number(value) => write!(f, "{value}"),
            Self::Bit(on) => write!(f, "{}", u8::from(*on)),
            Self::Text(text) => f.write_str(text),
            Self::Null => f.write_str("null"),
        }
    }
}

impl WatchTarget {
    /// Parses the name of a value.
    ///
    /// # Errors
    /// The message that names the text and the rule that it breaks.
    pub fn parse(text: &str) -> Result<Self, Message> {
        let text = text.trim();
        let source = parse_source(text)?;
        Ok(Self {
            name: text.to_owned(),
            source,
        })
    }

    /// The name as it was written.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the value is a bit, so that it is 0 or 1.
    pub const fn is_bit(&self) -> bool {
        matches!(
            self.source,
            WatchSource::Bit(_) | WatchSource::Parameter(_, Some(_))
        )
    }

    /// Whether the value is a text, so that it cannot be compared by size.
    pub const fn is_text(&self) -> bool {
        matches!(self.source, WatchSource::Modal(ModalWord::G))
    }

    /// Reads the value.
    ///
    /// # Errors
    /// The alarm of a formula: an unknown variable, a division by 0.
    pub fn read(&self, simulation: &Simulation) -> Result<WatchedValue, Alarm> {
        let cnc = &simulation.cnc;
        Ok(match &self.source {
            WatchSource::Variable(number) => number_or_null(cnc.real_variable(*number)),
            WatchSource::Formula(formula) => number_or_null(cnc.evaluate(formula)?),
            WatchSource::Position(coordinates, axis) => {
                WatchedValue::Number(read_position(cnc, *coordinates, *axis))
            }
            WatchSource::Modal(word) => read_modal(cnc, *word),
            WatchSource::Run(value) => WatchedValue::Number(read_run(simulation, *value)),
            WatchSource::Bit(address) => WatchedValue::Bit(cnc.plc().memory().bit(*address)),
            WatchSource::Byte(address) if address.area.is_entry() => {
                WatchedValue::Number(cnc.plc().memory().long(*address).into())
            }
            WatchSource::Byte(address) => {
                WatchedValue::Number(cnc.plc().memory().byte(*address).into())
            }
            WatchSource::Parameter(number, None) => {
                WatchedValue::Number(cnc.parameters().value(*number).into())
            }
            WatchSource::Parameter(number, Some(bit)) => {
                WatchedValue::Bit(cnc.parameters().bit(*number, *bit))
            }
            WatchSource::Offset(number, column) => {
                let offset = cnc.offsets().get(*number);
                WatchedValue::Number(match column {
                    WatchedColumn::X => offset.x,
                    WatchedColumn::Z => offset.z,
                    WatchedColumn::Radius => offset.r,
                    WatchedColumn::Tip => offset.t.into(),
                })
            }
        })
    }
}

fn number_or_null(value: Option<f64>) -> WatchedValue {
    value.map_or(WatchedValue::Null, WatchedValue::Number)
}

fn find_named<T: Copy>(list: &[(&str, T)], text: &str) -> Option<T> {
    let found = list
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(text));
    found.map(|(_, value)| *value)
}

fn parse_source(text: &str) -> Result<WatchSource, Message> {
    if text.starts_with(['#', '[']) {
        return parse_formula(text);
    }
    let position = POSITIONS
        .iter()
        .find(|(name, ..)| name.eq_ignore_ascii_case(text));
    if let Some((_, coordinates, axis)) = position {
        return Ok(WatchSource::Position(*coordinates, *axis));
    }
    if let Some(word) = find_named(&MODAL_WORDS, text) {
        return Ok(WatchSource::Modal(word));
    }
    if let Some(value) = find_named(&RUN_VALUES, text) {
        return Ok(WatchSource::Run(value));
    }
    let upper = text.to_ascii_uppercase();
    if let Some(source) = parse_parameter(&upper) {
        return source.ok_or_else(|| say::debug_parameter_unknown(text));
    }
    if let Some(source) = parse_offset(&upper) {
        return source.ok_or_else(|| say::debug_offset_unknown(text));
    }
    if !upper.chars().any(|letter| letter.is_ascii_digit()) {
        return Err(say::debug_value_unknown(text));
    }
    let bit = upper.parse::<BitAddress>();
    match (bit, upper.parse::<ByteAddress>()) {
        (Ok(address), _) => Ok(WatchSource::Bit(address)),
        (Err(_), Ok(address)) => Ok(WatchSource::Byte(address)),
        (Err(error), Err(_)) => Err(say::debug_address_wrong(text, error.message())),
    }
}

fn parse_formula(text: &str) -> Result<WatchSource, Message> {
    let digits = text.strip_prefix('#').and_then(|rest| rest.parse().ok());
    if let Some(number @ 1..=999) = digits {
        return Ok(WatchSource::Variable(number));
    }
    let formula = WatchFormula::parse(text)
        .map_err(|error| say::debug_formula_wrong(text, error.column, error.detail))?;
    Ok(WatchSource::Formula(formula))
}

/// The parameter `P22` or its bit `P4.3`. The outer `None`: another form; the inner one: no
/// such parameter.
fn parse_parameter(text: &str) -> Option<Option<WatchSource>> {
    let rest = text.strip_prefix('P')?;
    if !rest.starts_with(|letter: char| letter.is_ascii_digit()) {
        return None;
    }
    let (number, bit) = match rest.split_once('.') {
        Some((number, bit)) => (number, Some(bit)),
        None => (rest, None),
    };
    let number = number.parse().ok().filter(|number| *number < 1000);
    let bit = match bit {
        None => Some(None),
        Some(bit) => bit.parse().ok().filter(|bit| *bit < 8).map(Some),
    };
    Some(
        number
            .zip(bit)
            .map(|(number, bit)| WatchSource::Parameter(number, bit)),
    )
}

/// The offset `T1.X`. The outer `None`: another form; the inner one: no such offset.
fn parse_offset(text: &str) -> Option<Option<WatchSource>> {
    let (number, column) = text.strip_prefix('T')?.split_once('.')?;
    let column = match column {
        "X" => WatchedColumn::X,
        "Z" => WatchedColumn::Z,
        "R" => WatchedColumn::Radius,
        "T" => WatchedColumn::Tip,
        _ => return Some(None),
    };
    let number = number.parse().ok().filter(|number| *number <= 32);
    Some(number.map(|number| WatchSource::Offset(number, column)))
}

fn read_position(cnc: &Cnc, coordinates: WatchedCoordinates, axis: Axis) -> f64 {
    let point: Point = match coordinates {
        WatchedCoordinates::Absolute => cnc.position_absolute(),
        WatchedCoordinates::Relative => cnc.position_relative(),
        WatchedCoordinates::Machine => cnc.position_machine(),
    };
    let (x, z) = diameter_z(point);
    match axis {
        Axis::X => x,
        Axis::Z => z,
    }
}

fn read_modal(cnc: &Cnc, word: ModalWord) -> WatchedValue {
    let modal = cnc.modal();
    match word {
        ModalWord::G => WatchedValue::Text(modal_codes(modal).join(" ")),
        ModalWord::M => number_or_null(modal.m.map(f64::from)),
        ModalWord::F => WatchedValue::Number(modal.feed),
        ModalWord::S => WatchedValue::Number(modal.spindle),
        ModalWord::T => {
            let (tool, offset) = cnc.tool();
            WatchedValue::Number(f64::from(u16::from(tool) * 100 + u16::from(offset)))
        }
    }
}

fn read_run(simulation: &Simulation, value: RunValue) -> f64 {
    let cnc = &simulation.cnc;
    match value {
        RunValue::Feed => cnc.feed_actual(),
        RunValue::SpindleSpeed => simulation.lathe.spindle_rpm(),
        RunValue::SpindleAngle => simulation.lathe.spindle_degrees(),
        RunValue::Tick => cnc.ticks() as f64,
        RunValue::Line => cnc.cursor().line.into(),
    }
}

#[cfg(test)]
mod tests {
    use gsk_core::setup::Setup;
    use gsk_messages::Language;

    use super::*;

    #[test]
    fn every_kind_of_name_reads_its_value() {
        let mut setup = Setup::default();
        setup.memory.variables.set(200, 7).expect("variable");
        let simulation = Simulation::new(setup);
        for (name, value) in [
            ("#200", WatchedValue::Number(7.0)),
            ("#200+0.5", WatchedValue::Number(7.5)),
            ("#200 GT 5", WatchedValue::Number(1.0)),
            ("G", WatchedValue::Text("G00 G97 G98 G40".to_owned())),
            ("m", WatchedValue::Null),
            ("tick", WatchedValue::Number(0.0)),
            (
                "P22",
                WatchedValue::Number(simulation.cnc.parameters().value(22).into()),
            ),
            (
                "P4.3",
                WatchedValue::Bit(simulation.cnc.parameters().bit(4, 3)),
            ),
            ("T1.X", WatchedValue::Number(0.0)),
            ("r100", WatchedValue::Number(0.0)),
            ("R100.2", WatchedValue::Bit(false)),
        ] {
            let target = WatchTarget::parse(name).expect(name);
            assert_eq!(target.read(&simulation).expect(name), value, "{name}");
        }
    }

    #[test]
    fn a_wrong_name_is_quoted_with_its_rule() {
        for (name, rule) in [
            ("hello", "hello is no value"),
            ("P1000", "P1000: parameters have"),
            ("T1.Q", "T1.Q: an offset"),
            ("X200.1", "X200.1"),
            ("#100 > 5", "column 6"),
            ("", "is no value"),
        ] {
            let message = WatchTarget::parse(name).expect_err(name).text(Language::En);
            assert!(message.contains(rule), "{name}: {message}");
        }
    }
}
