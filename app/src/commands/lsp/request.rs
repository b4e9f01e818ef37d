//! What the answers to all requests share: parameters, documents, results and refusals.

use gsk_language::Position;
use gsk_messages::{Message, say};
use lsp_server::Request;
use lsp_types::{TextDocumentPositionParams, Uri};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::documents::OpenDocument;
use super::server_state::ServerState;

/// The result of a request as JSON and a notice for the user, or the refusal.
pub type RequestAnswer = Result<(Value, Option<Message>), RequestRefusal>;

/// The reason why a request is refused.
pub enum RequestRefusal {
    /// The parameters do not fit the method; the value is the reason.
    Params(String),
    NotOpen,
    /// The operation would change the meaning of the program, or does not apply at the
    /// position; holds the reason for the user.
    Failed(Message),
    /// The server does not support this method; the value is its name.
    Method(String),
}

pub fn parse_params<R>(request: Request) -> Result<R::Params, RequestRefusal>
where
    R: lsp_types::request::Request,
    R::Params: DeserializeOwned,
{
    let params = serde_json::from_value(request.params);
    params.map_err(|error| RequestRefusal::Params(error.to_string()))
}

pub fn to_answer(answer: &impl Serialize) -> RequestAnswer {
    let value = serde_json::to_value(answer);
    let value = value.map_err(|error| RequestRefusal::Failed(say::as_written(error)))?;
    Ok((value, None))
}

pub fn find_document<'a>(
    desk: &'a ServerState,
    uri: &Uri,
) -> Result<&'a OpenDocument, RequestRefusal> {
    desk.documents
        .get(uri.as_str())
        .ok_or(RequestRefusal::NotOpen)
}

/// Returns the document of a request and the position in its text; an error if the document is not
/// open.
pub fn document_position<'a>(
    desk: &'a ServerState,
    params: &TextDocumentPositionParams,
) -> Result<(&'a OpenDocument, Position), RequestRefusal> {
    let document = find_document(desk, &params.text_document.uri)?;
    let position = desk
        .editor
        .encoding
        .to_text(&document.text, params.position);
    Ok((document, position))
}
