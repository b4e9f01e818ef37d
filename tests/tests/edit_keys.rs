//! Presses random keys on all pages. Nothing panics, the memory can always be saved and read
//! back unchanged, and nothing changes that a protection guards.
//!
//! `EDIT_KEYS=100000 cargo test -p gsk980td-tests --test subjects edit_keys` presses more.

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::memory::{
    Authority, ControlParameters, ControlSettings, Counters, Disks, Offsets, Variables,
};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;
use gsk_panel::panel::{KeyEvent, SerialCable};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Number of keys without a setting in the environment.
const DEFAULT_KEYS: u64 = 10_000;
/// Number of keys between two checks of the whole memory and the LCD.
const CHECK_INTERVAL: u64 = 250;
/// Number of keys of one session.
const SESSION_KEYS: u64 = 2500;

const PROGRAMS: [&str; 3] = [
    "O0012;\nN10 G00 X50 Z2;\nN20 G01 Z-20 F100;\nN30 X60;\nM30;\n",
    "O0007 (名);\r\nG65 H01 P#200 Q5;\r\nM99\r\n%\r\n",
    "O9001;\nN1 M3;\nN2 M99;\n",
];

const EDIT_KEYS: [Key; 13] = [
    Key::Input,
    Key::Output,
    Key::Change,
    Key::Cancel,
    Key::Insert,
    Key::Delete,
    Key::Eob,
    Key::Up,
    Key::Down,
    Key::Left,
    Key::Right,
    Key::PageUp,
    Key::PageDown,
];
const PAGES: [Key; 10] = [
    Key::Program,
    Key::Program,
    Key::Program,
    Key::Position,
    Key::Program,
    Key::Offset,
    Key::Alarm,
    Key::Setting,
    Key::Parameter,
    Key::Diagnosis,
];
const MODES: [Key; 6] = [
    Key::Edit,
    Key::Edit,
    Key::Edit,
    Key::Mdi,
    Key::Auto,
    Key::Jog,
];
const CHARACTERS: &[u8] = b"ONGXZUWDSTMPQRIKJCFLHY/#0123456789-.( )";
/// Complete inputs of an operator.
const PHRASES: [&str; 24] = [
    "O12",
    "O7",
    "O9001",
    "O0055",
    "O-999",
    "N20",
    "G1X10.",
    "P12",
    "P175",
    "U1.5",
    "W-.5",
    "X99",
    "R.4",
    "T3",
    "12345",
    "123456",
    "1234",
    "00010101",
    "10000000",
    "99999999999",
    "PK12",
    "PT20",
    "-9999999",
    "1",
];

/// A random number generator that gives the same keys on every system.
struct KeyRandom(u64);

impl KeyRandom {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() >> 16) as usize % end
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

fn start_session(random: &mut KeyRandom) -> Emulator {
    let mut setup = Setup::default();
    for (number, bit) in [
        (12, 3),
        (12, 4),
        (13, 3),
        (172, 1),
        (174, 3),
        (4, 4),
        (12, 5),
    ] {
        if random.below(4) == 0 {
            let on = setup.memory.parameters.bit(number, bit);
            setup.memory.parameters.set_bit(number, bit, !on).unwrap();
        }
    }
    setup.memory.settings.numbering = random.below(3) == 0;
    match random.below(6) {
        0 => setup.memory.authority.log_off(),
        1 => assert!(setup.memory.authority.enter("1234")),
        _ => {}
    }
    for text in PROGRAMS {
        setup.memory.programs.store(text).unwrap();
    }
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    let cable = match random.below(2) {
        0 => SerialCable::Simulated,
        _ => SerialCable::Disconnected,
    };
    emulator.connect_cable(cable);
    if random.below(2) == 0 {
        emulator
            .request(ControlRequest::SetParameterSwitch(true))
            .unwrap();
        emulator.request(ControlRequest::CancelSwitchAlarm).unwrap();
    }
    emulator
}

/// Presses one key, or a few that belong together.
fn press(emulator: &mut Emulator, random: &mut KeyRandom) {
    let tap = |emulator: &mut Emulator, key: Key| {
        emulator.key_down(key);
        emulator.key_up(key);
        emulator.tick();
    };
    match random.below(100) {
        0..=34 => {
            let character = char::from(random.pick(CHARACTERS));
            emulator.key(KeyEvent::Type(character));
            emulator.tick();
        }
        35..=44 => {
            for character in random.pick(&PHRASES).chars() {
                emulator.key(KeyEvent::Type(character));
            }
            emulator.tick();
            tap(
                emulator,
                random.pick(&[Key::Input, Key::Down, Key::Delete, Key::Change]),
            );
        }
        45..=82 => tap(emulator, random.pick(&EDIT_KEYS)),
        83..=92 => tap(emulator, random.pick(&PAGES)),
        // Machine keys act through the ladder, which needs them for a while.
        93..=96 => emulator.press(random.pick(&MODES)),
        97 => emulator.press(Key::Reset),
        98 => {
            let key = random.pick(&[Key::U, Key::P, Key::J, Key::H, Key::Slash]);
            tap(emulator, key);
            tap(emulator, key);
        }
        _ => {
            emulator.key_down(Key::Cancel);
            tap(
                emulator,
                random.pick(&[Key::N, Key::T, Key::U, Key::X, Key::Reset]),
            );
            emulator.key_up(Key::Cancel);
        }
    }
}

/// The data that protections guard, and whether they are active.
#[derive(Clone)]
struct GuardedData {
    parameters: Option<ControlParameters>,
    disks: Option<Disks>,
    settings: Option<ControlSettings>,
    offsets: Option<Offsets>,
    variables: Option<Variables>,
    programs: Vec<(u16, Program)>,
}

impl GuardedData {
    fn from_cnc(cnc: &Cnc) -> Self {
        let rights = cnc.rights();
        let free = rights.check_parameters().is_ok() || rights.check_disks().is_ok();
        Self {
            parameters: (!free).then(|| cnc.parameters().clone()),
            disks: rights.check_disks().is_err().then(|| cnc.disks().clone()),
            settings: rights.check_settings().is_err().then(|| cnc.settings()),
            // A disk loads offsets as well.
            offsets: (rights.check_offsets().is_err() && rights.check_disks().is_err())
                .then(|| cnc.offsets().clone()),
            variables: rights
                .check_variables()
                .is_err()
                .then(|| cnc.variables().clone()),
            programs: cnc
                .programs()
                .iter()
                .filter(|(number, _)| rights.check_program_store(*number).is_err())
                .map(|(number, program)| (number, program.clone()))
                .collect(),
        }
    }

    fn check(&self, cnc: &Cnc) {
        fn assert_same<T: PartialEq + core::fmt::Debug>(kept: Option<&T>, now: &T) {
            if let Some(kept) = kept {
                assert_eq!(kept, now, "a guarded value has changed");
            }
        }
        assert_same(self.parameters.as_ref(), cnc.parameters());
        assert_same(self.disks.as_ref(), cnc.disks());
        assert_same(self.settings.as_ref(), &cnc.settings());
        assert_same(self.offsets.as_ref(), cnc.offsets());
        assert_same(self.variables.as_ref(), cnc.variables());
        for (number, program) in &self.programs {
            let now = cnc.programs().stored(*number);
            assert_eq!(now, Some(program), "O{number:04} was guarded");
        }
    }
}

/// Saves the memory and reads it back; it must be equal.
fn reload(cnc: &Cnc) {
    fn assert_round_trip<T: Serialize + DeserializeOwned + PartialEq + core::fmt::Debug>(
        value: &T,
    ) {
        let text = ron::to_string(value).unwrap();
        assert_eq!(&ron::from_str::<T>(&text).unwrap(), value);
    }
    assert_round_trip::<ControlParameters>(cnc.parameters());
    assert_round_trip::<Offsets>(cnc.offsets());
    assert_round_trip::<Variables>(cnc.variables());
    assert_round_trip::<Counters>(&cnc.counters());
    assert_round_trip::<ControlSettings>(&cnc.settings());
    assert_round_trip::<Authority>(cnc.authority());
    assert_round_trip::<Disks>(cnc.disks());
    for (number, program) in cnc.programs().iter() {
        let read = Program::new(program.text());
        assert_eq!(&read, program);
        assert_eq!(read.number(), Some(number), "{:?}", program.text());
    }
}

#[test]
fn no_key_panics_corrupts_the_memory_or_passes_a_protection() {
    let keys = std::env::var("EDIT_KEYS").map_or(DEFAULT_KEYS, |keys| keys.parse().unwrap());
    let mut random = KeyRandom(0x9E37_79B9_7F4A_7C15);
    let mut emulator = start_session(&mut random);
    let (mut changes, mut files) = (0, 0);
    // Whether the machine builder's password was entered in this session.
    let mut builder = false;
    for key in 0..keys {
        if key % SESSION_KEYS == SESSION_KEYS - 1 {
            emulator = start_session(&mut random);
            builder = false;
        }
        let guarded = GuardedData::from_cnc(emulator.cnc());
        let before = emulator.cnc().programs().clone();
        press(&mut emulator, &mut random);
        let sent = emulator.take_sent();
        builder |= emulator.cnc().authority().level().number() <= 2;
        assert!(
            builder || sent.iter().all(|file| file.name != "O9001.CNC"),
            "nobody had the level that sends it"
        );
        files += sent.len();
        let cnc = emulator.cnc();
        guarded.check(cnc);
        changes += u64::from(*cnc.programs() != before);
        if key % CHECK_INTERVAL == 0 {
            reload(cnc);
            emulator.screen();
        }
    }
    assert!(
        changes * 1000 > keys,
        "the keys did change programs: {changes}"
    );
    assert!(files > 0, "the keys did send something");
}

#[test]
fn a_restored_session_continues_alike() {
    let mut random = KeyRandom(7);
    let mut emulator = start_session(&mut random);
    for _ in 0..500 {
        press(&mut emulator, &mut random);
    }
    let mut restored = gsk_tests::saved_state::restore(&emulator).unwrap();
    let mut again = KeyRandom(random.0);
    for _ in 0..200 {
        press(&mut emulator, &mut random);
        press(&mut restored, &mut again);
    }
    assert_eq!(restored, emulator);
}
