//! Checks that every signal of the table acts where its column `acts` says, and nowhere else.
//!
//! | word | who | checked here by |
//! |---|---|---|
//! | `control` | the control reads G, writes F, X, K, DT | inverting the bit |
//! | `ladder` | the standard ladder reads or writes it | the cross reference |
//! | `engine` | the PLC itself | – |
//! | `free` | unused: it is the machine builder's | – |
//! | `none:` reason | unused, with the reason | – |
//!
//! Text after a semicolon is a remark.

use gsk_core::memory::ControlParameters;
use gsk_core::operation::{FromPlc, Handshake, OperatingMode, Strobe, ToPlc};
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};
use gsk_core::plc::{PlcAddress, PlcMemory};
use gsk_core::setup::standard_ladder;
use gsk_core::units::PerAxis;

const TABLE: &str = include_str!("../../../assets/tables/plc-signals.tsv");

/// Signals that the control reads and writes outside the F and G exchange; each has its case.
const DIRECT: [&str; 10] = [
    "X0.5",  // emergency stop without the ladder
    "X26.0", // RESET key
    "X1.2",  // *STEN, the cycle start enable: alarm 025
    "X0.3",  // deceleration switches of the zero return
    "X1.3", "Y0.7", // 011.4 ZDIL: the axes stand while the brake is on
    "Y1.2", // a spindle that turns already at the start
    "K9",   // the mode at power-on (174)
    "K12",  // the tool at power-on
    "G54.0",
];

fn parse_signal(text: &str) -> PlcAddress {
    match text.parse() {
        Ok(bit) => PlcAddress::Bit(bit),
        Err(_) => PlcAddress::Byte(text.parse().unwrap()),
    }
}

/// Whether a bit of G changes what the control decodes, with any other signals.
fn is_read_by_control(bit: BitAddress) -> bool {
    [0u8, 0x80, 0xff].into_iter().any(|others| {
        let mut memory = PlcMemory::new();
        for byte in 0..=255 {
            memory.set_g(byte, others & if byte == 96 { 0xff } else { 0 });
        }
        let mut seen = [false, true].map(|value| {
            memory.set_bit(bit, value);
            FromPlc::read(&memory)
        });
        // A number of more than one bit: together with its neighbours too.
        let plain = seen[0] != seen[1];
        let byte = memory.g(bit.byte);
        memory.set_g(bit.byte, byte | 0x0f);
        seen = [false, true].map(|value| {
            memory.set_bit(bit, value);
            FromPlc::read(&memory)
        });
        plain || seen[0] != seen[1]
    })
}

/// F as the control writes it, with everything off or on.
fn written_memory(on: bool, mode: OperatingMode) -> PlcMemory {
    let mut parameters = ControlParameters::default();
    for number in [1, 4, 9, 11, 164, 168, 172, 173, 175] {
        for bit in 0..8 {
            let _ = parameters.set_bit(number, bit, on);
        }
    }
    parameters.set(84, if on { 31 } else { 0 }).unwrap();
    let mut handshake = Handshake::default();
    if on {
        for strobe in [Strobe::M, Strobe::S, Strobe::T] {
            handshake.start(strobe, 255);
        }
        for _ in 0..20 {
            handshake.tick(false);
        }
        handshake.s = u32::MAX;
    }
    let axes = PerAxis::new(on, on);
    let mut g = PlcMemory::new();
    for byte in [5, 44, 46] {
        g.set_g(byte, if on { 0xff } else { 0 });
    }
    let mut memory = PlcMemory::new();
    ToPlc {
        mode,
        started: on,
        holding: on,
        operating: on,
        alarm: on,
        reset: on,
        distribution_end: on,
        servo_ready: on,
        rapid: on,
        cutting: on,
        dwelling: on,
        tapping: on,
        decoded: on.then_some([0, 1, 2, 30][mode as usize % 4]),
        handshake: &handshake,
        gear: if on { 4 } else { 1 },
        at_reference: axes,
        referenced: axes,
        at_program_zero: axes,
        moving: axes,
        negative: axes,
        output_key: on,
        sending: on,
        receiving: on,
        receiving_in_background: on,
        stopped_by_override: on,
        board_lags: on,
        soft_switches: if on { 0b11_1110 } else { 0 },
        ready: on,
        spindle_jog: on,
        parameters: &parameters,
    }
    .write(&mut memory, &FromPlc::read(&g));
    // Gears two and three.
    if on {
        memory.set_f(34, 0b1110);
    }
    memory
}

fn is_written_by_control(bit: BitAddress) -> bool {
    let mut seen = OperatingMode::ALL
        .iter()
        .flat_map(|mode| [written_memory(false, *mode), written_memory(true, *mode)])
        .map(|memory| memory.bit(bit));
    let first = seen.next().unwrap();
    // F54 to F59 are the macro variables #1100 to #1133.
    (54..=59).contains(&bit.byte) || seen.any(|value| value != first)
}

/// What acts on a signal, according to the program.
fn find_actors(address: &str) -> Vec<&'static str> {
    let control = match parse_signal(address) {
        PlcAddress::Bit(bit) if bit.area == Area::G => {
            is_read_by_control(bit) || matches!(bit.byte, 54 | 55)
        }
        PlcAddress::Bit(bit) if bit.area == Area::F => is_written_by_control(bit),
        PlcAddress::Bit(bit) => bit.area == Area::A || DIRECT.contains(&address),
        PlcAddress::Byte(ByteAddress { area: Area::Dt, .. }) => true,
        PlcAddress::Byte(_) => DIRECT.contains(&address),
    };
    let used = !standard_ladder()
        .references(parse_signal(address))
        .is_empty();
    let mut actors = Vec::new();
    if control {
        actors.push("control");
    }
    if address.starts_with("R900") {
        actors.push("engine");
    } else if used {
        actors.push("ladder");
    }
    actors
}

#[test]
fn every_signal_acts_where_the_table_says() {
    let mut wrong = Vec::new();
    let mut rows = 0;
    for line in TABLE.lines().skip(1) {
        let cells: Vec<&str> = line.split('\t').collect();
        let (address, acts) = (cells[0], cells.get(6).copied().unwrap_or(""));
        let words: Vec<&str> = match acts {
            "free" => Vec::new(),
            acts if acts.starts_with("none: ") => Vec::new(),
            acts => acts.split(';').next().unwrap().split(' ').collect(),
        };
        let seen = find_actors(address);
        if seen != words || acts.is_empty() {
            wrong.push(format!("{address}\t{}", seen.join(" ")));
        }
        rows += 1;
    }
    assert!(rows > 500, "{rows}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
