//! What identifies an agent: its lathe, its address, the version of its documents.

use core::fmt;

use crate::assets::text_hash;
use crate::device_description::DeviceDescription;
use crate::model::Component;

/// A version of the schemas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SchemaVersion {
    /// The first number: 2 of 2.5.
    pub major: u8,
    /// The second number: 5 of 2.5.
    pub minor: u8,
}

impl SchemaVersion {
    /// The versions in whose schemas the documents are valid. From 2.6 on errors have other
    /// elements.
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

    /// The version that a text names; `None` if the documents are not valid in it.
    pub fn from_text(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.to_string() == text)
    }
}

impl Default for SchemaVersion {
    /// The oldest version of the second generation: the clients of later ones read it.
    fn default() -> Self {
        Self::new(2, 0)
    }
}

impl fmt::Display for SchemaVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

/// What identifies an agent and its lathe.
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
    /// Number of this run of the agent: sequence numbers begin again with another number.
    pub instance_id: u64,
    /// Moment of the start, ms since 1970.
    pub started_ms: u64,
    /// Version of the schemas.
    pub schema: SchemaVersion,
    /// The lathe.
    pub description: DeviceDescription,
}

impl AgentIdentity {
    /// Name and identifier of a device: of the lathe or of the agent.
    pub(crate) fn name_and_uuid(&self, device: &Component) -> (&str, String) {
        match device.name {
            Some(name) => (name, format!("{}.{name}", self.uuid)),
            None => (&self.name, self.uuid.clone()),
        }
    }

    /// The identity of the agent that listens at `address` since `started_ms`.
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
