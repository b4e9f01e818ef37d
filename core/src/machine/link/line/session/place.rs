//! Where the slides stand: what the kernel says and what the board counts are put
//! together.

use super::super::super::{Doubt, LinkState, Refused, RunTime};
use super::super::answers::BoardState;
use super::{LineLink, MODES};
use crate::units::{PerAxis, Pulses};

impl LineLink {
    /// The slides stand where the kernel says: it has made its reference return, or
    /// the operator has confirmed it. From here on motion is taken.
    ///
    /// # Errors
    /// The board moves, is locked, or has not said where it stands.
    pub fn set_position(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        self.align(kernel, at)?;
        self.position_known = true;
        self.enter(LinkState::Ready);
        Ok(())
    }

    /// The operator moves the axes by hand although nobody knows where they stand:
    /// motion is taken from here on, and the state stays locked.
    ///
    /// # Errors
    /// The position is known, the board moves, is locked, or has not said where it
    /// stands.
    pub fn release(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        if self.state != LinkState::Locked {
            return Err(Refused::NotReady);
        }
        self.align(kernel, at)?;
        self.released = true;
        self.doubt = Doubt::Unreferenced;
        Ok(())
    }

    /// From here on the board's count and the kernel's go together.
    fn align(&mut self, kernel: PerAxis<Pulses>, at: RunTime) -> Result<(), Refused> {
        let standing = self
            .status
            .filter(|status| status.state == BoardState::Idle);
        let (LinkState::Locked | LinkState::Ready, Some(board)) =
            (self.state, standing.and_then(|status| self.pulses(status)))
        else {
            return Err(Refused::NotReady);
        };
        self.offset = PerAxis::new(
            Pulses(board.x.0 - kernel.x.0),
            Pulses(board.z.0 - kernel.z.0),
        );
        self.commanded = kernel;
        self.executed = at;
        self.made = kernel;
        self.stood = Some(kernel);
        self.counts = true;
        self.segments.begin(kernel, at);
        for modes in MODES {
            self.send(modes, false);
        }
        Ok(())
    }
}
