//! The whole machine at one moment, the inputs that change it, and the hash of its state.

use std::io;

use gsk_core::cnc::{ControlRequest, ReceivedData};
use gsk_panel::emulator::{Emulator, EmulatorInput, PortRequest};
use gsk_runner::machining::CollisionFinding;
use serde::{Deserialize, Serialize};

use crate::machine_part::{CutEffect, MachinePart, NamedJob, PartInput};

/// A change of the machine or of its part from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum HistoryInput {
    /// A change of control, panel or lathe.
    Machine(EmulatorInput),
    /// A change of the part or its job.
    Part(PartInput),
}

/// Texts from this length on take long to read again, bytes.
const LONG_TEXT_BYTES: usize = 64 * 1024;

impl HistoryInput {
    /// Returns whether the input takes long to repeat or replaces much of the state. A full
    /// state before it keeps its neighbours quick to reach.
    pub fn is_expensive(&self) -> bool {
        self.text_bytes() >= LONG_TEXT_BYTES
            || matches!(
                self,
                Self::Machine(EmulatorInput::PowerOff) | Self::Part(PartInput::Job(_))
            )
    }

    /// Returns the length of the texts in the input, bytes.
    pub(crate) fn text_bytes(&self) -> usize {
        match self {
            Self::Machine(
                EmulatorInput::Receive(file)
                | EmulatorInput::Port(PortRequest::Receive { file, .. }),
            ) => file.text.len(),
            Self::Machine(EmulatorInput::Request(request)) => match &**request {
                ControlRequest::OpenExternal(program)
                | ControlRequest::StoreEdited { program, .. } => program.text().len(),
                ControlRequest::StoreProgram(text)
                | ControlRequest::StoreReceived(
                    ReceivedData::Program(text) | ReceivedData::Replacement(text),
                ) => text.len(),
                ControlRequest::LoadLadder(ladder) => ladder.source().len(),
                _ => 0,
            },
            Self::Part(PartInput::Job(Some(named)) | PartInput::Tools(named)) => {
                size_of::<NamedJob>() + named.name_bytes()
            }
            Self::Machine(_) | Self::Part(_) => 0,
        }
    }
}

impl NamedJob {
    fn name_bytes(&self) -> usize {
        self.name.as_ref().map_or(0, String::len)
    }
}

/// An input with the tick of the machine before which it acts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedInput {
    /// Ticks of the emulator at the time of the input.
    pub tick: u64,
    /// The applied input.
    pub input: HistoryInput,
}

/// The machine with the part in it at one moment.
#[derive(Clone, Debug)]
pub struct MachineMoment {
    /// State of control, panel and lathe.
    pub emulator: Emulator,
    /// State of the part in the lathe.
    pub part: MachinePart,
}

impl MachineMoment {
    /// Applies a recorded input to the machine.
    pub fn apply(&mut self, input: HistoryInput) {
        match input {
            HistoryInput::Machine(input) => {
                self.emulator.apply(input);
            }
            HistoryInput::Part(input) => self.part.apply(input),
        }
    }

    /// Simulates one millisecond and returns the first collision in it, if any. A collision has
    /// no effect here: the faults that it caused are among the recorded inputs.
    pub fn tick(&mut self) -> Option<CollisionFinding> {
        self.emulator.tick();
        self.part.follow_tick(self.emulator.simulation())
    }

    /// Sets the faults that the last tick causes in the simulated lathe, as the machine in the
    /// window does. `collision` is that of the tick.
    pub fn set_cut_faults(&mut self, collision: Option<&CollisionFinding>) -> CutEffect {
        let effect = (self.part).cut_effect(collision, self.emulator.simulation());
        for fault in effect.faults() {
            self.emulator.set_fault(fault, true);
        }
        effect
    }

    /// Returns the ticks of the emulator.
    pub const fn ticks(&self) -> u64 {
        self.emulator.ticks()
    }
}

/// Start value and factor of FNV-1a with 64 bits.
const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0100_0000_01b3;

/// Adds bytes to a hash by FNV-1a.
#[derive(Debug)]
pub(crate) struct HashWriter(u64);

impl HashWriter {
    pub(crate) const fn new() -> Self {
        Self(FNV_BASIS)
    }

    pub(crate) const fn hash(&self) -> u64 {
        self.0
    }

    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(FNV_PRIME);
        }
    }
}

impl io::Write for HashWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Returns a hash of the whole state of an emulator, the same on every platform; `None` if the
/// state cannot be encoded.
pub fn state_hash(emulator: &Emulator) -> Option<u64> {
    let mut writer = HashWriter::new();
    rmp_serde::encode::write_named(&mut writer, emulator).ok()?;
    Some(writer.hash())
}
