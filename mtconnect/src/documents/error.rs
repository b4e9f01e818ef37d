//! The document that explains why a request is refused.

use super::{DocumentContext, ERROR_DOCUMENT, add_sizes};
use crate::buffer::BUFFER_SIZE;
use crate::query::AgentError;

/// Writes the document that reports a refused request.
pub(crate) fn write_error(context: DocumentContext<'_>, error: &AgentError) -> String {
    let mut xml = context.begin(ERROR_DOCUMENT);
    add_sizes(&mut xml, &[("bufferSize", &BUFFER_SIZE)]);
    xml.close();
    xml.open("Errors");
    xml.open("Error")
        .attribute("errorCode", error.code.word())
        .text(&error.reason);
    xml.finish()
}
