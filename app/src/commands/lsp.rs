//! `lsp`: a language server that answers an editor's requests on standard input and output.
//!
//! ```text
//!   editor  -> requests, changes of texts ->  server  -> texts to analyse -> checker
//!           <- answers, diagnostics       <-          <- analyses         <-
//! ```
//!
//! The server answers at once what it can read from the text. Diagnostics and times need a
//! preview of the program: a checker thread makes it and cancels it if the text changes.

mod actions;
mod answers;
mod capabilities;
mod checker;
mod convert;
mod diagnostics;
mod documents;
mod folder;
pub mod framing;
mod hints;
mod request;
mod server;
mod server_state;
mod settings;
mod streams;
mod workspace;

use gsk_core::setup::Setup;
use gsk_host::loading;
use gsk_messages::{Language, say};
use gsk_runner::mill::MillSetup;

use super::{CommandError, EXIT_OK};
use crate::cli::LspArgs;

/// Exit code if the editor disconnected without `shutdown`.
const EXIT_DISCONNECTED: u8 = 1;

/// The control model and memory for which programs are checked.
pub struct CheckedControl {
    /// Memory and settings of the control; for a mill only the programs in it are used.
    setup: Setup,
    /// The setup of the mill; `None` if the model is a lathe.
    mill: Option<MillSetup>,
}

/// Serves the editor that started the program.
///
/// # Errors
/// Options that cannot be applied, and malformed messages.
pub fn lsp(args: &LspArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let control = if args.setup.selected_model().is_mill() {
        let (mill, setup) = loading::mill_setup(&args.setup)?;
        CheckedControl {
            setup,
            mill: Some(mill),
        }
    } else {
        let setup = loading::command_setup(&args.setup, None, language)?;
        CheckedControl { setup, mill: None }
    };
    let (connection, streams) = streams::open_streams();
    let end = server::serve(&connection, control, language);
    drop(connection);
    let streams = streams.join();
    let end = end.map_err(say::lsp_ended)?;
    streams.map_err(say::lsp_ended)?;
    Ok(match end {
        server::ServerEnd::ShutDown => EXIT_OK,
        server::ServerEnd::Disconnected => EXIT_DISCONNECTED,
    })
}
