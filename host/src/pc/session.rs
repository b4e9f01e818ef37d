//! Runs the PC side of the transfer protocol at a port of the computer: one command at a
//! time.

use gsk_messages::{Message, say};
use gsk_transfer::{
    ConnectionLoss, DirectoryEntry, FileName, Partition, PcCommand, PcSide, RemotePath,
    TransferFile, TransferOutcome, TransferProgress,
};
use web_time::{Duration, Instant};

use super::{FilesError, PcError};
use crate::ports::Port;

/// Time for which opening a port that another program has just closed is retried.
const OPEN_RETRY_TIME: Duration = Duration::from_millis(500);
/// Longest time to wait until the last replies have left.
const DRAIN_TIMEOUT: Duration = Duration::from_millis(300);
/// Longest time to wait for the reply to a disconnection.
const BYE_TIMEOUT: Duration = Duration::from_secs(1);

/// Is notified of the progress of file transfers, and can cancel them.
pub trait TransferObserver: Send {
    /// The transfer of a file begins; `_size` is its length, bytes, or 0 if unknown.
    fn on_begin(&mut self, _name: &FileName, _size: usize) {}

    /// Part of the current file was transferred; `_retries` is the number of frames
    /// retransmitted so far (重试次数).
    fn on_progress(&mut self, _progress: TransferProgress, _retries: u64) {}

    /// The transfer of the current file has ended, successfully or not.
    fn on_end(&mut self) {}

    /// Returns whether the caller has cancelled the transfer.
    fn is_cancelled(&mut self) -> bool {
        false
    }
}

/// Totals of the transfers through the port.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransferTotals {
    /// Number of transferred files.
    pub file_count: usize,
    /// Total length of the transferred files, bytes.
    pub byte_count: usize,
    /// Total time in which files were transferred.
    pub busy_time: Duration,
    /// Number of retransmitted frames (重试次数).
    pub retries: u64,
    /// Rate of the line, bits a second.
    pub baud: u32,
}

impl TransferTotals {
    /// Returns the average transfer rate, bytes per second (传输速率).
    pub fn rate(&self) -> f64 {
        self.byte_count as f64 / self.busy_time.as_secs_f64().max(0.001)
    }

    /// Returns the used share of the line's rate, at ten bits a byte, 0 to 1.
    pub fn line_share(&self) -> f64 {
        self.rate() * 10.0 / f64::from(self.baud.max(1))
    }

    /// Returns a message with totals, rate and retries (传输速率, 重试次数).
    pub fn message(&self) -> Message {
        say::transfer_rate(
            self.file_count,
            self.byte_count,
            self.busy_time.as_secs_f64(),
            self.rate().round(),
            self.line_share() * 100.0,
            self.baud,
            self.retries,
        )
    }
}

/// The PC's end of the transfer protocol at an open port.
pub struct TransferSession {
    port: Port,
    side: PcSide,
    begun: Instant,
    observer: Box<dyn TransferObserver>,
    totals: TransferTotals,
}

impl TransferSession {
    /// Opens a port at this rate, bits per second.
    ///
    /// # Errors
    ///
    /// Returns an error with the name of the port and the remedy if it cannot be opened.
    pub fn open(port: &str, baud: u32, watch: Box<dyn TransferObserver>) -> Result<Self, PcError> {
        Ok(Self {
            port: Port::open_with_retry(port, baud, OPEN_RETRY_TIME)?,
            side: PcSide::new(baud),
            begun: Instant::now(),
            observer: watch,
            totals: TransferTotals {
                baud,
                ..TransferTotals::default()
            },
        })
    }

    /// Connects with the control.
    ///
    /// # Errors
    /// The control does not answer, or the port has gone.
    pub fn connect(&mut self) -> Result<(), PcError> {
        self.run_command(PcCommand::Connect).map(drop)
    }

    /// Moves bytes in both directions once; returns the outcome of the running command, or `None`
    /// while it has none. Returns an error if the port has failed.
    fn pump(&mut self) -> Result<Option<TransferOutcome>, PcError> {
        let received = self.port.read().map_err(FilesError::Gone)?;
        let now = self.begun.elapsed();
        self.side.receive(&received, now);
        let outcome = self.side.advance(now);
        let taken = self
            .port
            .write(self.side.pending_bytes(now))
            .map_err(FilesError::Gone)?;
        self.side.mark_sent(taken);
        if let Some(progress) = self.side.progress() {
            self.observer
                .on_progress(progress, self.side.retransmissions());
        }
        Ok(outcome)
    }

    /// Starts a command and waits for its outcome. Drops files that the control sends meanwhile.
    /// Returns an error if the port has failed, the control does not answer or the operator
    /// cancels.
    fn run_command(&mut self, order: PcCommand) -> Result<TransferOutcome, PcError> {
        self.side.start(order);
        let mut cancelled = false;
        loop {
            match self.pump()? {
                // A file that the control sends unrequested meanwhile is dropped.
                None | Some(TransferOutcome::Pushed(_)) => {}
                Some(TransferOutcome::Lost(loss)) => return Err(FilesError::Lost(loss).into()),
                Some(_) if cancelled => return Err(FilesError::Cancelled.into()),
                Some(outcome) => return Ok(outcome),
            }
            if !cancelled && self.observer.is_cancelled() {
                // On a new connection the control drops a partial file.
                cancelled = true;
                self.side.start(PcCommand::Connect);
            }
        }
    }

    /// Runs a command for a file and returns its outcome; a refusal of the control becomes an
    /// error.
    fn run_file_command(
        &mut self,
        name: &FileName,
        order: PcCommand,
    ) -> Result<TransferOutcome, PcError> {
        match self.run_command(order)? {
            TransferOutcome::Refused(fault) => Err(FilesError::Refused {
                name: name.clone(),
                fault,
            }
            .into()),
            outcome => Ok(outcome),
        }
    }

    /// Lists the files of a partition.
    ///
    /// # Errors
    /// The control refuses it or does not answer, or the port has gone.
    pub fn list(&mut self, partition: Partition) -> Result<Vec<DirectoryEntry>, PcError> {
        match self.run_command(PcCommand::Directory(partition))? {
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
    /// The control refuses it or does not answer, or the port has gone.
    pub fn send(&mut self, file: TransferFile) -> Result<(), PcError> {
        let (name, size) = (file.remote_path.name.clone(), file.bytes.len());
        self.observed(&name, size, |talk| {
            talk.run_file_command(&name, PcCommand::Put(file))?;
            talk.totals.byte_count += size;
            Ok(())
        })
    }

    /// Receives a file and returns its content.
    ///
    /// # Errors
    /// The control refuses it or does not answer, or the port has gone.
    pub fn receive(&mut self, place: RemotePath) -> Result<Vec<u8>, PcError> {
        let name = place.name.clone();
        self.observed(&name, 0, |talk| {
            match talk.run_file_command(&name, PcCommand::Get(place))? {
                TransferOutcome::Got(file) => {
                    talk.totals.byte_count += file.bytes.len();
                    Ok(file.bytes)
                }
                _ => Err(FilesError::Lost(ConnectionLoss::Interrupted).into()),
            }
        })
    }

    /// Runs a command that deletes or renames the file `name`.
    ///
    /// # Errors
    /// The control refuses it or does not answer, or the port has gone.
    pub fn change(&mut self, name: &FileName, order: PcCommand) -> Result<(), PcError> {
        self.run_file_command(name, order).map(drop)
    }

    /// Moves bytes while no command runs; returns a file that the control has sent unrequested, or
    /// `None` without one.
    ///
    /// # Errors
    /// The port has gone.
    pub fn poll(&mut self) -> Result<Option<TransferFile>, PcError> {
        let Some(TransferOutcome::Pushed(file)) = self.pump()? else {
            return Ok(None);
        };
        self.drain()?;
        Ok(Some(file))
    }

    fn observed<T>(
        &mut self,
        name: &FileName,
        size: usize,
        work: impl FnOnce(&mut Self) -> Result<T, PcError>,
    ) -> Result<T, PcError> {
        let begun = Instant::now();
        self.observer.on_begin(name, size);
        let result = work(self);
        self.observer.on_end();
        if result.is_ok() {
            self.totals.file_count += 1;
            self.totals.busy_time += begun.elapsed();
        }
        result
    }

    /// Returns the totals of the transfers so far.
    pub fn totals(&self) -> TransferTotals {
        TransferTotals {
            retries: self.side.retransmissions(),
            ..self.totals
        }
    }

    /// Moves bytes until the last replies have left, at most `DRAIN_TIMEOUT`. Returns an error if
    /// the port has failed.
    fn drain(&mut self) -> Result<(), PcError> {
        let begun = Instant::now();
        while !self.side.is_drained() && begun.elapsed() < DRAIN_TIMEOUT {
            self.pump()?;
        }
        Ok(())
    }

    /// Disconnects from the control and keeps the port open; a control that does not
    /// answer counts as disconnected.
    ///
    /// # Errors
    /// The port has gone.
    pub fn disconnect(&mut self) -> Result<(), PcError> {
        self.side.start(PcCommand::Bye);
        let begun = Instant::now();
        while begun.elapsed() < BYE_TIMEOUT {
            if !matches!(self.pump()?, None | Some(TransferOutcome::Pushed(_))) {
                break;
            }
        }
        self.drain()
    }

    /// Disconnects from the control and closes the port.
    pub fn close(mut self) {
        // The port is closed in any case.
        let _ = self.disconnect();
    }
}
