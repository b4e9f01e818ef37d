//! Ports a text block by block.

use gsk_messages::{Message, say};

use crate::block::{ForeignBlock, LinePiece};
use crate::dialect::{ForeignDialect, PlainNumbers, PortFinding, PortOptions};
use crate::number::write_number;
use crate::o_words::replace_o_words;
use crate::program_numbers::{ProgramNumbers, find_code_set, whole};
use crate::source::{SourcePart, read_source, without_brackets};
use crate::state::{ActiveCode, ForeignState};
use crate::table::{CodeRule, ForeignCodeRow, find_row};

/// A foreign program converted to this control, with the differences between both.
#[derive(Clone, Debug, PartialEq)]
pub struct PortedProgram {
    /// The text of the program for this control.
    pub text: String,
    /// The foreign line of each line of `text`, from 1.
    pub source_lines: Vec<u32>,
    /// Changes that the reader should know and blocks without an equivalent, in the order of
    /// the text.
    pub findings: Vec<PortFinding>,
}

impl PortedProgram {
    /// Whether every block has an equivalent.
    pub fn is_complete(&self) -> bool {
        !self.findings.iter().any(|finding| finding.is_refused)
    }
}

/// The reason why a foreign block has no equivalent, with the word that causes it.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// The foreign word without an equivalent.
    pub word: String,
    /// The message with the reason for the refusal.
    pub note: Message,
}

impl Refusal {
    /// Creates the refusal of a word, with its reason.
    pub fn new(word: impl Into<String>, note: Message) -> Self {
        Self {
            word: word.into(),
            note,
        }
    }
}

/// Ports a foreign program. Words of a block without an equivalent stay in a comment after a
/// command that stops the program with alarm 500.
pub fn port_program(text: &str, dialect: ForeignDialect, options: PortOptions) -> PortedProgram {
    let mut parts = read_source(text, dialect.has_semicolon_comments());
    let replaced = match dialect {
        ForeignDialect::LinuxCnc => replace_o_words(&mut parts),
        _ => Vec::new(),
    };
    let plain = options
        .plain_numbers
        .unwrap_or(match dialect.counts_increments() {
            true => PlainNumbers::Increments,
            false => PlainNumbers::AsWritten,
        });
    let set = find_code_set(dialect, &parts);
    let mut state = ForeignState::new(set, plain, options.starts_in_inches);
    state.is_radius = dialect == ForeignDialect::LinuxCnc;
    let mut porter = Porter {
        numbers: ProgramNumbers::collect(&parts),
        state,
        findings: Vec::new(),
        parts: &parts,
    };
    for (line, word) in replaced {
        porter.note(line, word, say::ported_note_o_word());
    }
    let mut text = String::with_capacity(text.len() * 2);
    let mut source_lines = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let begin = text.len();
        let block = porter.port_block(index);
        let end = part.line_end;
        for line in &block.before {
            text.push_str(line);
            text.push_str(end);
        }
        text.push_str(&block.text());
        let separator = &part.separator;
        let (closing, line_break) = match block.after.is_empty() {
            true => (separator.as_str(), ""),
            false => {
                let closing = separator.trim_end_matches(['\n', '\r']);
                (closing, &separator[closing.len()..])
            }
        };
        text.push_str(closing);
        for line in &block.after {
            text.push_str(end);
            text.push_str(line);
        }
        text.push_str(line_break);
        let ended = text[begin..].matches('\n').count();
        source_lines.extend(core::iter::repeat_n(part.block.line, ended));
    }
    if let Some(last) = parts.last().filter(|_| !text.ends_with('\n')) {
        source_lines.push(last.block.line);
    }
    PortedProgram {
        text,
        source_lines,
        findings: porter.findings,
    }
}

/// State of the port at one block of the foreign program.
pub(crate) struct Porter<'a> {
    pub parts: &'a [SourcePart],
    pub numbers: ProgramNumbers,
    pub state: ForeignState,
    pub findings: Vec<PortFinding>,
}

impl Porter<'_> {
    fn port_block(&mut self, index: usize) -> ForeignBlock {
        let source = &self.parts[index].block;
        let mut block = source.clone();
        if !block.has_content() && !block.has(b'N') {
            return block;
        }
        match self.convert(&mut block, index) {
            Ok(()) => block,
            Err(refusal) => {
                for axis in &mut self.state.axes {
                    axis.forget();
                }
                self.findings.push(PortFinding {
                    line: source.line,
                    word: refusal.word,
                    is_refused: true,
                    note: refusal.note,
                });
                let text = without_brackets(source.text().trim());
                ForeignBlock {
                    line: source.line,
                    pieces: vec![LinePiece::Text(format!("G65 H99 P0 ({text})"))],
                    ..ForeignBlock::default()
                }
            }
        }
    }

    /// Reports how a word has changed, but the same word with the same note once only.
    pub fn note(&mut self, line: u32, word: impl Into<String>, note: Message) {
        let finding = PortFinding {
            line,
            word: word.into(),
            is_refused: false,
            note,
        };
        let is_known = |it: &PortFinding| !it.is_refused && it.note == finding.note;
        if !self.findings.iter().any(is_known) {
            self.findings.push(finding);
        }
    }

    fn convert(&mut self, block: &mut ForeignBlock, index: usize) -> Result<(), Refusal> {
        let sequence = whole(block, b'N');
        let had_content = block.has_content();
        self.enter_profile(sequence);
        self.convert_numbers(block)?;
        self.convert_variables(block)?;
        let main = self.convert_g_codes(block)?;
        self.convert_m_codes(block)?;
        self.convert_tool(block)?;
        self.convert_speed(block, main)?;
        let group = main.map(|row| row.rule);
        if group.is_some_and(is_group_00) {
            self.separate_motion_code(block);
        }
        self.convert_role(block, group, index)?;
        self.convert_remaining(block)?;
        self.leave_profile(sequence);
        if had_content && !block.has_content() {
            let is_named = sequence.is_some_and(|it| self.numbers.named.contains(&it));
            comment_out(block, &self.parts[index].block, is_named);
        }
        Ok(())
    }

    /// Converts the words that belong to the main G code of the block, or to the modal code if the
    /// block has none.
    fn convert_role(
        &mut self,
        block: &mut ForeignBlock,
        rule: Option<CodeRule>,
        index: usize,
    ) -> Result<(), Refusal> {
        match rule {
            Some(CodeRule::Dwell) => self.convert_dwell(block),
            Some(CodeRule::Home) => self.convert_home(block),
            Some(CodeRule::SecondHome) => self.convert_second_home(block),
            Some(CodeRule::MachineCoordinates) => self.convert_machine_coordinates(block),
            Some(CodeRule::SetCoordinates) => self.convert_coordinates(block),
            Some(CodeRule::Rough) => self.convert_rough(block),
            Some(CodeRule::Finish) => self.convert_finish(block),
            Some(CodeRule::Peck) => self.convert_peck(block),
            Some(CodeRule::ManyPassThread) => self.convert_thread_cycle(block),
            Some(CodeRule::Macro) => self.convert_macro(block),
            Some(CodeRule::RigidTap) => self.convert_rigid_tap(block),
            _ => match self.state.active {
                ActiveCode::Rapid | ActiveCode::Line | ActiveCode::Arc { .. } => {
                    self.convert_motion(block, index)
                }
                ActiveCode::Thread => self.convert_thread(block),
                ActiveCode::Turn | ActiveCode::ThreadTurn | ActiveCode::Face => {
                    self.convert_canned(block)
                }
                ActiveCode::Drill(code) => self.convert_drill(block, code),
            },
        }
    }

    /// Reads the G codes of a block. Returns the table row of the code to which the other words
    /// belong; `None` if they belong to the modal code.
    fn convert_g_codes(
        &mut self,
        block: &mut ForeignBlock,
    ) -> Result<Option<&'static ForeignCodeRow>, Refusal> {
        let mut main: Option<&'static ForeignCodeRow> = None;
        for code in block.g_codes().collect::<Vec<_>>() {
            let word = format!("G{}", write_number(code * 100_000, 1).trim_end_matches('.'));
            let Some(row) = find_row(b'G', code, self.state.set) else {
                return Err(Refusal::new(word, say::ported_note_unknown_code()));
            };
            if self.convert_modal_code(block, code, row, &word)? {
                continue;
            }
            match row.rule {
                CodeRule::Refuse => return Err(Refusal::new(word, row_note(row))),
                CodeRule::RemoveNoted => {
                    block.remove_g(&[code]);
                    self.note(block.line, word, row_note(row));
                }
                CodeRule::WorkOffset => self.select_work_offset(block, code)?,
                CodeRule::Compensation => self.convert_compensation(block, code),
                _ => {
                    self.select_active(block, code, row.rule);
                    if main.is_none_or(|it| !is_group_00(it.rule)) {
                        main = Some(row);
                    }
                }
            }
        }
        Ok(main)
    }

    /// Executes a code that changes how later words are read, such as G20 or G91; returns `false`
    /// for other codes.
    fn convert_modal_code(
        &mut self,
        block: &mut ForeignBlock,
        code: i64,
        row: &ForeignCodeRow,
        word: &str,
    ) -> Result<bool, Refusal> {
        let state = &mut self.state;
        match row.rule {
            CodeRule::Inch => state.is_inch = true,
            CodeRule::Metric => state.is_inch = false,
            CodeRule::Absolute => state.is_incremental = false,
            CodeRule::Incremental => state.is_incremental = true,
            CodeRule::Diameter => state.is_radius = false,
            CodeRule::Radius => state.is_radius = true,
            CodeRule::AbsoluteCenters => state.has_absolute_centers = true,
            CodeRule::RelativeCenters => state.has_absolute_centers = false,
            CodeRule::PerMinute | CodeRule::PerRevolution => {
                state.per_revolution = Some(row.rule == CodeRule::PerRevolution);
                let here = row.becomes;
                if !matches!(code, 980 | 990) {
                    block.replace_g(code, here);
                }
                return Ok(true);
            }
            CodeRule::SurfaceSpeed => {
                state.has_surface_speed = code == 960;
                return Ok(true);
            }
            CodeRule::Remove => {
                if matches!(code, 640 | 1030 | 1870) {
                    block.remove(b"PQER");
                }
                if code == 800 && matches!(state.active, ActiveCode::Drill(_)) {
                    state.active = ActiveCode::Rapid;
                }
            }
            _ => return Ok(false),
        }
        if row.rule == CodeRule::Radius || row.rule == CodeRule::AbsoluteCenters {
            self.note(block.line, word, row_note(row));
        }
        block.remove_g(&[code]);
        Ok(true)
    }

    /// Selects `code` as the code to which the axis words of this and of later blocks belong.
    fn select_active(&mut self, block: &mut ForeignBlock, code: i64, rule: CodeRule) {
        let state = &mut self.state;
        state.active = match rule {
            CodeRule::Motion if code == 0 => ActiveCode::Rapid,
            CodeRule::Motion if code == 10 => ActiveCode::Line,
            CodeRule::Motion => ActiveCode::Arc {
                is_left: code == 30,
            },
            CodeRule::Thread | CodeRule::VariableThread => ActiveCode::Thread,
            CodeRule::Turn => ActiveCode::Turn,
            CodeRule::ThreadTurn => ActiveCode::ThreadTurn,
            CodeRule::Face => ActiveCode::Face,
            CodeRule::Drill => {
                state.drill = crate::state::DrillWords {
                    initial: state.axes[1].position,
                    ..Default::default()
                };
                ActiveCode::Drill(code)
            }
            _ => return,
        };
        let here = match rule {
            CodeRule::Thread if code != 320 => "G32",
            CodeRule::Turn if code != 900 => "G90",
            CodeRule::ThreadTurn if code != 920 => "G92",
            CodeRule::Face if code != 940 => "G94",
            _ => return,
        };
        block.replace_g(code, here);
    }

    /// Moves a code of group 01 that shares a block with a code of group 00 into a line before the
    /// block.
    fn separate_motion_code(&mut self, block: &mut ForeignBlock) {
        let codes: Vec<i64> = block.g_codes().filter(|it| *it <= 30).collect();
        for code in codes {
            block.remove_g(&[code]);
            block.before.push(format!("G{:02}", code / 10));
        }
    }

    /// Removes or refuses the words that are left over and that no code of this control has.
    fn convert_remaining(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let words: Vec<_> = block.words().cloned().collect();
        for word in words {
            let is_zero = word.number.is_some_and(|it| it.micro == 0);
            let note = match word.letter {
                _ if word.has_comma => say::ported_note_corner(),
                b'D' | b'H' | b'L' => {
                    block.remove(&[word.letter]);
                    self.note(block.line, word.shown(), say::ported_note_no_effect());
                    continue;
                }
                b'J' | b'V' | b'Y' if is_zero => {
                    block.remove(&[word.letter]);
                    continue;
                }
                b'A' => say::ported_note_angle(),
                b'B' | b'C' | b'V' | b'Y' => say::ported_note_axis(),
                b'E' | b'J' => say::ported_note_no_address(),
                _ => continue,
            };
            return Err(Refusal::new(word.shown(), note));
        }
        Ok(())
    }
}

/// Returns the note of a table row; a general note if the row has none.
pub(crate) fn row_note(row: &ForeignCodeRow) -> Message {
    row.note
        .map_or_else(say::ported_note_unknown_code, |note| note())
}

/// Whether the rule is for a code of group 00, which shares no block with a code of group 01.
const fn is_group_00(rule: CodeRule) -> bool {
    matches!(
        rule,
        CodeRule::Dwell
            | CodeRule::Home
            | CodeRule::SecondHome
            | CodeRule::MachineCoordinates
            | CodeRule::SetCoordinates
            | CodeRule::Rough
            | CodeRule::Finish
            | CodeRule::Peck
            | CodeRule::ManyPassThread
            | CodeRule::Macro
            | CodeRule::RigidTap
    )
}

/// Turns a block without any command for this control into a comment, because an empty block would
/// repeat a cycle. If a word refers to the block (`is_named`), the block keeps its sequence number
/// and becomes a G04 without time.
fn comment_out(block: &mut ForeignBlock, source: &ForeignBlock, is_named: bool) {
    if is_named {
        block.append("G04");
        return;
    }
    let is_comment =
        |piece: &&LinePiece| matches!(piece, LinePiece::Text(text) if text.starts_with('('));
    let comments: String = (source.pieces.iter().filter(is_comment))
        .map(|piece| match piece {
            LinePiece::Text(text) => format!(" {text}"),
            LinePiece::Word(_) | LinePiece::Formula(_) => String::new(),
        })
        .collect();
    let words: String = (source.pieces.iter().filter(|piece| !is_comment(piece)))
        .map(LinePiece::written)
        .collect();
    block.pieces = vec![LinePiece::Text(format!("({}){comments}", words.trim()))];
}
