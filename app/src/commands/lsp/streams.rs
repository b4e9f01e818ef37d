//! Connects the server to standard input and output. At the end of the connection all
//! messages are written, even after a malformed message of the editor.

use std::io;
use std::thread::{self, JoinHandle};

use crossbeam::channel::{Receiver, Sender, bounded};
use lsp_server::{Connection, Message, Notification};
use lsp_types::notification::{Exit, Notification as _};

use super::framing::read_message;

/// Maximum number of messages that wait for the writer thread.
const WRITE_QUEUE_CAPACITY: usize = 16;

/// The threads that read standard input and write standard output.
pub struct Streams {
    /// Receives the result of the reading thread when it ends.
    read_result: Receiver<io::Result<()>>,
    writer: JoinHandle<io::Result<()>>,
}

pub fn open_streams() -> (Connection, Streams) {
    let (to_writer, written) = bounded(WRITE_QUEUE_CAPACITY);
    let (to_server, messages) = bounded(0);
    let (send_result, read) = bounded(1);
    let connection = Connection {
        sender: to_writer,
        receiver: messages,
    };
    thread::spawn(move || {
        // The receiver may be dropped.
        let _ = send_result.send(read_all(&to_server));
        drop(to_server);
    });
    let streams = Streams {
        read_result: read,
        writer: thread::spawn(move || write_all(&written)),
    };
    (connection, streams)
}

fn read_all(to_server: &Sender<Message>) -> io::Result<()> {
    let mut input = io::stdin().lock();
    while let Some(message) = read_message(&mut input)? {
        let is_exit = |it: &Notification| it.method == Exit::METHOD;
        let last = matches!(&message, Message::Notification(it) if is_exit(it));
        if to_server.send(message).is_err() || last {
            break;
        }
    }
    Ok(())
}

fn write_all(written: &Receiver<Message>) -> io::Result<()> {
    let mut output = io::stdout().lock();
    written
        .iter()
        .try_for_each(|message| message.write(&mut output))
}

impl Streams {
    /// Waits until all messages are written. The caller must have dropped the connection.
    ///
    /// # Errors
    /// The editor does not read, or has sent a malformed message.
    pub fn join(self) -> io::Result<()> {
        let written = self.writer.join().unwrap_or(Ok(()));
        // A reader that still waits for the editor ends with the process.
        let read = self.read_result.try_recv().unwrap_or(Ok(()));
        read.and(written)
    }
}
