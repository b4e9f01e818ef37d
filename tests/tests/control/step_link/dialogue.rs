//! How the board becomes known, and what else hangs on it.

use core::time::Duration;

use gsk_core::linked::drives;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_link::step_queue::StepLink;
use gsk_link::{
    Backend, Input, LinkConfig, LinkEvent, LinkState, MotionRefused, Output, SpindleView, Stop,
};
use gsk_messages::say;
use gsk_twins::klipper::{KlipperHardware, KlipperState};

use super::bench::{Bench, config, parameters};
use super::machine::Machine;

#[test]
fn a_board_is_identified_set_up_and_locked() {
    let mut bench = Bench::new(KlipperHardware::default());
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [0_u16; 0]);
    let board = bench.link.board();
    assert_eq!(board.firmware, "atmega2560 v0.13.0-730");
    assert_eq!((board.blocks, board.receive_bytes), (657, 192));
    assert_eq!(bench.twin.statistics().identify_count, 91);
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
    let mut bench = Bench::new(KlipperHardware::default());
    assert!(bench.gets(LinkState::Locked, 3000));
    let now = Duration::from_nanos(bench.twin.now());
    bench.link = StepLink::open(config(), &drives(&parameters()), now);
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.twin.state(), KlipperState::Running);
    // The deceleration switch of Z was moved: the board is reset and set up anew.
    let mut other = config();
    other.z.dec = "PC7".to_owned();
    let now = Duration::from_nanos(bench.twin.now());
    bench.link = StepLink::open(other, &drives(&parameters()), now);
    assert!(bench.gets(LinkState::Configure, 3000));
    assert!(bench.wait(1000, |bench| bench.twin.state() == KlipperState::Booting));
    assert!(bench.gets(LinkState::Locked, 3000), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [0_u16; 0]);
}

/// Connected with these wires; what is told of it.
fn refused(change: impl Fn(&mut LinkConfig)) -> Vec<(u16, String)> {
    let mut wrong = config();
    change(&mut wrong);
    let mut bench = Bench::wired(wrong, KlipperHardware::default());
    assert!(bench.gets(LinkState::Fault, 5000), "{:?}", bench.events);
    let told = bench.events.iter().filter_map(|event| match event {
        LinkEvent::Alarm { number, detail } => Some((*number, detail.to_string())),
        _ => None,
    });
    told.collect()
}

#[test]
fn a_configuration_that_the_board_gives_up_at_is_refused_in_its_own_words() {
    let told = refused(|wrong| wrong.io.spindle_pwm = "PB6".into());
    let text = "the board does not take its configuration: Can not use timer1 for PWM; timer1 \
                is used for timers (link.io.spindle_pwm: PB6)";
    assert_eq!(told, [(603, text.to_owned())]);
    let told = refused(|wrong| wrong.io.spindle_pwm = "PA5".into());
    let text = "the board does not take its configuration: Not a valid PWM pin \
                (link.io.spindle_pwm: PA5)";
    assert_eq!(told, [(603, text.to_owned())]);
}

#[test]
fn a_pin_that_the_board_needs_for_itself_is_named() {
    let told = refused(|wrong| wrong.io.coolant = "PE1".into());
    let text = "link.io.coolant: the board needs PE1 for itself (serial)";
    assert_eq!(told, [(603, text.to_owned())]);
}

#[test]
fn a_board_that_gave_up_at_its_pins_takes_the_right_ones_behind_it() {
    let mut wrong = config();
    wrong.io.spindle_pwm = "PB6".into();
    let mut bench = Bench::wired(wrong, KlipperHardware::default());
    assert!(bench.gets(LinkState::Fault, 5000), "{:?}", bench.events);
    bench.open_again();
    assert!(bench.gets(LinkState::Locked, 5000), "{:?}", bench.events);
    assert_eq!(bench.alarms(), [0_u16; 0]);
}

#[test]
fn a_pin_the_board_has_not_is_named() {
    let mut wrong = config();
    wrong.z.limit = "^PQ1".to_owned();
    let mut bench = Bench::new(KlipperHardware::default());
    bench.link = StepLink::open(wrong, &drives(&parameters()), Duration::ZERO);
    assert!(bench.gets(LinkState::Fault, 3000));
    let alarm = LinkEvent::Alarm {
        number: 603,
        detail: say::board_pin_missing("z.limit", "PQ1"),
    };
    assert!(bench.events.contains(&alarm), "{:?}", bench.events);
}

#[test]
fn a_silent_port_is_601_and_another_firmware_602() {
    for (says, number, state) in [
        ("", 601, LinkState::Lost),
        ("Grbl 1.1h ['$' for help]\r\n~", 602, LinkState::Fault),
    ] {
        let mut link = StepLink::open(config(), &drives(&parameters()), Duration::ZERO);
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
                LinkEvent::Alarm { number, detail } => {
                    let text = detail.to_string();
                    let points = text.contains("protocol") && text.contains("baud");
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
        Err(MotionRefused::NotWired)
    );
    while bench.twin.output("PB7") == Some(1) {
        assert!(bench.feed(-1.0, 1));
    }
    let late = bench.link.executed().abs_diff(at);
    assert!(late <= Duration::from_millis(15), "{late:?}");
    assert_eq!(bench.twin.output("PH6"), Some(127));
    bench.link.stop(Stop::Kill);
    bench.write();
    bench.pass(20);
    assert_eq!(
        (bench.twin.output("PB7"), bench.twin.output("PH6")),
        (Some(1), Some(0))
    );
}

#[test]
fn the_index_tells_the_speed_of_the_spindle() {
    let mut bench = Bench::ready();
    assert_eq!(bench.link.spindle(None), Some(SpindleView::default()));
    bench.twin.run_spindle("PC3", 600.0);
    bench.pass(3000);
    let view = bench.link.spindle(None).unwrap();
    assert!((view.rpm - 600.0).abs() < 0.5, "{view:?}");
    assert!((view.now - view.before - 0.01).abs() < 1e-5, "{view:?}");
    assert!(view.variation.unwrap() < 0.001, "{view:?}");
    bench.twin.set_index_lost(true);
    bench.pass(600);
    let view = bench.link.spindle(None).unwrap();
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
