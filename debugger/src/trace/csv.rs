//! Traces as CSV: time in seconds, then the values of each tick.

use std::io::{self, Write};

use super::TraceSink;
use crate::watch::{WatchTarget, WatchedValue};

pub(super) struct CsvTrace {
    output: Box<dyn Write>,
}

impl CsvTrace {
    pub(super) fn new(targets: &[WatchTarget], mut output: Box<dyn Write>) -> io::Result<Self> {
        output.write_all(b"t")?;
        for target in targets {
            write!(output, ",{}", quote(target.name()))?;
        }
        output.write_all(b"\n")?;
        Ok(Self { output })
    }
}

/// Returns a name in CSV form: in quotation marks if it contains a comma or a quotation mark.
fn quote(name: &str) -> String {
    if name.contains([',', '"']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

impl TraceSink for CsvTrace {
    fn write_tick(&mut self, time_ms: u64, values: &[WatchedValue]) -> io::Result<()> {
        write!(self.output, "{}.{:03}", time_ms / 1000, time_ms % 1000)?;
        for value in values {
            match value {
                WatchedValue::Null => self.output.write_all(b",")?,
                value => write!(self.output, ",{value}")?,
            }
        }
        self.output.write_all(b"\n")
    }

    fn finish(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
