//! What identifies the lathe, and its topics.

use gsk_messages::Language;
use gsk_mtconnect::DeviceDescription;

use crate::message::TelemetryMessage;

/// Last level of the topic that has `online` or `offline`.
const ONLINE_TOPIC: &str = "online";
/// Start of the topics of an address without a prefix.
const DEFAULT_PREFIX: &str = "gsk980td/lathe";

/// What identifies the lathe and its topics.
#[derive(Clone, Debug, PartialEq)]
pub struct LatheIdentity {
    /// Start of all topics.
    pub prefix: String,
    /// The lathe.
    pub description: DeviceDescription,
    /// Version of the program.
    pub version: &'static str,
    /// Language of the names in discovery topics.
    pub language: Language,
}

impl LatheIdentity {
    /// Identifies a lathe; an empty prefix means the default one.
    pub fn new(prefix: &str, description: DeviceDescription, language: Language) -> Self {
        let prefix = match prefix {
            "" => DEFAULT_PREFIX,
            _ => prefix,
        };
        Self {
            prefix: prefix.to_owned(),
            description,
            version: env!("CARGO_PKG_VERSION"),
            language,
        }
    }

    /// A topic of the lathe by its last level.
    pub(crate) fn topic(&self, level: &str) -> String {
        format!("{}/{level}", self.prefix)
    }

    /// The topic that has `online` or `offline`.
    pub(crate) fn online_topic(&self) -> String {
        self.topic(ONLINE_TOPIC)
    }

    /// The last will: the broker publishes it when the connection is lost.
    pub fn will(&self) -> TelemetryMessage {
        TelemetryMessage::retained(self.online_topic(), "offline")
    }
}
