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
mod looker;
mod places;
mod server;
mod settings;
mod streams;

use super::{CommandError, FINE};
use crate::cli::LspArgs;
use crate::loading;

/// Exit code: the editor went away without saying so.
const ABANDONED: u8 = 1;

/// Serves the editor that started the program.
///
/// # Errors
/// Options that cannot be had, and messages that are none of the protocol.
pub fn lsp(args: &LspArgs) -> Result<u8, CommandError> {
    let setup = loading::setup(&args.setup, None, args.lang)?;
    let (connection, streams) = streams::open();
    let ended = server::serve(&connection, setup, args.lang);
    drop(connection);
    let streams = streams.end();
    let ended = ended.map_err(|error| CommandError::Editor(error.to_string()))?;
    streams.map_err(|error| CommandError::Editor(error.to_string()))?;
    Ok(match ended {
        server::Ended::AsAsked => FINE,
        server::Ended::Abandoned => ABANDONED,
    })
}
