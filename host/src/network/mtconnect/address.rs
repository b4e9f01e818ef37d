//! Parses the options of the agent.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use gsk_messages::{Message, say};
use gsk_mtconnect::SchemaVersion;

/// Address at which the agent listens if none is named: this computer only.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:5000";
/// Port at which the agent listens if the address has none.
const DEFAULT_PORT: u16 = 5000;

/// A value of an option of the agent that cannot be parsed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum AgentOptionError {
    /// The text is not an address at which the agent can listen.
    Address(String),
    /// Not a version in whose schemas the documents are valid.
    Schema(String),
}

impl AgentOptionError {
    /// The message that names the word and the possible ones.
    pub fn message(&self) -> Message {
        match self {
            Self::Address(word) => say::mtconnect_address_wrong(word),
            Self::Schema(word) => {
                let versions = SchemaVersion::ALL.map(|version| version.to_string());
                say::mtconnect_schema_unknown(word, versions.join(", "))
            }
        }
    }
}

/// Parses `IP`, `IP:PORT`, `localhost` or `localhost:PORT`. Returns an error for another text.
pub fn parse_address(word: &str) -> Result<String, AgentOptionError> {
    let numeric = match word.strip_prefix("localhost") {
        Some(rest) => format!("{}{rest}", Ipv4Addr::LOCALHOST),
        None => word.to_owned(),
    };
    let address = (numeric.parse::<SocketAddr>().ok()).or_else(|| {
        let ip: IpAddr = numeric.parse().ok()?;
        Some(SocketAddr::new(ip, DEFAULT_PORT))
    });
    let address = address.ok_or_else(|| AgentOptionError::Address(word.to_owned()))?;
    Ok(address.to_string())
}

/// Parses the version of the schemas. Returns an error for a version that the agent does not have.
pub fn parse_schema(word: &str) -> Result<SchemaVersion, AgentOptionError> {
    SchemaVersion::from_text(word).ok_or_else(|| AgentOptionError::Schema(word.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_have_an_ip_and_a_port() {
        for (word, address) in [
            ("127.0.0.1", "127.0.0.1:5000"),
            ("0.0.0.0:80", "0.0.0.0:80"),
            ("localhost:7000", "127.0.0.1:7000"),
            ("::1", "[::1]:5000"),
            ("[::1]:5001", "[::1]:5001"),
        ] {
            assert_eq!(parse_address(word).as_deref(), Ok(address));
        }
        for word in [
            "",
            "shaft.CNC",
            "5000",
            "127.0.0.1:",
            "127.0.0.1:x",
            "localhosts",
        ] {
            assert!(parse_address(word).is_err(), "{word}");
        }
        assert!(parse_schema("1.8").is_ok() && parse_schema("2.6").is_err());
    }
}
