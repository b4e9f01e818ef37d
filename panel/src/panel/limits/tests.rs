use gsk_core::setup::Setup;
use gsk_messages::Language;

use super::*;
use crate::emulator::{Emulator, WaitCondition};
use crate::panel::KeyEvent;

fn only(names: &[&str]) -> PermittedNames {
    PermittedNames::Only(names.iter().map(ToString::to_string).collect())
}

fn all_but(names: &[&str]) -> PermittedNames {
    PermittedNames::AllBut(names.iter().map(ToString::to_string).collect())
}

fn limited(keys: Option<PermittedNames>, pages: Option<PermittedNames>) -> Emulator {
    let mut limits = PanelLimits::default();
    if let Some(keys) = keys {
        limits.limit_keys(&keys).expect("known keys");
    }
    if let Some(pages) = pages {
        limits.limit_pages(&pages).expect("known pages");
    }
    let mut emulator = Emulator::new(Setup::default());
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator.limit_panel(&limits);
    emulator
}

#[test]
fn a_refused_key_does_nothing_and_gives_one_sentence() {
    let mut emulator = limited(Some(all_but(&["jog"])), None);
    let before = emulator.panel().clone();
    let why = emulator.key_down(Key::Jog).expect("a reason");
    assert_eq!(
        why.text(Language::En),
        "This exercise does not permit the key [手动]."
    );
    assert_eq!(*emulator.panel(), before);
    emulator.press(Key::Mdi);
    assert_eq!(
        emulator.cnc().mode(),
        gsk_core::operation::OperatingMode::Mdi
    );
    // The limit survives a power failure.
    emulator.power_cycle();
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    assert!(emulator.key_down(Key::Jog).is_some());
    assert!(!emulator.panel().is_held(Key::Jog));
}

#[test]
fn keys_that_stop_the_machine_are_never_refused() {
    let none = only(&[]);
    let mut emulator = limited(Some(none.clone()), Some(none.clone()));
    for key in keys::all_rows().map(|row| row.key) {
        let is_refused = emulator
            .panel()
            .limit_refusal(KeyEvent::Down(key), emulator.cnc());
        assert_eq!(is_refused.is_none(), STOP_KEYS.contains(&key), "{key:?}");
    }
    emulator.key_down(Key::EmergencyStop);
    emulator.run(100);
    assert!(emulator.panel().emergency_stop());
    assert_eq!(unlisted_stop_keys(&none), ["ESTOP", "RESET", "FH"]);
    assert_eq!(unlisted_stop_keys(&only(&["reset", "FH"])), ["ESTOP"]);
    for key in ["ESTOP", "RESET", "FH"] {
        let mut limits = PanelLimits::default();
        let fault = limits.limit_keys(&all_but(&["JOG", key])).expect_err(key);
        assert_eq!(fault.name, key);
        assert!(limits.is_empty());
    }
}

#[test]
fn a_refused_page_stays_closed_also_by_a_key_that_is_held() {
    let mut emulator = limited(None, Some(all_but(&["pos-all", "par-bit"])));
    assert!(emulator.key_down(Key::Parameter).is_some());
    assert_eq!(emulator.panel().page(), PageId::PosRel);
    emulator.key_up(Key::Parameter);
    assert_eq!(emulator.key_down(Key::PageDown), None);
    emulator.run(3000);
    assert_eq!(
        emulator.panel().page(),
        PageId::PosAbs,
        "the next page is refused"
    );
    emulator.key_up(Key::PageDown);
    emulator.press(Key::Offset);
    assert_eq!(emulator.panel().page(), PageId::Oft);
}

#[test]
fn a_typed_character_is_refused_with_the_key_that_enters_it() {
    let mut emulator = limited(Some(all_but(&["D/U", "7"])), None);
    emulator.press(Key::Mdi);
    emulator.press(Key::Program);
    emulator.press(Key::PageDown);
    for (character, is_refused) in [
        ('u', true),
        ('D', true),
        ('7', true),
        ('8', false),
        ('*', false),
    ] {
        let refusal = emulator.key(KeyEvent::Type(character));
        let by_exercise =
            refusal.is_some_and(|it| it.text(Language::En).starts_with("This exercise"));
        assert_eq!(by_exercise, is_refused, "{character}");
    }
    assert!(emulator.panel().view().input.contains('8'));
    assert!(!emulator.panel().view().input.contains(['U', '7']));
}

#[test]
fn unknown_names_are_reported() {
    let mut limits = PanelLimits::default();
    let fault = limits
        .limit_keys(&only(&["JOG", "AUT"]))
        .expect_err("a key");
    assert_eq!(fault.name, "AUT");
    assert!(fault.rule.text(Language::En).contains("AUTO"));
    let fault = limits.limit_pages(&only(&["nowhere"])).expect_err("a page");
    assert!(fault.rule.text(Language::En).contains("pos-rel"));
    assert!(limits.is_empty());
}
