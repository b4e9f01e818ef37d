//! Parses the directives of a ladder text: header, comments, messages and initial values.

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::address::{AddressError, Area, BitAddress, ByteAddress, parse_decimal, split_once_at};
use crate::diagnostic::{Rule, RuleViolation};

/// The information about the ladder that the version page shows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Name of the design unit in the header (`.UNIT`, 梯形图设计单位).
    pub unit: String,
    /// Name of the designer in the header (`.AUTHOR`, 梯形图设计者).
    pub author: String,
    /// Version of the ladder in the header (`.VERSION`, 梯形图版本号).
    pub version: String,
    /// Remark in the header (`.REMARK`, 备注).
    pub remark: String,
}

/// A message that the control shows while its request bit is 1 (`.MSG`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LadderMessage {
    /// Bit that requests the message while it is 1, in A0 to A24.
    pub bit: BitAddress,
    /// Number of the message that the control shows, 1000 to 9999.
    pub number: u16,
    /// Text of the message that the control shows.
    pub text: String,
}

/// An address of a bit, a byte or a 32-bit entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum PlcAddress {
    /// Address of a bit.
    Bit(BitAddress),
    /// Address of a byte or a 32-bit entry.
    Byte(ByteAddress),
}

/// The names of an address in both languages (`.CMT`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Comment {
    /// The address that gets the names.
    pub subject: PlcAddress,
    /// Chinese name of the address, at most 15 characters.
    pub chinese: String,
    /// English name of the address, at most 30 characters.
    pub english: String,
}

/// The initial value of an address in an empty retained memory (`.INIT`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartValue {
    /// Address of a byte of K or D, or of an entry of C, DC or DT.
    pub address: ByteAddress,
    /// Initial value: 0 to 255 for a byte, 0 to 2147483647 for an entry.
    pub value: i32,
}

/// An M code that the ladder implements in addition to those of the control (`.MCODE`).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MCode {
    /// Number of the M code, 0 to 99.
    pub code: u8,
    /// Description of the M code.
    pub text: String,
}

/// The title of the rungs that follow (`.NET`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NetworkTitle {
    /// Index of the first statement after the title, from 0.
    pub statement: usize,
    /// Text of the title that the following rungs get.
    pub title: String,
}

/// All directives (lines that begin with a dot) of a ladder text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Directives {
    pub header: Header,
    /// Whether the entries of CODB tables are numbered from 0 (`.OPT codb0`).
    pub table_from_0: bool,
    /// Whether level 2 runs as a whole in each slot instead of in parts (`.OPT n1`).
    pub undivided: bool,
    pub network_titles: Vec<NetworkTitle>,
    pub comments: Vec<Comment>,
    pub messages: Vec<LadderMessage>,
    pub start_values: Vec<StartValue>,
    pub m_codes: Vec<MCode>,
}

const MAX_CHINESE_CHARACTERS: usize = 15;
const MAX_ENGLISH_CHARACTERS: usize = 30;

/// Parses one directive line and adds its content to `directives`. `statement` is the
/// number of statements before the line.
pub(crate) fn parse(
    code: &str,
    statement: usize,
    directives: &mut Directives,
) -> Result<(), RuleViolation> {
    let tokens = split_tokens(code)?;
    let (name, arguments) = match tokens.split_first() {
        Some((Token::Word(name), arguments)) => (name.to_ascii_uppercase(), arguments),
        _ => {
            return Err((Rule::E00, say::ladder_directive_malformed()));
        }
    };
    match (name.as_str(), arguments) {
        (".UNIT", [Token::Text(text)]) => directives.header.unit = (*text).to_owned(),
        (".AUTHOR", [Token::Text(text)]) => directives.header.author = (*text).to_owned(),
        (".VERSION", [Token::Text(text)]) => directives.header.version = (*text).to_owned(),
        (".REMARK", [Token::Text(text)]) => directives.header.remark = (*text).to_owned(),
        (".OPT", [Token::Word(option)]) => set_option(option, directives)?,
        (".NET", [Token::Text(title)]) => directives.network_titles.push(NetworkTitle {
            statement,
            title: (*title).to_owned(),
        }),
        (
            ".CMT",
            [
                Token::Word(address),
                Token::Text(chinese),
                Token::Text(english),
            ],
        ) => {
            directives
                .comments
                .push(parse_comment(address, chinese, english)?);
        }
        (".MSG", [Token::Word(bit), Token::Word(number), Token::Text(text)]) => {
            let message = parse_message(bit, number, text, &directives.messages)?;
            directives.messages.push(message);
        }
        (".INIT", [Token::Word(address), Token::Word(value)]) => {
            directives
                .start_values
                .push(parse_start_value(address, value)?);
        }
        (".MCODE", [Token::Word(code), Token::Text(text)]) => {
            let code = parse_m_code(code, text, &directives.m_codes)?;
            directives.m_codes.push(code);
        }
        _ => return Err((Rule::E00, usage_message(&name))),
    }
    Ok(())
}

#[derive(Debug)]
enum Token<'a> {
    Word(&'a str),
    Text(&'a str),
}

fn split_tokens(code: &str) -> Result<Vec<Token<'_>>, RuleViolation> {
    let mut tokens = Vec::new();
    let mut rest = code.trim_start();
    while !rest.is_empty() {
        if let Some(quoted) = rest.strip_prefix('"') {
            let Some((text, after)) = split_once_at(quoted, b'"') else {
                return Err((Rule::E00, say::ladder_quote_missing()));
            };
            tokens.push(Token::Text(text));
            rest = after.trim_start();
            continue;
        }
        let end = rest
            .find(|c: char| c.is_whitespace() || c == '"')
            .unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        tokens.push(Token::Word(word));
        rest = after.trim_start();
    }
    Ok(tokens)
}

fn usage_message(name: &str) -> gsk_messages::Message {
    let form = match name {
        ".UNIT" | ".AUTHOR" | ".VERSION" | ".REMARK" | ".NET" => say::ladder_form_text(),
        ".OPT" => say::ladder_form_option(),
        ".CMT" => say::ladder_form_comment(),
        ".MSG" => say::ladder_form_message(),
        ".INIT" => say::ladder_form_start_value(),
        ".MCODE" => say::ladder_form_m_code(),
        _ => {
            return say::ladder_directive_unknown(name);
        }
    };
    say::ladder_directive_form(name, form)
}

fn set_option(option: &str, directives: &mut Directives) -> Result<(), RuleViolation> {
    match option.to_ascii_lowercase().as_str() {
        "codb0" => directives.table_from_0 = true,
        "n1" => directives.undivided = true,
        _ => {
            let message = say::ladder_option_unknown(option);
            return Err((Rule::E00, message));
        }
    }
    Ok(())
}

fn parse_comment(address: &str, chinese: &str, english: &str) -> Result<Comment, RuleViolation> {
    let subject = if address.contains('.') {
        address.parse().map(PlcAddress::Bit)
    } else {
        address.parse().map(PlcAddress::Byte)
    };
    let subject = subject.map_err(|error| (Rule::E03, error.message()))?;
    if chinese.chars().count() > MAX_CHINESE_CHARACTERS
        || english.chars().count() > MAX_ENGLISH_CHARACTERS
    {
        let message = say::ladder_comment_too_long(MAX_CHINESE_CHARACTERS, MAX_ENGLISH_CHARACTERS);
        return Err((Rule::E03, message));
    }
    Ok(Comment {
        subject,
        chinese: chinese.to_owned(),
        english: english.to_owned(),
    })
}

fn parse_message(
    bit: &str,
    number: &str,
    text: &str,
    messages: &[LadderMessage],
) -> Result<LadderMessage, RuleViolation> {
    let bit: BitAddress = bit
        .parse()
        .map_err(|error: AddressError| (Rule::E03, error.message()))?;
    if bit.area != Area::A {
        let message = say::ladder_message_bit_wrong(bit);
        return Err((Rule::E03, message));
    }
    let number = parse_decimal(number)
        .and_then(|number| u16::try_from(number).ok())
        .filter(|number| (1000..=9999).contains(number));
    let Some(number) = number else {
        return Err((Rule::E03, say::ladder_message_number_wrong()));
    };
    if messages.iter().any(|message| message.bit == bit) {
        return Err((Rule::E04, say::ladder_message_twice(bit)));
    }
    Ok(LadderMessage {
        bit,
        number,
        text: text.to_owned(),
    })
}

fn parse_m_code(code: &str, text: &str, codes: &[MCode]) -> Result<MCode, RuleViolation> {
    let code = parse_decimal(code)
        .and_then(|code| u8::try_from(code).ok())
        .filter(|code| *code <= 99);
    let Some(code) = code else {
        return Err((Rule::E03, say::ladder_m_code_wrong()));
    };
    if codes.iter().any(|known| known.code == code) {
        return Err((Rule::E04, say::ladder_m_code_twice(code)));
    }
    Ok(MCode {
        code,
        text: text.to_owned(),
    })
}

fn parse_start_value(address: &str, value: &str) -> Result<StartValue, RuleViolation> {
    let address: ByteAddress = address
        .parse()
        .map_err(|error: AddressError| (Rule::E03, error.message()))?;
    let largest = match address.area {
        Area::D | Area::K => 255,
        Area::C | Area::Dc | Area::Dt => i32::MAX,
        _ => {
            let message = say::ladder_start_value_area(address);
            return Err((Rule::E03, message));
        }
    };
    let value = parse_decimal(value)
        .and_then(|value| i32::try_from(value).ok())
        .filter(|value| *value <= largest);
    let Some(value) = value else {
        let message = say::ladder_start_value_wrong(address, largest);
        return Err((Rule::E03, message));
    };
    Ok(StartValue { address, value })
}
