//! Writes executed moves and positions as lines of text: NDJSON and CSV.

use std::io::{self, Write};

use crate::machining::MoveLoad;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::json_line::JsonLine;
use gsk_core::units::{Feed, Point};

/// Rounds to six decimals: a nanometre in mm, a microsecond in s. Returns no negative zero.
pub fn round_to_millionth(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    // No negative zero in the output.
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// Returns a point as diameter and Z, mm, rounded to six decimals.
pub fn diameter_z(point: Point) -> (f64, f64) {
    (
        round_to_millionth(point.diameter().0),
        round_to_millionth(point.z),
    )
}

/// Whether a move is part of the output. Motions without length are not, but dwells and full
/// circles are.
pub fn is_reported(executed: &ExecutedMove) -> bool {
    let full_circle = executed.center.is_some();
    executed.kind == MoveKind::Dwell || full_circle || executed.from != executed.to
}

/// Writes a move as one line, a JSON object. X values are diameters in the program's work
/// coordinates without tool offset, mm. Times are seconds of machine time. `line` is the memory
/// of the line, used again for the next one.
pub fn write_move(
    out: &mut dyn Write,
    line: &mut JsonLine,
    executed: &ExecutedMove,
) -> io::Result<()> {
    line.clear();
    line.push_integer(b"{\"line\":", executed.source.line.into());
    match executed.source.sequence {
        Some(sequence) => line.push_integer(b",\"n\":", u32::from(sequence).into()),
        None => line.push_bytes(b",\"n\":null"),
    }
    line.push_bytes(b",\"kind\":\"");
    line.push_text(executed.kind.name());
    line.push_number(b"\",\"x0\":", Some(executed.from.diameter().0));
    line.push_number(b",\"z0\":", Some(executed.from.z));
    line.push_number(b",\"x\":", Some(executed.to.diameter().0));
    line.push_number(b",\"z\":", Some(executed.to.z));
    line.push_number(
        b",\"cx\":",
        executed.center.map(|center| center.diameter().0),
    );
    line.push_number(b",\"cz\":", executed.center.map(|center| center.z));
    // A thread has a lead instead of a feed.
    let (feed, lead) = match executed.kind.is_thread() {
        true => (None, executed.feed),
        false => (executed.feed, None),
    };
    push_feed(line, feed);
    line.push_number(b",\"lead\":", lead.map(number_of));
    line.push_number(b",\"t\":", Some(executed.start_s));
    line.push_number(b",\"dt\":", Some(executed.duration_s));
    line.push_bytes(b"}\n");
    out.write_all(line.as_bytes())
}

/// Appends a feed and its unit to a line of a move; both are null without feed.
pub(crate) fn push_feed(line: &mut JsonLine, feed: Option<Feed>) {
    line.push_number(b",\"feed\":", feed.map(number_of));
    match feed {
        Some(Feed::PerMinute(_)) => line.push_bytes(b",\"per\":\"min\""),
        Some(Feed::PerRevolution(_)) => line.push_bytes(b",\"per\":\"rev\""),
        None => line.push_bytes(b",\"per\":null"),
    }
}

/// The number of a feed, in mm/min or mm/r.
const fn number_of(feed: Feed) -> f64 {
    match feed {
        Feed::PerMinute(number) | Feed::PerRevolution(number) => number,
    }
}

/// Header line of the CSV file of loads.
pub const LOADS_HEADER: &str = "t,line,tool,force_n,power_kw,torque_nm,edge_mm,thickness_mm,\
    area_mm2,speed_m_per_min,rpm,feed_force_n,radial_force_n,size_error_mm\n";

/// Writes the load of a move: a line of the CSV file for each moment, with its machine time, s.
pub fn write_loads(out: &mut dyn Write, load: &MoveLoad) -> io::Result<()> {
    for cut in &load.loads {
        let time_s = load.start_s + load.duration_s * cut.share;
        let (line, tool) = (load.source.line, load.tool);
        let (force, power, torque) = (cut.force_n, cut.power_kw, cut.torque_nm);
        let (edge, thickness, area) = (
            cut.chip.width_mm,
            cut.chip.thickness_mm(),
            cut.chip.area_mm2,
        );
        let (speed, rpm) = (cut.speed_m_per_min, cut.rpm);
        let (feed, radial, error) = (cut.feed_force_n, cut.radial_force_n, cut.size_error_mm);
        writeln!(
            out,
            "{time_s:.6},{line},{tool},{force:.2},{power:.4},{torque:.3},{edge:.4},{thickness:.4},\
             {area:.5},{speed:.2},{rpm:.1},{feed:.2},{radial:.2},{error:.5}"
        )?;
    }
    Ok(())
}

/// Header line of the CSV file of positions.
pub const POSITIONS_HEADER: &str = "t,x,z,spindle_deg\n";

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
    use gsk_core::command::{MoveConditions, ProgramId, SourcePosition};
    use proptest::prelude::*;

    fn executed(kind: MoveKind) -> ExecutedMove {
        ExecutedMove {
            source: SourcePosition {
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
            conditions: MoveConditions::default(),
        }
    }

    #[test]
    fn a_move_is_one_line_with_diameters() {
        let mut out = Vec::new();
        write_move(
            &mut out,
            &mut JsonLine::default(),
            &executed(MoveKind::Feed),
        )
        .expect("write");
        assert_eq!(
            String::from_utf8(out).expect("text"),
            "{\"line\":12,\"n\":50,\"kind\":\"feed\",\"x0\":50.0,\"z0\":0.0,\"x\":50.0,\"z\":-30.0,\
             \"cx\":null,\"cz\":null,\"feed\":120.0,\"per\":\"min\",\"lead\":null,\"t\":1.5,\"dt\":15.0}\n"
        );
    }

    #[test]
    fn only_motions_of_no_length_are_left_out() {
        let mut still = executed(MoveKind::Feed);
        assert!(is_reported(&still));
        still.to = still.from;
        assert!(!is_reported(&still));
        still.kind = MoveKind::Dwell;
        assert!(is_reported(&still));
        still.kind = MoveKind::Clockwise;
        still.center = Some(Point::default());
        assert!(is_reported(&still), "a full circle ends where it began");
    }

    const SCALES: [f64; 7] = [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e8];

    fn json_line_text(value: f64) -> String {
        let mut line = JsonLine::default();
        line.push_number(b"", Some(value));
        String::from_utf8(line.as_bytes().to_vec()).expect("text")
    }

    fn serde_json_text(value: f64) -> String {
        serde_json::to_string(&round_to_millionth(value)).expect("a number")
    }

    #[test]
    fn numbers_are_written_as_json_writes_them() {
        for value in [
            0.0,
            -0.0,
            1.0,
            -0.25,
            4e-7,
            6e-7,
            -1e-6,
            9e-6,
            1e-5,
            0.1,
            99_999_999.999_999,
            99_999_999.999_999_99,
            1e8,
            999_999_999.999_999,
            1e9,
            123_456_789_012.3,
            1e17,
            1e22,
            -1e300,
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ] {
            assert_eq!(json_line_text(value), serde_json_text(value), "{value}");
        }
        let mut line = JsonLine::default();
        line.push_integer(b"n", u64::MAX);
        line.push_number(b":", None);
        assert_eq!(line.as_bytes(), b"n18446744073709551615:null");
    }

    proptest! {
        #[test]
        fn any_number_is_written_as_json_writes_it(
            (size, scale) in (-1e6..1e6, prop::sample::select(&SCALES[..]))
        ) {
            let value: f64 = size * scale;
            let text = json_line_text(value);
            // With more than fifteen digits two shortest forms may be equally near.
            match value.abs() < 1e9 {
                true => prop_assert_eq!(text, serde_json_text(value)),
                false => prop_assert_eq!(text.parse(), Ok(round_to_millionth(value))),
            }
        }

        #[test]
        fn a_number_that_returns_in_a_line_is_written_again(
            sizes in prop::collection::vec((-40_i32..40, prop::sample::select(&SCALES[..])), 1..200)
        ) {
            let values = sizes.iter().map(|(size, scale)| f64::from(*size) * scale);
            let values: Vec<f64> = values.filter(|value| value.abs() < 1e9).collect();
            let mut line = JsonLine::default();
            let mut expected = String::new();
            for value in values {
                line.push_number(b" ", Some(value));
                expected.push(' ');
                expected.push_str(&serde_json_text(value));
            }
            prop_assert_eq!(String::from_utf8_lossy(line.as_bytes()), expected);
        }

        #[test]
        fn whole_numbers_have_all_their_digits((number, bits) in (any::<u64>(), 0..64_u32)) {
            let mut line = JsonLine::default();
            line.push_integer(b"", number >> bits);
            let text = (number >> bits).to_string();
            prop_assert_eq!(line.as_bytes(), text.as_bytes());
        }
    }
}
