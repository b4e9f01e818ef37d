//! A topic and its payload.

use std::sync::Arc;

/// A message to a broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TelemetryMessage {
    /// Topic, without wildcards.
    pub topic: String,
    /// Payload; an empty retained one deletes what the broker has retained.
    pub payload: Arc<[u8]>,
    /// Whether the broker retains the payload for clients that subscribe later.
    pub is_retained: bool,
}

impl TelemetryMessage {
    /// A message that the broker retains.
    pub fn retained(topic: String, payload: impl Into<Vec<u8>>) -> Self {
        Self {
            topic,
            payload: payload.into().into(),
            is_retained: true,
        }
    }

    /// A message that only the current subscribers receive.
    pub fn transient(topic: String, payload: impl Into<Vec<u8>>) -> Self {
        Self {
            is_retained: false,
            ..Self::retained(topic, payload)
        }
    }
}
