//! `dap`: a debugger that an editor drives over the Debug Adapter Protocol on standard input
//! and output.
//!
//! ```text
//!   editor  -> requests ------> channel -> server  -> DebugSession
//!           <- responses, events        <-         <- stops
//! ```
//!
//! While the program runs the server looks for requests between pieces of the run. The session
//! is deterministic, so the server goes back by running again from an earlier moment.

mod launch;
mod launched_program;
mod protocol;
mod server;
mod stop_points;
mod variables;

use std::io;
use std::thread;

use crossbeam::channel::{Sender, bounded, unbounded};
use gsk_messages::{Language, say};

use super::lsp::framing::read_text;
use super::{CommandError, EXIT_OK};
use crate::cli::DapArgs;
use protocol::Request;

/// Serves the editor that started the program.
///
/// # Errors
/// Malformed messages, and an editor that does not read.
pub fn dap(args: &DapArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let (to_server, requests) = unbounded();
    let (send_result, read_result) = bounded(1);
    thread::spawn(move || {
        let result = read_requests(&to_server);
        // The receiver may be dropped.
        let _ = send_result.send(result);
    });
    let output = io::stdout().lock();
    let served = server::serve(&requests, output, &args.setup, language);
    let read = read_result.try_recv().unwrap_or(Ok(()));
    let end = served.and(read);
    end.map_err(say::dap_ended)?;
    Ok(EXIT_OK)
}

/// Reads requests until the client closes the stream or the server has ended.
fn read_requests(to_server: &Sender<Request>) -> io::Result<()> {
    let mut input = io::stdin().lock();
    while let Some(text) = read_text(&mut input)? {
        let request = serde_json::from_str(&text);
        let request = request.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        if to_server.send(request).is_err() {
            break;
        }
    }
    Ok(())
}
