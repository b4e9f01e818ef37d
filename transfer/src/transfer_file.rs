//! A file in transfer: reception of blocks and sending of blocks.

use crate::file_name::FileName;
use crate::frame::{BLOCK_BYTES, PutRequest, RemotePath, TransferRequest};
use crate::station::Station;
use crate::transfer_fault::TransferFault;

/// Number of blocks of a file that wait in the station, so that the line is never idle.
const MAX_WAITING_BLOCKS: usize = 2;

/// Greatest size of a file, bytes. The receiver refuses a larger announcement.
pub(crate) const MAX_FILE_BYTES: u32 = 1 << 24;

/// A file in the directory of a partition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DirectoryEntry {
    /// Name of the file.
    pub name: FileName,
    /// Size of the file in bytes.
    pub size: u32,
}

/// A complete file with its path at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TransferFile {
    /// Path of the file at the control.
    pub remote_path: RemotePath,
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// Whether to replace an existing file of the same name.
    pub overwrite: bool,
}

/// Progress of a file transfer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TransferProgress {
    /// Number of bytes transferred so far.
    pub done: usize,
    /// Size of the file in bytes.
    pub total: usize,
}

/// A file that is being received: its announcement and the bytes so far.
#[derive(Clone, Debug)]
pub(crate) struct IncomingFile {
    pub put: PutRequest,
    bytes: Vec<u8>,
}

impl IncomingFile {
    pub(crate) const fn new(put: PutRequest) -> Self {
        Self {
            put,
            bytes: Vec::new(),
        }
    }

    /// Appends the next block of the file.
    ///
    /// # Errors
    /// [`TransferFault::Content`]: the file has more bytes than announced.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), TransferFault> {
        let length = self.bytes.len() + bytes.len();
        if length > self.put.size as usize {
            return Err(TransferFault::Content);
        }
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }

    pub(crate) const fn progress(&self) -> TransferProgress {
        TransferProgress {
            done: self.bytes.len(),
            total: self.put.size as usize,
        }
    }

    /// Returns the received file after its last block.
    ///
    /// # Errors
    /// [`TransferFault::Content`]: the file has fewer bytes than announced.
    pub(crate) fn finish(self) -> Result<TransferFile, TransferFault> {
        match self.bytes.len() == self.put.size as usize {
            true => Ok(TransferFile {
                remote_path: self.put.remote_path,
                bytes: self.bytes,
                overwrite: self.put.overwrite,
            }),
            false => Err(TransferFault::Content),
        }
    }
}

/// A file that is being sent, with its progress.
#[derive(Clone, Debug)]
pub(crate) struct OutgoingFile {
    file: TransferFile,
    /// Whether the peer has accepted the announcement.
    is_accepted: bool,
    /// Number of bytes of the file that were queued in the station.
    queued_bytes: usize,
    /// Number of bytes of the file that the peer has acknowledged.
    acknowledged_bytes: usize,
    is_eof_queued: bool,
}

impl OutgoingFile {
    /// Queues the announcement of a file in the station and starts its transfer.
    pub(crate) fn announce(file: TransferFile, station: &mut Station) -> Self {
        station.send(TransferRequest::Put(PutRequest {
            remote_path: file.remote_path.clone(),
            size: u32::try_from(file.bytes.len()).unwrap_or(u32::MAX),
            overwrite: file.overwrite,
        }));
        Self {
            file,
            is_accepted: false,
            queued_bytes: 0,
            acknowledged_bytes: 0,
            is_eof_queued: false,
        }
    }

    /// Returns the file, so that the caller can announce it again.
    pub(crate) fn into_file(self) -> TransferFile {
        self.file
    }

    pub(crate) const fn is_accepted(&self) -> bool {
        self.is_accepted
    }

    pub(crate) const fn file(&self) -> &TransferFile {
        &self.file
    }

    pub(crate) const fn progress(&self) -> TransferProgress {
        TransferProgress {
            done: self.acknowledged_bytes,
            total: self.file.bytes.len(),
        }
    }

    /// Queues the next blocks of an accepted file in the station, and the end of the file
    /// after the last block.
    pub(crate) fn continue_sending(&mut self, station: &mut Station) {
        if !self.is_accepted {
            return;
        }
        while self.queued_bytes < self.file.bytes.len() && station.waiting() < MAX_WAITING_BLOCKS {
            let end = (self.queued_bytes + BLOCK_BYTES).min(self.file.bytes.len());
            station.send(TransferRequest::Data(
                self.file.bytes[self.queued_bytes..end].to_vec(),
            ));
            self.queued_bytes = end;
        }
        if self.queued_bytes == self.file.bytes.len() && !self.is_eof_queued {
            self.is_eof_queued = true;
            station.send(TransferRequest::Eof);
        }
    }

    /// Processes the peer's reply to a frame of this file. Returns the result once the
    /// transfer has ended; `None` while it continues.
    pub(crate) fn handle_reply(
        &mut self,
        request: &TransferRequest,
        result: Result<(), TransferFault>,
    ) -> Option<Result<(), TransferFault>> {
        if result.is_err() {
            return Some(result);
        }
        match request {
            TransferRequest::Put(_) => self.is_accepted = true,
            TransferRequest::Data(bytes) => self.acknowledged_bytes += bytes.len(),
            TransferRequest::Eof => return Some(Ok(())),
            _ => {}
        }
        None
    }
}
