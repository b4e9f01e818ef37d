//! Everything that survives power-off, and its files.

use std::sync::Arc;

use gsk_core::battery::Memory;
use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::plc::{Ladder, RetainedMemory as PlcRetained};
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::PanelRetained;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Standing, take};
use crate::files::data_dir::{DataDir, as_ron};
use crate::files::kept::{Change, Complaint};

/// Everything that survives power-off.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Snapshot {
    /// Content of the control's battery-backed memory.
    pub memory: Memory,
    pub plc: PlcRetained,
    pub standing: Option<Standing>,
    pub panel: Option<PanelRetained>,
    /// The ladder that runs from the next power-on.
    pub ladder: Arc<Ladder>,
}

impl Snapshot {
    pub(super) fn of(cnc: &Cnc) -> Self {
        Self {
            memory: cnc.battery(),
            plc: cnc.plc().memory().retained(),
            ladder: Arc::clone(cnc.next_ladder().unwrap_or(cnc.plc().ladder())),
            standing: None,
            panel: None,
        }
    }

    /// Returns the state of a whole emulator, including panel and position.
    pub(super) fn of_emulator(emulator: &Emulator) -> Self {
        let cnc = &emulator.simulation.cnc;
        let mut snapshot = Self::of(cnc);
        if let Some((number, program)) = emulator.panel.edited() {
            snapshot.memory.programs.overlay(number, program);
        }
        Self {
            standing: Some(Standing {
                machine: cnc.position_machine(),
                absolute: cnc.position_absolute(),
                slides: Some(emulator.simulation.lathe.slides()),
                zero_kept: cnc.reference_without_switch(),
            }),
            panel: Some(emulator.panel.retained()),
            ..snapshot
        }
    }

    /// Returns the number of the selected program, if it is stored.
    pub(super) fn selected(&self) -> Option<u16> {
        match self.memory.programs.current() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        }
    }
}

/// A part of the memory that has its own file.
pub(super) trait Part {
    /// Reads the file; adds damage to the complaints.
    fn load(&mut self, data: &DataDir, name: &str, complaints: &mut Vec<Complaint>);

    /// Returns the content of the file.
    ///
    /// # Errors
    /// The value cannot be serialized.
    fn file(&self, name: &str) -> Result<Change, Message>;
}

impl<T: Serialize + DeserializeOwned> Part for T {
    fn load(&mut self, data: &DataDir, name: &str, complaints: &mut Vec<Complaint>) {
        take(data.load(name), self, complaints);
    }

    fn file(&self, name: &str) -> Result<Change, Message> {
        as_ron(name, self)
    }
}

/// Returns the parts of the control's memory, each with its file name. Programs are not
/// among them: each has a separate file.
pub(super) fn parts(memory: &mut Memory) -> [(&'static str, &mut dyn Part); 9] {
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
