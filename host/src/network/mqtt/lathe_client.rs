//! Publishes the state of the lathe.

use std::io;

use gsk_core::simulation::Simulation;
use gsk_messages::Language;
use gsk_mtconnect::DeviceDescription;
use gsk_telemetry::{
    BrokerUrl, DiscoveryOptions, LatheIdentity, LathePublisher, SessionOptions, TelemetryMessage,
};

use super::broker_line::{BrokerClient, BrokerLine};
use crate::network::mtconnect::feed::{AgentFeed, FeedQueue};
use crate::network::service_state::SharedServiceState;

/// What is published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LatheOptions {
    /// Start of the discovery topics; `None`: none are published.
    pub discovery_prefix: Option<String>,
    /// Greatest number of documents of one topic in a second.
    pub rate_hz: u32,
    /// Language of the names in discovery topics.
    pub language: Language,
}

/// Publishes a machine to a broker. Also returns the feed for the thread that ticks that machine.
///
/// # Errors
/// The system starts no thread.
pub fn start_publishing(
    url: &BrokerUrl,
    options: &LatheOptions,
    simulation: &Simulation,
    state: SharedServiceState,
) -> io::Result<(BrokerLine, AgentFeed)> {
    let description = DeviceDescription::new(simulation.lathe.config(), &simulation.cnc);
    let identity = LatheIdentity::new(&url.prefix, description, options.language);
    let discovery = options.discovery_prefix.clone();
    let discovery = discovery.map(|prefix| DiscoveryOptions { prefix });
    let (feed, queue) = AgentFeed::new();
    let client = LatheClient {
        will: identity.will(),
        publisher: LathePublisher::new(identity, discovery, options.rate_hz),
        queue,
    };
    let line = BrokerLine::start(url.clone(), client, state)?;
    Ok((line, feed))
}

/// The client that publishes the lathe.
struct LatheClient {
    will: TelemetryMessage,
    publisher: LathePublisher,
    queue: FeedQueue,
}

impl BrokerClient for LatheClient {
    fn announce(&self, options: &mut SessionOptions) {
        options.will = Some(self.will.clone());
    }

    fn collect(&mut self) {
        while let Some(item) = self.queue.pop() {
            if let Some(change) = item.change {
                self.publisher.set_assets(item.time_ms, change.assets);
            }
            self.publisher.set_reading(item.time_ms, item.reading);
        }
    }

    fn forget_published(&mut self) {
        self.publisher.forget_published();
    }

    fn take_due(&mut self, now_ms: u64) -> Vec<TelemetryMessage> {
        self.publisher.take_due(now_ms)
    }

    /// The lathe subscribes to nothing.
    fn receive(&mut self, _topic: &str, _payload: &[u8], _now_ms: u64) {}

    fn farewell(&mut self) -> Vec<TelemetryMessage> {
        vec![self.publisher.farewell()]
    }
}
