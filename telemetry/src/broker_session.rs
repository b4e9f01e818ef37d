//! The connection to a broker: MQTT 3.1.1 packets as bytes, keep-alive, last will.
//!
//! Everything is published with quality of service 0: TCP carries the bytes, and after a new
//! connection the caller publishes its whole state again.

use gsk_messages::{Message, say};
use mqtt_protocol_core::mqtt::common::Cursor;
use mqtt_protocol_core::mqtt::connection::{ConnectionOptions, Event};
use mqtt_protocol_core::mqtt::packet::{Packet, Qos, SubEntry, SubOpts, v3_1_1};
use mqtt_protocol_core::mqtt::prelude::*;
use mqtt_protocol_core::mqtt::result_code::MqttError;
use mqtt_protocol_core::mqtt::{Connection, Version, role};

use crate::broker_url::BrokerUrl;
use crate::message::TelemetryMessage;

/// Time without a packet after which the broker may close the connection, s.
pub const KEEP_ALIVE_S: u16 = 10;
/// Time between two pings, ms: without quality of service the broker answers nothing else.
const PING_INTERVAL_MS: u64 = 4000;
/// Time without a received byte after which the connection counts as lost, ms.
const SILENCE_MS: u64 = 9000;
/// Greatest packet that the session accepts, bytes.
const MAX_PACKET_BYTES: u32 = 2 * 1024 * 1024;

/// What a session announces when it connects.
#[derive(Clone, Debug)]
pub struct SessionOptions {
    /// Name of the client, different from that of every other client.
    pub client_id: String,
    /// User name; `None` without one.
    pub user: Option<String>,
    /// Password; `None` without one.
    pub password: Option<String>,
    /// Published by the broker when the connection is lost.
    pub will: Option<TelemetryMessage>,
    /// Topics from which the session receives messages.
    pub subscriptions: Vec<String>,
}

impl SessionOptions {
    /// The options with user and password of an address.
    pub fn new(client_id: String, url: &BrokerUrl) -> Self {
        Self {
            client_id,
            user: url.user.clone(),
            password: url.password.clone(),
            will: None,
            subscriptions: Vec::new(),
        }
    }
}

/// Why a session has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionFailure {
    /// The broker refuses user or password.
    NotAuthorized,
    /// The broker refuses the client for another reason.
    Refused,
    /// The bytes are not those of an MQTT broker.
    Malformed,
    /// The broker has not answered for `SILENCE_MS`.
    Silent,
}

impl SessionFailure {
    /// The reason as a message.
    pub fn message(self) -> Message {
        match self {
            Self::NotAuthorized => say::mqtt_not_authorized(),
            Self::Refused => say::mqtt_refused(),
            Self::Malformed => say::mqtt_malformed(),
            Self::Silent => say::mqtt_silent(),
        }
    }
}

/// What has arrived from the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionEvent {
    /// The broker has accepted the client: publish everything.
    Connected,
    /// A message of a subscribed topic.
    Received {
        /// Its topic.
        topic: String,
        /// Its payload.
        payload: Vec<u8>,
    },
    /// The session has ended; close the connection.
    Failed(SessionFailure),
}

/// A connection to a broker, from CONNECT to DISCONNECT.
pub struct BrokerSession {
    connection: Connection<role::Client>,
    subscriptions: Vec<String>,
    /// Bytes for the broker.
    output: Vec<u8>,
    is_connected: bool,
    has_failed: bool,
    last_ping_ms: u64,
    last_received_ms: u64,
}

impl core::fmt::Debug for BrokerSession {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("BrokerSession")
            .field("is_connected", &self.is_connected)
            .field("output", &self.output.len())
            .finish_non_exhaustive()
    }
}

impl BrokerSession {
    /// Begins a session at `now_ms`: its first bytes are those of CONNECT.
    pub fn new(options: SessionOptions, now_ms: u64) -> Self {
        let limit = ConnectionOptions::new().maximum_packet_size_recv(MAX_PACKET_BYTES);
        let mut connection = Connection::with_options(Version::V3_1_1, limit);
        connection.set_auto_pub_response(true);
        let connect = connect_packet(&options);
        let mut session = Self {
            connection,
            subscriptions: options.subscriptions,
            output: Vec::new(),
            is_connected: false,
            has_failed: false,
            last_ping_ms: now_ms,
            last_received_ms: now_ms,
        };
        match connect {
            Ok(packet) => session.send(packet.into(), now_ms),
            // A user name or a will that no packet can contain.
            Err(_) => session.has_failed = true,
        }
        session
    }

    /// Whether the broker has accepted the client.
    pub const fn is_connected(&self) -> bool {
        self.is_connected
    }

    /// Takes the bytes for the broker.
    pub fn take_output(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.output)
    }

    /// Publishes a message. A topic that no packet can contain publishes nothing.
    pub fn publish(&mut self, message: &TelemetryMessage, now_ms: u64) {
        if !self.is_connected {
            return;
        }
        let builder = v3_1_1::Publish::builder().topic_name(message.topic.as_str());
        let packet = builder.and_then(|builder| {
            builder
                .qos(Qos::AtMostOnce)
                .retain(message.is_retained)
                .payload(&*message.payload)
                .build()
        });
        if let Ok(packet) = packet {
            self.send(packet.into(), now_ms);
        }
    }

    /// Ends the session: the broker does not publish the last will.
    pub fn disconnect(&mut self, now_ms: u64) {
        if let Ok(packet) = v3_1_1::Disconnect::builder().build()
            && self.is_connected
        {
            self.send(packet.into(), now_ms);
        }
        self.is_connected = false;
    }

    /// Takes bytes of the broker.
    pub fn receive(&mut self, bytes: &[u8], now_ms: u64) -> Vec<SessionEvent> {
        let mut received = Vec::new();
        if !bytes.is_empty() {
            self.last_received_ms = now_ms;
        }
        let mut cursor = Cursor::new(bytes);
        while !self.has_failed && cursor.position() < bytes.len() as u64 {
            for event in self.connection.recv(&mut cursor) {
                self.handle(event, now_ms, &mut received);
            }
        }
        received
    }

    /// Sends a ping if one is due; returns a failure if the broker is silent.
    pub fn poll(&mut self, now_ms: u64) -> Option<SessionFailure> {
        if self.has_failed {
            return Some(SessionFailure::Malformed);
        }
        if now_ms.saturating_sub(self.last_received_ms) > SILENCE_MS {
            self.fail();
            return Some(SessionFailure::Silent);
        }
        let is_due = now_ms.saturating_sub(self.last_ping_ms) >= PING_INTERVAL_MS;
        if self.is_connected
            && is_due
            && let Ok(packet) = v3_1_1::Pingreq::builder().build()
        {
            self.last_ping_ms = now_ms;
            self.send(packet.into(), now_ms);
        }
        None
    }

    fn send(&mut self, packet: Packet, now_ms: u64) {
        let mut ignored = Vec::new();
        for event in self.connection.send(packet) {
            self.handle(event, now_ms, &mut ignored);
        }
    }

    fn handle(&mut self, event: Event, now_ms: u64, received: &mut Vec<SessionEvent>) {
        match event {
            Event::RequestSendPacket { packet, .. } => {
                self.output.extend(packet.to_continuous_buffer());
            }
            Event::NotifyPacketReceived(packet) => self.take_packet(&packet, now_ms, received),
            Event::NotifyError(error) => {
                // What cannot be sent is left out; what cannot be read ends the session.
                if !matches!(error, MqttError::PacketNotAllowedToSend) {
                    self.end(SessionFailure::Malformed, received);
                }
            }
            Event::RequestClose => self.end(SessionFailure::Malformed, received),
            // Pings follow the times of `poll`.
            Event::NotifyPacketIdReleased(_)
            | Event::RequestTimerReset { .. }
            | Event::RequestTimerCancel(_) => {}
        }
    }

    fn take_packet(&mut self, packet: &Packet, now_ms: u64, received: &mut Vec<SessionEvent>) {
        use mqtt_protocol_core::mqtt::result_code::ConnectReturnCode as Code;
        match packet {
            Packet::V3_1_1Connack(answer) => match answer.return_code() {
                Code::Accepted => {
                    self.is_connected = true;
                    self.subscribe(now_ms);
                    received.push(SessionEvent::Connected);
                }
                Code::BadUserNameOrPassword | Code::NotAuthorized => {
                    self.end(SessionFailure::NotAuthorized, received);
                }
                _ => self.end(SessionFailure::Refused, received),
            },
            Packet::V3_1_1Publish(publish) => received.push(SessionEvent::Received {
                topic: publish.topic_name().to_owned(),
                payload: publish.payload().as_slice().to_vec(),
            }),
            _ => {}
        }
    }

    fn subscribe(&mut self, now_ms: u64) {
        let options = SubOpts::new().set_qos(Qos::AtMostOnce);
        let entries: Result<Vec<SubEntry>, _> = self
            .subscriptions
            .iter()
            .map(|topic| SubEntry::new(topic.as_str(), options))
            .collect();
        let Ok(entries) = entries else {
            return;
        };
        if entries.is_empty() {
            return;
        }
        let packet = self.connection.acquire_packet_id().and_then(|id| {
            v3_1_1::Subscribe::builder()
                .packet_id(id)
                .entries(entries)
                .build()
        });
        if let Ok(packet) = packet {
            self.send(packet.into(), now_ms);
        }
    }

    /// Ends the session with the first failure.
    fn end(&mut self, failure: SessionFailure, received: &mut Vec<SessionEvent>) {
        if !self.has_failed {
            received.push(SessionEvent::Failed(failure));
        }
        self.fail();
    }

    fn fail(&mut self) {
        self.has_failed = true;
        self.is_connected = false;
    }
}

fn connect_packet(options: &SessionOptions) -> Result<v3_1_1::Connect, MqttError> {
    let mut builder = v3_1_1::Connect::builder()
        .client_id(options.client_id.as_str())?
        .clean_session(true)
        .keep_alive(KEEP_ALIVE_S);
    if let Some(user) = &options.user {
        builder = builder.user_name(user.as_str())?;
        // MQTT 3.1.1 has no password without a user.
        if let Some(password) = &options.password {
            builder = builder.password(password.as_bytes().to_vec())?;
        }
    }
    if let Some(will) = &options.will {
        let payload = will.payload.to_vec();
        builder = builder.will_message(
            will.topic.as_str(),
            payload,
            Qos::AtMostOnce,
            will.is_retained,
        )?;
    }
    builder.build()
}
