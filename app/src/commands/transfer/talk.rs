//! The PC's side at a port of the computer: an order, and what comes of it.

use std::io::{self, IsTerminal};

use gsk_messages::say;
use gsk_transfer::{Entry, FileName, Loss, NewFile, Order, Outcome, Partition, PcSide, Place};
use indicatif::{ProgressBar, ProgressStyle};
use web_time::{Duration, Instant};

use super::{CommandError, FilesError, output};
use crate::cli::TransferPortArgs;
use crate::ports::Port;

/// So long a port that another program has just left may still be in use.
const IN_USE: Duration = Duration::from_millis(500);
/// So long the last answer may take to leave.
const LAST_WORDS: Duration = Duration::from_millis(300);

/// The PC's side at its port.
pub(super) struct Talk {
    port: Port,
    side: PcSide,
    begun: Instant,
    bar: Option<ProgressBar>,
    files: usize,
    bytes: usize,
    /// Time in which files were under way.
    busy: Duration,
}

impl Talk {
    /// Opens the port.
    pub(super) fn open(args: &TransferPortArgs) -> Result<Self, CommandError> {
        Ok(Self {
            port: Port::open_within(&args.port, args.baud, IN_USE)?,
            side: PcSide::new(args.baud),
            begun: Instant::now(),
            bar: None,
            files: 0,
            bytes: 0,
            busy: Duration::ZERO,
        })
    }

    /// The same, and the control answers.
    pub(super) fn connect(args: &TransferPortArgs) -> Result<Self, CommandError> {
        let mut talk = Self::open(args)?;
        talk.order(Order::Connect)?;
        Ok(talk)
    }

    /// Carries bytes; what has come of it, if anything.
    fn pump(&mut self) -> Result<Option<Outcome>, CommandError> {
        let heard = self.port.read().map_err(CommandError::Gone)?;
        let now = self.begun.elapsed();
        self.side.hear(&heard, now);
        let outcome = self.side.advance(now);
        let taken = self
            .port
            .write(self.side.due(now))
            .map_err(CommandError::Gone)?;
        self.side.sent(taken);
        if let (Some(bar), Some(progress)) = (&self.bar, self.side.progress()) {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
            bar.set_prefix(self.side.retries().to_string());
        }
        Ok(outcome)
    }

    /// Gives an order and waits for what comes of it.
    pub(super) fn order(&mut self, order: Order) -> Result<Outcome, CommandError> {
        self.side.order(order);
        loop {
            match self.pump()? {
                // What the control sends by itself meanwhile it sends to nobody.
                None | Some(Outcome::Pushed(_)) => {}
                Some(Outcome::Lost(loss)) => return Err(FilesError::Lost(loss).into()),
                Some(outcome) => return Ok(outcome),
            }
        }
    }

    /// An order about a file; a refusal is an error.
    fn order_for(&mut self, name: &FileName, order: Order) -> Result<Outcome, CommandError> {
        match self.order(order)? {
            Outcome::Refused(fault) => Err(FilesError::Refused {
                name: name.clone(),
                fault,
            }
            .into()),
            outcome => Ok(outcome),
        }
    }

    /// The files of a partition.
    pub(super) fn list(&mut self, partition: Partition) -> Result<Vec<Entry>, CommandError> {
        match self.order(Order::Directory(partition))? {
            Outcome::Listed(entries) => Ok(entries),
            Outcome::Refused(fault) => Err(FilesError::Refused {
                name: FileName::of_program(0),
                fault,
            }
            .into()),
            _ => Err(FilesError::Lost(Loss::Broken).into()),
        }
    }

    /// Sends a file.
    pub(super) fn send(&mut self, file: NewFile) -> Result<(), CommandError> {
        let (name, size) = (file.place.name.clone(), file.bytes.len());
        self.with_bar(&name, size, |talk| {
            talk.order_for(&name, Order::Put(file))?;
            talk.bytes += size;
            Ok(())
        })
    }

    /// Receives a file.
    pub(super) fn receive(&mut self, place: Place) -> Result<Vec<u8>, CommandError> {
        let name = place.name.clone();
        self.with_bar(&name, 0, |talk| {
            match talk.order_for(&name, Order::Get(place))? {
                Outcome::Got(file) => {
                    talk.bytes += file.bytes.len();
                    Ok(file.bytes)
                }
                _ => Err(FilesError::Lost(Loss::Broken).into()),
            }
        })
    }

    /// Deletes or renames.
    pub(super) fn change(&mut self, name: &FileName, order: Order) -> Result<(), CommandError> {
        self.order_for(name, order).map(drop)
    }

    /// Waits until the control has sent a file by itself.
    pub(super) fn wait(&mut self) -> Result<NewFile, CommandError> {
        loop {
            if let Some(Outcome::Pushed(file)) = self.pump()? {
                self.rest()?;
                return Ok(file);
            }
        }
    }

    fn with_bar<T>(
        &mut self,
        name: &FileName,
        size: usize,
        work: impl FnOnce(&mut Self) -> Result<T, CommandError>,
    ) -> Result<T, CommandError> {
        let begun = Instant::now();
        self.bar = bar(name, size);
        let result = work(self);
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        if result.is_ok() {
            self.files += 1;
            self.busy += begun.elapsed();
        }
        result
    }

    /// Says what has gone and how fast (传输速率, 重试次数).
    pub(super) fn say_rate(&self) {
        let seconds = self.busy.as_secs_f64();
        let rate = self.bytes as f64 / seconds.max(0.001);
        output::say(&say::transfer_rate(
            self.files,
            self.bytes,
            seconds,
            rate.round(),
            self.side.retries(),
        ));
    }

    /// Lets the last answers leave.
    fn rest(&mut self) -> Result<(), CommandError> {
        let begun = Instant::now();
        while !self.side.is_quiet() && begun.elapsed() < LAST_WORDS {
            self.pump()?;
        }
        Ok(())
    }

    /// Says goodbye; a control that does not answer has gone all the same.
    pub(super) fn end(mut self) {
        self.side.order(Order::Bye);
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(1) {
            match self.pump() {
                Ok(None | Some(Outcome::Pushed(_))) => {}
                _ => break,
            }
        }
        let _ = self.rest();
    }
}

/// A progress bar on a terminal.
fn bar(name: &FileName, size: usize) -> Option<ProgressBar> {
    if !io::stderr().is_terminal() {
        return None;
    }
    let bar = ProgressBar::new(size as u64).with_message(name.to_string());
    let style = "{msg:12} {bar:30} {bytes}/{total_bytes}  {bytes_per_sec}  ×{prefix}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    Some(bar)
}
