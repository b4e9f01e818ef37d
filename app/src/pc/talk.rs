//! The PC's side at a port of the computer: an order, and what comes of it.

use gsk_messages::{Message, say};
use gsk_transfer::{
    ConnectionLoss, DirectoryEntry, FileName, Partition, PcCommand, PcSide, RemotePath,
    TransferFile, TransferOutcome, TransferProgress,
};
use web_time::{Duration, Instant};

use super::{FilesError, PcError};
use crate::ports::Port;

/// So long a port that another program has just left may still be in use.
const IN_USE: Duration = Duration::from_millis(500);
/// So long the last answer may take to leave.
const LAST_WORDS: Duration = Duration::from_millis(300);
/// So long the answer to a farewell may take.
const FAREWELL: Duration = Duration::from_secs(1);

/// Who watches files on their way.
pub trait Watch: Send {
    /// A file begins; its length, where it is known, bytes.
    fn begins(&mut self, _name: &FileName, _size: usize) {}

    /// How far it has come, and how many frames went out again so far (重试次数).
    fn moves(&mut self, _progress: TransferProgress, _retries: u64) {}

    /// It has ended, well or not.
    fn ends(&mut self) {}

    /// Whether it is to be broken off.
    fn is_cancelled(&mut self) -> bool {
        false
    }
}

/// What has gone through the port so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Files.
    pub files: usize,
    /// What they hold, bytes.
    pub bytes: usize,
    /// Time in which files were under way.
    pub busy: Duration,
    /// Frames that went out again (重试次数).
    pub retries: u64,
    /// Speed of the line, bits a second.
    pub baud: u32,
}

impl Traffic {
    /// Bytes a second (传输速率).
    pub fn rate(&self) -> f64 {
        self.bytes as f64 / self.busy.as_secs_f64().max(0.001)
    }

    /// What that is of what the line carries with ten bits a byte, 1: all of it.
    pub fn share(&self) -> f64 {
        self.rate() * 10.0 / f64::from(self.baud.max(1))
    }

    /// What has gone and how fast (传输速率, 重试次数).
    pub fn message(&self) -> Message {
        say::transfer_rate(
            self.files,
            self.bytes,
            self.busy.as_secs_f64(),
            self.rate().round(),
            self.share() * 100.0,
            self.baud,
            self.retries,
        )
    }
}

/// The PC's side at its port.
pub struct Talk {
    port: Port,
    side: PcSide,
    begun: Instant,
    watch: Box<dyn Watch>,
    traffic: Traffic,
}

impl Talk {
    /// Opens the port at so many bits a second.
    ///
    /// # Errors
    /// It cannot be opened: names the port and what to do.
    pub fn open(port: &str, baud: u32, watch: Box<dyn Watch>) -> Result<Self, PcError> {
        Ok(Self {
            port: Port::open_within(port, baud, IN_USE)?,
            side: PcSide::new(baud),
            begun: Instant::now(),
            watch,
            traffic: Traffic {
                baud,
                ..Traffic::default()
            },
        })
    }

    /// Connects: the control answers.
    ///
    /// # Errors
    /// It does not, or the port has gone.
    pub fn connect(&mut self) -> Result<(), PcError> {
        self.order(PcCommand::Connect).map(drop)
    }

    /// Carries bytes; what has come of it, if anything.
    fn pump(&mut self) -> Result<Option<TransferOutcome>, PcError> {
        let heard = self.port.read().map_err(FilesError::Gone)?;
        let now = self.begun.elapsed();
        self.side.receive(&heard, now);
        let outcome = self.side.advance(now);
        let taken = self
            .port
            .write(self.side.pending_bytes(now))
            .map_err(FilesError::Gone)?;
        self.side.mark_sent(taken);
        if let Some(progress) = self.side.progress() {
            self.watch.moves(progress, self.side.retransmissions());
        }
        Ok(outcome)
    }

    /// Gives an order and waits for what comes of it.
    fn order(&mut self, order: PcCommand) -> Result<TransferOutcome, PcError> {
        self.side.start(order);
        let mut cancelled = false;
        loop {
            match self.pump()? {
                // What the control sends by itself meanwhile it sends to nobody.
                None | Some(TransferOutcome::Pushed(_)) => {}
                Some(TransferOutcome::Lost(loss)) => return Err(FilesError::Lost(loss).into()),
                Some(_) if cancelled => return Err(FilesError::Cancelled.into()),
                Some(outcome) => return Ok(outcome),
            }
            if !cancelled && self.watch.is_cancelled() {
                // Connected anew, the control forgets the half of a file that it has.
                cancelled = true;
                self.side.start(PcCommand::Connect);
            }
        }
    }

    /// An order about a file; a refusal is an error.
    fn order_for(&mut self, name: &FileName, order: PcCommand) -> Result<TransferOutcome, PcError> {
        match self.order(order)? {
            TransferOutcome::Refused(fault) => Err(FilesError::Refused {
                name: name.clone(),
                fault,
            }
            .into()),
            outcome => Ok(outcome),
        }
    }

    /// The files of a partition.
    ///
    /// # Errors
    /// The control refuses it, or does not answer, or the port has gone.
    pub fn list(&mut self, partition: Partition) -> Result<Vec<DirectoryEntry>, PcError> {
        match self.order(PcCommand::Directory(partition))? {
            TransferOutcome::Listed(entries) => Ok(entries),
            TransferOutcome::Refused(fault) => Err(FilesError::Refused {
                name: FileName::from_program(0),
                fault,
            }
            .into()),
            _ => Err(FilesError::Lost(ConnectionLoss::Interrupted).into()),
        }
    }

    /// Sends a file.
    ///
    /// # Errors
    /// The control refuses it, or does not answer, or the port has gone.
    pub fn send(&mut self, file: TransferFile) -> Result<(), PcError> {
        let (name, size) = (file.remote_path.name.clone(), file.bytes.len());
        self.watched(&name, size, |talk| {
            talk.order_for(&name, PcCommand::Put(file))?;
            talk.traffic.bytes += size;
            Ok(())
        })
    }

    /// Receives a file.
    ///
    /// # Errors
    /// The control refuses it, or does not answer, or the port has gone.
    pub fn receive(&mut self, place: RemotePath) -> Result<Vec<u8>, PcError> {
        let name = place.name.clone();
        self.watched(&name, 0, |talk| {
            match talk.order_for(&name, PcCommand::Get(place))? {
                TransferOutcome::Got(file) => {
                    talk.traffic.bytes += file.bytes.len();
                    Ok(file.bytes)
                }
                _ => Err(FilesError::Lost(ConnectionLoss::Interrupted).into()),
            }
        })
    }

    /// Deletes or renames.
    ///
    /// # Errors
    /// The control refuses it, or does not answer, or the port has gone.
    pub fn change(&mut self, name: &FileName, order: PcCommand) -> Result<(), PcError> {
        self.order_for(name, order).map(drop)
    }

    /// Carries bytes while nothing is asked for: a file that the control has sent by itself.
    ///
    /// # Errors
    /// The port has gone.
    pub fn idle(&mut self) -> Result<Option<TransferFile>, PcError> {
        let Some(TransferOutcome::Pushed(file)) = self.pump()? else {
            return Ok(None);
        };
        self.rest()?;
        Ok(Some(file))
    }

    fn watched<T>(
        &mut self,
        name: &FileName,
        size: usize,
        work: impl FnOnce(&mut Self) -> Result<T, PcError>,
    ) -> Result<T, PcError> {
        let begun = Instant::now();
        self.watch.begins(name, size);
        let result = work(self);
        self.watch.ends();
        if result.is_ok() {
            self.traffic.files += 1;
            self.traffic.busy += begun.elapsed();
        }
        result
    }

    /// What has gone and how fast (传输速率, 重试次数).
    pub fn traffic(&self) -> Traffic {
        Traffic {
            retries: self.side.retransmissions(),
            ..self.traffic
        }
    }

    /// Lets the last answers leave.
    fn rest(&mut self) -> Result<(), PcError> {
        let begun = Instant::now();
        while !self.side.is_drained() && begun.elapsed() < LAST_WORDS {
            self.pump()?;
        }
        Ok(())
    }

    /// Says goodbye and stays at the port; a control that does not answer has gone all the
    /// same.
    ///
    /// # Errors
    /// The port has gone.
    pub fn take_leave(&mut self) -> Result<(), PcError> {
        self.side.start(PcCommand::Bye);
        let begun = Instant::now();
        while begun.elapsed() < FAREWELL {
            if !matches!(self.pump()?, None | Some(TransferOutcome::Pushed(_))) {
                break;
            }
        }
        self.rest()
    }

    /// Says goodbye.
    pub fn end(mut self) {
        // It is closed in any case.
        let _ = self.take_leave();
    }
}
