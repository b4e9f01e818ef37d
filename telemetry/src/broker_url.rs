//! Parses the address of a broker: `mqtt://user:pass@host:1883/prefix`.

use core::fmt;
use std::path::PathBuf;

use gsk_messages::{Message, say};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

/// The bytes of a user name that an address encodes: all but letters, digits and `-_.`.
const ENCODED_IN_USER: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.');
/// Longest prefix of topics, bytes.
const MAX_PREFIX: usize = 200;

/// Why a text is not the address of a broker.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum BrokerUrlError {
    /// Not of the form `mqtt://HOST:PORT/PREFIX`.
    Malformed(String),
    /// The prefix has a wildcard, or an empty level.
    Prefix(String),
}

impl BrokerUrlError {
    /// The message that names the text and the expected form.
    pub fn message(&self) -> Message {
        match self {
            Self::Malformed(word) => say::mqtt_url_wrong(word),
            Self::Prefix(word) => say::mqtt_prefix_wrong(word),
        }
    }
}

/// What carries the bytes to a broker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrokerTransport {
    /// TCP without encryption: `mqtt://`.
    Tcp,
    /// TLS: `mqtts://`.
    Tls,
    /// A WebSocket, the only connection that a page in a browser has: `ws://`.
    WebSocket,
    /// A WebSocket with TLS: `wss://`.
    SecureWebSocket,
}

impl BrokerTransport {
    /// The transport of a scheme; `None` for another word.
    fn from_scheme(scheme: &str) -> Option<Self> {
        match scheme {
            "mqtt" | "tcp" => Some(Self::Tcp),
            "mqtts" | "ssl" => Some(Self::Tls),
            "ws" => Some(Self::WebSocket),
            "wss" => Some(Self::SecureWebSocket),
            _ => None,
        }
    }

    /// The scheme in an address.
    const fn scheme(self) -> &'static str {
        match self {
            Self::Tcp => "mqtt",
            Self::Tls => "mqtts",
            Self::WebSocket => "ws",
            Self::SecureWebSocket => "wss",
        }
    }

    /// The port if the address has none: that of MQTT, for WebSocket that of Mosquitto's examples
    /// and that of HTTPS.
    pub const fn default_port(self) -> u16 {
        match self {
            Self::Tcp => 1883,
            Self::Tls => 8883,
            Self::WebSocket => 9001,
            Self::SecureWebSocket => 443,
        }
    }

    /// Whether a page in a browser can use it; a program on a computer can use the others.
    pub const fn is_web_socket(self) -> bool {
        matches!(self, Self::WebSocket | Self::SecureWebSocket)
    }
}

/// The address of a broker, with user and prefix of the topics.
#[derive(Clone, PartialEq, Eq)]
pub struct BrokerUrl {
    /// What carries the bytes.
    pub transport: BrokerTransport,
    /// Name or IP address of the computer.
    pub host: String,
    /// Port of the broker.
    pub port: u16,
    /// User name; `None` without one.
    pub user: Option<String>,
    /// Password; `None` without one.
    pub password: Option<String>,
    /// Start of all topics, without a slash at its ends; empty if the address has none.
    pub prefix: String,
    /// File with the certificates of the authorities that TLS trusts; `None`: those of the system.
    /// It is not part of the address.
    pub ca_file: Option<PathBuf>,
}

impl fmt::Debug for BrokerUrl {
    /// A log must not contain the password.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for BrokerUrl {
    /// Writes the address without user and password.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = self.transport.scheme();
        match self.host.contains(':') {
            true => write!(f, "{scheme}://[{}]:{}", self.host, self.port)?,
            false => write!(f, "{scheme}://{}:{}", self.host, self.port)?,
        }
        if !self.prefix.is_empty() {
            write!(f, "/{}", self.prefix)?;
        }
        Ok(())
    }
}

impl BrokerUrl {
    /// The address with its user and without its password, as settings store it.
    pub fn without_password(&self) -> String {
        let address = self.to_string();
        match (&self.user, address.split_once("://")) {
            (Some(user), Some((scheme, rest))) => {
                format!(
                    "{scheme}://{}@{rest}",
                    utf8_percent_encode(user, ENCODED_IN_USER)
                )
            }
            _ => address,
        }
    }

    /// Parses `mqtt://USER:PASSWORD@HOST:PORT/PREFIX`, also with `mqtts`, `ws` and `wss`;
    /// everything but the host may be missing.
    ///
    /// # Errors
    /// The text is not an address, or has a wildcard in its prefix.
    pub fn parse(text: &str) -> Result<Self, BrokerUrlError> {
        let malformed = || BrokerUrlError::Malformed(hide_password(text));
        let (transport, rest) = match text.split_once("://") {
            Some((scheme, rest)) => {
                let transport = BrokerTransport::from_scheme(scheme);
                (transport.ok_or_else(malformed)?, rest)
            }
            None => (BrokerTransport::Tcp, text),
        };
        let (authority, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let (user_info, address) = match authority.rsplit_once('@') {
            Some((user_info, address)) => (Some(user_info), address),
            None => (None, authority),
        };
        let (user, password) = match user_info.map(|it| it.split_once(':').unwrap_or((it, ""))) {
            Some((user, password)) => {
                let decode = |text| decode_percent(text).ok_or_else(malformed);
                let (user, password) = (decode(user)?, decode(password)?);
                let given = |text: String| (!text.is_empty()).then_some(text);
                (given(user), given(password))
            }
            None => (None, None),
        };
        let (host, port) = split_port(address, transport).ok_or_else(malformed)?;
        let prefix = decode_percent(prefix.trim_end_matches('/')).ok_or_else(malformed)?;
        if !is_topic_prefix(&prefix) {
            return Err(BrokerUrlError::Prefix(prefix));
        }
        Ok(Self {
            transport,
            host: host.to_owned(),
            port,
            user,
            password,
            prefix,
            ca_file: None,
        })
    }
}

/// Replaces the password in an address by dots.
fn hide_password(text: &str) -> String {
    let Some((before, host)) = text.rsplit_once('@') else {
        return text.to_owned();
    };
    let start = before.find("://").map_or(0, |at| at + 3);
    let user = before[start..].split(':').next().unwrap_or_default();
    format!("{}{user}:…@{host}", &before[..start])
}

/// Host and port of `HOST`, `HOST:PORT`, `[IPV6]` or `[IPV6]:PORT`; `None` for another text.
fn split_port(address: &str, transport: BrokerTransport) -> Option<(&str, u16)> {
    let (host, port) = match address.strip_prefix('[') {
        Some(rest) => {
            let (host, port) = rest.split_once(']')?;
            let is_ip = host.parse::<core::net::Ipv6Addr>().is_ok();
            let port = match port {
                "" => None,
                _ => Some(port.strip_prefix(':')?),
            };
            (is_ip.then_some(host)?, port)
        }
        None => match address.split_once(':') {
            Some((host, port)) => (host, Some(port)),
            None => (address, None),
        },
    };
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b".-_:".contains(&byte);
    if host.is_empty() || !host.bytes().all(is_name) {
        return None;
    }
    let port = match port {
        Some(port) => port.parse().ok().filter(|port| *port != 0)?,
        None => transport.default_port(),
    };
    Some((host, port))
}

/// Decodes `%41`; `None` for a malformed text.
fn decode_percent(text: &str) -> Option<String> {
    let is_hex = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_hexdigit);
    let mut escapes = text.split('%').skip(1).map(str::as_bytes);
    if !escapes.all(|it| is_hex(it.first()) && is_hex(it.get(1))) {
        return None;
    }
    let decoded = percent_decode_str(text).decode_utf8().ok()?;
    Some(decoded.into_owned())
}

/// Whether topics may begin with a text: no wildcard, no empty level, not reserved by brokers.
fn is_topic_prefix(prefix: &str) -> bool {
    let is_level = |level: &str| {
        let is_forbidden = |character: char| character.is_control() || "+#".contains(character);
        !level.is_empty() && !level.contains(is_forbidden)
    };
    prefix.is_empty()
        || (prefix.len() <= MAX_PREFIX
            && !prefix.starts_with('$')
            && prefix.split('/').all(is_level))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> (String, Option<String>, Option<String>) {
        let url = BrokerUrl::parse(text).expect(text);
        (url.to_string(), url.user, url.password)
    }

    #[test]
    fn every_part_but_the_host_may_be_missing() {
        let some = |text: &str| Some(text.to_owned());
        let whole = parse("mqtt://ann:s%3Acret@shop.local:1884/hall/lathe-3/");
        let address = "mqtt://shop.local:1884/hall/lathe-3".to_owned();
        assert_eq!(whole, (address, some("ann"), some("s:cret")));
        let plain = |text: &str| (text.to_owned(), None, None);
        assert_eq!(parse("broker"), plain("mqtt://broker:1883"));
        assert_eq!(parse("tcp://10.0.0.7:2000"), plain("mqtt://10.0.0.7:2000"));
        assert_eq!(parse("[::1]"), plain("mqtt://[::1]:1883"));
        assert_eq!(parse("mqtt://[::1]:7/a"), plain("mqtt://[::1]:7/a"));
        assert_eq!(parse("mqtts://broker/a"), plain("mqtts://broker:8883/a"));
        assert_eq!(parse("ssl://[::1]:2"), plain("mqtts://[::1]:2"));
        assert_eq!(parse("ws://broker"), plain("ws://broker:9001"));
        assert_eq!(parse("wss://broker/a"), plain("wss://broker:443/a"));
        assert_eq!(
            parse("ann@broker"),
            ("mqtt://broker:1883".to_owned(), some("ann"), None)
        );
    }

    #[test]
    fn malformed_addresses_are_refused_without_their_password() {
        for text in [
            "",
            "mqtt://",
            "http://host",
            "host:0",
            "host:70000",
            "host:",
            "ho st",
            "a:b@",
            "%zz@host",
            "[::1",
            "[host]:1",
            "host/%f",
        ] {
            assert!(
                matches!(BrokerUrl::parse(text), Err(BrokerUrlError::Malformed(_))),
                "{text}"
            );
        }
        for prefix in ["a/+/b", "#", "a//b", "$SYS"] {
            let parsed = BrokerUrl::parse(&format!("host/{prefix}"));
            assert_eq!(parsed, Err(BrokerUrlError::Prefix(prefix.to_owned())));
        }
        let error = BrokerUrl::parse("mqtts://ann:secret@host:0").expect_err("a port");
        let shown = "mqtts://ann:…@host:0".to_owned();
        assert_eq!(error, BrokerUrlError::Malformed(shown));
        let error = BrokerUrl::parse("ann:secret@host:0").expect_err("a port");
        assert_eq!(error, BrokerUrlError::Malformed("ann:…@host:0".to_owned()));
        let url = BrokerUrl::parse("a%40nn:secret@host").expect("an address");
        let stored = url.without_password();
        assert_eq!(stored, "mqtt://a%40nn@host:1883");
        let again = BrokerUrl::parse(&stored).expect("an address");
        assert_eq!(again.user.as_deref(), Some("a@nn"));
        assert!(!format!("{url:?}").contains("secret"));
    }
}
