//! The connection of the view of a class to its broker.

use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use crossbeam::channel::{Receiver, Sender, bounded};
use gsk_messages::{Message, say};
use gsk_telemetry::class::class_address::{ClassAddress, ClassCode, ClassTopics, SeatTopicKind};
use gsk_telemetry::class::class_roster::{ClassRoster, RosterEvent};
use gsk_telemetry::class::lcd_picture::LcdPicture;
use gsk_telemetry::class::seat_request::SeatRequest;
use gsk_telemetry::{SessionOptions, TelemetryMessage};
use web_time::Instant;

use super::page_server::ClassPageServer;
use super::result_store::store_result;
use crate::network::mqtt::{BrokerClient, BrokerLine};
use crate::network::service_state::SharedServiceState;

/// Capacity of the queues between both threads.
const QUEUE_CAPACITY: usize = 256;
/// Capacity of the queue for requests: one for each seat of the largest class.
const REQUEST_CAPACITY: usize = 2000;

/// What has arrived for the instructor.
#[derive(Clone, Debug, PartialEq)]
pub enum ClassEvent {
    /// The LCD of a seat.
    Lcd(String, Box<LcdPicture>),
    /// A sentence: the answer of a seat, or a result that was stored.
    Message(Message),
}

/// A class whose seats are shown; dropping it disconnects.
pub struct ClassLink {
    roster: Arc<Mutex<ClassRoster>>,
    events: Receiver<ClassEvent>,
    requests: Sender<(String, SeatRequest)>,
    state: SharedServiceState,
    start: Instant,
    code: ClassCode,
    _line: BrokerLine,
}

impl ClassLink {
    /// Connects to the broker of a class. Results are stored in `results`; `wake` is called when
    /// something has changed.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(
        class: &ClassAddress,
        results: PathBuf,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let topics = class.topics();
        let roster = Arc::new(Mutex::new(ClassRoster::new(topics.clone())));
        let (to_view, events) = bounded(QUEUE_CAPACITY);
        let (requests, from_view) = bounded(REQUEST_CAPACITY);
        let state = SharedServiceState::default();
        let start = Instant::now();
        let client = ClassClient {
            topics,
            roster: Arc::clone(&roster),
            events: to_view,
            requests: from_view,
            results,
            start,
            forgotten: Vec::new(),
            wake: Box::new(wake),
        };
        let line = BrokerLine::start(class.broker.clone(), client, state.clone())?;
        Ok(Self {
            roster,
            events,
            requests,
            state,
            start,
            code: class.code.clone(),
            _line: line,
        })
    }

    /// Shows the seats as a page for browsers.
    ///
    /// # Errors
    /// The address does not belong to this computer, or is in use.
    pub fn serve_page(&self, address: &str) -> Result<ClassPageServer, Message> {
        ClassPageServer::start(address, self.code.clone(), Arc::clone(&self.roster))
    }

    /// The state of the connection.
    pub const fn state(&self) -> &SharedServiceState {
        &self.state
    }

    /// A copy of the current seats.
    pub fn roster(&self) -> ClassRoster {
        let roster = self.roster.lock();
        roster.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The clock of the roster, ms.
    pub fn now_ms(&self) -> u64 {
        self.start.elapsed().as_millis() as u64
    }

    /// The next event; `None` without one.
    pub fn take_event(&self) -> Option<ClassEvent> {
        self.events.try_recv().ok()
    }

    /// Sends a request to a seat.
    pub fn request(&self, seat: &str, request: SeatRequest) {
        // A full queue means that there is no connection.
        let _ = self.requests.try_send((seat.to_owned(), request));
    }
}

/// The client of the view.
struct ClassClient {
    topics: ClassTopics,
    roster: Arc<Mutex<ClassRoster>>,
    events: Sender<ClassEvent>,
    requests: Receiver<(String, SeatRequest)>,
    results: PathBuf,
    /// The clock of the roster.
    start: Instant,
    /// Topics that the broker need not retain: results that were stored, seats that have
    /// returned under another number.
    forgotten: Vec<String>,
    wake: Box<dyn Fn() + Send>,
}

impl ClassClient {
    fn take_event(&mut self, event: RosterEvent) {
        let event = match event {
            RosterEvent::Lcd { seat, picture } => ClassEvent::Lcd(seat, picture),
            RosterEvent::Answer { name, answer } => ClassEvent::Message(match answer.refusal {
                Some(refusal) => say::class_answer_refused(name, answer.subject, refusal.message()),
                None => say::class_answer_accepted(name, answer.subject),
            }),
            RosterEvent::Result { seat, name, bytes } => {
                match store_result(&self.results, &name, &bytes) {
                    Ok(path) => {
                        let topic = self.topics.seat(&seat, SeatTopicKind::Result);
                        self.forgotten.push(topic);
                        ClassEvent::Message(say::class_result_saved(name, path.display()))
                    }
                    Err(reason) => ClassEvent::Message(reason),
                }
            }
        };
        // A view that does not read loses the oldest news only in its window.
        let _ = self.events.try_send(event);
    }
}

impl BrokerClient for ClassClient {
    fn announce(&self, options: &mut SessionOptions) {
        options.subscriptions = self.topics.subscriptions();
    }

    fn collect(&mut self) {}

    fn forget_published(&mut self) {
        let mut roster = self.roster.lock().unwrap_or_else(PoisonError::into_inner);
        roster.clear();
    }

    fn take_due(&mut self, _now_ms: u64) -> Vec<TelemetryMessage> {
        let forgotten = self.forgotten.drain(..);
        let mut due: Vec<TelemetryMessage> = forgotten
            .map(|topic| TelemetryMessage::retained(topic, Vec::new()))
            .collect();
        while let Ok((seat, request)) = self.requests.try_recv() {
            let topic = self.topics.seat(&seat, SeatTopicKind::Request);
            due.push(TelemetryMessage::transient(topic, request.to_json()));
        }
        due
    }

    fn receive(&mut self, topic: &str, payload: &[u8], _now_ms: u64) {
        let now_ms = self.start.elapsed().as_millis() as u64;
        let event = {
            let mut roster = self.roster.lock().unwrap_or_else(PoisonError::into_inner);
            let event = roster.take(topic, payload, now_ms);
            for seat in roster.take_replaced() {
                for kind in [SeatTopicKind::State, SeatTopicKind::Part] {
                    self.forgotten.push(self.topics.seat(&seat, kind));
                }
            }
            event
        };
        if let Some(event) = event {
            self.take_event(event);
        }
        (self.wake)();
    }

    fn farewell(&mut self) -> Vec<TelemetryMessage> {
        Vec::new()
    }
}
