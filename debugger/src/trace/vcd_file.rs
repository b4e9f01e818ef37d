//! Traces as VCD: bits as wires, numbers as reals, changes only.

use std::io::{self, BufWriter, Write};

use gsk_core::units::TICK_MS;
use vcd::{IdCode, TimescaleUnit, Value, VarType, Writer};

use super::TraceSink;
use crate::watch::{WatchTarget, WatchedValue};

/// Width of a real number, bits.
const REAL_BITS: u32 = 64;

pub(super) struct VcdTrace {
    writer: Writer<BufWriter<Box<dyn Write>>>,
    signals: Vec<VcdSignal>,
}

struct VcdSignal {
    id: IdCode,
    is_bit: bool,
    /// The value written last; `None` before the first.
    last: Option<WatchedValue>,
}

impl VcdTrace {
    pub(super) fn new(targets: &[WatchTarget], output: Box<dyn Write>) -> io::Result<Self> {
        let mut writer = Writer::new(BufWriter::new(output));
        writer.timescale(TICK_MS, TimescaleUnit::MS)?;
        writer.add_module("gsk980td")?;
        let mut signals = Vec::with_capacity(targets.len());
        for target in targets {
            let (kind, width) = match target.is_bit() {
                true => (VarType::Wire, 1),
                false => (VarType::Real, REAL_BITS),
            };
            // A name of VCD has no blanks.
            let name: String = target.name().split_whitespace().collect();
            signals.push(VcdSignal {
                id: writer.add_var(kind, width, &name, None)?,
                is_bit: target.is_bit(),
                last: None,
            });
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        Ok(Self { writer, signals })
    }
}

impl TraceSink for VcdTrace {
    fn write_tick(&mut self, time_ms: u64, values: &[WatchedValue]) -> io::Result<()> {
        let mut has_time = false;
        for (signal, value) in self.signals.iter_mut().zip(values) {
            if signal.last.as_ref() == Some(value) {
                continue;
            }
            if !has_time {
                self.writer.timestamp(time_ms)?;
                has_time = true;
            }
            match (signal.is_bit, value) {
                (true, WatchedValue::Bit(on)) => {
                    let level = if *on { Value::V1 } else { Value::V0 };
                    self.writer.change_scalar(signal.id, level)?;
                }
                // A variable without a value has none in a trace either.
                (_, value) => {
                    let number = match value {
                        WatchedValue::Null => f64::NAN,
                        value => value.number().unwrap_or(f64::NAN),
                    };
                    self.writer.change_real(signal.id, number)?;
                }
            }
            signal.last = Some(value.clone());
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
