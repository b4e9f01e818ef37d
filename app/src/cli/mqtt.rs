//! Options of MQTT.

use std::path::PathBuf;

use clap::Args;
use gsk_host::network::mqtt::{BrokerUrl, DEFAULT_DISCOVERY_PREFIX, parse_broker, parse_rate};

/// Whether and where the state of the machine is published.
#[derive(Args, Clone, Debug, Default)]
pub struct MqttArgs {
    /// Publish the state of the machine to this MQTT broker, mqtt://USER@HOST:PORT/PREFIX, with TLS mqtts://; nothing is received [default: nothing is sent; PORT 1883, with TLS 8883, PREFIX gsk980td/lathe]
    #[arg(long, value_name = "URL", value_parser = parse_broker)]
    pub mqtt: Option<BrokerUrl>,
    /// File with the certificates of the authorities that TLS trusts, for mqtts:// and --class [default: those of the system]
    #[arg(long, value_name = "FILE")]
    pub mqtt_ca: Option<PathBuf>,
    /// File with the password for the broker [default: the environment variable GSK980TD_MQTT_PASSWORD]
    #[arg(long, value_name = "FILE", requires = "mqtt")]
    pub mqtt_password_file: Option<PathBuf>,
    /// Publish topics by which Home Assistant finds the lathe [default: none; without PREFIX homeassistant]
    #[arg(long, value_name = "PREFIX", requires = "mqtt", num_args = 0..=1, default_missing_value = DEFAULT_DISCOVERY_PREFIX)]
    pub mqtt_discovery: Option<String>,
    /// Greatest number of messages of one topic in a second [default: 4]
    #[arg(long, value_name = "N", requires = "mqtt", value_parser = parse_rate)]
    pub mqtt_rate: Option<u32>,
}
