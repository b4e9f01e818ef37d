//! Options of `mill`: calculations for the setup of a GSK980MDi.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use gsk_host::setup_args::{OptionValueError, parse_number};

/// Subcommands of the command `mill`.
#[derive(Debug, Subcommand)]
pub enum MillCommand {
    /// The electronic gear of an axis: parameters 015 and 016
    Gear(GearArgs),
    /// Corrections of positions by the pitch error table: parameters 3620 to 3624
    Pitch(PitchArgs),
    /// Speed of backlash compensation: parameter 010
    Backlash(BacklashArgs),
    /// Decode the pressed keys from diagnosis numbers 016 to 024; without numbers list all keys
    Keys(MillKeysArgs),
    /// Homing method of an axis: absolute encoder, method D, switches
    Homing(HomingArgs),
    /// The pins of CN15 to CN78 with their addresses, or the rows with certain words
    Io(MillSearchArgs),
    /// The diagnosis numbers, or the rows with certain words
    Diagnosis(MillSearchArgs),
    /// The steps of the spindle set-up with their parameters, or those with certain words
    Spindle(MillSearchArgs),
    /// The steps of the reference return with their parameters, or those with certain words
    Reference(MillSearchArgs),
}

/// Arguments of the commands that show a table of the machine.
#[derive(Args, Debug)]
pub struct MillSearchArgs {
    /// Words to search for: X0.5, CN61, DECX, 3741, brake
    #[arg(value_name = "TEXT")]
    pub words: Vec<String>,
}

/// Arguments of the command `mill gear`.
#[derive(Args, Debug)]
pub struct GearArgs {
    /// Counts of the encoder per turn; for an incremental encoder four times its lines
    #[arg(long, value_name = "COUNTS")]
    pub counts: u32,
    /// Lead of the ball screw, mm
    #[arg(long, value_name = "MM", required_unless_present = "pulses", value_parser = parse_number)]
    pub lead: Option<f64>,
    /// Pulses per turn, for a rotary axis or a spindle
    #[arg(long, value_name = "PULSES", conflicts_with = "lead")]
    pub pulses: Option<u32>,
    /// Output increment, mm: 0.001, or 0.0001 (001.1 = 1)
    #[arg(long, value_name = "MM", default_value_t = 0.001, value_parser = parse_number)]
    pub increment: f64,
    /// Teeth on the screw or the table, on the motor
    #[arg(long, value_name = "ZM,ZD", default_value = "1,1", value_parser = parse_teeth)]
    pub teeth: (u32, u32),
}

/// Arguments of the command `mill pitch`.
#[derive(Args, Debug)]
pub struct PitchArgs {
    /// Positions from the reference point, mm (degrees)
    #[arg(value_name = "POSITION", allow_negative_numbers = true, value_parser = parse_number)]
    pub positions: Vec<f64>,
    /// The axis of the table: X, Y, Z, A, B or C; a file that names another one is refused
    #[arg(long, value_name = "AXIS", value_parser = parse_axis)]
    pub axis: Option<char>,
    /// 3620: point number at the reference point
    #[arg(long, value_name = "N")]
    pub origin: i64,
    /// 3624: interval between points, mm (degrees)
    #[arg(long, value_name = "MM", value_parser = parse_number)]
    pub interval: f64,
    /// 3621, 3622: smallest and greatest point number
    #[arg(long, value_name = "N,N", default_value = "0,1023", value_parser = parse_window)]
    pub window: (i64, i64),
    /// Values of the table, 0.001 mm: 58=-7 (may be repeated)
    #[arg(long = "value", value_name = "N=V", allow_hyphen_values = true, value_parser = parse_value)]
    pub values: Vec<(i64, i64)>,
    /// A Renishaw text whose values are added: axis, spacing (mm), backlash (µm), then lines
    /// of position and value, or of number, position and value (mm, µm)
    #[arg(long, value_name = "FILE")]
    pub ren: Option<PathBuf>,
    /// Write the table to a file in the same form
    #[arg(long, value_name = "FILE")]
    pub export: Option<PathBuf>,
    /// 1260: one turn of a rotary axis, degrees; checks that the intervals of the table divide it
    #[arg(long, value_name = "DEGREES", value_parser = parse_number)]
    pub turn: Option<f64>,
}

/// Arguments of the command `mill backlash`.
#[derive(Args, Debug)]
pub struct BacklashArgs {
    /// Parameter 010, its bits CPF7 to CPF0: 00001010
    #[arg(value_name = "BITS", value_parser = parse_bits)]
    pub bits: u8,
    /// 011.6 = 1: an eighth of the backlash at a time
    #[arg(long)]
    pub eighth: bool,
}

/// Arguments of the command `mill keys`.
#[derive(Args, Debug)]
pub struct MillKeysArgs {
    /// Diagnosis numbers with their bits: 016=01001000
    #[arg(value_name = "N=BITS", value_parser = parse_key_bits)]
    pub shown: Vec<(u16, u8)>,
}

fn parse_key_bits(word: &str) -> Result<(u16, u8), OptionValueError> {
    let (number, shown) = word
        .split_once('=')
        .ok_or(OptionValueError::InvalidKeyBits)?;
    let number = number
        .parse()
        .map_err(|_| OptionValueError::InvalidKeyBits)?;
    Ok((number, parse_bits(shown)?))
}

/// Arguments of the command `mill homing`.
#[derive(Args, Debug)]
pub struct HomingArgs {
    /// File with the parameters of a machine, one per line: N=V, N=00001000 or N.B=0|1; add 10000
    /// (X) to 50000 (fifth axis) to the number of an axis parameter. Prints the homing method of
    /// each axis
    #[arg(long, value_name = "FILE")]
    pub params: Option<PathBuf>,
    /// One parameter, instead of the file or in addition to it (may be repeated)
    #[arg(long = "param", value_name = "N=V")]
    pub values: Vec<String>,
}

/// Letters that an axis of a mill can have.
pub const MILL_AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

fn parse_axis(word: &str) -> Result<char, OptionValueError> {
    let letter = word.to_ascii_uppercase().parse().ok();
    let known = letter.filter(|letter| MILL_AXES.contains(letter));
    known.ok_or(OptionValueError::UnknownAxis)
}

fn parse_bits(word: &str) -> Result<u8, OptionValueError> {
    let digits = word.len() == 8 && word.bytes().all(|byte| matches!(byte, b'0' | b'1'));
    let value = digits.then(|| u8::from_str_radix(word, 2).ok()).flatten();
    value.ok_or(OptionValueError::NotEightBits)
}

fn parse_pair<T: core::str::FromStr>(
    word: &str,
    between: char,
) -> Result<(T, T), OptionValueError> {
    let wrong = || OptionValueError::NotTwoNumbers(between);
    let (first, second) = word.split_once(between).ok_or_else(wrong)?;
    let read = |text: &str| text.trim().parse().map_err(|_| wrong());
    Ok((read(first)?, read(second)?))
}

fn parse_teeth(word: &str) -> Result<(u32, u32), OptionValueError> {
    parse_pair(word, ',')
}

fn parse_window(word: &str) -> Result<(i64, i64), OptionValueError> {
    parse_pair(word, ',')
}

fn parse_value(word: &str) -> Result<(i64, i64), OptionValueError> {
    parse_pair(word, '=')
}
