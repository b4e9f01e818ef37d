//! Fuzzes the ladder compiler with any text. A ladder that compiles is listed, compiled again
//! and run.

use std::sync::Arc;

use gsk_core::plc::{Ladder, Plc};

use super::watch;

/// Number of PLC slots for which a ladder is run.
const RUN_SLOTS: u32 = 64;

pub(super) fn fuzz_ladder(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let ladder = match watch::run_unit(|| Ladder::compile(&text)) {
        Ok(ladder) => ladder,
        Err(errors) => {
            assert!(!errors.errors.is_empty(), "a refusal says why");
            for error in errors.errors.iter().chain(&errors.warnings) {
                watch::record_event(
                    "error",
                    (error.code, watch::message_rule(&error.message.to_string())),
                );
            }
            return;
        }
    };
    for statement in ladder.statements() {
        watch::record_event("statement", statement.mnemonic);
    }
    let listed = ladder.to_source();
    match Ladder::compile(&listed) {
        Ok(again) => {
            assert_eq!(again.steps(), ladder.steps(), "of\n{listed}");
            assert_eq!(again.to_source(), listed, "a listing lists itself");
        }
        Err(errors) => assert!(
            listed.is_empty(),
            "its listing has errors: {errors}\n{listed}"
        ),
    }
    // Rungs map back to their instruction list.
    let drawn: Vec<String> = ladder
        .networks()
        .flat_map(|network| network.statements())
        .map(|statement| statement.to_string())
        .collect();
    let written: Vec<String> = ladder
        .statements()
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(drawn, written, "of\n{listed}");
    for subject in ladder.addresses() {
        let used = ladder.references(subject);
        assert!(!used.is_empty(), "{subject:?} is named and used nowhere");
    }
    watch::record_event("steps", watch::order_of_magnitude(ladder.steps().into()));
    let mut plc = Plc::new(Arc::new(ladder));
    let mut stepped = plc.clone();
    let mut together = true;
    for slot in 0..RUN_SLOTS {
        // Inputs that change at different rates.
        for byte in 0..4 {
            plc.memory_mut().set_x(byte, (slot >> byte) as u8);
            stepped.memory_mut().set_x(byte, (slot >> byte) as u8);
        }
        watch::run_unit(|| plc.run_slot());
        together = together && step_through(&mut stepped) && plc.fault().is_none();
        if together {
            assert_eq!(
                plc.memory(),
                stepped.memory(),
                "stepped otherwise in slot {slot}"
            );
        }
    }
    for network in plc.ladder().networks() {
        assert_eq!(plc.power_flow(&network).len(), network.statements().len());
    }
    watch::record_event("fault", plc.fault().is_some());
    let retained = plc.memory().retained();
    plc.memory_mut().restore_retained(&retained);
    plc.power_on();
    plc.run_slot();
}

/// Runs one slot of the PLC, rung by rung. Returns `false` if a loop takes too many steps.
fn step_through(plc: &mut Plc) -> bool {
    const STEPS: u32 = 2000;
    for _ in 0..STEPS {
        watch::run_unit(|| plc.step_rung());
        if !plc.is_within_slot() {
            return true;
        }
    }
    false
}
