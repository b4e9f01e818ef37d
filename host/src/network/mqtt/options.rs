//! Parses the options of MQTT; finds the password.

use std::path::Path;

use gsk_messages::{Message, say};
use gsk_telemetry::{BrokerUrl, BrokerUrlError};

use crate::platform;

/// Name of the environment variable with the password.
pub const PASSWORD_VARIABLE: &str = "GSK980TD_MQTT_PASSWORD";
/// Documents of one topic in a second, unless an option says otherwise.
pub const DEFAULT_RATE_HZ: u32 = 4;
/// Greatest number of documents of one topic in a second: that of the states.
pub const MAX_RATE_HZ: u32 = 50;
/// Greatest size of a file with a password, bytes.
const MAX_PASSWORD_BYTES: u64 = 4096;

/// A value of an option of MQTT that cannot be parsed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum MqttOptionError {
    /// Not the address of a broker.
    Broker(BrokerUrlError),
    /// Not a number of documents in a second.
    Rate(String),
}

impl MqttOptionError {
    /// The message that names the word and the expected form.
    pub fn message(&self) -> Message {
        match self {
            Self::Broker(error) => error.message(),
            Self::Rate(word) => say::mqtt_rate_wrong(word),
        }
    }
}

/// Parses the address of a broker. Returns an error for another text.
pub fn parse_broker(word: &str) -> Result<BrokerUrl, MqttOptionError> {
    BrokerUrl::parse(word).map_err(MqttOptionError::Broker)
}

/// Parses the number of documents in a second. Returns an error for another text.
pub fn parse_rate(word: &str) -> Result<u32, MqttOptionError> {
    let rate = word.parse().ok();
    let rate = rate.filter(|rate| (1..=MAX_RATE_HZ).contains(rate));
    rate.ok_or_else(|| MqttOptionError::Rate(word.to_owned()))
}

/// Completes an address with the password in a file or in the environment.
///
/// # Errors
/// The file cannot be read.
pub fn read_password(url: &mut BrokerUrl, file: Option<&Path>) -> Result<(), Message> {
    if let Some(path) = file {
        let unreadable = |error| say::mqtt_password_unreadable(path.display(), error);
        let bytes = platform::read(path, MAX_PASSWORD_BYTES).map_err(unreadable)?;
        let text = String::from_utf8_lossy(&bytes);
        url.password = Some(text.trim_end_matches(['\r', '\n']).to_owned());
    } else if url.password.is_none() {
        url.password = std::env::var(PASSWORD_VARIABLE).ok();
    }
    Ok(())
}
