//! A link and a board, wired, in virtual time.

use core::time::Duration;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::step_queue::StepLink;
use gsk_link::{Backend, FINE, LinkConfig, LinkEvent, LinkState, MotionRefused, RunTime, Sample};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin};

/// One millisecond of both.
pub const MS: u64 = 1_000_000;

pub const WIRED: &str = r#"(
    protocol: StepQueue,
    baud: 250000,
    x: (step: "PA0", dir: "PA1", limit: "^PC0", dec: "PC4", zero: "PC5"),
    z: (step: "PA2", dir: "PA3", limit: "^PC1", dec: "PC6"),
    io: (enable: "PL0", estop: "!PC2", spindle_cw: "PB4", spindle_pwm: "PH6", coolant: "!PB7", index: "PC3"),
)"#;

#[derive(Clone)]
pub struct Bench {
    pub link: StepLink,
    pub twin: KlipperTwin,
    pub run: RunTime,
    pub at: (f64, f64),
    pub events: Vec<LinkEvent>,
}

pub fn config() -> LinkConfig {
    let config: LinkConfig = ron::from_str(WIRED).unwrap();
    config.check().unwrap();
    config
}

pub fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    for number in [17, 18] {
        parameters.set(number, 5).unwrap();
    }
    parameters
}

impl Bench {
    /// A board that has just got power, on a control with electronic gear 1/5.
    pub fn new(make: KlipperHardware) -> Self {
        Self::wired(config(), make)
    }

    /// The same with other wires.
    pub fn wired(config: LinkConfig, make: KlipperHardware) -> Self {
        let mut twin = KlipperTwin::new(make);
        twin.set_pin("PC2", true);
        Self {
            link: StepLink::open(config, &drives(&parameters()), Duration::ZERO),
            twin,
            run: RunTime::ZERO,
            at: (0.0, 0.0),
            events: Vec::new(),
        }
    }

    /// Set up, position confirmed.
    pub fn ready() -> Self {
        Self::ready_with(KlipperHardware::default())
    }

    /// The same with another board.
    pub fn ready_with(make: KlipperHardware) -> Self {
        let mut bench = Self::new(make);
        assert!(bench.gets(LinkState::Locked, 5000), "{:?}", bench.events);
        bench.set_position();
        bench.pass(300);
        bench.events.clear();
        bench
    }

    /// The port is closed and opened again, without a word to the board.
    pub fn open_again(&mut self) {
        let now = Duration::from_nanos(self.twin.now());
        self.link = StepLink::open(config(), &drives(&parameters()), now);
        self.events.clear();
    }

    pub fn set_position(&mut self) {
        self.pass(200);
        self.link.set_position(self.pulses(), self.run).unwrap();
    }

    pub fn pulses(&self) -> PerAxis<Pulses> {
        let whole = |place: f64| Pulses((place + 0.5).floor() as i64);
        PerAxis::new(whole(self.at.0), whole(self.at.1))
    }

    pub fn ms(&mut self) {
        self.twin.advance(MS);
        self.host();
    }

    /// The host does its work; between two calls it sleeps.
    pub fn host(&mut self) {
        let now = Duration::from_nanos(self.twin.now());
        let bytes = self.twin.read();
        self.link.rx(&bytes, now);
        self.link.tick(now);
        self.write();
        self.events.extend(self.link.events());
    }

    pub fn write(&mut self) {
        let tx = self.link.tx().to_vec();
        self.twin.write(&tx);
        self.link.consumed(tx.len());
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

    pub fn gets(&mut self, state: LinkState, limit_ms: u32) -> bool {
        self.wait(limit_ms, |bench| bench.link.state() == state)
    }

    /// Hands over one tick of motion, waiting for room; false when refused.
    pub fn sample(&mut self, x: f64, z: f64) -> bool {
        for _ in 0..3000 {
            if !self.link.state().takes_motion() {
                return false;
            }
            if self.link.free_lookahead() >= Duration::from_millis(1) {
                return self.give(x, z).is_ok();
            }
            self.ms();
        }
        false
    }

    pub fn give(&mut self, x: f64, z: f64) -> Result<(), MotionRefused> {
        let before = (self.run, self.at);
        self.run += Duration::from_millis(1);
        self.at = (x, z);
        let fine = |place: f64| (place * FINE as f64).round() as i64;
        let result = self.link.push(Sample {
            fine: PerAxis::new(fine(x), fine(z)),
            ..Sample::new(self.run, self.pulses())
        });
        if result.is_err() {
            (self.run, self.at) = before;
        }
        self.write();
        result
    }

    /// There and back in both axes with ramps and a reversal, and 100 pulses of Z
    /// farther; false when it broke off.
    pub fn job(&mut self) -> bool {
        let (x0, z0) = self.at;
        for k in 1..=1000_i64 {
            let share = 0.5 - 0.5 * libm::cos(core::f64::consts::TAU * k as f64 / 1000.0);
            let done = k as f64 / 1000.0;
            let rest = done * done * (3.0 - 2.0 * done);
            if !self.sample(x0 + 800.0 * share, z0 - 2400.0 * share - 100.0 * rest) {
                return false;
            }
        }
        self.link.finish().is_ok()
    }

    /// Along a path, tick by tick from where it stands; false when it broke off.
    pub fn follow(&mut self, ms: u32, path: impl Fn(f64) -> (f64, f64)) -> bool {
        let (x, z) = self.at;
        (1..=ms).all(|tick| {
            let (dx, dz) = path(f64::from(tick));
            self.sample(x + dx, z + dz)
        })
    }

    /// Z at a speed, pulses a ms, for some ms.
    pub fn feed(&mut self, speed: f64, ms: u32) -> bool {
        (0..ms).all(|_| self.sample(self.at.0, self.at.1 + speed))
    }

    pub fn alarms(&self) -> Vec<u16> {
        let number = |event: &LinkEvent| match event {
            LinkEvent::Alarm { number, .. } => Some(*number),
            _ => None,
        };
        self.events.iter().filter_map(number).collect()
    }

    /// Dictionaries that were read.
    pub fn learned(&self) -> Vec<(String, Vec<u8>)> {
        let learned = |event: &LinkEvent| match event {
            LinkEvent::Learned { name, packed } => Some((name.clone(), packed.clone())),
            _ => None,
        };
        self.events.iter().filter_map(learned).collect()
    }

    pub fn counted(&self) -> (i64, i64) {
        (self.pulses().x.0, self.pulses().z.0)
    }

    pub fn made(&self) -> (i64, i64) {
        let [x, z] = self.twin.pulses();
        (x, z)
    }

    /// Nothing moves any more, whatever the operator does not do.
    pub fn stands(&mut self, ms: u32) {
        let stood = self.twin.pulses();
        self.pass(ms);
        assert_eq!(self.twin.pulses(), stood, "it moves on");
    }
}
