//! GPIO pins by number: inputs, outputs, PWM, and the function of a PIO block.

use embassy_rp::pac;

/// Selects what drives a pin.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
pub enum PinFunction {
    /// A PWM slice drives the pin.
    Pwm = 4,
    /// The processor drives or reads the pin.
    Sio = 5,
    /// The PIO block of the encoders.
    Encoders = 6,
    /// The PIO block of the steps.
    Steps = 7,
}

/// Whether a pin has a pull-up, a pull-down or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pull {
    /// The pin has a pull-up resistor.
    Up,
    /// The pin has a pull-down resistor.
    Down,
    /// The pin has no pull resistor.
    None,
}

/// Connects a pin to its function.
pub fn connect(pin: u32, function: PinFunction, pull: Pull, is_inverted: bool) {
    let pin = pin as usize;
    pac::PADS_BANK0.gpio(pin).write(|pad| {
        pad.set_ie(true);
        pad.set_schmitt(true);
        pad.set_pue(pull == Pull::Up);
        pad.set_pde(pull == Pull::Down);
    });
    pac::IO_BANK0.gpio(pin).ctrl().write(|ctrl| {
        ctrl.set_funcsel(function as u8);
        if is_inverted {
            ctrl.set_outover(pac::io::vals::Outover::INVERT);
        }
    });
}

/// Writes the level of a pin that the processor drives.
pub fn write_level(pin: u32, is_high: bool) {
    let value = pac::SIO.gpio_out(0);
    if is_high {
        value.value_set().write_value(1 << pin);
    } else {
        value.value_clr().write_value(1 << pin);
    }
}

/// Makes a pin an output of the processor with a level.
pub fn set_up_output(pin: u32, is_high: bool) {
    write_level(pin, is_high);
    pac::SIO.gpio_oe(0).value_set().write_value(1 << pin);
    connect(pin, PinFunction::Sio, Pull::None, false);
}

/// Makes a pin an input.
pub fn set_up_input(pin: u32, pulls_up: bool) {
    pac::SIO.gpio_oe(0).value_clr().write_value(1 << pin);
    let pull = if pulls_up { Pull::Up } else { Pull::None };
    connect(pin, PinFunction::Sio, pull, false);
}

/// Returns the levels of all pins, a bit for each.
pub fn levels() -> u32 {
    pac::SIO.gpio_in(0).read()
}

/// The PWM outputs: the count at which each slice begins anew.
#[derive(Clone, Copy, Debug, Default)]
pub struct PwmOutputs {
    tops: [u16; 8],
}

impl PwmOutputs {
    const fn slice(pin: u32) -> usize {
        (pin as usize >> 1) & 7
    }

    /// Makes a pin a PWM output with a period of processor cycles.
    pub fn set_up(&mut self, pin: u32, cycles: u32, value: u32) {
        let slice = Self::slice(pin);
        let divider = (cycles >> 16) + 1;
        self.tops[slice] = (cycles / divider).saturating_sub(1) as u16;
        let channel = pac::PWM.ch(slice);
        channel
            .div()
            .write(|div| div.set_int(divider.min(255) as u8));
        channel.top().write(|top| top.set_top(self.tops[slice]));
        self.write(pin, value);
        channel.csr().modify(|csr| csr.set_en(true));
        connect(pin, PinFunction::Pwm, Pull::None, false);
    }

    /// Writes the value of a PWM output, 0 to `PWM_MAX`.
    pub fn write(&self, pin: u32, value: u32) {
        let slice = Self::slice(pin);
        let most = gsk_motion::messages::PWM_MAX;
        let compare = (u32::from(self.tops[slice]) + 1) * value.min(most) / most;
        pac::PWM.ch(slice).cc().modify(|cc| {
            if pin & 1 == 0 {
                cc.set_a(compare.min(0xFFFF) as u16);
            } else {
                cc.set_b(compare.min(0xFFFF) as u16);
            }
        });
    }
}
