//! The MTConnect agent without its network.
//!
//! | Module | What |
//! |---|---|
//! | `model` | components and data items of the lathe |
//! | `value`, `readers` | the value of a data item, and how it is read from control and lathe |
//! | `reading` | the values and faults of all data items at one moment |
//! | `buffer` | observations with their sequence numbers |
//! | `assets` | tools of the job and the selected program |
//! | `query` | requests of a client, and why one is refused |
//! | `path_filter` | the part of XPath that selects components and data items |
//! | `documents` | the documents as XML |
//! | `agent` | answers requests from buffer and assets |
//! | `status` | the state for the page that a browser shows |
//!
//! The caller supplies the time and moves the documents.

mod agent;
mod agent_identity;
mod assets;
mod buffer;
mod device_description;
mod documents;
pub mod model;
mod path_filter;
pub mod query;
mod readers;
mod reading;
mod status;
mod time_stamp;
mod value;
mod xml;

pub use agent::{Agent, SampleDocument};
pub use agent_identity::{AgentIdentity, SchemaVersion};
pub use assets::AgentAssets;
pub use device_description::DeviceDescription;
pub use query::{AgentError, AgentRequest};
pub use readers::program_name;
pub use reading::{ActiveFault, FaultLevel, MachineReading};
pub use time_stamp::TimeStamp;
pub use value::{AgentValue, MachineLoad, MachineSource};
