//! A control, its link and a board, in virtual time.

use core::time::Duration;

use gsk_core::cnc::Request;
use gsk_core::machine::link::{LinkConfig, LinkState, Linked, Note};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_twins::grbl::{GrblTwin, Settings, Variant};

/// One millisecond of all three.
const MS: u64 = 1_000_000;

/// Keys of the machine panel.
pub const AUTO: BitAddress = key(20, 1);
pub const ZERO: BitAddress = key(20, 3);
pub const CYCLE_START: BitAddress = key(25, 0);
/// Arrow down: X+.
pub const X_PLUS: BitAddress = key(23, 1);
pub const RESET: BitAddress = key(26, 0);
pub const FEED_HOLD: BitAddress = key(24, 7);
pub const SINGLE_BLOCK: BitAddress = key(20, 6);
pub const DRY_RUN: BitAddress = key(21, 2);
pub const MACHINE_LOCK: BitAddress = key(21, 0);
pub const STEP: BitAddress = key(20, 4);
pub const INCREMENT_100: BitAddress = key(21, 6);
pub const JOG: BitAddress = key(20, 5);
/// Arrows right and left: Z+, Z-.
pub const Z_PLUS: BitAddress = key(22, 7);
pub const Z_MINUS: BitAddress = key(22, 5);

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress {
        area: Area::X,
        byte,
        bit,
    }
}

#[derive(Clone)]
pub struct Machine {
    pub simulation: Simulation,
    pub linked: Linked,
    pub twin: GrblTwin,
    pub notes: Vec<Note>,
    /// The computer's clock against the board's.
    pub clock_rate: f64,
    /// Board time, ns, and host time at the last look.
    clock: (u64, Duration),
    /// Kernel ticks made.
    pub ticks: u64,
    /// The board's count at which the kernel's is zero.
    origin: [i64; 2],
    /// The kernel's count at the machine zero.
    home: [i64; 2],
    /// The kernel's way: pulses after each tick that made one.
    pub path: Vec<[i64; 2]>,
    recording: bool,
    /// Ticks of the kernel in motion.
    pub moving_ticks: u64,
    /// Looked at after every millisecond.
    pub watch: Option<fn(&Self)>,
}

impl Machine {
    /// A training lathe with electronic gear 1/5 and a board as delivered.
    fn new(variant: Variant, flush_keep_speed: u32, divide: i32) -> Self {
        let config = LinkConfig {
            flush_keep_speed,
            ..LinkConfig::default()
        };
        let changes = [(17, divide), (18, divide)];
        Self::wired(variant, config, Settings::default(), &changes)
    }

    fn wired(
        variant: Variant,
        config: LinkConfig,
        settings: Settings,
        changes: &[(u16, i32)],
    ) -> Self {
        let mut setup = Setup::delivered();
        for (number, value) in changes {
            setup.parameters.set(*number, *value).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let linked = Linked::open(config, &mut simulation, Duration::ZERO);
        Self {
            simulation,
            linked,
            twin: GrblTwin::new(variant, settings),
            notes: Vec::new(),
            clock_rate: 1.0,
            clock: (0, Duration::ZERO),
            ticks: 0,
            origin: [0, 0],
            home: [0, 0],
            path: Vec::new(),
            recording: false,
            moving_ticks: 0,
            watch: None,
        }
    }

    /// Settings written, board unlocked; nobody knows where it stands.
    pub fn connected(variant: Variant) -> Self {
        Self::unlocked(variant, 10_000, 5)
    }

    fn unlocked(variant: Variant, flush_keep_speed: u32, divide: i32) -> Self {
        Self::new(variant, flush_keep_speed, divide).open()
    }

    fn open(self) -> Self {
        let mut machine = self;
        machine.wait(6000, |machine| machine.alarms() == [603]);
        machine.linked.write_settings();
        machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked);
        machine.press(RESET);
        machine.pass(500);
        machine
    }

    /// The reference return is made.
    pub fn referenced(variant: Variant) -> Self {
        Self::with(variant, 10_000)
    }

    /// The same with another speed (mm/min) up to which a stop keeps the steps.
    pub fn with(variant: Variant, flush_keep_speed: u32) -> Self {
        Self::unlocked(variant, flush_keep_speed, 5).homed()
    }

    /// The same with electronic gear 1/`divide`.
    pub fn geared(variant: Variant, divide: i32) -> Self {
        Self::unlocked(variant, 10_000, divide).homed()
    }

    /// A lathe with grblHAL behind an encoder; machine file and settings of the board
    /// as given, and parameters besides the gear 1/5.
    pub fn threading(config: LinkConfig, settings: Settings, changes: &[(u16, i32)]) -> Self {
        let gear = [(17, 5), (18, 5)];
        let changes = [&gear[..], changes].concat();
        Self::wired(Variant::GrblHal, config, settings, &changes)
            .open()
            .homed()
    }

    fn homed(self) -> Self {
        let mut machine = self;
        machine.press(ZERO);
        machine.press(X_PLUS);
        let ready = machine.wait(60_000, |machine| machine.linked.state() == LinkState::Ready);
        assert!(ready, "{:?} {:?}", machine.linked.state(), machine.alarms());
        let (board, kernel) = (machine.twin.pulses(), machine.simulation.cnc.pulses());
        machine.origin = [board[0] - kernel.x.0, board[1] - kernel.z.0];
        machine.home = [kernel.x.0, kernel.z.0];
        machine
    }

    pub fn ms(&mut self) {
        self.twin.advance(MS);
        let passed = Duration::from_nanos(self.twin.now() - self.clock.0);
        let now = self.clock.1 + passed.mul_f64(self.clock_rate);
        self.clock = (self.twin.now(), now);
        let bytes = self.twin.read();
        self.linked.pump(&mut self.simulation, &bytes, now);
        while self.linked.may_tick(&mut self.simulation) {
            self.linked.tick(&mut self.simulation);
            self.ticks += 1;
            if self.recording {
                self.note_way();
            }
        }
        let tx = self.linked.tx().to_vec();
        self.twin.write(&tx);
        self.linked.consumed(tx.len());
        self.notes.extend(self.linked.notes());
        if let Some(watch) = self.watch {
            watch(self);
        }
    }

    /// From now on the kernel's way is noted.
    pub fn record(&mut self) {
        self.recording = true;
        self.note_way();
    }

    fn note_way(&mut self) {
        let cnc = &self.simulation.cnc;
        let pulses = cnc.pulses();
        let at = [pulses.x.0, pulses.z.0];
        self.moving_ticks += u64::from(cnc.is_moving());
        if self.path.last() != Some(&at) {
            self.path.push(at);
        }
    }

    pub fn pass(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms();
        }
    }

    pub fn wait(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        for _ in 0..limit_ms {
            if until(self) {
                return true;
            }
            self.ms();
        }
        until(self)
    }

    pub fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.pass(100);
        }
    }

    /// A key held for so long.
    pub fn hold(&mut self, key: BitAddress, ms: u32) {
        self.simulation.cnc.set_panel_key(key, true);
        self.pass(ms);
        self.simulation.cnc.set_panel_key(key, false);
        self.pass(100);
    }

    /// The computer does something else for so long.
    pub fn pause(&mut self, ms: u64) {
        self.twin.advance(ms * MS);
    }

    pub fn cut_cable(&mut self) {
        self.twin.to_host.set_cut(true);
        self.twin.to_board.set_cut(true);
    }

    pub fn mend_cable(&mut self) {
        self.twin.to_host.set_cut(false);
        self.twin.to_board.set_cut(false);
    }

    /// The port is closed and opened again; this board does not mind.
    pub fn reconnect(&mut self) {
        let now = self.clock.1;
        let config = self.linked.config().clone();
        self.linked = Linked::open(config, &mut self.simulation, now);
    }

    /// The kernel's count at the machine zero.
    pub const fn home_pulses(&self) -> [i64; 2] {
        self.home
    }

    pub fn load(&mut self, main: &str, sub: Option<&str>) {
        if let Some(sub) = sub {
            let stored = Request::StoreProgram(sub.to_owned());
            self.simulation.cnc.request(stored).unwrap();
        }
        let opened = Request::OpenExternal(Program::new(main));
        self.simulation.cnc.request(opened).unwrap();
    }

    /// Selects AUTO and presses cycle start.
    pub fn start(&mut self) {
        self.press(AUTO);
        self.press(CYCLE_START);
    }

    /// Runs until the program has ended and all is made; M00 is gone on from.
    pub fn run_to_end(&mut self, limit_ms: u32) {
        for _ in 0..limit_ms {
            self.ms();
            if self.linked.is_behind() || self.simulation.cnc.is_moving() {
                continue;
            }
            match self.simulation.cnc.run_state() {
                RunState::Run => {}
                RunState::Stop if self.alarms().is_empty() => self.press(CYCLE_START),
                _ => return,
            }
        }
        panic!("the program does not end: {:?}", self.linked.state());
    }

    /// Pulses at the pins, counted as the kernel counts.
    pub fn made(&self) -> [i64; 2] {
        let [x, z] = self.twin.pulses();
        [x - self.origin[0], z - self.origin[1]]
    }

    pub fn alarms(&self) -> Vec<u16> {
        let alarms = self.simulation.cnc.alarms();
        alarms.iter().map(|alarm| alarm.number).collect()
    }
}
