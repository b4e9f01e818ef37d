//! Describes a tool in a line: by ISO codes (`CNMG 120408 PCLNR 2020K12`) or by dimensions
//! (`drill 8.5 reach=60`).

use core::fmt::Write;

use gsk_messages::{Message, say};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

use crate::iso::{HolderCode, InsertCode};

/// Number of symbols of an insert designation.
const INSERT_SYMBOLS: usize = 10;
/// Shank of an insert without a holder code.
const USUAL_SHANK: Holder = Holder::Shank {
    width: 20.0,
    length: 60.0,
};

/// The kinds of tools that are described by dimensions.
const KINDS: [&str; 4] = ["turn", "groove", "thread", "drill"];

/// Parses the description of a tool.
///
/// # Errors
/// What is wrong, with the word or the position in the ISO code.
pub fn parse_description(text: &str) -> Result<Tool, Message> {
    let words: Vec<&str> = text
        .split(|it: char| it.is_whitespace() || it == ',' || it == '/')
        .filter(|it| !it.is_empty())
        .collect();
    let Some(first) = words.first() else {
        return Err(say::tool_description_empty());
    };
    let kind = KINDS.into_iter().find(|it| first.eq_ignore_ascii_case(it));
    let tool = match kind {
        Some(kind) => parse_dimensions(kind, &words[1..])?,
        None => parse_iso(&words)?,
    };
    tool.check()?;
    Ok(tool)
}

/// Parses an insert code and, if present, the code of its holder.
fn parse_iso(words: &[&str]) -> Result<Tool, Message> {
    let mut insert = String::new();
    let mut used = 0;
    while used < words.len() && insert.chars().count() < INSERT_SYMBOLS {
        insert += words[used];
        used += 1;
    }
    let code = InsertCode::parse(&insert).map_err(|error| error.message())?;
    let holder = words[used..].concat();
    let (entering, tip, holder) = match holder.as_str() {
        "" => (usual_entering(code.letter), 3, USUAL_SHANK),
        text => {
            let holder = HolderCode::parse(text, &code).map_err(|error| error.message())?;
            (holder.entering, holder.tip(), holder.holder)
        }
    };
    Ok(Tool {
        insert: Insert::Turning {
            letter: code.letter,
            entering,
            size: code.circle_mm,
            nose: match code.letter {
                InsertLetter::R => 0.0,
                _ => code.nose_mm,
            },
        },
        tip,
        holder,
    })
}

/// The entering angle of the usual holder for a shape, degrees.
const fn usual_entering(letter: InsertLetter) -> f64 {
    match letter {
        InsertLetter::C | InsertLetter::W => 95.0,
        InsertLetter::D | InsertLetter::V => 93.0,
        InsertLetter::T | InsertLetter::R => 90.0,
        InsertLetter::S => 75.0,
    }
}

/// Parses the dimensions of a tool: its main one, then words `name=value`.
fn parse_dimensions(kind: &str, words: &[&str]) -> Result<Tool, Message> {
    if words.is_empty() {
        return Err(say::tool_description_empty());
    }
    let mut tool = match kind {
        "turn" => Tool::turning(),
        "groove" => Tool::grooving(3.0),
        "thread" => Tool::threading(60.0),
        _ => Tool::drill(10.0),
    };
    let mut has_reach = false;
    for (index, word) in words.iter().enumerate() {
        let refused = || say::tool_word_unknown(word, dimension_names(kind));
        let (name, value) = match word.split_once('=') {
            Some(pair) => pair,
            None if index == 0 => (main_dimension(kind), *word),
            None => return Err(refused()),
        };
        match name {
            "letter" => {
                let known = InsertLetter::ALL.into_iter();
                let mut known = known.filter(|it| value.eq_ignore_ascii_case(&format!("{it:?}")));
                let letter = known.next().ok_or_else(refused)?;
                match &mut tool.insert {
                    Insert::Turning { letter: field, .. } => *field = letter,
                    _ => return Err(refused()),
                }
            }
            "tip" => tool.tip = value.parse().map_err(|_| refused())?,
            "shank" => {
                let (width, length) = parse_pair(value).ok_or_else(refused)?;
                tool.holder = Holder::Shank { width, length };
            }
            "bar" => {
                let (diameter, length) = parse_pair(value).ok_or_else(refused)?;
                tool.holder = Holder::Bar { diameter, length };
            }
            _ => {
                let value = parse_number(value).ok_or_else(refused)?;
                has_reach |= name == "reach";
                *dimension(&mut tool.insert, name).ok_or_else(refused)? = value;
            }
        }
    }
    if let Insert::Drill {
        diameter, reach, ..
    } = &mut tool.insert
        && !has_reach
    {
        // The flutes of a jobber drill, roughly.
        *reach = (8.0 * *diameter).clamp(10.0, 200.0);
    }
    Ok(tool)
}

/// The field of an insert by its name in a description.
fn dimension<'a>(insert: &'a mut Insert, name: &str) -> Option<&'a mut f64> {
    match (insert, name) {
        (Insert::Turning { entering, .. }, "entering") => Some(entering),
        (Insert::Turning { size, .. }, "size") => Some(size),
        (Insert::Grooving { width, .. }, "width") => Some(width),
        (Insert::Threading { angle, .. }, "angle") => Some(angle),
        (Insert::Threading { height, .. }, "height") => Some(height),
        (Insert::Drill { diameter, .. }, "diameter") => Some(diameter),
        (Insert::Drill { point, .. }, "point") => Some(point),
        (Insert::Grooving { reach, .. } | Insert::Drill { reach, .. }, "reach") => Some(reach),
        (
            Insert::Turning { nose, .. }
            | Insert::Grooving { nose, .. }
            | Insert::Threading { nose, .. },
            "nose",
        ) => Some(nose),
        _ => None,
    }
}

fn main_dimension(kind: &str) -> &'static str {
    match kind {
        "turn" => "letter",
        "groove" => "width",
        "thread" => "angle",
        _ => "diameter",
    }
}

/// The names that a description of this kind has, for messages.
fn dimension_names(kind: &str) -> &'static str {
    match kind {
        "turn" => "letter entering size nose tip shank bar",
        "groove" => "width nose reach tip shank bar",
        "thread" => "angle nose height tip shank bar",
        _ => "diameter point reach tip shank bar",
    }
}

fn parse_number(text: &str) -> Option<f64> {
    let number: f64 = text.parse().ok()?;
    number.is_finite().then_some(number)
}

/// Two numbers: `20x60`.
fn parse_pair(text: &str) -> Option<(f64, f64)> {
    let (first, second) = text.split_once(['x', 'X'])?;
    Some((parse_number(first)?, parse_number(second)?))
}

/// Describes a tool by all its dimensions; [`parse_description`] gives the same tool again.
pub fn tool_description(tool: &Tool) -> String {
    let mut out = match tool.insert {
        Insert::Turning {
            letter,
            entering,
            size,
            nose,
        } => format!("turn {letter:?} entering={entering} size={size} nose={nose}"),
        Insert::Grooving { width, nose, reach } => {
            format!("groove {width} nose={nose} reach={reach}")
        }
        Insert::Threading {
            angle,
            nose,
            height,
        } => format!("thread {angle} nose={nose} height={height}"),
        Insert::Drill {
            diameter,
            point,
            reach,
        } => format!("drill {diameter} point={point} reach={reach}"),
    };
    let tip = tool.tip;
    let _ = match tool.holder {
        Holder::None => write!(out, " tip={tip}"),
        Holder::Shank { width, length } => write!(out, " tip={tip} shank={width}x{length}"),
        Holder::Bar { diameter, length } => write!(out, " tip={tip} bar={diameter}x{length}"),
    };
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn iso_codes_give_the_tool_with_or_without_a_holder() {
        let with_holder = parse_description("CNMG 120408 PCLNR 2020K12").unwrap();
        assert_eq!(with_holder, Tool::turning());
        assert_eq!(parse_description("CNMG 12 04 08").unwrap(), Tool::turning());
        assert_eq!(
            parse_description("cnmg120408-pm, pclnr2020k12").unwrap(),
            with_holder
        );
        let bar = parse_description("DCMT 070204 / S12M-SDUCR 07").unwrap();
        assert_eq!((bar.tip, bar.is_internal()), (2, true));
        assert_eq!(parse_description("RCMT 1204M0").unwrap().nose(), 6.0);
    }

    #[test]
    fn dimensions_give_the_tool_and_the_tool_its_dimensions() {
        let drill = parse_description("drill 8.5 point=140").unwrap();
        assert_eq!(
            drill.insert,
            Insert::Drill {
                diameter: 8.5,
                point: 140.0,
                reach: 68.0
            }
        );
        for text in [
            "groove 3",
            "thread 55",
            "drill 12",
            "turn V nose=0.2 tip=2 bar=10x50",
        ] {
            let tool = parse_description(text).unwrap();
            let again = parse_description(&tool_description(&tool));
            // A drill has no holder by default, a description without one keeps it so.
            assert_eq!(again.unwrap(), tool, "{text}");
        }
    }

    #[test]
    fn a_wrong_word_is_named() {
        for (text, wanted) in [
            ("", "empty"),
            ("drill", "no dimension"),
            ("drill wide", "wide"),
            ("drill 8 nose=1", "nose=1"),
            ("groove 3 reach=inf", "reach=inf"),
            ("turn X", "X"),
            ("thread 60 height=0.1", "0.1"),
            ("turn C tip=300", "tip=300"),
            ("CNMG 130408", "position 5"),
            ("CNMG 120408 PCLNR 2020K09", "position 9"),
        ] {
            let error = parse_description(text).unwrap_err().text(Language::En);
            assert!(error.contains(wanted), "{text}: {error}");
        }
    }
}
