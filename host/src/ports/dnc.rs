//! The partner at the serial line in DNC operation: sends a file, standard input or the
//! bytes of a serial port, and reads only as far ahead as the control has space.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use gsk_core::cnc::{Cnc, DncInput};
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, EmulatorInput};
use gsk_runner::partner::{DncReceiver, PartnerWait, connect_partner, pass_characters};

use crate::message_format::describe_io_error;
use crate::platform::is_serial_port;
use crate::ports::{self, Port, PortError};

/// Name of the file in the transfer folder of the data directory that is sent in DNC when no
/// other source is named.
pub const FILE_IN_FOLDER: &str = "DNC.CNC";

/// Greatest number of bytes of one read.
const CHUNK_BYTES: usize = 4096;
/// Greatest number of chunks that the reader reads in advance for the control.
const MAX_CHUNKS: usize = 2;
/// Control character (XON) that lets the sending device start. `DC3` (XOFF) stops it.
const DC1: u8 = 0x11;
const DC3: u8 = 0x13;

/// The source of programs for DNC operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DncSource {
    /// A file, sent from its beginning each time the control requests a program.
    File(PathBuf),
    /// Standard input; each program starts where the last one ended.
    Standard,
    /// The name of a serial port; the control starts and stops the sender with DC1 and DC3.
    Port(String),
}

impl DncSource {
    /// Parses a name of the command line: `-` is standard input, the name of a serial port is
    /// that port, every other name is a file.
    pub fn from_name(name: &Path) -> Self {
        match name.to_str() {
            Some("-") => Self::Standard,
            Some(port) if is_serial_port(name) => Self::Port(port.to_owned()),
            _ => Self::File(name.to_owned()),
        }
    }
}

/// The reason why a DNC source cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
enum SourceError {
    File { path: PathBuf, error: io::Error },
    Port(#[from] PortError),
    Thread(io::Error),
}

impl SourceError {
    fn message(&self) -> Message {
        match self {
            Self::File { path, error } => {
                say::dnc_source_unreadable(path.display(), describe_io_error(error))
            }
            Self::Port(error) => error.message(),
            Self::Thread(error) => say::as_written(error),
        }
    }
}

/// Bytes read from the source, or the error that ended the reading.
type Chunk = io::Result<Vec<u8>>;

#[derive(Debug)]
pub struct DncPartner {
    source: DncSource,
    /// Number of the program request that is being served, as the control counts them.
    call_number: u32,
    chunks: Option<Receiver<Chunk>>,
    /// Channel to the thread that reads a port, which writes the characters DC1 and DC3 to the
    /// port; `None` if no port is open.
    to_port: Option<Sender<u8>>,
    /// The bytes that are being passed to the control.
    chunk: Vec<u8>,
    sent: usize,
}

impl DncPartner {
    /// Creates a partner that sends programs from `source`.
    pub const fn new(source: DncSource) -> Self {
        Self {
            source,
            call_number: 0,
            chunks: None,
            to_port: None,
            chunk: Vec::new(),
            sent: 0,
        }
    }

    /// Opens the source when the control requests a program; an error if it cannot be opened.
    fn open_source(&mut self, cnc: &Cnc) -> Result<(), SourceError> {
        match &self.source {
            DncSource::File(path) => {
                let refused = |error| SourceError::File {
                    path: path.clone(),
                    error,
                };
                let file = File::open(path).map_err(refused)?;
                self.drop_chunk();
                self.chunks = Some(start_reader(file)?);
            }
            DncSource::Standard if self.chunks.is_some() => {}
            DncSource::Standard => self.chunks = Some(start_reader(io::stdin())?),
            DncSource::Port(path) => {
                let baud = cnc.parameters().baud();
                let port = Port::open_with_handshake(path, baud)?;
                self.drop_chunk();
                let (to_port, receiver) = bounded(4);
                let _ = to_port.try_send(DC1);
                self.to_port = Some(to_port);
                self.chunks = Some(start_port_reader(port, receiver)?);
            }
        }
        Ok(())
    }

    /// Breaks off the program that is being sent, because the control went back to a past
    /// moment: the source cannot follow. Its program ends with alarm 086.
    pub fn break_off(&mut self, emulator: &mut Emulator) {
        self.call_number = emulator.cnc().dnc_request_count();
        self.drop_chunk();
        if let Some(to_port) = self.to_port.take() {
            let _ = to_port.try_send(DC3);
        }
        if self.source != DncSource::Standard {
            self.chunks = None;
        }
        if emulator.cnc().programs().dnc_buffer().is_some() {
            let reason = say::serial_partner_gone();
            emulator.apply(EmulatorInput::Dnc(DncInput::Failed(reason)));
        }
    }

    fn drop_chunk(&mut self) {
        self.chunk.clear();
        self.sent = 0;
    }

    /// Fetches the next chunk; returns `false` if none has arrived. Reports the end of the
    /// source or its error to the control.
    fn fetch_chunk(&mut self, line: &mut dyn DncReceiver, wait: PartnerWait) -> bool {
        let Some(chunks) = &self.chunks else {
            line.pass(DncInput::Complete);
            return false;
        };
        let chunk = match wait {
            PartnerWait::Allowed => chunks.recv().map_err(|_| TryRecvError::Disconnected),
            PartnerWait::Forbidden => chunks.try_recv(),
        };
        match chunk {
            Ok(Ok(characters)) => {
                (self.chunk, self.sent) = (characters, 0);
                return true;
            }
            Ok(Err(error)) => {
                line.pass(DncInput::Failed(ports::failure_message(&error)));
            }
            Err(TryRecvError::Disconnected) => {
                line.pass(DncInput::Complete);
            }
            Err(TryRecvError::Empty) => {}
        }
        false
    }
}

impl gsk_runner::partner::ProgramPartner for DncPartner {
    fn send_text(&mut self, line: &mut dyn DncReceiver, wait: PartnerWait) {
        connect_partner(line);
        let request_count = line.control().dnc_request_count();
        if self.call_number != request_count {
            self.call_number = request_count;
            if let Err(error) = self.open_source(line.control()) {
                line.pass(DncInput::Failed(error.message()));
                return;
            }
        }
        while line.control().dnc_free_characters() > 0 {
            let rest = self.chunk.get(self.sent..).unwrap_or_default();
            if rest.is_empty() && !self.fetch_chunk(line, wait) {
                return;
            }
            let rest = self.chunk.get(self.sent..).unwrap_or_default();
            self.sent += pass_characters(line, rest);
        }
        if line.control().programs().dnc_buffer().is_none()
            && let Some(to_port) = self.to_port.take()
        {
            let _ = to_port.try_send(DC3);
            self.chunks = None;
        }
    }
}

/// Starts a thread that reads `source`, only as far ahead as the channel has space. Returns the
/// channel with the chunks. Returns an error if the system starts no thread.
fn start_reader(mut source: impl Read + Send + 'static) -> Result<Receiver<Chunk>, SourceError> {
    start_thread(move |chunks| {
        let mut buffer = vec![0; CHUNK_BYTES];
        loop {
            let chunk = match source.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => Ok(buffer[..count].to_vec()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => Err(error),
            };
            let failed = chunk.is_err();
            if chunks.send(chunk).is_err() || failed {
                return;
            }
        }
    })
}

/// Starts a thread that reads a port and writes the characters from `to_send` to it. Returns the
/// channel with the chunks. Returns an error if the system starts no thread.
fn start_port_reader(
    mut port: Port,
    to_send: Receiver<u8>,
) -> Result<Receiver<Chunk>, SourceError> {
    start_thread(move |chunks| {
        loop {
            let mut disconnected = false;
            loop {
                match to_send.try_recv() {
                    Ok(character) => {
                        // If the port is gone, the next read reports it.
                        let _ = port.write(&[character]);
                    }
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => {
                        disconnected = true;
                        break;
                    }
                }
            }
            if disconnected {
                return;
            }
            let chunk = match port.read() {
                Ok(characters) if characters.is_empty() => continue,
                chunk => chunk,
            };
            let failed = chunk.is_err();
            if chunks.send(chunk).is_err() || failed {
                let _ = port.write(&[DC3]);
                return;
            }
        }
    })
}

fn start_thread(
    work: impl FnOnce(&Sender<Chunk>) + Send + 'static,
) -> Result<Receiver<Chunk>, SourceError> {
    let (send, receive) = bounded(MAX_CHUNKS);
    thread::Builder::new()
        .name("dnc".to_owned())
        .spawn(move || work(&send))
        .map_err(SourceError::Thread)?;
    Ok(receive)
}
