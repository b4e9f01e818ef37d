//! Checks machine files: the examples are lathes, the documents name every field, and
//! impossible values are refused with field and rule.

use gsk_core::machine::{LatheConfig, MachineInputs, MachineOutputs, SimulatedLathe};
use gsk_core::memory::ControlParameters;
use gsk_core::units::{PerAxis, Point, Pulses};

const EXAMPLES: [&str; 9] = [
    EXAMPLE,
    BADLY_SET,
    include_str!("../../assets/machines/bench-lathe.ron"),
    include_str!("../../assets/machines/pico-lathe.ron"),
    include_str!("../../assets/machines/servo-slant-bed.ron"),
    include_str!("../../assets/machines/slant-bed.ron"),
    include_str!("../../assets/machines/stepper-drives.ron"),
    include_str!("../../assets/machines/virtual-line.ron"),
    include_str!("../../assets/machines/virtual-klipper.ron"),
];
const EXAMPLE: &str = include_str!("../../assets/machines/small-flat-bed.ron");
const BADLY_SET: &str = include_str!("../../assets/machines/badly-set.ron");
const DOCUMENTS: [(&str, &str); 2] = [
    ("en", include_str!("../../docs/machine-file.md")),
    ("zh", include_str!("../../docs/machine-file.zh-CN.md")),
];

fn read_machine(text: &str) -> Result<LatheConfig, String> {
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    options.from_str(text).map_err(|error| error.to_string())
}

#[test]
fn the_example_is_another_lathe() {
    let config = read_machine(EXAMPLE).unwrap();
    config.check().unwrap();
    assert!(!config.rear_tool_post);
    let mut parameters = ControlParameters::default();
    parameters.set(84, 6).unwrap();
    let mut lathe = SimulatedLathe::new(config, &parameters);
    assert_eq!(lathe.station(), Some(1));
    let at = lathe.slide_position();
    assert!(
        (at.x + 20.0).abs() < 1e-3 && (at.z + 80.0).abs() < 1e-3,
        "{at:?}"
    );
    // TL+ for one station: 900 ms less the window of 45 ms.
    let mut forward = MachineOutputs::default();
    forward.y[1] = 1 << 6;
    let ticks = (1..2000).find(|_| {
        lathe.tick(&forward, &mut MachineInputs::default());
        lathe.station() == Some(2)
    });
    assert_eq!(ticks, Some(855));
    // Its drives give no one-turn signal.
    for place in 0..100 {
        lathe.move_slides(Point::new(0.0, f64::from(place) * -0.5));
        let inputs = lathe.inputs();
        assert!(!inputs.index_pulse.z);
    }
}

#[test]
fn every_example_is_a_lathe() {
    for text in EXAMPLES {
        let config = read_machine(text).unwrap();
        config.check().unwrap();
    }
}

/// Z at -240: half way between errors of 23 and 8 µm. X at -50, a diameter of -100: a quarter
/// of the way from 4 to -9 µm on the diameter.
#[test]
fn a_slide_is_off_by_the_errors_of_its_screw() {
    let mut lathe = SimulatedLathe::new(
        read_machine(BADLY_SET).unwrap(),
        &ControlParameters::default(),
    );
    for (reported, true_position) in [
        (
            Point::new(-50.0, -240.0),
            Point::new(-50.0 + 0.000_375, -240.0 + 0.0155),
        ),
        (Point::new(0.0, 0.0), Point::new(0.0, 0.0)),
        (
            Point::new(-165.0, -514.0),
            Point::new(-165.0 - 0.009, -514.0 + 0.034),
        ),
    ] {
        // The position is that of the slide; the pulse count is where the screw puts it.
        lathe.move_slides(true_position);
        let at = lathe.slide_position();
        assert!((at.x - true_position.x).abs() < 0.0002 + 1e-9, "{at:?}");
        assert!((at.z - true_position.z).abs() < 0.0004 + 1e-9, "{at:?}");
        lathe.set_count(PerAxis::default());
        // From there to the machine zero by the pulses that the screw needs.
        let pulses = PerAxis::new(
            Pulses((-reported.x / 0.0004).round() as i64),
            Pulses((-reported.z / 0.0008).round() as i64),
        );
        let mut outputs = MachineOutputs::default();
        outputs.enable = PerAxis::new(true, true);
        outputs.pulses = pulses;
        lathe.tick(&outputs, &mut MachineInputs::default());
        let zero = lathe.slide_position();
        assert!(zero.x.abs() < 0.0005 && zero.z.abs() < 0.0009, "{zero:?}");
        lathe = SimulatedLathe::new(
            read_machine(BADLY_SET).unwrap(),
            &ControlParameters::default(),
        );
    }
}

#[test]
fn the_documents_name_every_field() {
    let default = ron::ser::to_string(&LatheConfig::default()).unwrap();
    let mut fields = 0;
    for part in default.split(['(', ',', ')']) {
        let Some((name, _)) = part.split_once(':') else {
            continue;
        };
        let inner = matches!(
            name,
            "minus" | "plus" | "from" | "to" | "gain" | "largest_error"
        );
        for (language, text) in DOCUMENTS {
            assert!(
                inner || text.contains(&format!("`{name}`")),
                "the document on machine files ({language}) does not name {name}"
            );
        }
        fields += 1;
    }
    assert!(fields > 20, "{fields}");
}

#[test]
fn impossible_values_are_refused_by_field_and_rule() {
    let table = [
        ("(name: \"\")", "name: must not be empty"),
        (
            "(x: (limits: (minus: 10, plus: -310)))",
            "x.limits: `minus` 10 must be less than `plus` -310",
        ),
        (
            "(z: (start: 20))",
            "z.start: 20 is beyond the limit switches -505 to 5",
        ),
        (
            "(z: (dog: (from: -5, to: -30)))",
            "z.dog: `from` -5 must be less than `to` -30",
        ),
        (
            "(x: (dog: (from: -10, to: 20)))",
            "x.dog: -10 to 20 is not within the limit switches -310 to 10",
        ),
        (
            "(x: (ends: (minus: -300, plus: 20)))",
            "x.limits: -310 to 10 is not within the ends of the slide -300 to 20",
        ),
        (
            "(z: (ends: (minus: 20, plus: -600)))",
            "z.ends: `minus` 20 must be less than `plus` -600",
        ),
        (
            "(z: (limits: None, start: 30))",
            "z.start: 30 is beyond the ends of the slide -515 to 15",
        ),
        (
            "(x: (limits: None, dog: (from: -10, to: 40)))",
            "x.dog: -10 to 40 is not within the ends of the slide -330 to 30",
        ),
        (
            "(x: (motor_turn: 0))",
            "x.motor_turn: 0 must be above 0 and at most 1000 mm",
        ),
        (
            "(x: (pulse: -0.001))",
            "x.pulse: -0.001 must be above 0 and at most 1 mm; `reversed` sets the direction",
        ),
        (
            "(x: (pitch_errors: [(at: 0, error: 2)]))",
            "x.pitch_errors.error: 2 is not within ±1 mm",
        ),
        (
            "(z: (pitch_errors: [(at: 0, error: 0), (at: -5, error: 0)]))",
            "z.pitch_errors: -5 must be above 0: list the error points from minus to plus",
        ),
        (
            "(z: (pitch_errors: [(at: 0, error: 0), (at: 5, error: 0.1)]))",
            "z.pitch_errors: 0.1 mm from 0 to 5 is more than 0.01 mm per mm",
        ),
        (
            "(x: (servo: (gain: 0)))",
            "x.servo.gain: 0 is outside 1 to 1000",
        ),
        (
            "(turret: (stations: 12))",
            "turret.stations: 12 is more than 8: each station has a contact, T01 to T08; for up to 32 set \
             `coded: true` and use a ladder that reads the code",
        ),
        (
            "(turret: (stations: 33, coded: true))",
            "turret.stations: 33 is more than 32: parameter 084 allows no more",
        ),
        (
            "(turret: (stations: 4, first: 5))",
            "turret.first: 5 is not a station: stations are 1 to 4",
        ),
        (
            "(turret: (window: 0.5))",
            "turret.window: 0.5 must be above 0 and below 0.5 of a pitch",
        ),
        (
            "(spindle: (steps: (1, 2, 3, 1e9)))",
            "spindle.steps: 1000000000 is outside 0 to 99999 r/min",
        ),
        (
            "(spindle: (encoder_lines: 7))",
            "spindle.encoder_lines: 7 must be 0 (no encoder) or 100 to 5000",
        ),
        (
            "(link: (baud: 300))",
            "link.baud: 300 is not from 9600 to 4000000",
        ),
        (
            "(chuck: (travel_ms: 0))",
            "chuck.travel_ms: 0 ms is outside 1 to 600000 ms",
        ),
        (
            "(picture: (construction: SlantBed))",
            "picture.construction: a slant bed has its tool post behind the axis, other lathes in front of it: \
             set `rear_tool_post` accordingly",
        ),
        (
            "(rear_tool_post: true, picture: (construction: Bench))",
            "picture.construction: a slant bed has its tool post behind the axis, other lathes in front of it: \
             set `rear_tool_post` accordingly",
        ),
        (
            "(picture: (steady_rest: -5))",
            "picture.steady_rest: -5 must be above 0 and at most 5000 mm",
        ),
        (
            "(picture: (tower: (red: \"X1.0\")))",
            "picture.tower.red: X1.0 is not a bit of Y or F, such as Y8.0",
        ),
    ];
    for (text, expected) in table {
        let errors = read_machine(text).unwrap().check().unwrap_err();
        let seen: Vec<String> = errors.iter().map(ToString::to_string).collect();
        assert!(seen.contains(&expected.to_owned()), "{text}: {seen:?}");
    }
    for text in ["(nmae: \"x\")", "(x: (start: \"left\"))", "(turret: 4)"] {
        assert!(read_machine(text).is_err(), "{text}");
    }
    LatheConfig::default().check().unwrap();
    LatheConfig::without_limits().check().unwrap();
    LatheConfig::with_long_slides().check().unwrap();
}
