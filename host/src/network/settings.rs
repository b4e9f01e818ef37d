//! The settings of the network, as the window stores them.

use serde::{Deserialize, Serialize};

use crate::network::mtconnect::DEFAULT_ADDRESS;

/// The settings of the MTConnect agent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct AgentSettings {
    /// Whether the agent listens.
    pub is_on: bool,
    /// Where it listens, IP:PORT.
    pub address: String,
}

impl Default for AgentSettings {
    fn default() -> Self {
        Self {
            is_on: false,
            address: DEFAULT_ADDRESS.to_owned(),
        }
    }
}

/// The settings of the connection to an MQTT broker.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct BrokerSettings {
    /// Whether the state of the machine is published.
    pub is_on: bool,
    /// Address of the broker, without a password.
    pub url: String,
    /// File with the authorities that TLS trusts; empty: those of the system.
    pub ca: String,
    /// Whether discovery topics for Home Assistant are published.
    pub has_discovery: bool,
    /// Password; never stored.
    #[serde(skip)]
    pub password: String,
}

/// The settings of the seat of a class.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClassSettings {
    /// Whether the seat is shown to the instructor.
    pub is_on: bool,
    /// Code of the class.
    pub code: String,
    /// Address of the broker, without a password.
    pub broker: String,
    /// File with the authorities that TLS trusts; empty: those of the system.
    pub ca: String,
    /// Name of the learner on his tile.
    pub name: String,
    /// Whether the instructor may set faults of the simulated lathe.
    pub allows_faults: bool,
    /// Password; never stored.
    #[serde(skip)]
    pub password: String,
}

/// The settings of the network; everything is off as delivered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct NetworkSettings {
    /// The MTConnect agent.
    pub agent: AgentSettings,
    /// The MQTT broker.
    pub broker: BrokerSettings,
    /// The class.
    pub class: ClassSettings,
}
