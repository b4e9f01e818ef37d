//! The frames: `01 type seq length(2) payload crc(2)`, and what they say.
//!
//! | Type | Meaning | Payload |
//! |---|---|---|
//! | 10, 11 | connect, bye | version; – |
//! | 20, 21, 22 | directory, entry, end of it | partition; name, size; – |
//! | 30, 31, 32 | put, data, end of file | partition, name, size, overwrite; bytes; – |
//! | 40 | get | partition, name |
//! | 50, 51 | delete, rename | partition, name; partition, old, new |
//! | 7E, 7F | taken, refused | sequence number; the same and a code of [`Fault`] |
//!
//! Types are hexadecimal. A name is its length and its characters, a size four bytes;
//! numbers have their low byte first. The checksum is CRC-16-CCITT (polynomial 1021,
//! from FFFF) over type to payload.

mod reader;

use crate::fault::Fault;
use crate::name::{FileName, Partition};

pub(crate) use reader::{Piece, Reader};

/// Bytes of a file in one frame (manual V-3.2).
pub const BLOCK: usize = 512;
/// The version of this protocol.
pub(crate) const VERSION: u8 = 1;

/// How a frame begins.
const START: u8 = 0x01;
/// Start, type, sequence number, length.
const HEAD: usize = 5;
/// The checksum.
const TAIL: usize = 2;
/// The longest frame.
pub(crate) const LONGEST: usize = HEAD + BLOCK + TAIL;

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

/// Where a file stands at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its partition.
    pub partition: Partition,
    /// Its name.
    pub name: FileName,
}

/// A file that is about to come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Put {
    /// Where it is to stand.
    pub place: Place,
    /// Its length, bytes.
    pub size: u32,
    /// It takes the place of one of its name.
    pub overwrite: bool,
}

/// What a frame says that wants an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    /// A side begins.
    Connect {
        /// Of the protocol.
        version: u8,
    },
    /// It ends.
    Bye,
    /// What files are there?
    Directory(Partition),
    /// One of them.
    Entry {
        /// Its name.
        name: FileName,
        /// Its length, bytes.
        size: u32,
    },
    /// There are no more.
    End,
    /// A file comes.
    Put(Put),
    /// Its next bytes.
    Data(Vec<u8>),
    /// That was all of it.
    Eof,
    /// A file is to be sent.
    Get(Place),
    /// A file is to be deleted.
    Delete(Place),
    /// A file is to have another name.
    Rename {
        /// Where it stands.
        from: Place,
        /// The new name.
        to: FileName,
    },
}

/// A frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    /// It wants an answer.
    Body {
        /// Its sequence number.
        seq: u8,
        /// What it says, or why nobody understands it.
        body: Result<Body, Fault>,
    },
    /// The answer to the frame of this number.
    Answer {
        /// The number.
        seq: u8,
        /// Taken, or refused.
        result: Result<(), Fault>,
    },
}

/// CRC-16-CCITT.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, &byte| {
        (0..8).fold(crc ^ (u16::from(byte) << 8), |crc, _| match crc & 0x8000 {
            0 => crc << 1,
            _ => (crc << 1) ^ 0x1021,
        })
    })
}

fn put_name(payload: &mut Vec<u8>, name: &FileName) {
    let name = name.as_str().as_bytes();
    // At most twelve characters.
    payload.push(name.len() as u8);
    payload.extend_from_slice(name);
}

fn put_place(payload: &mut Vec<u8>, place: &Place) {
    payload.push(place.partition.code());
    put_name(payload, &place.name);
}

fn encoded(kind: u8, seq: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(HEAD + payload.len() + TAIL);
    frame.extend([START, kind, seq]);
    frame.extend((payload.len() as u16).to_le_bytes());
    frame.extend_from_slice(payload);
    let crc = crc(&frame[1..]);
    frame.extend(crc.to_le_bytes());
    frame
}

impl Body {
    /// As it goes over the wire.
    pub(crate) fn encode(&self, seq: u8) -> Vec<u8> {
        let mut payload = Vec::new();
        let kind = match self {
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
                put_name(&mut payload, name);
                payload.extend(size.to_le_bytes());
                ENTRY
            }
            Self::End => END,
            Self::Put(put) => {
                put_place(&mut payload, &put.place);
                payload.extend(put.size.to_le_bytes());
                payload.push(u8::from(put.overwrite));
                PUT
            }
            Self::Data(bytes) => {
                payload.extend_from_slice(&bytes[..bytes.len().min(BLOCK)]);
                DATA
            }
            Self::Eof => EOF,
            Self::Get(place) => {
                put_place(&mut payload, place);
                GET
            }
            Self::Delete(place) => {
                put_place(&mut payload, place);
                DELETE
            }
            Self::Rename { from, to } => {
                put_place(&mut payload, from);
                put_name(&mut payload, to);
                RENAME
            }
        };
        encoded(kind, seq, &payload)
    }

    fn decode(kind: u8, payload: &[u8]) -> Result<Self, Fault> {
        let mut rest = Fields(payload);
        let body = match kind {
            CONNECT => Self::Connect {
                version: rest.byte()?,
            },
            BYE => Self::Bye,
            DIRECTORY => Self::Directory(rest.partition()?),
            ENTRY => Self::Entry {
                name: rest.name()?,
                size: rest.size()?,
            },
            END => Self::End,
            PUT => Self::Put(Put {
                place: rest.place()?,
                size: rest.size()?,
                overwrite: rest.byte()? != 0,
            }),
            DATA => Self::Data(core::mem::take(&mut rest.0).to_vec()),
            EOF => Self::Eof,
            GET => Self::Get(rest.place()?),
            DELETE => Self::Delete(rest.place()?),
            RENAME => Self::Rename {
                from: rest.place()?,
                to: rest.name()?,
            },
            _ => return Err(Fault::Content),
        };
        match rest.0 {
            [] => Ok(body),
            _ => Err(Fault::Content),
        }
    }
}

/// An answer as it goes over the wire.
pub(crate) fn encode_answer(seq: u8, result: Result<(), Fault>) -> Vec<u8> {
    match result {
        Ok(()) => encoded(ACK, seq, &[seq]),
        Err(fault) => encoded(NAK, seq, &[seq, fault.code()]),
    }
}

impl Frame {
    fn decode(kind: u8, seq: u8, payload: &[u8]) -> Self {
        match (kind, payload) {
            (ACK, &[seq]) => Self::Answer {
                seq,
                result: Ok(()),
            },
            (NAK, &[seq, code]) => Self::Answer {
                seq,
                // A code that nobody knows is a refusal all the same.
                result: Err(Fault::of(code).unwrap_or(Fault::Content)),
            },
            _ => Self::Body {
                seq,
                body: Body::decode(kind, payload),
            },
        }
    }
}

/// What is left of a payload.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn byte(&mut self) -> Result<u8, Fault> {
        let (&byte, rest) = self.0.split_first().ok_or(Fault::Content)?;
        self.0 = rest;
        Ok(byte)
    }

    fn partition(&mut self) -> Result<Partition, Fault> {
        Partition::of(self.byte()?).ok_or(Fault::BadName)
    }

    fn name(&mut self) -> Result<FileName, Fault> {
        let length = usize::from(self.byte()?);
        let (name, rest) = self.0.split_at_checked(length).ok_or(Fault::Content)?;
        self.0 = rest;
        let name = core::str::from_utf8(name).map_err(|_| Fault::BadName)?;
        FileName::new(name).map_err(|_| Fault::BadName)
    }

    fn place(&mut self) -> Result<Place, Fault> {
        Ok(Place {
            partition: self.partition()?,
            name: self.name()?,
        })
    }

    fn size(&mut self) -> Result<u32, Fault> {
        let (size, rest) = self.0.split_first_chunk().ok_or(Fault::Content)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*size))
    }
}

#[cfg(test)]
#[path = "frame_tests.rs"]
mod tests;
