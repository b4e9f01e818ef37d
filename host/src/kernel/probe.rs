//! Takes samples for the scope: one per tick while a scope is open.

use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::plc::address::BitAddress;
use gsk_core::units::{PerAxis, Point};
use gsk_panel::emulator::Emulator;

/// Capacity of the sample queue: one minute of one sample per tick.
pub const MAX_SAMPLES: usize = 60_000;
/// Maximum number of PLC bits in a sample of the scope.
pub const MAX_BITS: usize = 32;

/// A sample of the scope: the machine at the end of one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScopeSample {
    pub tick: u64,
    /// Commanded machine coordinates, mm (X as a radius).
    pub commanded: Point,
    /// Position of the slides, machine coordinates, mm (X as a radius); with a pulse board the
    /// commanded position.
    pub actual: Point,
    /// Following error of the motors, mm (X as a radius); `None` with a pulse board, which cannot
    /// measure it.
    pub following_error: Option<Point>,
    /// Measured spindle speed, r/min; negative in reverse. `None` if a board does not read the
    /// one-turn signal.
    pub spindle_rpm: Option<f64>,
    /// Commanded spindle speed, r/min; 0 while the spindle is off, negative in reverse.
    pub commanded_spindle_rpm: f64,
    /// The watched PLC bits; the first one is in bit 0.
    pub bits: u32,
}

/// Settings of the sampling for the scope. The queue drops its oldest sample when it is full.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The queue into which the kernel puts the samples.
    pub queue: Arc<ArrayQueue<ScopeSample>>,
    /// The watched PLC bits, in the order of [`ScopeSample::bits`]; `None` for an unused bit.
    pub bits: Vec<Option<BitAddress>>,
}

/// The sampling for the scope while it is open.
#[derive(Clone, Debug)]
pub(super) struct ActiveProbe {
    probe: Probe,
    /// The referenced axes, and the machine coordinates of the zero of the simulated lathe, mm,
    /// which change when an axis makes its reference return. `None` before the first sample.
    origin: Option<(PerAxis<bool>, Point)>,
}

impl ActiveProbe {
    pub const fn new(probe: Probe) -> Self {
        Self {
            probe,
            origin: None,
        }
    }

    /// Replaces the watched bits and the queue by those of `probe`.
    pub fn replace_probe(&mut self, probe: Probe) {
        self.probe = probe;
    }

    pub fn take_sample(&mut self, tick: u64, emulator: &Emulator) {
        let cnc = emulator.cnc();
        let lathe = emulator.lathe();
        let real = cnc.has_board();
        let commanded = cnc.position_machine();
        let slides = lathe.slide_position();
        let origin = match self.origin {
            Some((referenced, origin)) if referenced == cnc.referenced_axes() => origin,
            _ => {
                let origin = commanded - slides;
                self.origin = Some((cnc.referenced_axes(), origin));
                origin
            }
        };
        let memory = cnc.plc().memory();
        let bits = self.probe.bits.iter().enumerate().take(MAX_BITS);
        let bits = bits.fold(0, |bits, (place, address)| {
            let state = address.is_some_and(|address| memory.bit(address));
            bits | u32::from(state) << place
        });
        let sample = ScopeSample {
            tick,
            commanded,
            actual: if real { commanded } else { slides + origin },
            following_error: (!real).then(|| lathe.following_error()),
            spindle_rpm: if real {
                cnc.board_spindle_rpm()
            } else {
                Some(lathe.spindle_rpm())
            },
            commanded_spindle_rpm: cnc.spindle_switched(),
            bits,
        };
        self.probe.queue.force_push(sample);
    }
}
