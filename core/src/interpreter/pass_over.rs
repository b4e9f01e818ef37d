//! Continues a check of a program after an alarm, which stops the control. The refused block
//! is ignored.

use crate::interpreter::reader::Interpreter;

/// The part of a program that a check ignores to continue after an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PassedOver {
    /// The check ignores the block that raised the alarm.
    Block,
    /// The nose radius compensation of a contour whose blocks are correct individually. The
    /// tool continues at the programmed position.
    Contour,
    /// Nothing, so the check cannot continue: the block is in the profile that a G70 runs
    /// through.
    Nothing,
}

impl Interpreter {
    /// Continues after an alarm of [`advance`](Self::advance), in a run that cuts nothing.
    /// Ends the nose radius compensation, because its corners need every block; the next G41
    /// or G42 starts the compensation again.
    pub(crate) fn pass_over_refused(&mut self) -> PassedOver {
        let has_contour_failed = self.compensation.has_failed();
        self.drop_compensation();
        self.state.modal.nose_compensation = 40;
        if has_contour_failed {
            // The remaining commands of the block read last would start it again.
            while self.main.plan.is_some() {
                self.main.take_command();
            }
            return PassedOver::Contour;
        }
        if self.main.finishing.is_some() {
            return PassedOver::Nothing;
        }
        self.main.position = self.main.position.next_block();
        PassedOver::Block
    }
}
