//! What an ATmega2560 does with its pins: which there are, which give pulses of a
//! width, and what the firmware says to the others.

/// Eight pins a port; there is no port I, and the numbers leave its place out.
pub(super) const PORTS: [(&str, u32); 11] = [
    ("PA", 0),
    ("PB", 8),
    ("PC", 16),
    ("PD", 24),
    ("PE", 32),
    ("PF", 40),
    ("PG", 48),
    ("PH", 56),
    ("PJ", 72),
    ("PK", 80),
    ("PL", 88),
];
/// Pins with pulses of a width, but those of timer 1.
const PWM_PINS: [&str; 13] = [
    "PB7", "PG5", "PB4", "PH6", "PE3", "PE4", "PE5", "PH3", "PH4", "PH5", "PL3", "PL4", "PL5",
];
/// Those of timer 1, which makes the clock of the firmware.
const TIMER_1: [&str; 2] = ["PB5", "PB6"];

/// The number of a pin.
pub(super) fn pin_number(name: &str) -> Option<u32> {
    let (port, bit) = name.split_at_checked(2)?;
    let (_, first) = PORTS.iter().find(|(known, _)| *known == port)?;
    let bit: u32 = bit.parse().ok().filter(|bit| *bit < 8)?;
    Some(first + bit)
}

fn exists(pin: u32) -> bool {
    PORTS
        .iter()
        .any(|(_, first)| (*first..first + 8).contains(&pin))
}

/// An output is set up.
pub(super) fn check_output(pin: u32) -> Result<(), &'static str> {
    if exists(pin) {
        return Ok(());
    }
    Err("Not an output pin")
}

/// An input is set up.
pub(super) fn check_input(pin: u32) -> Result<(), &'static str> {
    if exists(pin) {
        return Ok(());
    }
    Err("Not a valid input pin")
}

/// An output of pulses of a width is set up.
pub(super) fn check_pwm(pin: u32) -> Result<(), &'static str> {
    let among = |names: &[&str]| names.iter().any(|name| pin_number(name) == Some(pin));
    if among(&TIMER_1) {
        return Err("Can not use timer1 for PWM; timer1 is used for timers");
    }
    if among(&PWM_PINS) {
        return Ok(());
    }
    Err("Not a valid PWM pin")
}
