//! The file that a learner hands in: task, recording and report in one, sealed.
//!
//! ```text
//! result = magic, head length u32, head (JSON), recording (deflated), seal (text)
//! ```
//!
//! The seal covers all bytes before it.

use gsk_messages::{Message, say};
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde::{Deserialize, Serialize};

use crate::exam::ExamNote;
use crate::report::ExerciseReport;
use crate::seal::{KeyNumber, SealKey, SealPublicKey};

/// File extension of a result.
pub const RESULT_EXTENSION: &str = "gskresult";
/// First bytes of a result file, by which it is recognized.
const MAGIC: &[u8] = b"GSK980TD exercise result 1\n";
/// First bytes of the seal in a result file.
const SEAL_START: &[u8] = b"untrusted comment: ";
/// Greatest size of a recording in a result file, bytes.
const MAX_RECORDING_BYTES: usize = 256 * 1024 * 1024;
/// Greatest size of the head of a result file, bytes.
const MAX_HEAD_BYTES: usize = 1024 * 1024;
/// Compression level of the recording, 0 (none) to 10 (smallest).
const PACK_LEVEL: u8 = 6;

/// The head of a result file: learner, claimed report and public key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultHead {
    /// Version of the program that created the result.
    pub program: String,
    /// Name of the learner.
    pub learner: String,
    /// Numbers of the hints that the learner read, from 1.
    pub hints: Vec<u32>,
    /// The report that the program computed when it created the result.
    pub report: ExerciseReport,
    /// Pauses, interruptions and wrong PINs of the exam; `None` if the result is not from an exam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exam: Option<ExamNote>,
    /// The public key that verifies the seal, a line of base64.
    key: String,
    /// Length of the compressed recording, bytes.
    recording_bytes: usize,
}

/// A result file that was read. Its report is a claim until the recording is replayed.
#[derive(Clone, Debug, PartialEq)]
pub struct ExerciseResult {
    /// Learner, claimed report and public key.
    pub head: ResultHead,
    /// The recording of the solution, decompressed.
    pub recording: Vec<u8>,
    /// Number of the key that sealed the result.
    pub key: KeyNumber,
    /// Whether the seal is valid for the bytes of the file.
    pub is_sealed: bool,
}

/// Data for a result file besides the recording and its report: learner, program version, hints and
/// exam.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultAuthor {
    /// Version of the program that creates the result.
    pub program: String,
    /// Name of the learner.
    pub learner: String,
    /// Numbers of the hints that the learner read.
    pub hints: Vec<u32>,
    /// Pauses, interruptions and wrong PINs of the exam; `None` outside exams.
    pub exam: Option<ExamNote>,
}

/// Creates the bytes of a result file.
///
/// # Errors
///
/// The report cannot be written as JSON.
pub fn write_result(
    author: ResultAuthor,
    report: ExerciseReport,
    recording: &[u8],
    key: &SealKey,
) -> Result<Vec<u8>, Message> {
    let packed = compress_to_vec(recording, PACK_LEVEL);
    let task = report.task.clone();
    let head = ResultHead {
        program: author.program,
        learner: author.learner,
        hints: author.hints,
        report,
        exam: author.exam,
        key: key.public_key().to_line(),
        recording_bytes: packed.len(),
    };
    let head = serde_json::to_vec(&head).map_err(say::as_written)?;
    let mut bytes = MAGIC.to_vec();
    // A head has a few kilobytes.
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend(head);
    bytes.extend(packed);
    let seal = key.seal(&bytes, &task);
    bytes.extend(seal.as_bytes());
    Ok(bytes)
}

/// Reads a result file.
///
/// # Errors
///
/// The bytes are not a result file, or are damaged.
pub fn read_result(bytes: &[u8]) -> Result<ExerciseResult, Message> {
    let rest = bytes
        .strip_prefix(MAGIC)
        .ok_or_else(say::exercise_not_result)?;
    let damaged = |field: &str| say::exercise_result_damaged(field);
    let (length, rest) = rest
        .split_first_chunk::<4>()
        .ok_or_else(|| damaged("head"))?;
    let length = u32::from_le_bytes(*length) as usize;
    let (head, rest) = Some(length)
        .filter(|length| *length <= MAX_HEAD_BYTES)
        .and_then(|length| rest.split_at_checked(length))
        .ok_or_else(|| damaged("head"))?;
    let head: ResultHead = serde_json::from_slice(head).map_err(|_| damaged("head"))?;
    let (packed, seal) = rest
        .split_at_checked(head.recording_bytes)
        .filter(|(_, seal)| seal.starts_with(SEAL_START))
        .ok_or_else(|| damaged("recording"))?;
    let recording = decompress_to_vec_with_limit(packed, MAX_RECORDING_BYTES)
        .map_err(|_| damaged("recording"))?;
    let public = SealPublicKey::from_line(&head.key).ok_or_else(|| damaged("key"))?;
    let covered = bytes.get(..bytes.len() - seal.len()).unwrap_or_default();
    let is_sealed = core::str::from_utf8(seal)
        .is_ok_and(|seal| public.verifies(covered, &head.report.task, seal));
    Ok(ExerciseResult {
        head,
        recording,
        key: public.number(),
        is_sealed,
    })
}
