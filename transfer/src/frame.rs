//! Frames on the wire: `01 type seq length(2) payload crc(2)`.
//!
//! | Type | Meaning | Payload |
//! |---|---|---|
//! | 10, 11 | connect, bye | version; – |
//! | 20, 21, 22 | directory, entry, end of it | partition; name, size; – |
//! | 30, 31, 32 | put, data, end of file | partition, name, size, overwrite; bytes; – |
//! | 40 | get | partition, name |
//! | 50, 51 | delete, rename | partition, name; partition, old, new |
//! | 7E, 7F | acknowledge, refuse | sequence number; the same and a code of [`TransferFault`] |
//!
//! Types are hexadecimal. A name is its length and its characters. A size has four bytes.
//! Numbers are little-endian. The checksum is CRC-16-CCITT (polynomial 1021, initial value
//! FFFF) over type to payload.

mod frame_reader;

use crate::file_name::{FileName, Partition};
use crate::transfer_fault::TransferFault;

pub(crate) use frame_reader::{FrameReader, ReaderOutput};

/// Greatest number of file bytes in one frame (manual V-3.2).
pub const BLOCK_BYTES: usize = 512;
/// Version of the frame protocol, part of the connect request.
pub(crate) const VERSION: u8 = 1;

/// First byte of a frame.
const START: u8 = 0x01;
/// Number of bytes before the payload: start byte, type, sequence number and length.
const HEADER_BYTES: usize = 5;
const CRC_BYTES: usize = 2;
/// Greatest length of a frame, bytes.
pub(crate) const MAX_FRAME_BYTES: usize = HEADER_BYTES + BLOCK_BYTES + CRC_BYTES;

const CONNECT: u8 = 0x10;
const BYE: u8 = 0x11;
const DIRECTORY: u8 = 0x20;
const ENTRY: u8 = 0x21;
const END: u8 = 0x22;
const PUT: u8 = 0x30;
const DATA: u8 = 0x31;
const EOF: u8 = 0x32;
const GET: u8 = 0x40;
const DELETE: u8 = 0x50;
const RENAME: u8 = 0x51;
const ACK: u8 = 0x7E;
const NAK: u8 = 0x7F;

/// Path of a file at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RemotePath {
    /// Partition of the file.
    pub partition: Partition,
    /// Name of the file.
    pub name: FileName,
}

/// The announcement of a file that follows in blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PutRequest {
    /// Path at the control.
    pub remote_path: RemotePath,
    /// Size of the file in bytes.
    pub size: u32,
    /// Whether to replace an existing file of the same name.
    pub overwrite: bool,
}

/// A request that the peer must reply to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TransferRequest {
    /// Starts a connection.
    Connect {
        /// Version of the frame protocol.
        version: u8,
    },
    /// Ends the connection.
    Bye,
    /// Requests the directory of this partition.
    Directory(Partition),
    /// Reports one file of the requested directory.
    Entry {
        /// Name of the file.
        name: FileName,
        /// Size of the file in bytes.
        size: u32,
    },
    /// Ends the list of the directory.
    End,
    /// Announces a file that follows in blocks.
    Put(PutRequest),
    /// Contains the next block of the announced file.
    Data(Vec<u8>),
    /// Ends the file that was announced before.
    Eof,
    /// Requests the file with this path.
    Get(RemotePath),
    /// Deletes the file with this path.
    Delete(RemotePath),
    /// Renames a file.
    Rename {
        /// Path of the file to rename.
        from: RemotePath,
        /// New name of the file, in the same partition.
        to: FileName,
    },
}

/// A frame on the wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum TransferFrame {
    /// A request with its sequence number.
    Request {
        /// Sequence number of the frame.
        seq: u8,
        /// The request, or the reason why it cannot be decoded.
        request: Result<TransferRequest, TransferFault>,
    },
    /// The reply to a request.
    Reply {
        /// Sequence number of the request.
        seq: u8,
        /// `Ok` if the request is acknowledged, otherwise the reason for its refusal.
        result: Result<(), TransferFault>,
    },
}

/// Computes the CRC-16-CCITT of bytes, with the initial value FFFF.
fn compute_crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, &byte| {
        (0..8).fold(crc ^ (u16::from(byte) << 8), |crc, _| match crc & 0x8000 {
            0 => crc << 1,
            _ => (crc << 1) ^ 0x1021,
        })
    })
}

fn encode_name(payload: &mut Vec<u8>, name: &FileName) {
    let name = name.as_str().as_bytes();
    // At most 12 characters.
    payload.push(name.len() as u8);
    payload.extend_from_slice(name);
}

fn encode_path(payload: &mut Vec<u8>, path: &RemotePath) {
    payload.push(path.partition.code());
    encode_name(payload, &path.name);
}

fn encode_frame(type_code: u8, seq: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(HEADER_BYTES + payload.len() + CRC_BYTES);
    frame.extend([START, type_code, seq]);
    frame.extend((payload.len() as u16).to_le_bytes());
    frame.extend_from_slice(payload);
    let crc = compute_crc(&frame[1..]);
    frame.extend(crc.to_le_bytes());
    frame
}

impl TransferRequest {
    /// Encodes the request as a frame with the sequence number `seq`.
    pub(crate) fn encode(&self, seq: u8) -> Vec<u8> {
        let mut payload = Vec::new();
        let type_code = match self {
            Self::Connect { version } => {
                payload.push(*version);
                CONNECT
            }
            Self::Bye => BYE,
            Self::Directory(partition) => {
                payload.push(partition.code());
                DIRECTORY
            }
            Self::Entry { name, size } => {
                encode_name(&mut payload, name);
                payload.extend(size.to_le_bytes());
                ENTRY
            }
            Self::End => END,
            Self::Put(put) => {
                encode_path(&mut payload, &put.remote_path);
                payload.extend(put.size.to_le_bytes());
                payload.push(u8::from(put.overwrite));
                PUT
            }
            Self::Data(bytes) => {
                payload.extend_from_slice(&bytes[..bytes.len().min(BLOCK_BYTES)]);
                DATA
            }
            Self::Eof => EOF,
            Self::Get(path) => {
                encode_path(&mut payload, path);
                GET
            }
            Self::Delete(path) => {
                encode_path(&mut payload, path);
                DELETE
            }
            Self::Rename { from, to } => {
                encode_path(&mut payload, from);
                encode_name(&mut payload, to);
                RENAME
            }
        };
        encode_frame(type_code, seq, &payload)
    }

    fn decode(type_code: u8, payload: &[u8]) -> Result<Self, TransferFault> {
        let mut rest = Fields(payload);
        let request = match type_code {
            CONNECT => Self::Connect {
                version: rest.take_byte()?,
            },
            BYE => Self::Bye,
            DIRECTORY => Self::Directory(rest.take_partition()?),
            ENTRY => Self::Entry {
                name: rest.take_name()?,
                size: rest.take_size()?,
            },
            END => Self::End,
            PUT => Self::Put(PutRequest {
                remote_path: rest.take_path()?,
                size: rest.take_size()?,
                overwrite: rest.take_byte()? != 0,
            }),
            DATA => Self::Data(core::mem::take(&mut rest.0).to_vec()),
            EOF => Self::Eof,
            GET => Self::Get(rest.take_path()?),
            DELETE => Self::Delete(rest.take_path()?),
            RENAME => Self::Rename {
                from: rest.take_path()?,
                to: rest.take_name()?,
            },
            _ => return Err(TransferFault::Content),
        };
        match rest.0 {
            [] => Ok(request),
            _ => Err(TransferFault::Content),
        }
    }
}

/// Encodes the reply to the request with the sequence number `seq` as a frame.
pub(crate) fn encode_reply(seq: u8, result: Result<(), TransferFault>) -> Vec<u8> {
    match result {
        Ok(()) => encode_frame(ACK, seq, &[seq]),
        Err(fault) => encode_frame(NAK, seq, &[seq, fault.code()]),
    }
}

impl TransferFrame {
    fn decode(type_code: u8, seq: u8, payload: &[u8]) -> Self {
        match (type_code, payload) {
            (ACK, &[seq]) => Self::Reply {
                seq,
                result: Ok(()),
            },
            (NAK, &[seq, code]) => Self::Reply {
                seq,
                // An unknown code is a refusal as well.
                result: Err(TransferFault::from_code(code).unwrap_or(TransferFault::Content)),
            },
            _ => Self::Request {
                seq,
                request: TransferRequest::decode(type_code, payload),
            },
        }
    }
}

/// The bytes of a payload that are not decoded yet.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take_byte(&mut self) -> Result<u8, TransferFault> {
        let (&byte, rest) = self.0.split_first().ok_or(TransferFault::Content)?;
        self.0 = rest;
        Ok(byte)
    }

    fn take_partition(&mut self) -> Result<Partition, TransferFault> {
        Partition::from_code(self.take_byte()?).ok_or(TransferFault::BadName)
    }

    fn take_name(&mut self) -> Result<FileName, TransferFault> {
        let length = usize::from(self.take_byte()?);
        let (name, rest) = self
            .0
            .split_at_checked(length)
            .ok_or(TransferFault::Content)?;
        self.0 = rest;
        let name = core::str::from_utf8(name).map_err(|_| TransferFault::BadName)?;
        FileName::new(name).map_err(|_| TransferFault::BadName)
    }

    fn take_path(&mut self) -> Result<RemotePath, TransferFault> {
        Ok(RemotePath {
            partition: self.take_partition()?,
            name: self.take_name()?,
        })
    }

    fn take_size(&mut self) -> Result<u32, TransferFault> {
        let (size, rest) = self.0.split_first_chunk().ok_or(TransferFault::Content)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*size))
    }
}

#[cfg(test)]
#[path = "frame_tests.rs"]
mod tests;
