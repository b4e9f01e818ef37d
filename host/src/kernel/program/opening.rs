//! Opens a program read from a file: stores it in the memory, or reports why not.

use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::units::Axis;
use gsk_messages::say;
use gsk_panel::emulator::EmulatorInput;
use gsk_panel::keys::Key;
use tracing::info;

use super::start::programmed_start;
use crate::kernel::edges::KeyEdge;
use crate::kernel::part::end_crash_faults;
use crate::kernel::{Kernel, NotStored, Notice, OpenedProgram, ProgramPlacement, StorePolicy};

/// The program that was opened last from a file.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct LastOpened {
    pub name: String,
    /// The text of the program as it was stored; `None` if it was not stored.
    stored: Option<Program>,
}

impl Kernel {
    /// Opens a program and reports the result to the window by a notice; returns true if the
    /// program is selected then.
    pub(in crate::kernel) fn open(&mut self, opened: OpenedProgram) -> bool {
        let run_state = self.emulator.cnc().run_state();
        if matches!(run_state, RunState::Run | RunState::Hold) {
            let why = say::program_opened_after_reset(&opened.name);
            self.notify(Notice::Message(why));
            return false;
        }
        let program = with_number(&opened);
        let taken = program
            .number()
            .filter(|number| self.is_other_program(*number, &program, &opened.name));
        if let (Some(number), StorePolicy::AskOperator) = (taken, opened.store_policy) {
            self.notify(Notice::NumberTaken(Box::new(opened), number));
            return false;
        }
        for program in &opened.subprograms {
            self.store_subprogram(program);
        }
        let kept = match (taken, opened.store_policy) {
            (Some(number), StorePolicy::RunOnly) => Err(NotStored::NumberTaken(number)),
            _ => self.store(&program),
        };
        let place = match kept {
            Ok(number) => ProgramPlacement::Stored(number),
            Err(why) => {
                if let Err(alarm) = self.emulator.load_external(opened.program) {
                    self.notify(Notice::Refused(alarm));
                    return false;
                }
                ProgramPlacement::OnlyRun(why)
            }
        };
        let stored = matches!(place, ProgramPlacement::Stored(_)).then_some(program);
        let OpenedProgram { name, path, .. } = opened;
        self.last_opened = Some(LastOpened {
            name: name.clone(),
            stored,
        });
        info!(file = name, place = ?place, "program opened");
        self.notify(Notice::Opened {
            name,
            path,
            placement: place,
        });
        true
    }

    /// Opens a sample and prepares the simulated lathe for it, which may stand anywhere, in a
    /// half-cut bar or after a crash; `starts`: starts it. With a board it is opened only.
    pub(in crate::kernel) fn open_sample(&mut self, opened: OpenedProgram, starts: bool) {
        let record = self.emulator.cnc().model().record();
        let zero = programmed_start(&opened.program, record);
        let is_selected = self.open(opened);
        if !is_selected || self.drive.is_some() {
            return;
        }
        end_crash_faults(&mut self.emulator);
        let start = self.emulator.lathe().config().start();
        self.emulator.apply(EmulatorInput::PlaceSlides(start));
        // The slides stand at the start point of the program, and the display says so.
        for (axis, value) in zero
            .iter()
            .flat_map(|it| [(Axis::X, it.x), (Axis::Z, it.z)])
        {
            let request = ControlRequest::SetCoordinate(axis, value);
            // Refused only while a program runs, and then nothing has been opened.
            let _ = self.emulator.request(request);
        }
        self.part.fresh_stock();
        self.notify(Notice::FreshStock);
        // RESET clears the alarms; in edit mode it returns to the head of the program.
        let mut keys = vec![Key::Edit, Key::Reset];
        if starts {
            keys.extend([Key::Auto, Key::CycleStart]);
        }
        for key in keys {
            self.key_edges.push(KeyEdge::Tap(key));
        }
    }

    /// Whether the memory has a program of this number that is neither `program` nor the text that
    /// the file `name` had when it was opened last.
    fn is_other_program(&self, number: u16, program: &Program, name: &str) -> bool {
        let programs = self.emulator.cnc().programs();
        let Some(existing) = programs.get(ProgramId::Stored(number)) else {
            return false;
        };
        let last = self.last_opened.as_ref().filter(|last| last.name == name);
        let before = last.and_then(|last| last.stored.as_ref());
        existing.text() != program.text()
            && before.is_none_or(|before| before.text() != existing.text())
    }

    /// Stores a program unless the memory has the same text, and selects it. Returns its number, or
    /// why it is not stored.
    pub(in crate::kernel) fn store(&mut self, program: &Program) -> Result<u16, NotStored> {
        let number = program.number().ok_or(NotStored::NoNumber)?;
        let cnc = self.emulator.cnc();
        let existing = cnc.programs().get(ProgramId::Stored(number));
        let request = if existing.is_some_and(|there| there.text() == program.text()) {
            ControlRequest::SelectProgram(number)
        } else {
            let allowed = cnc.rights().check_program_store(number);
            allowed.map_err(NotStored::Refused)?;
            ControlRequest::StoreProgram(program.text().to_owned())
        };
        self.emulator.request(request).map_err(NotStored::Alarm)?;
        Ok(number)
    }

    /// Stores a subprogram unless the memory has a program of its number.
    fn store_subprogram(&mut self, program: &Program) {
        let cnc = self.emulator.cnc();
        let known = program
            .number()
            .is_some_and(|number| cnc.programs().get(ProgramId::Stored(number)).is_some());
        if known {
            return;
        }
        let request = ControlRequest::StoreProgram(program.text().to_owned());
        if let Err(alarm) = self.emulator.request(request) {
            self.notify(Notice::Refused(alarm));
        }
    }
}

/// Returns the program with a number: that of its O word, else the one in its file name; unchanged
/// without either.
fn with_number(opened: &OpenedProgram) -> Program {
    let program = &opened.program;
    match (
        program.number(),
        gsk_panel::emulator::number_of_name(&opened.name),
    ) {
        (None, Some(number)) => program.renumbered(number),
        _ => program.clone(),
    }
}

#[cfg(test)]
mod tests {
    use gsk_core::model::{ControlModel, ModelId};
    use gsk_core::setup::Setup;
    use gsk_panel::emulator::Emulator;

    use super::*;

    #[test]
    fn a_sample_begins_at_its_start_point() {
        for (model, text) in [
            (ModelId::Gsk980td, "O0021;\nG50 X120 Z80;\nG00 X50;\nM30;\n"),
            (ModelId::Ncb08, "O0021;\nG50 X120 Z80;\nG00 X50;\nM30;\n"),
            (
                ModelId::Hx31,
                "%P21\nN10 G92 X120 Z80\nN20 G00 X50\nN30 M02\n",
            ),
        ] {
            let mut setup = Setup::default();
            setup.memory.model = ControlModel::new(model);
            let (mut kernel, _console) = Kernel::new(Emulator::new(setup));
            kernel.run(200);
            let sample = OpenedProgram {
                name: "sample.CNC".to_owned(),
                path: None,
                store_policy: StorePolicy::Replace,
                program: Program::new(text),
                subprograms: Vec::new(),
            };
            kernel.open_sample(sample, false);
            // RESET, by which a sample returns to its head, leaves the coordinates.
            kernel.run(2000);
            let work = kernel.emulator.cnc().position_absolute();
            assert!((work.x - 60.0).abs() < 1e-9, "{model:?}: {work:?}");
            assert!((work.z - 80.0).abs() < 1e-9, "{model:?}: {work:?}");
        }
    }
}
