//! A file on its way, at the side that sends it and at the one that takes it.

use crate::fault::Fault;
use crate::frame::{BLOCK, Body, Place, Put};
use crate::name::FileName;
use crate::station::Station;

/// Blocks that wait for the station: enough that the wire never does.
const AHEAD: usize = 2;

/// No file of the control is longer, bytes: what claims to be is not even begun.
pub(crate) const LARGEST: u32 = 1 << 24;

/// A file of a directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name.
    pub name: FileName,
    /// Its length, bytes.
    pub size: u32,
}

/// A file with all that is in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewFile {
    /// Where it stands at the control.
    pub place: Place,
    /// What it holds.
    pub bytes: Vec<u8>,
    /// It takes the place of one of its name.
    pub overwrite: bool,
}

/// How far a file has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Bytes that have arrived.
    pub done: usize,
    /// All of them.
    pub total: usize,
}

/// A file that comes.
#[derive(Clone, Debug)]
pub(crate) struct Incoming {
    pub put: Put,
    bytes: Vec<u8>,
}

impl Incoming {
    pub(crate) const fn new(put: Put) -> Self {
        Self {
            put,
            bytes: Vec::new(),
        }
    }

    /// Its next bytes.
    ///
    /// # Errors
    /// There are more than were announced.
    pub(crate) fn take(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let length = self.bytes.len() + bytes.len();
        if length > self.put.size as usize {
            return Err(Fault::Content);
        }
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }

    pub(crate) const fn progress(&self) -> Progress {
        Progress {
            done: self.bytes.len(),
            total: self.put.size as usize,
        }
    }

    /// All of it.
    ///
    /// # Errors
    /// There are fewer bytes than were announced.
    pub(crate) fn whole(self) -> Result<NewFile, Fault> {
        match self.bytes.len() == self.put.size as usize {
            true => Ok(NewFile {
                place: self.put.place,
                bytes: self.bytes,
                overwrite: self.put.overwrite,
            }),
            false => Err(Fault::Content),
        }
    }
}

/// A file that goes.
#[derive(Clone, Debug)]
pub(crate) struct Outgoing {
    file: NewFile,
    /// Its beginning has been taken.
    announced: bool,
    /// Bytes handed to the station.
    given: usize,
    /// Bytes that have arrived.
    arrived: usize,
    ended: bool,
}

impl Outgoing {
    /// Announces a file.
    pub(crate) fn begin(file: NewFile, station: &mut Station) -> Self {
        station.send(Body::Put(Put {
            place: file.place.clone(),
            size: u32::try_from(file.bytes.len()).unwrap_or(u32::MAX),
            overwrite: file.overwrite,
        }));
        Self {
            file,
            announced: false,
            given: 0,
            arrived: 0,
            ended: false,
        }
    }

    /// The same file, to be announced anew.
    pub(crate) fn into_file(self) -> NewFile {
        self.file
    }

    /// The other side has taken its beginning.
    pub(crate) const fn has_begun(&self) -> bool {
        self.announced
    }

    pub(crate) const fn file(&self) -> &NewFile {
        &self.file
    }

    pub(crate) const fn progress(&self) -> Progress {
        Progress {
            done: self.arrived,
            total: self.file.bytes.len(),
        }
    }

    /// Hands the station what it has room for.
    pub(crate) fn go_on(&mut self, station: &mut Station) {
        if !self.announced {
            return;
        }
        while self.given < self.file.bytes.len() && station.waiting() < AHEAD {
            let end = (self.given + BLOCK).min(self.file.bytes.len());
            station.send(Body::Data(self.file.bytes[self.given..end].to_vec()));
            self.given = end;
        }
        if self.given == self.file.bytes.len() && !self.ended {
            self.ended = true;
            station.send(Body::Eof);
        }
    }

    /// What the other side says to a frame of this file; how it has ended, when it has.
    pub(crate) fn answered(
        &mut self,
        body: &Body,
        result: Result<(), Fault>,
    ) -> Option<Result<(), Fault>> {
        if result.is_err() {
            return Some(result);
        }
        match body {
            Body::Put(_) => self.announced = true,
            Body::Data(bytes) => self.arrived += bytes.len(),
            Body::Eof => return Some(Ok(())),
            _ => {}
        }
        None
    }
}
