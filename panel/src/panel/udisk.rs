//! Handles the page of the U disk: loads a program from it and stores the selected one on it.

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::command::ProgramId;
use gsk_core::program::Program;

use super::Panel;
use crate::keys::Key;
use crate::pages::{PageId, Udisk, UdiskFile};
use crate::panel::number_of_name;

impl Panel {
    /// Plugs a U disk with these files; `None` pulls it out.
    pub(crate) fn plug_udisk(&mut self, files: Option<Vec<UdiskFile>>) {
        self.view.udisk = files.map(|mut files| {
            files.sort_by(|one, other| one.name.cmp(&other.name));
            Udisk {
                files,
                stored: Vec::new(),
            }
        });
    }

    /// Returns whether the control has stored files on the U disk that were not taken yet.
    pub(crate) fn has_udisk_files(&self) -> bool {
        let disk = self.view.udisk.as_ref();
        disk.is_some_and(|disk| !disk.stored.is_empty())
    }

    /// Takes the files that the control has stored on the U disk.
    pub(crate) fn take_udisk_files(&mut self) -> Vec<UdiskFile> {
        let Some(disk) = &mut self.view.udisk else {
            return Vec::new();
        };
        let stored = core::mem::take(&mut disk.stored);
        let files = disk.files.iter();
        let taken = files.filter(|file| stored.contains(&file.name));
        taken.cloned().collect()
    }

    /// Handles 输入 and 输出 on the page of the U disk. Returns `false` for other keys.
    pub(super) fn udisk_key(
        &mut self,
        key: Key,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) -> bool {
        match key {
            Key::Input => self.view.disk_done = Some(self.load_from_udisk(cnc, requests)),
            Key::Output => {
                self.store_edited(requests);
                self.view.disk_done = Some(self.store_on_udisk(cnc));
            }
            _ => return false,
        }
        true
    }

    /// Requests to store the file at the cursor in the program memory. Returns whether it can
    /// be stored.
    fn load_from_udisk(&self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) -> bool {
        let item = self.view.cursors.get(PageId::Udisk).item;
        let file = self
            .view
            .udisk
            .as_ref()
            .and_then(|disk| disk.files.get(item));
        let Some(file) = file else {
            return false;
        };
        let program = Program::new(file.text.as_str());
        let program = match (program.number(), number_of_name(&file.name)) {
            (None, Some(number)) => program.renumbered(number),
            _ => program,
        };
        let number = program.number();
        let allowed = number.is_some_and(|it| cnc.rights().check_program_store(it).is_ok());
        if allowed {
            requests.push(ControlRequest::StoreProgram(program.text().to_owned()));
        }
        allowed
    }

    /// Stores the selected program on the U disk, under its number. Returns whether there is
    /// one that may leave the control.
    fn store_on_udisk(&mut self, cnc: &Cnc) -> bool {
        let Some(ProgramId::Stored(number)) = cnc.programs().selected() else {
            return false;
        };
        if cnc.rights().is_hidden(number) {
            return false;
        }
        let program = cnc.programs().stored(number);
        let (Some(program), Some(disk)) = (program, &mut self.view.udisk) else {
            return false;
        };
        let name = format!("O{number:04}.CNC");
        disk.files.retain(|file| file.name != name);
        disk.files.push(UdiskFile {
            name: name.clone(),
            text: program.text().to_owned(),
        });
        disk.files.sort_by(|one, other| one.name.cmp(&other.name));
        disk.stored.retain(|stored| *stored != name);
        disk.stored.push(name);
        true
    }
}
