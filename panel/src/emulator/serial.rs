//! Gives a serial port client access to the files in memory.

use std::sync::Arc;

use gsk_core::alarm::number;
use gsk_core::cnc::{Cnc, ControlRequest, ReceivedData};
use gsk_core::plc::Ladder;
use gsk_core::program::Program;
use serde::{Deserialize, Serialize};

use super::{Emulator, EmulatorInput, InputAnswer};
use crate::pages::Communication;
use crate::panel::{FileId, FileRefusal, SerialFile, file_of, read_data};

/// A request of a client at a port of the computer about the files in memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PortRequest {
    /// Checks whether the control would receive a file. An insufficient authority level raises
    /// its alarm.
    CheckReceive {
        /// Identifies the file to receive.
        id: FileId,
        /// Whether an existing file of this name may be replaced.
        overwrite: bool,
    },
    /// Passes a file to the control, which receives all of it or nothing.
    Receive {
        /// Identifies the file to receive; gives a program its number.
        id: FileId,
        /// Name and text of the received file.
        file: SerialFile,
        /// Whether an existing file of this name may be replaced.
        overwrite: bool,
    },
    /// Requests the text of a file from the control.
    Send(FileId),
    /// Deletes a program in the control's memory.
    Delete(FileId),
    /// Gives a program in the control's memory another number.
    Rename {
        /// The program to rename.
        from: FileId,
        /// The new number of the program.
        to: FileId,
    },
}

impl Emulator {
    /// Sets the state of the serial port: shows it in the LCD's status row and puts it into
    /// the PLC signals F213.
    pub fn show_port_state(&mut self, shown: Communication) {
        self.apply(EmulatorInput::PortState(shown));
    }

    /// Sends the request of a client at the port. Returns the requested file; `None` if the
    /// request returns none.
    ///
    /// # Errors
    ///
    /// Returns the reason for refusing the request.
    pub fn request_port(
        &mut self,
        request: PortRequest,
    ) -> Result<Option<SerialFile>, FileRefusal> {
        match self.apply(EmulatorInput::Port(request)) {
            InputAnswer::FileRefused(refused) => Err(refused),
            InputAnswer::Files(files) => Ok(files.into_iter().next()),
            _ => Ok(None),
        }
    }

    pub(super) fn execute_port_request(
        &mut self,
        request: PortRequest,
    ) -> Result<Option<SerialFile>, FileRefusal> {
        self.store_edited_text();
        match request {
            PortRequest::CheckReceive { id, overwrite } => self.check_receive(id, overwrite)?,
            PortRequest::Receive {
                id,
                file,
                overwrite,
            } => self.receive_file(id, file, overwrite)?,
            PortRequest::Send(id) => return self.send_file(id).map(Some),
            PortRequest::Delete(id) => {
                let number = self.changeable_program(id)?;
                self.request_transfer(ReceivedData::Deletion(number))?;
            }
            PortRequest::Rename { from, to } => self.rename_file(from, to)?,
        }
        Ok(None)
    }

    /// Returns the files that a client at the port can see, programs first.
    pub fn files(&self) -> Vec<SerialFile> {
        let cnc = &self.simulation.cnc;
        let numbers = cnc.programs().iter().map(|(number, _)| number);
        let seen = numbers.filter(|number| !cnc.rights().is_hidden(*number));
        seen.map(FileId::Program)
            .chain(FileId::DATA)
            .filter_map(|id| file_of(id, cnc))
            .collect()
    }

    fn check_receive(&mut self, id: FileId, overwrite: bool) -> Result<(), FileRefusal> {
        let cnc = &mut self.simulation.cnc;
        let FileId::Program(number) = id else {
            match id {
                FileId::Ladder => cnc.rights().check_ladder()?,
                _ => cnc.rights().check_receive_data()?,
            }
            return if overwrite {
                Ok(())
            } else {
                Err(FileRefusal::Exists)
            };
        };
        if let Err(refusal) = cnc.rights().check_receive_program(number) {
            // Its alarm is shown on the alarm page.
            let _ = cnc.request(ControlRequest::CheckReceive(number));
            return Err(refusal.into());
        }
        match cnc.programs().stored(number) {
            Some(_) if !overwrite => Err(FileRefusal::Exists),
            _ => Ok(()),
        }
    }

    fn receive_file(
        &mut self,
        id: FileId,
        file: SerialFile,
        overwrite: bool,
    ) -> Result<(), FileRefusal> {
        let cnc = &mut self.simulation.cnc;
        let received = match id {
            FileId::Program(number) => {
                cnc.rights().check_receive_program(number)?;
                let program = Program::new(file.text);
                let program = match program.number() {
                    Some(own) if own == number => program,
                    _ => program.renumbered(number),
                };
                let text = program.text().to_owned();
                match overwrite {
                    true => ReceivedData::Replacement(text),
                    false => ReceivedData::Program(text),
                }
            }
            FileId::Ladder => {
                cnc.rights().check_ladder()?;
                return receive_ladder(cnc, &file.text);
            }
            _ => {
                cnc.rights().check_receive_data()?;
                read_data(&file).map_err(FileRefusal::Unreadable)?
            }
        };
        self.request_transfer(received)
    }

    fn send_file(&self, id: FileId) -> Result<SerialFile, FileRefusal> {
        let cnc = &self.simulation.cnc;
        match id {
            FileId::Program(number) => cnc.rights().check_fetch_program(number)?,
            _ => cnc.rights().check_fetch_data()?,
        }
        file_of(id, cnc).ok_or(FileRefusal::Missing)
    }

    fn rename_file(&mut self, from: FileId, to: FileId) -> Result<(), FileRefusal> {
        let from = self.changeable_program(from)?;
        let FileId::Program(to) = to else {
            return Err(FileRefusal::OnlyPrograms);
        };
        let cnc = &self.simulation.cnc;
        cnc.rights().check_receive_program(to)?;
        if cnc.programs().stored(to).is_some() {
            return Err(FileRefusal::Exists);
        }
        self.request_transfer(ReceivedData::Renaming { from, to })
    }

    /// Returns the number of a program that may be deleted or renamed, otherwise the refusal.
    fn changeable_program(&self, id: FileId) -> Result<u16, FileRefusal> {
        let FileId::Program(number) = id else {
            return Err(FileRefusal::OnlyPrograms);
        };
        let cnc = &self.simulation.cnc;
        cnc.rights().check_receive_program(number)?;
        match cnc.programs().stored(number) {
            Some(_) => Ok(number),
            None => Err(FileRefusal::Missing),
        }
    }

    fn request_transfer(&mut self, received: ReceivedData) -> Result<(), FileRefusal> {
        let done = self
            .simulation
            .cnc
            .request(ControlRequest::StoreReceived(received));
        done.map_err(|alarm| match alarm.number {
            number::PROGRAM_STORED => FileRefusal::Exists,
            _ => FileRefusal::Alarm(Box::new(alarm)),
        })
    }
}

/// Stores a received ladder for the next power-on (manual PLC-I 1.2).
fn receive_ladder(cnc: &mut Cnc, text: &str) -> Result<(), FileRefusal> {
    let ladder = Ladder::compile(text).map_err(|errors| {
        let first = errors.errors.into_iter().next();
        first.map_or(FileRefusal::Missing, FileRefusal::Ladder)
    })?;
    let stored = cnc.request(ControlRequest::LoadLadder(Arc::new(ladder)));
    stored.map_err(|alarm| FileRefusal::Alarm(Box::new(alarm)))
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "tests fail by panicking")]
mod tests {
    use gsk_core::memory::WriteRefusal;
    use gsk_core::setup::Setup;

    use super::*;
    use crate::emulator::{WaitCondition, WaitOutcome};
    use crate::keys::Key;
    use crate::panel::SerialCable;

    fn file(name: &str, text: &str) -> SerialFile {
        SerialFile {
            name: name.to_owned(),
            text: text.to_owned(),
        }
    }

    fn emulator() -> Emulator {
        let mut setup = Setup::default();
        for text in ["O0001;\nM30;\n", "O9500;\nM99;\n"] {
            setup
                .memory
                .programs
                .store(text)
                .expect("room for a program");
        }
        let mut emulator = Emulator::new(setup);
        emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
        emulator.connect_cable(SerialCable::Line);
        emulator
    }

    #[test]
    fn names_of_the_control_are_known_and_no_others() {
        for (name, id) in [
            ("O0331.CNC", Some(FileId::Program(331))),
            ("o1.cnc", Some(FileId::Program(1))),
            ("paraw.PAR", Some(FileId::Parameters)),
            ("Tofs.ofs", Some(FileId::Offsets)),
            ("Wcomp.wmp", Some(FileId::Pitch)),
            ("O0001.NC", None),
            ("other.par", None),
            ("main.LDX", Some(FileId::Ladder)),
            ("lad.ldx", None),
        ] {
            assert_eq!(FileId::of(name), id, "{name}");
        }
    }

    #[test]
    fn rights_apply_as_at_the_panel() {
        let mut emulator = emulator();
        let one = FileId::Program(1);
        assert_eq!(
            emulator.request_port(PortRequest::CheckReceive {
                id: one,
                overwrite: false
            }),
            Err(FileRefusal::Exists)
        );
        assert_eq!(
            emulator.request_port(PortRequest::CheckReceive {
                id: one,
                overwrite: true
            }),
            Ok(None)
        );
        let switch = Err(FileRefusal::Refused(WriteRefusal::ParameterSwitch));
        assert_eq!(
            emulator.request_port(PortRequest::CheckReceive {
                id: FileId::Offsets,
                overwrite: true
            }),
            switch
        );
        assert!(
            emulator
                .request_port(PortRequest::Send(FileId::Parameters))
                .is_err()
        );
        assert_eq!(
            emulator.request_port(PortRequest::Delete(FileId::Offsets)),
            Err(FileRefusal::OnlyPrograms)
        );
        assert_eq!(
            emulator.request_port(PortRequest::Delete(FileId::Program(7))),
            Err(FileRefusal::Missing)
        );
        let renamed = emulator.request_port(PortRequest::Rename {
            from: one,
            to: FileId::Program(9500),
        });
        assert!(renamed.is_err());
        emulator
            .request(ControlRequest::SetProgramSwitch(false))
            .expect("the switch");
        let switch = FileRefusal::Refused(WriteRefusal::ProgramSwitch);
        assert_eq!(
            emulator.request_port(PortRequest::CheckReceive {
                id: one,
                overwrite: true
            }),
            Err(switch.clone())
        );
        assert_eq!(
            emulator.request_port(PortRequest::Send(one)),
            Err(switch.clone())
        );
        assert_eq!(emulator.request_port(PortRequest::Delete(one)), Err(switch));
    }

    #[test]
    fn a_program_gets_the_number_of_its_name() {
        let mut emulator = emulator();
        let two = FileId::Program(2);
        let text = "O0001;\nG00 X1.;\nM30;\n%\n";
        emulator
            .request_port(PortRequest::Receive {
                id: two,
                file: file("O0002.CNC", text),
                overwrite: false,
            })
            .expect("taken");
        let out = emulator
            .request_port(PortRequest::Send(two))
            .expect("handed out")
            .expect("a file");
        assert_eq!(out.text, text.replace("O0001", "O0002"));
        // Without `overwrite` it replaces no program, and raises 073.
        let again = emulator.request_port(PortRequest::Receive {
            id: two,
            file: file("O0002.CNC", "O0002;\n"),
            overwrite: false,
        });
        assert_eq!(again, Err(FileRefusal::Exists));
        assert_eq!(
            emulator
                .request_port(PortRequest::Send(two))
                .expect("handed out")
                .expect("a file")
                .text,
            out.text
        );
        let alarm = emulator.cnc().alarms().first();
        assert_eq!(
            alarm.map(|alarm| alarm.number),
            Some(number::PROGRAM_STORED)
        );
        emulator.press(Key::Reset);
        emulator
            .request_port(PortRequest::Receive {
                id: two,
                file: file("O0002.CNC", "O0002;\nM99;\n"),
                overwrite: true,
            })
            .expect("taken");
        emulator
            .request_port(PortRequest::Rename {
                from: two,
                to: FileId::Program(3),
            })
            .expect("renamed");
        let names: Vec<String> = emulator.files().into_iter().map(|file| file.name).collect();
        assert_eq!(names[..2], ["O0001.CNC", "O0003.CNC"]);
        emulator
            .request_port(PortRequest::Delete(FileId::Program(3)))
            .expect("deleted");
        assert_eq!(
            emulator.request_port(PortRequest::Send(FileId::Program(3))),
            Err(FileRefusal::Missing)
        );
    }

    #[test]
    fn out_hands_files_to_the_line_and_reset_breaks_it_off() {
        let mut emulator = emulator();
        emulator.press(Key::Edit);
        emulator.press(Key::Program);
        emulator.type_text("O1");
        emulator.press(Key::Output);
        let sent = emulator.take_port_files();
        assert_eq!(sent, [file("O0001.CNC", "O0001;\nM30;\n%\n")]);
        // It flashes.
        let sending = |emulator: &mut Emulator| {
            emulator.run_until(&WaitCondition::Text("输出".to_owned()), 1000)
                == WaitOutcome::Reached
        };
        assert!(sending(&mut emulator));
        // The line stays busy until it reports otherwise.
        emulator.run(60_000);
        assert!(sending(&mut emulator) && !emulator.take_aborted());
        emulator.press(Key::Reset);
        assert!(!sending(&mut emulator) && emulator.take_aborted());
        assert!(!emulator.take_aborted());
        emulator.show_port_state(Communication::Failed);
        assert!(emulator.screen().text().contains("通信出错"));
    }
}
