//! `lsp`: a language server that answers an editor's requests on standard input and output.
//!
//! ```text
//!   editor  -> requests, changes of texts ->  server  -> texts to analyse -> checker
//!           <- answers, diagnostics       <-          <- analyses         <-
//! ```
//!
//! The server answers at once what it can read from the text. Diagnostics and times need a
//! preview of the program: a checker thread makes it and cancels it if the text changes.

mod answers;
mod convert;
mod desk;
mod documents;
mod folder;
mod framing;
mod looker;
mod places;
mod server;
mod settings;
mod streams;

use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_runner::mill::MillSetup;

use super::{CommandError, FINE};
use crate::cli::LspArgs;
use crate::loading;

/// Exit code: the editor disconnected without `shutdown`.
const ABANDONED: u8 = 1;

/// The control that the programs are checked for.
pub struct Control {
    /// Its memory; for a mill only the programs in it are used.
    setup: Setup,
    /// The setup of the mill, if the model is one.
    mill: Option<MillSetup>,
}

/// Serves the editor that started the program.
///
/// # Errors
/// Options that cannot be applied, and malformed messages.
pub fn lsp(args: &LspArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let control = if args.setup.model().is_mill() {
        let (mill, setup) = loading::mill(&args.setup)?;
        Control {
            setup,
            mill: Some(mill),
        }
    } else {
        let setup = loading::setup(&args.setup, None, language)?;
        Control { setup, mill: None }
    };
    let (connection, streams) = streams::open();
    let ended = server::serve(&connection, control, language);
    drop(connection);
    let streams = streams.end();
    let ended = ended.map_err(|error| CommandError::Editor(error.to_string()))?;
    streams.map_err(|error| CommandError::Editor(error.to_string()))?;
    Ok(match ended {
        server::Ended::AsAsked => FINE,
        server::Ended::Abandoned => ABANDONED,
    })
}
