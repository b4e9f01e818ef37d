//! The interface of all boards to the kernel.

use core::fmt::Debug;
use core::ops::{Deref, DerefMut};
use core::time::Duration;

use gsk_messages::Message;

use crate::drives::Drives;
use crate::line::LineLink;
use crate::position::Positioned;
use crate::step_queue::StepLink;
use crate::{
    AwaitedInput, BoardInfo, BoardOutputs, EncoderReading, HostTime, Input, LinkConfig, LinkEvent,
    LinkState, MotionRefused, Output, PassError, Pins, Protocol, PulseRates, RunTime, Sample,
    SpindleView, Stop, TapCapability, TapOrder, ThreadCapability, ThreadPass, ThreadPlan, Traffic,
    Uncertainty,
};
use gsk_units::{Axis, PerAxis, Pulses};

/// A link to one board of either protocol. A `Link` dereferences to its [`Backend`].
#[derive(Clone, Debug)]
pub enum Link {
    /// A board that reads lines of G code: Grbl, grblHAL, FluidNC.
    Line(Box<LineLink>),
    /// A board that executes timed steps: Klipper firmware.
    StepQueue(Box<StepLink>),
}

impl Link {
    /// Creates the link to a board whose port was opened at the host time `now`. [`Backend::tick`]
    /// then identifies and configures the board.
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

/// A link to a board: takes bytes and time, returns bytes and events.
///
/// Functions that not every board supports have a default body, which refuses the request.
pub trait Backend: Positioned + Debug {
    /// Adds compressed dictionaries from earlier [`LinkEvent::Learned`] events, so that the link
    /// need not read a known dictionary from the board again.
    fn add_dictionaries(&mut self, dictionaries: Vec<Vec<u8>>) {
        // Only boards with timed steps have a dictionary.
        let _ = dictionaries;
    }

    /// Returns the state of the connection to the board.
    fn state(&self) -> LinkState {
        self.session().state
    }

    /// Returns the firmware and buffer sizes that the board has reported.
    fn board(&self) -> &BoardInfo;

    /// Returns which threads the board can cut, or which conditions are missing.
    fn threads(&self) -> ThreadCapability;

    /// Starts a thread pass that the board synchronizes with its spindle.
    ///
    /// # Errors
    /// The unmet condition; nothing was sent.
    fn cut(&mut self, pass: &ThreadPass) -> Result<(), PassError> {
        let _ = pass;
        Err(PassError::NotReady)
    }

    /// Returns whether the board can tap, or what is missing.
    fn taps(&self) -> TapCapability {
        TapCapability::NoEncoder
    }

    /// Starts a tap that the board makes on the angle of the spindle. [`LinkEvent::Drained`]
    /// reports that it is back at its start and that the counts agree.
    ///
    /// # Errors
    /// The unmet condition; nothing was sent.
    fn tap(&mut self, order: &TapOrder) -> Result<(), PassError> {
        let _ = order;
        Err(PassError::NotReady)
    }

    /// Returns the distance of the tap in the board from its start, pulses, at the angle that the
    /// board last reported; `None` without a tap.
    fn tap_distance(&self) -> Option<f64> {
        None
    }

    /// Returns the number of pulses per mm of slide travel, for X and Z.
    fn pulses_per_mm(&self) -> [f64; 2];

    /// Returns the switches that the board last reported as operated.
    fn pins(&self) -> Pins;

    /// Returns the position of the slides in the board's last report, in the kernel's pulses;
    /// `None` if the board has not reported a position.
    fn counted(&self) -> Option<PerAxis<Pulses>>;

    /// Returns the host time since which the axes are at standstill, as far as the link knows;
    /// `None` during motion or if the link does not know.
    fn standing_since(&self) -> Option<HostTime>;

    /// Returns the counters of the serial traffic.
    fn traffic(&self) -> Traffic;

    /// Returns the kernel time up to which the board has certainly executed the motion.
    fn executed(&self) -> RunTime;

    /// Returns the duration of the motion that the board may not have executed yet.
    fn outstanding(&self) -> Duration;

    /// Returns the duration of motion that the link accepts now without exceeding the
    /// lookahead.
    fn free_lookahead(&self) -> Duration;

    /// Returns the greatest pulse rates of the board.
    fn rates(&self) -> PulseRates;

    /// Removes and returns the events that the link has collected since the last call, the oldest
    /// first.
    fn events(&mut self) -> Vec<LinkEvent> {
        core::mem::take(&mut self.session_mut().events)
    }

    /// Returns the bytes to be written to the port.
    fn tx(&self) -> &[u8];

    /// Removes the first `count` bytes of [`tx`](Self::tx): the port has taken them.
    fn consumed(&mut self, count: usize);

    /// Advances the host time to `now`, checks the time limits and puts the due messages into
    /// [`tx`](Self::tx); call it at least every 5 ms.
    fn tick(&mut self, now: HostTime);

    /// Handles bytes that the port received from the board at the host time `now`.
    fn rx(&mut self, bytes: &[u8], now: HostTime);

    /// Holds motion back after the computer was suspended for longer than the lookahead: a
    /// line board gets no motion before it has reported its position. A board with timed steps
    /// detects the gap, so that its link does nothing here.
    fn stop_after_absence(&mut self) {}

    /// Handles a failed port, for instance after unplugging: raises an alarm with `cause` and
    /// enters [`LinkState::Lost`].
    fn lost(&mut self, cause: Message);

    /// Queries the count of a board at standstill; [`LinkEvent::Position`] reports the
    /// answer. Returns false if no query was sent, as for a board that reports its
    /// position all the time.
    fn compare(&mut self) -> bool {
        false
    }

    /// Writes the required values of the settings that differ to the board, after the operator has
    /// confirmed this. Without effect on a board with timed steps.
    fn write_settings(&mut self) {}

    /// Sets the position of the slides, at standstill at the kernel time `at`, to `kernel` in the
    /// kernel's pulses. The kernel calls this after its reference return or after the operator has
    /// confirmed the position. The link then accepts motion.
    ///
    /// # Errors
    /// The board moves, is locked, or has not reported its position.
    fn set_position(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        self.align(kernel, at)?;
        let session = self.session_mut();
        session.confirm_position();
        session.enter(LinkState::Ready);
        Ok(())
    }

    /// Accepts manual motion without a known position; the state remains [`LinkState::Locked`].
    /// `kernel` is the kernel's count, in pulses, at the kernel time `at`.
    ///
    /// # Errors
    /// The state is not [`LinkState::Locked`], or the board moves, is locked, or has not reported
    /// its position.
    fn release(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        if self.state() != LinkState::Locked {
            return Err(MotionRefused::NotReady);
        }
        self.align(kernel, at)?;
        self.session_mut().release();
        Ok(())
    }

    /// Prepares for closing the port: the bytes that remain in [`tx`](Self::tx) stop motion,
    /// spindle and coolant.
    fn close(&mut self);

    /// Returns bytes that stop motion, spindle and coolant after any earlier bytes. The port
    /// guard writes them when the main process ends. Empty if nothing needs to be stopped or
    /// the board is not identified yet.
    fn stop_bytes(&self) -> Vec<u8>;

    /// Whether `answered`, the bytes received after [`stop_bytes`](Self::stop_bytes) was sent, show
    /// that the board has executed the stop. Always false for a board that does not answer a stop.
    fn has_answered_stop(&self, answered: &[u8]) -> bool {
        let _ = answered;
        false
    }

    /// Marks the position and the board's count as unknown, as the control does at power-off.
    fn forget_position(&mut self) {
        self.invalidate_position(Uncertainty::Unreferenced);
        self.forget_count();
    }

    /// Marks the position as uncertain for the reason `uncertainty`, stops motion and locks the
    /// link.
    fn invalidate_position(&mut self, uncertainty: Uncertainty) {
        self.lose_position(uncertainty);
        match self.state() {
            LinkState::Moving => self.stop(Stop::Flush),
            LinkState::Ready => self.session_mut().enter(LinkState::Locked),
            _ => {}
        }
    }

    /// Whether the position of the slides is known.
    fn knows_position(&self) -> bool {
        self.session().knows_position()
    }

    /// Returns why the position is uncertain; `None` if the position is known.
    fn uncertainty(&self) -> Option<Uncertainty> {
        self.session().uncertainty()
    }

    /// Returns the position by the last count of the board, in the kernel's pulses; `None` if
    /// the counts of board and kernel were never aligned.
    fn last_position(&self) -> Option<PerAxis<Pulses>>;

    /// Whether a stop is in progress: the link does not know yet at which position the axes stop.
    fn is_stopping(&self) -> bool;

    /// Whether the board has answered a query that the link sent at or after the host time
    /// `moment`. Always true for a board with timed steps.
    fn has_answered_since(&self, moment: HostTime) -> bool {
        let _ = moment;
        true
    }

    /// Whether the link accepts motion, immediately or as soon as the board has answered all
    /// commands.
    fn takes_motion(&self) -> bool;

    /// Whether [`push`](Self::push) accepts motion now.
    fn is_prepared(&self) -> bool;

    /// Whether the board does its own homing. Otherwise the kernel makes the reference
    /// return with [`arm`](Self::arm).
    fn homes(&self) -> bool {
        false
    }

    /// Whether one axis can make its reference return while the other stays in place.
    fn homes_alone(&self) -> bool;

    /// Starts the board's own homing of the axes that are `true`. A board that cannot home a single
    /// axis homes both.
    ///
    /// # Errors
    /// The board moves, has not reported its state, or has no homing.
    fn home(&mut self, axes: PerAxis<bool>) -> Result<(), MotionRefused> {
        let _ = axes;
        Err(MotionRefused::NotReady)
    }

    /// Sets the wanted state of spindle and coolant; the link switches them as soon as
    /// possible.
    fn set_outputs(&mut self, outputs: BoardOutputs);

    /// Whether the board can switch outputs during motion; otherwise only at standstill.
    fn times_outputs(&self) -> bool {
        false
    }

    /// Returns the outputs that the link has commanded; `None` while the board has not answered a
    /// command.
    fn switched(&self) -> Option<BoardOutputs>;

    /// Takes the commanded position at the end of a tick of the kernel and sends the motion to the
    /// board before its execution is due.
    ///
    /// # Errors
    /// The state allows no motion, a limit switch is in the way, or the rate is too high;
    /// nothing was sent.
    fn push(&mut self, sample: Sample) -> Result<(), MotionRefused>;

    /// Sends the motion that the link still collects for a longer command; call it when the kernel
    /// is at standstill.
    ///
    /// # Errors
    /// This motion needs a higher pulse rate than the board has.
    fn finish(&mut self) -> Result<(), MotionRefused>;

    /// Stops the board immediately, in the way that `stop` selects.
    fn stop(&mut self, stop: Stop);

    /// Handles RESET: clears faults whose cause is gone and unlocks the board. An unknown
    /// position remains unknown.
    fn reset(&mut self);

    /// Arms an input: the board stops the axes when its condition is met, and
    /// [`LinkEvent::Reached`] reports the position. The board watches the input when
    /// [`is_armed`](Self::is_armed) returns true.
    ///
    /// # Errors
    /// The link accepts no motion, or the board has no such input.
    fn arm(&mut self, awaited: AwaitedInput) -> Result<(), MotionRefused> {
        let _ = awaited;
        Err(MotionRefused::NotWired)
    }

    /// Returns the armed input of an axis; `None` without one.
    fn awaited(&self, axis: Axis) -> Option<AwaitedInput> {
        let _ = axis;
        None
    }

    /// Whether the board already watches the armed input of an axis.
    fn is_armed(&self, axis: Axis) -> bool {
        let _ = axis;
        false
    }

    /// Disarms the awaited input of an axis: it no longer stops the axes.
    fn disarm(&mut self, axis: Axis) {
        let _ = axis;
    }

    /// Accepts motion off a limit switch that stopped the axes, before the operator presses
    /// RESET. The axes are at standstill at the position `kernel` of the kernel's count and at
    /// the kernel time `at`.
    ///
    /// # Errors
    /// No limit switch stopped the axes, or the position is unknown.
    fn retreat(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), MotionRefused> {
        let _ = (kernel, at);
        Err(MotionRefused::NotReady)
    }

    /// Whether the board's count is valid since it was aligned with the kernel's: no step and no
    /// drive power was lost. A referenced axis then keeps its position while the other axis makes
    /// its reference return.
    fn keeps_count(&self) -> bool {
        false
    }

    /// Switches an output to `value` (0 or 1; mV for the spindle speed) when the board has executed
    /// the motion up to the kernel time `at`.
    ///
    /// # Errors
    /// The board is not ready, or has no such output.
    fn output(&mut self, at: RunTime, output: Output, value: i32) -> Result<(), MotionRefused> {
        let _ = (at, output, value);
        Err(MotionRefused::NotWired)
    }

    /// Whether an input is operated; `None` if the input is not wired or not reported yet.
    fn input(&self, input: Input) -> Option<bool>;

    /// Tells the link before the kernel's next tick whether its motion depends on the angle of the
    /// spindle. A board with a spindle encoder then makes the motion at the true angle, and
    /// [`spindle`](Self::spindle) returns a spindle of the planned speed.
    fn plan_thread(&mut self, plan: Option<ThreadPlan>) {
        let _ = plan;
    }

    /// Whether the pace of the motion is that of the spindle: it takes the time that the spindle
    /// takes.
    fn waits_for_spindle(&self) -> bool {
        false
    }

    /// Predicts angle and speed of the spindle for the kernel's next tick; call it once before each
    /// tick. With `max_correction` the axes follow the spindle: the prediction may deviate from a
    /// constant speed by this many turns per tick at most. `None` if no one-turn signal is wired to
    /// the board.
    fn spindle(&mut self, max_correction: Option<f64>) -> Option<SpindleView> {
        let _ = max_correction;
        None
    }

    /// The spindle as its encoder at the board reports it; `None` without an encoder.
    fn encoder(&self) -> Option<EncoderReading> {
        None
    }

    /// Restarts the estimate of angle and speed of the spindle; call it when the spindle is
    /// reversed.
    fn spindle_reversed(&mut self) {}

    /// Sets whether samples without motion delay the following motion in the board by their
    /// duration (`on`), as during a thread. Otherwise the board executes the next motion as soon as
    /// possible.
    fn keep_time(&mut self, on: bool) {
        let _ = on;
    }

    /// Takes the next line or block from the collected bytes of one direction and formats it
    /// as text; `None` if the line or block is incomplete. `outward`: the bytes go to the
    /// board.
    fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String>;
}
