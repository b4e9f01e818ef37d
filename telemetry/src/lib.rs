//! What the program publishes to an MQTT broker, without its network.
//!
//! | Module | What |
//! |---|---|
//! | `broker_url` | parses the address of a broker |
//! | `broker_session` | the connection to a broker: packets as bytes, keep-alive, last will |
//! | `reconnect_delay` | the time between two attempts to connect |
//! | `message` | a topic and its payload |
//! | `lathe_identity` | the lathe and its topics |
//! | `lathe_documents` | the state of the lathe as JSON, a document for each component |
//! | `lathe_publisher` | publishes the documents that have changed, at a limited rate |
//! | `class` | the seats of a class and its view |
//! | `discovery` | describes the documents to Home Assistant |
//!
//! The caller supplies the time and moves the bytes.

mod broker_session;
mod broker_url;
pub mod class;
mod discovery;
mod lathe_documents;
mod lathe_identity;
mod lathe_publisher;
mod message;
mod reconnect_delay;

pub use broker_session::{
    BrokerSession, KEEP_ALIVE_S, SessionEvent, SessionFailure, SessionOptions,
};
pub use broker_url::{BrokerTransport, BrokerUrl, BrokerUrlError};
pub use discovery::{DEFAULT_DISCOVERY_PREFIX, DiscoveryOptions};
pub use lathe_identity::LatheIdentity;
pub use lathe_publisher::LathePublisher;
pub use message::TelemetryMessage;
pub use reconnect_delay::ReconnectDelay;
