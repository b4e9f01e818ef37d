//! The connection to a broker in its thread: connects again whenever it is lost.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam::channel::{Receiver, Sender, bounded};
use gsk_messages::{Message, say};
use gsk_telemetry::{
    BrokerSession, BrokerUrl, ReconnectDelay, SessionEvent, SessionOptions, TelemetryMessage,
};
use tracing::{info, warn};
use web_time::{Duration, Instant};

use crate::message_format::describe_io_error;
use crate::network::service_state::{ServiceState, SharedServiceState};
use crate::platform::{self, BrokerBytes, BrokerFailure, BrokerStream};

/// Longest time for which the thread waits for bytes of the broker: the delay of a message.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Time for the last messages when the program ends.
const FAREWELL_TIMEOUT: Duration = Duration::from_millis(1500);
/// Size of the buffer for bytes of the broker, bytes.
const READ_BYTES: usize = 64 * 1024;

/// Publishes messages and takes those of subscribed topics, in the thread of the connection.
pub trait BrokerClient: Send + 'static {
    /// The last will and the subscriptions.
    fn announce(&self, options: &mut SessionOptions);
    /// Empties the queues from other threads, with or without a connection.
    fn collect(&mut self);
    /// The broker knows nothing: everything is published again.
    fn forget_published(&mut self);
    /// The messages that are due at `now_ms`.
    fn take_due(&mut self, now_ms: u64) -> Vec<TelemetryMessage>;
    /// Takes a message of a subscribed topic at `now_ms`.
    fn receive(&mut self, topic: &str, payload: &[u8], now_ms: u64);
    /// The last messages before the program disconnects.
    fn farewell(&mut self) -> Vec<TelemetryMessage>;
}

/// A running connection; dropping it publishes the farewell and disconnects.
#[derive(Debug)]
pub struct BrokerLine {
    is_ended: Arc<AtomicBool>,
    finished: Receiver<()>,
}

impl BrokerLine {
    /// Connects a client to a broker, and again whenever the connection is lost.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        url: BrokerUrl,
        client: impl BrokerClient,
        state: SharedServiceState,
    ) -> io::Result<Self> {
        let is_ended = Arc::new(AtomicBool::new(false));
        let (sender, finished) = bounded(1);
        state.set(ServiceState::Connecting(url.to_string()));
        let mut line_loop = LineLoop {
            url,
            client,
            state,
            client_id: make_client_id(),
            is_ended: Arc::clone(&is_ended),
            finished: sender,
            start: Instant::now(),
            link: None,
            delay: ReconnectDelay::default(),
            next_attempt_ms: 0,
            buffer: vec![0; READ_BYTES],
        };
        platform::start_task("mqtt", move || line_loop.take_turn())?;
        Ok(Self { is_ended, finished })
    }

    /// Ends the connection without waiting for its last messages.
    pub fn end_in_background(self) {
        // Without a thread the wait is made here.
        let _ = platform::run_in_background("mqtt-end", move || drop(self));
    }
}

impl Drop for BrokerLine {
    fn drop(&mut self) {
        self.is_ended.store(true, Ordering::Relaxed);
        // A broker that hangs keeps its thread; the program ends without it.
        let _ = platform::wait_for_answer(&self.finished, FAREWELL_TIMEOUT);
    }
}

/// A name that no other client has.
fn make_client_id() -> String {
    let mut bytes = [0; 6];
    // Without random numbers the broker refuses the second client, which is reported.
    let _ = getrandom::fill(&mut bytes);
    let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("gsk980td-{digits}")
}

/// An open connection.
#[derive(Debug)]
struct BrokerLink {
    stream: BrokerStream,
    session: BrokerSession,
}

/// The thread of a connection.
struct LineLoop<C> {
    url: BrokerUrl,
    client: C,
    state: SharedServiceState,
    client_id: String,
    is_ended: Arc<AtomicBool>,
    finished: Sender<()>,
    start: Instant,
    /// `None` while the broker is not reached.
    link: Option<BrokerLink>,
    delay: ReconnectDelay,
    next_attempt_ms: u64,
    buffer: Vec<u8>,
}

impl<C: BrokerClient> LineLoop<C> {
    fn now_ms(&self) -> u64 {
        self.start.elapsed().as_millis() as u64
    }

    /// Exchanges what is due; returns `false` when the connection ends.
    fn take_turn(&mut self) -> bool {
        self.client.collect();
        if self.is_ended.load(Ordering::Relaxed) {
            self.say_farewell();
            let _ = self.finished.try_send(());
            return false;
        }
        match self.link.take() {
            Some(mut link) => match self.exchange(&mut link) {
                Ok(()) => self.link = Some(link),
                Err(reason) => self.lose(reason),
            },
            None if self.now_ms() >= self.next_attempt_ms => match self.connect() {
                Ok(link) => self.link = Some(link),
                Err(reason) => self.lose(reason),
            },
            None => platform::pause(POLL_INTERVAL),
        }
        true
    }

    /// Reports why there is no connection, and sets the time of the next attempt.
    fn lose(&mut self, reason: Message) {
        self.next_attempt_ms = self.now_ms() + self.delay.take_ms();
        let state = ServiceState::Failed(say::mqtt_failed(&self.url, reason));
        if self.state.get() != state {
            warn!("{}", state.message());
        }
        self.set_state(state);
    }

    /// Sets the state, unless the connection ends: then another one may have it already.
    fn set_state(&self, state: ServiceState) {
        if !self.is_ended.load(Ordering::Relaxed) {
            self.state.set(state);
        }
    }

    fn connect(&mut self) -> Result<BrokerLink, Message> {
        // The queues stay empty while several addresses do not answer.
        let client = &mut self.client;
        let stream = BrokerStream::open(&self.url, POLL_INTERVAL, || client.collect());
        let stream = stream.map_err(describe_failure)?;
        let mut options = SessionOptions::new(self.client_id.clone(), &self.url);
        self.client.announce(&mut options);
        let session = BrokerSession::new(options, self.now_ms());
        Ok(BrokerLink { stream, session })
    }

    /// Reads what the broker has sent, and writes what is due. Returns why the connection ends.
    fn exchange(&mut self, link: &mut BrokerLink) -> Result<(), Message> {
        self.write(link)?;
        let received = match (link.stream.read(&mut self.buffer)).map_err(describe_failure)? {
            BrokerBytes::Closed => return Err(say::mqtt_silent()),
            BrokerBytes::Received(count) => &self.buffer[..count],
        };
        let now_ms = self.start.elapsed().as_millis() as u64;
        for event in link.session.receive(received, now_ms) {
            match event {
                SessionEvent::Connected => {
                    info!("{}", say::mqtt_connected(&self.url));
                    self.delay.reset();
                    self.client.forget_published();
                    self.set_state(ServiceState::Connected(self.url.to_string()));
                }
                SessionEvent::Received { topic, payload } => {
                    self.client.receive(&topic, &payload, now_ms);
                }
                SessionEvent::Failed(failure) => return Err(failure.message()),
            }
        }
        match link.session.poll(now_ms) {
            Some(_) if !link.stream.is_established() => Err(say::mqtt_no_handshake()),
            Some(failure) => Err(failure.message()),
            None => Ok(()),
        }
    }

    /// Writes the messages that are due.
    fn write(&mut self, link: &mut BrokerLink) -> Result<(), Message> {
        if link.session.is_connected() {
            let now_ms = self.now_ms();
            for message in self.client.take_due(now_ms) {
                link.session.publish(&message, now_ms);
            }
        }
        let written = link.stream.write(&link.session.take_output());
        written.map_err(describe_failure)
    }

    /// Publishes the last state and the farewell, and disconnects.
    fn say_farewell(&mut self) {
        let Some(mut link) = self.link.take() else {
            return;
        };
        let now_ms = self.now_ms();
        if link.session.is_connected() {
            // The last state, whatever the rate.
            let mut last = self.client.take_due(u64::MAX);
            last.extend(self.client.farewell());
            for message in last {
                link.session.publish(&message, now_ms);
            }
        }
        link.session.disconnect(now_ms);
        // The broker may be gone; then it publishes the last will.
        let _ = link.stream.write(&link.session.take_output());
        link.stream.close();
    }
}

/// The reason in one sentence.
fn describe_failure(failure: BrokerFailure) -> Message {
    match failure {
        BrokerFailure::Io(error) => describe_io_error(&error),
        BrokerFailure::Refused(reason) => reason,
    }
}
