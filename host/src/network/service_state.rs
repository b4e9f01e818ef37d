//! The state of what the program does on the network, in one sentence.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use gsk_messages::{Message, say};

/// The state of a listener or of a connection.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ServiceState {
    /// Nothing is sent and nothing listens.
    #[default]
    Off,
    /// Clients reach it at this address.
    Listening(String),
    /// The first attempt to connect to this address.
    Connecting(String),
    /// It is connected to this address.
    Connected(String),
    /// Why it neither listens nor is connected.
    Failed(Message),
}

impl ServiceState {
    /// The state in one sentence.
    pub fn message(&self) -> Message {
        match self {
            Self::Off => say::network_off(),
            Self::Listening(url) => say::network_listening(url),
            Self::Connecting(url) => say::mqtt_connecting(url),
            Self::Connected(url) => say::network_connected(url),
            Self::Failed(reason) => say::network_trouble(reason.clone()),
        }
    }
}

/// A state that a thread changes and another one shows.
#[derive(Clone, Debug, Default)]
pub struct SharedServiceState {
    state: Arc<Mutex<ServiceState>>,
    /// Whether an option of the command line has switched it on.
    is_by_option: Arc<AtomicBool>,
    /// Receives each new state; `None` if nothing but the window shows it.
    report: Option<fn(&ServiceState)>,
}

impl SharedServiceState {
    /// A state whose changes are reported.
    pub fn with_report(report: fn(&ServiceState)) -> Self {
        Self {
            report: Some(report),
            ..Self::default()
        }
    }

    /// Marks the service as switched on by an option of the command line.
    pub fn mark_by_option(&self) {
        self.is_by_option.store(true, Ordering::Relaxed);
    }

    /// Whether an option of the command line has switched the service on.
    pub fn is_by_option(&self) -> bool {
        self.is_by_option.load(Ordering::Relaxed)
    }

    /// The current state.
    pub fn get(&self) -> ServiceState {
        let state = self.state.lock();
        state.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Sets the state; reports it if it differs from the last one.
    pub fn set(&self, state: ServiceState) {
        let mut current = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if *current == state {
            return;
        }
        let reported = state.clone();
        *current = state;
        drop(current);
        if let Some(report) = self.report {
            report(&reported);
        }
    }
}
