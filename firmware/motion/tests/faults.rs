//! Five hundred faults on the wire and at the pins: the position is never wrong without an
//! alarm, and the count of the board is that of the edges.

mod support;

use std::collections::VecDeque;

use gsk_motion::messages::{Command, Response, command_id};
use gsk_motion::{Engine, Event, Session, encode_block};
use support::{CRC, GROUP, GUARD_PIN, LIMIT, LIMIT_PIN, POLL_TICKS, TestBoard, X, Z};

/// A millisecond, ticks.
const MS: u64 = 15_625;
/// Time after which the host repeats what is not acknowledged, ticks.
const REPEAT: u64 = 2 * MS;
/// Number of faults.
const ROUNDS: u32 = 500;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    FlippedBit,
    LostBytes,
    DamagedReply,
    SilentHost,
    Unplugged,
    Reset,
    Guard,
    Limit,
    LostCounts,
    SpindleStops,
    SpindleReverses,
}

const FAULTS: [Fault; 11] = [
    Fault::FlippedBit,
    Fault::LostBytes,
    Fault::DamagedReply,
    Fault::SilentHost,
    Fault::Unplugged,
    Fault::Reset,
    Fault::Guard,
    Fault::Limit,
    Fault::LostCounts,
    Fault::SpindleStops,
    Fault::SpindleReverses,
];

/// Pseudorandom numbers, the same in each run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }
}

fn encode_vlq(out: &mut Vec<u8>, value: i64) {
    for bytes in (2_u32..=5).rev() {
        let least = -(1_i64 << (7 * bytes - 9));
        if value < least || value >= -3 * least {
            out.push(0x80 | (value >> (7 * (bytes - 1)) & 0x7F) as u8);
        }
    }
    out.push((value & 0x7F) as u8);
}

/// A host that repeats what is not acknowledged.
#[derive(Default)]
struct Host {
    /// Blocks that are not acknowledged, with their sequence number.
    sent: VecDeque<(u8, Vec<u8>)>,
    waiting: VecDeque<Vec<u8>>,
    next: u8,
    sent_at: u64,
    received: Vec<u8>,
    is_silent: bool,
    /// The next block loses bytes or a bit.
    damage: Option<(Fault, u64)>,
    damages_reply: bool,
}

impl Host {
    fn queue(&mut self, command: Command, values: &[i64]) {
        let mut content = Vec::new();
        for value in [i64::from(command_id(command))].iter().chain(values) {
            encode_vlq(&mut content, *value);
        }
        self.waiting.push_back(content);
    }

    /// Returns the bytes to send at the clock `now`.
    fn send(&mut self, now: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        if self.is_silent {
            return bytes;
        }
        if !self.sent.is_empty() && now >= self.sent_at + REPEAT {
            // What is received incompletely ends with these.
            bytes.extend([0x7E; 64]);
            bytes.extend(self.sent.iter().flat_map(|(_, block)| block.clone()));
            self.sent_at = now;
        }
        while self.sent.len() < 4
            && let Some(content) = self.waiting.pop_front()
        {
            let block = encode_block(self.next, &content).to_vec();
            self.sent.push_back((self.next, block.clone()));
            self.next = (self.next + 1) & 0x0F;
            self.sent_at = now;
            let mut damaged = block;
            if let Some((fault, place)) = self.damage.take() {
                let place = place as usize % damaged.len();
                if fault == Fault::FlippedBit {
                    damaged[place] ^= 1 << (place % 8);
                } else {
                    damaged.truncate(place);
                }
            }
            bytes.extend(damaged);
        }
        bytes
    }

    /// Takes a block of the board: its number acknowledges all before it.
    fn take(&mut self, block: &[u8]) {
        if self.damages_reply {
            self.damages_reply = false;
            return;
        }
        let expected = block[1] & 0x0F;
        let acknowledged = self.sent.iter().position(|(number, _)| *number == expected);
        let count = acknowledged.unwrap_or(if self.next == expected {
            self.sent.len()
        } else {
            0
        });
        self.sent.drain(..count);
        self.received.extend_from_slice(block);
    }
}

/// The board, its protocol and the host.
struct Wire {
    board: TestBoard,
    session: Session,
    host: Host,
    renews: bool,
    renewed: u64,
    /// Sums of the edges when the board was reset.
    reset_sums: [i32; 2],
    restarted: bool,
}

impl Wire {
    fn new() -> Self {
        let mut board = TestBoard::default();
        board.configure(4096);
        board.begin();
        board.renewed = None;
        Self {
            board,
            session: Session::default(),
            host: Host::default(),
            renews: true,
            renewed: 0,
            reset_sums: [0; 2],
            restarted: false,
        }
    }

    fn poll(&mut self) {
        self.board.port.advance(POLL_TICKS);
        let now = self.board.port.now;
        if self.renews && now >= self.renewed + 40 * MS {
            self.renewed = now;
            let end = (now + 100 * MS) as u32;
            self.host
                .queue(Command::RenewLease, &[CRC.into(), end.into()]);
        }
        for byte in self.host.send(now) {
            let host = &mut self.host;
            let TestBoard { engine, port, .. } = &mut self.board;
            let execute = |request| engine.execute(&request, port);
            self.session.push(byte, |block| host.take(&block), execute);
        }
        self.board.engine.poll(&mut self.board.port);
        while let Some(event) = self.board.engine.next_event() {
            let block = self.session.encode(&event);
            self.host.take(&block);
            self.board.events.push(event);
        }
    }

    fn reset(&mut self) {
        self.board.engine = Engine::new();
        self.board.engine.report_start();
        self.session = Session::default();
        self.restarted = true;
        for axis in 0..2 {
            // The output loses the step that waits in it.
            gsk_motion::StepPort::cancel_steps(&mut self.board.port, axis);
            self.reset_sums[axis] = self.board.port.sum(axis);
        }
    }

    fn has_alarm(&self) -> bool {
        let is_alarm = |event: &Event| match event.response {
            Response::Shutdown
            | Response::IsShutdown
            | Response::LeaseExpired
            | Response::Starting => true,
            Response::TrsyncState => event.values()[1] == 0,
            _ => false,
        };
        self.board.events.iter().any(is_alarm)
    }
}

/// Queues a motion of both axes; returns the steps that it is to make.
fn queue_motion(wire: &mut Wire) -> [i32; 2] {
    let now = wire.board.port.now;
    let at = i64::from((now + 20 * MS) as u32);
    let group = i64::from(GROUP);
    wire.host.queue(Command::TrsyncStart, &[group, at, 0, 4]);
    for axis in [Z, X] {
        wire.host
            .queue(Command::StepperStopOnTrigger, &[axis.into(), group]);
    }
    wire.host.queue(
        Command::EndstopHome,
        &[LIMIT.into(), at, 125, 4, 15_625, 1, group, 1],
    );
    let end = i64::from((now + 2000 * MS) as u32);
    wire.host.queue(Command::TrsyncSetTimeout, &[group, end]);
    for (axis, is_up) in [(Z, 1), (X, 0)] {
        wire.host.queue(Command::ResetStepClock, &[axis.into(), at]);
        wire.host
            .queue(Command::SetNextStepDir, &[axis.into(), is_up]);
    }
    // A tenth of a second in eight runs for each axis.
    for _ in 0..8 {
        wire.host
            .queue(Command::QueueStep, &[Z.into(), 781, 250, 0]);
        wire.host
            .queue(Command::QueueStep, &[X.into(), 1562, 125, 0]);
    }
    [2000, -1000]
}

/// Queues a thread of Z; returns the steps that it is to make.
fn queue_thread(wire: &mut Wire) -> [i32; 2] {
    let now = i64::from(wire.board.port.now as u32);
    let z = i64::from(Z);
    wire.host
        .queue(Command::BeginAngle, &[z, now, 100, 8, 4, 0]);
    for _ in 0..4 {
        wire.host.queue(Command::QueueAngle, &[z, 1024, 3, 0]);
    }
    wire.host.queue(Command::EndAngle, &[z]);
    [1536, 0]
}

/// Runs a job with a fault; returns whether there was an alarm.
fn run_round(round: u32, dice: &mut Dice) -> bool {
    let fault = FAULTS[round as usize % FAULTS.len()];
    let is_thread = match fault {
        Fault::LostCounts | Fault::SpindleStops | Fault::SpindleReverses => true,
        Fault::Limit => false,
        _ => dice.below(2) == 0,
    };
    let mut wire = Wire::new();
    // A spindle at 1200 rpm; the first turn shows the index.
    let mut count = 0.0_f64;
    let mut speed = 81_920.0 / 15_625_000.0 * POLL_TICKS as f64;
    let mut jump = 0;
    while count < 4200.0 {
        count += speed;
        wire.board.port.counts[0] = count as i32;
        wire.poll();
    }
    let wanted = if is_thread {
        queue_thread(&mut wire)
    } else {
        queue_motion(&mut wire)
    };
    let begun = wire.board.port.now;
    let mut fault_at = begun + dice.below(130) * MS + dice.below(MS);
    let silent_for = (1 + dice.below(250)) * MS;
    let mut is_done = false;
    while wire.board.port.now < begun + 600 * MS {
        let now = wire.board.port.now;
        if now >= fault_at && !is_done {
            is_done = true;
            fault_at = now;
            match fault {
                Fault::FlippedBit | Fault::LostBytes => {
                    wire.host.damage = Some((fault, dice.below(64)))
                }
                Fault::DamagedReply => wire.host.damages_reply = true,
                Fault::SilentHost | Fault::Unplugged => wire.host.is_silent = true,
                Fault::Reset => wire.reset(),
                Fault::Guard => wire.board.port.levels |= 1 << GUARD_PIN,
                Fault::Limit => wire.board.port.levels |= 1 << LIMIT_PIN,
                Fault::LostCounts => jump = 20 + dice.below(1000) as i32,
                Fault::SpindleStops => speed = 0.0,
                Fault::SpindleReverses => speed = -speed,
            }
        }
        if fault == Fault::SilentHost && now >= fault_at + silent_for {
            wire.host.is_silent = false;
        }
        if fault == Fault::SpindleReverses && now >= fault_at + 20 * MS {
            speed = speed.abs();
        }
        count += speed;
        // A count that is lost moves the angle of the encoder, not that of the index.
        wire.board.port.index_turn = 0;
        let index = 1 << support::INDEX_PIN;
        let is_index = (count as i32).rem_euclid(4096) < 2;
        wire.board.port.levels = wire.board.port.levels & !index | if is_index { index } else { 0 };
        wire.board.port.counts[0] = count as i32 - jump;
        wire.poll();
    }
    let text = format!(
        "round {round}: {fault:?}, thread {is_thread}, {:?}",
        wire.board.shutdown_text()
    );
    for axis in 0..2 {
        let sum = wire.board.port.sum(axis) - wire.reset_sums[axis];
        assert_eq!(
            wire.board.engine.position(axis),
            if wire.restarted { 0 } else { sum },
            "{text}"
        );
    }
    let made = [wire.board.port.sum(0), wire.board.port.sum(1)];
    let has_alarm = wire.has_alarm();
    if !has_alarm && fault != Fault::SpindleStops {
        assert_eq!(made, wanted, "{text}");
    }
    assert!(
        made[0] <= wanted[0] && made[1] >= wanted[1],
        "{text}: {made:?}"
    );
    let last = wire.board.port.steps.last().map_or(0, |step| step.at);
    let run_on = last.saturating_sub(fault_at);
    match fault {
        Fault::Guard | Fault::Limit => assert!(run_on <= 781, "{text}: {run_on} ticks"),
        Fault::Reset => assert!(run_on == 0, "{text}: {run_on} ticks"),
        Fault::Unplugged => assert!(run_on <= 168 * MS, "{text}: {run_on} ticks"),
        _ => {}
    }
    match fault {
        Fault::Guard | Fault::Unplugged | Fault::Reset | Fault::LostCounts | Fault::Limit => {
            assert!(has_alarm, "{text}");
        }
        Fault::FlippedBit | Fault::LostBytes | Fault::DamagedReply => {
            assert!(!has_alarm, "{text}: the host repeats");
        }
        _ => {}
    }
    has_alarm
}

#[test]
fn the_position_is_never_wrong_without_an_alarm() {
    let mut dice = Dice(20_260_101);
    let alarms = (0..ROUNDS)
        .filter(|round| run_round(*round, &mut dice))
        .count();
    println!("{alarms} alarms in {ROUNDS} faults");
    assert!(alarms > 150);
}
