//! Tests each instruction slot by slot.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on should say where"
)]

use std::sync::Arc;

use gsk_plc::{Ladder, Plc, PlcFault, PlcMemory};

/// Returns a PLC with `rungs` in level 2 and an empty level 1.
fn plc(rungs: &str) -> Plc {
    let source = format!("END1\n{rungs}\nEND2");
    Plc::new(Arc::new(Ladder::compile(&source).unwrap()))
}

fn bit(plc: &Plc, address: &str) -> bool {
    plc.memory().bit(address.parse().unwrap())
}

fn set(plc: &mut Plc, address: &str, value: bool) {
    plc.memory_mut().set_bit(address.parse().unwrap(), value);
}

/// Runs one slot with R0.0 set to `act`.
fn scan(plc: &mut Plc, act: bool) {
    set(plc, "R0.0", act);
    plc.run_slot();
}

#[test]
fn contacts_in_series_and_parallel() {
    // Rung, and its result for R1 = 0 to 7 (a = R1.0, b = R1.1, c = R1.2).
    let table = [
        ("LD R1.0", "01010101"),
        ("LDI R1.0", "10101010"),
        ("LD R1.0\nAND R1.1", "00010001"),
        ("LD R1.0\nANI R1.1", "01000100"),
        ("LD R1.0\nOR R1.1", "01110111"),
        ("LD R1.0\nORI R1.1", "11011101"),
        ("LD R1.0\nAND R1.1\nOR R1.2", "00011111"),
        ("LD R1.0\nAND R1.1\nLD R1.1\nANI R1.2\nORB", "00110001"),
        ("LD R1.0\nOR R1.1\nLD R1.2\nORI R1.0\nANB", "00100111"),
        (
            "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.0\nLD R1.1\nANI R1.2\nORB\nANB",
            "00110101",
        ),
    ];
    for (rung, expected) in table {
        let mut plc = plc(&format!("{rung}\nOUT R2.0\nOUT Y0.7"));
        for (value, digit) in (0..).zip(expected.chars()) {
            plc.memory_mut().set_r(1, value);
            plc.run_slot();
            assert_eq!(
                bit(&plc, "R2.0"),
                digit == '1',
                "{rung} with R1 = {value:03b}"
            );
            assert_eq!(bit(&plc, "R2.0"), bit(&plc, "Y0.7"));
        }
    }
}

#[test]
fn a_closed_contact_of_a_signal_at_0() {
    let mut plc = plc("LDI F100.3\nOUT G120.0");
    plc.run_slot();
    assert!(bit(&plc, "G120.0"));
}

#[test]
fn set_and_reset_latch_the_bit() {
    let mut plc = plc("LD R0.0\nSET Y1.0\nLD R0.1\nRST Y1.0");
    scan(&mut plc, true);
    assert!(bit(&plc, "Y1.0"));
    scan(&mut plc, false);
    assert!(bit(&plc, "Y1.0"));
    set(&mut plc, "R0.1", true);
    plc.run_slot();
    assert!(!bit(&plc, "Y1.0"));
}

#[test]
fn compare() {
    let table = [
        ("1 5 3", 0b001, 0),
        ("1 3 3", 0b010, 1),
        ("2 300 301", 0b100, 2),
        ("1 R10 127", 0b001, 0),
        ("4 R10 0", 0b100, 2),
        ("2 R10 65535", 0b010, 1),
    ];
    for (operands, three, flags) in table {
        let mut plc = plc(&format!("LD R0.0\nCMP {operands} R5.3"));
        for byte in 10..14 {
            plc.memory_mut().set_r(byte, 0xFF);
        }
        plc.memory_mut().set_r(5, 0b1100_0111);
        scan(&mut plc, false);
        assert_eq!(plc.memory().r(5), 0b1100_0111, "no change without ACT");
        assert_eq!(plc.memory().r(900), 0);
        scan(&mut plc, true);
        assert_eq!(plc.memory().r(5), 0b1100_0111 | three << 3, "{operands}");
        assert_eq!(plc.memory().r(900), flags, "{operands}");
    }
}

#[test]
fn compare_matches_manual_example() {
    let mut plc = plc("LDI R9.0\nCMP 1 5 3 R0.0");
    plc.run_slot();
    assert_eq!(plc.memory().r(0), 0b001);
}

#[test]
fn timer_counts_8_ms_ticks() {
    let mut plc = plc("LD R0.0\nTMRB T0 100 R300.0");
    scan(&mut plc, true);
    for tick in 1..13 {
        plc.run_slot();
        assert!(!bit(&plc, "R300.0"), "tick {tick}");
        assert_eq!(plc.memory().t(0), 8 * tick);
    }
    plc.run_slot();
    assert!(bit(&plc, "R300.0"));
    plc.run_slot();
    assert_eq!(plc.memory().t(0), 100, "stops at its preset");
    scan(&mut plc, false);
    assert!(!bit(&plc, "R300.0"));
    assert_eq!(plc.memory().t(0), 0);
}

#[test]
fn timer_with_preset_0_follows_its_contact() {
    let mut plc = plc("LD R0.0\nTMRB T1 0 R300.0");
    scan(&mut plc, true);
    assert!(bit(&plc, "R300.0"));
    scan(&mut plc, false);
    assert!(!bit(&plc, "R300.0"));
}

#[test]
fn a_changed_preset_acts_at_once() {
    let mut plc = plc("LD R0.0\nTMRB T5 DT20 R300.0");
    plc.memory_mut().set_dt(20, 1000);
    scan(&mut plc, true);
    plc.run_slot();
    plc.memory_mut().set_dt(20, 16);
    plc.run_slot();
    assert!(bit(&plc, "R300.0"));
    plc.memory_mut().set_dt(20, 32);
    plc.run_slot();
    assert!(!bit(&plc, "R300.0"));
    plc.memory_mut().set_dt(20, -5);
    plc.run_slot();
    assert!(bit(&plc, "R300.0"));
}

#[test]
fn a_timer_that_a_jump_skips_keeps_its_value() {
    let mut plc = plc("LD R0.1\nJMPB L1\nLD R0.0\nTMRB T2 1000 R300.0\nLBL L1");
    scan(&mut plc, true);
    plc.run_slot();
    set(&mut plc, "R0.1", true);
    plc.run_slot();
    let value = plc.memory().t(2);
    for _ in 0..20 {
        plc.run_slot();
    }
    assert_eq!(plc.memory().t(2), value);
    set(&mut plc, "R0.1", false);
    plc.run_slot();
    plc.run_slot();
    assert_eq!(plc.memory().t(2), value + 8);
}

fn edges(plc: &mut Plc, number: usize) {
    for _ in 0..number {
        scan(plc, false);
        scan(plc, true);
    }
}

#[test]
fn counter_up() {
    let mut plc = plc("LD R0.0\nCTRC 0000 R100.0 C1 10 R500.0");
    edges(&mut plc, 10);
    assert_eq!((plc.memory().c(1), bit(&plc, "R500.0")), (10, true));
    scan(&mut plc, true);
    assert_eq!((plc.memory().c(1), bit(&plc, "R500.0")), (10, true));
    edges(&mut plc, 1);
    assert_eq!((plc.memory().c(1), bit(&plc, "R500.0")), (0, false));
    edges(&mut plc, 3);
    set(&mut plc, "R100.0", true);
    edges(&mut plc, 1);
    assert_eq!((plc.memory().c(1), bit(&plc, "R500.0")), (0, false));
}

#[test]
fn counter_down_from_its_preset() {
    let mut plc = plc("LD R0.0\nCTRC 0011 R100.0 C2 DC5 R500.0");
    plc.memory_mut().set_dc(5, 3);
    set(&mut plc, "R100.0", true);
    plc.run_slot();
    assert_eq!(plc.memory().c(2), 3);
    set(&mut plc, "R100.0", false);
    let mut seen = Vec::new();
    for _ in 0..4 {
        edges(&mut plc, 1);
        seen.push((plc.memory().c(2), bit(&plc, "R500.0")));
    }
    assert_eq!(seen, [(2, false), (1, true), (3, false), (2, false)]);
}

#[test]
fn a_contact_closed_at_power_on_is_no_edge() {
    let mut plc = plc("LDI R0.0\nCTRC 0000 R100.0 C1 10 R500.0");
    plc.run_slot();
    plc.power_on();
    plc.run_slot();
    assert_eq!(plc.memory().c(1), 0);
}

#[test]
fn counter_continues_after_power_off() {
    let mut plc = plc("LD R0.0\nCTRC 0000 R100.0 C1 10 R500.0");
    edges(&mut plc, 4);
    plc.power_on();
    edges(&mut plc, 1);
    assert_eq!(plc.memory().c(1), 5);
}

#[test]
fn move_copies_its_length() {
    let mut plc = plc(
        "LD R0.0\nMOVN 1 255 D0\nMOVN 2 4660 R10\nMOVN 4 2000000000 DT30\nMOVN 2 DT30 R20\nMOVN 1 7 C9",
    );
    plc.memory_mut().set_c(9, 0x0102_0304);
    scan(&mut plc, false);
    assert_eq!((plc.memory().d(0), plc.memory().dt(30)), (0, i32::MAX));
    scan(&mut plc, true);
    let memory = plc.memory();
    assert_eq!((memory.d(0), memory.d(1)), (255, 0));
    assert_eq!((memory.r(10), memory.r(11)), (0x34, 0x12));
    assert_eq!(memory.dt(30), 2_000_000_000);
    assert_eq!(
        memory.word("R20".parse().unwrap()),
        (2_000_000_000 & 0xFFFF) as u16
    );
    assert_eq!(memory.c(9), 0x0102_0307);
}

#[test]
fn decode_matches_manual_example() {
    let mut plc = plc("LD R0.0\nDECB 1 F10 8 R4");
    for (code, bits) in [(8, 1), (9, 2), (15, 128), (7, 0), (16, 0)] {
        plc.memory_mut().set_f(10, code);
        scan(&mut plc, true);
        assert_eq!(plc.memory().r(4), bits, "code {code}");
    }
    plc.memory_mut().set_r(4, 0xFF);
    scan(&mut plc, false);
    assert_eq!(plc.memory().r(4), 0);
}

#[test]
fn table_matches_manual_example() {
    let rungs = "LD R0.0\nCODB 1 3 F20 R30 , 12 22 32 42 52 62 72 82";
    let mut plc = plc(rungs);
    for (index, value) in [(1, 12), (3, 32), (8, 82), (9, 82), (0, 82)] {
        plc.memory_mut().set_f(20, index);
        scan(&mut plc, true);
        assert_eq!(plc.memory().r(30), value, "index {index}");
    }
    plc.memory_mut().set_f(20, 1);
    scan(&mut plc, false);
    assert_eq!(plc.memory().r(30), 82);
}

#[test]
fn table_counted_from_0() {
    let source = ".OPT codb0\nEND1\nLDI R9.0\nCODB 2 1 F20 D400 , 1000 2000\nEND2";
    let mut plc = Plc::new(Arc::new(Ladder::compile(source).unwrap()));
    for (index, value) in [(0, 1000), (1, 2000), (2, 2000)] {
        plc.memory_mut().set_f(20, index);
        plc.run_slot();
        assert_eq!(plc.memory().word("D400".parse().unwrap()), value);
    }
}

#[test]
fn rotation_matches_manual_example() {
    let mut plc = plc("LD R0.0\nROTB 1110 12 1 R7 F26 R27 R37.0");
    plc.memory_mut().set_r(7, 1);
    for (target, station, backwards) in [(10, 11, true), (8, 9, true), (5, 4, false), (3, 2, false)]
    {
        plc.memory_mut().set_f(26, target);
        scan(&mut plc, true);
        assert_eq!(plc.memory().r(27), station, "to {target}");
        assert_eq!(bit(&plc, "R37.0"), backwards, "to {target}");
    }
    plc.memory_mut().set_f(26, 10);
    scan(&mut plc, false);
    assert_eq!((plc.memory().r(27), bit(&plc, "R37.0")), (2, false));
}

#[test]
fn jumps_go_forward_and_back() {
    // Shifts a bit through R1 in one scan, then jumps over a coil.
    let mut plc = plc("LDI R9.0
        MOVN 1 1 R1
        LBL L1
        LD R1.2
        SET R1.3
        LD R1.1
        SET R1.2
        LD R1.0
        SET R1.1
        LDI R1.3
        JMPB L1
        LD R1.3
        JMPB L2
        LDI R9.0
        OUT R3.0
        LBL L2
        LDI R9.0
        OUT R3.1");
    plc.run_slot();
    assert_eq!(plc.memory().r(1), 0b1111);
    assert_eq!(plc.memory().r(3), 0b10);
}

#[test]
fn an_endless_loop_trips_the_watchdog() {
    let mut plc = plc("LBL L1\nLDI R9.0\nSET R1.0\nJMPB L1");
    plc.run_slot();
    assert_eq!(plc.fault(), Some(PlcFault::Watchdog { line: 5 }));
    let stopped = plc.memory().clone();
    set(&mut plc, "R1.0", false);
    plc.run_slot();
    assert_ne!(
        *plc.memory(),
        stopped,
        "memory writes work while the PLC is stopped"
    );
    plc.power_on();
    assert_eq!(plc.fault(), None);
}

#[test]
fn subprograms_nest() {
    let source = "
        END1
        LD R0.0
        CALL P1
        CALL P2
        LDI R0.0
        CALL P2
        END2
        SP P1
        LDI R9.0
        OUT R1.0
        CALL P2
        LDI R9.0
        OUT R1.1
        SPE
        SP P2
        LD R2.0
        MOVN 1 R3 R4
        LDI R9.0
        SET R2.0
        SPE";
    let mut plc = Plc::new(Arc::new(Ladder::compile(source).unwrap()));
    plc.memory_mut().set_r(3, 77);
    scan(&mut plc, true);
    assert_eq!(plc.memory().r(1), 3);
    assert_eq!(plc.memory().r(4), 77, "P2 ran twice");
}

#[test]
fn coils_act_in_program_order() {
    let mut first = plc("LD R0.0\nANI R0.2\nOUT R0.1\nLD R0.0\nOUT R0.2");
    scan(&mut first, true);
    assert!(bit(&first, "R0.1"), "on for one scan");
    first.run_slot();
    assert!(!bit(&first, "R0.1"));
    let mut second = plc("LD R0.0\nOUT R0.2\nLD R0.0\nANI R0.2\nOUT R0.1");
    scan(&mut second, true);
    assert!(!bit(&second, "R0.1"));
}

/// Returns `count` rungs of two steps that change nothing.
fn filler(count: usize) -> String {
    "LD R800.0\nSET R800.1\n".repeat(count)
}

#[test]
fn level2_reads_inputs_latched_at_cycle_start() {
    // Level 1 and the second part of level 2 read the same X.
    let source = format!(
        "LD X2.0\nOUT R1.0\nEND1\n{}LD X2.0\nOUT R1.1\nEND2",
        filler(260)
    );
    let ladder = Ladder::compile(&source).unwrap();
    assert_eq!(ladder.part_count(), 2);
    let mut plc = Plc::new(Arc::new(ladder));
    set(&mut plc, "X2.0", true);
    plc.run_slot();
    set(&mut plc, "X2.0", false);
    plc.run_slot();
    assert!(!bit(&plc, "R1.0"), "level 1 reads the input itself");
    assert!(bit(&plc, "R1.1"), "level 2 reads it as the cycle began");
    plc.run_slot();
    plc.run_slot();
    assert!(!bit(&plc, "R1.1"));
}

#[test]
fn part_ends_with_rung_that_fills_the_slot() {
    let parts = |rungs, head: &str| {
        let source = format!("{head}END1\n{}END2", filler(rungs));
        Ladder::compile(&source).unwrap().part_count()
    };
    // END1 takes one step. The remaining 499 steps are filled by 250 rungs of two steps.
    assert_eq!(parts(250, ""), 1);
    assert_eq!(parts(251, ""), 2);
    assert_eq!(parts(500, ""), 2);
    assert_eq!(parts(501, ""), 3);
    assert_eq!(parts(1200, ""), 5);
    assert_eq!(parts(1200, ".OPT n1\n"), 1);
}

#[test]
fn a_jump_may_skip_whole_parts() {
    let source = format!(
        "END1\nLD R0.0\nJMPB L1\n{}LDI R9.0\nSET R1.0\n{}LBL L1\nLDI R9.0\nSET R1.1\nEND2",
        filler(300),
        filler(300)
    );
    let ladder = Ladder::compile(&source).unwrap();
    assert_eq!(ladder.part_count(), 3);
    let mut plc = Plc::new(Arc::new(ladder));
    for _ in 0..3 {
        scan(&mut plc, true);
    }
    assert!(!bit(&plc, "R1.0"));
    assert!(bit(&plc, "R1.1"));
    for _ in 0..3 {
        scan(&mut plc, false);
    }
    assert!(bit(&plc, "R1.0"));
}

#[test]
fn unwritten_interlock_signals_stay_inactive() {
    let mut plc = plc("LDI R9.0\nOUT G8.4");
    plc.run_slot();
    assert_eq!(plc.memory().g(8), 0x31);
    assert_eq!(PlcMemory::new().g(114), 15);
}
