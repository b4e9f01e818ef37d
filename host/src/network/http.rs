//! Reads requests and writes responses of HTTP/1.1, with limits of size and time.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, TcpStream};

use gsk_messages::Language;
use gsk_mtconnect::query::ErrorCode;
use web_time::{Duration, Instant};

/// Greatest size of an HTTP request, bytes.
const MAX_REQUEST_BYTES: usize = 8192;
/// Greatest number of header lines in a request.
const MAX_HEADERS: usize = 48;
/// Longest time from the first byte of a request to its end.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest time that a connection may remain open without a request.
const IDLE_TIMEOUT: Duration = Duration::from_secs(15);
/// Longest time in which a client must take a response.
const RESPONSE_TIMEOUT: Duration = Duration::from_secs(20);
/// Longest time in which a client must take the next bytes.
const WRITE_TIMEOUT: Duration = Duration::from_secs(5);
/// HTTP header that restricts what a page may load: itself and the state.
pub(super) const PAGE_POLICY: &str = "Content-Security-Policy: default-src 'none'; \
    style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'\r\n";

/// An HTTP request of a client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct HttpRequest {
    pub(super) path: String,
    /// The part of the address after `?`.
    pub(super) query: String,
    /// Whether the client prefers HTML, as browsers do.
    pub(super) accepts_html: bool,
    /// The language of the browser; `None` if it names none.
    pub(super) language: Option<Language>,
    /// The host that the client has addressed; `None` if it names none.
    pub(super) host: Option<String>,
    /// Whether the connection remains open after the response.
    pub(super) keeps_open: bool,
}

impl HttpRequest {
    /// The language of a page: of the address, else of the browser.
    pub(super) fn page_language(&self) -> Language {
        let mut pairs = self.query.split('&');
        match pairs.find_map(|pair| pair.strip_prefix("lang=")) {
            Some("zh") => Language::Zh,
            Some("en") => Language::En,
            _ => self.language.unwrap_or(Language::En),
        }
    }
}

/// Whether a host name, with or without a port, is one of this computer alone. A listener for this
/// computer accepts no other, so that no page of another site reads it through a browser.
pub(super) fn is_local_name(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let is_local = |address: IpAddr| address.is_loopback();
    name.eq_ignore_ascii_case("localhost")
        || (name.trim_matches(['[', ']']).parse()).is_ok_and(is_local)
}

/// The reason why no request was read from a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadError {
    /// The client has gone, or was silent for too long.
    Gone,
    /// The request is malformed or too large.
    Malformed,
    /// The method of the request is not `GET`.
    Method,
}

impl ReadError {
    /// The refusal that the client receives; `None` for a client that has gone.
    pub(super) const fn refusal(self) -> Option<(ErrorCode, &'static str)> {
        match self {
            Self::Gone => None,
            Self::Malformed => Some((ErrorCode::InvalidRequest, "The request is malformed.")),
            Self::Method => Some((ErrorCode::Unsupported, "The agent only answers GET.")),
        }
    }
}

/// The agent's end of the connection to a client.
pub(super) struct HttpConnection {
    stream: TcpStream,
    /// Received bytes that belong to the next request.
    received: Vec<u8>,
}

impl HttpConnection {
    /// Prepares an accepted connection.
    ///
    /// # Errors
    /// The system refuses its options.
    pub(super) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok(Self {
            stream,
            received: Vec::new(),
        })
    }

    /// Reads the next request.
    ///
    /// # Errors
    /// The client has gone, or its request is refused.
    pub(super) fn read_request(&mut self) -> Result<HttpRequest, ReadError> {
        let mut deadline = Instant::now() + IDLE_TIMEOUT;
        let mut has_begun = false;
        loop {
            if !self.received.is_empty() {
                if !has_begun {
                    has_begun = true;
                    deadline = Instant::now() + REQUEST_TIMEOUT;
                }
                if let Some((request, length)) = parse_request(&self.received)? {
                    self.received.drain(..length);
                    return Ok(request);
                }
                if self.received.len() >= MAX_REQUEST_BYTES {
                    return Err(ReadError::Malformed);
                }
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.stream.set_read_timeout(Some(left)).is_err() {
                return Err(ReadError::Gone);
            }
            let mut bytes = [0; 1024];
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(ReadError::Gone),
                Ok(count) => self.received.extend_from_slice(&bytes[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return Err(ReadError::Gone),
            }
        }
    }

    /// Writes a whole response; `extra` are header lines with their ends.
    ///
    /// # Errors
    /// The client has gone or reads too slowly.
    pub(super) fn write_response(
        &mut self,
        status: &str,
        content_type: &str,
        extra: &str,
        keeps_open: bool,
        body: &str,
    ) -> io::Result<()> {
        let connection = if keeps_open { "keep-alive" } else { "close" };
        let mut bytes = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {}\r\n\
             Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n{extra}\
             Connection: {connection}\r\n\r\n",
            body.len()
        )
        .into_bytes();
        bytes.extend_from_slice(body.as_bytes());
        self.write_all(&bytes)
    }

    /// Writes the header of a stream of documents with this boundary.
    ///
    /// # Errors
    /// The client has gone or reads too slowly.
    pub(super) fn begin_stream(&mut self, boundary: &str) -> io::Result<()> {
        let header = format!(
            "HTTP/1.1 200 OK\r\n\
             Content-Type: multipart/x-mixed-replace;boundary={boundary}\r\n\
             Cache-Control: no-store\r\nConnection: close\r\n\r\n"
        );
        self.write_all(header.as_bytes())
    }

    /// Writes a document of a stream.
    ///
    /// # Errors
    /// The client has gone or reads too slowly.
    pub(super) fn write_part(&mut self, boundary: &str, document: &str) -> io::Result<()> {
        let mut bytes = format!(
            "--{boundary}\r\nContent-type: text/xml\r\nContent-length: {}\r\n\r\n",
            document.len()
        )
        .into_bytes();
        bytes.extend_from_slice(document.as_bytes());
        bytes.extend_from_slice(b"\r\n");
        self.write_all(&bytes)
    }

    fn write_all(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        let deadline = Instant::now() + RESPONSE_TIMEOUT;
        while !bytes.is_empty() {
            match self.stream.write(bytes) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
            if Instant::now() > deadline {
                return Err(ErrorKind::TimedOut.into());
            }
        }
        Ok(())
    }
}

/// Parses a request; `None` if more bytes are needed. Also returns its length.
fn parse_request(bytes: &[u8]) -> Result<Option<(HttpRequest, usize)>, ReadError> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let length = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(_) => return Err(ReadError::Malformed),
    };
    if parsed.method != Some("GET") {
        return Err(ReadError::Method);
    }
    let header = |name: &str| {
        let mut headers = parsed.headers.iter();
        let found = headers.find(|header| header.name.eq_ignore_ascii_case(name))?;
        core::str::from_utf8(found.value).ok().map(str::trim)
    };
    let has_body = header("transfer-encoding").is_some()
        || header("content-length").is_some_and(|length| length != "0");
    if has_body {
        return Err(ReadError::Malformed);
    }
    let target = parsed.path.unwrap_or("/");
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let connection = header("connection").unwrap_or_default();
    let keeps_open = match parsed.version {
        Some(0) => connection.eq_ignore_ascii_case("keep-alive"),
        _ => !connection.eq_ignore_ascii_case("close"),
    };
    let request = HttpRequest {
        path: path.to_owned(),
        query: query.to_owned(),
        accepts_html: header("accept").is_some_and(|accept| accept.contains("text/html")),
        language: header("accept-language").map(accepted_language),
        host: header("host").map(str::to_owned),
        keeps_open,
    };
    Ok(Some((request, length)))
}

/// The first language of the header that the page has.
fn accepted_language(header: &str) -> Language {
    let languages = header.split(',').map(str::trim);
    let known = languages.filter(|it| it.starts_with("zh") || it.starts_with("en"));
    match known.map(|it| it.starts_with("zh")).next() {
        Some(true) => Language::Zh,
        _ => Language::En,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_read_with_its_headers() {
        let bytes = b"GET /sample?from=1 HTTP/1.1\r\nHost: localhost:5000\r\n\
            Accept: text/html,*/*\r\nAccept-Language: fr, zh-CN;q=0.8, en\r\n\r\nGET";
        let (request, length) = parse_request(bytes).expect("valid").expect("whole");
        assert_eq!(length, bytes.len() - 3);
        assert_eq!((&*request.path, &*request.query), ("/sample", "from=1"));
        assert!(request.accepts_html && request.keeps_open);
        assert_eq!(request.language, Some(Language::Zh));
        assert_eq!(request.host.as_deref(), Some("localhost:5000"));
    }

    #[test]
    fn writing_methods_bodies_and_noise_are_refused() {
        for (bytes, error) in [
            ("PUT / HTTP/1.1\r\n\r\n", ReadError::Method),
            ("POST /sample HTTP/1.1\r\n\r\n", ReadError::Method),
            (
                "GET / HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc",
                ReadError::Malformed,
            ),
            ("\u{1}\u{2}\r\n\r\n", ReadError::Malformed),
        ] {
            assert_eq!(parse_request(bytes.as_bytes()), Err(error), "{bytes}");
        }
        let many = format!(
            "GET / HTTP/1.1\r\n{}\r\n",
            "a: b\r\n".repeat(MAX_HEADERS + 1)
        );
        assert_eq!(parse_request(many.as_bytes()), Err(ReadError::Malformed));
        assert_eq!(parse_request(b"GET / HTTP/1.1\r\nHost:"), Ok(None));
    }
}
