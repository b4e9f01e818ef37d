//! What identifies an agent: its lathe, its address, the version of its documents.

use core::fmt;

use crate::assets::text_hash;
use crate::device_description::DeviceDescription;
use crate::model::Component;

/// A version of the MTConnect schemas, such as 2.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SchemaVersion {
    /// First number of the version: 2 of 2.5.
    pub major: u8,
    /// Second number of the version: 5 of 2.5.
    pub minor: u8,
}

impl SchemaVersion {
    /// The schema versions in which the documents are valid. From 2.6 on, error documents have
    /// other elements.
    pub const ALL: [Self; 7] = [
        Self::new(1, 8),
        Self::new(2, 0),
        Self::new(2, 1),
        Self::new(2, 2),
        Self::new(2, 3),
        Self::new(2, 4),
        Self::new(2, 5),
    ];

    const fn new(major: u8, minor: u8) -> Self {
        Self { major, minor }
    }

    /// Parses a schema version such as `2.0`; `None` for a version in which the documents are not
    /// valid.
    pub fn from_text(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.to_string() == text)
    }
}

impl Default for SchemaVersion {
    /// Returns version 2.0, the oldest of the second generation, which clients of all later
    /// versions can read.
    fn default() -> Self {
        Self::new(2, 0)
    }
}

impl fmt::Display for SchemaVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

/// Names, addresses and versions that identify an agent and its lathe.
#[derive(Clone, Debug, PartialEq)]
pub struct AgentIdentity {
    /// Name of the lathe in addresses: `GSK980TD`.
    pub name: String,
    /// Identifier of the lathe, the same at every start.
    pub uuid: String,
    /// Address at which the agent listens.
    pub sender: String,
    /// Start of the addresses of the agent's files: `http://127.0.0.1:5000`.
    pub base_url: String,
    /// Number of this run of the agent. A client that reads another number knows that the sequence
    /// numbers have restarted.
    pub instance_id: u64,
    /// Time at which the agent started, ms since 1970.
    pub started_ms: u64,
    /// Version of the MTConnect schemas that the documents follow.
    pub schema: SchemaVersion,
    /// Name, model, travel and speed of the lathe.
    pub description: DeviceDescription,
}

impl AgentIdentity {
    /// Returns name and identifier (UUID) of a device component: of the lathe or of the agent.
    pub(crate) fn name_and_uuid(&self, device: &Component) -> (&str, String) {
        match device.name {
            Some(name) => (name, format!("{}.{name}", self.uuid)),
            None => (&self.name, self.uuid.clone()),
        }
    }

    /// Creates the identity of an agent that has listened at `address` since `started_ms`, ms since
    /// 1970.
    pub fn new(
        description: DeviceDescription,
        schema: SchemaVersion,
        address: &str,
        started_ms: u64,
    ) -> Self {
        let is_word = |character: &char| character.is_ascii_alphanumeric();
        let name: String = description.control_model.chars().filter(is_word).collect();
        let named = format!("{name} {} {address}", description.lathe_name);
        Self {
            uuid: format!("{name}.{:016x}", text_hash(&named)),
            name,
            sender: address.to_owned(),
            base_url: format!("http://{address}"),
            instance_id: (started_ms / 1000).max(1),
            started_ms,
            schema,
            description,
        }
    }
}
