//! Code, broker and topics of a class.

use core::fmt;

use gsk_messages::{Message, say};
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};

use crate::broker_url::{BrokerUrl, BrokerUrlError};

/// The bytes of a class that a link encodes.
const ENCODED_IN_LINK: &AsciiSet = &CONTROLS.add(b' ').add(b'%').add(b'+').add(b'&').add(b'#');
/// Start of the topics of an address without a prefix.
const DEFAULT_PREFIX: &str = "gsk980td/class";
/// Shortest and longest code.
const CODE_LENGTHS: core::ops::RangeInclusive<usize> = 3..=24;

/// Why a text is not the address or the code of a class.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ClassAddressError {
    /// Not of the form `CODE@BROKER`.
    Malformed(String),
    /// Not a code.
    Code(String),
    /// The broker is wrong.
    Broker(BrokerUrlError),
}

impl ClassAddressError {
    /// The message that names the text and the expected form.
    pub fn message(&self) -> Message {
        match self {
            Self::Malformed(word) => say::class_address_wrong(word),
            Self::Code(word) => say::class_code_wrong(word),
            Self::Broker(error) => error.message(),
        }
    }
}

/// The code of a class: capital letters and digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassCode(String);

impl fmt::Display for ClassCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl ClassCode {
    /// Parses a code; small letters count as capital ones.
    ///
    /// # Errors
    /// The text has other characters, or too few or too many.
    pub fn parse(text: &str) -> Result<Self, ClassAddressError> {
        let is_code = CODE_LENGTHS.contains(&text.len())
            && text.bytes().all(|byte| byte.is_ascii_alphanumeric());
        match is_code {
            true => Ok(Self(text.to_ascii_uppercase())),
            false => Err(ClassAddressError::Code(text.to_owned())),
        }
    }
}

/// A class at a broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassAddress {
    /// Code of the class.
    pub code: ClassCode,
    /// The broker through which its seats report.
    pub broker: BrokerUrl,
}

impl ClassAddress {
    /// Parses `CODE@BROKER`; the broker may name a user: `CODE@mqtt://ann@host`.
    ///
    /// # Errors
    /// There is no code, or the broker is malformed.
    pub fn parse(text: &str) -> Result<Self, ClassAddressError> {
        let malformed = || ClassAddressError::Malformed(text.to_owned());
        let (code, broker) = text.split_once('@').ok_or_else(malformed)?;
        Ok(Self {
            code: ClassCode::parse(code)?,
            broker: BrokerUrl::parse(broker).map_err(ClassAddressError::Broker)?,
        })
    }

    /// Parses what a learner pastes: a class, or the link of a page for browsers that names one
    /// after `class=`.
    ///
    /// # Errors
    /// There is no class in the text.
    pub fn from_pasted(text: &str) -> Result<Self, ClassAddressError> {
        let text = text.trim();
        let Some((_, class)) = text.split_once("class=") else {
            return Self::parse(text);
        };
        let class = class.split(['&', '#']).next().unwrap_or_default();
        let decoded = percent_decode_str(class).decode_utf8_lossy();
        Self::parse(&decoded)
    }

    /// The class as a seat joins it, without the password.
    pub fn join_text(&self) -> String {
        format!("{}@{}", self.code, self.broker.without_password())
    }

    /// The link with which the page for browsers at `page` joins the class.
    pub fn join_link(&self, page: &str) -> String {
        let separator = if page.contains('?') { '&' } else { '?' };
        let class = self.join_text();
        let class = utf8_percent_encode(&class, ENCODED_IN_LINK);
        format!("{page}{separator}class={class}")
    }

    /// The topics of the class.
    pub fn topics(&self) -> ClassTopics {
        let prefix = match self.broker.prefix.as_str() {
            "" => DEFAULT_PREFIX,
            prefix => prefix,
        };
        ClassTopics {
            root: format!("{prefix}/{}", self.code),
        }
    }
}

/// What a topic of a seat contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeatTopicKind {
    /// The report of the seat, retained.
    State,
    /// The outline of the part, retained.
    Part,
    /// The LCD, while the instructor watches it.
    Lcd,
    /// A sealed result, retained until the instructor has stored it.
    Result,
    /// The answer to a request.
    Answer,
    /// A request of the instructor.
    Request,
}

impl SeatTopicKind {
    const ALL: [(&'static str, Self); 6] = [
        ("state", Self::State),
        ("part", Self::Part),
        ("lcd", Self::Lcd),
        ("result", Self::Result),
        ("answer", Self::Answer),
        ("request", Self::Request),
    ];

    fn level(self) -> &'static str {
        let name = Self::ALL.iter().find(|(_, kind)| *kind == self);
        name.map_or("", |(name, _)| name)
    }
}

/// The topics of a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassTopics {
    root: String,
}

impl ClassTopics {
    /// A topic of a seat.
    pub fn seat(&self, seat: &str, kind: SeatTopicKind) -> String {
        format!("{}/seats/{seat}/{}", self.root, kind.level())
    }

    /// The topics to which the view of the class subscribes. Requests are its own.
    pub fn subscriptions(&self) -> Vec<String> {
        let kinds = SeatTopicKind::ALL.iter();
        let kinds = kinds.filter(|(_, kind)| *kind != SeatTopicKind::Request);
        kinds.map(|(_, kind)| self.seat("+", *kind)).collect()
    }

    /// Seat and content of a topic; `None` for another topic.
    pub fn split<'a>(&self, topic: &'a str) -> Option<(&'a str, SeatTopicKind)> {
        let rest = topic.strip_prefix(&self.root)?.strip_prefix("/seats/")?;
        let (seat, level) = rest.split_once('/')?;
        let is_seat = !seat.is_empty()
            && seat.len() <= 40
            && seat.bytes().all(|byte| byte.is_ascii_alphanumeric());
        let kind = SeatTopicKind::ALL.iter().find(|(name, _)| *name == level)?;
        is_seat.then_some((seat, kind.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_is_a_code_at_a_broker() {
        let class = ClassAddress::parse("k7m2@mqtt://ann:pw@host/school").expect("a class");
        assert_eq!(class.code.to_string(), "K7M2");
        assert_eq!(class.broker.user.as_deref(), Some("ann"));
        let topics = class.topics();
        let topic = topics.seat("a1", SeatTopicKind::State);
        assert_eq!(topic, "school/K7M2/seats/a1/state");
        assert_eq!(topics.split(&topic), Some(("a1", SeatTopicKind::State)));
        let plain = ClassAddress::parse("ABC@host").expect("a class").topics();
        assert_eq!(
            plain.seat("a1", SeatTopicKind::Lcd),
            "gsk980td/class/ABC/seats/a1/lcd"
        );
        for topic in ["", "school/K7M2/seats/a1", "school/K7M2/seats/a/b/state"] {
            assert_eq!(topics.split(topic), None);
        }
        assert_eq!(topics.split("other/K7M2/seats/a1/state"), None);
        let subscribed = topics.subscriptions();
        assert!(subscribed.iter().all(|it| !it.ends_with("/request")));
    }

    #[test]
    fn a_pasted_class_or_link_joins() {
        let class = ClassAddress::parse("K7M2@ws://a%40nn:pw@host/school").expect("a class");
        let text = class.join_text();
        assert_eq!(text, "K7M2@ws://a%40nn@host:9001/school");
        for page in ["http://pc:8080/", "http://pc/gsk/?lang=zh"] {
            let link = class.join_link(page);
            let read = ClassAddress::from_pasted(&format!(" {link}\n")).expect("a class");
            assert_eq!(read.join_text(), text, "{link}");
        }
        let read = ClassAddress::from_pasted(&text).expect("a class");
        assert_eq!(read.broker.user.as_deref(), Some("a@nn"));
        assert!(ClassAddress::from_pasted("http://pc/?lang=zh").is_err());
    }

    #[test]
    fn other_words_are_refused() {
        for word in [
            "",
            "host",
            "@host",
            "ab@host",
            "a-b-c@host",
            "ABC@",
            "ABC@host:x",
        ] {
            assert!(ClassAddress::parse(word).is_err(), "{word}");
        }
    }
}
