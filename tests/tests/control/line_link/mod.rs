//! Tests the link with a line board against the board's twin, in virtual time: nothing moves
//! without a command, every stop is known, the counts agree to the pulse.

use core::time::Duration;

use gsk_core::linked::drives_from_parameters;
use gsk_core::memory::ControlParameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::line::LineLink;
use gsk_link::{
    Backend, Input, LinkConfig, LinkEvent, LinkState, RunTime, Sample, SettingDifference,
};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

mod faults;
mod stops;

const ALL: [Variant; 3] = [Variant::Grbl, Variant::GrblHal, Variant::FluidNc];
/// One millisecond, ns.
const MS_IN_NS: u64 = 1_000_000;

#[derive(Clone)]
struct LineBench {
    link: LineLink,
    twin: GrblTwin,
    run: RunTime,
    at: (i64, i64),
    events: Vec<LinkEvent>,
    last_tx: Vec<u8>,
}

impl LineBench {
    /// A board as delivered, on a control with electronic gear 1/5.
    fn new(variant: Variant) -> Self {
        let mut parameters = ControlParameters::default();
        for number in [17, 18] {
            parameters.set(number, 5).unwrap();
        }
        let twin = GrblTwin::new(variant, GrblSettings::default());
        let config = LinkConfig {
            flush_keep_speed: 10_000,
            ..LinkConfig::default()
        };
        let link = LineLink::open(config, &drives_from_parameters(&parameters), Duration::ZERO);
        Self {
            link,
            twin,
            run: RunTime::ZERO,
            at: (0, 0),
            events: Vec::new(),
            last_tx: Vec::new(),
        }
    }

    /// Opened, settings written, position confirmed.
    fn ready(variant: Variant) -> Self {
        let mut bench = Self::new(variant);
        bench.open();
        bench.set_position();
        bench.events.clear();
        bench
    }

    fn open(&mut self) {
        self.run_until(5000, |bench| {
            matches!(
                bench.link.state(),
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            ) || bench
                .events
                .iter()
                .any(|event| matches!(event, LinkEvent::Differs(_)))
        });
        self.link.write_settings();
        self.run_until(5000, |bench| bench.link.state() == LinkState::Locked);
    }

    fn set_position(&mut self) {
        // A board with homing starts locked.
        self.run_ms(400);
        self.link.reset();
        self.run_ms(400);
        let at = PerAxis::new(Pulses(self.at.0), Pulses(self.at.1));
        self.link.set_position(at, self.run).unwrap();
    }

    fn run_one_ms(&mut self) {
        self.twin.advance(MS_IN_NS);
        let now = Duration::from_nanos(self.twin.now());
        let bytes = self.twin.read();
        self.link.rx(&bytes, now);
        self.link.tick(now);
        let tx = self.link.tx().to_vec();
        self.twin.write(&tx);
        self.link.consumed(tx.len());
        self.last_tx = tx;
        self.events.extend(self.link.events());
    }

    fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            self.run_one_ms();
        }
    }

    fn run_until(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        for _ in 0..limit_ms {
            if until(self) {
                return true;
            }
            self.run_one_ms();
        }
        until(self)
    }

    /// Sends one tick of motion when the board has space for it. Returns false if it is
    /// refused.
    fn send_sample(&mut self, x: i64, z: i64) -> bool {
        for _ in 0..3000 {
            if !self.link.state().takes_motion() {
                return false;
            }
            if self.link.free_lookahead() > Duration::ZERO {
                self.run += Duration::from_millis(1);
                self.at = (x, z);
                let pulses = PerAxis::new(Pulses(x), Pulses(z));
                return self.link.push(Sample::new(self.run, pulses)).is_ok();
            }
            self.run_one_ms();
        }
        false
    }

    /// Moves 12 mm in Z and 2 mm in X with ramps, and back. Returns false if the motion is
    /// interrupted.
    fn run_job(&mut self) -> bool {
        let (x0, z0) = self.at;
        for k in 1..=1000_i64 {
            // A quarter wave up and down: starts and ends at rest.
            let share = 0.5 - 0.5 * libm::cos(core::f64::consts::TAU * k as f64 / 1000.0);
            let x = x0 + (800.0 * share).round() as i64;
            let z = z0 - (2400.0 * share).round() as i64 - k / 10;
            if !self.send_sample(x, z) {
                return false;
            }
        }
        self.link.finish().is_ok()
    }

    fn alarms(&self) -> Vec<u16> {
        let number = |event: &LinkEvent| match event {
            LinkEvent::Alarm { number, .. } => Some(*number),
            _ => None,
        };
        self.events.iter().filter_map(number).collect()
    }

    fn is_ready_at_end(&mut self) -> bool {
        self.run_until(3000, |bench| bench.link.state() == LinkState::Ready)
    }
}

#[test]
fn a_board_as_delivered_is_refused_until_its_settings_are_written() {
    for variant in ALL {
        let mut bench = LineBench::new(variant);
        bench.run_until(5000, |bench| !bench.alarms().is_empty());
        assert_eq!(bench.alarms(), [603], "{variant:?} {:?}", bench.events);
        let (name, board) = match variant {
            Variant::FluidNc => ("axes/x/steps_per_mm", "80.000000"),
            _ => ("$100", "250"),
        };
        let per_mm = bench.events.iter().any(|event| {
            *event
                == LinkEvent::Differs(SettingDifference {
                    number: 100,
                    name: name.into(),
                    board: Some(board.into()),
                    wanted: "400".into(),
                })
        });
        assert!(per_mm, "{:?}", bench.events);
        assert!(!bench.link.state().takes_motion());
        bench.link.write_settings();
        assert!(bench.run_until(5000, |bench| bench.link.state() == LinkState::Locked));
        assert!((bench.twin.settings().value(100) - 400.0).abs() < 1e-9);
        assert_eq!(
            bench.twin.pulses(),
            [0, 0],
            "knowing each other moves nothing"
        );
    }
}

#[test]
fn a_silent_port_is_alarm_601() {
    let mut link = LineLink::open(
        LinkConfig::default(),
        &drives_from_parameters(&ControlParameters::default()),
        Duration::ZERO,
    );
    for ms in 0..6000 {
        link.tick(Duration::from_millis(ms));
        let count = link.tx().len();
        link.consumed(count);
    }
    let alarm = |event: &LinkEvent| matches!(event, LinkEvent::Alarm { number: 601, .. });
    assert!(link.events().iter().any(alarm));
    assert_eq!(link.state(), LinkState::Lost);
}

#[test]
fn a_job_ends_on_the_commanded_pulse() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        assert!(bench.run_job());
        assert!(bench.is_ready_at_end(), "{:?}", bench.events);
        assert_eq!(bench.twin.pulses(), [bench.at.0, bench.at.1]);
        assert_eq!(bench.at, (0, -100));
        assert!(bench.events.contains(&LinkEvent::Drained));
        assert_eq!(bench.alarms(), [0_u16; 0]);
    }
}

/// The board stores G54 without power, and another program may have set one.
#[test]
fn a_work_offset_of_another_program_moves_nothing() {
    for variant in ALL {
        let mut bench = LineBench::new(variant);
        bench.twin.set_work_offset([12.5, -40.0]);
        bench.open();
        bench.set_position();
        assert!(
            bench.run_job() && bench.is_ready_at_end(),
            "{:?}",
            bench.events
        );
        assert_eq!(bench.twin.pulses(), [0, -100]);
        assert!(bench.alarms().iter().all(|alarm| *alarm == 603));
    }
}

#[test]
fn the_board_never_holds_more_than_the_lookahead_nor_loses_a_byte() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        for k in 1..=1500 {
            assert!(bench.send_sample(k * 4, -k * 8));
            assert!(bench.link.outstanding() <= Duration::from_millis(160));
        }
        bench.link.finish().unwrap();
        assert!(bench.is_ready_at_end());
        assert_eq!(bench.twin.pulses(), [6000, -12_000]);
    }
}

#[test]
fn motion_keeps_the_time_of_the_kernel() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        let from = bench.twin.now();
        for k in 1..=2000 {
            assert!(bench.send_sample(0, -k * 2));
        }
        bench.link.finish().unwrap();
        bench.run_until(3000, |bench| bench.twin.pulses()[1] == -4000);
        let seconds = (bench.twin.now() - from) as f64 * 1e-9;
        // The first pulse takes 80 ms.
        assert!((seconds - 2.08).abs() < 0.06, "{seconds}");
    }
}

#[test]
fn a_report_pending_at_the_start_of_a_reference_return_gives_no_position() {
    for variant in ALL {
        let mut bench = LineBench::ready(variant);
        assert!(bench.run_job() && bench.is_ready_at_end());
        let reports = bench.link.traffic().reports;
        // The next status request was just sent; its answer comes while the board homes.
        let mut request_sent = false;
        for _ in 0..300 {
            bench.run_one_ms();
            request_sent = bench.last_tx.contains(&b'?');
            if request_sent {
                break;
            }
        }
        assert!(request_sent && bench.link.traffic().reports >= reports);
        bench.link.home(PerAxis::new(true, true)).unwrap();
        let homed = |event: &LinkEvent| matches!(event, LinkEvent::Homed(_));
        assert!(bench.run_until(120_000, |bench| bench.events.iter().any(homed)));
        let zero = PerAxis::new(Pulses(0), Pulses(0));
        assert!(bench.run_until(1000, |bench| bench.link.status().is_some()));
        bench.link.set_position(zero, bench.run).unwrap();
        bench.run_ms(500);
        assert_eq!(bench.alarms(), [0_u16; 0], "{variant:?}");
        assert_eq!(bench.link.state(), LinkState::Ready);
    }
}

#[test]
fn letters_of_a_report_are_contacts_of_the_control() {
    let mut bench = LineBench::new(Variant::Grbl);
    let config: LinkConfig = ron::from_str(r#"(inputs: {"X2.0": "P", "X2.1": "!D"})"#).unwrap();
    config.check().unwrap();
    bench.link = LineLink::open(
        config,
        &drives_from_parameters(&ControlParameters::default()),
        Duration::ZERO,
    );
    let contact = |bit| Input::Contact { byte: 2, bit };
    assert_eq!(
        bench.link.input(contact(0)),
        None,
        "nothing was reported yet"
    );
    bench.open();
    bench.run_ms(500);
    let both = |bench: &LineBench| [0, 1].map(|bit| bench.link.input(contact(bit)));
    assert_eq!(both(&bench), [Some(false), Some(true)]);
    bench.twin.pins.probe = true;
    bench.twin.pins.door = true;
    bench.run_ms(500);
    assert_eq!(both(&bench), [Some(true), Some(false)]);
    assert_eq!(bench.link.input(contact(2)), None, "not wired");
    assert_eq!(bench.link.input(Input::LimitX), Some(false));
}

/// Old or other firmware is named and refused; nothing is written to it.
#[test]
fn another_firmware_is_602() {
    for (identity, named) in [
        ("[VER:1.1e.20161219:]\r\n[OPT:V,15,128]\r\nok\r\n", "1.1e"),
        ("[0.9j.20160316:]\r\nok\r\n", "older than 1.1f"),
        ("echo:Unknown command: \"$I\"\r\nok\r\n", "older than 1.1f"),
        (
            "[VER:1.1f.2020:]\r\n[OPT:V,35,255]\r\n[AXS:2:XY]\r\n[FIRMWARE:grblHAL]\r\nok\r\n",
            "axes XY",
        ),
        (
            "[VER:3.0:]\r\n[OPT:,15,128]\r\n[FIRMWARE:Other]\r\nok\r\n",
            "firmware Other",
        ),
        ("error:1\r\n", "error:1"),
    ] {
        let mut link = LineLink::open(
            LinkConfig::default(),
            &drives_from_parameters(&ControlParameters::default()),
            Duration::ZERO,
        );
        let (mut sent, mut events) = (Vec::new(), Vec::new());
        for ms in 0..6000 {
            let now = Duration::from_millis(ms);
            if ms == 100 {
                link.rx(b"\r\nHello\r\n", now);
            }
            link.tick(now);
            let tx = link.tx().to_vec();
            link.consumed(tx.len());
            if tx.starts_with(b"$I") {
                link.rx(identity.as_bytes(), now);
            }
            sent.extend(tx);
            events.extend(link.events());
        }
        let has_alarm = events.iter().any(
            |event| matches!(event, LinkEvent::Alarm { number: 602, detail } if detail.to_string().contains(named)),
        );
        assert!(has_alarm, "{identity}: {events:?}");
        assert_eq!(link.state(), LinkState::Fault);
        assert_eq!(sent, b"\x18\n$I\n", "{identity}");
    }
}

/// An axis that reverses just before a complete piece of motion still goes all the way.
#[test]
fn an_axis_reverses_at_its_commanded_position() {
    for variant in ALL {
        for top in [331_i64, 337] {
            let mut bench = LineBench::ready(variant);
            let mut most = 0;
            for k in 1..=2 * top {
                assert!(bench.send_sample(0, top - (k - top).abs()));
                bench.run_one_ms();
                most = most.max(bench.twin.pulses()[1]);
            }
            bench.link.finish().unwrap();
            assert!(bench.is_ready_at_end(), "{:?}", bench.events);
            assert_eq!((most, bench.twin.pulses()[1]), (top, 0), "{variant:?}");
        }
    }
}
