//! Loads the control's battery-backed memory from the data directory at the start, and
//! saves it while the control runs.

mod keeper;
pub mod project;
mod snapshot;
#[cfg(test)]
mod tests;
mod writer;

use std::collections::BTreeMap;
use std::path::Path;
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
use snapshot::{RetainedSnapshot, parts};
use writer::MemoryWriter;

use crate::files::data_dir::{DataDir, LoadedFile};
use crate::files::decode::TextEncoding;
use crate::files::mirrored_files::FileDamage;
use crate::message_format;

/// The position of the slides at the last save, and the coordinates on the display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedPosition {
    /// Position of the slides, machine coordinates, mm (X as a radius).
    pub machine: Point,
    /// Position on the display, absolute coordinates, mm.
    pub absolute: Point,
    /// Position of the simulated lathe's slides from its reference point, mm (X as a radius);
    /// `None` in files that lack it.
    #[serde(default)]
    pub slides: Option<Point>,
    /// Axes whose machine zero was set by hand (zero return of method A).
    #[serde(default)]
    pub zero_kept: PerAxis<bool>,
}

/// The error for files that could not be saved, one message per file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct NotSaved(pub Vec<Message>);

impl NotSaved {
    /// Returns the message for the operator with one line per file that could not be saved.
    pub fn message(&self) -> Message {
        message_format::join_lines(self.0.iter().cloned())
    }
}

/// The data loaded from a data directory besides the setup.
#[derive(Debug)]
pub struct Restored {
    /// The encodings of the programs, so that they are written back unchanged.
    encodings: BTreeMap<u16, TextEncoding>,
    /// Messages for damaged files of the data directory.
    pub complaints: Vec<Message>,
    /// Last saved position of the slides; `None` if none was saved.
    pub position: Option<SavedPosition>,
    /// Saved state of the panel; `None` if none was saved.
    pub panel: Option<PanelRetained>,
}

impl Restored {
    /// Moves slides and tool post of `setup` to their last position, for sessions that continue
    /// with the same machine.
    pub fn place_slides(&self, setup: &mut Setup) {
        let tool = setup.tool_in_position();
        if tool > 0 {
            setup.lathe.turret.first = tool;
        }
        if let Some(position) = self.position {
            setup.start = Some(position.machine);
            setup.absolute = Some(position.absolute);
            setup.slides = position.slides;
            setup.zero_kept = position.zero_kept;
        }
    }

    /// Restores the saved state of the panel, if there is one.
    pub fn restore_panel(&self, emulator: &mut Emulator) {
        if let Some(panel) = &self.panel {
            emulator.restore_panel(panel);
        }
    }
}

/// Loads the memory of a data directory into the setup of a command and returns it; prints damage
/// on standard error. `None` without a directory.
pub fn load_and_report(data: Option<&DataDir>, setup: &mut Setup) -> Option<Restored> {
    let restored = load(data?, setup);
    for complaint in &restored.complaints {
        crate::output::report_error(complaint);
    }
    restored.place_slides(setup);
    Some(restored)
}

/// Forgets where the slides stand, because another lathe takes the place of this one.
///
/// # Errors
/// Why the directory cannot be opened or written.
pub fn forget_position(directory: &Path) -> Result<(), Message> {
    let data = DataDir::open(directory).map_err(|error| error.message())?;
    data.store("standing", &None::<SavedPosition>)
}

/// Loads the memory of a data directory into a setup.
pub fn load(data: &DataDir, setup: &mut Setup) -> Restored {
    let mut complaints = Vec::new();
    for (name, part) in parts(&mut setup.memory) {
        part.load(data, name, &mut complaints);
    }
    let mut selected = None;
    assign_loaded(data.load("selected"), &mut selected, &mut complaints);
    let mut position = None;
    assign_loaded(data.load("standing"), &mut position, &mut complaints);
    let mut panel = None;
    assign_loaded(data.load("panel"), &mut panel, &mut complaints);
    complaints.extend(data.manifest_damage().cloned());
    setup.plc_retained = loaded_value(data.load("plc"), &mut complaints);
    if let Some(ladder) = loaded_value(data.load_ladder(), &mut complaints) {
        setup.ladder = Arc::new(ladder).into();
    }
    let (programs, damaged) = data.load_programs();
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
            Err(alarm) => complaints.push(FileDamage {
                file_name: format!("O{:04}", stored.number),
                message: say::stored_program_reason(stored.number, alarm.reason()),
            }),
        }
    }
    if let Some(number) = selected {
        setup.memory.programs.select(ProgramId::Stored(number));
    }
    if !complaints.is_empty() {
        let names: Vec<&str> = complaints.iter().map(|it| it.file_name.as_str()).collect();
        setup.alarms.push(
            Alarm::new(number::MEMORY_DAMAGED).with_detail(say::as_written(names.join(", "))),
        );
    }
    if !data.interrupted_programs().is_empty() {
        let names = data.interrupted_programs().join(", ");
        setup
            .alarms
            .push(Alarm::new(number::WRITE_INTERRUPTED).with_detail(say::as_written(names)));
    }
    Restored {
        encodings,
        complaints: complaints.into_iter().map(|it| it.message).collect(),
        position,
        panel,
    }
}

fn assign_loaded<T>(loaded: LoadedFile<T>, target: &mut T, complaints: &mut Vec<FileDamage>) {
    if let Some(value) = loaded_value(loaded, complaints) {
        *target = value;
    }
}

/// Returns the loaded value; `None` if there is none. Adds damage to `complaints`.
fn loaded_value<T>(loaded: LoadedFile<T>, complaints: &mut Vec<FileDamage>) -> Option<T> {
    match loaded {
        LoadedFile::Value(value) => Some(value),
        LoadedFile::Recovered(value, complaint) => {
            complaints.push(complaint);
            Some(value)
        }
        LoadedFile::Missing => None,
        LoadedFile::Damaged(complaint) => {
            complaints.push(complaint);
            None
        }
    }
}

/// Saves the memory of a control in its directory, once.
///
/// # Errors
/// The files that could not be written; all others are written.
pub fn save(data: DataDir, restored: &Restored, cnc: &Cnc) -> Result<(), NotSaved> {
    save_once(data, restored, &RetainedSnapshot::from_cnc(cnc))
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
    save_once(data, restored, &RetainedSnapshot::from_emulator(emulator))
}

fn save_once(data: DataDir, restored: &Restored, now: &RetainedSnapshot) -> Result<(), NotSaved> {
    // Only the window loads another ladder.
    let ladder = Arc::clone(&now.ladder);
    let failures = MemoryWriter::new(Arc::new(data), restored, ladder).write(now);
    if failures.is_empty() {
        Ok(())
    } else {
        Err(NotSaved(failures))
    }
}
