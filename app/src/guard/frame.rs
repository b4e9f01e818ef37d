//! What the program and the process that holds its port say to each other: a letter,
//! a length of two bytes, so many bytes.

/// The longest content.
pub const MOST: usize = 4096;
const HEAD: usize = 3;

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the holder: bytes of the board.
    Data,
    /// To the holder: bytes for the board, behind the moment they were handed over at:
    /// see [`put_dated`].
    Dated,
    /// To the holder: how long the program may be silent, and how old bytes for the board
    /// may be: see [`Lease`].
    Lease,
    /// From the holder: the program did not renew its lease, or its bytes were too old; it
    /// has stopped the board, which answered this.
    Stopped,
    /// To the holder: what stops the board from now on; nothing: it is not to be stopped.
    Stop,
    /// To the holder: the program closes the port; all is said.
    End,
    /// From the holder: the port is open.
    Open,
    /// From the holder: it is not, and why: a message as JSON.
    Refused,
    /// From the holder: the port failed with this error of the system, four bytes.
    Gone,
}

const LETTERS: [(Kind, u8); 9] = [
    (Kind::Data, b'D'),
    (Kind::Dated, b'T'),
    (Kind::Lease, b'L'),
    (Kind::Stopped, b'X'),
    (Kind::Stop, b'S'),
    (Kind::End, b'E'),
    (Kind::Open, b'O'),
    (Kind::Refused, b'R'),
    (Kind::Gone, b'G'),
];

/// A stream that is none of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strange;

/// Appends a frame. What is longer than [`MOST`] is cut off.
pub fn put(out: &mut Vec<u8>, kind: Kind, content: &[u8]) {
    let content = &content[..content.len().min(MOST)];
    let letter = LETTERS.iter().find(|(one, _)| *one == kind);
    out.push(letter.map_or(0, |(_, letter)| *letter));
    out.extend_from_slice(&(content.len() as u16).to_le_bytes());
    out.extend_from_slice(content);
}

/// Bytes of a date.
const DATE: usize = 8;
/// The longest bytes of a [`Kind::Dated`].
pub const MOST_DATED: usize = MOST - DATE;

/// Appends a [`Kind::Dated`]: bytes for the board, handed over at this moment of the clock
/// that both processes read, ms.
pub fn put_dated(out: &mut Vec<u8>, at: u64, bytes: &[u8]) {
    let bytes = &bytes[..bytes.len().min(MOST_DATED)];
    put(out, Kind::Dated, &[&at.to_le_bytes(), bytes].concat());
}

/// Moment and bytes of a [`Kind::Dated`].
pub fn dated(content: &[u8]) -> Option<(u64, &[u8])> {
    let (at, bytes) = content.split_first_chunk::<DATE>()?;
    Some((u64::from_le_bytes(*at), bytes))
}

/// How long the holder waits for the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lease {
    /// The board is stopped when the program was silent for so long, ms; 0: it need not
    /// speak.
    pub silent_ms: u32,
    /// Bytes for the board that are older than this are not written: the board has run dry
    /// meanwhile, ms; 0: they are written whenever they come.
    pub stale_ms: u32,
}

impl Lease {
    /// As the content of a [`Kind::Lease`].
    pub fn to_bytes(self) -> [u8; 8] {
        let [silent, stale] = [self.silent_ms, self.stale_ms].map(u32::to_le_bytes);
        let mut bytes = [0; 8];
        bytes[..4].copy_from_slice(&silent);
        bytes[4..].copy_from_slice(&stale);
        bytes
    }

    /// Of the content of a [`Kind::Lease`].
    pub fn from_bytes(content: &[u8]) -> Option<Self> {
        let (silent, stale) = content.split_first_chunk::<4>()?;
        Some(Self {
            silent_ms: u32::from_le_bytes(*silent),
            stale_ms: u32::from_le_bytes(stale.try_into().ok()?),
        })
    }
}

/// Finds the frames in a stream of bytes.
#[derive(Debug, Default)]
pub struct Reader(Vec<u8>);

impl Reader {
    /// Bytes came.
    pub fn give(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// The next whole frame.
    ///
    /// # Errors
    /// Nobody speaks so.
    pub fn take(&mut self) -> Result<Option<(Kind, Vec<u8>)>, Strange> {
        let [letter, low, high, ..] = self.0[..] else {
            return Ok(None);
        };
        let known = LETTERS.iter().find(|(_, one)| *one == letter);
        let (kind, _) = known.ok_or(Strange)?;
        let end = HEAD + usize::from(u16::from_le_bytes([low, high]));
        if end > HEAD + MOST {
            return Err(Strange);
        }
        if self.0.len() < end {
            return Ok(None);
        }
        let content = self.0[HEAD..end].to_vec();
        self.0.drain(..end);
        Ok(Some((*kind, content)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_through_in_any_pieces() {
        let said = [
            (Kind::Open, vec![]),
            (Kind::Data, vec![7; MOST]),
            (Kind::Stop, vec![0x18]),
            (Kind::Gone, vec![5, 0, 0, 0]),
            (Kind::End, vec![]),
        ];
        let mut stream = Vec::new();
        for (kind, content) in &said {
            put(&mut stream, *kind, content);
        }
        for piece in [1, 2, 3, 1000, stream.len()] {
            let mut reader = Reader::default();
            let mut found = Vec::new();
            for bytes in stream.chunks(piece) {
                reader.give(bytes);
                while let Some(frame) = reader.take().unwrap() {
                    found.push(frame);
                }
            }
            assert_eq!(found, said, "{piece}");
        }
    }

    #[test]
    fn dates_and_leases_come_through() {
        let mut stream = Vec::new();
        put_dated(&mut stream, 1 << 40, &[9; MOST]);
        let mut reader = Reader::default();
        reader.give(&stream);
        let (kind, content) = reader.take().unwrap().unwrap();
        assert_eq!(kind, Kind::Dated);
        assert_eq!(dated(&content), Some((1 << 40, &[9; MOST_DATED][..])));
        assert_eq!(dated(&[1]), None);
        let lease = Lease {
            silent_ms: 1000,
            stale_ms: 70_000,
        };
        assert_eq!(Lease::from_bytes(&lease.to_bytes()), Some(lease));
        assert_eq!(Lease::from_bytes(&[0; 7]), None);
    }

    #[test]
    fn what_is_no_frame_is_strange() {
        for bytes in [&b"ok\n"[..], b"D\xFF\xFF"] {
            let mut reader = Reader::default();
            reader.give(bytes);
            assert_eq!(reader.take(), Err(Strange));
        }
    }
}
