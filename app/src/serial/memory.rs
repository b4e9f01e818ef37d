//! The memory of the control as a store of files.

use gsk_core::memory::Refusal;
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::{FileId, FileRefusal, SerialFile};
use gsk_transfer::{Entry, Fault, FileName, NewFile, Partition, Place, Put, Store};

use crate::files::decode;

/// The memory, in the partition USER: the other two are empty and take nothing.
pub(super) struct Memory<'a> {
    emulator: &'a mut Emulator,
    /// Why the last file was not taken, in full.
    why: Option<Message>,
}

impl<'a> Memory<'a> {
    pub(super) const fn of(emulator: &'a mut Emulator) -> Self {
        Self {
            emulator,
            why: None,
        }
    }

    pub(super) fn into_why(self) -> Option<Message> {
        self.why
    }

    fn refused(&mut self, refusal: &FileRefusal) -> Fault {
        self.why = Some(refusal.message());
        fault(refusal)
    }
}

/// As it goes over the wire.
fn fault(refusal: &FileRefusal) -> Fault {
    match refusal {
        FileRefusal::Refused(refusal) => match refusal {
            Refusal::Mode | Refusal::Running | Refusal::Alarm => Fault::Busy,
            Refusal::ParameterSwitch | Refusal::ProgramSwitch => Fault::SwitchOff,
            Refusal::Level | Refusal::Locked => Fault::NoRight,
        },
        FileRefusal::Missing => Fault::NotFound,
        FileRefusal::Exists => Fault::Exists,
        FileRefusal::OnlyPrograms => Fault::NoRight,
        FileRefusal::Alarm(_) if refusal.is_for_room() => Fault::Full,
        FileRefusal::Unreadable(_) | FileRefusal::Alarm(_) => Fault::Content,
    }
}

/// Which file is meant; in the other partitions there is none.
fn found(place: &Place) -> Result<FileId, Fault> {
    match place.partition {
        Partition::User => FileId::of(place.name.as_str()).ok_or(Fault::NotFound),
        Partition::User1 | Partition::User2 => Err(Fault::NotFound),
    }
}

/// Which file is to come.
fn wanted(place: &Place) -> Result<FileId, Fault> {
    match place.partition {
        Partition::User => FileId::of(place.name.as_str()).ok_or(Fault::BadName),
        Partition::User1 | Partition::User2 => Err(Fault::Full),
    }
}

impl Store for Memory<'_> {
    fn directory(&mut self, partition: Partition) -> Result<Vec<Entry>, Fault> {
        if partition != Partition::User {
            return Ok(Vec::new());
        }
        let entry = |file: SerialFile| {
            Some(Entry {
                name: FileName::new(&file.name).ok()?,
                size: u32::try_from(file.text.len()).ok()?,
            })
        };
        Ok(self
            .emulator
            .files()
            .into_iter()
            .filter_map(entry)
            .collect())
    }

    fn may_put(&mut self, put: &Put) -> Result<(), Fault> {
        let id = wanted(&put.place)?;
        let may = self.emulator.may_take(id, put.overwrite);
        may.map_err(|refusal| self.refused(&refusal))
    }

    fn put(&mut self, file: &NewFile) -> Result<(), Fault> {
        let id = wanted(&file.place)?;
        let text = match decode::decode(file.bytes.clone()) {
            Ok(decoded) => decoded.text,
            Err(error) => {
                self.why = Some(error.message());
                return Err(Fault::Content);
            }
        };
        let name = file.place.name.as_str().to_owned();
        let overwrite = file.overwrite;
        let file = SerialFile { name, text };
        let taken = self.emulator.take_file(id, file, overwrite);
        taken.map_err(|refusal| self.refused(&refusal))
    }

    fn get(&mut self, place: &Place) -> Result<Vec<u8>, Fault> {
        let file = self.emulator.hand_out(found(place)?);
        let file = file.map_err(|refusal| fault(&refusal))?;
        Ok(file.text.into_bytes())
    }

    fn delete(&mut self, place: &Place) -> Result<(), Fault> {
        let deleted = self.emulator.delete_file(found(place)?);
        deleted.map_err(|refusal| fault(&refusal))
    }

    fn rename(&mut self, from: &Place, to: &FileName) -> Result<(), Fault> {
        let to = FileId::of(to.as_str()).ok_or(Fault::BadName)?;
        let renamed = self.emulator.rename_file(found(from)?, to);
        renamed.map_err(|refusal| fault(&refusal))
    }
}
