//! Kills the process while the panel is operated. Confirmed data stays on the disk; data that
//! was being written has its old or its new content.
//!
//! `KILLS=500 cargo test -p gsk980td --test kill` kills more often.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::files::data_dir::DataDir;
use gsk_host::retained::{self, Keeper, Restored};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;

/// Default count of kills.
const KILLS: u64 = 12;
/// Operations after which a child ends without a kill.
const MAX_OPERATIONS: u64 = 400;
/// Greatest delay of a kill, ms.
const MAX_DELAY_MS: u64 = 400;

struct KillRandom(u64);

impl KillRandom {
    fn next_below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % end
    }
}

/// Creates the emulator from the data directory, directly after power-on.
fn power_on(data: &DataDir) -> (Emulator, Restored) {
    let mut setup = Setup::delivered();
    let restored = retained::load(data, &mut setup);
    restored.place_slides(&mut setup);
    setup.alarms.clear();
    let mut emulator = Emulator::new(setup);
    restored.restore_panel(&mut emulator);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    (emulator, restored)
}

fn press_keys(emulator: &mut Emulator, keys: &[Key]) {
    for key in keys {
        emulator.press(*key);
    }
}

/// A random operation of the operator.
fn operate_randomly(emulator: &mut Emulator, random: &mut KillRandom) {
    match random.next_below(6) {
        0 => {
            press_keys(emulator, &[Key::Offset]);
            emulator.type_text(&format!("P{}", 1 + random.next_below(32)));
            press_keys(emulator, &[Key::Input]);
            emulator.type_text(&format!("U{}.5", random.next_below(9)));
            press_keys(emulator, &[Key::Input]);
        }
        1 | 2 => {
            let number = 1 + random.next_below(5);
            press_keys(emulator, &[Key::Edit, Key::Program]);
            emulator.type_text(&format!("O{number}"));
            press_keys(emulator, &[Key::Eob, Key::Reset, Key::Program]);
            emulator.type_text(&format!("O{number}"));
            press_keys(emulator, &[Key::Down, Key::Down]);
            emulator.type_text(&format!("G0X{};", random.next_below(90)));
            press_keys(emulator, &[Key::Position]);
        }
        3 => {
            press_keys(emulator, &[Key::Edit, Key::Program]);
            let number = 1 + random.next_below(5);
            emulator.type_text(&format!("O{number}"));
            let key = if random.next_below(2) == 0 {
                Key::Delete
            } else {
                Key::Insert
            };
            press_keys(emulator, &[key, Key::Reset]);
        }
        4 => {
            press_keys(emulator, &[Key::Mdi, Key::Position, Key::Setting]);
            press_keys(emulator, &[Key::PageDown, Key::Up, Key::Down]);
            emulator.type_text("DW");
            press_keys(emulator, &[Key::Up]);
            emulator.type_text("D");
            press_keys(emulator, &[Key::Position, Key::Parameter, Key::Parameter]);
            emulator.type_text("P24");
            press_keys(emulator, &[Key::Input]);
            emulator.type_text(&format!("{}", 100 + random.next_below(900)));
            press_keys(emulator, &[Key::Input, Key::Position, Key::Setting]);
            press_keys(emulator, &[Key::PageDown, Key::PageDown]);
            emulator.type_text(&format!("{}", 5 + random.next_below(4)));
            press_keys(emulator, &[Key::PageUp]);
            emulator.type_text("W");
            press_keys(emulator, &[Key::Down]);
            emulator.type_text("D");
            press_keys(emulator, &[Key::Up]);
        }
        _ => {
            press_keys(emulator, &[Key::Auto, Key::CycleStart]);
            emulator.run(random.next_below(2000));
            press_keys(emulator, &[Key::Reset]);
        }
    }
}

/// The child: operates, waits until the disk has the data, and confirms it.
#[test]
#[ignore = "the other test runs it in a process of its own"]
fn operating() {
    let Some(folder) = std::env::var_os("KILL_FOLDER") else {
        return;
    };
    let seed = std::env::var("KILL_SEED").unwrap().parse().unwrap();
    let data = Arc::new(DataDir::open(Path::new(&folder)).unwrap());
    let (mut emulator, restored) = power_on(&data);
    let mut keeper = Keeper::start(data, &restored, &emulator).unwrap();
    let mut random = KillRandom(seed);
    for operation in 1..=MAX_OPERATIONS {
        operate_randomly(&mut emulator, &mut random);
        keeper.save_and_wait(&emulator);
        println!("confirmed {operation}");
    }
}

/// Runs the child and kills it. Returns the count of confirmed operations.
fn run_and_kill(folder: &Path, seed: u64, random: &mut KillRandom) -> u64 {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["operating", "--exact", "--ignored", "--nocapture"])
        .env("KILL_FOLDER", folder)
        .env("KILL_SEED", seed.to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let (sender, confirmations) = std::sync::mpsc::channel();
    let reader = std::thread::spawn(move || {
        for line in lines.map_while(Result::ok) {
            // libtest prints the name of the test on the same line.
            let number = line.split("confirmed ").nth(1);
            if let Some(number) = number.and_then(|number| number.trim().parse::<u64>().ok()) {
                let _ = sender.send(number);
            }
        }
    });
    let first_kill = random.next_below(4);
    let mut confirmed = 0;
    while confirmed < first_kill
        && let Ok(number) = confirmations.recv()
    {
        confirmed = number;
    }
    std::thread::sleep(Duration::from_millis(random.next_below(MAX_DELAY_MS)));
    child.kill().unwrap();
    child.wait().unwrap();
    reader.join().unwrap();
    confirmations.try_iter().last().unwrap_or(confirmed)
}

/// Asserts that each part of the data on the disk equals that of one of the two emulators.
fn assert_old_or_new(found: &Emulator, before: &Emulator, after: &Emulator, context: &str) {
    let [found, before, after] = [found, before, after].map(Emulator::cnc);
    macro_rules! same {
        ($part:ident) => {
            assert!(
                found.$part() == before.$part() || found.$part() == after.$part(),
                "{context}: {} is neither old nor new",
                stringify!($part)
            );
        };
    }
    same!(parameters);
    same!(offsets);
    same!(variables);
    same!(disks);
    for number in 0..=9999 {
        let text = |program: Option<&Program>| program.map(|program| program.text().to_owned());
        let found = text(found.programs().stored(number));
        let old = text(before.programs().stored(number));
        let new = text(after.programs().stored(number));
        assert!(
            found == old || found == new,
            "{context}: O{number:04} is {found:?}, not {old:?} or {new:?}"
        );
    }
}

#[test]
fn confirmed_data_survives_a_kill() {
    let kills = std::env::var("KILLS").map_or(KILLS, |kills| kills.parse().unwrap());
    let folder: PathBuf =
        std::env::temp_dir().join(format!("gsk980td-kill-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    let mut random = KillRandom(0x2545_F491_4F6C_DD1D);
    let mut total_confirmed = 0;
    for kill in 0..kills {
        let seed = 1 + random.next_below(u64::MAX);
        let mut before = {
            let data = DataDir::open(&folder).unwrap();
            power_on(&data).0
        };
        let confirmed = run_and_kill(&folder, seed, &mut random);
        total_confirmed += confirmed;
        let mut operations = KillRandom(seed);
        for _ in 0..confirmed {
            operate_randomly(&mut before, &mut operations);
        }
        let mut after = before.clone();
        operate_randomly(&mut after, &mut operations);
        let data = DataDir::open(&folder).unwrap();
        let (found, restored) = power_on(&data);
        let context = format!("kill {kill} after {confirmed} operations");
        assert_eq!(restored.complaints, [], "{context}");
        assert_old_or_new(&found, &before, &after, &context);
    }
    assert!(total_confirmed > 0, "no child came to confirm anything");
    fs::remove_dir_all(folder).unwrap();
}
