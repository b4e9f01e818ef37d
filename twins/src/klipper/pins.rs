//! Pins of an ATmega2560 and the errors of the firmware for wrong pins.

/// Number of the first pin of each port. A port has eight pins; there is no port I, but its
/// numbers are left free.
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
/// Names of the pins with PWM, except those of timer 1.
const PWM_PINS: [&str; 13] = [
    "PB7", "PG5", "PB4", "PH6", "PE3", "PE4", "PE5", "PH3", "PH4", "PH5", "PL3", "PL4", "PL5",
];
/// Names of the pins of timer 1, which drives the clock of the firmware.
const TIMER_1: [&str; 2] = ["PB5", "PB6"];

/// Returns the number of a pin by its name such as `PB5`; `None` for an unknown name.
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

/// Checks that a pin can be an output. Returns the firmware's shutdown reason if it cannot.
pub(super) fn check_output(pin: u32) -> Result<(), &'static str> {
    if exists(pin) {
        return Ok(());
    }
    Err("Not an output pin")
}

/// Checks that a pin can be an input. Returns the firmware's shutdown reason if it cannot.
pub(super) fn check_input(pin: u32) -> Result<(), &'static str> {
    if exists(pin) {
        return Ok(());
    }
    Err("Not a valid input pin")
}

/// Checks that a pin can be a PWM output. Returns the firmware's shutdown reason if it cannot.
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
