#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]
//! Who is at the wire: boards that are refused, and what they have to be set to.

use core::time::Duration;

use gsk_core::machine::link::line::{LineLink, Required};
use gsk_core::machine::link::{Event, LinkConfig, LinkState};
use gsk_core::memory::Parameters;

/// What another firmware says when it is spoken to; alarm and text that come of it.
fn alarm_of(answers: impl Fn(&str) -> String, banner: &str) -> (u16, String, LinkState) {
    let mut link = LineLink::open(
        LinkConfig::default(),
        &Parameters::default(),
        Duration::ZERO,
    );
    link.rx(banner.as_bytes(), Duration::from_millis(600));
    for ms in 601..8000 {
        let now = Duration::from_millis(ms);
        link.tick(now);
        let said = String::from_utf8_lossy(link.tx()).into_owned();
        link.consumed(said.len());
        for line in said.lines() {
            link.rx(answers(line).as_bytes(), now);
        }
        for event in link.events() {
            if let Event::Alarm { number, detail } = event {
                return (number, detail, link.state());
            }
        }
    }
    panic!("{:?}", link.state());
}

/// FluidNC, as its `Report.cpp` writes it; the settings of that firmware cannot be
/// compared, so it is named, not taken for an old Grbl.
#[test]
fn a_fluidnc_board_is_refused_by_its_name() {
    let boot = "[MSG:INFO: FluidNC v4.0.4 https://github.com/bdring/FluidNC]\r\n\r\n\
                Grbl 4.0 [FluidNC v4.0.4 (esp32-wifi) '$' for help]\r\n";
    for version in [
        "4.0 FluidNC v4.0.4 (esp32-wifi) :",
        "3.7 FluidNC v3.7.15 (esp32-wifi-v3.7.15):",
    ] {
        let answers = |line: &str| match line {
            "$I" => format!("[VER:{version}]\r\n[OPT:PHS]\r\n[MSG:Machine: lathe]\r\nok\r\n"),
            _ => "ok\r\n".to_owned(),
        };
        let (number, text, state) = alarm_of(answers, boot);
        let (_, name) = version.split_once(' ').unwrap();
        let (name, _) = name.split_once(" (").unwrap();
        assert_eq!((number, state), (602, LinkState::Fault), "{text}");
        assert!(text.starts_with(name), "{text}");
        assert!(!text.contains("older"), "{text}");
    }
}

#[test]
fn a_board_that_is_not_understood_points_to_protocol_and_baud() {
    // Nothing at all; nothing but `ok`; noise.
    for (banner, answer) in [("", ""), ("ok\r\n", "ok\r\n"), ("", "~{x\u{7}")] {
        let (_, text, _) = alarm_of(|_| answer.to_owned(), banner);
        assert!(
            text.contains("protocol") && text.contains("baud"),
            "{answer}: {text}"
        );
    }
}

/// Wires of the owner: what the machine file says is asked of the board, and written.
#[test]
fn levels_and_the_time_of_a_switch_come_from_the_machine_file() {
    let config: LinkConfig =
        ron::from_str("(line: (invert_step: true, invert_enable: true, debounce_ms: 40))").unwrap();
    config.check().unwrap();
    let value = |config: &LinkConfig, number| {
        let required = Required::new(&Parameters::default(), config);
        let mut settings = required.settings.iter();
        settings
            .find(|setting| setting.number == number)
            .unwrap()
            .value
    };
    for (number, delivered, told) in [(2, 0.0, 5.0), (4, 0.0, 1.0), (26, 250.0, 40.0)] {
        assert_eq!(value(&LinkConfig::default(), number), delivered);
        assert_eq!(value(&config, number), told);
    }
    let error = ron::from_str::<LinkConfig>("(line: (debounce_ms: 0))")
        .unwrap()
        .check();
    assert_eq!(
        error.unwrap_err().to_string(),
        "link.line.debounce_ms: 0 is not from 1 to 1000"
    );
}
