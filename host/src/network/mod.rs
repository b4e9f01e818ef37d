//! What the program does on the network while a control is on: MTConnect agent, MQTT, class.
//! Everything is off unless it is switched on.

pub mod class;
mod http;
pub mod mqtt;
pub mod mtconnect;
mod page_address;
pub mod service_state;
mod services;
mod settings;

pub use page_address::{page_url, reachable_broker};
pub use services::{NetworkServices, NetworkStates};
pub use settings::{AgentSettings, BrokerSettings, ClassSettings, NetworkSettings};
