//! Writes the record as a table for spreadsheets.

use std::fmt::Write as _;

use super::BitChannel;
use super::record::Record;
use super::trace::TRACES;

/// The traces and bits from the first to the last tick, a line a millisecond. X lengths are
/// radii. A field is empty where a trace has no value.
pub fn table(record: &Record, bits: &[BitChannel], ticks: (u64, u64), over: u64) -> String {
    let mut text = String::from("t_s");
    for trace in &TRACES {
        text.push(',');
        text.push_str(trace.id);
    }
    for bit in bits {
        let _ = write!(text, ",{}", bit.address);
    }
    text.push('\n');
    for tick in ticks.0..=ticks.1 {
        let Some(sample) = record.at(tick) else {
            continue;
        };
        let _ = write!(text, "{:.3}", (tick - ticks.0) as f64 / 1000.0);
        for trace in &TRACES {
            text.push(',');
            if let Some(value) = record.value(trace, tick, over) {
                let decimals = trace.quantity.decimals() + 1;
                // Adding 0.0 removes the sign of a negative zero.
                let _ = write!(text, "{:.decimals$}", value + 0.0);
            }
        }
        for bit in bits {
            let _ = write!(text, ",{}", sample.bits >> bit.place & 1);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::probe::Sample;
    use gsk_core::units::Point;

    #[test]
    fn a_line_a_tick_and_empty_fields_where_nothing_can_be_said() {
        let queue = Record::new();
        for tick in 11..=13 {
            let z = tick as f64 * 0.05;
            queue.queue().force_push(Sample {
                tick,
                commanded: Point::new(1.0, z),
                actual: Point::new(1.0, z - 0.01),
                bits: 2,
                ..Sample::default()
            });
        }
        let mut record = queue;
        assert_eq!(record.take(), 3);
        let bits = [BitChannel {
            address: "F0.5".parse().unwrap(),
            place: 1,
        }];
        let table = table(&record, &bits, (11, 13), 1);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(lines[0].starts_with("t_s,x_command_mm,z_command_mm,x_mm"));
        assert!(lines[0].ends_with(",s_rpm,F0000.5"));
        // There is neither speed nor acceleration before the first sample.
        assert!(lines[1].starts_with("0.000,1.0000,0.5500,1.0000,0.5400,,,,,,,,"));
        let columns: Vec<&str> = lines[3].split(',').collect();
        let heading = lines[0].split(',').position(|name| name == "vz_mm_min");
        assert_eq!(columns[heading.unwrap()], "3000.00");
        assert_eq!(columns.last(), Some(&"1"));
    }
}
