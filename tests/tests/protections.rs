//! Tries every page that writes against every protection. The table `protections.txt` lists
//! what is written, what is refused, and the alarm.

use std::collections::BTreeSet;

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::operation::SoftSwitch;
use gsk_core::plc::address::{Area, ByteAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::PageId;
use gsk_panel::script::{self, Script};
use gsk_tests::repository;

/// A dwell longer than every script.
const PROGRAM: &str = "\nG04 X9000;\nM30;\n";

/// The data that a page writes, as text, for a comparison before and after.
type PageData = fn(&Emulator) -> String;

struct WritingPage {
    name: &'static str,
    /// The key of the mode it needs; empty for any mode.
    mode: &'static str,
    /// The keys that write.
    keys: &'static str,
    seen: PageData,
}

const fn writing_page(
    name: &'static str,
    mode: &'static str,
    keys: &'static str,
    data: PageData,
) -> WritingPage {
    WritingPage {
        name,
        mode,
        keys,
        seen: data,
    }
}

const WRITING_PAGES: [WritingPage; 29] = [
    writing_page(
        "prg-text",
        "EDIT",
        "press DOWN\ntype G4\npress POS",
        programs,
    ),
    writing_page("prg-create", "EDIT", "type O55\npress EOB", programs),
    writing_page("prg-delete", "EDIT", "type O7\npress DEL", programs),
    writing_page("prg-delete-all", "EDIT", "type O-999\npress DEL", programs),
    writing_page("prg-rename", "EDIT", "type O56\npress INS", programs),
    writing_page("prg-save-as", "EDIT", "type O57\npress CHG", programs),
    writing_page(
        "prg-9000-text",
        "EDIT",
        "press DOWN\ntype G4\npress POS",
        |emulator| {
            let program = cnc(emulator).programs().stored(9001);
            format!("{:?}", program.map(Program::text))
        },
    ),
    writing_page("prg-9000-create", "EDIT", "type O9002\npress EOB", programs),
    writing_page("prg-9000-delete", "EDIT", "type O9001\npress DEL", programs),
    writing_page(
        "mdi",
        "MDI",
        "press PRG\npress PGDN\ntype G1\npress IN",
        |emulator| cnc(emulator).mdi_block().text(),
    ),
    writing_page(
        "oft",
        "",
        "press OFT\ntype P1\npress IN\ntype R1.5\npress IN",
        offsets,
    ),
    writing_page(
        "macro",
        "MDI",
        "press OFT\npress PGUP\ntype 5\npress IN",
        |emulator| format!("{:?}", cnc(emulator).variables()),
    ),
    writing_page(
        "set-code",
        "MDI",
        "press SET\npress UP\ntype 1\npress IN",
        |emulator| format!("{:?}", cnc(emulator).settings()),
    ),
    writing_page(
        "set-switch",
        "",
        "press SET\npress PGDN\ntype D",
        |emulator| cnc(emulator).is_parameter_switch_on().to_string(),
    ),
    writing_page(
        "set-switch-prg",
        "",
        "press SET\npress PGDN\npress DOWN\ntype W",
        |emulator| cnc(emulator).is_program_switch_on().to_string(),
    ),
    writing_page(
        "edisk-save",
        "MDI",
        "press SET\npress PGDN\npress PGDN\ntype 5",
        |emulator| format!("{:?}", cnc(emulator).disks()),
    ),
    writing_page(
        "edisk-read",
        "MDI",
        "press SET\npress PGDN\npress PGDN\ntype 3",
        parameters,
    ),
    writing_page(
        "password",
        "",
        "press SET\npress PGUP\ntype 123456\npress IN",
        |emulator| cnc(emulator).authority().level().number().to_string(),
    ),
    writing_page(
        "graph-plane",
        "MDI",
        "press SET\npress SET\ntype 1\npress IN",
        graphic,
    ),
    writing_page(
        "graph-extent",
        "MDI",
        "press SET\npress SET\npress UP\ntype 50\npress IN",
        graphic,
    ),
    writing_page(
        "par-bit",
        "MDI",
        "press PAR\ntype P5\npress IN\ntype 00010001\npress IN",
        parameters,
    ),
    writing_page(
        "par-data",
        "MDI",
        "press PAR\npress PAR\ntype P24\npress IN\ntype 333\npress IN",
        parameters,
    ),
    writing_page(
        "pitch",
        "MDI",
        "press PAR\npress PAR\npress PAR\ntype X5\npress IN",
        |emulator| format!("{:?}", cnc(emulator).pitch()),
    ),
    writing_page(
        "dgn-075",
        "MDI",
        "press DGN\ntype P75\npress IN\ntype 3\npress IN",
        |emulator| cnc(emulator).plc().memory().k(12).to_string(),
    ),
    writing_page(
        "plc-preset",
        "MDI",
        "press DGN\npress DGN\npress DGN\ntype 7\npress IN",
        |emulator| {
            let d0 = ByteAddress::new(Area::D, 0);
            cnc(emulator).plc().memory().byte(d0).to_string()
        },
    ),
    writing_page(
        "rel-zero",
        "",
        "press POS\npress U\npress CAN",
        |emulator| format!("{:?}", cnc(emulator).position_relative()),
    ),
    writing_page(
        "parts",
        "",
        "press POS\ndown CAN\npress N\nup CAN",
        |emulator| cnc(emulator).counters().parts.to_string(),
    ),
    writing_page(
        "cutting-time",
        "",
        "press POS\ndown CAN\npress T\nup CAN",
        |emulator| (cnc(emulator).counters().cutting_ms / 3_600_000).to_string(),
    ),
    writing_page(
        "softpanel",
        "",
        "press DGN\npress DGN\npress DGN\npress DGN\ntype 1\nwait 300ms",
        |emulator| {
            cnc(emulator)
                .is_soft_switch_active(SoftSwitch::ALL[0])
                .to_string()
        },
    ),
];

const fn cnc(emulator: &Emulator) -> &Cnc {
    emulator.cnc()
}

fn programs(emulator: &Emulator) -> String {
    let programs = cnc(emulator).programs().iter();
    let texts = programs.map(|(number, program)| format!("O{number:04} {}\n", program.text()));
    texts.collect()
}

fn offsets(emulator: &Emulator) -> String {
    format!("{:?}", cnc(emulator).offsets())
}

fn parameters(emulator: &Emulator) -> String {
    format!("{:?}", cnc(emulator).parameters())
}

fn graphic(emulator: &Emulator) -> String {
    format!("{:?}", emulator.panel().view().graphic)
}

fn run_script(emulator: &mut Emulator, text: &str, why: &str) {
    let script = Script::parse(text).unwrap();
    let done = script::run(script, emulator, &mut |_, _| {
        Ok::<(), core::convert::Infallible>(())
    });
    assert!(done.is_ok(), "{why}: {done:?}");
}

/// The machine on a page, with a protection active.
fn prepare_machine(page: &WritingPage, protection: &str) -> Emulator {
    let mut setup = Setup::default();
    let bit = match protection {
        "EAL" => Some((12, 3, false)),
        "SKEY" => Some((172, 1, true)),
        "PRG9" => Some((12, 4, true)),
        // Else the switches must be on before.
        "MPWE" if page.name == "set-switch" => Some((172, 2, true)),
        _ => None,
    };
    if let Some((number, bit, on)) = bit {
        setup.memory.parameters.set_bit(number, bit, on).unwrap();
    }
    for number in [7, 12, 9001] {
        setup
            .memory
            .programs
            .store(format!("O{number:04};{PROGRAM}"))
            .unwrap();
    }
    setup.memory.counters.parts = 5;
    setup.memory.counters.cutting_ms = 3_600_000;
    let mut emulator = Emulator::new(setup);
    // The self-test picture is skipped: there are 400 of them.
    emulator.show_page(PageId::PosRel);
    emulator.run(100);
    let selected = if page.name.starts_with("prg-9000") {
        9001
    } else {
        12
    };
    // Hidden programs cannot be selected; that is their protection.
    let _ = emulator.request(ControlRequest::SelectProgram(selected));
    emulator.press(gsk_panel::keys::Key::Reset);
    // The switches are set before what forbids to set them.
    let switch = protection != "PSW" && page.name != "set-switch";
    if switch {
        switch_on(&mut emulator);
    }
    let request = match protection {
        "L4" => Some(ControlRequest::EnterPassword("1234".to_owned())),
        "L5" => Some(ControlRequest::LowerLevel),
        "MPWE" if switch => Some(ControlRequest::SetParameterBit {
            number: 172,
            bit: 2,
            on: true,
        }),
        _ => None,
    };
    if let Some(request) = request {
        if matches!(request, ControlRequest::SetParameterBit { .. }) {
            run_script(&mut emulator, "press MDI", protection);
        }
        emulator.request(request).unwrap();
    }
    if protection == "PRG" {
        run_script(
            &mut emulator,
            "press SET\npress PGDN\npress DOWN\ntype W\npress UP\npress POS",
            "switch",
        );
    }
    let keys = match protection {
        "run" => "press AUTO\npress CS\nwait 300ms\nexpect lamp CS on",
        "alarm" | "EAL" => {
            "press EDIT\npress PRG\npress CHG\ntype N77\npress DOWN\nexpect alarm 071"
        }
        "estop" => "press ESTOP\nwait 100ms\nexpect alarm 207",
        "KEY1" => "force G46.3 1",
        _ => "",
    };
    run_script(&mut emulator, keys, protection);
    emulator
}

/// Switches the parameter switch on and clears its alarm.
fn switch_on(emulator: &mut Emulator) {
    for request in [
        ControlRequest::SetParameterSwitch(true),
        ControlRequest::CancelSwitchAlarm,
    ] {
        emulator.request(request).unwrap();
    }
    assert!(cnc(emulator).is_parameter_switch_on());
}

/// The result of the keys: `ok`, `-`, or the alarm.
fn key_result(page: &WritingPage, protection: &str) -> String {
    let mut emulator = prepare_machine(page, protection);
    let mode = match protection {
        "jog" | "estop" => "JOG",
        _ => page.mode,
    };
    if !mode.is_empty() {
        run_script(&mut emulator, &format!("press {mode}"), "mode");
    }
    if page.name.starts_with("prg") {
        run_script(&mut emulator, "press PRG", "page");
    }
    let numbers = |emulator: &Emulator| -> BTreeSet<u16> {
        cnc(emulator)
            .alarms()
            .iter()
            .map(|alarm| alarm.number)
            .collect()
    };
    let (before, alarms) = ((page.seen)(&emulator), numbers(&emulator));
    run_script(&mut emulator, page.keys, page.name);
    let changed = (page.seen)(&emulator) != before;
    let new: Vec<u16> = numbers(&emulator).difference(&alarms).copied().collect();
    match (changed, new.first()) {
        (true, _) => "ok".to_owned(),
        (false, None) => "-".to_owned(),
        (false, Some(number)) => format!("{number:03}"),
    }
}

#[test]
fn every_page_that_writes_against_every_protection() {
    let path = repository().join("tests/protections.txt");
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| line.split_whitespace().collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let rows: Vec<Vec<&str>> = rows.collect();
    let listed: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(
        listed,
        WRITING_PAGES.map(|place| place.name),
        "the places of the table"
    );
    let mut wrong = Vec::new();
    for (row, place) in rows.iter().zip(&WRITING_PAGES) {
        assert_eq!(row.len(), head.len(), "{}: columns", place.name);
        for (protection, expected) in head.iter().zip(row).skip(1) {
            if *expected == "." {
                continue;
            }
            let seen = key_result(place, protection);
            if seen != *expected {
                wrong.push(format!(
                    "{} {protection}: {expected} expected, {seen} seen",
                    place.name
                ));
            }
        }
    }
    if !wrong.is_empty() {
        panic!("{} cells differ:\n{}", wrong.len(), wrong.join("\n"));
    }
}
