//! The main loop of the server: messages of the editor and results of the checker thread.

use std::collections::BTreeMap;
use std::sync::Arc;

use crossbeam::channel::{Receiver, SendError, Sender};
use crossbeam::select;
use gsk_core::model::ControlModel;
use gsk_core::setup::Setup;
use gsk_language::ReadingContext;
use gsk_messages::{Language, say};
use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use lsp_types::notification::{
    DidChangeConfiguration, DidChangeTextDocument, DidChangeWatchedFiles, DidCloseTextDocument,
    DidOpenTextDocument, DidSaveTextDocument, Exit, Notification as _, PublishDiagnostics,
    ShowMessage,
};
use lsp_types::request::{CodeLensRequest, Request as _, Shutdown};
use lsp_types::{
    CodeLensOptions, CompletionOptions, FoldingRangeProviderCapability, HoverProviderCapability,
    InitializeParams, InitializeResult, MarkupKind, MessageType, OneOf, PublishDiagnosticsParams,
    RenameOptions, SaveOptions, ServerCapabilities, ServerInfo, ShowMessageParams,
    TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
    TextDocumentSyncSaveOptions, Uri, WorkDoneProgressOptions,
};
use serde::de::DeserializeOwned;

use super::Control;
use super::answers;
use super::convert::{Encoding, path_of};
use super::desk::{Desk, Editor};
use super::documents::Document;
use super::folder::{self, Folders};
use super::looker::{self, Job, Looked};
use super::{places, settings};
use crate::cli::is_chinese;

/// Why the server ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The editor sent `shutdown` and `exit`.
    AsAsked,
    /// The editor disconnected, or sent `exit` without `shutdown`.
    Abandoned,
}

/// Why the connection failed.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// A message violates the protocol.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// The editor does not read the answers.
    #[error("{}", say::lsp_not_read())]
    NotRead,
}

impl<T> From<SendError<T>> for ServeError {
    fn from(_: SendError<T>) -> Self {
        Self::NotRead
    }
}

/// The server with its connection and its state.
struct Server<'a> {
    connection: &'a Connection,
    desk: Desk,
    /// The control model: it determines which codes call programs.
    model: ControlModel,
    jobs: Sender<Job>,
    looked: Receiver<Looked>,
    shut_down: bool,
}

/// Serves an editor until it ends the server.
///
/// # Errors
/// A message violates the protocol, or the editor does not read the answers.
pub fn serve(
    connection: &Connection,
    control: Control,
    language: Option<Language>,
) -> Result<Ended, ServeError> {
    let (id, params) = loop {
        let (id, params) = match connection.initialize_start() {
            Ok(asked) => asked,
            // The editor disconnected before the initialization.
            Err(error) if error.channel_is_disconnected() => return Ok(Ended::Abandoned),
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
    let editor = editor(&params, &control.setup, language);
    let style = params
        .initialization_options
        .as_ref()
        .and_then(settings::style);
    let result = InitializeResult {
        capabilities: capabilities(editor.encoding),
        server_info: Some(ServerInfo {
            name: "gsk980td".to_owned(),
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        }),
    };
    connection
        .sender
        .send(Response::new_ok(id, result).into())?;
    let model = control.setup.memory.model.clone();
    let (jobs, looked) = looker::start(control, editor.reader.language);
    let server = Server {
        connection,
        desk: Desk {
            editor,
            style: style.unwrap_or_default(),
            open: BTreeMap::new(),
            folders: Folders::default(),
        },
        model,
        jobs,
        looked,
        shut_down: false,
    };
    server.run()
}

/// The capabilities of an editor from its initialization message.
fn editor(params: &InitializeParams, setup: &Setup, language: Option<Language>) -> Editor {
    let general = params.capabilities.general.as_ref();
    let offered = general.and_then(|it| it.position_encodings.as_deref());
    let text_document = params.capabilities.text_document.as_ref();
    let item = text_document
        .and_then(|it| it.completion.as_ref())
        .and_then(|it| it.completion_item.as_ref());
    let hover = text_document.and_then(|it| it.hover.as_ref());
    let formats = [
        hover.and_then(|it| it.content_format.as_deref()),
        item.and_then(|it| it.documentation_format.as_deref()),
    ];
    let [hover, proposal] =
        formats.map(|it| it.is_some_and(|it| it.contains(&MarkupKind::Markdown)));
    let chinese = params.locale.as_deref().is_some_and(is_chinese);
    let by_locale = if chinese { Language::Zh } else { Language::En };
    Editor {
        encoding: Encoding::of(offered),
        snippets: item.and_then(|it| it.snippet_support).unwrap_or(false),
        markdown: (hover, proposal),
        reader: ReadingContext {
            model: setup.memory.model.id(),
            macro_b: setup.memory.settings.macro_b || setup.memory.model.id().is_mill(),
            language: language.unwrap_or(by_locale),
        },
    }
}

/// The capabilities of the server.
fn capabilities(encoding: Encoding) -> ServerCapabilities {
    let triggers = ["G", "M", "T", "P", "Q", " "];
    ServerCapabilities {
        position_encoding: Some(encoding.kind()),
        text_document_sync: Some(TextDocumentSyncCapability::Options(
            TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(TextDocumentSyncKind::INCREMENTAL),
                save: Some(TextDocumentSyncSaveOptions::SaveOptions(
                    SaveOptions::default(),
                )),
                ..TextDocumentSyncOptions::default()
            },
        )),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(triggers.map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        folding_range_provider: Some(FoldingRangeProviderCapability::Simple(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        document_range_formatting_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        code_lens_provider: Some(CodeLensOptions {
            resolve_provider: Some(false),
        }),
        ..ServerCapabilities::default()
    }
}

/// Whether the main loop continues after a message.
enum Next {
    GoOn,
    End(Ended),
}

impl Server<'_> {
    fn run(mut self) -> Result<Ended, ServeError> {
        loop {
            let next = select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(message) => self.take(message)?,
                    Err(_) => Next::End(Ended::Abandoned),
                },
                recv(self.looked) -> looked => {
                    if let Ok(looked) = looked {
                        self.show(looked)?;
                    }
                    Next::GoOn
                }
            };
            if let Next::End(ended) = next {
                for document in self.desk.open.values() {
                    document.give_up_look();
                }
                return Ok(ended);
            }
        }
    }

    fn take(&mut self, message: Message) -> Result<Next, ServeError> {
        match message {
            Message::Request(request) => self.request(request)?,
            Message::Notification(it) if it.method == Exit::METHOD => {
                let asked = self.shut_down;
                return Ok(Next::End(match asked {
                    true => Ended::AsAsked,
                    false => Ended::Abandoned,
                }));
            }
            Message::Notification(_) if self.shut_down => {}
            Message::Notification(notification) => self.notified(notification)?,
            // The server sends no requests to the editor.
            Message::Response(_) => {}
        }
        Ok(Next::GoOn)
    }

    fn send(&self, message: impl Into<Message>) -> Result<(), ServeError> {
        Ok(self.connection.sender.send(message.into())?)
    }

    fn request(&mut self, request: Request) -> Result<(), ServeError> {
        if self.shut_down {
            let said = say::lsp_shut_down().text(self.desk.editor.reader.language);
            let code = ErrorCode::InvalidRequest as i32;
            return self.send(Response::new_err(request.id, code, said));
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
            document.waiting.push(request.id);
            return Ok(());
        }
        let (response, notice) = answers::answer(&mut self.desk, request);
        if let Some(message) = notice {
            let params = ShowMessageParams {
                typ: MessageType::WARNING,
                message: message.text(self.desk.editor.reader.language),
            };
            self.send(Notification::new(ShowMessage::METHOD.to_owned(), params))?;
        }
        self.send(response)
    }

    fn notified(&mut self, notification: Notification) -> Result<(), ServeError> {
        match notification.method.as_str() {
            DidOpenTextDocument::METHOD => {
                if let Some(params) = params::<DidOpenTextDocument>(notification) {
                    let document = params.text_document;
                    let (uri, path) = (document.uri.clone(), path_of(&document.uri));
                    let opened = Document::new(document.uri, path, document.version, document.text);
                    if let Some(before) = self.desk.open.insert(uri.as_str().to_owned(), opened) {
                        before.give_up_look();
                    }
                    self.desk.folders.forget();
                    self.look_with_callers(&uri)?;
                }
            }
            DidChangeTextDocument::METHOD => {
                let Some(params) = params::<DidChangeTextDocument>(notification) else {
                    return Ok(());
                };
                let uri = params.text_document.uri;
                let encoding = self.desk.editor.encoding;
                if let Some(document) = self.desk.open.get_mut(uri.as_str()) {
                    let version = params.text_document.version;
                    document.change(version, params.content_changes, encoding);
                    self.look_with_callers(&uri)?;
                }
            }
            DidSaveTextDocument::METHOD | DidChangeWatchedFiles::METHOD => {
                self.desk.folders.forget();
                for uri in self.uris() {
                    self.look(&uri)?;
                }
            }
            DidCloseTextDocument::METHOD => {
                if let Some(params) = params::<DidCloseTextDocument>(notification) {
                    self.close(&params.text_document.uri)?;
                }
            }
            DidChangeConfiguration::METHOD => {
                let params = params::<DidChangeConfiguration>(notification);
                if let Some(style) = params.and_then(|it| settings::style(&it.settings)) {
                    self.desk.style = style;
                }
            }
            "$/cancelRequest" => self.cancel(&notification)?,
            _ => {}
        }
        Ok(())
    }

    fn uris(&self) -> Vec<Uri> {
        self.desk
            .open
            .values()
            .map(|document| document.uri.clone())
            .collect()
    }

    /// Cancels a waiting request; all other requests are already answered.
    fn cancel(&mut self, notification: &Notification) -> Result<(), ServeError> {
        let id = notification.params.get("id");
        let Some(id) = id.and_then(|id| serde_json::from_value(id.clone()).ok()) else {
            return Ok(());
        };
        for document in self.desk.open.values_mut() {
            let waits = document.waiting.iter().position(|waiting| *waiting == id);
            if let Some(at) = waits {
                document.waiting.remove(at);
                let code = ErrorCode::RequestCanceled as i32;
                return self.send(Response::new_err(id, code, String::new()));
            }
        }
        Ok(())
    }

    fn close(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let Some(document) = self.desk.open.remove(uri.as_str()) else {
            return Ok(());
        };
        document.give_up_look();
        self.refuse(document.waiting)?;
        self.desk.folders.forget();
        self.publish(uri.clone(), None, Vec::new())
    }

    /// Refuses requests whose text has changed or was closed.
    fn refuse(&self, waiting: Vec<lsp_server::RequestId>) -> Result<(), ServeError> {
        for id in waiting {
            let code = ErrorCode::ContentModified as i32;
            self.send(Response::new_err(id, code, String::new()))?;
        }
        Ok(())
    }

    /// Analyses a changed document and the open documents that call it.
    fn look_with_callers(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let path = self
            .desk
            .open
            .get(uri.as_str())
            .and_then(|it| it.path.clone());
        let calls = |document: &&Document| {
            document.uri != *uri
                && document
                    .found
                    .iter()
                    .any(|found| Some(&found.path) == path.as_ref())
        };
        let callers: Vec<Uri> = (self.desk.open.values().filter(calls))
            .map(|document| document.uri.clone())
            .collect();
        self.look(uri)?;
        for caller in callers {
            self.look(&caller)?;
        }
        Ok(())
    }

    /// Sends a document to the checker thread.
    fn look(&mut self, uri: &Uri) -> Result<(), ServeError> {
        let Some(document) = self.desk.open.get(uri.as_str()) else {
            return Ok(());
        };
        let found = match &document.path {
            None => Vec::new(),
            Some(path) => {
                let index = self.desk.folders.beside(path, self.desk.open.values());
                let read = |path: &std::path::Path| folder::text_of(path, self.desk.open.values());
                folder::called(&document.text, &index, &self.model, &read)
            }
        };
        let Some(document) = self.desk.open.get_mut(uri.as_str()) else {
            return Ok(());
        };
        document.found = Arc::new(found);
        let waiting = core::mem::take(&mut document.waiting);
        let job = Job {
            uri: uri.clone(),
            version: document.version,
            path: document.path.clone(),
            text: Arc::clone(&document.text),
            found: Arc::clone(&document.found),
            wanted: document.begin_look(),
        };
        self.jobs.send(job)?;
        self.refuse(waiting)
    }

    /// Publishes the result of an analysis.
    fn show(&mut self, looked: Looked) -> Result<(), ServeError> {
        let Editor {
            encoding, reader, ..
        } = self.desk.editor;
        let Some(document) = self.desk.open.get_mut(looked.uri.as_str()) else {
            return Ok(());
        };
        if document.version != looked.version {
            return Ok(());
        }
        document.looked(looked.structure, Arc::clone(&looked.analysis));
        let all = places::diagnostics(document, &looked.analysis, encoding, reader.language);
        let lenses = answers::lenses_of(document, encoding, reader);
        let waiting = core::mem::take(&mut document.waiting);
        self.publish(looked.uri, Some(looked.version), all)?;
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

/// The parameters of a notification. Malformed ones are logged and ignored: a notification
/// has no answer.
fn params<N>(notification: Notification) -> Option<N::Params>
where
    N: lsp_types::notification::Notification,
    N::Params: DeserializeOwned,
{
    serde_json::from_value(notification.params)
        .inspect_err(|error| tracing::warn!("{}: {error}", N::METHOD))
        .ok()
}
