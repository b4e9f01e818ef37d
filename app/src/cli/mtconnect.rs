//! Options of the MTConnect agent.

use clap::Args;
use gsk_host::network::mtconnect::{DEFAULT_ADDRESS, SchemaVersion, parse_address, parse_schema};

/// Whether and where the MTConnect agent listens.
#[derive(Args, Clone, Debug, Default)]
pub struct MtconnectArgs {
    /// Serve the state of the machine to MTConnect clients and browsers at this address, IP:PORT; clients cannot operate anything [default: nothing listens; without ADDR 127.0.0.1:5000, this computer only]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS, value_parser = parse_address)]
    pub mtconnect: Option<String>,
    /// Version of the MTConnect schemas: 1.8, or 2.0 to 2.5 [default: 2.0]
    #[arg(long, value_name = "VERSION", requires = "mtconnect", value_parser = parse_schema)]
    pub mtconnect_schema: Option<SchemaVersion>,
}
