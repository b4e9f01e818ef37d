//! Fuzzes operator scripts with any text; its lines without errors are executed.

use core::mem::discriminant;
use std::cell::OnceCell;

use gsk_core::setup::Setup;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::script::{Effect, Runner, Script, ScriptError, ScriptProgress};

use super::watch;

/// Machine time after which a script is stopped, ticks (ms).
const MAX_TICKS: u32 = 4000;
/// The program that `load` reads for any file name.
const PROGRAM_FILE: &str = "O0077\nG00 X50 Z20\nG01 X40 Z-5 F300\nM30\n";

pub(super) fn fuzz_script(input: &[u8]) {
    thread_local! {
        static READY: OnceCell<Emulator> = const { OnceCell::new() };
    }
    let text = String::from_utf8_lossy(input);
    let script = match watch::run_unit(|| Script::parse(&text)) {
        Ok(script) => script,
        Err(errors) => match Script::parse(&without_errors(&text, &errors)) {
            Ok(script) => script,
            Err(again) => unreachable!("the lines without errors have errors: {again:?}"),
        },
    };
    for line in &script.lines {
        watch::record_event("line", discriminant(&line.action));
    }
    let mut emulator = READY.with(|ready| ready.get_or_init(ready_emulator).clone());
    let mut runner = Runner::new(script);
    for _ in 0..MAX_TICKS {
        match watch::run_unit(|| runner.advance(&mut emulator, 1)) {
            ScriptProgress::Effect(Effect::Load(name)) => {
                let _ = emulator.load_program(&name, PROGRAM_FILE);
            }
            ScriptProgress::Running | ScriptProgress::Effect(_) => {}
            ScriptProgress::Failed(_) | ScriptProgress::Finished => break,
        }
    }
    let screen = watch::run_unit(|| emulator.screen().text());
    assert_eq!(screen.lines().count(), 15, "the LCD has 15 rows");
    watch::record_event("mode", format!("{:?}", emulator.cnc().mode()));
    for alarm in emulator.cnc().alarms() {
        watch::record_event("alarm", alarm.number);
    }
}

/// Returns the text of a script with its invalid lines emptied.
fn without_errors(text: &str, errors: &[ScriptError]) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    for error in errors {
        watch::record_event("error", watch::message_rule(&error.cause.to_string()));
        let line = (error.line as usize).checked_sub(1);
        match line.and_then(|line| lines.get_mut(line)) {
            Some(line) => *line = "",
            None => unreachable!("{error} of {} lines", lines.len()),
        }
    }
    lines.join("\n")
}

fn ready_emulator() -> Emulator {
    let mut emulator = Emulator::new(Setup::default());
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator
}
