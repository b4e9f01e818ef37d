//! The partner at the serial line in DNC operation: sends a file, standard input or the
//! bytes of a serial port, and reads only as far ahead as the control has space.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use gsk_core::cnc::Cnc;
use gsk_messages::{Message, say};
use gsk_runner::partner::Patience;

use crate::platform::is_serial_port;
use crate::ports::{self, Port, PortError};
use crate::saying::of_system;

/// File in the folder of the data directory that is sent when no other source is named.
pub const IN_FOLDER: &str = "DNC.CNC";

/// Size of a read, bytes.
const CHUNK: usize = 4096;
/// Number of chunks that wait for the control.
const CHUNKS: usize = 2;
/// Reader start and reader stop.
const DC1: u8 = 0x11;
const DC3: u8 = 0x13;

/// Source of the programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A file, sent from its beginning at each call for a program.
    File(PathBuf),
    /// Standard input, which continues where it was.
    Standard,
    /// A serial port; DC1 and DC3 start and stop the sender.
    Port(String),
}

impl Source {
    /// Parses a name of the command line: `-` is standard input, a port is read as one,
    /// every other name is a file.
    pub fn of(name: &Path) -> Self {
        match name.to_str() {
            Some("-") => Self::Standard,
            Some(port) if is_serial_port(name) => Self::Port(port.to_owned()),
            _ => Self::File(name.to_owned()),
        }
    }
}

/// Why a source cannot be read.
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
                say::dnc_source_unreadable(path.display(), of_system(error))
            }
            Self::Port(error) => error.message(),
            Self::Thread(error) => say::as_written(error),
        }
    }
}

/// A chunk, or why no more can be read.
type Chunk = io::Result<Vec<u8>>;

#[derive(Debug)]
pub struct Partner {
    source: Source,
    /// Number of the call that is being answered.
    call: u32,
    chunks: Option<Receiver<Chunk>>,
    /// Channel to the reader of a port: a character for the other end.
    say: Option<Sender<u8>>,
    /// The current chunk.
    rest: Vec<u8>,
    taken: usize,
}

impl Partner {
    /// Creates a partner that sends from a source.
    pub const fn new(source: Source) -> Self {
        Self {
            source,
            call: 0,
            chunks: None,
            say: None,
            rest: Vec::new(),
            taken: 0,
        }
    }

    /// Opens the source after a call of the control.
    fn begin(&mut self, cnc: &Cnc) -> Result<(), SourceError> {
        match &self.source {
            Source::File(path) => {
                let refused = |error| SourceError::File {
                    path: path.clone(),
                    error,
                };
                let file = File::open(path).map_err(refused)?;
                self.forget();
                self.chunks = Some(read_aside(file)?);
            }
            Source::Standard if self.chunks.is_some() => {}
            Source::Standard => self.chunks = Some(read_aside(io::stdin())?),
            Source::Port(path) => {
                let baud = cnc.parameters().baud();
                let port = Port::open_with_handshake(path, baud)?;
                self.forget();
                let (say, said) = bounded(4);
                let _ = say.try_send(DC1);
                self.say = Some(say);
                self.chunks = Some(listen_aside(port, said)?);
            }
        }
        Ok(())
    }

    fn forget(&mut self) {
        self.rest.clear();
        self.taken = 0;
    }

    /// Fetches the next chunk; returns `false` if there is none now.
    fn fetch(&mut self, cnc: &mut Cnc, patience: Patience) -> bool {
        let Some(chunks) = &self.chunks else {
            cnc.dnc_end();
            return false;
        };
        let chunk = match patience {
            Patience::Waits => chunks.recv().map_err(|_| TryRecvError::Disconnected),
            Patience::None => chunks.try_recv(),
        };
        match chunk {
            Ok(Ok(characters)) => {
                (self.rest, self.taken) = (characters, 0);
                return true;
            }
            Ok(Err(error)) => cnc.dnc_broken(ports::gone(&error)),
            Err(TryRecvError::Disconnected) => cnc.dnc_end(),
            Err(TryRecvError::Empty) => {}
        }
        false
    }
}

impl gsk_runner::partner::Partner for Partner {
    fn feed(&mut self, cnc: &mut Cnc, patience: Patience) {
        cnc.connect_dnc(true);
        if self.call != cnc.dnc_calls() {
            self.call = cnc.dnc_calls();
            if let Err(said) = self.begin(cnc) {
                return cnc.dnc_broken(said.message());
            }
        }
        while cnc.dnc_room() > 0 {
            let rest = self.rest.get(self.taken..).unwrap_or_default();
            if rest.is_empty() && !self.fetch(cnc, patience) {
                return;
            }
            let rest = self.rest.get(self.taken..).unwrap_or_default();
            self.taken += cnc.dnc_send(rest);
        }
        if cnc.programs().inflow().is_none()
            && let Some(say) = self.say.take()
        {
            let _ = say.try_send(DC3);
            self.chunks = None;
        }
    }
}

/// Reads in a separate thread, only as far ahead as the channel has space.
fn read_aside(mut source: impl Read + Send + 'static) -> Result<Receiver<Chunk>, SourceError> {
    aside(move |chunks| {
        let mut buffer = vec![0; CHUNK];
        loop {
            let chunk = match source.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => Ok(buffer[..count].to_vec()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => Err(error),
            };
            let over = chunk.is_err();
            if chunks.send(chunk).is_err() || over {
                return;
            }
        }
    })
}

/// Reads a port in a separate thread and sends characters to it.
fn listen_aside(mut port: Port, said: Receiver<u8>) -> Result<Receiver<Chunk>, SourceError> {
    aside(move |chunks| {
        loop {
            let mut over = false;
            loop {
                match said.try_recv() {
                    Ok(character) => {
                        // If the port is gone, the next read reports it.
                        let _ = port.write(&[character]);
                    }
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => {
                        over = true;
                        break;
                    }
                }
            }
            if over {
                return;
            }
            let chunk = match port.read() {
                Ok(characters) if characters.is_empty() => continue,
                chunk => chunk,
            };
            let over = chunk.is_err();
            if chunks.send(chunk).is_err() || over {
                let _ = port.write(&[DC3]);
                return;
            }
        }
    })
}

fn aside(
    work: impl FnOnce(&Sender<Chunk>) + Send + 'static,
) -> Result<Receiver<Chunk>, SourceError> {
    let (send, receive) = bounded(CHUNKS);
    thread::Builder::new()
        .name("dnc".to_owned())
        .spawn(move || work(&send))
        .map_err(SourceError::Thread)?;
    Ok(receive)
}
