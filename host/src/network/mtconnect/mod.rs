//! The MTConnect agent on the network: passes the state of the machine from the thread that ticks
//! to the agent, and answers the requests of clients.
//!
//! The agent only reads. The thread that ticks never waits for it: states travel through a queue
//! of limited length without locks, and the oldest one is dropped if the queue is full.

mod address;
mod connection;
pub(crate) mod feed;
mod pacing;
mod page;
mod server;
mod shared;
#[cfg(test)]
mod tests;

pub use address::{AgentOptionError, DEFAULT_ADDRESS, parse_address, parse_schema};
pub use feed::AgentFeed;
pub use gsk_mtconnect::SchemaVersion;
pub use pacing::MachinePacer;
pub use server::{AgentServer, AgentServerError};
