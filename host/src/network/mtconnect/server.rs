//! The listener of the agent: accepts clients up to a limit, and records the states of the feed.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;

use gsk_core::preview::WorkBudget;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_messages::{Message, say};
use gsk_mtconnect::query::ErrorCode;
use gsk_mtconnect::{AgentError, AgentIdentity, DeviceDescription, SchemaVersion};
use gsk_runner::program_summary::summarize;
use web_time::Duration;

use super::connection;
use super::feed::{AgentFeed, FeedQueue, wall_clock_ms};
use super::shared::SharedAgent;
use crate::network::http::HttpConnection;
use crate::platform::{self, TaskHandle};
use crate::preview::work_limit::WorkLimit;

/// Greatest number of connected clients.
const MAX_CONNECTIONS: usize = 64;
/// Time between two checks for new clients and new machine states.
const POLL_INTERVAL: Duration = Duration::from_millis(10);
/// Greatest number of clients that one check accepts.
const MAX_ACCEPTS: usize = 64;
/// Size of the stack of a client's thread, bytes.
const CLIENT_STACK_BYTES: usize = 512 * 1024;
/// Work of the preview that computes the time of a program.
const PREVIEW_BUDGET: WorkBudget = WorkBudget {
    moves: 2_000_000,
    work: 20_000_000,
    motionless: 1_000_000,
};

/// Error: the agent cannot listen at an address.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct AgentServerError {
    address: String,
    error: io::Error,
}

impl AgentServerError {
    /// Returns the message that names the address and the reason.
    pub fn message(&self) -> Message {
        say::mtconnect_not_listening(&self.address, &self.error)
    }
}

/// The running agent; all connections close when it is dropped.
#[derive(Debug)]
pub struct AgentServer {
    shared: Arc<SharedAgent>,
    address: SocketAddr,
    task: Option<TaskHandle>,
}

impl AgentServer {
    /// Listens at `address` for clients of a machine. Also returns the feed for the thread that
    /// ticks that machine.
    ///
    /// # Errors
    /// The address is malformed, does not belong to this computer, or is in use.
    pub fn start(
        address: &str,
        schema: SchemaVersion,
        simulation: &Simulation,
    ) -> Result<(Self, AgentFeed), AgentServerError> {
        let refused = |error| AgentServerError {
            address: address.to_owned(),
            error,
        };
        let listener = listen(address).map_err(refused)?;
        let local = listener.local_addr().map_err(refused)?;
        let description = DeviceDescription::new(simulation.lathe.config(), &simulation.cnc);
        let started_ms = wall_clock_ms();
        let identity = AgentIdentity::new(description, schema, &local.to_string(), started_ms);
        let shared = Arc::new(SharedAgent::new(identity, local.ip().is_loopback()));
        let (feed, queue) = AgentFeed::new();
        let for_task = Arc::clone(&shared);
        let task = platform::start_task("mtconnect", move || {
            record(&for_task, &queue);
            accept(&for_task, &listener);
            thread::sleep(POLL_INTERVAL);
            !for_task.is_ended.load(Ordering::Relaxed)
        });
        let server = Self {
            shared,
            address: local,
            task: Some(task.map_err(refused)?),
        };
        Ok((server, feed))
    }

    /// Returns the address at which clients reach the agent.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }
}

impl Drop for AgentServer {
    fn drop(&mut self) {
        self.shared.is_ended.store(true, Ordering::Relaxed);
        // With the lock no stream is between its check and its wait.
        drop(self.shared.lock());
        self.shared.recorded.notify_all();
        if let Some(task) = self.task.take() {
            task.finish();
        }
    }
}

/// Opens the port at which the agent listens.
fn listen(address: &str) -> io::Result<TcpListener> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Records the machine states that wait in the queue.
fn record(shared: &Arc<SharedAgent>, queue: &FeedQueue) {
    let mut has_recorded = false;
    while let Some(item) = queue.pop() {
        let mut agent = shared.lock();
        if let Some(change) = &item.change {
            agent.set_assets(item.time_ms, &change.assets);
            agent.set_program_time(None);
        }
        agent.record(item.time_ms, item.reading);
        drop(agent);
        if let Some(change) = item.change {
            compute_program_time(shared, change.setup);
        }
        has_recorded = true;
    }
    if has_recorded {
        shared.recorded.notify_all();
    }
}

/// Computes the machine time of the selected program in a thread.
fn compute_program_time(shared: &Arc<SharedAgent>, setup: Setup) {
    let number = shared.program_number.fetch_add(1, Ordering::Relaxed) + 1;
    let shared = Arc::clone(shared);
    let job = move || {
        let limit = WorkLimit::new(PREVIEW_BUDGET);
        let is_current = || {
            shared.program_number.load(Ordering::Relaxed) == number
                && !shared.is_ended.load(Ordering::Relaxed)
        };
        let summary = summarize(String::new(), &setup, &mut |progress| {
            limit.allows(progress) && is_current()
        });
        if is_current() && !summary.has_alarm() {
            shared.lock().set_program_time(Some(summary.time_s));
        }
    };
    // Without a thread the page shows no time left.
    let _ = platform::run_in_background("mtconnect-time", job);
}

/// Accepts the clients that wait, and refuses those above the limit.
fn accept(shared: &Arc<SharedAgent>, listener: &TcpListener) {
    for _ in 0..MAX_ACCEPTS {
        let Ok((stream, _)) = listener.accept() else {
            return;
        };
        if shared.connections.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
            refuse_client(shared, stream);
            shared.connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let for_client = Arc::clone(shared);
        let client = move || {
            if let Ok(connection) = HttpConnection::new(stream) {
                connection::serve(connection, &for_client);
            }
            for_client.connections.fetch_sub(1, Ordering::Relaxed);
        };
        let thread = thread::Builder::new()
            .name("mtconnect-client".to_owned())
            .stack_size(CLIENT_STACK_BYTES);
        if thread.spawn(client).is_err() {
            shared.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

/// Sends a client above the limit away without waiting for it.
fn refuse_client(shared: &SharedAgent, stream: TcpStream) {
    let error = AgentError::new(ErrorCode::TooMany, "Too many clients are connected.");
    let text = shared.lock().error(&error, wall_clock_ms());
    let Ok(mut connection) = HttpConnection::new(stream) else {
        return;
    };
    // The response fits the buffer of a new connection; the client may be gone.
    let status = error.code.http_status();
    let _ = connection.write_response(status, "text/xml", "Retry-After: 5\r\n", false, &text);
}
