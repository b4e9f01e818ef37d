//! The main loop of the server: messages of the editor and results of the checker thread.

use std::collections::BTreeMap;
use std::sync::Arc;

use crossbeam::channel::{Receiver, SendError, Sender};
use crossbeam::select;
use gsk_core::model::ControlModel;
use gsk_messages::{Language, say};
use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use lsp_types::notification::{
    DidChangeConfiguration, DidChangeTextDocument, DidChangeWatchedFiles, DidCloseTextDocument,
    DidOpenTextDocument, DidSaveTextDocument, Exit, Notification as _, PublishDiagnostics,
    ShowMessage,
};
use lsp_types::request::{CodeLensRequest, Request as _, Shutdown};
use lsp_types::{
    InitializeParams, InitializeResult, MessageType, PublishDiagnosticsParams, ServerInfo,
    ShowMessageParams, Uri,
};
use serde::de::DeserializeOwned;

use super::CheckedControl;
use super::answers;
use super::capabilities::{provided_functions, read_capabilities};
use super::checker::{self, AnalysisJob, AnalysisResult};
use super::convert::uri_to_path;
use super::documents::OpenDocument;
use super::folder::{self, FolderIndexes};
use super::server_state::{EditorCapabilities, ServerState};
use super::{diagnostics, settings};

/// Whether the editor ended the server regularly or disconnected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServerEnd {
    /// The editor sent `shutdown` and `exit`.
    ShutDown,
    /// The editor disconnected, or sent `exit` without `shutdown`.
    Disconnected,
}

/// The reason why the connection to the editor failed.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The editor sent a message that violates the protocol.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// The editor does not read the answers of the server.
    #[error("{}", say::lsp_not_read())]
    NotRead,
}

impl<T> From<SendError<T>> for ServeError {
    fn from(_: SendError<T>) -> Self {
        Self::NotRead
    }
}

/// The language server, with its connection and its state.
struct Server<'a> {
    connection: &'a Connection,
    desk: ServerState,
    /// The control model, which determines the codes that call programs.
    model: ControlModel,
    jobs: Sender<AnalysisJob>,
    results: Receiver<AnalysisResult>,
    shut_down: bool,
}

/// Serves an editor until it ends the server.
///
/// # Errors
/// A message violates the protocol, or the editor does not read the answers.
pub fn serve(
    connection: &Connection,
    control: CheckedControl,
    language: Option<Language>,
) -> Result<ServerEnd, ServeError> {
    let (id, params) = loop {
        let (id, params) = match connection.initialize_start() {
            Ok(request) => request,
            // The editor disconnected before the initialization.
            Err(error) if error.channel_is_disconnected() => return Ok(ServerEnd::Disconnected),
            Err(error) => return Err(error.into()),
        };
        match serde_json::from_value::<InitializeParams>(params) {
            Ok(params) => break (id, params),
            Err(error) => {
                let code = ErrorCode::InvalidParams as i32;
                let response = Response::new_err(id, code, error.to_string());
                connection.sender.send(response.into())?;
            }
        }
    };
    let editor = read_capabilities(&params, &control.setup, language);
    let settings = params
        .initialization_options
        .as_ref()
        .and_then(settings::read_settings);
    let result = InitializeResult {
        capabilities: provided_functions(&editor),
        server_info: Some(ServerInfo {
            name: "gsk980td".to_owned(),
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        }),
    };
    connection
        .sender
        .send(Response::new_ok(id, result).into())?;
    let model = control.setup.memory.model.clone();
    let (jobs, looked) = checker::start_checker(control, editor.reading.language);
    let server = Server {
        connection,
        desk: ServerState {
            editor,
            settings: settings.unwrap_or_default(),
            documents: BTreeMap::new(),
            folders: FolderIndexes::default(),
        },
        model,
        jobs,
        results: looked,
        shut_down: false,
    };
    server.run()
}

/// Whether the main loop continues after a message.
enum LoopStep {
    Continue,
    Stop(ServerEnd),
}

impl Server<'_> {
    fn run(mut self) -> Result<ServerEnd, ServeError> {
        loop {
            let next = select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(message) => self.handle_message(message)?,
                    Err(_) => LoopStep::Stop(ServerEnd::Disconnected),
                },
                recv(self.results) -> looked => {
                    if let Ok(looked) = looked {
                        self.publish_analysis(looked)?;
                    }
                    LoopStep::Continue
                }
            };
            if let LoopStep::Stop(ended) = next {
                for document in self.desk.documents.values() {
                    document.cancel_analysis();
                }
                return Ok(ended);
            }
        }
    }

    fn handle_message(&mut self, message: Message) -> Result<LoopStep, ServeError> {
        match message {
            Message::Request(request) => self.handle_request(request)?,
            Message::Notification(it) if it.method == Exit::METHOD => {
                let after_shutdown = self.shut_down;
                return Ok(LoopStep::Stop(match after_shutdown {
                    true => ServerEnd::ShutDown,
                    false => ServerEnd::Disconnected,
                }));
            }
            Message::Notification(_) if self.shut_down => {}
            Message::Notification(notification) => self.handle_notification(notification)?,
            // The server sends no requests to the editor.
            Message::Response(_) => {}
        }
        Ok(LoopStep::Continue)
    }

    fn send(&self, message: impl Into<Message>) -> Result<(), ServeError> {
        Ok(self.connection.sender.send(message.into())?)
    }

    fn handle_request(&mut self, request: Request) -> Result<(), ServeError> {
        if self.shut_down {
            let text = say::lsp_shut_down().text(self.desk.editor.reading.language);
            let code = ErrorCode::InvalidRequest as i32;
            return self.send(Response::new_err(request.id, code, text));
        }
        if request.method == Shutdown::METHOD {
            self.shut_down = true;
            return self.send(Response::new_ok(request.id, ()));
        }
        if request.method == CodeLensRequest::METHOD
            && let Some(document) = answers::document_of(&mut self.desk, &request)
            && document.analysis.is_none()
        {
            // The running analysis answers this request.
            document.waiting_requests.push(request.id);
            return Ok(());
        }
        let (response, notice) = answers::answer(&mut self.desk, request);
        if let Some(message) = notice {
            let params = ShowMessageParams {
                typ: MessageType::WARNING,
                message: message.text(self.desk.editor.reading.language),
            };
            self.send(Notification::new(ShowMessage::METHOD.to_owned(), params))?;
        }
        self.send(response)
    }

    fn handle_notification(&mut self, notification: Notification) -> Result<(), ServeError> {
        match notification.method.as_str() {
            DidOpenTextDocument::METHOD => {
                if let Some(params) = parse_params::<DidOpenTextDocument>(notification) {
                    let document = params.text_document;
                    let (uri, path) = (document.uri.clone(), uri_to_path(&document.uri));
                    let opened =
                        OpenDocument::new(document.uri, path, document.version, document.text);
                    if let Some(before) =
                        self.desk.documents.insert(uri.as_str().to_owned(), opened)
                    {
                        before.cancel_analysis();
                    }
                    self.desk.folders.clear();
                    self.start_analysis_with_callers(&uri)?;
                }
            }
            DidChangeTextDocument::METHOD => {
                let Some(params) = parse_params::<DidChangeTextDocument>(notification) else {
                    return Ok(());
                };
                let uri = params.text_document.uri;
                let encoding = self.desk.editor.encoding;
                if let Some(document) = self.desk.documents.get_mut(uri.as_str()) {
                    let version = params.text_document.version;
                    document.apply_changes(version, params.content_changes, encoding);
                    self.start_analysis_with_callers(&uri)?;
                }
            }
            DidSaveTextDocument::METHOD | DidChangeWatchedFiles::METHOD => {
                self.desk.folders.clear();
                for uri in self.uris() {
                    self.start_analysis(&uri)?;
                }
            }
            DidCloseTextDocument::METHOD => {
                if let Some(params) = parse_params::<DidCloseTextDocument>(notification) {
                    self.close(&params.text_document.uri)?;
                }
            }
            DidChangeConfiguration::METHOD => {
                let params = parse_params::<DidChangeConfiguration>(notification);
                let settings = params.and_then(|it| settings::read_settings(&it.settings));
                if let Some(settings) = settings {
                    self.desk.settings = settings;
                }
            }
            "$/cancelRequest" => self.cancel(&notification)?,
            _ => {}
        }
        Ok(())
    }

    fn uris(&self) -> Vec<Uri> {
        self.desk
            .documents
            .values()
            .map(|document| document.uri.clone())
            .collect()
    }

    /// Cancels a waiting code lens request; all other requests are already answered.
    fn cancel(&mut self, notification: &Notification) -> Result<(), ServeError> {
        let id = notification.params.get("id");
        let Some(id) = id.and_then(|id| serde_json::from_value(id.clone()).ok()) else {
            return Ok(());
        };
        for document in self.desk.documents.values_mut() {
            let position = document
                .waiting_requests
                .iter()
                .position(|waiting| *waiting == id);
            if let Some(at) = position {
                document.waiting_requests.remove(at);
                let code = ErrorCode::RequestCanceled as i32;
                return self.send(Response::new_err(id, code, String::new()));
            }
        }
        Ok(())
    }

    fn close(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let Some(document) = self.desk.documents.remove(uri.as_str()) else {
            return Ok(());
        };
        document.cancel_analysis();
        self.refuse_requests(document.waiting_requests)?;
        self.desk.folders.clear();
        self.publish(uri.clone(), None, Vec::new())
    }

    /// Refuses requests because their document has changed or was closed.
    fn refuse_requests(&self, waiting: Vec<lsp_server::RequestId>) -> Result<(), ServeError> {
        for id in waiting {
            let code = ErrorCode::ContentModified as i32;
            self.send(Response::new_err(id, code, String::new()))?;
        }
        Ok(())
    }

    /// Analyses a changed document and the open documents that call it.
    fn start_analysis_with_callers(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let path = self
            .desk
            .documents
            .get(uri.as_str())
            .and_then(|it| it.path.clone());
        let calls = |document: &&OpenDocument| {
            document.uri != *uri
                && document
                    .called_programs
                    .iter()
                    .any(|found| Some(&found.path) == path.as_ref())
        };
        let callers: Vec<Uri> = (self.desk.documents.values().filter(calls))
            .map(|document| document.uri.clone())
            .collect();
        self.start_analysis(uri)?;
        for caller in callers {
            self.start_analysis(&caller)?;
        }
        Ok(())
    }

    /// Sends the text of a document to the checker thread.
    fn start_analysis(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let Some(document) = self.desk.documents.get(uri.as_str()) else {
            return Ok(());
        };
        let found = match &document.path {
            None => Vec::new(),
            Some(path) => {
                let index = self
                    .desk
                    .folders
                    .index_for(path, self.desk.documents.values());
                let read =
                    |path: &std::path::Path| folder::read_text(path, self.desk.documents.values());
                folder::find_called_programs(&document.text, &index, &self.model, &read)
            }
        };
        let Some(document) = self.desk.documents.get_mut(uri.as_str()) else {
            return Ok(());
        };
        document.called_programs = Arc::new(found);
        let waiting = core::mem::take(&mut document.waiting_requests);
        let job = AnalysisJob {
            uri: uri.clone(),
            version: document.version,
            path: document.path.clone(),
            text: Arc::clone(&document.text),
            called_programs: Arc::clone(&document.called_programs),
            is_wanted: document.begin_analysis(),
        };
        self.jobs.send(job)?;
        self.refuse_requests(waiting)
    }

    /// Sends the findings of an analysis to the editor and answers the requests that wait for
    /// it.
    fn publish_analysis(&mut self, result: AnalysisResult) -> Result<(), ServeError> {
        let EditorCapabilities {
            encoding,
            reading: reader,
            ..
        } = self.desk.editor;
        let Some(document) = self.desk.documents.get_mut(result.uri.as_str()) else {
            return Ok(());
        };
        if document.version != result.version {
            return Ok(());
        }
        document.store_analysis(result.structure, Arc::clone(&result.analysis));
        let all = diagnostics::diagnostics(document, &result.analysis, &self.desk.editor);
        let lenses = answers::code_lenses(document, encoding, reader);
        let waiting = core::mem::take(&mut document.waiting_requests);
        self.publish(result.uri, Some(result.version), all)?;
        for id in waiting {
            self.send(Response::new_ok(id, &lenses))?;
        }
        Ok(())
    }

    fn publish(
        &self,
        uri: Uri,
        version: Option<i32>,
        diagnostics: Vec<lsp_types::Diagnostic>,
    ) -> Result<(), ServeError> {
        let params = PublishDiagnosticsParams::new(uri, diagnostics, version);
        self.send(Notification::new(
            PublishDiagnostics::METHOD.to_owned(),
            params,
        ))
    }
}

/// Parses the parameters of a notification. Malformed ones are logged and give `None`: a
/// notification has no answer.
fn parse_params<N>(notification: Notification) -> Option<N::Params>
where
    N: lsp_types::notification::Notification,
    N::Params: DeserializeOwned,
{
    serde_json::from_value(notification.params)
        .inspect_err(|error| tracing::warn!("{}: {error}", N::METHOD))
        .ok()
}
