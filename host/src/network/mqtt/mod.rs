//! Publishes the state of the machine to an MQTT broker.
//!
//! The thread that ticks never waits for it: states travel through a queue of limited length
//! without locks, and the thread of the connection alone waits for the broker.

mod broker_line;
mod lathe_client;
mod options;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tls_tests;

pub use broker_line::{BrokerClient, BrokerLine};
pub use gsk_telemetry::{BrokerTransport, BrokerUrl, DEFAULT_DISCOVERY_PREFIX};
pub use lathe_client::{LatheOptions, start_publishing};
pub use options::{
    DEFAULT_RATE_HZ, MAX_RATE_HZ, MqttOptionError, PASSWORD_VARIABLE, parse_broker, parse_rate,
    read_password,
};
