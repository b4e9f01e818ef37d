//! Differences of two models that lie in no code: what X measures, increments, planes,
//! feeds, tools, variables, ranges. Each is found once, at its first block.

use gsk_core::model::{GCode, Increments, MacroForm, Record, ToolForm, WorkPlane, XMeasure};
use gsk_messages::{Message, say};

use super::{Block, Word};

/// A difference that a program meets.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// X measures something else.
    Diameter,
    /// Increments by U and W are written by G91 there.
    Increments(char),
    /// There is no such address.
    Address(char),
    /// Arcs and radius compensation begin in another plane.
    Plane,
    /// A cut before the first F.
    FirstFeed,
    /// A feed beyond the greatest one there, mm/min.
    Feed(f64),
    /// A number beyond its range there.
    Range(char, String),
    /// A T word names something else.
    Tool,
    /// Variables and formulas are others.
    Macros,
    /// A code that means the same stays in force in one of them alone.
    Modal(u8),
    /// L counts the runs of M98 in one of them alone.
    CallCount,
}

/// A difference with its first block, as it stands there, and in how many it is met.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Met {
    pub(super) difference: Difference,
    pub(super) line: u32,
    pub(super) code: String,
    pub(super) blocks: usize,
}

/// The differences that the blocks of a program meet.
pub(super) fn differences(blocks: &[Block<'_>], from: &Record, to: &Record) -> Vec<Met> {
    let mut met: Vec<Met> = Vec::new();
    let mut has_feed = false;
    let mut cut_found = false;
    for block in blocks {
        has_feed |= block.has(b'F');
        let mut found = in_block(block, from, to);
        if !has_feed
            && !cut_found
            && first_feeds_differ(from, to)
            && let Some(word) = cutting_code(block, from)
        {
            cut_found = true;
            found.push((Difference::FirstFeed, written(word)));
        }
        for (difference, code) in found {
            match met.iter_mut().find(|it| it.difference == difference) {
                Some(known) => known.blocks += usize::from(known.line != block.line),
                None => met.push(Met {
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

fn written(word: &Word<'_>) -> String {
    format!("{}{}", char::from(word.letter), word.value)
}

fn first_feeds_differ(from: &Record, to: &Record) -> bool {
    from.conventions.first_feed != to.conventions.first_feed
}

/// The code of a block that cuts.
fn cutting_code<'a>(block: &'a Block<'_>, from: &Record) -> Option<&'a Word<'a>> {
    block.codes(b'G').find(|word| {
        let code = word.value.parse::<u8>().ok();
        matches!(code, Some(1..=3)) && code.is_some_and(|it| from.g_code(it.into()).is_some())
    })
}

fn in_block(block: &Block<'_>, from: &Record, to: &Record) -> Vec<(Difference, String)> {
    let (here, there) = (&from.conventions, &to.conventions);
    let dwells = block.means(from, GCode::is_dwell);
    let mut found = Vec::new();
    if block.has_formula && here.macros != there.macros {
        found.push((Difference::Macros, String::new()));
    }
    for word in &block.words {
        let letter = char::from(word.letter);
        let coordinate = matches!(word.letter, b'X' | b'U') && !dwells;
        if coordinate && here.x != there.x {
            found.push((Difference::Diameter, written(word)));
        }
        let by_letters = matches!(here.increments, Increments::Letters | Increments::Both);
        let is_increment = matches!(word.letter, b'U' | b'W') && by_letters;
        if is_increment && there.increments == Increments::Codes && !dwells {
            found.push((Difference::Increments(letter), written(word)));
        } else if from.takes_address(word.letter)
            && !to.takes_address(word.letter)
            && !block.has_formula
        {
            found.push((Difference::Address(letter), written(word)));
        }
        if word.letter == b'T' && here.tool != there.tool {
            found.push((Difference::Tool, written(word)));
        }
        found.extend(beyond(word, block, from, to).map(|it| (it, written(word))));
        found.extend(modal(word, from, to).map(|it| (it, written(word))));
    }
    let turns = block.means(from, GCode::is_arc_or_compensation);
    if turns && here.plane != there.plane {
        found.push((Difference::Plane, String::new()));
    }
    let calls = block.codes(b'M').any(|word| word.value == "98");
    if calls && block.has(b'L') && here.counts_calls_by_l != there.counts_calls_by_l {
        found.push((Difference::CallCount, String::from("L")));
    }
    found
}

/// A code that means the same, and stays in force in one model alone.
fn modal(word: &Word<'_>, from: &Record, to: &Record) -> Option<Difference> {
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

/// A number that the other model does not take.
fn beyond(word: &Word<'_>, block: &Block<'_>, from: &Record, to: &Record) -> Option<Difference> {
    let letter = char::from(word.letter);
    let value: f64 = word.value.parse().ok()?;
    let in_range = |record: &Record| {
        let limits = record.word_limits(word.letter);
        limits.is_none_or(|(low, high)| (low as f64..=high as f64).contains(&value))
    };
    if in_range(from) && !in_range(to) {
        let (low, high) = to.word_limits(word.letter)?;
        return Some(Difference::Range(letter, format!("{low}~{high}")));
    }
    let per_minute = !block.means(from, |it| it == GCode::FeedPerRevolution) && value >= 1.0;
    let (here, there) = (from.conventions.greatest_feed, to.conventions.greatest_feed);
    if word.letter == b'F' && per_minute && value > there.into() && here > there {
        return Some(Difference::Feed(value));
    }
    let coordinate = matches!(word.letter, b'X' | b'Y' | b'Z' | b'U' | b'W');
    let greatest = to.greatest_coordinate_mm();
    let too_far = coordinate && value.abs() > greatest;
    (too_far && value.abs() <= from.greatest_coordinate_mm())
        .then(|| Difference::Range(letter, format!("-{greatest}~{greatest}")))
}

impl Met {
    /// In words, without the line.
    pub(super) fn text(&self, from: &Record, to: &Record) -> Message {
        let (here, there) = (&from.conventions, &to.conventions);
        let (code, blocks) = (&self.code, self.blocks);
        match &self.difference {
            Difference::Diameter => say::dialect_x(
                code,
                measure(here.x),
                from.name(),
                measure(there.x),
                to.name(),
                blocks,
            ),
            Difference::Increments(letter) => {
                say::dialect_increments(letter, from.name(), to.name(), blocks)
            }
            Difference::Address(letter) => say::dialect_address(letter, to.name(), blocks),
            Difference::Plane => {
                let planes = (plane(here.plane), plane(there.plane));
                say::dialect_plane(from.name(), planes.0, to.name(), planes.1, blocks)
            }
            Difference::FirstFeed => say::dialect_first_feed(
                code,
                from.name(),
                first_feed(here.first_feed),
                to.name(),
                first_feed(there.first_feed),
            ),
            Difference::Feed(value) => {
                say::dialect_feed(value, to.name(), there.greatest_feed, blocks)
            }
            Difference::Range(letter, range) => {
                say::dialect_range(code, letter, to.name(), range, blocks)
            }
            Difference::Tool => {
                let forms = (tool(here.tool), tool(there.tool));
                say::dialect_tool(code, from.name(), forms.0, to.name(), forms.1, blocks)
            }
            Difference::Macros => {
                let forms = (macros(here.macros), macros(there.macros));
                say::dialect_macros(from.name(), forms.0, to.name(), forms.1, blocks)
            }
            Difference::Modal(_) => say::dialect_modal(code, from.name(), to.name(), blocks),
            Difference::CallCount => say::dialect_call_count(from.name(), to.name(), blocks),
        }
    }
}

fn measure(x: XMeasure) -> Message {
    match x {
        XMeasure::Diameter => say::dialect_diameter(),
        XMeasure::Distance => say::dialect_distance(),
    }
}

const fn plane(plane: WorkPlane) -> &'static str {
    plane.name()
}

fn first_feed(feed: Option<u32>) -> Message {
    match feed {
        Some(feed) => say::dialect_feed_at_power_on(feed),
        None => say::dialect_feed_needed(),
    }
}

fn tool(form: ToolForm) -> Message {
    match form {
        ToolForm::ToolAndOffset(digits) => say::dialect_tool_and_offset(digits / 2),
        ToolForm::Tool => say::dialect_tool_alone(),
    }
}

fn macros(form: MacroForm) -> Message {
    match form {
        MacroForm::A => say::dialect_macro_a(),
        MacroForm::B => say::dialect_macro_b(),
        MacroForm::Formulas => say::dialect_macro_formulas(),
    }
}
