//! LinuxCNC's tool table (`tool.tbl`): T P X Z D I J Q, one tool in a line.

use gsk_messages::{Message, say};
use gsk_units::Diameter;
use gsk_workpiece::job::DiameterPoint;
use gsk_workpiece::tool::{Insert, Tool};

use super::lathe_angles::{edge_angles, insert_shape, orientation, tip_number};
use super::{ImportedTools, numbered_tools, short_number};
use crate::library::{LibraryTool, ToolLibrary};

/// Separates description, id and name in a comment.
const COMMENT_SEPARATOR: &str = " | ";
/// Greatest nose diameter of a turning insert, mm; a tool along Z with more is a drill.
const MAX_NOSE_DIAMETER_MM: f64 = 3.2;
/// Point angle of a drill without angles, degrees.
const USUAL_POINT_DEGREES: f64 = 118.0;

/// Writes a library, in mm. Tools without a station get the next free number. X is the length as
/// a radius; the comment has description, id and name. LinuxCNC keeps 39 characters of it.
pub fn linuxcnc_text(library: &ToolLibrary) -> String {
    let mut out = String::new();
    for (number, id, tool) in numbered_tools(library) {
        let length = tool.length.unwrap_or_default();
        let (front, back) = edge_angles(&tool.tool);
        let diameter = match tool.tool.insert {
            Insert::Drill { diameter, .. } => diameter,
            _ => 2.0 * tool.tool.nose(),
        };
        let plain = |text: &str| text.replace([';', '|', '\n', '\r'], " ");
        let words: Vec<String> = [plain(&tool.description()), id.clone(), plain(&tool.name)]
            .into_iter()
            .filter(|it| !it.trim().is_empty())
            .collect();
        out += &format!(
            "T{number} P{number} X{} Z{} D{} I{} J{} Q{} ;{}\n",
            short_number(length.x.radius()),
            short_number(length.z),
            short_number(diameter),
            short_number(front),
            short_number(back),
            orientation(tool.tool.tip),
            words.join(COMMENT_SEPARATOR),
        );
    }
    out
}

/// The words of a line. Lengths are in mm.
#[derive(Default)]
struct TableLine {
    tool: Option<u32>,
    offset: Option<DiameterPoint>,
    diameter: f64,
    angles: (Option<f64>, Option<f64>),
    orientation: u8,
}

/// Reads a table whose unit of length is `unit_mm`. Bad lines are reported and left out.
pub fn read_linuxcnc(text: &str, unit_mm: f64) -> ImportedTools {
    let mut imported = ImportedTools::default();
    for (index, line) in text.lines().enumerate() {
        let (words, comment) = line.split_once(';').unwrap_or((line, ""));
        if words.trim().is_empty() {
            continue;
        }
        let number = index + 1;
        match read_words(words, unit_mm).and_then(|it| make_tool(&it, comment)) {
            Ok((id, tool, is_assumed)) => {
                if is_assumed {
                    imported
                        .notes
                        .push(say::tool_table_line(number, say::tool_table_assumed()));
                }
                imported.tools.push((id, tool));
            }
            Err(why) => imported.notes.push(say::tool_table_line(number, why)),
        }
    }
    imported
}

fn read_words(words: &str, unit_mm: f64) -> Result<TableLine, Message> {
    let mut line = TableLine::default();
    for word in words.split_whitespace() {
        let refused = || say::tool_word_unknown(word, "T P X Z D I J Q");
        let mut characters = word.chars();
        let letter = characters.next().unwrap_or_default().to_ascii_uppercase();
        let value: f64 = characters.as_str().parse().map_err(|_| refused())?;
        if !value.is_finite() {
            return Err(refused());
        }
        match letter {
            'T' if (0.0..=99_999.0).contains(&value) => line.tool = Some(value as u32),
            'D' => line.diameter = libm::fabs(value) * unit_mm,
            'X' => line.offset.get_or_insert_default().x = Diameter(2.0 * value * unit_mm),
            'Z' => line.offset.get_or_insert_default().z = value * unit_mm,
            'I' => line.angles.0 = Some(value),
            'J' => line.angles.1 = Some(value),
            'Q' if (0.0..=9.0).contains(&value) => line.orientation = value as u8,
            // Pocket and the axes that a lathe does not have.
            'P' | 'Y' | 'A' | 'B' | 'C' | 'U' | 'V' | 'W' => {}
            _ => return Err(refused()),
        }
    }
    Ok(line)
}

/// The tool of a line with its id, and whether its shape is assumed.
fn make_tool(line: &TableLine, comment: &str) -> Result<(String, LibraryTool, bool), Message> {
    let number = line.tool.ok_or_else(say::tool_table_number)?;
    let mut parts = comment.split('|').map(str::trim);
    let first = parts.next().unwrap_or_default();
    let mut id = String::new();
    let (mut tool, is_assumed) = match LibraryTool::from_description(first) {
        Ok(mut tool) => {
            id = parts.next().unwrap_or_default().to_owned();
            tool.name = parts.next().unwrap_or_default().to_owned();
            adjust_to_words(&mut tool.tool, line);
            tool.tool.check()?;
            (tool, false)
        }
        Err(_) => {
            let mut tool = LibraryTool::new(shape_from_words(line)?);
            tool.name = first.to_owned();
            (tool, true)
        }
    };
    tool.station = u8::try_from(number).ok().filter(|it| (1..=99).contains(it));
    tool.length = line.offset.filter(|it| *it != DiameterPoint::default());
    Ok((id, tool, is_assumed))
}

/// Takes over what the words of the table say about a described tool.
fn adjust_to_words(tool: &mut Tool, line: &TableLine) {
    if line.orientation != 0 {
        tool.tip = tip_number(line.orientation);
    }
    match &mut tool.insert {
        Insert::Turning { nose, .. }
        | Insert::Grooving { nose, .. }
        | Insert::Threading { nose, .. }
            // A round insert has its size instead.
            if line.diameter > 0.0 && *nose > 0.0 =>
        {
            *nose = line.diameter / 2.0;
        }
        Insert::Drill { diameter, .. } if line.diameter > 0.0 => *diameter = line.diameter,
        _ => {}
    }
}

/// The tool that orientation, angles and diameter show.
fn shape_from_words(line: &TableLine) -> Result<Tool, Message> {
    let tip = tip_number(line.orientation);
    let angles = match line.angles {
        (Some(front), Some(back)) if front != back => Some((front, back)),
        _ => None,
    };
    let is_along_z = tip == 7 || (line.orientation == 0 && angles.is_none());
    let mut tool;
    if is_along_z && (line.diameter > MAX_NOSE_DIAMETER_MM || angles.is_none()) {
        tool = Tool::drill(line.diameter);
        if let (Insert::Drill { point, .. }, Some((front, back))) = (&mut tool.insert, angles) {
            *point = libm::fabs(front - back);
        } else if let Insert::Drill { point, .. } = &mut tool.insert {
            *point = USUAL_POINT_DEGREES;
        }
    } else {
        tool = Tool::turning();
        tool.tip = tip;
        let shown = angles.and_then(|(front, back)| insert_shape(tip, front, back));
        if let Insert::Turning {
            letter,
            entering,
            nose,
            ..
        } = &mut tool.insert
        {
            if let Some(shape) = shown {
                (*letter, *entering) = shape;
            }
            *nose = line.diameter / 2.0;
        }
        if tool.is_internal() {
            tool.holder = Tool::boring().holder;
        }
    }
    tool.check()?;
    Ok(tool)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;
    use gsk_workpiece::tool::InsertLetter;

    #[test]
    fn a_library_survives_a_round_trip_through_the_table() {
        let mut library = ToolLibrary::default();
        for (id, text, station) in [
            ("rough", "CNMG 120408 PCLNR 2020K12", Some(1)),
            ("bore", "DCMT 070204 S12M-SDUCR 07", Some(2)),
            ("groove", "groove 3 nose=0.2", None),
            ("thread", "thread 60", Some(4)),
            ("drill", "drill 8.5", None),
            ("left", "turn D nose=0.4 tip=4", None),
            ("round", "RCMT 0803M0", None),
        ] {
            let mut tool = LibraryTool::from_description(text).unwrap();
            tool.station = station;
            tool.name = format!("{id} ü");
            tool.length = Some(DiameterPoint {
                x: Diameter(-7.0),
                z: 0.125,
            });
            library.insert(id, tool).unwrap();
        }
        let table = linuxcnc_text(&library);
        let first = table.lines().find(|it| it.contains("rough")).unwrap();
        assert_eq!(
            first,
            "T1 P1 X-3.5 Z0.125 D1.6 I85 J5 Q2 ;CNMG 120408 PCLNR 2020K12 | rough | rough ü"
        );
        let read = read_linuxcnc(&table, 1.0);
        assert_eq!(read.notes, []);
        for (id, tool) in read.tools {
            let mut known = library.tools[&id].clone();
            known.station = tool.station;
            assert_eq!(tool, known, "{id}");
        }
        let numbers: Vec<&str> = table
            .lines()
            .filter_map(|it| it.split(' ').next())
            .collect();
        let mut unique = numbers.clone();
        unique.sort_unstable();
        unique.dedup();
        assert_eq!(unique.len(), numbers.len(), "{numbers:?}");
    }

    #[test]
    fn a_table_of_another_shop_gives_shapes_by_their_angles() {
        let table = "; lathe\nT1 P1 D+0.8 I+95 J+175 Q1 ;facing\nT2 P2 D0.4 I85 J30 Q2\n\
                     T7 P7 D10 Q7 ;drill\nT9 P9 D0.8 I40 J50 Q3\nT10 P\nX1 Q2\n";
        let read = read_linuxcnc(table, 1.0);
        let letter = |index: usize| match read.tools[index].1.tool.insert {
            Insert::Turning {
                letter,
                entering,
                nose,
                ..
            } => Some((letter, entering, nose)),
            _ => None,
        };
        assert_eq!(letter(0), Some((InsertLetter::C, 95.0, 0.4)));
        assert_eq!(letter(1), Some((InsertLetter::D, 95.0, 0.2)));
        assert_eq!(read.tools[0].1.name, "facing");
        assert!(
            matches!(read.tools[2].1.tool.insert, Insert::Drill { diameter, .. } if diameter == 10.0)
        );
        assert_eq!(read.tools[3].1.tool.tip, 2);
        let notes: Vec<String> = read.notes.iter().map(|it| it.text(Language::En)).collect();
        assert_eq!(read.tools.len(), 4);
        assert!(
            notes
                .iter()
                .any(|it| it.contains("line 6") && it.contains('P')),
            "{notes:?}"
        );
        assert!(notes.iter().any(|it| it.contains("line 7")), "{notes:?}");
        let inch = read_linuxcnc("T1 P1 D0.03125 I85 J5 Q2", 25.4);
        assert!((inch.tools[0].1.tool.nose() - 0.396_875).abs() < 1e-9);
    }
}
