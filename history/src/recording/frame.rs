//! Frames with a check that continues from frame to frame.

use super::RecordingError;

/// First bytes of a recording.
pub(super) const MAGIC: &[u8] = b"GSK980TD recording\n";
/// Length and check before the content of a frame, bytes.
const HEAD_BYTES: usize = 8;

/// Appends frames to the bytes of a recording.
#[derive(Debug, Default)]
pub(super) struct FrameEncoder {
    check: u32,
}

impl FrameEncoder {
    /// Appends a frame whose content begins with `kind`.
    pub(super) fn append(&mut self, kind: u8, content: &[u8], out: &mut Vec<u8>) {
        // No state or text comes near 4 GB.
        let length = (content.len() as u32).saturating_add(1).to_le_bytes();
        self.check = continue_check(self.check, &[&length, &[kind], content]);
        out.extend_from_slice(&length);
        out.extend_from_slice(&self.check.to_le_bytes());
        out.push(kind);
        out.extend_from_slice(content);
    }
}

/// Reads frames from the bytes of a recording.
#[derive(Debug)]
pub(super) struct FrameReader<'a> {
    bytes: &'a [u8],
    offset: usize,
    check: u32,
}

impl<'a> FrameReader<'a> {
    /// Starts after the first bytes; `None` if they are not those of a recording.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        bytes.starts_with(MAGIC).then_some(Self {
            bytes,
            offset: MAGIC.len(),
            check: 0,
        })
    }

    /// Returns the offset of the next frame.
    pub(super) const fn offset(&self) -> usize {
        self.offset
    }

    /// Returns the content of the next frame; `None` at the end.
    pub(super) fn next_frame(&mut self) -> Result<Option<&'a [u8]>, RecordingError> {
        let rest = self.bytes.get(self.offset..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let incomplete = RecordingError::Incomplete(self.offset);
        let word = |at: usize| -> Option<[u8; 4]> { rest.get(at..at + 4)?.try_into().ok() };
        let (Some(length), Some(check)) = (word(0), word(4)) else {
            return Err(incomplete);
        };
        let end = HEAD_BYTES.saturating_add(u32::from_le_bytes(length) as usize);
        let Some(content) = rest.get(HEAD_BYTES..end) else {
            return Err(incomplete);
        };
        let found = continue_check(self.check, &[&length, content]);
        if found != u32::from_le_bytes(check) {
            return Err(RecordingError::CheckFailed(self.offset));
        }
        self.check = found;
        self.offset += end;
        Ok(Some(content))
    }
}

fn continue_check(check: u32, parts: &[&[u8]]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(check);
    for part in parts {
        hasher.update(part);
    }
    hasher.finalize()
}
