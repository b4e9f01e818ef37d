//! Who is at the wire: boards that are refused, and what they have to be set to.

use core::time::Duration;

use gsk_core::linked::drives;
use gsk_core::memory::Parameters;
use gsk_link::line::{LineLink, RequiredSettings};
use gsk_link::{Backend, LinkConfig, LinkEvent, LinkState};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

/// What another firmware says when it is spoken to; alarm and text that come of it.
fn alarm_of(answers: impl Fn(&str) -> String, banner: &str) -> (u16, String, LinkState) {
    let mut link = LineLink::open(
        LinkConfig::default(),
        &drives(&Parameters::default()),
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
            if let LinkEvent::Alarm { number, detail } = event {
                return (number, detail.to_string(), link.state());
            }
        }
    }
    panic!("{:?}", link.state());
}

/// A link and a FluidNC board, side by side; what the link has to say.
fn fluid(changes: &[(&str, &str)]) -> (LineLink, GrblTwin) {
    let mut twin = GrblTwin::new(Variant::FluidNc, GrblSettings::default());
    for (path, value) in changes {
        twin.set_config_item(path, value).unwrap();
    }
    let (config, parameters) = (LinkConfig::default(), Parameters::default());
    (
        LineLink::open(config, &drives(&parameters), Duration::ZERO),
        twin,
    )
}

fn pass(link: &mut LineLink, twin: &mut GrblTwin, ms: u32) -> Vec<LinkEvent> {
    let mut events = Vec::new();
    for _ in 0..ms {
        twin.advance(1_000_000);
        let now = Duration::from_nanos(twin.now());
        link.rx(&twin.read(), now);
        link.tick(now);
        let tx = link.tx().to_vec();
        twin.write(&tx);
        link.consumed(tx.len());
        events.extend(link.events());
    }
    events
}

fn alarms(events: &[LinkEvent]) -> Vec<(u16, String)> {
    let alarm = |event: &LinkEvent| match event {
        LinkEvent::Alarm { number, detail } => Some((*number, detail.to_string())),
        _ => None,
    };
    events.iter().filter_map(alarm).collect()
}

#[test]
fn a_fluidnc_board_is_known_and_told_its_settings_by_name() {
    let (mut link, mut twin) = fluid(&[]);
    let events = pass(&mut link, &mut twin, 5000);
    assert_eq!(link.board().firmware, "FluidNC v4.0.4");
    assert_eq!((link.board().blocks, link.board().receive_bytes), (15, 128));
    assert!(alarms(&events).iter().all(|(number, _)| *number == 603));
    link.write_settings();
    let events = pass(&mut link, &mut twin, 3000);
    assert_eq!(link.state(), LinkState::Locked, "{events:?}");
    assert_eq!(twin.config_item("start/must_home"), Some("true"));
    assert_eq!(twin.macro_count, 0);
    // What was written is forgotten with the power.
    twin.press_reset();
    let events = pass(&mut link, &mut twin, 4000);
    assert_eq!(alarms(&events)[0].0, 606, "{events:?}");
    link.reset();
    let events = pass(&mut link, &mut twin, 4000);
    assert_eq!(alarms(&events)[0].0, 603, "{events:?}");
}

/// Pulse length, pins, macros: a value in memory would change nothing, or not for long.
#[test]
fn what_only_the_file_of_the_board_can_say_is_named_and_not_written() {
    for (path, value, wanted) in [
        ("stepping/pulse_us", "4", "10"),
        (
            "axes/x/motor0/stepstick/direction_pin",
            "gpio.14:low",
            "not :low",
        ),
        ("10V/speed_map", "0=0.00% 3000=100.00%", "…1000=100%"),
        ("macros/after_reset", "G0X0", "(empty)"),
        ("control/feed_hold_pin", "gpio.34", "NO_PIN"),
    ] {
        let (mut link, mut twin) = fluid(&[(path, value)]);
        let events = pass(&mut link, &mut twin, 5000);
        let named = |event: &LinkEvent| match event {
            LinkEvent::Differs(one) => one.name == path && one.wanted == wanted,
            _ => false,
        };
        assert!(events.iter().any(named), "{path}: {events:?}");
        link.write_settings();
        let events = pass(&mut link, &mut twin, 1000);
        let (number, text) = alarms(&events)[0].clone();
        assert_eq!(number, 603);
        assert!(
            text.contains("config.yaml") && text.contains(path),
            "{text}"
        );
        assert_eq!(twin.config_item(path), Some(value));
        assert_eq!(twin.config_item("axes/x/steps_per_mm"), Some("80.000000"));
    }
}

/// The example of the manual is what the machine file beside it asks for.
#[test]
fn the_example_of_a_config_yaml_fits_its_machine_file() {
    let config: LinkConfig = ron::from_str(
        "(x: (invert_direction: true), line: (home: (seek: 500, locate: 100, pull_off_um: 1000)))",
    )
    .unwrap();
    let mut parameters = Parameters::default();
    for (number, value) in [(17, 5), (16, 2), (18, 5)] {
        parameters.set(number, value).unwrap();
    }
    for text in [
        include_str!("../../../docs/real-lathe.md"),
        include_str!("../../../docs/real-lathe.zh-CN.md"),
    ] {
        let (_, yaml) = text.split_once("```yaml\n").unwrap();
        let (yaml, _) = yaml.split_once("```").unwrap();
        let (_, mut twin) = fluid(&[]);
        let mut sections: Vec<&str> = Vec::new();
        for line in yaml.lines() {
            let (name, value) = line.trim().split_once(':').unwrap();
            sections.truncate((line.len() - line.trim_start().len()) / 2);
            sections.push(name);
            if !value.is_empty() {
                twin.set_config_item(&sections.join("/"), value.trim())
                    .unwrap();
            }
        }
        let mut link = LineLink::open(config.clone(), &drives(&parameters), Duration::ZERO);
        let events = pass(&mut link, &mut twin, 5000);
        let differs: Vec<_> = events
            .iter()
            .filter_map(|event| match event {
                LinkEvent::Differs(one) => Some(one.name.clone()),
                _ => None,
            })
            .collect();
        assert!(differs.contains(&"axes/z/steps_per_mm".to_owned()));
        let of_z = |name: &String| name.starts_with("axes/z/") || name == "$10";
        assert!(differs.iter().all(of_z), "{differs:?}");
    }
}

/// A board that looks for a network says so every second, and greets much later.
#[test]
fn a_board_that_starts_slowly_is_waited_for() {
    let (config, parameters) = (LinkConfig::default(), Parameters::default());
    let mut link = LineLink::open(config, &drives(&parameters), Duration::ZERO);
    let mut sent = Vec::new();
    for ms in 1..16_000 {
        let now = Duration::from_millis(ms);
        if ms < 12_000 && ms % 1500 == 500 {
            link.rx(b"[MSG:INFO: Connecting to STA SSID:shed]\r\n", now);
        } else if ms == 12_500 {
            link.rx(
                b"\r\nGrbl 4.0 [FluidNC v4.0.4 (esp32-wifi) '$' for help]\r\n",
                now,
            );
        }
        link.tick(now);
        assert!(
            ms >= 12_500 || link.tx().is_empty(),
            "{ms}: {:?}",
            link.tx()
        );
        sent.extend_from_slice(link.tx());
        link.consumed(link.tx().len());
        if sent.ends_with(b"$I\n") {
            return;
        }
    }
    panic!("{sent:?}");
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
        let required = RequiredSettings::new(&drives(&Parameters::default()), config);
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

#[test]
fn a_board_that_greets_and_then_is_silent_is_reset_once_and_called_silent() {
    let resets = core::cell::Cell::new(0);
    let answers = |line: &str| {
        resets.set(resets.get() + u32::from(line.contains('\u{18}')));
        String::new()
    };
    let (number, text, state) = alarm_of(answers, "\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_eq!((number, state), (601, LinkState::Lost), "{text}");
    assert!(text.contains("says nothing"), "{text}");
    assert_eq!(resets.get(), 1);
}

/// Versions of grblHAL hang at the first setting that is written.
#[test]
fn a_setting_that_is_never_answered_is_named() {
    for (variant, hint) in [(Variant::Grbl, false), (Variant::GrblHal, true)] {
        let mut twin = GrblTwin::new(variant, GrblSettings::default());
        let (config, parameters) = (LinkConfig::default(), Parameters::default());
        let mut link = LineLink::open(config, &drives(&parameters), Duration::ZERO);
        let events = pass(&mut link, &mut twin, 5000);
        assert_eq!(alarms(&events)[0].0, 603, "{events:?}");
        link.write_settings();
        twin.to_host.set_cut(true);
        let events = pass(&mut link, &mut twin, 3000);
        let (number, text) = alarms(&events)[0].clone();
        assert_eq!((number, link.state()), (602, LinkState::Fault), "{text}");
        assert!(text.contains("$") && text.contains("was written"), "{text}");
        assert_eq!(text.contains("8689918"), hint, "{text}");
    }
}
