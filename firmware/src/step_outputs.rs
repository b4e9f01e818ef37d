//! Step and direction in the second PIO block: a word for each step, with the direction and the
//! time until the step in ticks. The output makes the pulse and the pause after it.

use embassy_rp::pac;
use embassy_rp::pio::program::pio_asm;

use crate::pins::{self, PinFunction, Pull};

/// Ticks from taking a word to the step, with a delay of 0.
const START_TICKS: u32 = 4;
/// Ticks from the step to taking the next word, besides two pulse times.
const END_TICKS: u32 = 6;
/// Difference between the length of a pulse and its counter, ticks.
const PULSE_TICKS: u32 = 3;
/// Address of the instruction that raises the step signal.
const RAISE: u8 = 4;
/// Processor cycles per tick.
const DIVIDER: u16 = 8;

/// Whether the clock `left` is before `right`.
const fn is_before(left: u32, right: u32) -> bool {
    (left.wrapping_sub(right) as i32) < 0
}

/// The step output of an axis.
#[derive(Clone, Copy, Debug, Default)]
struct StepOutput {
    /// Counter of the pulse length.
    pulse: u32,
    /// Clock from which on the output waits for a word, ticks.
    free_at: u32,
    /// Directions of the last words, the latest in the lowest bit.
    directions: u32,
}

impl StepOutput {
    /// Returns the clock at which an output without words takes the next, ticks.
    #[inline(always)]
    fn next_start(&self, mut clock: impl FnMut() -> u32) -> u32 {
        loop {
            let now = clock();
            if is_before(now.wrapping_add(2), self.free_at) {
                return self.free_at;
            }
            // For two ticks it is unknown whether the output has begun to wait.
            if !is_before(now, self.free_at.wrapping_add(2)) {
                return now.wrapping_add(1);
            }
        }
    }
}

/// The step outputs of both axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepOutputs {
    outputs: [StepOutput; 2],
    take_word: u16,
    wraps: [u8; 2],
}

impl StepOutputs {
    /// Loads the program of the step outputs.
    pub fn load() -> Self {
        let program = pio_asm!(
            ".origin 0",
            ".wrap_target",
            "pull block",
            "out pins, 1",
            "out x, 31",
            "delay:",
            "jmp x--, delay",
            "set pins, 1",
            "mov x, isr",
            "high:",
            "jmp x--, high",
            "set pins, 0",
            "mov x, isr",
            "low:",
            "jmp x--, low",
            ".wrap",
        );
        for (address, code) in program.program.code.iter().enumerate() {
            pac::PIO1
                .instr_mem(address)
                .write(|word| word.set_instr_mem(*code));
        }
        Self {
            outputs: [StepOutput::default(); 2],
            take_word: pio_asm!("jmp 0").program.code[0],
            wraps: [program.program.wrap.target, program.program.wrap.source],
        }
    }

    /// Sets up the output of an axis: the pins of step and direction, and the pulse length.
    pub fn set_up(
        &mut self,
        axis: usize,
        [step, direction]: [u32; 2],
        is_inverted: bool,
        pulse_ticks: u32,
        now: u32,
    ) {
        let block = pac::PIO1;
        let machine = block.sm(axis);
        block
            .ctrl()
            .modify(|ctrl| ctrl.set_sm_enable(ctrl.sm_enable() & !(1 << axis)));
        machine.clkdiv().write(|divider| divider.set_int(DIVIDER));
        machine.execctrl().write(|exec| {
            exec.set_wrap_bottom(self.wraps[0]);
            exec.set_wrap_top(self.wraps[1]);
        });
        machine
            .shiftctrl()
            .write(|shift| shift.set_out_shiftdir(true));
        block.ctrl().modify(|ctrl| {
            ctrl.set_sm_restart(1 << axis);
            ctrl.set_clkdiv_restart(1 << axis);
        });
        let set_low = pio_asm!("set pins, 0").program.code[0];
        let set_output = pio_asm!("set pindirs, 1").program.code[0];
        // Low before the direction of the pin: no pulse at the start.
        for pin in [direction, step] {
            machine.pinctrl().write(|pins| {
                pins.set_set_base(pin as u8);
                pins.set_set_count(1);
            });
            machine.instr().write(|word| word.set_instr(set_low));
            machine.instr().write(|word| word.set_instr(set_output));
        }
        machine.pinctrl().write(|pins| {
            pins.set_set_base(step as u8);
            pins.set_set_count(1);
            pins.set_out_base(direction as u8);
            pins.set_out_count(1);
        });
        pins::connect(step, PinFunction::Steps, Pull::None, is_inverted);
        pins::connect(direction, PinFunction::Steps, Pull::None, false);
        let pulse = pulse_ticks.max(PULSE_TICKS) - PULSE_TICKS;
        block.txf(axis).write_value(pulse);
        for code in [
            pio_asm!("pull block").program.code[0],
            pio_asm!("mov isr, osr").program.code[0],
            self.take_word,
        ] {
            machine.instr().write(|word| word.set_instr(code));
        }
        self.outputs[axis] = StepOutput {
            pulse,
            free_at: now,
            ..StepOutput::default()
        };
        block
            .ctrl()
            .modify(|ctrl| ctrl.set_sm_enable(ctrl.sm_enable() | 1 << axis));
    }

    #[inline(always)]
    fn level(axis: usize) -> u32 {
        (pac::PIO1.flevel().read().0 >> (8 * axis)) & 0x0F
    }

    /// Makes a step at the clock `at`, or as soon as possible after it, if not more than
    /// `waiting` words wait. `clock` reads the clock. Returns whether the step is taken.
    #[inline(always)]
    pub fn try_step(
        &mut self,
        axis: usize,
        is_up: bool,
        at: u32,
        waiting: u32,
        clock: impl FnMut() -> u32,
    ) -> bool {
        let level = Self::level(axis);
        if level > waiting {
            return false;
        }
        let output = &mut self.outputs[axis];
        // A word that waits is taken at the end of those before it.
        let begins = if level > 0 {
            output.free_at
        } else {
            output.next_start(clock)
        };
        let mut soonest = begins.wrapping_add(START_TICKS);
        if u32::from(is_up) != output.directions & 1 {
            // The direction is set up for the time of a pulse before the step.
            soonest = soonest.wrapping_add(output.pulse);
        }
        let edge = if is_before(at, soonest) { soonest } else { at };
        let delay = edge.wrapping_sub(begins).wrapping_sub(START_TICKS);
        pac::PIO1
            .txf(axis)
            .write_value(delay << 1 | u32::from(is_up));
        output.directions = output.directions << 1 | u32::from(is_up);
        output.free_at = edge.wrapping_add(END_TICKS + 2 * output.pulse);
        true
    }

    /// Drops the steps of an axis that are not begun; returns their sum, positive minus negative.
    pub fn cancel(&mut self, axis: usize, now: u32) -> i32 {
        let block = pac::PIO1;
        let machine = block.sm(axis);
        block
            .ctrl()
            .modify(|ctrl| ctrl.set_sm_enable(ctrl.sm_enable() & !(1 << axis)));
        let address = machine.addr().read().addr();
        let is_before_step = (1..=RAISE).contains(&address);
        let dropped = Self::level(axis) + u32::from(is_before_step);
        // Toggling the join of the queues empties them.
        for _ in 0..2 {
            machine
                .shiftctrl()
                .modify(|shift| shift.set_fjoin_rx(!shift.fjoin_rx()));
        }
        if is_before_step {
            machine.instr().write(|word| word.set_instr(self.take_word));
        }
        block
            .ctrl()
            .modify(|ctrl| ctrl.set_sm_enable(ctrl.sm_enable() | 1 << axis));
        let output = &mut self.outputs[axis];
        // A pulse under way ends in this time.
        output.free_at = now.wrapping_add(END_TICKS + 2 * output.pulse);
        (0..dropped)
            .map(|back| {
                if output.directions >> back & 1 != 0 {
                    1
                } else {
                    -1
                }
            })
            .sum()
    }
}
