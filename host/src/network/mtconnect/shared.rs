//! The agent, as its threads share it.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use gsk_mtconnect::{Agent, AgentIdentity};
use web_time::Instant;

use crate::network::http::is_local_name;

/// The agent, as the threads share it. The thread that ticks does not use it.
#[derive(Debug)]
pub(super) struct SharedAgent {
    agent: Mutex<Agent>,
    /// Wakes the streams when a machine state was recorded.
    pub(super) recorded: Condvar,
    pub(super) is_ended: AtomicBool,
    /// Number of connected clients.
    pub(super) connections: AtomicUsize,
    /// Number of the program whose machine time is being computed; it increases with each program.
    pub(super) program_number: AtomicUsize,
    /// Name of the lathe in the addresses of documents.
    pub(super) device: String,
    /// Whether the agent accepts clients on this computer only.
    is_local: bool,
}

impl SharedAgent {
    /// Creates the agent of a lathe. `is_local`: it serves this computer only.
    pub(super) fn new(identity: AgentIdentity, is_local: bool) -> Self {
        Self {
            device: identity.name.clone(),
            agent: Mutex::new(Agent::new(identity)),
            recorded: Condvar::new(),
            is_ended: AtomicBool::new(false),
            connections: AtomicUsize::new(0),
            program_number: AtomicUsize::new(0),
            is_local,
        }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Agent> {
        self.agent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until `earliest`, then until an observation from `sequence` on is recorded, at most
    /// until `latest`. Returns false if the agent has ended.
    pub(super) fn wait_until(&self, earliest: Instant, latest: Instant, sequence: u64) -> bool {
        let mut agent = self.lock();
        loop {
            if self.is_ended.load(Ordering::Relaxed) {
                return false;
            }
            let now = Instant::now();
            let is_recorded = agent.next_sequence() > sequence;
            if now >= latest || (is_recorded && now >= earliest) {
                return true;
            }
            let due = if is_recorded { earliest } else { latest };
            let waited = self.recorded.wait_timeout(agent, due - now);
            agent = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Whether a client may address the agent by this host name.
    pub(super) fn accepts_host(&self, host: Option<&str>) -> bool {
        !self.is_local || host.is_none_or(is_local_name)
    }
}
