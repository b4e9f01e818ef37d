//! Everything that survives power-off, and its files.

use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::plc::{Ladder, RetainedMemory as PlcRetained};
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::PanelRetained;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{SavedPosition, assign_loaded};
use crate::files::data_dir::{DataDir, to_ron_change};
use crate::files::mirrored_files::{FileChange, FileDamage};

/// All data that survive power-off, at one moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RetainedSnapshot {
    /// Content of the control's battery-backed memory.
    pub memory: BatteryMemory,
    pub plc: PlcRetained,
    pub position: Option<SavedPosition>,
    pub panel: Option<PanelRetained>,
    /// The ladder that runs from the next power-on.
    pub ladder: Arc<Ladder>,
}

impl RetainedSnapshot {
    pub(super) fn from_cnc(cnc: &Cnc) -> Self {
        Self {
            memory: cnc.battery_memory(),
            plc: cnc.plc().memory().retained(),
            ladder: cnc.stored_ladder(),
            position: None,
            panel: None,
        }
    }

    /// Returns the state of a whole emulator, including panel and position.
    pub(super) fn from_emulator(emulator: &Emulator) -> Self {
        let cnc = emulator.cnc();
        let mut snapshot = Self::from_cnc(cnc);
        if let Some((number, program)) = emulator.panel().edited() {
            snapshot.memory.programs.overlay(number, program);
        }
        Self {
            position: Some(SavedPosition {
                machine: cnc.position_machine(),
                absolute: cnc.position_absolute(),
                slides: Some(emulator.lathe().slide_position()),
                zero_kept: cnc.reference_without_switch(),
            }),
            panel: Some(emulator.panel().retained()),
            ..snapshot
        }
    }

    /// Returns the number of the selected program; `None` if it is not stored in the memory.
    pub(super) fn selected(&self) -> Option<u16> {
        match self.memory.programs.selected() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        }
    }
}

/// A part of the memory that is stored in a separate file.
pub(super) trait MemoryPart {
    /// Reads the part from the file `NAME.ron`; adds damage to `complaints`.
    fn load(&mut self, data: &DataDir, name: &str, complaints: &mut Vec<FileDamage>);

    /// Returns the change that writes the part into the file `NAME.ron`.
    ///
    /// # Errors
    /// The value cannot be serialized.
    fn to_change(&self, name: &str) -> Result<FileChange, Message>;
}

impl<T: Serialize + DeserializeOwned> MemoryPart for T {
    fn load(&mut self, data: &DataDir, name: &str, complaints: &mut Vec<FileDamage>) {
        assign_loaded(data.load(name), self, complaints);
    }

    fn to_change(&self, name: &str) -> Result<FileChange, Message> {
        to_ron_change(name, self)
    }
}

/// Returns the parts of the control's memory, each with its file name. Programs are not
/// among them: each has a separate file.
pub(super) fn parts(memory: &mut BatteryMemory) -> [(&'static str, &mut dyn MemoryPart); 9] {
    [
        ("parameters", &mut memory.parameters),
        ("offsets", &mut memory.offsets),
        ("pitch", &mut memory.pitch),
        ("counters", &mut memory.counters),
        ("variables", &mut memory.variables),
        ("settings", &mut memory.settings),
        ("authority", &mut memory.authority),
        ("disks", &mut memory.disks),
        ("model", &mut memory.model),
    ]
}
