//! Parses the values of command line options.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gsk_core::memory::DayTime;
use gsk_core::model::ModelId;
use gsk_core::units::parse_finite;
use gsk_messages::{Language, Message, say};

/// The reason why a value of an option is invalid. A text in a variant is the value as typed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum OptionValueError {
    /// The value of an option is not a number.
    NotANumber(String),
    /// The length is outside the range of lengths, ±9999.999.
    OutOfRange(String),
    /// The value of an option does not have this form.
    WrongForm(&'static str),
    /// The value does not have this form; the second text is an example of the form.
    WrongFormExample(&'static str, &'static str),
    /// The value is neither `on` nor `off`.
    NotOnOff,
    /// The distance is below 0.1 mm.
    DistanceTooShort(String),
    /// The feed is below 1 mm/min.
    FeedTooLow(String),
    /// The spindle speed is below 0.
    NegativeSpeed,
    /// The value of a bit is neither `0` nor `1`.
    NotZeroOrOne(String),
    /// The value is not a parameter number.
    InvalidParameterNumber(String),
    /// The value is not a whole number.
    NotAWholeNumber(String),
    /// The bit number is not 0 to 7.
    InvalidBitNumber,
    /// The value is not an offset number.
    InvalidOffsetNumber(String),
    /// The offset option has more than four values.
    TooManyOffsetValues,
    /// The imaginary tip number of an offset is not 0 to 9.
    InvalidNoseType,
    /// The unit of a time is unknown.
    UnknownTimeUnit(String),
    /// There is no number before the unit of a time.
    InvalidTime(String),
    /// The time is below 1 ms or above 10^12 ms.
    TimeOutOfRange(String),
    /// The value is not a log level.
    UnknownLogLevel(String),
    /// The value is not a partition of the control's memory.
    UnknownPartition,
    /// The value is not an axis of a mill.
    UnknownAxis,
    /// The value does not have eight binary digits.
    NotEightBits,
    /// The value is not a diagnosis number with its eight bits.
    InvalidKeyBits,
    /// The value does not consist of two whole numbers with this character between them.
    NotTwoNumbers(char),
}

impl OptionValueError {
    pub fn message(&self) -> Message {
        match self {
            Self::NotANumber(word) => say::option_no_number(word),
            Self::OutOfRange(word) => say::option_outside(word),
            Self::WrongForm(form) => say::option_form(form),
            Self::WrongFormExample(form, example) => say::option_form_example(form, example),
            Self::NotOnOff => say::option_on_off(),
            Self::DistanceTooShort(word) => say::option_way(word),
            Self::FeedTooLow(word) => say::option_feed(word),
            Self::NegativeSpeed => say::option_negative_speed(),
            Self::NotZeroOrOne(word) => say::option_state(word),
            Self::InvalidParameterNumber(word) => say::option_no_parameter(word),
            Self::NotAWholeNumber(word) => say::option_not_whole(word),
            Self::InvalidBitNumber => say::option_bit(),
            Self::InvalidOffsetNumber(word) => say::option_no_offset(word),
            Self::TooManyOffsetValues => say::option_offset_values(),
            Self::InvalidNoseType => say::option_nose(),
            Self::UnknownTimeUnit(word) => say::option_no_unit(word),
            Self::InvalidTime(word) => say::option_no_time(word),
            Self::TimeOutOfRange(word) => say::option_useless_time(word),
            Self::UnknownLogLevel(word) => say::option_log(word),
            Self::UnknownPartition => say::option_partition(),
            Self::UnknownAxis => say::option_axis(),
            Self::NotEightBits => say::option_bits(),
            Self::InvalidKeyBits => say::option_keys(),
            Self::NotTwoNumbers(between) => say::option_two_whole(between),
        }
    }
}

/// The value of `--param`: a parameter or a bit, with its new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterOption {
    /// A whole parameter with its new value, `N=V`.
    Value { number: u16, value: i32 },
    /// A bit of a parameter with its new state, `N.B=0|1`.
    Bit {
        number: u16,
        /// Number of the bit in the parameter, 0 to 7.
        bit: u8,
        state: bool,
    },
}

/// The value of `--offset`: a row of the tool offset table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetOption {
    pub number: u8,
    /// X offset, mm, a diameter or a radius as on the offset page.
    pub x: f64,
    /// Z value of the tool offset, mm.
    pub z: f64,
    /// Nose radius of the tool offset, mm.
    pub nose_radius_mm: f64,
    /// Imaginary tip number of the tool offset, 0 to 9.
    pub nose_type: u8,
}

/// Value of `--input` and `--set`: a PLC address and the state of its bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputBit {
    /// Address of the input such as `X0.4`, in capitals.
    pub address: String,
    pub state: bool,
}

/// Parses any finite number, of any unit. Returns an error for another text.
pub fn parse_number(word: &str) -> Result<f64, OptionValueError> {
    parse_finite(word.trim()).ok_or_else(|| OptionValueError::NotANumber(word.to_owned()))
}

fn parse_length(word: &str) -> Result<f64, OptionValueError> {
    let value = parse_number(word)?;
    if value.abs() > 9999.999 {
        return Err(OptionValueError::OutOfRange(word.to_owned()));
    }
    Ok(value)
}

/// Creates the parser of a model whose programs can be executed: all lathes.
pub fn lathe_model_parser() -> impl TypedValueParser<Value = ModelId> {
    model_parser_for(|id| !id.is_mill())
}

/// Creates the parser for the name of a control model, mills included.
pub fn model_parser() -> impl TypedValueParser<Value = ModelId> {
    model_parser_for(|_| true)
}

fn model_parser_for(is_accepted: fn(&ModelId) -> bool) -> impl TypedValueParser<Value = ModelId> {
    let words = ModelId::ALL.into_iter().filter(is_accepted);
    let words =
        words.map(|id| PossibleValue::new(id.command_word()).help(id.name().text(Language::En)));
    PossibleValuesParser::new(words)
        .map(|word| ModelId::from_command_word(&word).unwrap_or_default())
}

/// Parses the date and time of `--clock`, such as `1993-03-28T15:34:56`. Returns an error for
/// another text.
pub(super) fn parse_moment(word: &str) -> Result<DayTime, OptionValueError> {
    DayTime::from_text(word).ok_or(OptionValueError::WrongForm("YYYY-MM-DDThh:mm:ss"))
}

pub(super) fn parse_model_parameter(word: &str) -> Result<(u16, i32), OptionValueError> {
    match parse_parameter(word)? {
        ParameterOption::Value { number, value } => Ok((number, value)),
        ParameterOption::Bit { .. } => Err(OptionValueError::WrongFormExample("N=V", "17=6000")),
    }
}

/// Parses `X,Z`; both are at most 9999.999 in size. Returns an error for another text.
pub fn parse_xz(word: &str) -> Result<(f64, f64), OptionValueError> {
    let (x, z) = word
        .split_once(',')
        .ok_or(OptionValueError::WrongFormExample("X,Z", "300,300"))?;
    Ok((parse_length(x)?, parse_length(z)?))
}

/// Parses the distance of a move there and back, mm, positive or negative, at least 0.1 mm. Returns
/// an error for another text.
pub fn parse_distance(word: &str) -> Result<f64, OptionValueError> {
    let value = parse_length(word)?;
    if value.abs() < 0.1 {
        return Err(OptionValueError::DistanceTooShort(word.to_owned()));
    }
    Ok(value)
}

/// Parses a feed, mm/min, at least 1. Returns an error for another text.
pub fn parse_feed(word: &str) -> Result<f64, OptionValueError> {
    let value = parse_length(word)?;
    if value < 1.0 {
        return Err(OptionValueError::FeedTooLow(word.to_owned()));
    }
    Ok(value)
}

pub(super) fn parse_spindle_speed(word: &str) -> Result<f64, OptionValueError> {
    let value = parse_length(word)?;
    if value < 0.0 {
        Err(OptionValueError::NegativeSpeed)
    } else {
        Ok(value)
    }
}

/// Parses `on` (true) and `off` (false). Returns an error for another text.
pub fn parse_switch(word: &str) -> Result<bool, OptionValueError> {
    match word.trim() {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(OptionValueError::NotOnOff),
    }
}

fn parse_state(word: &str) -> Result<bool, OptionValueError> {
    match word.trim() {
        "0" => Ok(false),
        "1" => Ok(true),
        other => Err(OptionValueError::NotZeroOrOne(other.to_owned())),
    }
}

pub fn parse_parameter(word: &str) -> Result<ParameterOption, OptionValueError> {
    let (name, value) = word
        .split_once('=')
        .ok_or(OptionValueError::WrongFormExample(
            "N=V | N.B=0|1",
            "22=3800, 1.4=1",
        ))?;
    let name = name.trim();
    let name = name.strip_prefix('P').unwrap_or(name);
    let parse = |digits: &str| {
        digits
            .parse::<u16>()
            .map_err(|_| OptionValueError::InvalidParameterNumber(digits.to_owned()))
    };
    let Some((number, bit)) = name.split_once('.') else {
        let number = parse(name)?;
        let value = value.trim();
        // The eight bits of a bit parameter, as the parameter page shows them.
        if value.len() == 8 && value.bytes().all(|byte| matches!(byte, b'0' | b'1')) {
            let value = i32::from_str_radix(value, 2)
                .map_err(|_| OptionValueError::NotAWholeNumber(value.to_owned()))?;
            return Ok(ParameterOption::Value { number, value });
        }
        let value = value
            .parse()
            .map_err(|_| OptionValueError::NotAWholeNumber(value.to_owned()))?;
        return Ok(ParameterOption::Value { number, value });
    };
    let number = parse(number)?;
    let bit = bit.parse().ok().filter(|bit| *bit < 8);
    let bit = bit.ok_or(OptionValueError::InvalidBitNumber)?;
    Ok(ParameterOption::Bit {
        number,
        bit,
        state: parse_state(value)?,
    })
}

pub(super) fn parse_offset(word: &str) -> Result<OffsetOption, OptionValueError> {
    let (name, values) = word
        .split_once('=')
        .ok_or(OptionValueError::WrongFormExample(
            "NN=X,Z,R,T",
            "1=0,0,0.4,3",
        ))?;
    let name = name.trim();
    let offset_number = name
        .parse()
        .map_err(|_| OptionValueError::InvalidOffsetNumber(name.to_owned()))?;
    let words: Vec<&str> = values.split(',').collect();
    if words.len() > 4 {
        return Err(OptionValueError::TooManyOffsetValues);
    }
    let value = |index: usize| words.get(index).map_or(Ok(0.0), |word| parse_length(word));
    let nose = words.get(3).map_or("0", |word| word.trim());
    let nose = nose.parse().ok().filter(|nose| *nose <= 9);
    Ok(OffsetOption {
        number: offset_number,
        x: value(0)?,
        z: value(1)?,
        nose_radius_mm: value(2)?,
        nose_type: nose.ok_or(OptionValueError::InvalidNoseType)?,
    })
}

/// Parses an input and its state, such as `X0.4=1`. Returns an error for another text.
pub fn parse_input_bit(word: &str) -> Result<InputBit, OptionValueError> {
    let (address, value) = word
        .split_once('=')
        .ok_or(OptionValueError::WrongFormExample("X0.4=0|1", "X0.4=1"))?;
    Ok(InputBit {
        address: address.trim().to_ascii_uppercase(),
        state: parse_state(value)?,
    })
}

/// Parses a time such as `500ms`, `90s`, `1.5m`, `24h` to ms; without a unit it is in seconds.
/// Returns an error for another text.
pub fn parse_duration_ms(word: &str) -> Result<u64, OptionValueError> {
    let word = word.trim();
    let split = word
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(word.len());
    let (digits, unit) = word.split_at(split);
    let unit_ms = match unit {
        "ms" => 1.0,
        "" | "s" => 1000.0,
        "m" | "min" => 60_000.0,
        "h" => 3_600_000.0,
        _ => return Err(OptionValueError::UnknownTimeUnit(unit.to_owned())),
    };
    let value = parse_finite(digits.trim())
        .ok_or_else(|| OptionValueError::InvalidTime(word.to_owned()))?;
    let ms = value * unit_ms;
    if !(1.0..=1e12).contains(&ms) {
        return Err(OptionValueError::TimeOutOfRange(word.to_owned()));
    }
    Ok(ms.round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_move_has_a_distance_and_a_feed() {
        assert_eq!(
            (parse_distance("-50"), parse_feed("600")),
            (Ok(-50.0), Ok(600.0))
        );
        for word in ["0", "0.05", "nan", "inf", "1e5", "x"] {
            assert!(parse_distance(word).is_err(), "{word}");
        }
        for word in ["0", "0.5", "-100", "nan", "1e9", ""] {
            assert!(parse_feed(word).is_err(), "{word}");
        }
    }

    #[test]
    fn parameters_come_as_value_as_bit_and_as_eight_bits() {
        assert_eq!(
            parse_parameter("22=3800"),
            Ok(ParameterOption::Value {
                number: 22,
                value: 3800
            })
        );
        assert_eq!(
            parse_parameter("45=-5"),
            Ok(ParameterOption::Value {
                number: 45,
                value: -5
            })
        );
        assert_eq!(
            parse_parameter("001=00010000"),
            Ok(ParameterOption::Value {
                number: 1,
                value: 16
            })
        );
        assert_eq!(
            parse_parameter("001.4=1"),
            Ok(ParameterOption::Bit {
                number: 1,
                bit: 4,
                state: true
            })
        );
        for wrong in ["22", "x=1", "1.8=1", "1.4=2", "22=1.5"] {
            assert!(parse_parameter(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn offsets_may_be_short() {
        let word = parse_offset("3=-1.5,2").expect("offset");
        assert_eq!(
            word,
            OffsetOption {
                number: 3,
                x: -1.5,
                z: 2.0,
                nose_radius_mm: 0.0,
                nose_type: 0
            }
        );
        assert!(parse_offset("3=1,2,3,4,5").is_err());
        assert!(parse_offset("3=0,0,0.4,12").is_err());
    }

    #[test]
    fn times_have_units() {
        assert_eq!(parse_duration_ms("500ms"), Ok(500));
        assert_eq!(parse_duration_ms("90"), Ok(90_000));
        assert_eq!(parse_duration_ms("1.5m"), Ok(90_000));
        assert_eq!(parse_duration_ms("24h"), Ok(86_400_000));
        assert!(parse_duration_ms("3 days").is_err());
        assert!(parse_duration_ms("-1s").is_err());
    }
}
