//! How the board becomes known, and what else hangs on it.

use core::time::Duration;

use gsk_core::machine::link::step_queue::StepLink;
use gsk_core::machine::link::{Event, Input, LinkState, Output, Refused, SpindleView, Stop};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_twins::klipper::{Make, State};

use crate::bench::{Bench, config, parameters};
use crate::machine::Machine;

#[test]
fn a_board_is_identified_set_up_and_locked() {
    let mut bench = Bench::new(Make::default());
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [0_u16; 0]);
    let board = bench.link.board();
    assert_eq!(board.firmware, "atmega2560 v0.13.0-730");
    assert_eq!((board.blocks, board.receive_bytes), (657, 192));
    assert_eq!(bench.twin.figures().identify, 91);
    assert_eq!(bench.made(), (0, 0), "knowing each other moves nothing");
    bench.pass(200);
    assert_eq!(bench.link.input(Input::EmergencyStop), Some(false));
    assert_eq!(bench.link.input(Input::ZeroZ), None);
    assert_eq!(bench.twin.output("PL0"), Some(0), "the drives are off");
    bench.set_position();
    bench.pass(300);
    assert_eq!(bench.twin.output("PL0"), Some(1));
}

#[test]
fn a_board_keeps_its_configuration_over_a_new_port_and_not_over_another_machine_file() {
    let mut bench = Bench::new(Make::default());
    assert!(bench.gets(LinkState::Locked, 3000));
    let now = Duration::from_nanos(bench.twin.now());
    bench.link = StepLink::open(config(), &parameters(), now);
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.twin.state(), State::Runs);
    // The deceleration switch of Z was moved: the board is reset and set up anew.
    let mut other = config();
    other.z.dec = "PC7".to_owned();
    let now = Duration::from_nanos(bench.twin.now());
    bench.link = StepLink::open(other, &parameters(), now);
    assert!(bench.gets(LinkState::Configure, 3000));
    assert!(bench.wait(1000, |bench| bench.twin.state() == State::Boots));
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [0_u16; 0]);
}

#[test]
fn a_pin_the_board_has_not_is_named() {
    let mut wrong = config();
    wrong.z.limit = "^PQ1".to_owned();
    let mut bench = Bench::new(Make::default());
    bench.link = StepLink::open(wrong, &parameters(), Duration::ZERO);
    assert!(bench.gets(LinkState::Fault, 3000));
    let text = "link.z.limit: the board has no pin PQ1".to_owned();
    let alarm = Event::Alarm {
        number: 603,
        detail: text,
    };
    assert!(bench.events.contains(&alarm), "{:?}", bench.events);
}

#[test]
fn a_silent_port_is_601_and_another_firmware_602() {
    for (says, number, state) in [
        ("", 601, LinkState::Lost),
        ("Grbl 1.1h ['$' for help]\r\n~", 602, LinkState::Fault),
    ] {
        let mut link = StepLink::open(config(), &parameters(), Duration::ZERO);
        let mut alarms = Vec::new();
        for ms in 0..6000 {
            let now = Duration::from_millis(ms);
            if ms % 1000 == 500 {
                link.rx(says.as_bytes(), now);
            }
            link.tick(now);
            let count = link.tx().len();
            link.consumed(count);
            alarms.extend(link.events().into_iter().filter_map(|event| match event {
                Event::Alarm { number, detail } => {
                    let points = detail.contains("protocol") && detail.contains("baud");
                    assert!(points, "{detail}");
                    Some(number)
                }
                _ => None,
            }));
        }
        assert_eq!((alarms, link.state()), (vec![number], state));
    }
}

#[test]
fn outputs_switch_with_the_motion() {
    let mut bench = Bench::ready();
    assert_eq!(bench.twin.output("PB7"), Some(1), "turned over");
    assert!(bench.feed(-1.0, 100));
    let at = bench.run;
    bench.link.output(at, Output::Coolant, 1).unwrap();
    bench.link.output(at, Output::SpindleSpeed, 5000).unwrap();
    assert_eq!(
        bench.link.output(at, Output::SpindleReverse, 1),
        Err(Refused::NotWired)
    );
    while bench.twin.output("PB7") == Some(1) {
        assert!(bench.feed(-1.0, 1));
    }
    let late = bench.link.executed().abs_diff(at);
    assert!(late <= Duration::from_millis(15), "{late:?}");
    assert_eq!(bench.twin.output("PB6"), Some(127));
    bench.link.stop(Stop::Kill);
    bench.write();
    bench.pass(20);
    assert_eq!(
        (bench.twin.output("PB7"), bench.twin.output("PB6")),
        (Some(1), Some(0))
    );
}

#[test]
fn the_index_tells_the_speed_of_the_spindle() {
    let mut bench = Bench::ready();
    assert_eq!(bench.link.spindle(None), SpindleView::default());
    bench.twin.turn_spindle("PC3", 600.0);
    bench.pass(3000);
    let view = bench.link.spindle(None);
    assert!((view.rpm - 600.0).abs() < 0.5, "{view:?}");
    assert!((view.now - view.before - 0.01).abs() < 1e-5, "{view:?}");
    assert!(view.variation.unwrap() < 0.001, "{view:?}");
    bench.twin.lose_index(true);
    bench.pass(600);
    let view = bench.link.spindle(None);
    assert!(view.rpm == 0.0 && view.now == view.before, "{view:?}");
}

#[test]
fn contacts_of_the_control_are_read_at_the_board() {
    let mut config = config();
    for (contact, pin) in [("X2.0", "PD0"), ("X1.4", "^!PD1")] {
        config.inputs.insert(contact.to_owned(), pin.to_owned());
    }
    config.check().unwrap();
    let mut machine = Machine::with(config, &[]);
    machine.twin.set_pin("PD1", true);
    machine.return_axes();
    let closed = |machine: &Machine| {
        [(2, 0), (1, 4)].map(|(byte, bit)| {
            let contact = BitAddress::new(Area::X, byte, bit);
            machine.simulation.cnc.plc().memory().bit(contact)
        })
    };
    assert_eq!(closed(&machine), [false, false]);
    machine.twin.set_pin("PD0", true);
    machine.twin.set_pin("PD1", false);
    machine.pass(150);
    assert_eq!(closed(&machine), [true, true]);
    let inputs = machine.linked.inputs();
    let state = |input| inputs.iter().find(|(told, _)| *told == input).unwrap().1;
    assert_eq!(state(Input::Contact { byte: 2, bit: 0 }), Some(true));
    assert_eq!(state(Input::LimitZ), Some(false));
    assert_eq!(state(Input::DriveAlarm), None, "not wired");
    assert_eq!(machine.linked.missing_outputs(), [Output::SpindleReverse]);
}
