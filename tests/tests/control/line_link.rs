//! The link with a line board against the board's twin, in virtual time: nothing
//! moves by itself, every stop is known, the counts agree to the pulse.

use core::time::Duration;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_core::units::{PerAxis, Pulses};
use gsk_link::line::LineLink;
use gsk_link::{
    Backend, Input, LinkConfig, LinkEvent, LinkState, RunTime, Sample, SettingDifference, Stop,
};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};
use gsk_twins::wire::Damage;

const ALL: [Variant; 3] = [Variant::Grbl, Variant::GrblHal, Variant::FluidNc];
/// One millisecond of both.
const MS: u64 = 1_000_000;

#[derive(Clone)]
struct Bench {
    link: LineLink,
    twin: GrblTwin,
    run: RunTime,
    at: (i64, i64),
    events: Vec<LinkEvent>,
    last_tx: Vec<u8>,
}

impl Bench {
    /// A board as delivered, on a control with electronic gear 1/5.
    fn new(variant: Variant) -> Self {
        let mut parameters = Parameters::default();
        for number in [17, 18] {
            parameters.set(number, 5).unwrap();
        }
        let twin = GrblTwin::new(variant, GrblSettings::default());
        let config = LinkConfig {
            flush_keep_speed: 10_000,
            ..LinkConfig::default()
        };
        let link = LineLink::open(config, &drives(&parameters), Duration::ZERO);
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
        self.wait(5000, |bench| {
            matches!(
                bench.link.state(),
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            ) || bench
                .events
                .iter()
                .any(|event| matches!(event, LinkEvent::Differs(_)))
        });
        self.link.write_settings();
        self.wait(5000, |bench| bench.link.state() == LinkState::Locked);
    }

    fn set_position(&mut self) {
        // A board with homing wakes up locked.
        self.pass(400);
        self.link.reset();
        self.pass(400);
        let at = PerAxis::new(Pulses(self.at.0), Pulses(self.at.1));
        self.link.set_position(at, self.run).unwrap();
    }

    fn ms(&mut self) {
        self.twin.advance(MS);
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

    fn pass(&mut self, ms: u32) {
        for _ in 0..ms {
            self.ms();
        }
    }

    fn wait(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        for _ in 0..limit_ms {
            if until(self) {
                return true;
            }
            self.ms();
        }
        until(self)
    }

    /// Hands over one tick of motion, waiting for room; false when refused.
    fn sample(&mut self, x: i64, z: i64) -> bool {
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
            self.ms();
        }
        false
    }

    /// A there-and-back of 12 mm in Z and 2 mm in X with ramps; false when it broke off.
    fn job(&mut self) -> bool {
        let (x0, z0) = self.at;
        for k in 1..=1000_i64 {
            // A quarter wave up and down: starts and ends at rest.
            let share = 0.5 - 0.5 * libm::cos(core::f64::consts::TAU * k as f64 / 1000.0);
            let x = x0 + (800.0 * share).round() as i64;
            let z = z0 - (2400.0 * share).round() as i64 - k / 10;
            if !self.sample(x, z) {
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

    fn ends_ready(&mut self) -> bool {
        self.wait(3000, |bench| bench.link.state() == LinkState::Ready)
    }
}

#[test]
fn a_board_as_delivered_is_refused_until_its_settings_are_written() {
    for variant in ALL {
        let mut bench = Bench::new(variant);
        bench.wait(5000, |bench| !bench.alarms().is_empty());
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
        assert!(bench.wait(5000, |bench| bench.link.state() == LinkState::Locked));
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
        &drives(&Parameters::default()),
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
        let mut bench = Bench::ready(variant);
        assert!(bench.job());
        assert!(bench.ends_ready(), "{:?}", bench.events);
        assert_eq!(bench.twin.pulses(), [bench.at.0, bench.at.1]);
        assert_eq!(bench.at, (0, -100));
        assert!(bench.events.contains(&LinkEvent::Drained));
        assert_eq!(bench.alarms(), [0_u16; 0]);
    }
}

/// G54 is kept in the board without power: whatever used it last may have left one.
#[test]
fn a_work_offset_of_another_program_moves_nothing() {
    for variant in ALL {
        let mut bench = Bench::new(variant);
        bench.twin.set_work_offset([12.5, -40.0]);
        bench.open();
        bench.set_position();
        assert!(bench.job() && bench.ends_ready(), "{:?}", bench.events);
        assert_eq!(bench.twin.pulses(), [0, -100]);
        assert!(bench.alarms().iter().all(|alarm| *alarm == 603));
    }
}

#[test]
fn the_board_never_holds_more_than_the_lookahead_nor_loses_a_byte() {
    for variant in ALL {
        let mut bench = Bench::ready(variant);
        for k in 1..=1500 {
            assert!(bench.sample(k * 4, -k * 8));
            assert!(bench.link.outstanding() <= Duration::from_millis(160));
        }
        bench.link.finish().unwrap();
        assert!(bench.ends_ready());
        assert_eq!(bench.twin.pulses(), [6000, -12_000]);
    }
}

#[test]
fn motion_keeps_the_time_of_the_kernel() {
    for variant in ALL {
        let mut bench = Bench::ready(variant);
        let from = bench.twin.now();
        for k in 1..=2000 {
            assert!(bench.sample(0, -k * 2));
        }
        bench.link.finish().unwrap();
        bench.wait(3000, |bench| bench.twin.pulses()[1] == -4000);
        let seconds = (bench.twin.now() - from) as f64 * 1e-9;
        // The first pulse takes 80 ms.
        assert!((seconds - 2.08).abs() < 0.06, "{seconds}");
    }
}

#[test]
fn a_flush_in_motion_keeps_the_position() {
    for variant in ALL {
        for at in (60..900).step_by(37) {
            let mut bench = Bench::ready(variant);
            for k in 1..=at {
                assert!(bench.sample(k * 2, -k * 4));
            }
            bench.link.stop(Stop::Flush);
            assert!(bench.ends_ready(), "{at}: {:?}", bench.events);
            let [x, z] = bench.twin.pulses();
            let stood = LinkEvent::Position(PerAxis::new(Pulses(x), Pulses(z)));
            assert!(
                bench.events.contains(&stood),
                "{at}: {x} {z} {:?}",
                bench.events
            );
            // And it goes on from there.
            bench.at = (x, z);
            assert!(
                bench.job() && bench.ends_ready(),
                "{at}: {:?}",
                bench.events
            );
            assert_eq!(bench.twin.pulses(), [x, z - 100]);
        }
    }
}

#[test]
fn a_kill_loses_the_position_and_says_so() {
    for variant in ALL {
        let mut bench = Bench::ready(variant);
        for k in 1..=300 {
            assert!(bench.sample(0, -k * 4));
        }
        bench.link.stop(Stop::Kill);
        bench.pass(1000);
        assert_eq!(bench.link.state(), LinkState::Locked);
        assert!(!bench.sample(0, 0));
        let stood = bench.twin.pulses();
        bench.pass(2000);
        assert_eq!(bench.twin.pulses(), stood);
    }
}

/// Nothing on this wire is said twice, but the reset is: until the board is there again.
#[test]
fn a_reset_that_is_lost_on_the_way_is_sent_again() {
    for variant in ALL {
        for lost in [0, 1, 4] {
            let mut bench = Bench::ready(variant);
            for k in 1..=300 {
                assert!(bench.sample(0, -k * 4));
            }
            let next = bench.twin.to_board.sent_count();
            for byte in next..next + lost {
                bench.twin.to_board.damage(byte, Damage::Changed(0x01));
            }
            bench.link.stop(Stop::Kill);
            // FluidNC makes what its pulse timer has been handed.
            let coasts = if variant == Variant::FluidNc { 200 } else { 0 };
            bench.pass(100 * lost as u32 + 60 + coasts);
            let stood = bench.twin.pulses();
            bench.pass(3000);
            assert_eq!(bench.twin.pulses(), stood);
            assert_eq!(bench.link.state(), LinkState::Locked, "{lost}");
            assert_eq!(bench.alarms(), [0_u16; 0], "{:?}", bench.events);
            bench.at = (0, 0);
            bench.set_position();
            assert!(bench.job() && bench.ends_ready());
        }
    }
}

/// A line that becomes slow brings a banner for each of them, late.
#[test]
fn the_banners_of_a_reset_that_was_sent_again_are_no_restart() {
    for held_up in [150, 300] {
        let mut bench = Bench::ready(Variant::Grbl);
        for k in 1..=300 {
            assert!(bench.sample(0, -k * 4));
        }
        let next = bench.twin.to_host.sent_count();
        bench
            .twin
            .to_host
            .damage(next, Damage::Delayed(held_up * MS));
        bench.link.stop(Stop::Kill);
        bench.pass(3000);
        assert_eq!(bench.link.state(), LinkState::Locked);
        bench.link.reset();
        bench.pass(1500);
        let set = bench.link.set_position(PerAxis::default(), bench.run);
        assert_eq!(set, Ok(()));
        bench.pass(1500);
        assert_eq!(bench.alarms(), [0_u16; 0], "{:?}", bench.events);
        assert_eq!(bench.link.state(), LinkState::Ready);
    }
}

/// What the board has in its queue tells the way on which its switch was met; where the
/// axis turned round about then nobody knows it.
#[test]
fn the_way_into_a_limit_switch_is_that_of_the_motion_that_met_it() {
    for (turned, known) in [
        (0, true),
        (30, false),
        (100, false),
        (200, false),
        (600, true),
    ] {
        let mut bench = Bench::ready(Variant::Grbl);
        for k in 1..=300 {
            assert!(bench.sample(0, -k * 2));
        }
        for k in 1..=turned {
            assert!(bench.sample(0, -600 + k * 2));
        }
        bench.twin.pins.limit_z = true;
        bench.pass(500);
        assert_eq!(bench.link.state(), LinkState::Tripped);
        bench.link.reset();
        bench.pass(500);
        let [_, z] = bench.twin.pulses();
        bench.at = (0, z);
        bench.set_position();
        bench.pass(200);
        let into = if turned == 600 { 1 } else { -1 };
        let mut gone = [0; 2];
        for (gone, way) in gone.iter_mut().zip([into, -into]) {
            let (mut link, run) = (bench.link.clone(), bench.run);
            for k in 1..=400 {
                let end = run + Duration::from_millis(k as u64);
                let pulses = PerAxis::new(Pulses(0), Pulses(z + way * k));
                if link.push(Sample::new(end, pulses)).is_err() {
                    break;
                }
                *gone = k;
            }
        }
        let wanted = if known { [0, 400] } else { [200, 200] };
        assert_eq!(gone, wanted, "turned {turned} ms before");
    }
}

#[test]
fn a_limit_switch_stops_the_board_and_names_its_axis() {
    for variant in ALL {
        for (x, number) in [(true, 621), (false, 622)] {
            let mut bench = Bench::ready(variant);
            for k in 1..=300 {
                let way = -k * 4;
                assert!(bench.sample(if x { way } else { 0 }, if x { 0 } else { way }));
            }
            bench.twin.pins.limit_x = x;
            bench.twin.pins.limit_z = !x;
            bench.pass(500);
            assert_eq!(bench.link.state(), LinkState::Tripped);
            assert_eq!(bench.alarms(), [number], "{:?}", bench.events);
            let stood = bench.twin.pulses();
            bench.twin.pins.limit_x = false;
            bench.twin.pins.limit_z = false;
            bench.pass(3000);
            assert_eq!(bench.twin.pulses(), stood, "nothing restarts by itself");
            bench.link.reset();
            bench.pass(500);
            assert_eq!(
                bench.link.state(),
                LinkState::Locked,
                "the position has to be found again"
            );
        }
    }
}

#[test]
fn a_board_that_restarts_is_noticed_in_every_state() {
    for variant in ALL {
        for moving in [false, true] {
            let mut bench = Bench::ready(variant);
            if moving {
                for k in 1..=300 {
                    assert!(bench.sample(0, -k * 4));
                }
            }
            bench.twin.press_reset();
            bench.pass(4000);
            assert!(
                !bench.link.state().takes_motion(),
                "{moving} {:?}",
                bench.link.state()
            );
            let known = [605, 606, 607];
            assert!(
                bench.alarms().iter().any(|number| known.contains(number)),
                "{:?}",
                bench.events
            );
        }
    }
}

#[test]
fn an_unplugged_cable_is_an_alarm_within_a_second() {
    for variant in ALL {
        let mut bench = Bench::ready(variant);
        for k in 1..=300 {
            assert!(bench.sample(0, -k * 4));
        }
        bench.twin.to_host.set_cut(true);
        bench.twin.to_board.set_cut(true);
        bench.pass(1000);
        assert_eq!(
            (bench.link.state(), bench.alarms()),
            (LinkState::Lost, vec![605])
        );
        // What the board held it made, then it stood.
        let stood = bench.twin.pulses();
        bench.pass(2000);
        assert_eq!(bench.twin.pulses(), stood);
    }
}

/// A decimal point lost on the wire makes a valid line with another meaning; the
/// wire has no checksum. The board is stopped as soon as it reports itself off the
/// path.
#[test]
fn a_board_off_the_path_is_stopped() {
    for variant in ALL {
        let mut alarms = Vec::new();
        for byte in 0..16 {
            let mut bench = Bench::ready(variant);
            for k in 1..=300 {
                assert!(bench.sample(k, -k * 4));
            }
            // Somewhere in the next lines: a digit turns into another one, a letter is
            // refused by the board.
            let from = bench.twin.to_board.sent_count();
            bench
                .twin
                .to_board
                .damage(from + byte, Damage::Changed(b'2' ^ b'6'));
            for k in 301..=600 {
                if !bench.sample(k, -k * 4) {
                    break;
                }
            }
            bench.pass(2000);
            if bench.alarms().is_empty() {
                // Within the tolerance of a report.
                continue;
            }
            assert_eq!(bench.link.state(), LinkState::Fault, "{:?}", bench.events);
            let stood = bench.twin.pulses();
            bench.pass(2000);
            assert_eq!(bench.twin.pulses(), stood);
            alarms.extend(bench.alarms());
        }
        assert!(alarms.iter().all(|alarm| matches!(alarm, 608 | 611)));
        assert!(alarms.contains(&611), "{alarms:?}");
    }
}

/// A fault at every byte of a short job, either way: the job ends on the pulse
/// with the count compared, or it stands with an alarm. Nothing third.
#[test]
fn a_fault_at_any_byte_ends_known_or_declared_unknown() {
    for variant in ALL {
        // EVERY_BYTE=1 leaves none out, and does everything to each.
        let every = std::env::var_os("EVERY_BYTE").is_some();
        let step = if every { 1 } else { 7 };
        let damages = [
            Damage::Lost,
            Damage::Changed(0x15),
            Damage::Doubled,
            Damage::Delayed(100 * MS),
            Damage::Cut,
        ];
        let ready = Bench::ready(variant);
        let clean = {
            let mut bench = ready.clone();
            assert!(bench.job() && bench.ends_ready());
            (
                bench.twin.to_board.sent_count(),
                bench.twin.to_host.sent_count(),
            )
        };
        let (mut proved, mut stopped) = (0, 0);
        for (to_board, first, last) in [
            (true, ready.twin.to_board.sent_count(), clean.0),
            (false, ready.twin.to_host.sent_count(), clean.1),
        ] {
            for (index, byte) in (first..last).step_by(step).enumerate() {
                let one = index % damages.len();
                let kinds = if every {
                    &damages[..]
                } else {
                    &damages[one..=one]
                };
                for &damage in kinds {
                    let mut bench = ready.clone();
                    if to_board {
                        bench.twin.to_board.damage(byte, damage);
                    } else {
                        bench.twin.to_host.damage(byte, damage);
                    }
                    let whole = bench.job();
                    bench.pass(4000);
                    let place = format!("{damage:?} at {byte}, to the board: {to_board}");
                    match bench.link.state() {
                        LinkState::Ready if whole && bench.alarms().is_empty() => {
                            assert_eq!(bench.twin.pulses(), [0, -100], "{place}");
                            proved += 1;
                        }
                        LinkState::Locked
                        | LinkState::Fault
                        | LinkState::Lost
                        | LinkState::Tripped => {
                            assert!(!bench.alarms().is_empty(), "{place}");
                            stopped += 1;
                        }
                        state => panic!("{place}: {state:?} {:?}", bench.events),
                    }
                    let stood = bench.twin.pulses();
                    bench.pass(1000);
                    assert_eq!(bench.twin.pulses(), stood, "{place}: it moves on");
                }
            }
        }
        assert!(proved > 0 && stopped > 0, "{proved} {stopped}");
    }
}

#[test]
fn a_report_under_way_when_the_reference_return_begins_tells_no_place() {
    for variant in ALL {
        let mut bench = Bench::ready(variant);
        assert!(bench.job() && bench.ends_ready());
        let reports = bench.link.traffic().reports;
        // The next question has just gone out; its answer comes while the board homes.
        let mut asked = false;
        for _ in 0..300 {
            bench.ms();
            asked = bench.last_tx.contains(&b'?');
            if asked {
                break;
            }
        }
        assert!(asked && bench.link.traffic().reports >= reports);
        bench.link.home(PerAxis::new(true, true)).unwrap();
        let homed = |event: &LinkEvent| matches!(event, LinkEvent::Homed(_));
        assert!(bench.wait(120_000, |bench| bench.events.iter().any(homed)));
        let zero = PerAxis::new(Pulses(0), Pulses(0));
        assert!(bench.wait(1000, |bench| bench.link.status().is_some()));
        bench.link.set_position(zero, bench.run).unwrap();
        bench.pass(500);
        assert_eq!(bench.alarms(), [0_u16; 0], "{variant:?}");
        assert_eq!(bench.link.state(), LinkState::Ready);
    }
}

#[test]
fn letters_of_a_report_are_contacts_of_the_control() {
    let mut bench = Bench::new(Variant::Grbl);
    let config: LinkConfig = ron::from_str(r#"(inputs: {"X2.0": "P", "X2.1": "!D"})"#).unwrap();
    config.check().unwrap();
    bench.link = LineLink::open(config, &drives(&Parameters::default()), Duration::ZERO);
    let contact = |bit| Input::Contact { byte: 2, bit };
    assert_eq!(
        bench.link.input(contact(0)),
        None,
        "nothing was reported yet"
    );
    bench.open();
    bench.pass(500);
    let both = |bench: &Bench| [0, 1].map(|bit| bench.link.input(contact(bit)));
    assert_eq!(both(&bench), [Some(false), Some(true)]);
    bench.twin.pins.probe = true;
    bench.twin.pins.door = true;
    bench.pass(500);
    assert_eq!(both(&bench), [Some(true), Some(false)]);
    assert_eq!(bench.link.input(contact(2)), None, "not wired");
    assert_eq!(bench.link.input(Input::LimitX), Some(false));
}

/// Old or other firmware is named and refused; nothing is written into it.
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
            &drives(&Parameters::default()),
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
        let told = events.iter().any(
            |event| matches!(event, LinkEvent::Alarm { number: 602, detail } if detail.to_string().contains(named)),
        );
        assert!(told, "{identity}: {events:?}");
        assert_eq!(link.state(), LinkState::Fault);
        assert_eq!(sent, b"\x18\n$I\n", "{identity}");
    }
}

/// Somebody opened its door, or put it into another state: it is stopped, and said.
#[test]
fn a_state_nobody_asked_for_is_607() {
    for state in ["Door:0", "Tool", "Sleep", "Check", "Jog"] {
        let mut bench = Bench::ready(Variant::GrblHal);
        for k in 1..=300 {
            assert!(bench.sample(0, -k * 4));
        }
        let said = format!("<{state}|MPos:0.000,0.000,-4.000|Bf:90,1000|FS:0,0>\r\n");
        let now = bench.twin.now();
        bench.twin.to_host.send(said.as_bytes(), now);
        bench.pass(2000);
        assert_eq!(bench.alarms(), [607], "{state}: {:?}", bench.events);
        assert_eq!(bench.link.state(), LinkState::Fault, "{state}");
        let stood = bench.twin.pulses();
        bench.pass(1000);
        assert_eq!(bench.twin.pulses(), stood, "{state}");
    }
}

/// The line protocol has no checksum: `X1.005` may arrive as `X9.005` or `X1005`. What
/// the slides do until the next report tells is bounded: at a feed of 1200 mm/min less than
/// 1 mm, and 5 mm with FluidNC, whose pulse timer makes 120 ms more.
#[test]
fn a_figure_damaged_on_the_way_is_stopped_within_millimetres() {
    for variant in ALL {
        let every = std::env::var_os("EVERY_BYTE").is_some();
        let mut stopped = 0;
        for byte in (0..160).step_by(if every { 1 } else { 7 }) {
            let bits = (0..8).map(|bit| Damage::Changed(1 << bit));
            for damage in bits.chain([Damage::Lost]) {
                let place = format!("{damage:?} at {byte}");
                let mut bench = Bench::ready(variant);
                for k in 1..=300 {
                    assert!(bench.sample(k, -4 * k));
                }
                let from = bench.twin.to_board.sent_count();
                bench.twin.to_board.damage(from + byte, damage);
                let (mut k, mut farthest) = (300, 0);
                for _ in 0..1500 {
                    let room = bench.link.free_lookahead() >= Duration::from_millis(10);
                    if k < 600 && room && bench.link.state().takes_motion() {
                        k += 1;
                        bench.sample(k, -4 * k);
                    } else {
                        bench.ms();
                    }
                    let [x, z] = bench.twin.pulses();
                    let off = (0..=600).map(|k| (x - k).abs().max((z + 4 * k).abs()));
                    farthest = farthest.max(off.min().unwrap());
                }
                let most = match variant {
                    Variant::Grbl | Variant::GrblHal => 200,
                    Variant::FluidNc => 1000,
                };
                assert!(farthest <= most, "{variant:?} {place}: {farthest} pulses");
                stopped += i32::from(!bench.alarms().is_empty());
            }
        }
        assert!(stopped > 0);
    }
}

/// Wherever the program was cut off, in the middle of a line, too: the bytes for whoever
/// holds the port, sent a few times, leave a board that stands with its spindle off.
#[test]
fn the_bytes_that_stop_the_board_do_so_behind_any_broken_line() {
    for variant in ALL {
        let begun = Bench::ready(variant);
        for cut in 0..40 {
            let mut bench = begun.clone();
            assert_eq!(bench.link.stop_bytes(), [0x18]);
            bench.twin.write(b"M3S500\n");
            // Whole pieces of motion, and one that is broken off.
            let lines = "G53G1X10F600\nG53G1X20F600\nG53G1X30F600\n";
            bench.twin.write(&lines.as_bytes()[..cut]);
            bench.twin.advance(cut as u64 * 3 * MS);
            for ms in [0, 30, 70, 150, 350] {
                bench.twin.advance(ms * MS);
                bench.twin.write(&bench.link.stop_bytes());
            }
            bench.twin.advance(1000 * MS);
            let stood = bench.twin.pulses();
            bench.twin.advance(1000 * MS);
            assert_eq!(bench.twin.pulses(), stood, "{variant:?} {cut}: it moves on");
            let (spindle, ..) = bench.twin.outputs();
            assert_eq!(spindle, 5, "{variant:?} {cut}: the spindle goes on");
        }
    }
}
/// However short of a whole piece of motion an axis turns: it goes all the way.
#[test]
fn an_axis_turns_where_it_was_commanded_to() {
    for variant in ALL {
        for top in [331_i64, 337] {
            let mut bench = Bench::ready(variant);
            let mut most = 0;
            for k in 1..=2 * top {
                assert!(bench.sample(0, top - (k - top).abs()));
                bench.ms();
                most = most.max(bench.twin.pulses()[1]);
            }
            bench.link.finish().unwrap();
            assert!(bench.ends_ready(), "{:?}", bench.events);
            assert_eq!((most, bench.twin.pulses()[1]), (top, 0), "{variant:?}");
        }
    }
}

/// With motion that has found no room in the board yet, too.
#[test]
fn a_computer_that_was_away_is_612_whatever_waited() {
    for variant in ALL {
        for away in [160, 400, 2000] {
            let mut bench = Bench::ready(variant);
            for k in 1..=600 {
                assert!(bench.sample(0, 2 * k));
            }
            // Nothing more is answered, and lines wait here.
            while bench.link.free_lookahead() > Duration::ZERO {
                let (x, z) = bench.at;
                assert!(bench.sample(x, z + 2));
            }
            bench.twin.advance(away * MS);
            bench.pass(3000);
            let alarms = bench.alarms();
            assert!(
                matches!(*alarms, [] | [612]),
                "{variant:?} {away} {alarms:?}"
            );
            let state = bench.link.state();
            assert!(
                matches!(state, LinkState::Ready | LinkState::Moving),
                "{state:?}"
            );
            if state == LinkState::Ready {
                let told = bench.events.iter().rev().find_map(|event| match event {
                    LinkEvent::Position(at) => Some([at.x.0, at.z.0]),
                    _ => None,
                });
                assert_eq!(told, Some(bench.twin.pulses()), "{variant:?} {away}");
            }
        }
    }
}

/// Behind a limit switch Grbl hears nothing but a reset, and what an earlier host was
/// greeted with waits in the port.
#[test]
fn a_board_behind_its_limit_switch_is_known_although_an_old_banner_waits() {
    let mut bench = Bench::ready(Variant::Grbl);
    for k in 1..=300 {
        assert!(bench.sample(0, 2 * k));
    }
    // The host is gone.
    bench.twin.pins.limit_z = true;
    bench.twin.advance(3000 * MS);
    bench.twin.pins.limit_z = false;
    let _ = bench.twin.read();
    let now = Duration::from_nanos(bench.twin.now());
    let mut parameters = Parameters::default();
    for number in [17, 18] {
        parameters.set(number, 5).unwrap();
    }
    bench.link = LineLink::open(LinkConfig::default(), &drives(&parameters), now);
    bench.events.clear();
    bench.link.rx(b"\r\nGrbl 1.1h ['$' for help]\r\n", now);
    assert!(
        bench.wait(6000, |bench| bench.link.state() == LinkState::Locked),
        "{:?}",
        bench.events
    );
    assert_eq!(bench.alarms(), [0_u16; 0]);
}
