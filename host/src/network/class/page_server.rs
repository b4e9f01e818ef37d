//! The page of a class: shows the tiles in a browser, without a way to request anything.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use gsk_messages::{Language, Message, say};
use gsk_telemetry::class::class_address::ClassCode;
use gsk_telemetry::class::class_page::write_page_state;
use gsk_telemetry::class::class_roster::ClassRoster;
use web_time::Duration;

use crate::message_format::describe_io_error;
use crate::network::http::{HttpConnection, HttpRequest, PAGE_POLICY, is_local_name};
use crate::platform::{self, TaskHandle};

/// The page; `{{name}}` is replaced by a text.
const TEMPLATE: &str = include_str!("../../../../assets/pages/class.html");
/// Where the page is if no address is named: this computer only.
pub const DEFAULT_PAGE_ADDRESS: &str = "127.0.0.1:5001";
/// Greatest number of connected browsers.
const MAX_CONNECTIONS: usize = 32;
/// Time between two checks for new browsers.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// What the threads of the page share.
struct SharedPage {
    roster: Arc<Mutex<ClassRoster>>,
    code: ClassCode,
    is_local: bool,
    is_ended: AtomicBool,
    connections: AtomicUsize,
}

/// The running page; it ends when it is dropped.
pub struct ClassPageServer {
    shared: Arc<SharedPage>,
    address: SocketAddr,
    task: Option<TaskHandle>,
}

impl ClassPageServer {
    /// Shows the seats of a roster at an address.
    ///
    /// # Errors
    /// The address does not belong to this computer, or is in use.
    pub(super) fn start(
        address: &str,
        code: ClassCode,
        roster: Arc<Mutex<ClassRoster>>,
    ) -> Result<Self, Message> {
        let refused =
            |error: io::Error| say::class_page_not_listening(address, describe_io_error(&error));
        let listener = TcpListener::bind(address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let local = listener.local_addr().map_err(refused)?;
        let shared = Arc::new(SharedPage {
            roster,
            code,
            is_local: local.ip().is_loopback(),
            is_ended: AtomicBool::new(false),
            connections: AtomicUsize::new(0),
        });
        let for_task = Arc::clone(&shared);
        let task = platform::start_task("class-page", move || {
            accept(&for_task, &listener);
            platform::pause(POLL_INTERVAL);
            !for_task.is_ended.load(Ordering::Relaxed)
        });
        Ok(Self {
            shared,
            address: local,
            task: Some(task.map_err(refused)?),
        })
    }

    /// Returns the address at which browsers open the page.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }
}

impl Drop for ClassPageServer {
    fn drop(&mut self) {
        self.shared.is_ended.store(true, Ordering::Relaxed);
        if let Some(task) = self.task.take() {
            task.finish();
        }
    }
}

/// Accepts the browsers that wait; those above the limit are sent away.
fn accept(shared: &Arc<SharedPage>, listener: &TcpListener) {
    while let Ok((stream, _)) = listener.accept() {
        if shared.connections.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
            shared.connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let for_client = Arc::clone(shared);
        let client = move || {
            if let Ok(connection) = HttpConnection::new(stream) {
                serve(connection, &for_client);
            }
            for_client.connections.fetch_sub(1, Ordering::Relaxed);
        };
        let thread = thread::Builder::new().name("class-page-client".to_owned());
        if thread.spawn(client).is_err() {
            shared.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

/// Serves a browser until it has gone or the page ends.
fn serve(mut connection: HttpConnection, shared: &SharedPage) {
    while !shared.is_ended.load(Ordering::Relaxed) {
        // The page requests nothing that could be refused.
        let Ok(request) = connection.read_request() else {
            return;
        };
        let is_open = request.keeps_open;
        if answer(&mut connection, shared, &request).is_err() || !is_open {
            return;
        }
    }
}

fn answer(
    connection: &mut HttpConnection,
    shared: &SharedPage,
    request: &HttpRequest,
) -> io::Result<()> {
    let is_open = request.keeps_open;
    let host = request.host.as_deref();
    if shared.is_local && !host.is_none_or(is_local_name) {
        return connection.write_response("403 Forbidden", "text/plain", "", false, "");
    }
    let language = request.page_language();
    match request.path.as_str() {
        "/" => {
            let page = render_page(&shared.code, language);
            let kind = "text/html; charset=utf-8";
            connection.write_response("200 OK", kind, PAGE_POLICY, is_open, &page)
        }
        "/seats.json" => {
            let roster = shared.roster.lock();
            let state = {
                let roster = roster.unwrap_or_else(PoisonError::into_inner);
                write_page_state(&roster, language)
            };
            connection.write_response("200 OK", "application/json", "", is_open, &state)
        }
        _ => connection.write_response("404 Not Found", "text/plain", "", is_open, ""),
    }
}

/// The HTML of the page in a language.
fn render_page(code: &ClassCode, language: Language) -> String {
    let tag = match language {
        Language::Zh => "zh-CN",
        Language::En => "en",
    };
    let mut page = TEMPLATE.replace("{{language}}", tag);
    for (name, message) in [
        ("title", say::class_title(code)),
        ("lost", say::class_page_lost()),
        ("points", say::class_column_points()),
        ("read_only", say::class_page_read_only()),
    ] {
        page = page.replace(&format!("{{{{{name}}}}}"), &message.text(language));
    }
    page
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpStream;

    use gsk_telemetry::class::class_address::ClassAddress;

    use super::*;

    fn fetch(server: &ClassPageServer, request: &str) -> String {
        let mut stream = TcpStream::connect(server.address).expect("connects");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut text = String::new();
        stream.read_to_string(&mut text).expect("received");
        text
    }

    #[test]
    fn the_page_shows_the_seats_and_nothing_else_is_answered() {
        let class = ClassAddress::parse("K7M2@host").expect("a class");
        let roster = Arc::new(Mutex::new(ClassRoster::new(class.topics())));
        let report = r#"{"name":"<b>Ann","is_online":true,"asks_help":true,"points":7}"#;
        let topic = "gsk980td/class/K7M2/seats/a1/state";
        let first = roster
            .lock()
            .expect("a roster")
            .take(topic, report.as_bytes(), 0);
        assert_eq!(first, None);
        let server = ClassPageServer::start("127.0.0.1:0", class.code, roster).expect("a page");
        let end = "Host: localhost\r\nConnection: close\r\n\r\n";
        let page = fetch(&server, &format!("GET /?lang=zh HTTP/1.1\r\n{end}"));
        assert!(
            page.contains("学员组 K7M2") && !page.contains("{{"),
            "{page}"
        );
        let state = fetch(
            &server,
            &format!("GET /seats.json?lang=en HTTP/1.1\r\n{end}"),
        );
        let tile = r#""name":"<b>Ann","urgency":"help","state":"asks for help""#;
        assert!(
            state.contains(tile) && state.contains(r#""points":7"#),
            "{state}"
        );
        let other = fetch(&server, &format!("GET /x HTTP/1.1\r\n{end}"));
        assert!(other.starts_with("HTTP/1.1 404"), "{other}");
        assert_eq!(fetch(&server, &format!("POST / HTTP/1.1\r\n{end}")), "");
        let foreign = "GET /seats.json HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n";
        assert!(fetch(&server, foreign).starts_with("HTTP/1.1 403"));
    }
}
