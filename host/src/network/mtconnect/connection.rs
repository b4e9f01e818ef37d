//! Serves one client: reads its requests and writes documents, streams and the page.

use std::io;
use std::sync::atomic::Ordering;

use gsk_mtconnect::query::{CurrentQuery, ErrorCode, SampleQuery};
use gsk_mtconnect::{Agent, AgentError, AgentRequest};
use web_time::{Duration, Instant};

use super::feed::wall_clock_ms;
use super::page;
use super::shared::SharedAgent;
use crate::network::http::{HttpConnection, HttpRequest, PAGE_POLICY};

/// Text that separates the documents of a stream.
const BOUNDARY: &str = "gsk980td-document";
const XML: &str = "text/xml; charset=utf-8";
const TEXT: &str = "text/plain; charset=utf-8";
const HTML: &str = "text/html; charset=utf-8";
const JSON: &str = "application/json";

/// Serves a client until it has gone or the agent ends.
pub(super) fn serve(mut connection: HttpConnection, shared: &SharedAgent) {
    while !shared.is_ended.load(Ordering::Relaxed) {
        let request = match connection.read_request() {
            Ok(request) => request,
            Err(error) => {
                if let Some((code, reason)) = error.refusal() {
                    // The client may be gone.
                    let _ = refuse(
                        &mut connection,
                        shared,
                        &AgentError::new(code, reason),
                        false,
                    );
                }
                return;
            }
        };
        let keeps_open = request.keeps_open;
        if answer(&mut connection, shared, &request).is_err() || !keeps_open {
            return;
        }
    }
}

/// Answers a request of a client. An error ends the connection.
fn answer(
    connection: &mut HttpConnection,
    shared: &SharedAgent,
    request: &HttpRequest,
) -> io::Result<()> {
    let keeps_open = request.keeps_open;
    if !shared.accepts_host(request.host.as_deref()) {
        let error = AgentError::new(
            ErrorCode::InvalidUri,
            "The agent serves this computer only, by its local name.",
        );
        return refuse(connection, shared, &error, keeps_open);
    }
    let language = request.page_language();
    match request.path.as_str() {
        "/" if request.accepts_html => {
            let html = page::render_page(language);
            return connection.write_response("200 OK", HTML, PAGE_POLICY, keeps_open, &html);
        }
        "/status.json" => {
            let status = shared.lock().status(language, wall_clock_ms());
            return connection.write_response("200 OK", JSON, "", keeps_open, &status);
        }
        path => {
            let program = path.strip_prefix("/programs/");
            let text = program.and_then(|name| shared.lock().program_text(name));
            if let Some(text) = text {
                return connection.write_response("200 OK", TEXT, "", keeps_open, &text);
            }
        }
    }
    let device = &shared.device;
    let parsed = AgentRequest::parse(&request.path, &request.query, device);
    let document = match parsed {
        Ok(AgentRequest::Sample(query)) if query.interval.is_some() => {
            return stream_samples(connection, shared, &query);
        }
        Ok(AgentRequest::Current(query)) if query.interval.is_some() => {
            return stream_current(connection, shared, &query);
        }
        Ok(request) => make_document(&shared.lock(), &request),
        Err(error) => Err(error),
    };
    match document {
        Ok(text) => connection.write_response("200 OK", XML, "", keeps_open, &text),
        Err(error) => refuse(connection, shared, &error, keeps_open),
    }
}

fn make_document(agent: &Agent, request: &AgentRequest) -> Result<String, AgentError> {
    let now_ms = wall_clock_ms();
    match request {
        AgentRequest::Probe => Ok(agent.probe(now_ms)),
        AgentRequest::Current(query) => agent.current(query, now_ms),
        AgentRequest::Sample(query) => {
            let document = agent.sample(query, None, now_ms)?;
            Ok(document.text)
        }
        AgentRequest::Assets(query) => agent.assets(query, now_ms),
    }
}

fn refuse(
    connection: &mut HttpConnection,
    shared: &SharedAgent,
    error: &AgentError,
    keeps_open: bool,
) -> io::Result<()> {
    let text = shared.lock().error(error, wall_clock_ms());
    let extra = match error.code {
        ErrorCode::Unsupported => "Allow: GET\r\n",
        _ => "",
    };
    connection.write_response(error.code.http_status(), XML, extra, keeps_open, &text)
}

/// Writes observations as they are recorded, each document at least the interval after the one
/// before. After the heartbeat without observations a document without observations follows.
fn stream_samples(
    connection: &mut HttpConnection,
    shared: &SharedAgent,
    query: &SampleQuery,
) -> io::Result<()> {
    let first = shared.lock().sample(query, None, wall_clock_ms());
    let mut document = match first {
        Ok(document) => document,
        Err(error) => return refuse(connection, shared, &error, false),
    };
    connection.begin_stream(BOUNDARY)?;
    let interval = query.interval.unwrap_or_default();
    loop {
        connection.write_part(BOUNDARY, &document.text)?;
        let sent = Instant::now();
        let mut next = document.next_sequence;
        let latest = sent + query.heartbeat.max(interval);
        document = loop {
            if !shared.wait_until(sent + interval, latest, next) {
                return Err(io::ErrorKind::ConnectionAborted.into());
            }
            let sample = shared.lock().sample(query, Some(next), wall_clock_ms());
            let sample = match sample {
                Ok(sample) => sample,
                // The client reads more slowly than the buffer forgets.
                Err(error) => {
                    let text = shared.lock().error(&error, wall_clock_ms());
                    connection.write_part(BOUNDARY, &text)?;
                    return Err(io::ErrorKind::ConnectionAborted.into());
                }
            };
            next = sample.next_sequence;
            if sample.has_observations || Instant::now() >= latest {
                break sample;
            }
        };
    }
}

/// Sends the current state repeatedly, as a stream.
fn stream_current(
    connection: &mut HttpConnection,
    shared: &SharedAgent,
    query: &CurrentQuery,
) -> io::Result<()> {
    connection.begin_stream(BOUNDARY)?;
    let interval = query.interval.unwrap_or(Duration::from_secs(1));
    loop {
        let document = shared.lock().current(query, wall_clock_ms());
        let Ok(text) = document else {
            return Err(io::ErrorKind::InvalidInput.into());
        };
        connection.write_part(BOUNDARY, &text)?;
        let due = Instant::now() + interval;
        if !shared.wait_until(due, due, u64::MAX) {
            return Err(io::ErrorKind::ConnectionAborted.into());
        }
    }
}
