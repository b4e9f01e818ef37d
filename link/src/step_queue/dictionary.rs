//! Decodes the dictionary of a board: its commands, replies, pins and constants.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;
use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use super::block;
use super::commands::{COMMANDS, Command, REPLIES, Reply, ReplyKind, Requirement};

/// Greatest length of a compressed dictionary, bytes.
pub(super) const LONGEST_PACKED: usize = 1 << 17;
/// Greatest length of an uncompressed dictionary, bytes.
const LONGEST: usize = 1 << 20;
/// Message number of the command `identify`, the same in all boards.
const IDENTIFY: i64 = 1;
const IDENTIFY_RESPONSE: u32 = 0;

/// The type of a parameter in a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Parameter {
    Number,
    Bytes,
}

#[derive(Clone, Debug, PartialEq)]
struct Form {
    kind: Option<ReplyKind>,
    parameters: Vec<Parameter>,
}

/// The dictionary of a board: numbers and formats of its messages, and its constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dictionary {
    ids: Vec<Option<i64>>,
    replies: BTreeMap<u32, Form>,
    pins: BTreeMap<String, u32>,
    texts: BTreeMap<u32, String>,
    constants: BTreeMap<String, Value>,
    /// Format texts of all messages by their number: of commands to the board, and of replies from
    /// it.
    forms: [BTreeMap<u32, String>; 2],
    pub(super) version: String,
}

/// The JSON object in a dictionary text.
#[derive(Deserialize)]
struct Written {
    #[serde(default)]
    commands: BTreeMap<String, i64>,
    #[serde(default)]
    responses: BTreeMap<String, i64>,
    #[serde(default)]
    enumerations: BTreeMap<String, BTreeMap<String, Value>>,
    #[serde(default)]
    config: BTreeMap<String, Value>,
    #[serde(default)]
    version: String,
}

impl Default for Dictionary {
    /// Creates the dictionary before the opening: `identify` and its response only.
    fn default() -> Self {
        let ids = COMMANDS
            .iter()
            .map(|(command, ..)| (*command == Command::Identify).then_some(IDENTIFY));
        let response = Form {
            kind: Some(ReplyKind::Identify),
            parameters: vec![Parameter::Number, Parameter::Bytes],
        };
        Self {
            ids: ids.collect(),
            replies: BTreeMap::from([(IDENTIFY_RESPONSE, response)]),
            pins: BTreeMap::new(),
            texts: BTreeMap::new(),
            constants: BTreeMap::new(),
            forms: [
                BTreeMap::from([(IDENTIFY as u32, COMMANDS[0].2.to_owned())]),
                BTreeMap::from([(IDENTIFY_RESPONSE, REPLIES[0].2.to_owned())]),
            ],
            version: String::new(),
        }
    }
}

/// The reason for which a dictionary is invalid.
#[derive(Debug, Error)]
#[error("{}", self.message())]
pub(super) enum DictionaryError {
    /// The bytes are not valid zlib data, or their content is too long.
    Packed,
    /// The decompressed text is not the JSON of a dictionary.
    Json(#[from] serde_json::Error),
    /// The reply with this name has parameters of an unknown type.
    Reply(String),
    /// The range of pins with this name is not valid.
    Pins(String),
}

impl DictionaryError {
    /// Returns the message about the error in the dictionary.
    pub(super) fn message(&self) -> Message {
        match self {
            Self::Packed => say::dictionary_packed_wrong(),
            Self::Json(error) => say::dictionary_wrong(error),
            Self::Reply(reply) => say::dictionary_reply_wrong(reply),
            Self::Pins(pins) => say::dictionary_pins_wrong(pins),
        }
    }
}

/// The signals in the machine file that need commands which not every board has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct WiredSignals {
    /// The spindle speed output.
    pub(super) speed: bool,
    /// The one-turn signal of the spindle at a counter.
    pub(super) index: bool,
    /// The encoder of the spindle.
    pub(super) encoder: bool,
    /// The encoder of an axis.
    pub(super) axis_encoder: bool,
    /// The handwheel.
    pub(super) wheel: bool,
}

impl Dictionary {
    /// Decompresses and parses a dictionary.
    ///
    /// # Errors
    ///
    /// Returns an error with the reason if the dictionary is invalid.
    pub(super) fn unpack(packed: &[u8]) -> Result<Self, DictionaryError> {
        let text = decompress_to_vec_zlib_with_limit(packed, LONGEST)
            .map_err(|_| DictionaryError::Packed)?;
        Self::read(&text)
    }

    fn read(text: &[u8]) -> Result<Self, DictionaryError> {
        let written: Written = serde_json::from_slice(text)?;
        let mut replies = BTreeMap::new();
        for (text, id) in &written.responses {
            let kind = REPLIES.iter().find(|(.., known)| known == text);
            let form = Form {
                kind: kind.map(|(kind, ..)| *kind),
                parameters: parameters(text)?,
            };
            replies.insert(*id as u32, form);
        }
        let forms = [&written.commands, &written.responses].map(|texts| {
            texts
                .iter()
                .map(|(text, id)| (*id as u32, text.clone()))
                .collect()
        });
        let enumeration = |name: &str| written.enumerations.get(name);
        let mut texts = BTreeMap::new();
        for (text, id) in enumeration("static_string_id").into_iter().flatten() {
            if let Some(id) = id.as_u64().and_then(|id| u32::try_from(id).ok()) {
                texts.insert(id, text.clone());
            }
        }
        Ok(Self {
            ids: COMMANDS
                .iter()
                .map(|(.., text)| written.commands.get(*text).copied())
                .collect(),
            replies,
            pins: pins(enumeration("pin"))?,
            texts,
            constants: written.config,
            forms,
            version: written.version,
        })
    }

    /// Returns the format text of the first required command or reply that the board does not have;
    /// `None` if it has all. `wired` tells what the machine file wires.
    pub(super) fn missing(&self, wired: WiredSignals) -> Option<&'static str> {
        let wanted = |need: &Requirement| match need {
            Requirement::Always => true,
            Requirement::Speed => wired.speed,
            Requirement::Index => wired.index,
            Requirement::Angle => wired.encoder,
            Requirement::AxisEncoder => wired.axis_encoder,
            Requirement::Wheel => wired.wheel,
            Requirement::Restart | Requirement::Optional => false,
        };
        let has = |text: &str| {
            let known = REPLIES.iter().find(|(.., known)| *known == text);
            self.replies
                .values()
                .any(|form| form.kind.is_some() && form.kind == known.map(|(kind, ..)| *kind))
        };
        let commands = COMMANDS
            .iter()
            .filter(|(command, need, _)| wanted(need) && !self.has(*command))
            .map(|(.., text)| *text);
        let replies = REPLIES
            .iter()
            .filter(|(_, need, text)| wanted(need) && !has(text))
            .map(|(.., text)| *text);
        let restart =
            (!self.has(Command::Reset) && !self.has(Command::ConfigReset)).then_some("reset");
        commands.chain(replies).chain(restart).next()
    }

    /// Whether the board knows a command.
    pub(super) fn has(&self, command: Command) -> bool {
        self.id(command).is_some()
    }

    fn id(&self, command: Command) -> Option<i64> {
        self.ids.get(command as usize).copied().flatten()
    }

    /// Returns a command encoded with its arguments; empty if the board does not have the command.
    pub(super) fn message(&self, command: Command, arguments: &[i64]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(16);
        if let Some(id) = self.id(command) {
            block::encode_vlq(&mut bytes, id);
            for argument in arguments {
                block::encode_vlq(&mut bytes, *argument);
            }
        }
        bytes
    }

    /// Returns the format text of a message by its number; `None` for an unknown number.
    /// `outward`: the message goes to the board.
    pub(super) fn form(&self, outward: bool, id: u32) -> Option<&str> {
        self.forms[usize::from(!outward)]
            .get(&id)
            .map(String::as_str)
    }

    /// Returns the replies in the content of a block that the link uses, and skips the others;
    /// `None` if the content is invalid.
    pub(super) fn replies(&self, mut content: &[u8]) -> Option<Vec<Reply>> {
        let mut replies = Vec::new();
        while !content.is_empty() {
            let form = self.replies.get(&block::decode_vlq(&mut content)?)?;
            let mut numbers = [0; 4];
            let mut data = Vec::new();
            for (index, parameter) in form.parameters.iter().enumerate() {
                match parameter {
                    Parameter::Number => {
                        let number = block::decode_vlq(&mut content)?;
                        if let Some(slot) = numbers.get_mut(index) {
                            *slot = number;
                        }
                    }
                    Parameter::Bytes => {
                        let (&count, rest) = content.split_first()?;
                        data = rest.get(..usize::from(count))?.to_vec();
                        content = &rest[usize::from(count)..];
                    }
                }
            }
            if let Some(kind) = form.kind {
                replies.push(Reply {
                    kind,
                    numbers,
                    data,
                });
            }
        }
        Some(replies)
    }

    /// Returns the number of the pin with this name; `None` for an unknown pin.
    pub(super) fn pin(&self, name: &str) -> Option<u32> {
        self.pins.get(name).copied()
    }

    /// Returns the text of a shutdown reason by its number; `text` and the number for an unknown
    /// one.
    pub(super) fn text(&self, id: u32) -> String {
        match self.texts.get(&id) {
            Some(text) => text.clone(),
            None => format!("text {id}"),
        }
    }

    /// Returns a constant of the board by its name; `None` if it is unknown or not a number of 32
    /// bits.
    pub(super) fn constant(&self, name: &str) -> Option<u32> {
        let value = self.constants.get(name)?;
        u32::try_from(value.as_u64()?).ok()
    }

    /// Returns the purpose for which the board reserves a pin, from constants like
    /// `RESERVE_PINS_serial`; `None` for a free pin.
    pub(super) fn reserved(&self, pin: &str) -> Option<&str> {
        self.constants.iter().find_map(|(name, value)| {
            let purpose = name.strip_prefix("RESERVE_PINS_")?;
            let mut pins = value.as_str()?.split(',');
            pins.any(|reserved| reserved.trim() == pin)
                .then_some(purpose)
        })
    }

    /// Returns the name of the board's processor; empty if unknown.
    pub(super) fn processor(&self) -> &str {
        let name = self.constants.get("MCU").and_then(Value::as_str);
        name.unwrap_or_default()
    }
}

fn parameters(text: &str) -> Result<Vec<Parameter>, DictionaryError> {
    let kind = |word: &str| match word.split_once('=').map(|(_, kind)| kind) {
        Some("%c" | "%u" | "%i" | "%hu" | "%hi") => Ok(Parameter::Number),
        Some("%s" | "%*s" | "%.*s") => Ok(Parameter::Bytes),
        _ => Err(DictionaryError::Reply(text.to_owned())),
    };
    text.split_whitespace().skip(1).map(kind).collect()
}

/// Returns the numbers of the pins of a dictionary by their names; `"PA0": [0, 8]` stands for PA0
/// to PA7. An error names an invalid range.
fn pins(
    written: Option<&BTreeMap<String, Value>>,
) -> Result<BTreeMap<String, u32>, DictionaryError> {
    /// Greatest number of pins in one range of names.
    const MOST: u64 = 1024;
    let mut pins = BTreeMap::new();
    for (name, value) in written.into_iter().flatten() {
        if let Some(number) = value.as_u64().and_then(|number| u32::try_from(number).ok()) {
            pins.insert(name.clone(), number);
            continue;
        }
        let range = value.as_array().and_then(|range| match range.as_slice() {
            [first, count] => Some((first.as_u64()?, count.as_u64()?)),
            _ => None,
        });
        let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let from: Option<u64> = name[stem.len()..].parse().ok();
        let (Some((first, count)), Some(from)) = (range, from) else {
            return Err(DictionaryError::Pins(name.clone()));
        };
        if count > MOST || first > MOST * MOST || from > MOST * MOST {
            return Err(DictionaryError::Pins(name.clone()));
        }
        for index in 0..count {
            pins.insert(format!("{stem}{}", from + index), (first + index) as u32);
        }
    }
    Ok(pins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ALL_WIRED: WiredSignals = WiredSignals {
        speed: true,
        index: true,
        encoder: true,
        axis_encoder: true,
        wheel: true,
    };

    fn all_commands(first: i64) -> String {
        let pair = |(index, text): (usize, &str)| format!("\"{text}\": {}", first - index as i64);
        let commands = COMMANDS
            .iter()
            .map(|(.., text)| *text)
            .enumerate()
            .map(pair);
        let replies = REPLIES.iter().map(|(.., text)| *text).enumerate().map(pair);
        format!(
            r#"{{"commands": {{{}}}, "responses": {{{}}}, "enumerations": {{"pin": {{"PA0": [0, 8], "PL0": 80}},
               "static_string_id": {{"Timer too close": 3}}}}, "config": {{"CLOCK_FREQ": 16000000, "MCU": "atmega2560"}}, "version": "v1"}}"#,
            commands.collect::<Vec<_>>().join(","),
            replies.collect::<Vec<_>>().join(",")
        )
    }

    #[test]
    fn a_dictionary_is_read() {
        let board = Dictionary::read(all_commands(20).as_bytes()).unwrap();
        assert_eq!(board.missing(ALL_WIRED), None);
        assert_eq!((board.pin("PA7"), board.pin("PL0")), (Some(7), Some(80)));
        assert_eq!((board.pin("PA8"), board.pin("PB0")), (None, None));
        assert_eq!(board.constant("CLOCK_FREQ"), Some(16_000_000));
        assert_eq!(board.processor(), "atmega2560");
        assert_eq!(board.text(3), "Timer too close");
        assert_eq!(board.text(4), "text 4");
    }

    #[test]
    fn a_board_with_the_older_dictionary_is_complete() {
        let text = all_commands(20).replace("angle_error oid=%c error=%u", "other_reply oid=%c");
        let board = Dictionary::read(text.as_bytes()).unwrap();
        assert_eq!(board.missing(ALL_WIRED), None);
    }

    #[test]
    fn a_command_that_differs_by_a_letter_is_named() {
        let text = all_commands(20).replace("count=%hu add=%hi", "count=%hu add=%i");
        let board = Dictionary::read(text.as_bytes()).unwrap();
        assert_eq!(
            board.missing(WiredSignals::default()),
            Some("queue_step oid=%c interval=%u count=%hu add=%hi")
        );
        let text = all_commands(20).replace("uptime high=%u", "uptime high=%i");
        let board = Dictionary::read(text.as_bytes()).unwrap();
        assert_eq!(
            board.missing(WiredSignals::default()),
            Some("uptime high=%u clock=%u")
        );
        let text = all_commands(20)
            .replace("\"reset\"", "\"reset_\"")
            .replace("\"config_reset\"", "\"x\"");
        let board = Dictionary::read(text.as_bytes()).unwrap();
        assert_eq!(board.missing(WiredSignals::default()), Some("reset"));
    }

    #[test]
    fn invalid_dictionaries_are_refused() {
        for text in [
            "{",
            r#"{"responses": {"stats x=%q": 1}}"#,
            r#"{"enumerations": {"pin": {"PA": [0, 8]}}}"#,
            r#"{"enumerations": {"pin": {"PA0": [0, 99999999]}}}"#,
        ] {
            assert!(Dictionary::read(text.as_bytes()).is_err(), "{text}");
        }
        assert!(Dictionary::unpack(b"no zlib").is_err());
    }

    #[test]
    fn replies_are_distinguished() {
        let board = Dictionary::read(all_commands(-5).as_bytes()).unwrap();
        let mut content = Vec::new();
        for number in [-5 - 2, 1, 99, -5 - 9, -5 - 3, 0, -7] {
            block::encode_vlq(&mut content, number);
        }
        let kinds: Vec<ReplyKind> = board
            .replies(&content)
            .unwrap()
            .iter()
            .map(|reply| reply.kind)
            .collect();
        assert_eq!(
            kinds,
            [ReplyKind::Uptime, ReplyKind::Starting, ReplyKind::Position]
        );
        assert_eq!(board.replies(&content).unwrap()[2].numbers[1] as i32, -7);
        assert_eq!(board.replies(&content[..2]), None);
    }

    proptest! {
        #[test]
        fn commands_are_encoded_with_any_message_numbers(first in -40_000i64..40_000, arguments in prop::collection::vec(any::<u32>(), 4)) {
            let board = Dictionary::read(all_commands(first).as_bytes()).unwrap();
            let arguments: Vec<i64> = arguments.into_iter().map(i64::from).collect();
            let bytes = board.message(Command::QueueStep, &arguments);
            let mut rest = bytes.as_slice();
            prop_assert_eq!(block::decode_vlq(&mut rest), Some((first - Command::QueueStep as i64) as u32));
            for argument in arguments {
                prop_assert_eq!(block::decode_vlq(&mut rest), Some(argument as u32));
            }
            prop_assert!(rest.is_empty());
        }

        #[test]
        fn any_content_is_read_or_refused(content in prop::collection::vec(any::<u8>(), 0..60)) {
            let board = Dictionary::read(all_commands(60).as_bytes()).unwrap();
            let _ = board.replies(&content);
            let _ = Dictionary::unpack(&content);
        }
    }
}
