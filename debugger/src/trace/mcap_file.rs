//! Traces as MCAP: a channel for each value, with JSON messages `{"value": …}`.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions, Writer};

use super::TraceSink;
use crate::watch::{WatchTarget, WatchedValue};

const NS_PER_MS: u64 = 1_000_000;
/// The messages of the trace, for programs that read the schema.
const NUMBER_SCHEMA: &str = r#"{"type":"object","properties":{"value":{"type":"number"}}}"#;
const TEXT_SCHEMA: &str = r#"{"type":"object","properties":{"value":{"type":"string"}}}"#;

pub(super) struct McapTrace {
    writer: Writer<NoSeek<Box<dyn Write>>>,
    channels: Vec<u16>,
    sequence: u32,
}

impl McapTrace {
    pub(super) fn new(targets: &[WatchTarget], output: Box<dyn Write>) -> io::Result<Self> {
        let options = WriteOptions::new()
            .compression(None)
            .library("gsk980td")
            .disable_seeking(true);
        let mut writer = options.create(NoSeek::new(output)).map_err(to_io)?;
        let number = writer
            .add_schema("gsk980td.Number", "jsonschema", NUMBER_SCHEMA.as_bytes())
            .map_err(to_io)?;
        let text = writer
            .add_schema("gsk980td.Text", "jsonschema", TEXT_SCHEMA.as_bytes())
            .map_err(to_io)?;
        let mut channels = Vec::with_capacity(targets.len());
        for target in targets {
            let schema = if target.is_text() { text } else { number };
            let topic = format!("/{}", target.name());
            let channel = writer
                .add_channel(schema, &topic, "json", &BTreeMap::new())
                .map_err(to_io)?;
            channels.push(channel);
        }
        Ok(Self {
            writer,
            channels,
            sequence: 0,
        })
    }
}

impl TraceSink for McapTrace {
    fn write_tick(&mut self, time_ms: u64, values: &[WatchedValue]) -> io::Result<()> {
        let log_time = time_ms * NS_PER_MS;
        for (channel_id, value) in self.channels.iter().zip(values) {
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: self.sequence,
                log_time,
                publish_time: log_time,
            };
            let text = format!("{{\"value\":{}}}", value.to_json());
            self.writer
                .write_to_known_channel(&header, text.as_bytes())
                .map_err(to_io)?;
        }
        self.sequence = self.sequence.wrapping_add(1);
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.writer.finish().map_err(to_io)?;
        Ok(())
    }
}

fn to_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
