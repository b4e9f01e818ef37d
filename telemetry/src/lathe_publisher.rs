//! Publishes the documents that have changed, at a limited rate.

use gsk_mtconnect::model::COMPONENTS;
use gsk_mtconnect::{AgentAssets, AgentValue, MachineReading};
use serde_json::json;

use crate::discovery::{self, DiscoveryOptions};
use crate::lathe_documents::{
    alarm_document, component_document, items_of, language_code, program_document, tool_document,
};
use crate::lathe_identity::LatheIdentity;
use crate::message::TelemetryMessage;

/// A part of the state with a separate topic.
#[derive(Debug)]
struct PublishedDocument {
    topic: String,
    /// Whether it differs from what the broker has.
    is_pending: bool,
    /// Moment of the newest change, ms since 1970.
    time_ms: u64,
    /// When it may be published again, on the caller's clock, ms.
    next_ms: u64,
}

impl PublishedDocument {
    const fn new(topic: String) -> Self {
        Self {
            topic,
            is_pending: true,
            time_ms: 0,
            next_ms: 0,
        }
    }

    const fn mark(&mut self, time_ms: u64) {
        self.is_pending = true;
        self.time_ms = time_ms;
    }

    /// Whether it is published now.
    const fn take_due(&mut self, now_ms: u64, interval_ms: u64) -> bool {
        if !self.is_pending || now_ms < self.next_ms {
            return false;
        }
        self.is_pending = false;
        self.next_ms = now_ms.saturating_add(interval_ms);
        true
    }
}

/// The state of the lathe, and which of its documents the broker does not have yet.
#[derive(Debug)]
pub struct LathePublisher {
    identity: LatheIdentity,
    discovery: Option<DiscoveryOptions>,
    /// Shortest time between two documents of one topic, ms.
    interval_ms: u64,
    /// Whether the broker has the topics that never change.
    is_introduced: bool,
    reading: MachineReading,
    assets: AgentAssets,
    /// A document for each component with items.
    components: Vec<(usize, PublishedDocument)>,
    alarms: PublishedDocument,
    program: PublishedDocument,
    tools: PublishedDocument,
}

impl LathePublisher {
    /// A lathe that has published nothing. `rate_hz`: greatest number of documents of one topic
    /// in a second.
    pub fn new(identity: LatheIdentity, discovery: Option<DiscoveryOptions>, rate_hz: u32) -> Self {
        let document = |level: &str| PublishedDocument::new(identity.topic(level));
        let components = COMPONENTS.iter().enumerate();
        // What MTConnect requires of its agent says nothing of the lathe.
        let components =
            components.filter(|(_, it)| it.id != "agent" && items_of(it).next().is_some());
        Self {
            components: components
                .map(|(index, it)| (index, document(it.id)))
                .collect(),
            alarms: document("alarms"),
            program: document("program"),
            tools: document("tools"),
            identity,
            discovery,
            interval_ms: 1000 / u64::from(rate_hz.max(1)),
            is_introduced: false,
            reading: MachineReading::unavailable(),
            assets: AgentAssets::default(),
        }
    }

    /// Takes the state of the machine at `time_ms` since 1970.
    pub fn set_reading(&mut self, time_ms: u64, reading: MachineReading) {
        for (index, document) in &mut self.components {
            let differs = |item: usize| value_of(&self.reading, item) != value_of(&reading, item);
            let mut items = items_of(&COMPONENTS[*index]);
            if items.any(|(item, _)| differs(item)) {
                document.mark(time_ms);
            }
        }
        if self.reading.faults != reading.faults {
            self.alarms.mark(time_ms);
        }
        self.reading = reading;
    }

    /// Takes program and job at `time_ms` since 1970.
    pub fn set_assets(&mut self, time_ms: u64, assets: AgentAssets) {
        self.program.mark(time_ms);
        self.tools.mark(time_ms);
        self.assets = assets;
    }

    /// Publishes everything again: a new connection, or a broker that has lost its memory.
    pub fn forget_published(&mut self) {
        self.is_introduced = false;
        let components = self.components.iter_mut().map(|(_, document)| document);
        let others = [&mut self.alarms, &mut self.program, &mut self.tools];
        for document in components.chain(others) {
            document.is_pending = true;
            document.next_ms = 0;
        }
    }

    /// The messages that are due at `now_ms` on a clock that never goes back.
    pub fn take_due(&mut self, now_ms: u64) -> Vec<TelemetryMessage> {
        let mut due = Vec::new();
        if !self.is_introduced {
            self.is_introduced = true;
            due.extend(self.introduction());
        }
        let interval = self.interval_ms;
        let reading = &self.reading;
        if self.alarms.take_due(now_ms, interval) {
            let text = alarm_document(reading, self.alarms.time_ms);
            due.push(TelemetryMessage::retained(self.alarms.topic.clone(), text));
        }
        for (index, document) in &mut self.components {
            if document.take_due(now_ms, interval) {
                let text = component_document(&COMPONENTS[*index], reading, document.time_ms);
                due.push(TelemetryMessage::retained(document.topic.clone(), text));
            }
        }
        if self.program.take_due(now_ms, interval) {
            let text = program_document(&self.assets, self.program.time_ms);
            due.push(TelemetryMessage::retained(self.program.topic.clone(), text));
        }
        if self.tools.take_due(now_ms, interval) {
            let text = tool_document(&self.assets, self.tools.time_ms);
            due.push(TelemetryMessage::retained(self.tools.topic.clone(), text));
        }
        due
    }

    /// The last message before the program disconnects.
    pub fn farewell(&self) -> TelemetryMessage {
        self.identity.will()
    }

    /// The topics that do not change: availability, description, discovery.
    fn introduction(&self) -> Vec<TelemetryMessage> {
        let identity = &self.identity;
        let description = &identity.description;
        let travel = description.travel.map(|(minus, plus)| [minus, plus]);
        let device = json!({
            "lathe": description.lathe_name,
            "control": description.control_model,
            "software": format!("gsk980td {}", identity.version),
            "max_speed": description.max_speed_rpm,
            "travel": { "x": travel[0], "z": travel[1] },
            "language": language_code(identity.language),
        });
        let online = TelemetryMessage::retained(identity.online_topic(), "online");
        let device = TelemetryMessage::retained(identity.topic("device"), device.to_string());
        let mut messages = vec![online, device];
        if let Some(options) = &self.discovery {
            messages.extend(discovery::entities(identity, options));
        }
        messages
    }
}

fn value_of(reading: &MachineReading, item: usize) -> Option<&AgentValue> {
    reading.values.get(item)
}
