//! Behind an alarm the control stops. A check of the program may go on: the block
//! that was refused counts as not there.

use crate::interpreter::reader::Interpreter;

/// What was passed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PassedOver {
    /// The block that was refused.
    Block,
    /// The compensation of a contour whose blocks are right each by itself: where
    /// it stands is what was programmed.
    Contour,
    /// Nothing: the block stands in the profile that a G70 runs through.
    Nothing,
}

impl Interpreter {
    /// After an alarm of [`advance`](Self::advance), for a run that need not cut
    /// anything: it goes on behind the alarm. The nose radius compensation ends there,
    /// for its corners need every block; the next G41 or G42 starts it anew.
    pub(crate) fn pass_over(&mut self) -> PassedOver {
        let of_contour = self.compensation.has_failed();
        self.drop_compensation();
        self.state.modal.nose_compensation = 40;
        if of_contour {
            // What is left of the block read last would start it again.
            while self.main.plan.is_some() {
                self.main.take();
            }
            return PassedOver::Contour;
        }
        if self.main.finishing.is_some() {
            return PassedOver::Nothing;
        }
        self.main.place = self.main.place.after();
        PassedOver::Block
    }
}
