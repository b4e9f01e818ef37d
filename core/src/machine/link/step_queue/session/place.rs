//! Where the slides stand: what the kernel says, and what the board counts.

use super::super::super::{Doubt, HostTime, LinkState, PulseRates, Refused, RunTime};
use super::super::commands::Command;
use super::super::delivery::Mark;
use super::super::fit::Ticks;
use super::stops::Why;
use super::{GIVE_UP, Purpose, Reading, StepLink};
use crate::units::{PerAxis, Pulses};

impl StepLink {
    /// The slides stand where the kernel says: it has made its reference return, or
    /// the operator has confirmed it. From here on motion is taken.
    ///
    /// # Errors
    /// The board moves, is shut down, or has not said where it stands.
    pub fn set_position(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        self.align(kernel, at)?;
        self.known = true;
        self.enter(LinkState::Ready);
        Ok(())
    }

    /// The operator moves the axes by hand although nobody knows where they stand:
    /// motion is taken from here on, and the state stays locked.
    ///
    /// # Errors
    /// The position is known, the board moves, or has not said where it stands.
    pub fn release(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        if self.state != LinkState::Locked {
            return Err(Refused::NotReady);
        }
        self.align(kernel, at)?;
        self.known = false;
        self.released = true;
        self.doubt = Doubt::Unreferenced;
        Ok(())
    }

    /// A limit switch has stopped the axes, and it is known where: they may be moved
    /// off it, before the operator presses RESET.
    ///
    /// # Errors
    /// Something else stopped them, or the position is not known.
    pub fn retreat(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        if !(self.state == LinkState::Tripped && self.known && self.motion.limits.any_met()) {
            return Err(Refused::NotReady);
        }
        self.align(kernel, at)?;
        self.released = true;
        Ok(())
    }

    /// From here on the board's count and the kernel's go together.
    pub(super) fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        let by_limit = self.state == LinkState::Tripped && self.motion.limits.any_met();
        let standing = (matches!(self.state, LinkState::Locked | LinkState::Ready) || by_limit)
            && self.stopping.is_none()
            && !self.down
            && !self.motion.is_under_way()
            && self.upkeep.all_told(self.wiring.as_ref());
        let (true, Some(board)) = (standing, self.motion.board) else {
            return Err(Refused::NotReady);
        };
        self.motion.take_over(kernel, board, at);
        self.upkeep.drives_on = true;
        self.exact = true;
        self.edges = [None; 2];
        self.arm_group();
        Ok(())
    }

    /// The control forgot where the axes stand (power off): so does the link.
    pub fn forget_position(&mut self) {
        self.doubt_position(Doubt::Unreferenced);
        self.motion.placed = false;
    }

    /// The board's count says no more where the slides stand.
    pub fn doubt_position(&mut self, doubt: Doubt) {
        self.lose_position(doubt);
        match self.state {
            LinkState::Moving => self.halt(Why::Flush),
            LinkState::Ready => self.enter(LinkState::Locked),
            _ => {}
        }
    }

    /// The port is about to be closed: the board gives up, with all its outputs.
    pub fn close(&mut self) {
        self.give_up_motion();
        if self.is_running() && !self.down {
            self.say_first(Command::EmergencyStop, &[]);
            // Whatever the board still has to confirm.
            self.delivery.set_window(None);
            self.send();
        }
        self.lose_position(Doubt::Unheard);
        self.enter(LinkState::Off);
    }

    /// Nobody knows where the slides stand.
    pub(super) fn lose_position(&mut self, doubt: Doubt) {
        if core::mem::take(&mut self.known) {
            self.doubt = doubt;
        }
        self.released = false;
        self.exact = false;
    }

    /// Whether the board's count is still that of the kernel: an axis that has made
    /// its reference return stands where the kernel says.
    pub const fn keeps_count(&self) -> bool {
        self.exact
    }

    /// Whether it is known where the slides stand.
    pub const fn knows_position(&self) -> bool {
        self.known
    }

    /// Why it is not.
    pub const fn doubt(&self) -> Doubt {
        self.doubt
    }

    /// Where the axes stand by the board's last count; of axes that move, where they
    /// are to go.
    pub fn place(&self) -> Option<PerAxis<Pulses>> {
        self.motion.placed.then_some(self.motion.commanded)
    }

    /// Whether a stop is still under way.
    pub const fn is_stopping(&self) -> bool {
        self.stopping.is_some()
    }

    /// The board does not say any more where the axes stand: they are where its clock
    /// had them at this time.
    pub(super) fn stand_unread(&mut self, at: HostTime) {
        self.stopping = None;
        let clock = self.clock.at(at.min(self.now));
        self.motion.stand_unread(clock as Ticks);
    }

    /// Whether motion is taken.
    pub fn takes_motion(&self) -> bool {
        let by_hand = matches!(self.state, LinkState::Locked | LinkState::Tripped);
        (self.state.takes_motion() || by_hand && self.released)
            && self.stopping.is_none()
            && !self.down
    }

    /// Whether motion is taken now; this board needs no preparation.
    pub fn is_prepared(&self) -> bool {
        self.takes_motion()
    }

    /// The board's count in the kernel's pulses, as last told.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.motion.counted()
    }

    /// The most pulses a second that can be given.
    pub const fn rates(&self) -> PulseRates {
        self.motion.rates.most
    }

    /// Asks where the axes stand.
    pub(super) fn read_place(&mut self, purpose: Purpose) {
        self.reading = Some(Reading {
            purpose,
            since: self.now,
            asked: self.now,
            got: [None; 2],
        });
        self.ask_place();
    }

    fn ask_place(&mut self) {
        if let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) {
            // Replies to either are newer than the first question.
            self.say_marked(Command::StepperGetPosition, &[axes.x], Mark::Position);
            self.say_first(Command::StepperGetPosition, &[axes.z]);
        }
    }

    pub(super) fn ask_again(&mut self) {
        let patience = self.patience();
        let Some(reading) = &mut self.reading else {
            return;
        };
        if self.now.saturating_sub(reading.since) >= GIVE_UP {
            self.lost("the board does not say where the axes stand");
        } else if self.now.saturating_sub(reading.asked) >= patience {
            reading.asked = self.now;
            self.ask_place();
        }
    }

    pub(super) fn place_told(&mut self, oid: i64, pulses: u32) {
        let (Some(reading), Some(wiring)) = (&mut self.reading, &self.wiring) else {
            return;
        };
        let axis = [wiring.axes.x, wiring.axes.z]
            .iter()
            .position(|&axis| axis == oid);
        if let Some(axis) = axis {
            reading.got[axis] = Some(pulses);
        }
        if let [Some(x), Some(z)] = reading.got {
            let purpose = reading.purpose;
            self.reading = None;
            let board = self.motion.board_counts([x, z], &self.config);
            self.place_read(purpose, board);
        }
    }
}
