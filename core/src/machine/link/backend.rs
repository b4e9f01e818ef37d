//! One face for all kinds of board.

use core::time::Duration;

use super::line::{self, LineLink};
use super::step_queue::StepLink;
use super::{
    Awaited, BoardInfo, BoardOutputs, CannotCut, Doubt, Event, HostTime, Input, Lacks, LinkConfig,
    LinkState, Output, Pass, Pins, Protocol, PulseRates, Refused, RunTime, Sample, SpindleView,
    Stop, ThreadRights, Traffic,
};
use crate::memory::Parameters;
use crate::units::{Axis, PerAxis, Pulses};

/// A link to one board, whatever it speaks.
#[derive(Clone, Debug)]
pub enum Link {
    /// A board that reads lines.
    Line(Box<LineLink>),
    /// A board that executes times of steps.
    StepQueue(Box<StepLink>),
}

impl Link {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, parameters: &Parameters, now: HostTime) -> Self {
        match config.protocol {
            Protocol::Line => Self::Line(Box::new(LineLink::open(config, parameters, now))),
            Protocol::StepQueue => {
                Self::StepQueue(Box::new(StepLink::open(config, parameters, now)))
            }
        }
    }

    /// What boards met before said they understand: [`Event::Learned`].
    pub fn know(&mut self, dictionaries: Vec<Vec<u8>>) {
        match self {
            // Such a board is asked a few questions only.
            Self::Line(_) => {}
            Self::StepQueue(link) => link.know(dictionaries),
        }
    }

    /// Where the link stands.
    pub const fn state(&self) -> LinkState {
        match self {
            Self::Line(link) => link.state(),
            Self::StepQueue(link) => link.state(),
        }
    }

    /// What the board said it is.
    pub const fn board(&self) -> &BoardInfo {
        match self {
            Self::Line(link) => link.board(),
            Self::StepQueue(link) => link.board(),
        }
    }

    /// Which threads it cuts.
    pub fn threads(&self) -> ThreadRights {
        match self {
            Self::Line(link) => link.threads(),
            Self::StepQueue(link) if link.sees_spindle() => ThreadRights::Followed,
            Self::StepQueue(_) => ThreadRights::None(Lacks {
                index: true,
                ..Lacks::default()
            }),
        }
    }

    /// Hands over a pass that the board cuts by itself.
    ///
    /// # Errors
    /// What is not as it must be; nothing was sent.
    pub fn cut(&mut self, pass: &Pass) -> Result<(), CannotCut> {
        match self {
            Self::Line(link) => link.cut(pass),
            Self::StepQueue(_) => Err(CannotCut::NotReady),
        }
    }

    /// Pulses per mm of slide travel, X and Z.
    pub const fn pulses_per_mm(&self) -> [f64; 2] {
        match self {
            Self::Line(link) => link.required().pulses_per_mm,
            Self::StepQueue(link) => link.pulses_per_mm(),
        }
    }

    /// Switches at the board that are operated, as last reported.
    pub fn pins(&self) -> Pins {
        match self {
            Self::Line(link) => link.pins(),
            Self::StepQueue(link) => link.pins(),
        }
    }

    /// The board's count in the kernel's pulses, as last reported.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        match self {
            Self::Line(link) => link.counted(),
            Self::StepQueue(link) => link.counted(),
        }
    }

    /// Since when the board has reported itself standing.
    pub fn standing_since(&self) -> Option<HostTime> {
        match self {
            Self::Line(link) => link.standing_since(),
            Self::StepQueue(link) => link.standing_since(),
        }
    }

    /// Figures of the wire.
    pub const fn traffic(&self) -> Traffic {
        match self {
            Self::Line(link) => link.traffic(),
            Self::StepQueue(link) => link.traffic(),
        }
    }

    /// Motion the board has certainly made, as time since the opening.
    pub const fn executed(&self) -> RunTime {
        match self {
            Self::Line(link) => link.executed(),
            Self::StepQueue(link) => link.executed(),
        }
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        match self {
            Self::Line(link) => link.outstanding(),
            Self::StepQueue(link) => link.outstanding(),
        }
    }

    /// How much more motion may be handed over now.
    pub fn room(&self) -> Duration {
        match self {
            Self::Line(link) => link.room(),
            Self::StepQueue(link) => link.room(),
        }
    }

    /// The most pulses a second that can be given.
    pub fn rates(&self) -> PulseRates {
        match self {
            Self::Line(link) => link.rates(),
            Self::StepQueue(link) => link.rates(),
        }
    }

    /// What happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        match self {
            Self::Line(link) => link.events(),
            Self::StepQueue(link) => link.events(),
        }
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        match self {
            Self::Line(link) => link.tx(),
            Self::StepQueue(link) => link.tx(),
        }
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        match self {
            Self::Line(link) => link.consumed(count),
            Self::StepQueue(link) => link.consumed(count),
        }
    }

    /// Time passes; at least every 5 ms.
    pub fn tick(&mut self, now: HostTime) {
        match self {
            Self::Line(link) => link.tick(now),
            Self::StepQueue(link) => link.tick(now),
        }
    }

    /// Bytes came from the port.
    pub fn rx(&mut self, bytes: &[u8], now: HostTime) {
        match self {
            Self::Line(link) => link.rx(bytes, now),
            Self::StepQueue(link) => link.rx(bytes, now),
        }
    }

    /// The port failed: unplugged, or taken away.
    pub fn lost(&mut self, cause: &str) {
        match self {
            Self::Line(link) => link.lost(cause),
            Self::StepQueue(link) => link.lost(cause),
        }
    }

    /// Asks a standing board for its count: [`Event::Position`] tells it when it agrees.
    /// False: it tells it all the time.
    pub fn compare(&mut self) -> bool {
        match self {
            Self::Line(_) => false,
            Self::StepQueue(link) => link.compare(),
        }
    }

    /// Writes the settings that differ; the operator was asked.
    pub fn write_settings(&mut self) {
        match self {
            Self::Line(link) => link.write_settings(),
            // Such a board is set up whenever it is opened.
            Self::StepQueue(_) => {}
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
            Self::StepQueue(link) => link.set_position(kernel, at),
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
            Self::StepQueue(link) => link.release(kernel, at),
        }
    }

    /// The port is about to be closed: motion, spindle and coolant stop with the
    /// bytes that are left to be written.
    pub fn close(&mut self) {
        match self {
            Self::Line(link) => link.close(),
            Self::StepQueue(link) => link.close(),
        }
    }

    /// The control forgot where the axes stand (power off): so does the link.
    pub fn forget_position(&mut self) {
        match self {
            Self::Line(link) => link.forget_position(),
            Self::StepQueue(link) => link.forget_position(),
        }
    }

    /// The board's count says no more where the slides stand.
    pub fn doubt_position(&mut self, doubt: Doubt) {
        match self {
            Self::Line(link) => link.doubt_position(doubt),
            Self::StepQueue(link) => link.doubt_position(doubt),
        }
    }

    /// Whether it is known where the slides stand.
    pub const fn knows_position(&self) -> bool {
        match self {
            Self::Line(link) => link.knows_position(),
            Self::StepQueue(link) => link.knows_position(),
        }
    }

    /// Why it is not.
    pub const fn doubt(&self) -> Doubt {
        match self {
            Self::Line(link) => link.doubt(),
            Self::StepQueue(link) => link.doubt(),
        }
    }

    /// Where standing axes are by the board's last count, since it and the kernel's
    /// were put together.
    pub fn place(&self) -> Option<PerAxis<Pulses>> {
        match self {
            Self::Line(link) => link.place(),
            Self::StepQueue(link) => link.place(),
        }
    }

    /// Whether a stop is still under way: where the axes come to stand is not known.
    pub fn is_stopping(&self) -> bool {
        match self {
            Self::Line(link) => link.is_stopping(),
            Self::StepQueue(link) => link.is_stopping(),
        }
    }

    /// Whether the board answers what it is asked.
    pub fn is_heard(&self) -> bool {
        match self {
            Self::Line(link) => link.is_heard(),
            // Such a link stops by itself when motion does not reach the board.
            Self::StepQueue(_) => true,
        }
    }

    /// Whether motion is taken, at the latest when the board has answered what it was
    /// told.
    pub fn takes_motion(&self) -> bool {
        match self {
            Self::Line(link) => link.takes_motion(),
            Self::StepQueue(link) => link.takes_motion(),
        }
    }

    /// Whether motion is taken now.
    pub fn is_prepared(&self) -> bool {
        match self {
            Self::Line(link) => link.is_prepared(),
            Self::StepQueue(link) => link.is_prepared(),
        }
    }

    /// Whether the board makes the reference return by itself; else the kernel does,
    /// with [`arm`](Self::arm).
    pub const fn homes(&self) -> bool {
        matches!(self, Self::Line(_))
    }

    /// Whether the return of one axis leaves the other where it is.
    pub fn homes_alone(&self) -> bool {
        match self {
            Self::Line(link) => link.homes_single_axes(),
            Self::StepQueue(_) => true,
        }
    }

    /// Begins the reference return of these axes, which the board makes by itself.
    ///
    /// # Errors
    /// The board moves or has not said how it stands, or does not do so.
    pub fn home(&mut self, axes: PerAxis<bool>) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.home(axes),
            Self::StepQueue(_) => Err(Refused::NotReady),
        }
    }

    /// What spindle and coolant are to do.
    pub fn set_outputs(&mut self, outputs: BoardOutputs) {
        match self {
            Self::Line(link) => link.set_outputs(outputs),
            Self::StepQueue(link) => link.set_outputs(outputs),
        }
    }

    /// Whether outputs switch at their place in the motion, without a standstill.
    pub const fn times_outputs(&self) -> bool {
        matches!(self, Self::StepQueue(_))
    }

    /// What the board has switched; none while an order is under way.
    pub fn switched(&self) -> Option<BoardOutputs> {
        match self {
            Self::Line(link) => link.switched(),
            Self::StepQueue(link) => link.switched(),
        }
    }

    /// Hands over where the axes are to be at the end of a tick.
    ///
    /// # Errors
    /// The state takes no motion, or the board could not follow; nothing was sent.
    pub fn push(&mut self, sample: Sample) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.push(sample),
            Self::StepQueue(link) => link.push(sample),
        }
    }

    /// The kernel stands: what is left of the motion goes out.
    ///
    /// # Errors
    /// The board could not follow the rest.
    pub fn finish(&mut self) -> Result<(), Refused> {
        match self {
            Self::Line(link) => link.finish(),
            Self::StepQueue(link) => link.finish(),
        }
    }

    /// Stops the board at once.
    pub fn stop(&mut self, stop: Stop) {
        match self {
            Self::Line(link) => link.stop(stop),
            Self::StepQueue(link) => link.stop(stop),
        }
    }

    /// The operator pressed RESET: faults whose cause is gone are cleared, the board
    /// is unlocked; without a position nothing moves yet.
    pub fn reset(&mut self) {
        match self {
            Self::Line(link) => link.reset(),
            Self::StepQueue(link) => link.reset(),
        }
    }

    /// From now on this input stops the axes in the board as soon as it does what is
    /// awaited, once [`is_armed`](Self::is_armed) says so: [`Event::Reached`] tells
    /// where.
    ///
    /// # Errors
    /// No motion is taken, or the board has no such input.
    pub fn arm(&mut self, awaited: Awaited) -> Result<(), Refused> {
        match self {
            Self::Line(_) => Err(Refused::NotWired),
            Self::StepQueue(link) => link.arm(awaited),
        }
    }

    /// What is waited for at an axis.
    pub fn awaited(&self, axis: Axis) -> Option<Awaited> {
        match self {
            Self::Line(_) => None,
            Self::StepQueue(link) => link.awaited(axis),
        }
    }

    /// Whether the board looks at what is waited for.
    pub fn is_armed(&self, axis: Axis) -> bool {
        match self {
            Self::Line(_) => false,
            Self::StepQueue(link) => link.is_armed(axis),
        }
    }

    /// Nothing is waited for at an axis any more.
    pub fn disarm(&mut self, axis: Axis) {
        match self {
            Self::Line(_) => {}
            Self::StepQueue(link) => link.forget_awaited(axis),
        }
    }

    /// A limit switch has stopped the axes, and it is known where: they may be moved
    /// off it, before the operator presses RESET.
    ///
    /// # Errors
    /// Something else stopped them, or the position is not known.
    pub fn retreat(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        match self {
            Self::Line(_) => Err(Refused::NotReady),
            Self::StepQueue(link) => link.retreat(kernel, at),
        }
    }

    /// Whether axes that have made their reference return stand where the kernel
    /// says, although that of another is missing.
    pub const fn keeps_count(&self) -> bool {
        match self {
            Self::Line(_) => false,
            Self::StepQueue(link) => link.keeps_count(),
        }
    }

    /// Switches an output of the board when the motion up to a time has been made.
    ///
    /// # Errors
    /// The board is not ready, or has no such output.
    pub fn output(&mut self, at: RunTime, output: Output, value: i32) -> Result<(), Refused> {
        match self {
            Self::Line(_) => Err(Refused::NotWired),
            Self::StepQueue(link) => link.output(at, output, value),
        }
    }

    /// Whether a switch at the board is operated; `None`: not wired, or not told yet.
    pub fn input(&self, input: Input) -> Option<bool> {
        match self {
            Self::Line(link) => link.input(input),
            Self::StepQueue(link) => link.input(input),
        }
    }

    /// The spindle in the kernel's next tick; once before each. `give`: the axes follow
    /// it, and it may be corrected by so much, turns.
    pub fn spindle(&mut self, give: Option<f64>) -> Option<SpindleView> {
        match self {
            Self::StepQueue(link) if link.sees_spindle() => Some(link.spindle(give)),
            Self::Line(_) | Self::StepQueue(_) => None,
        }
    }

    /// The spindle was reversed: what was learned of its turns does not go on.
    pub fn spindle_reversed(&mut self) {
        match self {
            Self::Line(_) => {}
            Self::StepQueue(link) => link.spindle_reversed(),
        }
    }

    /// A time without motion is time all the same, while the axes wait for the
    /// spindle.
    pub const fn keep_time(&mut self, on: bool) {
        match self {
            Self::Line(_) => {}
            Self::StepQueue(link) => link.keep_time(on),
        }
    }

    /// The next piece of the traffic as text, taken from the bytes of one direction
    /// that are collected; none: it is not whole yet.
    pub fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        match self {
            Self::Line(_) => line::piece(outward, collected),
            Self::StepQueue(link) => {
                let block = StepLink::next_block(collected)?;
                Some(link.describe(outward, &block))
            }
        }
    }
}
