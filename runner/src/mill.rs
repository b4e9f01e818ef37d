//! Checks a program of the mill without a clock: its moves as lines of JSON, its report.

use std::collections::BTreeMap;
use std::io::{self, Write};

use gsk_core::json_line::JsonLine;
use gsk_core::model::ProgramNaming;
use gsk_core::program::ProgramMemory;
use gsk_messages::Language;
use gsk_milling::{
    MillAxis, MillMove, MillMoveKind, MillPosition, MillPreview, PreviewProgress, preview_while,
};

use crate::move_output::{push_feed, round_to_millionth};
use crate::report::{
    AlarmReport, FinalPositions, MillReportPosition, PathReport, ProgramReport, ReportBounds,
    ReportPosition, TimeReport, ToolTimeReport, WarningReport,
};

pub use gsk_milling::MillSetup;

/// Previews the selected program of a mill and reports on it. `on_move` receives every move in
/// order. `can_continue` receives the progress and returns false to cancel.
pub fn check_program(
    name: &str,
    setup: &MillSetup,
    programs: &ProgramMemory,
    language: Option<Language>,
    on_move: &mut dyn FnMut(&MillMove),
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> ProgramReport {
    let mut times = MillTimes::default();
    let mut add = |made: &MillMove| {
        times.add_move(made);
        on_move(made);
    };
    let preview = preview_while(setup, programs, &mut add, can_continue);
    build_report(name, &preview, &times, programs, language)
}

fn build_report(
    name: &str,
    preview: &MillPreview,
    times: &MillTimes,
    programs: &ProgramMemory,
    language: Option<Language>,
) -> ProgramReport {
    let alarm_report = |alarm| AlarmReport::new(alarm, programs, language);
    let modal = &preview.modal;
    ProgramReport {
        naming: ProgramNaming::Letter,
        file: name.to_owned(),
        end: preview.end.into(),
        alarm: preview.alarm.as_ref().map(alarm_report),
        waits_for: None,
        time_s: round_to_millionth(preview.time_s),
        cutting_s: round_to_millionth(preview.cutting_s),
        blocks: preview.blocks,
        moves: preview.moves,
        parts: preview.parts,
        stops: preview.stops,
        position: FinalPositions {
            abs: ReportPosition::Mill(report_position(preview, &preview.work)),
            machine: ReportPosition::Mill(report_position(preview, &preview.machine)),
            rel: None,
        },
        modal: modal.codes(),
        f: round_to_millionth(modal.feed),
        s: modal.speed,
        t: tool_word(modal.tool),
        spindle: match modal.spindle {
            gsk_milling::SpindleState::Forward => "cw",
            gsk_milling::SpindleState::Reverse => "ccw",
            gsk_milling::SpindleState::Stopped => "stop",
        },
        coolant: modal.coolant,
        breaks: Vec::new(),
        parameters_changed: BTreeMap::new(),
        warning_kinds: Vec::new(),
        warnings: preview
            .cautions
            .iter()
            .map(|it| WarningReport::from_mill_caution(it, language))
            .collect(),
        path: Some(PathReport {
            more_alarms: preview.further.iter().map(alarm_report).collect(),
            unchecked_after: None,
            lengths: BTreeMap::from([
                ("rapid", round_to_millionth(preview.lengths.rapid)),
                ("feed", round_to_millionth(preview.lengths.feed)),
                ("cw", round_to_millionth(preview.lengths.clockwise)),
                ("ccw", round_to_millionth(preview.lengths.counter_clockwise)),
                ("tap", round_to_millionth(preview.lengths.tap)),
                ("thread", round_to_millionth(preview.lengths.thread)),
            ]),
            // A mill has no setup sheet.
            programs: Vec::new(),
            tools: preview.tools.iter().copied().map(tool_word).collect(),
            bounds: preview.bounds.map(|it| path_bounds(preview, &it)),
            times: times.total,
            tool_times: times.tool_seconds(),
        }),
        part: None,
        load: None,
    }
}

/// The bounds of the path for the report, including the further axes (the fourth and fifth) of
/// the machine.
fn path_bounds(preview: &MillPreview, bounds_mm: &gsk_milling::MillBounds) -> ReportBounds {
    let axis_range = |axis: usize| {
        (
            round_to_millionth(bounds_mm.least[axis]),
            round_to_millionth(bounds_mm.greatest[axis]),
        )
    };
    let mut bounds = ReportBounds {
        x: axis_range(0),
        y: Some(axis_range(1)),
        z: axis_range(2),
        further: BTreeMap::new(),
        turning: Vec::new(),
    };
    for (axis, further) in preview.axes.all_further() {
        let name = match further.letter {
            'A' => "a",
            'B' => "b",
            _ => "c",
        };
        let (least, greatest) = bounds_mm.further[usize::from(axis == MillAxis::Fifth)];
        let range = (round_to_millionth(least), round_to_millionth(greatest));
        bounds.further.insert(name, range);
        if further.rotary {
            bounds.turning.push(name);
        }
    }
    bounds
}

/// A point for the report, including the further axes of the machine: mm, or degrees for a
/// rotary axis.
fn report_position(preview: &MillPreview, point: &MillPosition) -> MillReportPosition {
    let further = preview.axes.all_further();
    MillReportPosition {
        basic: point.mm().map(round_to_millionth),
        further: further
            .map(|(axis, it)| (it.letter, round_to_millionth(point.get(axis).mm())))
            .collect(),
    }
}

/// Returns the number of a tool as the digits of a T word.
pub fn tool_word(tool: u16) -> String {
    format!("{tool:02}")
}

/// Machine time of a mill program: total, and of each tool in the order of use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MillTimes {
    /// Machine time of all moves, by kind.
    pub total: TimeReport,
    tools: Vec<(u16, TimeReport)>,
}

impl MillTimes {
    /// Adds the time of an executed move to the total and to its tool.
    pub fn add_move(&mut self, made: &MillMove) {
        let known = self.tools.iter().position(|(tool, _)| *tool == made.tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push((made.tool, TimeReport::default()));
            self.tools.len() - 1
        });
        for seconds in [&mut self.total, &mut self.tools[index].1] {
            *match made.kind {
                MillMoveKind::Rapid => &mut seconds.rapid,
                MillMoveKind::Tap | MillMoveKind::Thread => &mut seconds.thread,
                MillMoveKind::Dwell => &mut seconds.dwell,
                MillMoveKind::Feed | MillMoveKind::Clockwise | MillMoveKind::CounterClockwise => {
                    &mut seconds.feed
                }
            } += made.duration_s;
        }
    }

    /// Returns the numbers of the tools that cut, each with its cutting time, s.
    pub fn cutting(&self) -> impl Iterator<Item = (u16, f64)> {
        let cuts = |(tool, seconds): &(u16, TimeReport)| (*tool, seconds.feed + seconds.thread);
        self.tools
            .iter()
            .map(cuts)
            .filter(|(_, seconds)| *seconds > 0.0)
    }

    fn tool_seconds(&self) -> Vec<ToolTimeReport> {
        let row = |(tool, seconds): &(u16, TimeReport)| ToolTimeReport {
            tool: tool_word(*tool),
            seconds: *seconds,
        };
        self.tools.iter().map(row).collect()
    }
}

/// Writes a move as one line, a JSON object: the tip of the tool in work coordinates, mm.
/// `cx`, `cy`, `cz` give the centre of an arc. A fourth and a fifth axis use their letters, with
/// degrees for rotary axes: `a0` is where A begins, `a` where it ends. `line` is the memory of the
/// line, used again for the next one.
///
/// # Errors
/// Writing to `out` fails.
pub fn write_move(out: &mut dyn Write, line: &mut JsonLine, made: &MillMove) -> io::Result<()> {
    line.clear();
    line.push_integer(b"{\"line\":", made.source.line.into());
    match made.source.sequence {
        Some(sequence) => line.push_integer(b",\"n\":", u32::from(sequence).into()),
        None => line.push_bytes(b",\"n\":null"),
    }
    line.push_bytes(b",\"kind\":\"");
    line.push_text(made.kind.name());
    let (from, to) = (made.from.mm(), made.to.mm());
    line.push_number(b"\",\"x0\":", Some(from[0]));
    line.push_number(b",\"y0\":", Some(from[1]));
    line.push_number(b",\"z0\":", Some(from[2]));
    line.push_number(b",\"x\":", Some(to[0]));
    line.push_number(b",\"y\":", Some(to[1]));
    line.push_number(b",\"z\":", Some(to[2]));
    for (further, from, to) in made.further() {
        let (begin, end) = match further.letter {
            'A' => (b",\"a0\":", b",\"a\":"),
            'B' => (b",\"b0\":", b",\"b\":"),
            _ => (b",\"c0\":", b",\"c\":"),
        };
        line.push_number(begin, Some(from));
        line.push_number(end, Some(to));
    }
    let mut center = [None; 3];
    if let Some(arc) = made.arc {
        let [first, second, _] = arc.plane.axes();
        center[first as usize] = Some(arc.center.first);
        center[second as usize] = Some(arc.center.second);
    }
    line.push_number(b",\"cx\":", center[0]);
    line.push_number(b",\"cy\":", center[1]);
    line.push_number(b",\"cz\":", center[2]);
    push_feed(line, made.feed);
    line.push_integer(b",\"tool\":", made.tool.into());
    line.push_number(b",\"t\":", Some(made.start_s));
    line.push_number(b",\"dt\":", Some(made.duration_s));
    line.push_bytes(b"}\n");
    out.write_all(line.as_bytes())
}
