//! The hardware of a Pico as the engine uses it.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use gsk_motion::StepPort;

use crate::encoders::QuadratureCounters;
use crate::pins::{self, PwmOutputs};
use crate::step_outputs::StepOutputs;

/// Greatest value of the cycle counter.
const CYCLES: u32 = 0x00FF_FFFF;
/// Binary logarithm of the processor cycles per tick.
const TICK_SHIFT: u32 = 3;

/// The clock of the board: the cycle counter of the second processor, extended.
#[derive(Clone, Copy, Debug, Default)]
struct CycleClock {
    last: u32,
    cycles: u64,
}

impl CycleClock {
    #[inline(always)]
    fn ticks(&mut self) -> u64 {
        let current = SYST::get_current();
        self.cycles += u64::from(self.last.wrapping_sub(current) & CYCLES);
        self.last = current;
        self.cycles >> TICK_SHIFT
    }
}

/// The interface to the hardware of the board.
#[derive(Clone, Copy, Debug)]
pub struct BoardPort {
    clock: CycleClock,
    counters: QuadratureCounters,
    steps: StepOutputs,
    pwm: PwmOutputs,
}

impl BoardPort {
    /// Starts the clock and loads the programs of the PIO blocks. The processor that calls the
    /// engine must call this. `embassy_rp::init` has ended the reset of all blocks.
    pub fn start(systick: &mut SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(CYCLES);
        systick.clear_current();
        systick.enable_counter();
        Self {
            clock: CycleClock {
                last: SYST::get_current(),
                cycles: 0,
            },
            counters: QuadratureCounters::load(),
            steps: StepOutputs::load(),
            pwm: PwmOutputs::default(),
        }
    }
}

impl StepPort for BoardPort {
    #[inline(always)]
    fn clock(&mut self) -> u64 {
        self.clock.ticks()
    }

    #[inline(always)]
    fn pins(&mut self) -> u32 {
        pins::levels()
    }

    #[inline(always)]
    fn encoder(&mut self, index: usize) -> i32 {
        self.counters.read(index)
    }

    #[inline(always)]
    fn try_step(&mut self, axis: usize, is_up: bool, at: u32, waiting: u32) -> bool {
        let clock = &mut self.clock;
        let read_clock = || clock.ticks() as u32;
        self.steps.try_step(axis, is_up, at, waiting, read_clock)
    }

    fn cancel_steps(&mut self, axis: usize) -> i32 {
        let now = self.clock.ticks() as u32;
        self.steps.cancel(axis, now)
    }

    fn set_up_stepper(&mut self, axis: usize, pins: [u32; 2], is_inverted: bool, pulse_ticks: u32) {
        let now = self.clock.ticks() as u32;
        self.steps.set_up(axis, pins, is_inverted, pulse_ticks, now);
    }

    fn set_up_input(&mut self, pin: u32, pulls_up: bool) {
        pins::set_up_input(pin, pulls_up);
    }

    fn set_up_output(&mut self, pin: u32, cycle_ticks: u32, value: u32) {
        if cycle_ticks == 0 {
            pins::set_up_output(pin, value != 0);
        } else {
            self.pwm.set_up(pin, cycle_ticks << TICK_SHIFT, value);
        }
    }

    fn set_up_encoder(&mut self, index: usize, pin_a: u32) {
        self.counters.set_up(index, pin_a);
    }

    fn write_output(&mut self, pin: u32, is_pwm: bool, value: u32) {
        if is_pwm {
            self.pwm.write(pin, value);
        } else {
            pins::write_level(pin, value != 0);
        }
    }

    fn restart(&mut self) {
        crate::watchdog::restart();
    }
}
