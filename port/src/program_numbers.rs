//! Program and sequence numbers beyond the range of this control, and the parts of a program
//! that other controls call by their sequence number.

use std::collections::{BTreeMap, BTreeSet};

use crate::block::ForeignBlock;
use crate::dialect::{CodeSet, ForeignDialect};
use crate::number::Number;
use crate::source::SourcePart;

/// Greatest program number and greatest sequence number of this control.
const MAX_NUMBER: i64 = 9999;
/// First program number for the subprograms that the porter makes from local ones.
const FIRST_LOCAL: i64 = 9001;

/// Numbers of the whole foreign text, collected before its blocks are ported.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProgramNumbers {
    /// New sequence number for each foreign one beyond 9999 to which a word refers.
    sequences: BTreeMap<i64, i64>,
    /// New program number for each foreign one beyond 9999.
    programs: BTreeMap<i64, i64>,
    /// Program number of each local subprogram, by the foreign sequence number of its first block.
    pub locals: BTreeMap<i64, i64>,
    /// Sequence numbers to which words of the program refer.
    pub named: BTreeSet<i64>,
    /// Whether any block has M06 (tool change).
    pub has_tool_change: bool,
}

impl ProgramNumbers {
    /// Collects the numbers of all blocks of a text.
    pub fn collect(parts: &[SourcePart]) -> Self {
        let blocks = || parts.iter().map(|part| &part.block);
        let mut used: BTreeSet<i64> = BTreeSet::new();
        let mut programs: BTreeSet<i64> = BTreeSet::new();
        let mut named: BTreeSet<i64> = BTreeSet::new();
        let mut called: BTreeSet<i64> = BTreeSet::new();
        let mut numbers = Self::default();
        for block in blocks() {
            used.extend(whole(block, b'N'));
            programs.extend(whole(block, b'O'));
            let calls = |code| has_m(block, code);
            if calls(97) {
                called.extend(whole(block, b'P'));
            }
            if calls(99) || block.g_codes().any(|code| (700..=730).contains(&code)) {
                named.extend(whole(block, b'P'));
                named.extend(whole(block, b'Q'));
            }
            numbers.has_tool_change |= calls(6);
        }
        let beyond = |number: &&i64| **number > MAX_NUMBER;
        let mut free = (1..=MAX_NUMBER).filter(|number| !used.contains(number));
        for number in named.iter().filter(beyond) {
            if let Some(new) = free.next() {
                numbers.sequences.insert(*number, new);
            }
        }
        for number in programs.iter().filter(beyond) {
            let short = number % (MAX_NUMBER + 1);
            if !programs.contains(&short) {
                numbers.programs.insert(*number, short);
            }
        }
        numbers.named = named;
        let mut free = (FIRST_LOCAL..=MAX_NUMBER).filter(|number| !programs.contains(number));
        for number in called {
            if starts_after_end(parts, number)
                && let Some(new) = free.next()
            {
                numbers.locals.insert(number, new);
            }
        }
        numbers
    }

    /// Returns the sequence number on this control; `None` if it is beyond 9999 and no word refers
    /// to it, so that it can be left out.
    pub fn sequence(&self, number: i64) -> Option<i64> {
        match number > MAX_NUMBER {
            true => self.sequences.get(&number).copied(),
            false => Some(number),
        }
    }

    /// Returns the program number on this control; `None` if it is beyond 9999 and has no new
    /// number.
    pub fn program(&self, number: i64) -> Option<i64> {
        match number > MAX_NUMBER {
            true => self.programs.get(&number).copied(),
            false => Some(number),
        }
    }
}

/// Finds the code set of a text: that of the dialect; for Fanuc, system B if a code of the text
/// exists in B only or can only be meant as in B, else A.
pub(crate) fn find_code_set(dialect: ForeignDialect, parts: &[SourcePart]) -> CodeSet {
    match dialect {
        ForeignDialect::Haas => CodeSet::Haas,
        ForeignDialect::Mach3 => CodeSet::Mach3,
        ForeignDialect::LinuxCnc => CodeSet::LinuxCnc,
        ForeignDialect::Fanuc0t | ForeignDialect::Fanuc10t | ForeignDialect::Fusion => {
            let mut has_lead = false;
            let mut shows_b = |block: &ForeignBlock| {
                let only_b = |code| matches!(code, 330 | 770 | 780 | 790 | 910 | 950);
                let is_thread = |code| matches!(code, 320 | 330 | 340 | 760 | 920);
                has_lead |= block.has_any(b"FE") && block.g_codes().any(is_thread);
                // In system A G92 is a thread, which needs a lead, and G94 a facing cycle.
                block.g_codes().any(only_b)
                    || (block.has_g(920)
                        && (block.has(b'S') || (!has_lead && block.has_any(b"XZ"))))
                    || (block.has_g(940) && !block.has_any(b"XUZW"))
            };
            match parts.iter().any(|part| shows_b(&part.block)) {
                true => CodeSet::FanucB,
                false => CodeSet::FanucA,
            }
        }
    }
}

/// Whether a block has the M code `code`, in tenths: M03 is 30.
pub(crate) fn has_m(block: &ForeignBlock, code: i64) -> bool {
    let mut words = block.words().filter(|word| word.letter == b'M');
    words.any(|word| word.number.and_then(Number::whole) == Some(code))
}

/// Returns the value of the first word with this letter if it is a whole number; else `None`.
pub(crate) fn whole(block: &ForeignBlock, letter: u8) -> Option<i64> {
    block.number(letter)?.whole()
}

/// Whether only calls reach the block with a sequence number: the block before it ends a
/// program.
fn starts_after_end(parts: &[SourcePart], number: i64) -> bool {
    let is_start = |part: &SourcePart| whole(&part.block, b'N') == Some(number);
    let Some(at) = parts.iter().position(is_start) else {
        return false;
    };
    let before = parts[..at].iter().rev().find(|it| it.block.has_content());
    before.is_some_and(|part| [2, 30, 99].iter().any(|code| has_m(&part.block, *code)))
}
