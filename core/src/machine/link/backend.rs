//! One face for all kinds of board.

use core::time::Duration;

use super::line::LineLink;
use super::{
    BoardInfo, BoardOutputs, Event, HostTime, LinkConfig, LinkState, Pins, Refused, RunTime,
    Sample, Stop, Traffic,
};
use crate::memory::Parameters;
use crate::units::{PerAxis, Pulses};

/// A link to one board, whatever it speaks.
#[derive(Clone, Debug)]
pub enum Link {
    /// A board that reads lines.
    Line(Box<LineLink>),
}

impl Link {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, parameters: &Parameters, now: HostTime) -> Self {
        Self::Line(Box::new(LineLink::open(config, parameters, now)))
    }

    /// Where the link stands.
    pub const fn state(&self) -> LinkState {
        match self {
            Self::Line(link) => link.state(),
        }
    }

    /// What the board said it is.
    pub const fn board(&self) -> &BoardInfo {
        match self {
            Self::Line(link) => link.board(),
        }
    }

    /// Pulses per mm of slide travel, X and Z.
    pub const fn pulses_per_mm(&self) -> [f64; 2] {
        match self {
            Self::Line(link) => link.required().pulses_per_mm,
        }
    }

    /// Switches at the board that are operated, as last reported.
    pub const fn pins(&self) -> Pins {
        match self {
            Self::Line(link) => link.pins(),
        }
    }

    /// The board's count in the kernel's pulses, as last reported.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        match self {
            Self::Line(link) => link.counted(),
        }
    }

    /// Since when the board has reported itself standing.
    pub const fn standing_since(&self) -> Option<HostTime> {
        match self {
            Self::Line(link) => link.standing_since(),
        }
    }

    /// Figures of the wire.
    pub const fn traffic(&self) -> Traffic {
        match self {
            Self::Line(link) => link.traffic(),
        }
    }

    /// Motion the board has certainly made, as time since the opening.
    pub const fn executed(&self) -> RunTime {
        match self {
            Self::Line(link) => link.executed(),
        }
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        match self {
            Self::Line(link) => link.outstanding(),
        }
    }

    /// How much more motion may be handed over now.
    pub fn room(&self) -> Duration {
        match self {
            Self::Line(link) => link.room(),
        }
    }

    /// What happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        match self {
            Self::Line(link) => link.events(),
        }
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        match self {
            Self::Line(link) => link.tx(),
        }
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        match self {
            Self::Line(link) => link.consumed(count),
        }
    }

    /// Time passes; at least every 5 ms.
    pub fn tick(&mut self, now: HostTime) {
        match self {
            Self::Line(link) => link.tick(now),
        }
    }

    /// Bytes came from the port.
    pub fn rx(&mut self, bytes: &[u8], now: HostTime) {
        match self {
            Self::Line(link) => link.rx(bytes, now),
        }
    }

    /// The port failed: unplugged, or taken away.
    pub fn lost(&mut self, cause: &str) {
        match self {
            Self::Line(link) => link.lost(cause),
        }
    }

    /// Writes the settings that differ; the operator was asked.
    pub fn write_settings(&mut self) {
        match self {
            Self::Line(link) => link.write_settings(),
        }
    }

    /// The slides stand where the kernel says: it has made its reference return, or
    /// the operator has confirmed it. From here on motion is taken.
    ///
    /// # Errors
    /// The board moves, is locked, or has not said where it stands.
    pub fn set_position(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.set_position(kernel, at),
        }
    }

    /// The operator moves the axes by hand although nobody knows where they stand:
    /// motion is taken from here on, and the state stays locked.
    ///
    /// # Errors
    /// The position is known, the board moves, is locked, or has not said where it
    /// stands.
    pub fn release(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.release(kernel, at),
        }
    }

    /// The port is about to be closed: motion, spindle and coolant stop with the
    /// bytes that are left to be written.
    pub fn close(&mut self) {
        match self {
            Self::Line(link) => link.close(),
        }
    }

    /// The control forgot where the axes stand (power off): so does the link.
    pub fn forget_position(&mut self) {
        match self {
            Self::Line(link) => link.forget_position(),
        }
    }

    /// Whether it is known where the slides stand.
    pub const fn knows_position(&self) -> bool {
        match self {
            Self::Line(link) => link.knows_position(),
        }
    }

    /// Whether motion is taken, at the latest when the board has answered what it was
    /// told.
    pub fn takes_motion(&self) -> bool {
        match self {
            Self::Line(link) => link.takes_motion(),
        }
    }

    /// Whether motion is taken now.
    pub fn is_prepared(&self) -> bool {
        match self {
            Self::Line(link) => link.is_prepared(),
        }
    }

    /// Begins the reference return of these axes, which the board makes by itself.
    ///
    /// # Errors
    /// The board moves or has not said how it stands.
    pub fn home(&mut self, axes: PerAxis<bool>) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.home(axes),
        }
    }

    /// What spindle and coolant are to do.
    pub const fn set_outputs(&mut self, outputs: BoardOutputs) {
        match self {
            Self::Line(link) => link.set_outputs(outputs),
        }
    }

    /// What the board has switched; none while an order is under way.
    pub fn switched(&self) -> Option<BoardOutputs> {
        match self {
            Self::Line(link) => link.switched(),
        }
    }

    /// Hands over where the axes are to be at the end of a tick.
    ///
    /// # Errors
    /// The state takes no motion, or the board could not follow; nothing was sent.
    pub fn push(&mut self, sample: Sample) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.push(sample),
        }
    }

    /// The kernel stands: what is left of the motion goes out.
    ///
    /// # Errors
    /// The board could not follow the rest.
    pub fn finish(&mut self) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.finish(),
        }
    }

    /// Stops the board at once.
    pub fn stop(&mut self, stop: Stop) {
        match self {
            Self::Line(link) => link.stop(stop),
        }
    }

    /// The operator pressed RESET: faults whose cause is gone are cleared, the board
    /// is unlocked; without a position nothing moves yet.
    pub fn reset(&mut self) {
        match self {
            Self::Line(link) => link.reset(),
        }
    }
}
