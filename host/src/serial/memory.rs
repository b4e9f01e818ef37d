//! The memory of the control as a file store.

use gsk_core::memory::WriteRefusal;
use gsk_messages::Message;
use gsk_panel::emulator::{Emulator, PortRequest};
use gsk_panel::panel::{FileId, FileRefusal, SerialFile};
use gsk_transfer::{
    DirectoryEntry, FileName, FileStore, Partition, PutRequest, RemotePath, TransferFault,
    TransferFile,
};

use crate::files::decode;

/// The memory of the control as the partition USER of the transfer protocol; the other two
/// partitions are empty and read-only.
pub struct SerialFileStore<'a> {
    emulator: &'a mut Emulator,
    /// The full reason why the last file was refused; `None` if none was.
    refusal_reason: Option<Message>,
}

impl<'a> SerialFileStore<'a> {
    /// Creates the file store of a control.
    pub const fn new(emulator: &'a mut Emulator) -> Self {
        Self {
            emulator,
            refusal_reason: None,
        }
    }

    pub(super) fn into_refusal_reason(self) -> Option<Message> {
        self.refusal_reason
    }

    fn record_refusal(&mut self, refusal: &FileRefusal) -> TransferFault {
        self.refusal_reason = Some(refusal.message());
        to_fault(refusal)
    }
}

/// Converts a refusal to the fault code of the transfer protocol.
fn to_fault(refusal: &FileRefusal) -> TransferFault {
    match refusal {
        FileRefusal::Refused(refusal) => match refusal {
            WriteRefusal::Mode | WriteRefusal::Running | WriteRefusal::Alarm => TransferFault::Busy,
            WriteRefusal::ParameterSwitch | WriteRefusal::ProgramSwitch => TransferFault::SwitchOff,
            WriteRefusal::Level | WriteRefusal::Locked => TransferFault::NoRight,
        },
        FileRefusal::Missing => TransferFault::NotFound,
        FileRefusal::Exists => TransferFault::Exists,
        FileRefusal::OnlyPrograms => TransferFault::NoRight,
        FileRefusal::Alarm(_) if refusal.is_memory_full() => TransferFault::Full,
        FileRefusal::Unreadable(_) | FileRefusal::Ladder(_) | FileRefusal::Alarm(_) => {
            TransferFault::Content
        }
    }
}

/// Returns the id of the file to read; the partitions other than USER have none. Returns a fault as
/// error for these or an invalid name.
fn file_to_read(place: &RemotePath) -> Result<FileId, TransferFault> {
    match place.partition {
        Partition::User => FileId::of(place.name.as_str()).ok_or(TransferFault::NotFound),
        Partition::User1 | Partition::User2 => Err(TransferFault::NotFound),
    }
}

/// Returns the id of the file to write, or the fault if the name or partition permits none.
fn file_to_write(place: &RemotePath) -> Result<FileId, TransferFault> {
    match place.partition {
        Partition::User => FileId::of(place.name.as_str()).ok_or(TransferFault::BadName),
        Partition::User1 | Partition::User2 => Err(TransferFault::Full),
    }
}

impl FileStore for SerialFileStore<'_> {
    fn directory(&mut self, partition: Partition) -> Result<Vec<DirectoryEntry>, TransferFault> {
        if partition != Partition::User {
            return Ok(Vec::new());
        }
        let entry = |file: SerialFile| {
            Some(DirectoryEntry {
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

    fn check_put(&mut self, put: &PutRequest) -> Result<(), TransferFault> {
        let id = file_to_write(&put.remote_path)?;
        let request = PortRequest::CheckReceive {
            id,
            overwrite: put.overwrite,
        };
        let may = self.emulator.request_port(request).map(drop);
        may.map_err(|refusal| self.record_refusal(&refusal))
    }

    fn put(&mut self, file: &TransferFile) -> Result<(), TransferFault> {
        let id = file_to_write(&file.remote_path)?;
        let text = match decode::decode(file.bytes.clone()) {
            Ok(decoded) => decoded.text,
            Err(error) => {
                self.refusal_reason = Some(error.message());
                return Err(TransferFault::Content);
            }
        };
        let name = file.remote_path.name.as_str().to_owned();
        let overwrite = file.overwrite;
        let file = SerialFile { name, text };
        let request = PortRequest::Receive {
            id,
            file,
            overwrite,
        };
        let taken = self.emulator.request_port(request).map(drop);
        taken.map_err(|refusal| self.record_refusal(&refusal))
    }

    fn get(&mut self, place: &RemotePath) -> Result<Vec<u8>, TransferFault> {
        let request = PortRequest::Send(file_to_read(place)?);
        let file = self.emulator.request_port(request);
        let file = file.map_err(|refusal| to_fault(&refusal))?;
        file.map(|file| file.text.into_bytes())
            .ok_or(TransferFault::NotFound)
    }

    fn delete(&mut self, place: &RemotePath) -> Result<(), TransferFault> {
        let request = PortRequest::Delete(file_to_read(place)?);
        let deleted = self.emulator.request_port(request).map(drop);
        deleted.map_err(|refusal| to_fault(&refusal))
    }

    fn rename(&mut self, from: &RemotePath, to: &FileName) -> Result<(), TransferFault> {
        let to = FileId::of(to.as_str()).ok_or(TransferFault::BadName)?;
        let from = file_to_read(from)?;
        let request = PortRequest::Rename { from, to };
        let renamed = self.emulator.request_port(request).map(drop);
        renamed.map_err(|refusal| to_fault(&refusal))
    }
}
