//! Loads the control's battery-backed memory from the data directory at the start, and
//! saves it while the control runs.

mod keeper;
pub mod project;
mod snapshot;
#[cfg(test)]
mod tests;
mod writer;

use std::collections::BTreeMap;
use std::sync::Arc;

use gsk_core::alarm::{Alarm, number};
use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::{PerAxis, Point};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::PanelRetained;
use serde::{Deserialize, Serialize};

pub use keeper::Keeper;
use snapshot::{Snapshot, parts};
use writer::Writer;

use crate::files::data_dir::{DataDir, Loaded};
use crate::files::decode::Encoding;
use crate::files::kept::Complaint;
use crate::saying;

/// Position of the slides, and the coordinates on the display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// Machine coordinates (X as a radius), mm.
    pub machine: Point,
    /// Absolute coordinates, mm.
    pub absolute: Point,
    /// The slides of the simulated lathe, mm from its reference point (X as a radius).
    #[serde(default)]
    pub slides: Option<Point>,
    /// Axes whose machine zero was set by hand (zero return of method A).
    #[serde(default)]
    pub zero_kept: PerAxis<bool>,
}

/// Messages for the files that could not be saved.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct NotSaved(pub Vec<Message>);

impl NotSaved {
    /// Returns the message for the operator, one file a line.
    pub fn message(&self) -> Message {
        saying::lines(self.0.iter().cloned())
    }
}

/// Content of a data directory besides the setup.
#[derive(Debug)]
pub struct Restored {
    /// The encodings of the programs, so that they are written back unchanged.
    encodings: BTreeMap<u16, Encoding>,
    /// Messages for damaged files.
    pub complaints: Vec<Message>,
    /// Last position of the slides.
    pub standing: Option<Standing>,
    /// Saved state of the panel.
    pub panel: Option<PanelRetained>,
}

impl Restored {
    /// Puts the slides to their last position: for sessions that continue with the
    /// machine.
    pub fn place(&self, setup: &mut Setup) {
        if let Some(standing) = self.standing {
            setup.start = Some(standing.machine);
            setup.absolute = Some(standing.absolute);
            setup.slides = standing.slides;
            setup.zero_kept = standing.zero_kept;
        }
    }

    /// Restores the saved state of the panel.
    pub fn restore_panel(&self, emulator: &mut Emulator) {
        if let Some(panel) = &self.panel {
            emulator.panel.restore(panel);
        }
    }
}

/// Loads the memory of a data directory, if there is one, into the setup of a command;
/// prints damage on standard error.
pub fn bring_back(data: Option<&DataDir>, setup: &mut Setup) -> Option<Restored> {
    let restored = load(data?, setup);
    for complaint in &restored.complaints {
        crate::output::complain_of(complaint);
    }
    restored.place(setup);
    Some(restored)
}

/// Loads the memory of a data directory into a setup.
pub fn load(data: &DataDir, setup: &mut Setup) -> Restored {
    let mut complaints = Vec::new();
    for (name, part) in parts(&mut setup.memory) {
        part.load(data, name, &mut complaints);
    }
    let mut selected = None;
    take(data.load("selected"), &mut selected, &mut complaints);
    let mut standing = None;
    take(data.load("standing"), &mut standing, &mut complaints);
    let mut panel = None;
    take(data.load("panel"), &mut panel, &mut complaints);
    complaints.extend(data.complaint().cloned());
    setup.plc_retained = value(data.load("plc"), &mut complaints);
    if let Some(ladder) = value(data.ladder(), &mut complaints) {
        setup.ladder = Arc::new(ladder).into();
    }
    let (programs, damaged) = data.programs();
    complaints.extend(damaged);
    let mut encodings = BTreeMap::new();
    for stored in programs {
        let program = Program::new(stored.text.as_str());
        let text = match program.number() {
            Some(number) if number == stored.number => stored.text,
            _ => program.renumbered(stored.number).text().to_owned(),
        };
        match setup.memory.programs.store(text) {
            Ok(number) => {
                encodings.insert(number, stored.encoding);
            }
            Err(alarm) => complaints.push(Complaint {
                name: format!("O{:04}", stored.number),
                said: say::stored_program_reason(stored.number, alarm.reason()),
            }),
        }
    }
    if let Some(number) = selected {
        setup.memory.programs.select(ProgramId::Stored(number));
    }
    if !complaints.is_empty() {
        let names: Vec<&str> = complaints.iter().map(|it| it.name.as_str()).collect();
        setup
            .alarms
            .push(Alarm::new(number::MEMORY_DAMAGED).because(say::as_written(names.join(", "))));
    }
    if !data.interrupted().is_empty() {
        let names = data.interrupted().join(", ");
        setup
            .alarms
            .push(Alarm::new(number::WRITE_INTERRUPTED).because(say::as_written(names)));
    }
    Restored {
        encodings,
        complaints: complaints.into_iter().map(|it| it.said).collect(),
        standing,
        panel,
    }
}

fn take<T>(loaded: Loaded<T>, place: &mut T, complaints: &mut Vec<Complaint>) {
    if let Some(value) = value(loaded, complaints) {
        *place = value;
    }
}

/// Returns the loaded value, if there is one; adds damage to the complaints.
fn value<T>(loaded: Loaded<T>, complaints: &mut Vec<Complaint>) -> Option<T> {
    match loaded {
        Loaded::Value(value) => Some(value),
        Loaded::Recovered(value, said) => {
            complaints.push(said);
            Some(value)
        }
        Loaded::Missing => None,
        Loaded::Damaged(said) => {
            complaints.push(said);
            None
        }
    }
}

/// Saves the memory of a control in its directory, once.
///
/// # Errors
/// The files that could not be written; all others are written.
pub fn save(data: DataDir, restored: &Restored, cnc: &Cnc) -> Result<(), NotSaved> {
    save_once(data, restored, &Snapshot::of(cnc))
}

/// Saves the memory of a whole emulator in its directory, once.
///
/// # Errors
/// The files that could not be written; all others are written.
pub fn save_emulator(
    data: DataDir,
    restored: &Restored,
    emulator: &Emulator,
) -> Result<(), NotSaved> {
    save_once(data, restored, &Snapshot::of_emulator(emulator))
}

fn save_once(data: DataDir, restored: &Restored, now: &Snapshot) -> Result<(), NotSaved> {
    // Only the window loads another ladder.
    let ladder = Arc::clone(&now.ladder);
    let failures = Writer::new(Arc::new(data), restored, ladder).write(now);
    if failures.is_empty() {
        Ok(())
    } else {
        Err(NotSaved(failures))
    }
}
