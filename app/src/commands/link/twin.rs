//! `link twin`: simulates a pulse board in real time on a pseudo terminal or a network
//! address.

use crate::commands::CommandError;

use gsk_host::ports::OfferedPort;
use gsk_messages::{Message, say};
use gsk_twins::grbl::{GrblSettings, GrblState, GrblTwin, Variant};
use gsk_twins::klipper::{self, KlipperTwin, SpindleWiring, TravelSwitch};
use gsk_twins::pico::{PicoState, PicoTwin, SpindleEncoderWiring};
use gsk_twins::wire::{Damage, TwinWire};
use web_time::{Duration, Instant};

use super::super::{EXIT_OK, output};
use crate::cli::{LinkTwinArgs, TwinBoard};

/// Number of bytes from the current one on for which losses are scheduled.
const DAMAGE_AHEAD_BYTES: u64 = 4096;

/// Number of encoder pulses per turn of the grblHAL twin's spindle.
const ENCODER_PULSES_PER_TURN: u16 = 1024;

/// Switches of the Klipper twin: pin, axis, first and last pulse, and pulses per turn if the
/// signal comes once per turn. Limit switch, deceleration switch and zero signal of X, then
/// of Z. After its deceleration switch the first zero signal of X comes at 3200, that of Z
/// at 6400.
const SWITCHES: [(&str, usize, i64, i64, Option<i64>); 6] = [
    ("PC0", 0, 4000, i64::MAX, None),
    ("PC4", 0, 1200, 2400, None),
    ("PC5", 0, 0, 31, Some(1600)),
    ("PC1", 1, 8000, i64::MAX, None),
    ("PC6", 1, 2400, 5600, None),
    ("PC7", 1, 0, 31, Some(1600)),
];

/// Wiring and speed of the Klipper twin's simulated spindle.
const SPINDLE: SpindleWiring<'_> = SpindleWiring {
    index_pin: "PC3",
    forward_pin: "PB4",
    reverse_pin: "PB5",
    speed_pin: "PH6",
    full_speed_rpm: 9999.0,
    time_constant_s: 0.2,
};

/// Switches of the Pico twin, as `assets/machines/pico-lathe.ron` wires them: the limit switch of
/// X, the deceleration switches of X and Z.
const PICO_SWITCHES: [(&str, usize, i64, i64); 3] = [
    ("gpio10", 0, 4000, i64::MAX),
    ("gpio12", 0, 1200, 2400),
    ("gpio13", 1, 2400, 5600),
];

/// The simulated spindle of the Pico twin.
const PICO_SPINDLE: SpindleEncoderWiring = SpindleEncoderWiring {
    index_pin: 18,
    direction_pins: Some([15, 19]),
    speed_pin: Some(20),
    counts_per_turn: 4096,
    full_speed_rpm: 9999.0,
    time_constant_s: 0.2,
};

/// Number of ripples of the Pico's spindle in a turn.
const PICO_RIPPLES: f64 = 3.0;

/// A simulated board with one of the firmwares.
enum SimulatedBoard {
    Grbl(Box<GrblTwin>),
    Klipper(Box<KlipperTwin>),
    Pico(Box<PicoTwin>),
}

/// The state of the simulated board; a line is printed whenever it changes.
#[derive(PartialEq)]
struct TwinStatus {
    state: Message,
    reset_count: u32,
    is_stopped: bool,
    pulses: [i64; 2],
}

impl SimulatedBoard {
    fn new(args: &LinkTwinArgs) -> Self {
        let grbl = |variant, settings| {
            let mut board = GrblTwin::new(variant, settings);
            board.spindle_mut().full_speed_rpm = args.spindle_top;
            Self::Grbl(Box::new(board))
        };
        match args.firmware {
            TwinBoard::Grbl => grbl(Variant::Grbl, GrblSettings::default()),
            // A board with a spindle encoder.
            TwinBoard::Grblhal => grbl(
                Variant::GrblHal,
                GrblSettings::with_encoder(ENCODER_PULSES_PER_TURN),
            ),
            // The settings of a board configured from an example.
            TwinBoard::Fluidnc => grbl(Variant::FluidNc, GrblSettings::with_config_tree()),
            TwinBoard::Klipper => {
                let mut board = KlipperTwin::new(klipper::KlipperHardware::default());
                for (pin, axis, from, to, turn) in SWITCHES {
                    let travel = TravelSwitch {
                        stepper: axis,
                        first_pulse: from,
                        last_pulse: to,
                        pulses_per_turn: turn,
                    };
                    board.place_switch(pin, travel);
                }
                board.attach_spindle(SpindleWiring {
                    full_speed_rpm: args.spindle_top,
                    ..SPINDLE
                });
                board.set_speed_ripple(args.ripple, args.ripple_hz);
                Self::Klipper(Box::new(board))
            }
            TwinBoard::Pico => {
                let mut board = PicoTwin::new();
                for (pin, stepper, first_pulse, last_pulse) in PICO_SWITCHES {
                    let travel = TravelSwitch {
                        stepper,
                        first_pulse,
                        last_pulse,
                        pulses_per_turn: None,
                    };
                    board.place_switch(pin, travel);
                }
                board.attach_spindle(SpindleEncoderWiring {
                    full_speed_rpm: args.spindle_top,
                    ..PICO_SPINDLE
                });
                board.set_speed_ripple(args.ripple, PICO_RIPPLES);
                Self::Pico(Box::new(board))
            }
        }
    }

    fn wire(&mut self) -> &mut TwinWire {
        match self {
            Self::Grbl(board) => &mut board.to_board,
            Self::Klipper(board) => &mut board.to_board,
            Self::Pico(board) => &mut board.to_board,
        }
    }

    /// Passes bytes to the board and advances its time to `until_ns`. Returns the bytes that
    /// it answers.
    fn advance_to(&mut self, bytes: &[u8], until_ns: u64) -> Vec<u8> {
        match self {
            Self::Grbl(board) => {
                board.write(bytes);
                board.advance(until_ns.saturating_sub(board.now()));
                board.read()
            }
            Self::Klipper(board) => {
                board.write(bytes);
                board.advance(until_ns.saturating_sub(board.now()));
                board.read()
            }
            Self::Pico(board) => {
                board.write(bytes);
                board.advance(until_ns.saturating_sub(board.now()));
                board.read()
            }
        }
    }

    fn set_index_lost(&mut self, is_lost: bool) {
        match self {
            Self::Grbl(_) => {}
            Self::Klipper(board) => board.set_index_lost(is_lost),
            Self::Pico(board) => board.set_index_lost(is_lost),
        }
    }

    fn status(&self) -> TwinStatus {
        match self {
            Self::Grbl(board) => TwinStatus {
                state: say::as_written(format_args!("{:?}", board.state())),
                reset_count: board.reset_count,
                is_stopped: board.state() == GrblState::Idle,
                pulses: board.pulses(),
            },
            Self::Klipper(board) => TwinStatus {
                state: match board.state() {
                    klipper::KlipperState::Booting => say::link_twin_boots(),
                    klipper::KlipperState::Running => say::link_twin_runs(),
                    klipper::KlipperState::Shutdown(reason) => say::link_twin_shut_down(reason),
                },
                reset_count: 0,
                // At standstill: no pulse for 0.25 s.
                is_stopped: board.now().saturating_sub(board.last_pulse_ns()) > 250_000_000,
                pulses: board.pulses(),
            },
            Self::Pico(board) => TwinStatus {
                state: match board.state() {
                    PicoState::Booting => say::link_twin_boots(),
                    PicoState::Running => say::link_twin_runs(),
                    PicoState::Stopping => say::link_twin_stops(),
                    PicoState::Shutdown(reason) => say::link_twin_shut_down(reason),
                },
                reset_count: 0,
                is_stopped: board.now().saturating_sub(board.last_pulse_ns()) > 250_000_000,
                pulses: board.pulses(),
            },
        }
    }
}

/// The text of the machine file with the wiring of a simulated board.
const fn machine_file(firmware: TwinBoard) -> &'static str {
    match firmware {
        TwinBoard::Grbl | TwinBoard::Grblhal | TwinBoard::Fluidnc => {
            include_str!("../../../../assets/machines/virtual-line.ron")
        }
        TwinBoard::Klipper => include_str!("../../../../assets/machines/virtual-klipper.ron"),
        TwinBoard::Pico => include_str!("../../../../assets/machines/pico-lathe.ron"),
    }
}

/// Simulates a board until Ctrl-C or until the time of `--seconds` has passed. Returns the exit
/// code. Returns an error if the port cannot be offered.
pub fn run_twin(args: &LinkTwinArgs) -> Result<u8, CommandError> {
    if args.print_machine {
        output::print(machine_file(args.firmware));
        return Ok(EXIT_OK);
    }
    let mut port = OfferedPort::open(args.tcp.as_deref())?;
    let mut board = SimulatedBoard::new(args);
    output::print(&format!("{}\n", port.name()?));
    if args.delay_ms > 0 {
        let delay = Damage::Delayed(args.delay_ms * 1_000_000);
        board.wire().damage(0, delay);
    }
    let start = Instant::now();
    let mut next_lost_byte = 0;
    let mut last_status = board.status();
    while args
        .seconds
        .is_none_or(|seconds| start.elapsed() < Duration::from_secs(seconds))
    {
        if let Some(every) = args.lose_every {
            while next_lost_byte < board.wire().sent_count() + DAMAGE_AHEAD_BYTES {
                next_lost_byte += every;
                board.wire().damage(next_lost_byte, Damage::Lost);
            }
        }
        let bytes = port.read().map_err(CommandError::gone)?;
        let elapsed = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        if let Some(after) = args.lose_index {
            board.set_index_lost(start.elapsed() >= Duration::from_secs(after));
        }
        let reply = board.advance_to(&bytes, elapsed);
        port.write(&reply).map_err(CommandError::gone)?;
        let status = board.status();
        let reset = status.reset_count != last_status.reset_count;
        if reset
            || status.state != last_status.state
            || (status.is_stopped && status.pulses != last_status.pulses)
        {
            let time = format!("{:9.3}", elapsed as f64 * 1e-9);
            let (state, [x, z]) = (status.state.clone(), status.pulses);
            output::print_message(&match reset {
                true => say::link_twin_reset(time, state, x, z),
                false => say::link_twin_state(time, state, x, z),
            });
            last_status = status;
        }
    }
    Ok(EXIT_OK)
}
