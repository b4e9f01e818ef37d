//! Parses the values of command line options.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gsk_core::memory::DayTime;
use gsk_core::model::ModelId;
use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

/// Why a value of an option cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum WordError {
    /// Not a number.
    NoNumber(String),
    /// Outside the range of lengths, 9999.999.
    Outside(String),
    /// Wrong form; holds the expected one.
    Form(&'static str),
    /// Wrong form; holds the expected one and an example.
    FormLike(&'static str, &'static str),
    /// Neither `on` nor `off`.
    NoSwitch,
    /// A distance below 0.1 mm.
    NoWay(String),
    /// A feed below 1 mm/min.
    NoFeed(String),
    /// A spindle speed below 0.
    NegativeSpeed,
    /// Neither `0` nor `1`.
    NoState(String),
    /// Not a parameter number.
    NoParameter(String),
    /// Not a whole number.
    NotWhole(String),
    /// Not a bit number 0 to 7.
    NoBit,
    /// Not an offset number.
    NoOffset(String),
    /// More than four values of an offset.
    TooManyValues,
    /// Not a nose type 0 to 9.
    NoNose,
    /// Not a unit of time.
    NoUnit(String),
    /// Not a number before the unit of time.
    NoTime(String),
    /// A time below 1 ms or above 10^12 ms.
    UselessTime(String),
    /// Not a log level.
    NoLevel(String),
    /// Not a partition of the control's memory.
    NoPartition,
    /// Not an axis of a mill.
    NoAxis,
    /// Not eight binary digits.
    NoBits,
    /// Not a diagnosis number with its eight bits.
    NoKeys,
    /// Not two whole numbers with this character between them.
    NotTwo(char),
}

impl WordError {
    pub fn message(&self) -> Message {
        match self {
            Self::NoNumber(word) => say::option_no_number(word),
            Self::Outside(word) => say::option_outside(word),
            Self::Form(form) => say::option_form(form),
            Self::FormLike(form, example) => say::option_form_example(form, example),
            Self::NoSwitch => say::option_on_off(),
            Self::NoWay(word) => say::option_way(word),
            Self::NoFeed(word) => say::option_feed(word),
            Self::NegativeSpeed => say::option_negative_speed(),
            Self::NoState(word) => say::option_state(word),
            Self::NoParameter(word) => say::option_no_parameter(word),
            Self::NotWhole(word) => say::option_not_whole(word),
            Self::NoBit => say::option_bit(),
            Self::NoOffset(word) => say::option_no_offset(word),
            Self::TooManyValues => say::option_offset_values(),
            Self::NoNose => say::option_nose(),
            Self::NoUnit(word) => say::option_no_unit(word),
            Self::NoTime(word) => say::option_no_time(word),
            Self::UselessTime(word) => say::option_useless_time(word),
            Self::NoLevel(word) => say::option_log(word),
            Self::NoPartition => say::option_partition(),
            Self::NoAxis => say::option_axis(),
            Self::NoBits => say::option_bits(),
            Self::NoKeys => say::option_keys(),
            Self::NotTwo(between) => say::option_two_whole(between),
        }
    }
}

/// Value of `--param`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterWord {
    /// A whole parameter, `N=V`.
    Value {
        number: u16,
        value: i32,
    },
    /// One bit of a parameter, `N.B=0|1`.
    Bit {
        number: u16,
        /// Bit 0 to 7.
        bit: u8,
        state: bool,
    },
}

/// Value of `--offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetWord {
    pub number: u8,
    /// X in mm, a diameter or a radius as on the offset page.
    pub x: f64,
    /// Z, mm.
    pub z: f64,
    /// Nose radius, mm.
    pub radius: f64,
    /// Nose type 0–9.
    pub nose: u8,
}

/// Value of `--input` and `--set`: a PLC address and the state of its bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputBit {
    /// Such as `X0.4`, in capitals.
    pub address: String,
    pub state: bool,
}

/// Parses any finite number.
pub fn finite(word: &str) -> Result<f64, WordError> {
    parse_finite(word.trim()).ok_or_else(|| WordError::NoNumber(word.to_owned()))
}

fn number(word: &str) -> Result<f64, WordError> {
    let value = finite(word)?;
    if value.abs() > 9999.999 {
        return Err(WordError::Outside(word.to_owned()));
    }
    Ok(value)
}

/// Parser of a model whose programs can be executed: all lathes.
pub fn model() -> impl TypedValueParser<Value = ModelId> {
    models(|id| !id.is_mill())
}

/// Parser of a model, mills included.
pub fn any_model() -> impl TypedValueParser<Value = ModelId> {
    models(|_| true)
}

fn models(taken: fn(&ModelId) -> bool) -> impl TypedValueParser<Value = ModelId> {
    let words = ModelId::ALL.into_iter().filter(taken);
    let words = words.map(|id| PossibleValue::new(id.word()).help(id.name()));
    PossibleValuesParser::new(words).map(|word| ModelId::from_word(&word).unwrap_or_default())
}

/// Parses the value of `--clock`.
pub(super) fn moment(word: &str) -> Result<DayTime, WordError> {
    DayTime::from_text(word).ok_or(WordError::Form("YYYY-MM-DDThh:mm:ss"))
}

pub(super) fn model_parameter(word: &str) -> Result<(u16, i32), WordError> {
    match parameter(word)? {
        ParameterWord::Value { number, value } => Ok((number, value)),
        ParameterWord::Bit { .. } => Err(WordError::FormLike("N=V", "17=6000")),
    }
}

/// Parses `X,Z`, both at most 9999.999.
pub fn pair(word: &str) -> Result<(f64, f64), WordError> {
    let (x, z) = word
        .split_once(',')
        .ok_or(WordError::FormLike("X,Z", "300,300"))?;
    Ok((number(x)?, number(z)?))
}

/// Parses the distance of a move there and back, mm, positive or negative, at least 0.1 mm.
pub fn travel(word: &str) -> Result<f64, WordError> {
    let value = number(word)?;
    if value.abs() < 0.1 {
        return Err(WordError::NoWay(word.to_owned()));
    }
    Ok(value)
}

/// Parses a feed, mm/min, at least 1.
pub fn feed(word: &str) -> Result<f64, WordError> {
    let value = number(word)?;
    if value < 1.0 {
        return Err(WordError::NoFeed(word.to_owned()));
    }
    Ok(value)
}

pub(super) fn spindle_speed(word: &str) -> Result<f64, WordError> {
    let value = number(word)?;
    if value < 0.0 {
        Err(WordError::NegativeSpeed)
    } else {
        Ok(value)
    }
}

/// Parses `on` and `off`.
pub fn switch(word: &str) -> Result<bool, WordError> {
    match word.trim() {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(WordError::NoSwitch),
    }
}

fn state(word: &str) -> Result<bool, WordError> {
    match word.trim() {
        "0" => Ok(false),
        "1" => Ok(true),
        other => Err(WordError::NoState(other.to_owned())),
    }
}

pub(super) fn parameter(word: &str) -> Result<ParameterWord, WordError> {
    let (name, value) = word
        .split_once('=')
        .ok_or(WordError::FormLike("N=V | N.B=0|1", "22=3800, 1.4=1"))?;
    let name = name.trim();
    let name = name.strip_prefix('P').unwrap_or(name);
    let parse = |digits: &str| {
        digits
            .parse::<u16>()
            .map_err(|_| WordError::NoParameter(digits.to_owned()))
    };
    let Some((number, bit)) = name.split_once('.') else {
        let number = parse(name)?;
        let value = value.trim();
        // The eight bits of a bit parameter, as the parameter page shows them.
        if value.len() == 8 && value.bytes().all(|byte| matches!(byte, b'0' | b'1')) {
            let value =
                i32::from_str_radix(value, 2).map_err(|_| WordError::NotWhole(value.to_owned()))?;
            return Ok(ParameterWord::Value { number, value });
        }
        let value = value
            .parse()
            .map_err(|_| WordError::NotWhole(value.to_owned()))?;
        return Ok(ParameterWord::Value { number, value });
    };
    let number = parse(number)?;
    let bit = bit.parse().ok().filter(|bit| *bit < 8);
    let bit = bit.ok_or(WordError::NoBit)?;
    Ok(ParameterWord::Bit {
        number,
        bit,
        state: state(value)?,
    })
}

pub(super) fn offset(word: &str) -> Result<OffsetWord, WordError> {
    let (name, values) = word
        .split_once('=')
        .ok_or(WordError::FormLike("NN=X,Z,R,T", "1=0,0,0.4,3"))?;
    let name = name.trim();
    let number_of = name
        .parse()
        .map_err(|_| WordError::NoOffset(name.to_owned()))?;
    let words: Vec<&str> = values.split(',').collect();
    if words.len() > 4 {
        return Err(WordError::TooManyValues);
    }
    let value = |index: usize| words.get(index).map_or(Ok(0.0), |word| number(word));
    let nose = words.get(3).map_or("0", |word| word.trim());
    let nose = nose.parse().ok().filter(|nose| *nose <= 9);
    Ok(OffsetWord {
        number: number_of,
        x: value(0)?,
        z: value(1)?,
        radius: value(2)?,
        nose: nose.ok_or(WordError::NoNose)?,
    })
}

/// Parses `X0.4=1`.
pub fn input_bit(word: &str) -> Result<InputBit, WordError> {
    let (address, value) = word
        .split_once('=')
        .ok_or(WordError::FormLike("X0.4=0|1", "X0.4=1"))?;
    Ok(InputBit {
        address: address.trim().to_ascii_uppercase(),
        state: state(value)?,
    })
}

/// Parses a time such as `500ms`, `90s`, `1.5m`, `24h` to ms; without a unit it is in
/// seconds.
pub fn duration_ms(word: &str) -> Result<u64, WordError> {
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
        _ => return Err(WordError::NoUnit(unit.to_owned())),
    };
    let value = parse_finite(digits.trim()).ok_or_else(|| WordError::NoTime(word.to_owned()))?;
    let ms = value * unit_ms;
    if !(1.0..=1e12).contains(&ms) {
        return Err(WordError::UselessTime(word.to_owned()));
    }
    Ok(ms.round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drill_has_a_way_and_a_feed() {
        assert_eq!((travel("-50"), feed("600")), (Ok(-50.0), Ok(600.0)));
        for word in ["0", "0.05", "nan", "inf", "1e5", "x"] {
            assert!(travel(word).is_err(), "{word}");
        }
        for word in ["0", "0.5", "-100", "nan", "1e9", ""] {
            assert!(feed(word).is_err(), "{word}");
        }
    }

    #[test]
    fn parameters_come_as_value_as_bit_and_as_eight_bits() {
        assert_eq!(
            parameter("22=3800"),
            Ok(ParameterWord::Value {
                number: 22,
                value: 3800
            })
        );
        assert_eq!(
            parameter("45=-5"),
            Ok(ParameterWord::Value {
                number: 45,
                value: -5
            })
        );
        assert_eq!(
            parameter("001=00010000"),
            Ok(ParameterWord::Value {
                number: 1,
                value: 16
            })
        );
        assert_eq!(
            parameter("001.4=1"),
            Ok(ParameterWord::Bit {
                number: 1,
                bit: 4,
                state: true
            })
        );
        for wrong in ["22", "x=1", "1.8=1", "1.4=2", "22=1.5"] {
            assert!(parameter(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn offsets_may_be_short() {
        let word = offset("3=-1.5,2").expect("offset");
        assert_eq!(
            word,
            OffsetWord {
                number: 3,
                x: -1.5,
                z: 2.0,
                radius: 0.0,
                nose: 0
            }
        );
        assert!(offset("3=1,2,3,4,5").is_err());
        assert!(offset("3=0,0,0.4,12").is_err());
    }

    #[test]
    fn times_have_units() {
        assert_eq!(duration_ms("500ms"), Ok(500));
        assert_eq!(duration_ms("90"), Ok(90_000));
        assert_eq!(duration_ms("1.5m"), Ok(90_000));
        assert_eq!(duration_ms("24h"), Ok(86_400_000));
        assert!(duration_ms("3 days").is_err());
        assert!(duration_ms("-1s").is_err());
    }
}
