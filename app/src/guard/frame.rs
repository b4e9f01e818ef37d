//! What the program and the process that holds its port say to each other: a letter,
//! a length of two bytes, so many bytes.

/// The longest content.
pub const MOST: usize = 4096;
const HEAD: usize = 3;

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Bytes from or for the board.
    Data,
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

const LETTERS: [(Kind, u8); 6] = [
    (Kind::Data, b'D'),
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
    fn what_is_no_frame_is_strange() {
        for bytes in [&b"ok\n"[..], b"D\xFF\xFF"] {
            let mut reader = Reader::default();
            reader.give(bytes);
            assert_eq!(reader.take(), Err(Strange));
        }
    }
}
