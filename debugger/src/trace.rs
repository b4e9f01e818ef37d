//! Writes chosen values of each tick as a trace: CSV, VCD or MCAP.

mod csv;
mod mcap_file;
mod vcd_file;

use std::io::{self, Write};

use gsk_core::simulation::Simulation;
use gsk_messages::{Message, say};

use crate::watch::{WatchTarget, WatchedValue};

/// The values of a trace for which none are chosen: axes, spindle, feed, line.
pub const DEFAULT_SIGNALS: &str = "XM,ZM,X,Z,feed,spindle,angle,line";

/// The file format of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFormat {
    /// A line of text for each tick.
    Csv,
    /// Value changes for GTKWave and PulseView.
    Vcd,
    /// Messages for Foxglove and PlotJuggler, a channel for each value.
    Mcap,
}

impl TraceFormat {
    /// The format by the ending of a file name.
    ///
    /// # Errors
    /// The message that names the file and the endings.
    pub fn from_file_name(name: &str) -> Result<Self, Message> {
        let ending = name.rsplit_once('.').map(|(_, ending)| ending);
        match ending.map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("vcd") => Ok(Self::Vcd),
            Some("mcap") => Ok(Self::Mcap),
            _ => Err(say::debug_trace_format(name)),
        }
    }
}

/// Parses the names of values, separated by commas.
///
/// # Errors
/// The message about the first wrong or repeated name.
pub fn parse_signals(text: &str) -> Result<Vec<WatchTarget>, Message> {
    let mut targets: Vec<WatchTarget> = Vec::new();
    for name in text.split(',') {
        let target = WatchTarget::parse(name)?;
        if targets.iter().any(|other| other.name() == target.name()) {
            return Err(say::debug_signal_twice(target.name()));
        }
        targets.push(target);
    }
    Ok(targets)
}

/// Writes a trace in one format.
trait TraceSink {
    /// Writes the values of a tick, `time_ms` after the begin of the trace.
    fn write_tick(&mut self, time_ms: u64, values: &[WatchedValue]) -> io::Result<()>;
    /// Writes the end of the trace, after the last tick.
    fn finish(&mut self) -> io::Result<()>;
}

/// Writes a trace while a control runs.
pub struct TraceWriter {
    targets: Vec<WatchTarget>,
    sink: Box<dyn TraceSink>,
}

impl TraceWriter {
    /// Writes the head of a trace of `targets`.
    ///
    /// # Errors
    /// The message about a value that the format does not hold, or what the output reports.
    pub fn new(
        format: TraceFormat,
        targets: Vec<WatchTarget>,
        output: Box<dyn Write>,
    ) -> Result<Self, TraceError> {
        let sink: Box<dyn TraceSink> = match format {
            TraceFormat::Csv => Box::new(csv::CsvTrace::new(&targets, output)?),
            TraceFormat::Vcd => {
                if let Some(text) = targets.iter().find(|target| target.is_text()) {
                    return Err(TraceError::TextInBits(text.name().to_owned()));
                }
                Box::new(vcd_file::VcdTrace::new(&targets, output)?)
            }
            TraceFormat::Mcap => Box::new(mcap_file::McapTrace::new(&targets, output)?),
        };
        Ok(Self { targets, sink })
    }

    /// Writes the values after a tick, `time_ms` after the begin of the trace. A value that
    /// cannot be read is null.
    ///
    /// # Errors
    /// What the output reports.
    pub fn write_tick(&mut self, time_ms: u64, simulation: &Simulation) -> io::Result<()> {
        let read = |target: &WatchTarget| target.read(simulation).unwrap_or(WatchedValue::Null);
        let values: Vec<WatchedValue> = self.targets.iter().map(read).collect();
        self.sink.write_tick(time_ms, &values)
    }

    /// Writes the end of the trace.
    ///
    /// # Errors
    /// What the output reports.
    pub fn finish(&mut self) -> io::Result<()> {
        self.sink.finish()
    }
}

/// Why a trace cannot be begun.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum TraceError {
    /// A watched value is this text, which a VCD trace cannot contain.
    TextInBits(String),
    /// The output cannot be written.
    Output(#[from] io::Error),
}

impl TraceError {
    /// The message that explains the error.
    pub fn message(&self) -> Message {
        match self {
            Self::TextInBits(name) => say::debug_trace_bits(name),
            Self::Output(error) => say::as_written(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use gsk_core::setup::Setup;
    use gsk_messages::Language;

    use super::*;

    #[derive(Clone, Default)]
    struct SharedBytes(Arc<Mutex<Vec<u8>>>);

    impl Write for SharedBytes {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().expect("bytes").extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn trace(format: TraceFormat, signals: &str) -> Vec<u8> {
        let bytes = SharedBytes::default();
        let targets = parse_signals(signals).expect("signals");
        let mut writer = TraceWriter::new(format, targets, Box::new(bytes.clone())).expect("head");
        let mut simulation = Simulation::new(Setup::default());
        for time_ms in 0..3 {
            simulation.tick();
            writer.write_tick(time_ms, &simulation).expect("tick");
        }
        writer.finish().expect("end");
        let bytes = bytes.0.lock().expect("bytes");
        bytes.clone()
    }

    #[test]
    fn a_csv_trace_has_a_line_a_tick() {
        let text = String::from_utf8(trace(TraceFormat::Csv, "tick,G,#500,Y1.2")).expect("text");
        assert_eq!(
            text,
            "t,tick,G,#500,Y1.2\n\
             0.000,1,G00 G97 G98 G40,0,0\n\
             0.001,2,G00 G97 G98 G40,0,0\n\
             0.002,3,G00 G97 G98 G40,0,0\n"
        );
    }

    #[test]
    fn a_vcd_trace_has_the_changes_only() {
        let text = String::from_utf8(trace(TraceFormat::Vcd, "tick,Y1.2")).expect("text");
        assert!(text.contains("$timescale 1 ms $end"), "{text}");
        assert!(text.contains("$var wire 1 \" Y1.2 $end"), "{text}");
        assert!(text.contains("#2\nr3 !\n"), "{text}");
        assert_eq!(text.matches("0\"").count(), 1, "{text}");
    }

    #[test]
    fn an_mcap_trace_begins_and_ends_with_its_magic() {
        let bytes = trace(TraceFormat::Mcap, "tick,Y1.2");
        assert!(bytes.starts_with(b"\x89MCAP0\r\n"));
        assert!(bytes.ends_with(b"\x89MCAP0\r\n"));
    }

    #[test]
    fn wrong_names_and_endings_are_refused() {
        let ending = TraceFormat::from_file_name("a.txt").expect_err("ending");
        assert!(ending.text(Language::En).contains("a.txt"));
        let twice = parse_signals("X,X").expect_err("twice");
        assert!(twice.text(Language::En).contains("given twice"));
        let targets = parse_signals("G").expect("signals");
        let bits = TraceWriter::new(TraceFormat::Vcd, targets, Box::new(io::sink()));
        assert!(matches!(bits.err(), Some(TraceError::TextInBits(name)) if name == "G"));
    }
}
