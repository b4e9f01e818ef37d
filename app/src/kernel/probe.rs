//! What the scope sees: one sample a tick, as long as a scope is open.

use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::plc::address::BitAddress;
use gsk_core::units::{PerAxis, Point};
use gsk_panel::emulator::Emulator;

/// Samples that wait for the window at most: a minute.
pub const SAMPLES: usize = 60_000;
/// PLC bits that a sample has room for.
pub const BITS: usize = 32;

/// The machine at the end of one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The tick.
    pub tick: u64,
    /// Commanded machine coordinate, mm (X in radius).
    pub commanded: Point,
    /// Where the slides are in the same coordinates, mm (X in radius); with a pulse
    /// board where its pulses put them.
    pub actual: Point,
    /// How far the motors are behind their pulses, mm (X in radius); none: a pulse
    /// board does not see that.
    pub following: Option<Point>,
    /// Spindle speed, r/min; negative in reverse. None: the board has no index.
    pub spindle: Option<f64>,
    /// Spindle speed that is commanded, r/min; 0 while it is switched off, negative in
    /// reverse.
    pub spindle_commanded: f64,
    /// The watched bits, the first in bit 0.
    pub bits: u32,
}

/// Takes a sample a tick. The queue forgets the oldest when nobody reads.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Where the samples go.
    pub queue: Arc<ArrayQueue<Sample>>,
    /// The watched PLC bits, each in its place in [`Sample::bits`].
    pub bits: Vec<Option<BitAddress>>,
}

/// The probe at work.
#[derive(Clone, Debug)]
pub(super) struct Probing {
    probe: Probe,
    /// Coordinate of the place that the lathe counts from; it changes when an axis
    /// takes its reference.
    origin: Option<(PerAxis<bool>, Point)>,
}

impl Probing {
    pub const fn new(probe: Probe) -> Self {
        Self {
            probe,
            origin: None,
        }
    }

    /// Other bits, or another queue.
    pub fn exchange(&mut self, probe: Probe) {
        self.probe = probe;
    }

    pub fn take(&mut self, tick: u64, emulator: &Emulator) {
        let cnc = &emulator.simulation.cnc;
        let lathe = &emulator.simulation.lathe;
        let real = cnc.has_board();
        let commanded = cnc.position_machine();
        let slides = lathe.slides();
        let origin = match self.origin {
            Some((referenced, origin)) if referenced == cnc.referenced() => origin,
            _ => {
                let origin = commanded - slides;
                self.origin = Some((cnc.referenced(), origin));
                origin
            }
        };
        let memory = cnc.plc().memory();
        let bits = self.probe.bits.iter().enumerate().take(BITS);
        let bits = bits.fold(0, |bits, (place, address)| {
            let state = address.is_some_and(|address| memory.bit(address));
            bits | u32::from(state) << place
        });
        let sample = Sample {
            tick,
            commanded,
            actual: if real { commanded } else { slides + origin },
            following: (!real).then(|| lathe.following_error()),
            spindle: if real {
                cnc.spindle_of_board()
            } else {
                Some(lathe.spindle_rpm())
            },
            spindle_commanded: cnc.spindle_switched(),
            bits,
        };
        self.probe.queue.force_push(sample);
    }
}
