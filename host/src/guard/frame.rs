//! Encodes the frames between the program and the process that holds its port: a letter, a
//! length of two bytes, the content.

/// Maximum length of the content of a frame, bytes.
pub const MAX_CONTENT: usize = 4096;
const HEADER_BYTES: usize = 3;

/// The kind of a frame between program and holder process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// From the holder process: bytes received from the board.
    Data,
    /// To the holder: bytes for the board, after the time at which they were sent (see
    /// [`append_dated`]).
    Dated,
    /// To the holder: the longest silence of the program, and the greatest age of bytes for the
    /// board: see [`Lease`].
    Lease,
    /// From the holder: the program has not renewed its lease, or its bytes were too old.
    /// The holder has stopped the board; the content is the board's answer.
    Stopped,
    /// To the holder: the bytes that stop the board from now on; empty: do not stop it.
    Stop,
    /// To the holder: the program closes the port after its last bytes.
    End,
    /// From the holder process: the port is open.
    Open,
    /// From the holder: the port cannot be opened; the content is a message as JSON.
    Refused,
    /// From the holder: the port failed with this error number of the system, four bytes.
    Gone,
}

const LETTERS: [(FrameKind, u8); 9] = [
    (FrameKind::Data, b'D'),
    (FrameKind::Dated, b'T'),
    (FrameKind::Lease, b'L'),
    (FrameKind::Stopped, b'X'),
    (FrameKind::Stop, b'S'),
    (FrameKind::End, b'E'),
    (FrameKind::Open, b'O'),
    (FrameKind::Refused, b'R'),
    (FrameKind::Gone, b'G'),
];

/// The error for a byte stream that contains no frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidFrame;

/// Appends a frame to `out`; cuts content above [`MAX_CONTENT`].
pub fn append_frame(out: &mut Vec<u8>, kind: FrameKind, content: &[u8]) {
    let content = &content[..content.len().min(MAX_CONTENT)];
    let letter = LETTERS.iter().find(|(one, _)| *one == kind);
    out.push(letter.map_or(0, |(_, letter)| *letter));
    out.extend_from_slice(&(content.len() as u16).to_le_bytes());
    out.extend_from_slice(content);
}

/// Length of the encoded time in the content of a [`FrameKind::Dated`], bytes.
const TIME_BYTES: usize = 8;
/// Maximum number of bytes for the board in one [`FrameKind::Dated`].
pub const MAX_DATED: usize = MAX_CONTENT - TIME_BYTES;

/// Appends a [`FrameKind::Dated`]: bytes for the board, sent at time `at` of the clock that
/// both processes read, ms; cuts bytes above [`MAX_DATED`].
pub fn append_dated(out: &mut Vec<u8>, at: u64, bytes: &[u8]) {
    let bytes = &bytes[..bytes.len().min(MAX_DATED)];
    append_frame(out, FrameKind::Dated, &[&at.to_le_bytes(), bytes].concat());
}

/// Splits the content of a [`FrameKind::Dated`] into its time, ms, and the bytes for the
/// board; `None` if it is too short.
pub fn split_dated(content: &[u8]) -> Option<(u64, &[u8])> {
    let (at, bytes) = content.split_first_chunk::<TIME_BYTES>()?;
    Some((u64::from_le_bytes(*at), bytes))
}

/// The times for which the holder waits for the program before it stops the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lease {
    /// The holder stops the board when the program was silent for this time, ms; 0: never.
    pub silent_ms: u32,
    /// The holder drops bytes for the board that are older than this, ms, because the
    /// board has run out of motion meanwhile; 0: it writes all bytes.
    pub stale_ms: u32,
}

impl Lease {
    /// Encodes the lease as the content of a [`FrameKind::Lease`].
    pub fn to_bytes(self) -> [u8; 8] {
        let [silent, stale] = [self.silent_ms, self.stale_ms].map(u32::to_le_bytes);
        let mut bytes = [0; 8];
        bytes[..4].copy_from_slice(&silent);
        bytes[4..].copy_from_slice(&stale);
        bytes
    }

    /// Decodes the content of a [`FrameKind::Lease`]; `None` if its length is wrong.
    pub fn from_bytes(content: &[u8]) -> Option<Self> {
        let (silent, stale) = content.split_first_chunk::<4>()?;
        Some(Self {
            silent_ms: u32::from_le_bytes(*silent),
            stale_ms: u32::from_le_bytes(stale.try_into().ok()?),
        })
    }
}

/// Splits a stream of bytes from the other process into frames.
#[derive(Debug, Default)]
pub struct GuardFrameReader(Vec<u8>);

impl GuardFrameReader {
    /// Appends bytes that were received from the other process.
    pub fn push_bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Takes the next complete frame; `None` if its bytes have not all arrived.
    ///
    /// # Errors
    /// The bytes are no frame.
    pub fn take_frame(&mut self) -> Result<Option<(FrameKind, Vec<u8>)>, InvalidFrame> {
        let [letter, low, high, ..] = self.0[..] else {
            return Ok(None);
        };
        let known = LETTERS.iter().find(|(_, one)| *one == letter);
        let (kind, _) = known.ok_or(InvalidFrame)?;
        let end = HEADER_BYTES + usize::from(u16::from_le_bytes([low, high]));
        if end > HEADER_BYTES + MAX_CONTENT {
            return Err(InvalidFrame);
        }
        if self.0.len() < end {
            return Ok(None);
        }
        let content = self.0[HEADER_BYTES..end].to_vec();
        self.0.drain(..end);
        Ok(Some((*kind, content)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_through_in_any_pieces() {
        let frames = [
            (FrameKind::Open, vec![]),
            (FrameKind::Data, vec![7; MAX_CONTENT]),
            (FrameKind::Stop, vec![0x18]),
            (FrameKind::Gone, vec![5, 0, 0, 0]),
            (FrameKind::End, vec![]),
        ];
        let mut stream = Vec::new();
        for (kind, content) in &frames {
            append_frame(&mut stream, *kind, content);
        }
        for piece in [1, 2, 3, 1000, stream.len()] {
            let mut reader = GuardFrameReader::default();
            let mut found = Vec::new();
            for bytes in stream.chunks(piece) {
                reader.push_bytes(bytes);
                while let Some(frame) = reader.take_frame().unwrap() {
                    found.push(frame);
                }
            }
            assert_eq!(found, frames, "{piece}");
        }
    }

    #[test]
    fn dates_and_leases_come_through() {
        let mut stream = Vec::new();
        append_dated(&mut stream, 1 << 40, &[9; MAX_CONTENT]);
        let mut reader = GuardFrameReader::default();
        reader.push_bytes(&stream);
        let (kind, content) = reader.take_frame().unwrap().unwrap();
        assert_eq!(kind, FrameKind::Dated);
        assert_eq!(split_dated(&content), Some((1 << 40, &[9; MAX_DATED][..])));
        assert_eq!(split_dated(&[1]), None);
        let lease = Lease {
            silent_ms: 1000,
            stale_ms: 70_000,
        };
        assert_eq!(Lease::from_bytes(&lease.to_bytes()), Some(lease));
        assert_eq!(Lease::from_bytes(&[0; 7]), None);
    }

    #[test]
    fn bytes_without_frames_are_invalid() {
        for bytes in [&b"ok\n"[..], b"D\xFF\xFF"] {
            let mut reader = GuardFrameReader::default();
            reader.push_bytes(bytes);
            assert_eq!(reader.take_frame(), Err(InvalidFrame));
        }
    }
}
