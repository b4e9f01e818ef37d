//! The quick fixes of warnings.

use gsk_core::command::SourcePosition;
use gsk_core::interpreter::{IgnoredWord, WordAdvice};
use gsk_core::preview::CautionKind;
use gsk_core::program::Program;
use gsk_messages::{Language, Message, say};

use super::QuickFix;
use super::line_edit::EditedLine;
use crate::text::{Position, TextChange};

/// Greatest number of lines above a warning that are searched for the word that causes it.
const MAX_LINES_ABOVE: u32 = 5000;

/// Returns the fix of a warning about a block of `program`; `None` if no edit is certainly
/// right.
///
/// No fix have: the end elsewhere than G50 sets (the G50 or the last move may be wrong), G28
/// without known machine zero (an option of the command), a contour without compensation (it
/// needs blocks for start-up and cancel), compensation with
/// nose radius 0 (the radius may be missing), an unreachable block (a jump may be missing).
pub(crate) fn caution_fix(
    kind: &CautionKind,
    source: SourcePosition,
    program: &Program,
    language: Language,
) -> Option<QuickFix> {
    let line = EditedLine::new(source.line, program.line(source.line));
    let (title, changes) = match kind {
        CautionKind::SlowFeed => feed_per_revolution(&line)?,
        CautionKind::SpindleStopped => (
            say::fix_insert_line("M03"),
            vec![line.insert_line_before("M03")],
        ),
        CautionKind::NoOffset => call_offset(program, source.line)?,
        CautionKind::IgnoredWord(word) => ignored_word(&line, word)?,
        CautionKind::AfterSemicolon => into_comment(&line, program.line(source.line))?,
        CautionKind::AfterEnd => delete_to_end(program, source.line),
        CautionKind::ColonName(number) => colon_name(&line, program.line(source.line), *number)?,
        CautionKind::ThreadRunIn { programmed, needed } => {
            longer_run_in(program, source.line, *programmed, *needed)?
        }
        CautionKind::ThreadSurfaceSpeed { rpm } => {
            let block = format!("G97 S{rpm}");
            let title = say::fix_insert_line(&block);
            (title, vec![line.insert_line_before(&block)])
        }
        CautionKind::ThreadSpeedChanged { now, .. } => delete_speed(program, source.line, *now)?,
        CautionKind::ShortDwell(ms) => {
            let (span, _) = line.word('P')?;
            let word = format!("P{}", u64::from(*ms) * 1000);
            (say::fix_replace(&word), vec![line.replace(span, word)])
        }
        CautionKind::EndElsewhere { .. }
        | CautionKind::MachineZero
        | CautionKind::NoseRadiusZero(_)
        | CautionKind::NoseUncompensated(_)
        | CautionKind::UnreachableBlock => return None,
    };
    Some(QuickFix::new(&title, changes, language))
}

/// Returns the fix of a word without effect in a block of a mill: deletes it.
pub(crate) fn mill_word_fix(
    letter: char,
    source: SourcePosition,
    program: &Program,
    language: Language,
) -> Vec<QuickFix> {
    let line = EditedLine::new(source.line, program.line(source.line));
    let fix = line.word(letter).map(|(span, word)| {
        let title = say::fix_delete_word(format!("{letter}{}", word.value));
        QuickFix::new(&title, vec![line.delete(span)], language)
    });
    fix.into_iter().collect()
}

/// The title of a fix and its changes.
type Fix = (Message, Vec<TextChange>);

/// Makes the feed of a block one per revolution.
fn feed_per_revolution(line: &EditedLine<'_>) -> Option<Fix> {
    let code = line
        .words()
        .find(|(_, word)| word.address == 'G' && word.number() == Some(98));
    let change = match code {
        Some((span, _)) => line.replace(span, "G99"),
        None if line.is_one_block() => line.insert_word("G99"),
        None => return None,
    };
    Some((say::fix_feed_per_revolution(), vec![change]))
}

/// Searches upwards from `line` (from 1) for a line that `find` accepts.
fn search_up<'a, T>(
    program: &'a Program,
    line: u32,
    find: impl Fn(&EditedLine<'a>) -> Option<T>,
) -> Option<T> {
    let least = line.saturating_sub(MAX_LINES_ABOVE).max(1);
    (least..=line)
        .rev()
        .find_map(|at| find(&EditedLine::new(at, program.line(at))))
}

/// Adds the offset of the same number to the last T word, whose offset is 00.
fn call_offset(program: &Program, line: u32) -> Option<Fix> {
    let change = search_up(program, line, |above| {
        let (span, word) = above.word('T')?;
        let tool = word.value.strip_suffix("00");
        let tool = tool.and_then(|digits| digits.parse::<u8>().ok());
        let replacement = tool
            .filter(|tool| (1..=99).contains(tool))
            .map(|tool| format!("T{tool:02}{tool:02}"));
        // The last T word decides, even if it cannot be corrected.
        Some(replacement.map(|text| (above.replace(span, text.clone()), text)))
    })?;
    let (change, word) = change?;
    Some((say::fix_replace(word), vec![change]))
}

/// Corrects or deletes a word without effect.
fn ignored_word(line: &EditedLine<'_>, word: &IgnoredWord) -> Option<Fix> {
    let ignored = line.span_at_column(word.columns.0)?;
    Some(match &word.advice {
        WordAdvice::CallCount(call) => {
            let (program, _) = line.word('P')?;
            let changes = vec![line.replace(program, call.as_str()), line.delete(ignored)];
            (say::fix_replace(call), changes)
        }
        WordAdvice::TaperIsR(taper) => (
            say::fix_replace(taper),
            vec![line.replace(ignored, taper.as_str())],
        ),
        _ => (say::fix_delete_word(&word.text), vec![line.delete(ignored)]),
    })
}

/// Makes the text after the `;` of a line a comment; `None` if it contains parentheses.
fn into_comment(line: &EditedLine<'_>, text: &str) -> Option<Fix> {
    let comment = text.trim().trim_start_matches(';').trim();
    if comment.contains(['(', ')', '（', '）']) {
        return None;
    }
    let comment = format!("({comment})");
    Some((say::fix_make_comment(), vec![line.replace_all(comment)]))
}

/// Deletes the lines from `line` (from 1) to the end of the text.
fn delete_to_end(program: &Program, line: u32) -> Fix {
    let change = TextChange {
        from: Position {
            line: line.saturating_sub(1),
            byte: 0,
        },
        to: Position {
            line: program.line_count(),
            byte: 0,
        },
        text: String::new(),
    };
    (say::fix_delete_after_end(), vec![change])
}

/// Replaces the `:` before the number of a program by O.
fn colon_name(line: &EditedLine<'_>, text: &str, number: u16) -> Option<Fix> {
    let at = text.find([':', '：'])?;
    let column = text.get(..at)?.chars().count() as u32 + 1;
    let colon = line.span_at_column(column)?;
    let title = say::fix_replace(format!("O{number:04}"));
    Some((title, vec![line.replace(colon, "O")]))
}

/// Moves the start of a thread away from the part: replaces the Z word that set it.
fn longer_run_in(program: &Program, line: u32, programmed: f64, needed: f64) -> Option<Fix> {
    // The start is in the block before the thread, or above it.
    let start = search_up(program, line.saturating_sub(1), |above| {
        let (span, word) = above.word('Z')?;
        let is_start = word
            .value
            .parse()
            .is_ok_and(|z: f64| (z - programmed).abs() < 1e-6);
        Some(is_start.then(|| {
            let tenths = (needed * 10.0).ceil();
            let text = format!("Z{}", tenths / 10.0);
            (above.replace(span, text.clone()), text)
        }))
    })?;
    let (change, word) = start?;
    Some((say::fix_replace(word), vec![change]))
}

/// Deletes the S word with the value `now` that changed the speed of a thread.
fn delete_speed(program: &Program, line: u32, now: f64) -> Option<Fix> {
    let speed = search_up(program, line, |above| {
        let (span, word) = above.word('S')?;
        let is_it = word.value.parse().is_ok_and(|speed: f64| speed == now);
        Some(is_it.then(|| (above.delete(span), word.value.into_owned())))
    })?;
    let (change, value) = speed?;
    Some((say::fix_delete_word(format!("S{value}")), vec![change]))
}
