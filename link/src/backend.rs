//! What every board can do for the kernel, whatever it speaks.

use core::fmt::Debug;
use core::ops::{Deref, DerefMut};
use core::time::Duration;

use gsk_messages::Message;

use crate::drives::Drives;
use crate::line::LineLink;
use crate::position::Positioned;
use crate::step_queue::StepLink;
use crate::{
    AwaitedInput, BoardInfo, BoardOutputs, HostTime, Input, LinkConfig, LinkEvent, LinkState,
    MotionRefused, Output, PassError, Pins, Protocol, PulseRates, RunTime, Sample, SpindleView,
    Stop, ThreadCapability, ThreadPass, Traffic, Uncertainty,
};
use gsk_units::{Axis, PerAxis, Pulses};

/// A link to one board, whatever it speaks: everything it does is of its [`Backend`].
#[derive(Clone, Debug)]
pub enum Link {
    /// A board that reads lines.
    Line(Box<LineLink>),
    /// A board that executes times of steps.
    StepQueue(Box<StepLink>),
}

impl Link {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, drives: &Drives, now: HostTime) -> Self {
        match config.protocol {
            Protocol::Line => Self::Line(Box::new(LineLink::open(config, drives, now))),
            Protocol::StepQueue => Self::StepQueue(Box::new(StepLink::open(config, drives, now))),
        }
    }
}

impl Deref for Link {
    type Target = dyn Backend;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Line(link) => &**link,
            Self::StepQueue(link) => &**link,
        }
    }
}

impl DerefMut for Link {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Line(link) => &mut **link,
            Self::StepQueue(link) => &mut **link,
        }
    }
}

/// A board behind a port: bytes and time go in, bytes and events come out.
///
/// What a board cannot do has a body here that says so.
pub trait Backend: Positioned + Debug {
    /// What boards met before said they understand: [`Event::Learned`].
    fn add_dictionaries(&mut self, dictionaries: Vec<Vec<u8>>) {
        // Most boards are asked a few questions only.
        let _ = dictionaries;
    }

    /// Where the link stands.
    fn state(&self) -> LinkState {
        self.session().state
    }

    /// What the board said it is.
    fn board(&self) -> &BoardInfo;

    /// Which threads it cuts.
    fn threads(&self) -> ThreadCapability;

    /// Hands over a pass that the board cuts by itself.
    ///
    /// # Errors
    /// What is not as it must be; nothing was sent.
    fn cut(&mut self, pass: &ThreadPass) -> Result<(), PassError> {
        let _ = pass;
        Err(PassError::NotReady)
    }

    /// Pulses per mm of slide travel, X and Z.
    fn pulses_per_mm(&self) -> [f64; 2];

    /// Switches at the board that are operated, as last reported.
    fn pins(&self) -> Pins;

    /// The board's count in the kernel's pulses, as last reported.
    fn counted(&self) -> Option<PerAxis<Pulses>>;

    /// Since when the board has reported itself standing.
    fn standing_since(&self) -> Option<HostTime>;

    /// Figures of the wire.
    fn traffic(&self) -> Traffic;

    /// Motion the board has certainly made, as time since the opening.
    fn executed(&self) -> RunTime;

    /// Motion handed over that may not have been made yet.
    fn outstanding(&self) -> Duration;

    /// How much more motion may be handed over now.
    fn free_lookahead(&self) -> Duration;

    /// The most pulses a second that can be given.
    fn rates(&self) -> PulseRates;

    /// What happened since the last call.
    fn events(&mut self) -> Vec<LinkEvent> {
        core::mem::take(&mut self.session_mut().events)
    }

    /// Bytes to be written to the port.
    fn tx(&self) -> &[u8];

    /// So many of them were written.
    fn consumed(&mut self, count: usize);

    /// Time passes; at least every 5 ms.
    fn tick(&mut self, now: HostTime);

    /// Bytes came from the port.
    fn rx(&mut self, bytes: &[u8], now: HostTime);

    /// The computer was away for longer than a board that makes what it holds is told
    /// ahead: such a board is sent nothing before it has reported where it stands. A board
    /// of timed steps notices by itself.
    fn stop_after_absence(&mut self) {}

    /// The port failed: unplugged, or taken away.
    fn lost(&mut self, cause: Message);

    /// Asks a standing board for its count: [`Event::Position`] reports it when it agrees.
    /// False: it reports it all the time.
    fn compare(&mut self) -> bool {
        false
    }

    /// Writes the settings that differ; the operator was asked.
    fn write_settings(&mut self) {}

    /// The slides stand where the kernel says: it has made its reference return, or
    /// the operator has confirmed it. From here on motion is taken.
    ///
    /// # Errors
    /// The board moves, is locked, or has not said where it stands.
    fn set_position(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        self.align(kernel, at)?;
        let session = self.session_mut();
        session.confirm_position();
        session.enter(LinkState::Ready);
        Ok(())
    }

    /// The operator moves the axes by hand although nobody knows where they stand:
    /// motion is taken from here on, and the state stays locked.
    ///
    /// # Errors
    /// The position is known, the board moves, is locked, or has not said where it
    /// stands.
    fn release(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        if self.state() != LinkState::Locked {
            return Err(MotionRefused::NotReady);
        }
        self.align(kernel, at)?;
        self.session_mut().release();
        Ok(())
    }

    /// The port is about to be closed: motion, spindle and coolant stop with the
    /// bytes that are left to be written.
    fn close(&mut self);

    /// What stops motion, spindle and coolant whatever was written before, for whoever
    /// holds the port when this program is gone; nothing: there is nothing to be stopped,
    /// or nobody knows yet what the board is.
    fn stop_bytes(&self) -> Vec<u8>;

    /// Whether a board answers so to [`stop_bytes`](Self::stop_bytes).
    fn has_answered_stop(&self, answered: &[u8]) -> bool {
        let _ = answered;
        false
    }

    /// The control forgot where the axes stand (power off): so does the link.
    fn forget_position(&mut self) {
        self.invalidate_position(Uncertainty::Unreferenced);
        self.forget_count();
    }

    /// The board's count says no more where the slides stand.
    fn invalidate_position(&mut self, uncertainty: Uncertainty) {
        self.lose_position(uncertainty);
        match self.state() {
            LinkState::Moving => self.stop(Stop::Flush),
            LinkState::Ready => self.session_mut().enter(LinkState::Locked),
            _ => {}
        }
    }

    /// Whether it is known where the slides stand.
    fn knows_position(&self) -> bool {
        self.session().knows_position()
    }

    /// Why it is not.
    fn uncertainty(&self) -> Option<Uncertainty> {
        self.session().uncertainty()
    }

    /// Where standing axes are by the board's last count, since it and the kernel's
    /// were put together.
    fn last_position(&self) -> Option<PerAxis<Pulses>>;

    /// Whether a stop is still under way: where the axes come to stand is not known.
    fn is_stopping(&self) -> bool;

    /// Whether the board has answered a question that was asked no earlier than this.
    fn has_answered_since(&self, moment: HostTime) -> bool {
        let _ = moment;
        true
    }

    /// Whether motion is taken, at the latest when the board has answered what it was
    /// told.
    fn takes_motion(&self) -> bool;

    /// Whether motion is taken now.
    fn is_prepared(&self) -> bool;

    /// Whether the board makes the reference return by itself; else the kernel does,
    /// with [`arm`](Self::arm).
    fn homes(&self) -> bool {
        false
    }

    /// Whether the return of one axis leaves the other where it is.
    fn homes_alone(&self) -> bool;

    /// Begins the reference return of these axes, which the board makes by itself.
    ///
    /// # Errors
    /// The board moves or has not said how it stands, or does not do so.
    fn home(&mut self, axes: PerAxis<bool>) -> Result<(), MotionRefused> {
        let _ = axes;
        Err(MotionRefused::NotReady)
    }

    /// What spindle and coolant are to do.
    fn set_outputs(&mut self, outputs: BoardOutputs);

    /// Whether outputs switch at their place in the motion, without a standstill.
    fn times_outputs(&self) -> bool {
        false
    }

    /// What the board has switched; none while an order is under way.
    fn switched(&self) -> Option<BoardOutputs>;

    /// Hands over where the axes are to be at the end of a tick.
    ///
    /// # Errors
    /// The state takes no motion, or the board could not follow; nothing was sent.
    fn push(&mut self, sample: Sample) -> Result<(), MotionRefused>;

    /// The kernel stands: what is left of the motion goes out.
    ///
    /// # Errors
    /// The board could not follow the rest.
    fn finish(&mut self) -> Result<(), MotionRefused>;

    /// Stops the board at once.
    fn stop(&mut self, stop: Stop);

    /// The operator pressed RESET: faults whose cause is gone are cleared, the board
    /// is unlocked; without a position nothing moves yet.
    fn reset(&mut self);

    /// From now on this input stops the axes in the board as soon as it does what is
    /// awaited, once [`is_armed`](Self::is_armed) says so: [`Event::Reached`] tells
    /// where.
    ///
    /// # Errors
    /// No motion is taken, or the board has no such input.
    fn arm(&mut self, awaited: AwaitedInput) -> Result<(), MotionRefused> {
        let _ = awaited;
        Err(MotionRefused::NotWired)
    }

    /// What is waited for at an axis.
    fn awaited(&self, axis: Axis) -> Option<AwaitedInput> {
        let _ = axis;
        None
    }

    /// Whether the board looks at what is waited for.
    fn is_armed(&self, axis: Axis) -> bool {
        let _ = axis;
        false
    }

    /// Nothing is waited for at an axis any more.
    fn disarm(&mut self, axis: Axis) {
        let _ = axis;
    }

    /// A limit switch has stopped the axes, and it is known where: they may be moved
    /// off it, before the operator presses RESET.
    ///
    /// # Errors
    /// Something else stopped them, or the position is not known.
    fn retreat(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        let _ = (kernel, at);
        Err(MotionRefused::NotReady)
    }

    /// Whether axes that have made their reference return stand where the kernel
    /// says, although that of another is missing.
    fn keeps_count(&self) -> bool {
        false
    }

    /// Switches an output of the board when the motion up to a time has been made.
    ///
    /// # Errors
    /// The board is not ready, or has no such output.
    fn output(&mut self, at: RunTime, output: Output, value: i32) -> Result<(), MotionRefused> {
        let _ = (at, output, value);
        Err(MotionRefused::NotWired)
    }

    /// Whether a switch at the board is operated; `None`: not wired, or not reported yet.
    fn input(&self, input: Input) -> Option<bool>;

    /// The spindle in the kernel's next tick; once before each. `give`: the axes follow
    /// it, and it may be corrected by so much, turns.
    fn spindle(&mut self, max_correction: Option<f64>) -> Option<SpindleView> {
        let _ = max_correction;
        None
    }

    /// The spindle was reversed: what was learned of its turns does not go on.
    fn spindle_reversed(&mut self) {}

    /// A time without motion is time all the same, while the axes wait for the
    /// spindle.
    fn keep_time(&mut self, on: bool) {
        let _ = on;
    }

    /// The next piece of the traffic as text, taken from the bytes of one direction
    /// that are collected; none: it is not whole yet.
    fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String>;
}
