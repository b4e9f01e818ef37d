//! Checks a program of the mill without a clock: its moves as lines of JSON, its report.

use std::collections::BTreeMap;
use std::io::{self, Write};

use gsk_core::program::ProgramMemory;
use gsk_core::units::Feed;
use gsk_messages::Language;
use gsk_milling::{
    MillAxis, MillMove, MillMoveKind, MillPosition, MillPreview, Progress, preview_while,
};

use crate::decimal::Line;
use crate::moves::rounded;
use crate::report::{
    AlarmReport, Bounds, Final, MillPlace, PathReport, Place, Report, Seconds, ToolSeconds,
    WarningReport,
};

pub use gsk_milling::MillSetup;

/// Previews the selected program. `on_move` receives every move in order. `goes_on` is called
/// with the progress; it returns false to cancel.
pub fn check(
    name: &str,
    setup: &MillSetup,
    programs: &ProgramMemory,
    language: Option<Language>,
    on_move: &mut dyn FnMut(&MillMove),
    goes_on: &mut dyn FnMut(&Progress) -> bool,
) -> Report {
    let mut times = Times::default();
    let mut take = |made: &MillMove| {
        times.push(made);
        on_move(made);
    };
    let preview = preview_while(setup, programs, &mut take, goes_on);
    of(name, &preview, &times, programs, language)
}

fn of(
    name: &str,
    preview: &MillPreview,
    times: &Times,
    programs: &ProgramMemory,
    language: Option<Language>,
) -> Report {
    let told = |alarm| AlarmReport::new(alarm, programs, language);
    let modal = &preview.modal;
    Report {
        file: name.to_owned(),
        end: preview.end.into(),
        alarm: preview.alarm.as_ref().map(told),
        waits_for: None,
        time_s: rounded(preview.time_s),
        cutting_s: rounded(preview.cutting_s),
        blocks: preview.blocks,
        moves: preview.moves,
        parts: preview.parts,
        stops: preview.stops,
        position: Final {
            abs: Place::Mill(place(preview, &preview.work)),
            machine: Place::Mill(place(preview, &preview.machine)),
            rel: None,
        },
        modal: modal.codes(),
        f: rounded(modal.feed),
        s: modal.speed,
        t: tool_word(modal.tool),
        spindle: match modal.spindle {
            gsk_milling::SpindleState::Forward => "cw",
            gsk_milling::SpindleState::Reverse => "ccw",
            gsk_milling::SpindleState::Stopped => "stop",
        },
        coolant: modal.coolant,
        parameters_changed: BTreeMap::new(),
        warnings: preview
            .cautions
            .iter()
            .map(|it| WarningReport::of_mill(it, language))
            .collect(),
        path: Some(PathReport {
            more_alarms: preview.further.iter().map(told).collect(),
            unchecked_behind: None,
            lengths: BTreeMap::from([
                ("rapid", rounded(preview.lengths.rapid)),
                ("feed", rounded(preview.lengths.feed)),
                ("cw", rounded(preview.lengths.clockwise)),
                ("ccw", rounded(preview.lengths.counter_clockwise)),
                ("tap", rounded(preview.lengths.tap)),
                ("thread", rounded(preview.lengths.thread)),
            ]),
            tools: preview.tools.iter().copied().map(tool_word).collect(),
            bounds: preview.bounds.map(|it| bounds(preview, &it)),
            times: times.all,
            tool_times: times.of_tools(),
        }),
        part: None,
    }
}

/// The bounds of the path, with those of the further axes of the machine.
fn bounds(preview: &MillPreview, found: &gsk_milling::MillBounds) -> Bounds {
    let side = |axis: usize| (rounded(found.least[axis]), rounded(found.greatest[axis]));
    let mut bounds = Bounds {
        x: side(0),
        y: Some(side(1)),
        z: side(2),
        further: BTreeMap::new(),
        turning: Vec::new(),
    };
    for (axis, further) in preview.axes.all_further() {
        let name = match further.letter {
            'A' => "a",
            'B' => "b",
            _ => "c",
        };
        let (least, greatest) = found.further[usize::from(axis == MillAxis::Fifth)];
        let range = (rounded(least), rounded(greatest));
        bounds.further.insert(name, range);
        if further.rotary {
            bounds.turning.push(name);
        }
    }
    bounds
}

/// A point with the further axes of the machine, mm or degrees.
fn place(preview: &MillPreview, point: &MillPosition) -> MillPlace {
    let further = preview.axes.all_further();
    MillPlace {
        basic: point.mm().map(rounded),
        further: further
            .map(|(axis, it)| (it.letter, rounded(point.get(axis).mm())))
            .collect(),
    }
}

/// The digits of a T word.
pub(crate) fn tool_word(tool: u16) -> String {
    format!("{tool:02}")
}

/// Machine time of the whole program, and of each tool in the order of their use.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Times {
    pub(crate) all: Seconds,
    tools: Vec<(u16, Seconds)>,
}

impl Times {
    /// Adds the time of a move.
    pub(crate) fn push(&mut self, made: &MillMove) {
        let known = self.tools.iter().position(|(tool, _)| *tool == made.tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push((made.tool, Seconds::default()));
            self.tools.len() - 1
        });
        for seconds in [&mut self.all, &mut self.tools[index].1] {
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

    /// The tools that cut, with their cutting time, s.
    pub(crate) fn cutting(&self) -> impl Iterator<Item = (u16, f64)> {
        let cuts = |(tool, seconds): &(u16, Seconds)| (*tool, seconds.feed + seconds.thread);
        self.tools
            .iter()
            .map(cuts)
            .filter(|(_, seconds)| *seconds > 0.0)
    }

    fn of_tools(&self) -> Vec<ToolSeconds> {
        let told = |(tool, seconds): &(u16, Seconds)| ToolSeconds {
            tool: tool_word(*tool),
            seconds: *seconds,
        };
        self.tools.iter().map(told).collect()
    }
}

/// Writes a move as one line, a JSON object: the tip of the tool in work coordinates, mm.
/// `cx`, `cy`, `cz` give the centre in the plane of an arc. A fourth and a fifth axis use
/// their own letters, `a0` and `a` for example, with degrees for rotary axes.
///
/// # Errors
/// Writing to `out` fails.
pub fn write_move(out: &mut dyn Write, made: &MillMove) -> io::Result<()> {
    let mut line = Line::default();
    line.number("{\"line\":", made.source.line.into());
    match made.source.sequence {
        Some(sequence) => line.number(",\"n\":", u32::from(sequence).into()),
        None => line.text(",\"n\":null"),
    }
    line.text(",\"kind\":\"");
    line.text(made.kind.name());
    let (from, to) = (made.from.mm(), made.to.mm());
    line.value("\",\"x0\":", Some(from[0]));
    line.value(",\"y0\":", Some(from[1]));
    line.value(",\"z0\":", Some(from[2]));
    line.value(",\"x\":", Some(to[0]));
    line.value(",\"y\":", Some(to[1]));
    line.value(",\"z\":", Some(to[2]));
    for (further, from, to) in made.further() {
        let (begin, end) = match further.letter {
            'A' => (",\"a0\":", ",\"a\":"),
            'B' => (",\"b0\":", ",\"b\":"),
            _ => (",\"c0\":", ",\"c\":"),
        };
        line.value(begin, Some(from));
        line.value(end, Some(to));
    }
    let mut center = [None; 3];
    if let Some(arc) = made.arc {
        let [first, second, _] = arc.plane.axes();
        center[first as usize] = Some(arc.center.first);
        center[second as usize] = Some(arc.center.second);
    }
    line.value(",\"cx\":", center[0]);
    line.value(",\"cy\":", center[1]);
    line.value(",\"cz\":", center[2]);
    let (feed, per) = match made.feed {
        Some(Feed::PerMinute(feed)) => (Some(feed), "\"min\""),
        Some(Feed::PerRevolution(feed)) => (Some(feed), "\"rev\""),
        None => (None, "null"),
    };
    line.value(",\"feed\":", feed);
    line.text(",\"per\":");
    line.text(per);
    line.number(",\"tool\":", made.tool.into());
    line.value(",\"t\":", Some(made.start_s));
    line.value(",\"dt\":", Some(made.duration_s));
    line.text("}\n");
    out.write_all(&line.bytes)
}
