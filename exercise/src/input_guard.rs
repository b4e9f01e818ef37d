//! Decides which recorded inputs an operator can make.

use gsk_core::cnc::ControlRequest;
use gsk_history::machine_part::{CRASH_FAULTS, PartInput};
use gsk_history::moment::HistoryInput;
use gsk_panel::emulator::EmulatorInput;

/// Returns whether a learner can make this input at the machine: keys, handwheel, power, new stock,
/// the repair of a fault. `after_cut` is true if a collision or a cut above the limits in the same
/// tick has set its faults.
pub fn is_by_operator(input: &HistoryInput, after_cut: bool) -> bool {
    match input {
        HistoryInput::Machine(input) => match input {
            EmulatorInput::Key(_)
            | EmulatorInput::PowerOff
            | EmulatorInput::PowerOn
            | EmulatorInput::StoreEdited
            | EmulatorInput::FitGraphic { .. }
            // The computer takes what the learner has sent with 输出.
            | EmulatorInput::TakeSent
            | EmulatorInput::Fault(_, false) => true,
            EmulatorInput::Fault(fault, true) => after_cut && CRASH_FAULTS.contains(fault),
            // All keys are released when the window loses the focus: the wheel stops, too.
            EmulatorInput::Request(request) => matches!(**request, ControlRequest::DropWheel),
            _ => false,
        },
        HistoryInput::Part(input) => matches!(input, PartInput::NewStock),
    }
}
