//! Writes the record as a table for spreadsheets.

use std::fmt::Write as _;

use super::BitChannel;
use super::record::SampleRecord;
use super::trace::TRACES;

/// Formats the traces and bits from the first to the last tick as CSV, one line per
/// millisecond. X lengths are radii. A field is empty where a trace has no value.
pub fn format_table(
    record: &SampleRecord,
    bits: &[BitChannel],
    ticks: (u64, u64),
    average_ticks: u64,
) -> String {
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
        let Some(sample) = record.sample_at(tick) else {
            continue;
        };
        let _ = write!(text, "{:.3}", (tick - ticks.0) as f64 / 1000.0);
        for trace in &TRACES {
            text.push(',');
            if let Some(value) = record.trace_value(trace, tick, average_ticks) {
                let decimals = trace.quantity.decimals() + 1;
                // Adding 0.0 removes the sign of a negative zero.
                let _ = write!(text, "{:.decimals$}", value + 0.0);
            }
        }
        for bit in bits {
            let _ = write!(text, ",{}", sample.bits >> bit.bit_index & 1);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::units::Point;
    use gsk_host::kernel::probe::ScopeSample;

    #[test]
    fn each_tick_is_a_line_and_missing_values_are_empty() {
        let queue = SampleRecord::new();
        for tick in 11..=13 {
            let z = tick as f64 * 0.05;
            queue.queue().force_push(ScopeSample {
                tick,
                commanded: Point::new(1.0, z),
                actual: Point::new(1.0, z - 0.01),
                bits: 2,
                ..ScopeSample::default()
            });
        }
        let mut record = queue;
        assert_eq!(record.take_samples(), 3);
        let bits = [BitChannel {
            address: "F0.5".parse().unwrap(),
            bit_index: 1,
        }];
        let table = format_table(&record, &bits, (11, 13), 1);
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
