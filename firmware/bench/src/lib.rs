//! The firmware in an emulated RP2040: the host's line, the spindle's encoder, the inputs, and
//! every edge of the step signals.

use std::path::PathBuf;

use gsk_motion::messages::{Command, REASONS, RESPONSES, Response};
use gsk_motion::messages::{FIRST_REASON_ID, command_id, parameter_count, response_id};
use gsk_motion::{crc16, encode_block};
use rp2040_emu::{Config, Emulator, EmulatorBuilder};

/// Processor cycles per second.
pub const CYCLES_PER_S: f64 = 125e6;
/// Processor cycles per tick of the board clock.
pub const CYCLES_PER_TICK: u64 = 8;
/// Cycles of the emulator between two readings of the pins.
const QUANTUM: u32 = 8;
/// Pins of the axes: step and direction.
pub const STEP_PINS: [u32; 2] = [2, 4];
/// Pins of the inputs.
pub const LIMIT_PIN: u32 = 10;
/// Emergency stop.
pub const GUARD_PIN: u32 = 11;
/// Output that enables the drives.
pub const ENABLE_PIN: u32 = 14;
/// Spindle encoder: A, B is the next.
pub const ENCODER_PIN: u32 = 16;
/// Index of the spindle encoder.
pub const INDEX_PIN: u32 = 18;
/// Hash of the configuration.
pub const CRC: i64 = 0x1234_5678;
/// Objects of the configuration.
pub const GROUP: i64 = 2;
/// Limit switch.
pub const LIMIT: i64 = 3;
/// Enable output.
pub const ENABLE: i64 = 4;
/// Spindle encoder.
pub const SPINDLE: i64 = 5;
/// Guard.
pub const GUARD: i64 = 6;

/// A rising edge of a step signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepEdge {
    /// Axis, 0 or 1.
    pub axis: usize,
    /// Whether the direction signal is high.
    pub is_up: bool,
    /// Processor cycle.
    pub cycle: u64,
    /// Count of the spindle.
    pub count: i64,
    /// Cycles since the spindle reached this count.
    pub after_count: u64,
}

/// A reply of the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Which reply.
    pub response: Response,
    /// Its numbers.
    pub values: Vec<u32>,
    /// Processor cycle at which it was read.
    pub cycle: u64,
}

/// The inputs with a level of the test, a bit for each pin.
struct Inputs {
    levels: u32,
    connected: u32,
}

/// The spindle: gives its count at a processor cycle.
type Spindle = Box<dyn FnMut(u64) -> i64>;

/// The board in the emulator.
pub struct Bench {
    emulator: Emulator,
    spindle: Option<Spindle>,
    /// Count of the spindle.
    pub count: i64,
    counts_per_turn: i64,
    /// Length of the index signal, counts; 0 for a lost one.
    pub index_counts: i64,
    /// Count at which the index signal begins: not 0 after the encoder has lost counts.
    pub index_at: i64,
    counted_at: u64,
    inputs: Inputs,
    last_pins: u32,
    /// Step edges so far.
    pub edges: Vec<StepEdge>,
    /// Falling edges of the step signals: axis and cycle.
    pub falls: Vec<(usize, u64)>,
    /// Cycle of the last change of a direction signal.
    pub direction_changes: Vec<(usize, u64)>,
    sequence: u8,
    to_board: std::collections::VecDeque<u8>,
    received: Vec<u8>,
    /// Bytes of the board for another host; `None` if this is the host.
    pub from_board: Option<Vec<u8>>,
    /// Replies so far.
    pub replies: Vec<Reply>,
    /// Renews the lease at this cycle; `None` for a host that does not.
    pub renew_at: Option<u64>,
    clock_offset: i64,
}

/// Returns the path of the firmware: `target/pico/pico.bin`.
pub fn firmware_path() -> PathBuf {
    PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../target/pico/pico.bin"
    ))
}

impl Bench {
    /// Switches the board on and runs it until it reports its start.
    pub fn start() -> Self {
        let path = firmware_path();
        let image =
            std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut emulator = EmulatorBuilder::new(Config::default())
            .step_quantum(QUANTUM)
            .flash(image.clone())
            .build()
            .expect("an emulator");
        emulator.reset();
        emulator.load_flash(&image);
        emulator.direct_boot_from_flash(0x100);
        let mut bench = Self {
            emulator,
            spindle: None,
            count: 0,
            counts_per_turn: 4096,
            index_counts: 1,
            index_at: 0,
            counted_at: 0,
            inputs: Inputs {
                levels: 0,
                connected: 1 << LIMIT_PIN | 1 << GUARD_PIN | 3 << ENCODER_PIN | 1 << INDEX_PIN,
            },
            last_pins: 0,
            edges: Vec::new(),
            falls: Vec::new(),
            direction_changes: Vec::new(),
            sequence: 0,
            to_board: std::collections::VecDeque::new(),
            received: Vec::new(),
            from_board: None,
            replies: Vec::new(),
            renew_at: None,
            clock_offset: 0,
        };
        bench.set_levels();
        bench.run_until(40_000_000, |bench| bench.find(Response::Starting).is_some());
        bench
    }

    /// Resets the processor, as its RUN pin does.
    pub fn press_reset(&mut self) {
        self.emulator.reset();
        self.emulator.direct_boot_from_flash(0x100);
        self.sequence = 0;
        self.received.clear();
        self.to_board.clear();
        self.renew_at = None;
    }

    /// Returns the processor cycle.
    pub fn cycle(&self) -> u64 {
        self.emulator.clock.cycles
    }

    /// Returns the clock of the board, ticks.
    pub fn clock(&self) -> i64 {
        (self.cycle() / CYCLES_PER_TICK) as i64 + self.clock_offset
    }

    /// Sets the counts per turn of the spindle; call it before [`Bench::configure`].
    pub fn set_counts_per_turn(&mut self, counts: i64) {
        self.counts_per_turn = counts;
    }

    /// Sets the spindle: its count at a cycle.
    pub fn set_spindle(&mut self, spindle: impl FnMut(u64) -> i64 + 'static) {
        self.spindle = Some(Box::new(spindle));
    }

    /// Sets the level of an input.
    pub fn set_input(&mut self, pin: u32, is_high: bool) {
        let levels = &mut self.inputs.levels;
        *levels = *levels & !(1 << pin) | u32::from(is_high) << pin;
        self.set_levels();
    }

    /// Connects an input and sets its level.
    pub fn drive_input(&mut self, pin: u32, is_high: bool) {
        self.inputs.connected |= 1 << pin;
        self.set_input(pin, is_high);
    }

    /// Returns the level of a pin.
    pub fn level(&self, pin: u32) -> bool {
        self.last_pins >> pin & 1 != 0
    }

    fn set_levels(&mut self) {
        let phase = [0, 1, 3, 2][self.count.rem_euclid(4) as usize];
        let after_index = (self.count - self.index_at).rem_euclid(self.counts_per_turn);
        let index = u32::from(after_index < self.index_counts);
        let bus = &mut self.emulator.bus;
        bus.external_gpio_in_mask = self.inputs.connected;
        bus.external_gpio_in_override =
            self.inputs.levels | phase << ENCODER_PIN | index << INDEX_PIN;
    }

    /// Runs the board for some cycles.
    pub fn run(&mut self, cycles: u64) {
        let end = self.cycle() + cycles;
        self.run_until(cycles, |bench| bench.cycle() >= end);
    }

    /// Runs the board until a condition holds; returns whether it does within some cycles.
    pub fn run_until(&mut self, cycles: u64, mut condition: impl FnMut(&Self) -> bool) -> bool {
        let end = self.cycle() + cycles;
        let mut looks = 0_u32;
        while self.cycle() < end {
            self.step();
            looks += 1;
            if looks.is_multiple_of(64) {
                self.exchange();
                if condition(self) {
                    return true;
                }
            }
        }
        condition(self)
    }

    fn step(&mut self) {
        if let Some(spindle) = &mut self.spindle {
            let wanted = spindle(self.emulator.clock.cycles);
            if wanted != self.count {
                self.count += (wanted - self.count).signum();
                self.counted_at = self.emulator.clock.cycles;
                self.set_levels();
            }
        }
        let advanced = self.emulator.step().expect("the emulator runs");
        assert!(advanced > 0, "the emulator has stopped");
        let pins = self.emulator.bus.gpio_in;
        let changed = pins ^ self.last_pins;
        self.last_pins = pins;
        if changed == 0 {
            return;
        }
        let cycle = self.emulator.clock.cycles;
        for (axis, step) in STEP_PINS.into_iter().enumerate() {
            if changed >> (step + 1) & 1 != 0 {
                self.direction_changes.push((axis, cycle));
            }
            if changed >> step & 1 == 0 {
                continue;
            }
            if pins >> step & 1 == 0 {
                self.falls.push((axis, cycle));
                continue;
            }
            self.edges.push(StepEdge {
                axis,
                is_up: pins >> (step + 1) & 1 != 0,
                cycle,
                count: self.count,
                after_count: cycle - self.counted_at,
            });
        }
    }

    fn exchange(&mut self) {
        if self.renew_at.is_some_and(|at| at <= self.cycle()) {
            self.renew();
        }
        while let Some(byte) = self.to_board.front() {
            if !self.emulator.bus.inject_uart0_rx(*byte) {
                break;
            }
            self.to_board.pop_front();
        }
        let bytes = self.emulator.drain_uart0_tx_log();
        if let Some(from_board) = &mut self.from_board {
            from_board.extend(bytes);
            return;
        }
        for byte in bytes {
            self.received.push(byte);
            let length = usize::from(self.received[0]);
            if self.received.len() < length {
                continue;
            }
            let block = std::mem::take(&mut self.received);
            let (body, tail) = block.split_at(length - 3);
            assert_eq!(tail[..2], crc16(body).to_be_bytes(), "a damaged block");
            self.take(&body[2..]);
        }
    }

    fn take(&mut self, mut content: &[u8]) {
        while let Some((&id, rest)) = content.split_first() {
            content = rest;
            let known = RESPONSES
                .iter()
                .find(|row| response_id(row.0) == i32::from(id));
            let Some((response, format)) = known else {
                return;
            };
            if *response == Response::Identify {
                return;
            }
            let numbers = (0..parameter_count(format)).map_while(|_| decode(&mut content));
            let values = numbers.collect();
            let cycle = self.cycle();
            self.replies.push(Reply {
                response: *response,
                values,
                cycle,
            });
        }
    }

    /// Sends a command.
    pub fn send(&mut self, command: Command, values: &[i64]) {
        let mut content = Vec::new();
        for value in [i64::from(command_id(command))].iter().chain(values) {
            encode(&mut content, *value);
        }
        self.to_board.extend(encode_block(self.sequence, &content));
        self.sequence = (self.sequence + 1) & 0x0F;
    }

    /// Runs until all that was sent has reached the board.
    pub fn flush(&mut self) {
        self.run_until(50_000_000, |bench| bench.to_board.is_empty());
        self.run(40_000);
    }

    /// Sends the bytes of another host.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.extend(bytes);
    }

    /// Renews the lease for 100 ms, and does so every 40 ms from now on.
    pub fn renew(&mut self) {
        self.renew_at = Some(self.cycle() + 5_000_000);
        let end = (self.clock() + 1_562_500) as u32;
        self.send(Command::RenewLease, &[CRC, end.into()]);
    }

    /// Returns the last reply of a kind.
    pub fn find(&self, response: Response) -> Option<&Reply> {
        self.replies
            .iter()
            .rfind(|reply| reply.response == response)
    }

    /// Returns the text of the reason of a shutdown.
    pub fn shutdown_text(&self) -> Option<&'static str> {
        let id = self.find(Response::Shutdown)?.values[1];
        REASONS.get((id - FIRST_REASON_ID) as usize).copied()
    }

    /// Sends a query and returns the reply.
    pub fn query(&mut self, command: Command, values: &[i64], response: Response) -> Reply {
        let before = self.replies.len();
        self.send(command, values);
        let is_reply = |reply: &&Reply| reply.response == response;
        self.run_until(5_000_000, |bench| {
            bench.replies[before..].iter().any(|reply| is_reply(&reply))
        });
        let reply = self.replies[before..].iter().find(is_reply);
        reply
            .unwrap_or_else(|| panic!("no {response:?}: {:?}", self.replies))
            .clone()
    }

    /// Configures two axes, a stop group, a limit switch, an output, the spindle and a guard, and
    /// learns the clock of the board.
    pub fn configure(&mut self) {
        self.send(Command::AllocateOids, &[7]);
        for (oid, pin) in STEP_PINS.into_iter().enumerate() {
            let pin = i64::from(pin);
            self.send(Command::ConfigStepper, &[oid as i64, pin, pin + 1, 0, 24]);
        }
        self.send(Command::ConfigTrsync, &[GROUP]);
        self.send(Command::ConfigEndstop, &[LIMIT, LIMIT_PIN.into(), 1]);
        self.send(
            Command::ConfigDigitalOut,
            &[ENABLE, ENABLE_PIN.into(), 0, 0, 0],
        );
        let index = i64::from(INDEX_PIN);
        self.send(
            Command::ConfigSpindle,
            &[SPINDLE, ENCODER_PIN.into(), index, self.counts_per_turn],
        );
        self.send(Command::ConfigGuard, &[GUARD, GUARD_PIN.into(), 1, 1, 80]);
        self.send(Command::FinalizeConfig, &[CRC]);
        self.flush();
        self.learn_clock();
    }

    /// Queries the clock of the board.
    pub fn learn_clock(&mut self) {
        let uptime = self.query(Command::GetUptime, &[], Response::Uptime);
        let clock = i64::from(uptime.values[0]) << 32 | i64::from(uptime.values[1]);
        self.clock_offset += clock - self.clock();
    }

    /// Takes up the lease and clears both axes for steps.
    pub fn begin(&mut self) {
        self.renew();
        for axis in 0..2 {
            let clock = self.clock() as u32;
            self.send(Command::ResetStepClock, &[axis, clock.into()]);
        }
        self.flush();
    }

    /// Returns the sum of the step edges of an axis.
    pub fn sum(&self, axis: usize) -> i64 {
        let edges = self.edges.iter().filter(|edge| edge.axis == axis);
        edges.map(|edge| if edge.is_up { 1 } else { -1 }).sum()
    }

    /// Queries the position of an axis.
    pub fn query_position(&mut self, axis: i64) -> i64 {
        let reply = self.query(
            Command::StepperGetPosition,
            &[axis],
            Response::StepperPosition,
        );
        assert_eq!(i64::from(reply.values[0]), axis);
        i64::from(reply.values[1] as i32)
    }
}

fn encode(out: &mut Vec<u8>, value: i64) {
    for bytes in (2_u32..=5).rev() {
        let least = -(1_i64 << (7 * bytes - 9));
        if value < least || value >= -3 * least {
            out.push(0x80 | (value >> (7 * (bytes - 1)) & 0x7F) as u8);
        }
    }
    out.push((value & 0x7F) as u8);
}

fn decode(bytes: &mut &[u8]) -> Option<u32> {
    let (&first, rest) = bytes.split_first()?;
    *bytes = rest;
    let mut value = u32::from(first & 0x7F);
    if first & 0x60 == 0x60 {
        value |= !0x1F;
    }
    let mut last = first;
    while last & 0x80 != 0 {
        let (&next, rest) = bytes.split_first()?;
        *bytes = rest;
        value = value << 7 | u32::from(next & 0x7F);
        last = next;
    }
    Some(value)
}
