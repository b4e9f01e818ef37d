//! Requests of a client, and why one is refused.

use core::time::Duration;

use crate::path_filter::select_items;

/// Greatest number of observations in one document.
pub const MAX_COUNT: usize = 4096;
/// Number of observations in a document if the client does not give one.
const DEFAULT_COUNT: usize = 100;
/// Time after which a stream sends a document without observations.
const DEFAULT_HEARTBEAT: Duration = Duration::from_secs(10);
/// Longest heartbeat of a stream, so that the agent notices when a client has disconnected.
const MAX_HEARTBEAT: Duration = Duration::from_secs(60);
/// Shortest time between two documents of a stream.
const MIN_INTERVAL: Duration = Duration::from_millis(10);
/// Longest time between two documents of a stream.
const MAX_INTERVAL: Duration = Duration::from_secs(60);

/// A request of a client to the agent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AgentRequest {
    /// The probe document, with the device model.
    Probe,
    /// The current values of the selected data items.
    Current(CurrentQuery),
    /// Observations from a sequence number on.
    Sample(SampleQuery),
    /// Assets: tools and program of the lathe.
    Assets(AssetQuery),
}

/// A request for the values of data items at one moment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CurrentQuery {
    /// Sequence number of the moment; `None` for the newest.
    pub at: Option<u64>,
    /// For each data item, by its index, whether it is selected; `None` selects all.
    pub items: Option<Vec<bool>>,
    /// Time between the documents of a stream; `None` for a single document.
    pub interval: Option<Duration>,
}

/// A request for observations from the buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleQuery {
    /// Sequence number of the first observation; `None` for the oldest.
    pub from: Option<u64>,
    /// Sequence number of the last observation; `None` for the newest.
    pub to: Option<u64>,
    /// Greatest number of observations in the document.
    pub count: usize,
    /// For each data item, by its index, whether it is selected; `None` selects all.
    pub items: Option<Vec<bool>>,
    /// Shortest time between the documents of a stream; `None` for a single document.
    pub interval: Option<Duration>,
    /// Time after which a stream sends a document without observations.
    pub heartbeat: Duration,
}

/// A request for assets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetQuery {
    /// Identifiers of the requested assets; empty for all assets.
    pub ids: Vec<String>,
    /// Type of the requested assets; `None` for all types.
    pub asset_type: Option<String>,
    /// Whether the document also lists removed assets.
    pub with_removed: bool,
    /// Greatest number of assets in the document.
    pub count: usize,
}

/// The MTConnect error code of a refused request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorCode {
    /// The request names a device that is not the lathe.
    NoDevice,
    /// A number in the request is outside its range.
    OutOfRange,
    /// The address names no document of the agent.
    InvalidUri,
    /// A parameter of the request cannot be parsed.
    InvalidRequest,
    /// The XPath expression of the request cannot be parsed.
    InvalidPath,
    /// The HTTP method is not `GET`.
    Unsupported,
    /// An asset with the requested identifier is not stored.
    AssetNotFound,
    /// Too many clients are connected.
    TooMany,
}

impl ErrorCode {
    /// Returns the word of the MTConnect standard for the error, such as `NO_DEVICE`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoDevice => "NO_DEVICE",
            Self::OutOfRange => "OUT_OF_RANGE",
            Self::InvalidUri => "INVALID_URI",
            Self::InvalidRequest => "INVALID_REQUEST",
            Self::InvalidPath => "INVALID_PATH",
            Self::Unsupported => "UNSUPPORTED",
            Self::AssetNotFound => "ASSET_NOT_FOUND",
            Self::TooMany => "TOO_MANY",
        }
    }

    /// Returns the status line of the HTTP response, such as `404 Not Found`.
    pub const fn http_status(self) -> &'static str {
        match self {
            Self::NoDevice | Self::InvalidUri | Self::AssetNotFound => "404 Not Found",
            Self::OutOfRange | Self::InvalidRequest | Self::InvalidPath => "400 Bad Request",
            Self::Unsupported => "405 Method Not Allowed",
            Self::TooMany => "503 Service Unavailable",
        }
    }
}

/// A refused request: its error code, with the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AgentError {
    /// The MTConnect error code.
    pub code: ErrorCode,
    /// Explanation of the refusal for the client, one sentence.
    pub reason: String,
}

impl AgentError {
    /// Creates a refusal with its reason.
    pub fn new(code: ErrorCode, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { code, reason }
    }
}

impl AgentRequest {
    /// Parses the path and the query of an address, without `?`. `device` is the name of the
    /// lathe, which may precede the document: `/lathe/current`.
    ///
    /// # Errors
    /// The address names no document, or a parameter is wrong.
    pub fn parse(path: &str, query: &str, device: &str) -> Result<Self, AgentError> {
        let path = decode(path)?;
        let parameters = Parameters::parse(query)?;
        let mut words: Vec<&str> = path.split('/').filter(|word| !word.is_empty()).collect();
        let is_document =
            |word: &str| matches!(word, "probe" | "current" | "sample" | "asset" | "assets");
        if let [first, rest @ ..] = words.as_slice()
            && !is_document(first)
        {
            let names_document = rest.first().is_none_or(|word| is_document(word));
            if *first != device && names_document {
                let reason = format!("There is no device `{first}`.");
                return Err(AgentError::new(ErrorCode::NoDevice, reason));
            }
            words.remove(0);
        }
        match words.as_slice() {
            [] | ["probe"] => Ok(Self::Probe),
            ["current"] => Ok(Self::Current(parameters.to_current()?)),
            ["sample"] => Ok(Self::Sample(parameters.to_sample()?)),
            ["asset" | "assets"] => Ok(Self::Assets(parameters.to_assets(Vec::new())?)),
            ["asset" | "assets", ids] => {
                let ids = ids.split(';').map(str::to_owned).collect();
                Ok(Self::Assets(parameters.to_assets(ids)?))
            }
            _ => {
                let reason = format!("There is no document `{path}`.");
                Err(AgentError::new(ErrorCode::InvalidUri, reason))
            }
        }
    }
}

/// The parameters after `?` in an address, decoded, as pairs of name and value.
struct Parameters(Vec<(String, String)>);

impl Parameters {
    fn parse(query: &str) -> Result<Self, AgentError> {
        let pairs = query.split('&').filter(|pair| !pair.is_empty());
        let decoded = pairs.map(|pair| {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            Ok((decode(name)?, decode(&value.replace('+', " "))?))
        });
        decoded.collect::<Result<_, AgentError>>().map(Self)
    }

    fn text(&self, name: &str) -> Option<&str> {
        let mut pairs = self.0.iter();
        pairs.find_map(|(own, value)| (own == name).then_some(value.as_str()))
    }

    /// Returns the number of a parameter; `None` if the address does not have the parameter.
    fn number(&self, name: &str) -> Result<Option<u64>, AgentError> {
        let Some(text) = self.text(name) else {
            return Ok(None);
        };
        let is_number =
            |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        match text.parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) if is_number(text.strip_prefix('-').unwrap_or(text)) => Err(AgentError::new(
                ErrorCode::OutOfRange,
                format!("`{name}` is out of range: {text}."),
            )),
            Err(_) => Err(AgentError::new(
                ErrorCode::InvalidRequest,
                format!("`{name}` is not a number: {text}."),
            )),
        }
    }

    fn items(&self) -> Result<Option<Vec<bool>>, AgentError> {
        let selected = self.text("path").map(select_items).transpose();
        selected.map_err(|reason| AgentError::new(ErrorCode::InvalidPath, reason))
    }

    fn interval(&self) -> Result<Option<Duration>, AgentError> {
        let interval = self.number("interval")?.map(Duration::from_millis);
        Ok(interval.map(|interval| interval.clamp(MIN_INTERVAL, MAX_INTERVAL)))
    }

    /// Returns the parameter `count`, from 1 to `largest`, or `default` without it; a larger number
    /// is reduced.
    fn count(&self, default: usize, largest: usize) -> Result<usize, AgentError> {
        match self.number("count")? {
            Some(0) => Err(AgentError::new(
                ErrorCode::OutOfRange,
                "`count` must be at least 1.",
            )),
            Some(count) => Ok(usize::try_from(count).unwrap_or(largest).min(largest)),
            None => Ok(default),
        }
    }

    fn to_current(&self) -> Result<CurrentQuery, AgentError> {
        let query = CurrentQuery {
            at: self.number("at")?,
            items: self.items()?,
            interval: self.interval()?,
        };
        if query.at.is_some() && query.interval.is_some() {
            return Err(AgentError::new(
                ErrorCode::InvalidRequest,
                "`at` and `interval` exclude each other.",
            ));
        }
        Ok(query)
    }

    fn to_sample(&self) -> Result<SampleQuery, AgentError> {
        let heartbeat = self.number("heartbeat")?.map(Duration::from_millis);
        Ok(SampleQuery {
            from: self.number("from")?,
            to: self.number("to")?,
            count: self.count(DEFAULT_COUNT, MAX_COUNT)?,
            items: self.items()?,
            interval: self.interval()?,
            heartbeat: heartbeat
                .unwrap_or(DEFAULT_HEARTBEAT)
                .clamp(MIN_INTERVAL, MAX_HEARTBEAT),
        })
    }

    fn to_assets(&self, ids: Vec<String>) -> Result<AssetQuery, AgentError> {
        Ok(AssetQuery {
            ids,
            asset_type: self.text("type").map(str::to_owned),
            with_removed: self.text("removed") == Some("true"),
            count: self.count(DEFAULT_COUNT, MAX_COUNT)?,
        })
    }
}

/// Decodes percent escapes such as `%41`.
fn decode(text: &str) -> Result<String, AgentError> {
    let malformed = || {
        let reason = "The address has a malformed `%`.";
        AgentError::new(ErrorCode::InvalidUri, reason)
    };
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let mut digit = || char::from(rest.next()?).to_digit(16);
        let (high, low) = digit().zip(digit()).ok_or_else(malformed)?;
        bytes.push((high * 16 + low) as u8);
    }
    String::from_utf8(bytes).map_err(|_| malformed())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(path: &str, query: &str) -> ErrorCode {
        let refused = AgentRequest::parse(path, query, "lathe");
        refused.expect_err(query).code
    }

    #[test]
    fn addresses_name_documents() {
        let parse = |path: &str, query: &str| AgentRequest::parse(path, query, "lathe");
        assert_eq!(parse("/", ""), Ok(AgentRequest::Probe));
        assert_eq!(parse("/lathe", ""), Ok(AgentRequest::Probe));
        assert_eq!(parse("/lathe/probe", "x=1"), Ok(AgentRequest::Probe));
        let Ok(AgentRequest::Sample(query)) = parse(
            "/lathe/sample",
            "from=7&count=99999&interval=0&path=%2f%2FAxes",
        ) else {
            panic!("a sample");
        };
        assert_eq!((query.from, query.count), (Some(7), MAX_COUNT));
        assert_eq!(query.interval, Some(MIN_INTERVAL));
        assert!(query.items.is_some_and(|items| items.contains(&true)));
        let Ok(AgentRequest::Assets(query)) = parse("/asset/T01;T02", "removed=true") else {
            panic!("assets");
        };
        assert_eq!(query.ids, ["T01", "T02"]);
        assert!(query.with_removed);
    }

    #[test]
    fn wrong_addresses_are_refused() {
        assert_eq!(code("/mill/current", ""), ErrorCode::NoDevice);
        assert_eq!(code("/mill", ""), ErrorCode::NoDevice);
        assert_eq!(code("/current/x", ""), ErrorCode::InvalidUri);
        assert_eq!(code("/a/b/c", ""), ErrorCode::InvalidUri);
        assert_eq!(code("/%f", ""), ErrorCode::InvalidUri);
        assert_eq!(code("/%ff", ""), ErrorCode::InvalidUri);
        assert_eq!(code("/sample", "count=0"), ErrorCode::OutOfRange);
        assert_eq!(code("/sample", "count=-5"), ErrorCode::OutOfRange);
        assert_eq!(
            code("/sample", "from=18446744073709551616"),
            ErrorCode::OutOfRange
        );
        assert_eq!(code("/sample", "from=first"), ErrorCode::InvalidRequest);
        assert_eq!(
            code("/current", "at=1&interval=5"),
            ErrorCode::InvalidRequest
        );
        assert_eq!(code("/current", "path=Axes"), ErrorCode::InvalidPath);
    }
}
