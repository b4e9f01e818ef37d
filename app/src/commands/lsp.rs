//! `lsp`: an editor's questions about part programs, answered on standard input and output.
//!
//! ```text
//!   editor  -> requests, changes of texts ->  server  -> texts to be looked through -> looker
//!           <- answers, what is wrong     <-          <- what was found             <-
//! ```
//!
//! The server answers at once what the text alone says; what needs a look through the
//! program (what is wrong, how long it takes) is a thread's, which drops a look when the
//! text has changed.

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

/// Exit code: the editor went away without saying so.
const ABANDONED: u8 = 1;

/// Whose programs are looked through, and what from.
pub struct Control {
    /// Its memory; that of a mill has programs alone.
    setup: Setup,
    /// Of a mill.
    mill: Option<MillSetup>,
}

/// Serves the editor that started the program.
///
/// # Errors
/// Options that cannot be had, and messages that are none of the protocol.
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
