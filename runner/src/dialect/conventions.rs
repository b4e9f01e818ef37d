//! Finds the differences of two models that no code shows: what X measures, increments,
//! planes, feeds, tools, variables, ranges. Each difference is found once, at its first block.

use gsk_core::model::{GCode, Increments, MacroForm, ModelRecord, ToolForm, WorkPlane, XMeasure};
use gsk_messages::{Message, say};

use super::{DialectBlock, DialectWord};

/// A difference between two models, other than in G and M codes, that the program meets.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The models read X differently: one as a diameter, the other as a distance.
    Diameter,
    /// The letter of an increment, U or W: the target model writes increments with G91
    /// instead.
    Increments(char),
    /// An address letter that the target model does not have.
    Address(char),
    /// The models start with different planes for arcs and radius compensation at power-on.
    Plane,
    /// The models start with different feeds, and the program cuts before its first F word.
    FirstFeed,
    /// A programmed feed, mm/min, above the maximum of the target model.
    Feed(f64),
    /// An address letter whose number is outside the range of the target model, and that range
    /// as `low~high`.
    Range(char, String),
    /// The models read a T word differently: as tool and offset, or as the tool alone.
    Tool,
    /// The models have different macro languages (macro A or macro B).
    Macros,
    /// The number of a G code that has the same meaning in both models, but is modal in only
    /// one of them.
    Modal(u8),
    /// The models read L next to M98 differently: only in one of them it is the repeat count.
    CallCount,
}

/// A difference with the line and text of its first word, and the number of blocks that have
/// it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MetDifference {
    pub(super) difference: Difference,
    pub(super) line: u32,
    pub(super) code: String,
    pub(super) blocks: usize,
}

/// Lists each difference that the blocks of a program meet once, in the order of the blocks.
pub(super) fn find_differences(
    blocks: &[DialectBlock<'_>],
    from: &ModelRecord,
    to: &ModelRecord,
) -> Vec<MetDifference> {
    let mut met: Vec<MetDifference> = Vec::new();
    let mut has_feed = false;
    let mut cut_found = false;
    for block in blocks {
        has_feed |= block.has_word(b'F');
        let mut found = find_block_differences(block, from, to);
        if !has_feed
            && !cut_found
            && has_other_first_feed(from, to)
            && let Some(word) = find_cutting_code(block, from)
        {
            cut_found = true;
            found.push((Difference::FirstFeed, word_text(word)));
        }
        for (difference, code) in found {
            match met.iter_mut().find(|it| it.difference == difference) {
                Some(known) => known.blocks += usize::from(known.line != block.line),
                None => met.push(MetDifference {
                    difference,
                    line: block.line,
                    code,
                    blocks: 1,
                }),
            }
        }
    }
    met
}

fn word_text(word: &DialectWord<'_>) -> String {
    format!("{}{}", char::from(word.letter), word.value)
}

fn has_other_first_feed(from: &ModelRecord, to: &ModelRecord) -> bool {
    from.conventions.first_feed != to.conventions.first_feed
}

/// The first word of G01 to G03 in a block; `None` if the block does not cut.
fn find_cutting_code<'a>(
    block: &'a DialectBlock<'_>,
    from: &ModelRecord,
) -> Option<&'a DialectWord<'a>> {
    block.words_with_letter(b'G').find(|word| {
        let code = word.value.parse::<u8>().ok();
        matches!(code, Some(1..=3)) && code.is_some_and(|it| from.g_code(it.into()).is_some())
    })
}

fn find_block_differences(
    block: &DialectBlock<'_>,
    from: &ModelRecord,
    to: &ModelRecord,
) -> Vec<(Difference, String)> {
    let (here, there) = (&from.conventions, &to.conventions);
    let dwells = block.has_meaning(from, GCode::is_dwell);
    let mut found = Vec::new();
    if block.has_formula && here.macros != there.macros {
        found.push((Difference::Macros, String::new()));
    }
    for word in &block.words {
        let letter = char::from(word.letter);
        let coordinate = matches!(word.letter, b'X' | b'U') && !dwells;
        if coordinate && here.x != there.x {
            found.push((Difference::Diameter, word_text(word)));
        }
        let by_letters = matches!(here.increments, Increments::Letters | Increments::Both);
        let is_increment = matches!(word.letter, b'U' | b'W') && by_letters;
        if is_increment && there.increments == Increments::Codes && !dwells {
            found.push((Difference::Increments(letter), word_text(word)));
        } else if from.is_address(word.letter) && !to.is_address(word.letter) && !block.has_formula
        {
            found.push((Difference::Address(letter), word_text(word)));
        }
        if word.letter == b'T' && here.tool != there.tool {
            found.push((Difference::Tool, word_text(word)));
        }
        found.extend(find_range_difference(word, block, from, to).map(|it| (it, word_text(word))));
        found.extend(find_modal_difference(word, from, to).map(|it| (it, word_text(word))));
    }
    let has_arc = block.has_meaning(from, GCode::is_arc_or_compensation);
    if has_arc && here.plane != there.plane {
        found.push((Difference::Plane, String::new()));
    }
    let has_call = block.words_with_letter(b'M').any(|word| word.value == "98");
    if has_call && block.has_word(b'L') && here.counts_calls_by_l != there.counts_calls_by_l {
        found.push((Difference::CallCount, String::from("L")));
    }
    found
}

/// The difference of a G code that means the same in both models, but is modal in only one;
/// `None` for any other word.
fn find_modal_difference(
    word: &DialectWord<'_>,
    from: &ModelRecord,
    to: &ModelRecord,
) -> Option<Difference> {
    if word.letter != b'G' {
        return None;
    }
    let code: u8 = word.value.parse().ok()?;
    let meaning = from.g_code(code.into())?;
    let number = to.g_number(meaning)?;
    let stays = from.conventions.group(code).is_some();
    let stays_there = to.conventions.group(number).is_some();
    (stays != stays_there).then_some(Difference::Modal(code))
}

/// The difference of a word whose number the source model accepts and the target model does
/// not; `None` for any other word.
fn find_range_difference(
    word: &DialectWord<'_>,
    block: &DialectBlock<'_>,
    from: &ModelRecord,
    to: &ModelRecord,
) -> Option<Difference> {
    let letter = char::from(word.letter);
    let value: f64 = word.value.parse().ok()?;
    let in_range = |record: &ModelRecord| {
        let limits = record.word_limits(word.letter);
        limits.is_none_or(|(low, high)| (low as f64..=high as f64).contains(&value))
    };
    if in_range(from) && !in_range(to) {
        let (low, high) = to.word_limits(word.letter)?;
        return Some(Difference::Range(letter, format!("{low}~{high}")));
    }
    let per_minute = !block.has_meaning(from, |it| it == GCode::FeedPerRevolution) && value >= 1.0;
    let (here, there) = (from.conventions.greatest_feed, to.conventions.greatest_feed);
    if word.letter == b'F' && per_minute && value > there.into() && here > there {
        return Some(Difference::Feed(value));
    }
    let coordinate = matches!(word.letter, b'X' | b'Y' | b'Z' | b'U' | b'W');
    let greatest = to.greatest_coordinate_mm();
    let is_too_far = coordinate && value.abs() > greatest;
    (is_too_far && value.abs() <= from.greatest_coordinate_mm())
        .then(|| Difference::Range(letter, format!("-{greatest}~{greatest}")))
}

impl MetDifference {
    /// The message that explains how the target model differs, without the line number.
    pub(super) fn text(&self, from: &ModelRecord, to: &ModelRecord) -> Message {
        let (here, there) = (&from.conventions, &to.conventions);
        let (code, blocks) = (&self.code, self.blocks);
        match &self.difference {
            Difference::Diameter => say::dialect_x(
                code,
                x_measure_text(here.x),
                from.name(),
                x_measure_text(there.x),
                to.name(),
                blocks,
            ),
            Difference::Increments(letter) => {
                say::dialect_increments(letter, from.name(), to.name(), blocks)
            }
            Difference::Address(letter) => say::dialect_address(letter, to.name(), blocks),
            Difference::Plane => {
                let planes = (plane_name(here.plane), plane_name(there.plane));
                say::dialect_plane(planes.0, from.name(), planes.1, to.name(), blocks)
            }
            Difference::FirstFeed => say::dialect_first_feed(
                code,
                from.name(),
                first_feed_text(here.first_feed),
                to.name(),
                first_feed_text(there.first_feed),
            ),
            Difference::Feed(value) => {
                say::dialect_feed(value, to.name(), there.greatest_feed, blocks)
            }
            Difference::Range(letter, range) => {
                say::dialect_range(code, letter, to.name(), range, blocks)
            }
            Difference::Tool => {
                let forms = (tool_form_text(here.tool), tool_form_text(there.tool));
                say::dialect_tool(code, from.name(), forms.0, to.name(), forms.1, blocks)
            }
            Difference::Macros => {
                let forms = (macro_form_text(here.macros), macro_form_text(there.macros));
                say::dialect_macros(from.name(), forms.0, to.name(), forms.1, blocks)
            }
            Difference::Modal(_) => say::dialect_modal(code, from.name(), to.name(), blocks),
            Difference::CallCount => say::dialect_call_count(from.name(), to.name(), blocks),
        }
    }
}

fn x_measure_text(x: XMeasure) -> Message {
    match x {
        XMeasure::Diameter => say::dialect_diameter(),
        XMeasure::Distance => say::dialect_distance(),
    }
}

const fn plane_name(plane: WorkPlane) -> &'static str {
    plane.name()
}

fn first_feed_text(feed: Option<u32>) -> Message {
    match feed {
        Some(feed) => say::dialect_feed_at_power_on(feed),
        None => say::dialect_feed_needed(),
    }
}

fn tool_form_text(form: ToolForm) -> Message {
    match form {
        ToolForm::ToolAndOffset(digits) => say::dialect_tool_and_offset(digits / 2),
        ToolForm::Tool => say::dialect_tool_alone(),
    }
}

fn macro_form_text(form: MacroForm) -> Message {
    match form {
        MacroForm::A => say::dialect_macro_a(),
        MacroForm::B => say::dialect_macro_b(),
        MacroForm::Formulas => say::dialect_macro_formulas(),
    }
}
