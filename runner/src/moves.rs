//! Writes executed moves and positions as lines of text: NDJSON and CSV.

use std::io::{self, Write};

use crate::decimal::Line;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::units::{Feed, Point};

/// Rounds to six decimals: a nanometre, a microsecond. Returns no negative zero.
pub fn rounded(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    // No negative zero in the output.
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A point as diameter and Z, mm, rounded to six decimals.
pub fn diameter_z(point: Point) -> (f64, f64) {
    (rounded(point.diameter().0), rounded(point.z))
}

/// Whether a move is part of the output. Motions without length are not, but dwells and full
/// circles are.
pub fn counts(executed: &ExecutedMove) -> bool {
    let full_circle = executed.center.is_some();
    executed.kind == MoveKind::Dwell || full_circle || executed.from != executed.to
}

/// Writes a move as one line, a JSON object. X values are diameters in the program's work
/// coordinates without tool offset, mm. Times are seconds of machine time.
pub fn write_move(out: &mut dyn Write, executed: &ExecutedMove) -> io::Result<()> {
    let mut line = Line::default();
    line.number("{\"line\":", executed.source.line.into());
    match executed.source.sequence {
        Some(sequence) => line.number(",\"n\":", u32::from(sequence).into()),
        None => line.text(",\"n\":null"),
    }
    line.text(",\"kind\":\"");
    line.text(executed.kind.name());
    line.value("\",\"x0\":", Some(executed.from.diameter().0));
    line.value(",\"z0\":", Some(executed.from.z));
    line.value(",\"x\":", Some(executed.to.diameter().0));
    line.value(",\"z\":", Some(executed.to.z));
    line.value(
        ",\"cx\":",
        executed.center.map(|center| center.diameter().0),
    );
    line.value(",\"cz\":", executed.center.map(|center| center.z));
    let (feed, per) = match executed.feed {
        Some(Feed::PerMinute(feed)) => (Some(feed), "\"min\""),
        Some(Feed::PerRevolution(feed)) => (Some(feed), "\"rev\""),
        None => (None, "null"),
    };
    // A thread has a lead instead of a feed.
    let (feed, per, lead) = if executed.kind.is_thread() {
        (None, "null", feed)
    } else {
        (feed, per, None)
    };
    line.value(",\"feed\":", feed);
    line.text(",\"per\":");
    line.text(per);
    line.value(",\"lead\":", lead);
    line.value(",\"t\":", Some(executed.start_s));
    line.value(",\"dt\":", Some(executed.duration_s));
    line.text("}\n");
    out.write_all(&line.bytes)
}

/// Header line of the CSV file of positions.
pub const POSITIONS_HEAD: &str = "t,x,z,spindle_deg\n";

/// Writes a line of the CSV file: the time, s, the machine position with X as a diameter, mm,
/// and the angle of the spindle, degrees.
pub fn write_position(
    out: &mut dyn Write,
    time_s: f64,
    machine: Point,
    spindle_degrees: f64,
) -> io::Result<()> {
    let (x, z) = (machine.diameter().0, machine.z);
    writeln!(out, "{time_s:.3},{x:.6},{z:.6},{spindle_degrees:.3}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{Conditions, ProgramId, Source};

    fn executed(kind: MoveKind) -> ExecutedMove {
        ExecutedMove {
            source: Source {
                program: ProgramId::External,
                line: 12,
                sequence: Some(50.into()),
            },
            kind,
            from: Point::new(25.0, 0.0),
            to: Point::new(25.0, -30.000_000_04),
            center: None,
            feed: Some(Feed::PerMinute(120.0)),
            start_s: 1.5,
            duration_s: 15.0,
            conditions: Conditions::default(),
        }
    }

    #[test]
    fn a_move_is_one_line_with_diameters() {
        let mut out = Vec::new();
        write_move(&mut out, &executed(MoveKind::Feed)).expect("write");
        assert_eq!(
            String::from_utf8(out).expect("text"),
            "{\"line\":12,\"n\":50,\"kind\":\"feed\",\"x0\":50.0,\"z0\":0.0,\"x\":50.0,\"z\":-30.0,\
             \"cx\":null,\"cz\":null,\"feed\":120.0,\"per\":\"min\",\"lead\":null,\"t\":1.5,\"dt\":15.0}\n"
        );
    }

    #[test]
    fn only_motions_of_no_length_are_left_out() {
        let mut still = executed(MoveKind::Feed);
        assert!(counts(&still));
        still.to = still.from;
        assert!(!counts(&still));
        still.kind = MoveKind::Dwell;
        assert!(counts(&still));
        still.kind = MoveKind::Clockwise;
        still.center = Some(Point::default());
        assert!(counts(&still), "a full circle ends where it began");
    }
}
