//! What fault bench, ladder view and commissioning see: the machine and the PLC as they are.

use std::sync::Arc;

use gsk_core::alarm::Alarm;
use gsk_core::machine::{Inputs, Lathe};
use gsk_core::memory::{Parameters, PitchTable, Refusal};
use gsk_core::plc::{Ladder, Plc};
use gsk_panel::emulator::Emulator;

/// The machine and the PLC at one moment. Taken only while a view is open that
/// shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineView {
    /// The lathe.
    pub lathe: Lathe,
    /// What its contacts and sensors say.
    pub inputs: Inputs,
    /// The PLC with its memory.
    pub plc: Plc,
    /// The scan stands still for stepping.
    pub halted: bool,
    /// The ladder that runs at the next power-on, if it is another one.
    pub next_ladder: Option<Arc<Ladder>>,
    /// Why the control would not take a ladder now.
    pub ladder_refused: Option<Refusal>,
    /// The parameters.
    pub parameters: Parameters,
    /// The pitch error table.
    pub pitch: PitchTable,
    /// Why the control would not take parameters now.
    pub parameters_refused: Option<Refusal>,
    /// Alarms and messages that stand, the newest first.
    pub alarms: Vec<String>,
}

impl MachineView {
    /// As it is now.
    pub fn of(emulator: &Emulator) -> Self {
        let simulation = &emulator.simulation;
        let cnc = &simulation.cnc;
        let alarms = cnc.alarms().iter().map(Alarm::line_text);
        let messages = cnc
            .plc_messages()
            .map(|(number, text)| format!("{number:04} {text}"));
        Self {
            lathe: simulation.lathe.clone(),
            inputs: simulation.lathe.inputs(),
            plc: cnc.plc().clone(),
            halted: cnc.ladder_halted(),
            next_ladder: cnc.next_ladder().cloned(),
            ladder_refused: cnc.rights().ladder().err(),
            parameters: cnc.parameters().clone(),
            pitch: cnc.pitch().clone(),
            parameters_refused: cnc.rights().parameters().err(),
            alarms: alarms.chain(messages).collect(),
        }
    }
}
