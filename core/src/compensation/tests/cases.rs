//! Runs the worked cases of `cases.txt` through interpreter and preview.

use crate::command::{ExecutedMove, MoveKind};
use crate::memory::ToolOffset;
use crate::preview::{Preview, preview};
use crate::program::{Program, ProgramMemory};
use crate::setup::Setup;
use crate::units::{Diameter, Point};

const CASES: &str = include_str!("cases.txt");
const TOLERANCE: f64 = 0.001;

/// A worked case of `cases.txt`: blocks and the expected moves of the tip.
struct WorkedCase {
    name: &'static str,
    nose: ToolOffset,
    /// The texts of the blocks of the case, in order.
    blocks: Vec<&'static str>,
    /// Expected moves: index of the block, target of the tip, and the centre if it is an arc,
    /// mm.
    targets: Vec<(usize, Point, Option<Point>)>,
    alarm: Option<(u16, u32)>,
}

/// Runs a program from the position `start`, with `nose` in row 01 of the offset table.
pub(super) fn run_with_nose(
    text: &str,
    nose: ToolOffset,
    start: Point,
) -> (Vec<ExecutedMove>, Preview) {
    let mut setup = Setup {
        start: Some(start),
        ..Setup::default()
    };
    setup.memory.parameters.set_bit(2, 1, true).unwrap();
    setup.memory.offsets.set(1, nose).unwrap();
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(text));
    let mut moves = Vec::new();
    let preview = preview(&setup, &programs, &mut |executed| moves.push(*executed));
    (moves, preview)
}

/// Displacement from the nose centre to its tip, mm, computed independently of the tested
/// code.
pub(super) fn tip_vector(nose: &ToolOffset) -> Point {
    let (z, x) = [
        (0, 0),
        (1, 1),
        (-1, 1),
        (-1, -1),
        (1, -1),
        (1, 0),
        (0, 1),
        (-1, 0),
        (0, -1),
        (0, 0),
    ][usize::from(nose.t)];
    Point::new(f64::from(x), f64::from(z)) * nose.r.abs()
}

fn parse_point(text: &str) -> Point {
    let mut words = text
        .split_whitespace()
        .map(|word| word.parse::<f64>().unwrap());
    let x = words.next().unwrap();
    let point = Point::from_diameter(Diameter(x), words.next().unwrap());
    assert_eq!(words.next(), None, "{text}");
    point
}

fn parse_case(paragraph: &'static str) -> WorkedCase {
    let mut lines = paragraph.lines();
    let head = lines.next().unwrap();
    let mut words = head.split(':').next().unwrap().split(' ');
    let name = words.next().unwrap();
    let mut value = |letter: char| {
        let word = words.next().unwrap();
        word.strip_prefix(letter).unwrap().parse::<f64>().unwrap()
    };
    let mut case = WorkedCase {
        name,
        nose: ToolOffset {
            r: value('R'),
            t: value('T') as u8,
            ..ToolOffset::default()
        },
        blocks: Vec::new(),
        targets: Vec::new(),
        alarm: None,
    };
    for line in lines {
        let line = line.trim();
        if let Some(alarm) = line.strip_prefix("=> ") {
            let (number, block) = alarm.split_once(" in block ").unwrap();
            case.alarm = Some((number.parse().unwrap(), block.parse().unwrap()));
            continue;
        }
        let (block, targets) = line.split_once(" -> ").unwrap_or((line, ""));
        let (targets, about) = match targets.split_once(" about ") {
            Some((targets, about)) => (targets, Some(parse_point(about) + tip_vector(&case.nose))),
            None => (targets, None),
        };
        for (index, target) in targets.split(", ").enumerate() {
            if !target.is_empty() {
                let about = about.filter(|_| index == 0);
                case.targets
                    .push((case.blocks.len(), parse_point(target), about));
            }
        }
        case.blocks.push(block);
    }
    case
}

fn worked_cases() -> Vec<WorkedCase> {
    CASES
        .split("\n\n")
        .filter(|paragraph| !paragraph.starts_with('#'))
        .map(|paragraph| parse_case(paragraph.trim()))
        .collect()
}

fn are_close(a: Point, b: Point) -> bool {
    // X counts as a diameter, as in the rows.
    (a.x - b.x).abs() * 2.0 <= TOLERANCE && (a.z - b.z).abs() <= TOLERANCE
}

#[test]
fn worked_cases_match() {
    let cases = worked_cases();
    assert_eq!(cases.len(), 64);
    let mut wrong = Vec::new();
    for case in &cases {
        if let Err(text) = check_case(case) {
            wrong.push(format!("{}: {text}", case.name));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

fn check_case(case: &WorkedCase) -> Result<(), String> {
    // The first block is the start position.
    let start = parse_point(&case.blocks[0].replace("G00 X", "").replace('Z', ""));
    let text = format!("T0101 F100\n{}", case.blocks[1..].join("\n"));
    let (moves, preview) = run_with_nose(&text, case.nose, start);
    let alarm = preview.alarm.as_ref().map(|alarm| {
        let line = alarm.source.map_or(0, |source| source.line);
        (alarm.number, line)
    });
    if alarm != case.alarm {
        return Err(format!("alarm {alarm:?}, not {:?}", case.alarm));
    }
    if case.alarm.is_some() {
        return Ok(());
    }
    // Moves without length are not reported.
    let mut at = start;
    let mut expected = Vec::new();
    for target in &case.targets {
        if !are_close(target.1, at) {
            expected.push(*target);
        }
        at = target.1;
    }
    let moves: Vec<_> = moves.iter().filter(|made| made.from != made.to).collect();
    if moves.len() != expected.len() {
        return Err(format!(
            "{} moves, not {}: {moves:?}",
            moves.len(),
            expected.len()
        ));
    }
    let mut before = 1;
    for (made, (block, target, about)) in moves.iter().zip(expected) {
        let line = made.source.line as usize - 1;
        // The block after a corner runs it.
        let box_leg = case.blocks[block].contains("G9");
        let own = block != before || box_leg;
        if (own && line != block) || (!own && line <= block && block != 1) {
            return Err(format!("{made:?} belongs to block {block}"));
        }
        before = block;
        if !are_close(made.to, target) {
            return Err(format!("block {block}: {:?}, not {target:?}", made.to));
        }
        let arc = matches!(made.kind, MoveKind::Clockwise | MoveKind::CounterClockwise);
        match (arc, about) {
            (false, None) => {}
            (true, Some(about)) if are_close(made.center.unwrap_or_default(), about) => {}
            _ => return Err(format!("block {block}: {made:?}, not about {about:?}")),
        }
    }
    Ok(())
}
