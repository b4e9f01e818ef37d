//! The documents of the agent as XML.

pub(crate) mod assets;
pub(crate) mod error;
pub(crate) mod probe;
pub(crate) mod streams;

use core::fmt::Display;

use crate::agent_identity::AgentIdentity;
use crate::time_stamp::TimeStamp;
use crate::xml::XmlWriter;

/// Name of the document that reports errors and has no device in it.
const ERROR_DOCUMENT: &str = "MTConnectError";

/// Data that the header of every document contains.
#[derive(Clone, Copy)]
pub(crate) struct DocumentContext<'a> {
    pub(crate) identity: &'a AgentIdentity,
    /// Time of the response.
    pub(crate) now: TimeStamp,
}

impl DocumentContext<'_> {
    /// Begins a document of the kind `MTConnectStreams`, and opens its header.
    fn begin(self, document: &'static str) -> XmlWriter {
        let version = self.identity.schema;
        let namespace = format!("urn:mtconnect.org:{document}:{version}");
        let mut xml = XmlWriter::new();
        xml.open(document)
            .attribute("xmlns", &namespace)
            .attribute("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance")
            .attribute(
                "xsi:schemaLocation",
                format_args!(
                    "{namespace} http://schemas.mtconnect.org/schemas/{document}_{version}.xsd"
                ),
            );
        xml.open("Header")
            .attribute("creationTime", self.now)
            .attribute("sender", &self.identity.sender)
            .attribute("instanceId", self.identity.instance_id)
            .attribute("version", format_args!("{version}.0.0"));
        if document != ERROR_DOCUMENT {
            xml.attribute("deviceModelChangeTime", TimeStamp(self.identity.started_ms));
        }
        xml
    }
}

/// Adds attributes with sizes, such as `bufferSize`, to the header.
fn add_sizes(xml: &mut XmlWriter, sizes: &[(&str, &dyn Display)]) {
    for (name, value) in sizes {
        xml.attribute(name, value);
    }
}
