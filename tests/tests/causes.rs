//! Checks that nothing moves without a cause. Keys are pressed at random and inputs fail at
//! random. An observer knows the wires and the manual, but nothing of the control's inside.
//! For every pulse and every output that switches on it finds the cause that the manual
//! gives.
//!
//! | What | Cause (manual) |
//! |---|---|
//! | pulse of an axis | a program runs (III-5); or its direction key is down in 手动 (III-4.1); or a press in 单步, for at most one increment (III-6.1); or graduations of the wheel in 手轮 with the axis selected, for one increment each (III-6.2); or a press in a zero mode, until reset, another mode or the zero (III-7); each with its braking distance |
//! | no pulse at all | emergency-stop loop open (III-2.4), machine lock (III-5.3) |
//! | a program runs | 运行 released in 自动 or 录入 (III-5.1) |
//! | M03, M04 | 正转, 反转 in a manual mode (III-4.2), or the M function |
//! | M08, M32 | 冷却, 润滑, or the M function |
//! | TL+, TL- | a T function in progress; 换刀 makes one (II-2.8.2) |
//! | brake | the spindle was switched off (II-2.8.4) |
//! | chuck, tailstock | their M function or input (II-2.8.10) |
//! | gears | M41 to M44 (II-2.8.6) |
//! | spindle gains speed | M03 or M04 is on |
//!
//! `CAUSES_PRESSES=100000` runs the full number of presses; a tenth without it.

use gsk_core::machine::LatheFault;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_core::units::{Axis, PerAxis};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::{KEYS, Key, KeyRole};

/// Number of presses in one run of an emulator.
const PRESSES_PER_RUN: u32 = 200;
/// The longest braking time: rapid with 024, 025, ms.
const MAX_BRAKING_MS: u64 = 500;
/// Seeds that once found a fault.
const REGRESSION_SEEDS: [u64; 2] = [218, 492];
/// Time from a contact to an output through the ladder, ms: filter, slots of level 2, and the
/// output itself.
const LADDER_DELAY_MS: u64 = 120;
/// Time from a contact to an output of the control itself, ms.
const DIRECT_DELAY_MS: u64 = 24;
/// Pulses of the largest increment of a key, 0.1 mm on the display: X counts
/// diameter in pulses of 0.0005 mm of radius, Z has pulses of 0.001 mm.
const INCREMENT: i64 = 100;

/// A program with most functions of a program.
const PROGRAM: &str = "O0001;\nT0101;\nM03 S500;\nM08;\nG00 U-20 W-30;\nG98 G01 U-4 W-6 F800;\n\
    G04 X1;\nM32;\nG02 U4 W-2 R2;\nM05;\nT0202;\nM04 S300;\nG00 U20 W38;\nM09;\nM33;\nM00;\n\
    M41;\nG01 W-5 F300;\nG00 W5;\nM05;\nM99;\n";

/// Key sequences of an operator: random keys alone rarely start anything.
const PHRASES: [&[Key]; 7] = [
    &[Key::Auto, Key::CycleStart],
    &[Key::Reset, Key::Auto, Key::CycleStart],
    &[Key::Jog, Key::Rapid, Key::XUp],
    &[Key::Jog, Key::ZLeft],
    &[Key::Handwheel, Key::Increment100, Key::WheelZ, Key::ZRight],
    &[Key::Handwheel, Key::Increment100, Key::WheelX, Key::XUp],
    &[Key::Jog, Key::SpindleForward, Key::ToolChange],
];

/// A generator of random numbers.
struct CauseRandom(u64);

impl CauseRandom {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }
}

const fn input_bit(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

const fn output_bit(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::Y, byte, bit)
}

/// An output, the key that may switch it on (and whether only in manual modes), and the M
/// functions that may.
const BY_KEY_OR_M: [(&str, BitAddress, BitAddress, bool, &[u8]); 4] = [
    ("M03", output_bit(1, 2), input_bit(23, 3), true, &[3]),
    ("M04", output_bit(0, 4), input_bit(23, 7), true, &[4]),
    ("M08", output_bit(0, 3), input_bit(23, 4), false, &[8]),
    ("M32", output_bit(1, 1), input_bit(23, 6), true, &[32]),
];
/// Outputs that follow an input or an M function.
const BY_INPUT_OR_M: [(&str, BitAddress, BitAddress, &[u8]); 4] = [
    ("chuck", output_bit(0, 6), input_bit(0, 6), &[12, 13]),
    ("chuck", output_bit(1, 5), input_bit(0, 6), &[12, 13]),
    ("tailstock", output_bit(0, 2), input_bit(0, 2), &[10, 11]),
    ("tailstock", output_bit(1, 4), input_bit(0, 2), &[10, 11]),
];
const GEARS: [BitAddress; 4] = [
    output_bit(1, 0),
    output_bit(0, 0),
    output_bit(0, 1),
    output_bit(1, 3),
];
const TURRET: [BitAddress; 2] = [output_bit(1, 6), output_bit(1, 7)];
const BRAKE: BitAddress = output_bit(0, 7);
/// The direction keys of each axis; 175 selects which one is +.
const DIRECTIONS: PerAxis<[BitAddress; 2]> = PerAxis::new(
    [input_bit(22, 3), input_bit(23, 1)],
    [input_bit(22, 5), input_bit(22, 7)],
);
const CYCLE_START: BitAddress = input_bit(25, 0);

/// The last time of an event; `None` if it never happened.
#[derive(Clone, Copy, Default)]
struct LastTime(Option<u64>);

impl LastTime {
    fn note(&mut self, now: u64, holds: bool) {
        if holds {
            self.0 = Some(now);
        }
    }

    fn is_within(self, now: u64, time: u64) -> bool {
        self.0.is_some_and(|at| now <= at + time)
    }
}

/// The memory of the observer.
struct Observer {
    now: u64,
    y: [u8; 20],
    keys: [u8; 30],
    pulses: PerAxis<i64>,
    rpm: f64,
    running: bool,
    mode: OperatingMode,
    ran: LastTime,
    jogged: PerAxis<LastTime>,
    returned: PerAxis<LastTime>,
    /// A press in a zero mode whose return has not ended.
    returning: PerAxis<bool>,
    /// Pulses of steps and graduations that are not used up yet.
    credit: PerAxis<i64>,
    /// Whether the mode is step or handwheel.
    by_hand: LastTime,
    start_let_go: LastTime,
    loop_closed: LastTime,
    unlocked: LastTime,
    spindle_on: LastTime,
    tool: LastTime,
    /// The last time each key of the panel was down, and each M function was on.
    down: [[LastTime; 8]; 30],
    m: [LastTime; 100],
    manual: LastTime,
    seen: ExplainedEvents,
}

/// The explained events: ticks with pulses by their cause, outputs.
#[derive(Clone, Copy, Debug, Default)]
struct ExplainedEvents {
    by_program: u64,
    by_key: u64,
    by_return: u64,
    by_step: u64,
    rises: u64,
}

impl ExplainedEvents {
    const fn add(self, other: Self) -> Self {
        Self {
            by_program: self.by_program + other.by_program,
            by_key: self.by_key + other.by_key,
            by_return: self.by_return + other.by_return,
            by_step: self.by_step + other.by_step,
            rises: self.rises + other.rises,
        }
    }
}

impl Observer {
    fn new(emulator: &Emulator) -> Self {
        let cnc = emulator.cnc();
        let pulses = cnc.pulses();
        Self {
            now: 0,
            y: [0; 20],
            keys: [0; 30],
            pulses: PerAxis::new(pulses.x.0, pulses.z.0),
            rpm: 0.0,
            running: false,
            mode: cnc.mode(),
            ran: LastTime::default(),
            jogged: PerAxis::default(),
            returned: PerAxis::default(),
            returning: PerAxis::default(),
            credit: PerAxis::default(),
            by_hand: LastTime::default(),
            start_let_go: LastTime::default(),
            loop_closed: LastTime::default(),
            unlocked: LastTime::default(),
            spindle_on: LastTime::default(),
            tool: LastTime::default(),
            down: [[LastTime::default(); 8]; 30],
            m: [LastTime::default(); 100],
            manual: LastTime::default(),
            seen: ExplainedEvents::default(),
        }
    }

    /// The wheel was turned.
    fn wheel(&mut self, emulator: &Emulator, graduations: i32) {
        let memory = emulator.cnc().plc().memory();
        let axis = match memory.g(18) & 0b11 {
            1 => Axis::X,
            2 => Axis::Z,
            _ => return,
        };
        if emulator.cnc().mode() == OperatingMode::Handwheel {
            *self.credit.get_mut(axis) += i64::from(graduations.abs()) * INCREMENT;
        }
    }

    /// Checks the machine after a tick; the error names the event without a cause.
    fn check_tick(&mut self, emulator: &Emulator) -> Result<(), String> {
        self.now += 1;
        let now = self.now;
        let cnc = emulator.cnc();
        let memory = cnc.plc().memory();
        let contact = |at: BitAddress| memory.x(at.byte) >> at.bit & 1 == 1;
        let was = |keys: &[u8; 30], at: BitAddress| keys[usize::from(at.byte)] >> at.bit & 1 == 1;
        let mode = cnc.mode();

        self.manual.note(
            now,
            !matches!(
                mode,
                OperatingMode::Edit | OperatingMode::Auto | OperatingMode::Mdi
            ),
        );
        for (byte, bits) in self.down.iter_mut().enumerate() {
            let contacts = memory.x(byte as u16);
            if contacts != 0 {
                for (bit, last) in bits.iter_mut().enumerate() {
                    last.note(now, contacts >> bit & 1 == 1);
                }
            }
        }
        if let Some(last) = self.m.get_mut(usize::from(memory.f(10))) {
            last.note(now, memory.f(7) & 1 != 0);
        }
        self.tool.note(now, memory.f(7) & 0b1000 != 0);
        self.loop_closed.note(now, contact(input_bit(0, 5)));
        self.unlocked.note(now, memory.g(44) & 0b10 == 0);
        let powered = emulator.panel().powered();
        let let_go = was(&self.keys, CYCLE_START) && !contact(CYCLE_START);
        self.start_let_go.note(now, let_go);

        // A program runs.
        let running = powered && cnc.run_state() == RunState::Run;
        if running && !self.running {
            let may = self.start_let_go.is_within(now, DIRECT_DELAY_MS) && mode.runs_programs();
            require(may, || format!("a program runs in {mode:?}"))?;
        }
        self.running = running;
        self.ran.note(now, running);

        // Pulses.
        let by_hand = matches!(mode, OperatingMode::Step | OperatingMode::Handwheel);
        self.by_hand.note(now, by_hand);
        let reset = memory.f(1) & 0b10 != 0;
        let pulses = cnc.pulses();
        for (axis, count) in [(Axis::X, pulses.x.0), (Axis::Z, pulses.z.0)] {
            let keys = DIRECTIONS.get(axis);
            let held = keys.iter().any(|key| contact(*key));
            let pressed = keys
                .iter()
                .any(|key| contact(*key) && !was(&self.keys, *key));
            self.jogged
                .get_mut(axis)
                .note(now, held && mode == OperatingMode::Jog);
            let zero = matches!(
                mode,
                OperatingMode::MachineZero | OperatingMode::ProgramZero
            );
            let returning = self.returning.get_mut(axis);
            *returning = (*returning || held) && zero && mode == self.mode && !reset;
            let goes = *returning;
            self.returned.get_mut(axis).note(now, goes);
            if pressed && mode == OperatingMode::Step {
                *self.credit.get_mut(axis) += INCREMENT;
            }
            let before = core::mem::replace(self.pulses.get_mut(axis), count);
            let way = (count - before).abs();
            if way == 0 {
                continue;
            }
            let loop_closed = self.loop_closed.is_within(now, DIRECT_DELAY_MS);
            require(loop_closed && powered, || {
                format!("{axis:?} moves with the emergency-stop loop open")
            })?;
            require(self.unlocked.is_within(now, DIRECT_DELAY_MS), || {
                format!("{axis:?} moves under machine lock")
            })?;
            let by_program = self.ran.is_within(now, MAX_BRAKING_MS);
            let by_key = self
                .jogged
                .get(axis)
                .is_within(now, MAX_BRAKING_MS + LADDER_DELAY_MS);
            let by_return = self
                .returned
                .get(axis)
                .is_within(now, MAX_BRAKING_MS + LADDER_DELAY_MS);
            self.seen.by_program += u64::from(by_program);
            self.seen.by_key += u64::from(by_key && !by_program);
            self.seen.by_return += u64::from(by_return && !by_program && !by_key);
            if by_program || by_key || by_return {
                continue;
            }
            self.seen.by_step += 1;
            // Steps and the wheel: in their mode, and no farther than requested.
            let credit = self.credit.get_mut(axis);
            *credit -= way;
            let by_step = self.by_hand.is_within(now, MAX_BRAKING_MS);
            require(by_step && *self.credit.get(axis) >= 0, || {
                format!(
                    "{axis:?} moves by {way} in {mode:?} (left {})",
                    self.credit.get(axis)
                )
            })?;
        }
        if !self.by_hand.is_within(now, MAX_BRAKING_MS) {
            self.credit = PerAxis::default();
        }

        // Outputs.
        let new_y: [u8; 20] = core::array::from_fn(|byte| memory.y(byte as u16));
        let on = |at: BitAddress| new_y[usize::from(at.byte)] >> at.bit & 1 == 1;
        let rises = |at: BitAddress| on(at) && self.y[usize::from(at.byte)] >> at.bit & 1 == 0;
        let by_m = |codes: &[u8]| {
            codes
                .iter()
                .any(|code| self.m[usize::from(*code)].is_within(now, LADDER_DELAY_MS))
        };
        let touched = |at: BitAddress| {
            self.down[usize::from(at.byte)][usize::from(at.bit)].is_within(now, LADDER_DELAY_MS)
        };
        for (name, output, key, in_manual, codes) in BY_KEY_OR_M {
            let by_key =
                touched(key) && (!in_manual || self.manual.is_within(now, LADDER_DELAY_MS));
            require(!rises(output) || by_key || by_m(codes), || {
                format!("{name} rises in {mode:?}")
            })?;
        }
        for (name, output, input, codes) in BY_INPUT_OR_M {
            require(!rises(output) || touched(input) || by_m(codes), || {
                format!("{name} rises in {mode:?}")
            })?;
        }
        for output in GEARS {
            require(!rises(output) || by_m(&[41, 42, 43, 44]), || {
                "a gear output rises".to_owned()
            })?;
        }
        for output in TURRET {
            require(
                !rises(output) || self.tool.is_within(now, LADDER_DELAY_MS),
                || "the turret turns without a T function".to_owned(),
            )?;
        }
        let spindle = on(output_bit(1, 2)) || on(output_bit(0, 4));
        require(!rises(BRAKE) || self.spindle_on.is_within(now, 200), || {
            "the brake closes on a spindle that was off".to_owned()
        })?;
        for output in [
            output_bit(1, 2),
            output_bit(0, 4),
            output_bit(0, 3),
            output_bit(1, 1),
            TURRET[0],
            BRAKE,
        ] {
            self.seen.rises += u64::from(rises(output));
        }
        self.spindle_on.note(now, spindle);
        let rpm = emulator.lathe().spindle_rpm().abs();
        let gains = rpm > self.rpm + 1e-9;
        require(
            !gains || self.spindle_on.is_within(now, DIRECT_DELAY_MS),
            || format!("the spindle gains speed: {rpm} r/min"),
        )?;
        self.rpm = rpm;
        self.y = new_y;
        for (byte, keys) in self.keys.iter_mut().enumerate() {
            *keys = memory.x(byte as u16);
        }
        self.mode = mode;
        Ok(())
    }
}

fn require(may: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if may { Ok(()) } else { Err(what()) }
}

/// A random key: mostly of the machine panel, rarely the emergency button.
fn random_key(dice: &mut CauseRandom) -> Key {
    loop {
        let row = &KEYS[dice.below(KEYS.len() as u64) as usize];
        let take = match row.role {
            KeyRole::Machine(_) | KeyRole::OvertravelRelease => true,
            KeyRole::EmergencyStop => dice.one_in(3),
            _ => dice.one_in(4),
        };
        if take {
            return row.key;
        }
    }
}

/// Runs one emulator. The error lists the actions for a failure report.
fn run_random_keys(seed: u64) -> Result<ExplainedEvents, String> {
    let mut dice = CauseRandom(seed);
    let mut setup = Setup::delivered();
    for (number, bit) in [
        (1, 3),
        (11, 2),
        (7, 0),
        (7, 1),
        (14, 0),
        (12, 7),
        (175, 0),
        (175, 1),
    ] {
        let value = if number == 14 {
            !dice.one_in(4)
        } else {
            dice.one_in(2)
        };
        setup
            .memory
            .parameters
            .set_bit(number, bit, value)
            .map_err(|error| format!("{error:?}"))?;
    }
    let mut emulator = Emulator::new(setup);
    emulator
        .load_program("O0001", PROGRAM)
        .map_err(|alarm| format!("{alarm:?}"))?;
    let mut observer = Observer::new(&emulator);
    let mut done: Vec<String> = Vec::new();
    let mut held: Vec<(Key, u64)> = Vec::new();
    let pass = |emulator: &mut Emulator,
                observer: &mut Observer,
                held: &mut Vec<(Key, u64)>,
                ticks: u64| {
        for _ in 0..ticks {
            held.retain(|(key, until)| {
                let keep = observer.now < *until;
                if !keep {
                    emulator.key_up(*key);
                }
                keep
            });
            emulator.tick();
            observer.check_tick(emulator)?;
        }
        Ok(())
    };
    let mut outcome = pass(&mut emulator, &mut observer, &mut held, 3300);
    for _ in 0..PRESSES_PER_RUN {
        match dice.below(12) {
            0 | 3 => {
                let turn = dice.below(80) as i32 - 40;
                done.push(format!("{}: turn {turn}", observer.now));
                emulator.turn(turn);
                observer.wheel(&emulator, turn);
            }
            1 if dice.one_in(3) => {
                // An input that fails, or one that is repaired.
                let at = input_bit(dice.below(2) as u16, dice.below(8) as u8);
                let state = (!dice.one_in(3)).then(|| dice.one_in(2));
                // The emergency-stop loop itself fails rarely, or nothing else would happen.
                let state = if at == input_bit(0, 5) && !dice.one_in(4) {
                    None
                } else {
                    state
                };
                done.push(format!("{}: input {at:?} {state:?}", observer.now));
                emulator.force_input(at, state);
            }
            2 if dice.one_in(4) => {
                let (name, fault) =
                    LatheFault::ALL[dice.below(LatheFault::ALL.len() as u64) as usize];
                let on = dice.one_in(4);
                done.push(format!("{}: fault {name} {on}", observer.now));
                emulator.set_fault(fault, on);
            }
            4 => {
                let phrase = PHRASES[dice.below(PHRASES.len() as u64) as usize];
                for key in phrase {
                    if outcome.is_err() || held.iter().any(|(other, _)| other == key) {
                        break;
                    }
                    done.push(format!("{}: {} on purpose", observer.now, key.id()));
                    emulator.key_down(*key);
                    held.push((*key, observer.now + 60));
                    outcome = pass(&mut emulator, &mut observer, &mut held, 120);
                }
            }
            _ => {}
        }
        if outcome.is_err() {
            break;
        }
        // Faults that stop the machine for good would end the test early. So the button is
        // released and RESET is pressed more often than by chance.
        let key = if emulator.panel().emergency_stop() && dice.one_in(2) {
            Key::EmergencyStop
        } else if !emulator.cnc().alarms().is_empty() && dice.one_in(4) {
            Key::Reset
        } else {
            random_key(&mut dice)
        };
        if held.iter().all(|(other, _)| *other != key) {
            let long = if dice.one_in(12) { 4000 } else { 300 };
            let time = 5 + dice.below(long);
            done.push(format!("{}: {} for {time}", observer.now, key.id()));
            emulator.key_down(key);
            held.push((key, observer.now + time));
        }
        let longest = if dice.one_in(10) { 1500 } else { 120 };
        let pause = 1 + dice.below(longest);
        outcome = pass(&mut emulator, &mut observer, &mut held, pause);
    }
    outcome.map(|()| observer.seen).map_err(|what: String| {
        let from = done.len().saturating_sub(25);
        format!(
            "seed {seed}, tick {}: {what}\nlast done:\n{}",
            observer.now,
            done[from..].join("\n")
        )
    })
}

#[test]
fn random_keys_and_faults_move_nothing_without_a_cause() {
    let presses = std::env::var("CAUSES_PRESSES")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(10_000u32);
    let lives = presses.div_ceil(PRESSES_PER_RUN);
    let mut seen = ExplainedEvents::default();
    for seed in REGRESSION_SEEDS.into_iter().chain(1..=u64::from(lives)) {
        match run_random_keys(seed) {
            Ok(more) => seen = seen.add(more),
            Err(found) => panic!("{found}"),
        }
    }
    println!("{presses} presses: {seen:?}");
    // Enough happened for the result to be significant.
    let enough = u64::from(presses);
    assert!(
        seen.by_program > enough && seen.by_key > enough / 5,
        "{seen:?}"
    );
    assert!(
        seen.by_return > enough / 5 && seen.by_step > enough / 20,
        "{seen:?}"
    );
    assert!(seen.rises > enough / 50, "{seen:?}");
}
