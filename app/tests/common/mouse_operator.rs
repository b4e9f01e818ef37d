//! Operates the window with one mouse: clicks each key at its position on the panel, turns the
//! handwheel with the mouse wheel.

use std::collections::BTreeMap;

use super::WindowBench;
use egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase};
use egui_kittest::kittest::Queryable;
use gsk_core::setup::Setup;
use gsk_panel::emulator::WaitCondition;
use gsk_panel::keys::{KEYS, Key, KeyRole};
use gsk_panel::script::{Expectation, Script, ScriptAction};

/// Duration of a click and the pause after it, ms.
const CLICK_MS: u64 = 200;
/// Ticks between two checks of a condition.
const CHECK_INTERVAL: u64 = 10;
/// Detents that the mouse wheel turns at once, and the time that they take, ms.
const DETENTS_PER_STEP: i32 = 10;
const STEP_MS: u64 = 50;

/// An operator with one mouse.
pub struct MouseOperator {
    pub bench: WindowBench,
    key_positions: BTreeMap<Key, Pos2>,
    wheel_position: Pos2,
}

impl MouseOperator {
    /// Operates a window with the panel alone.
    pub fn new(setup: Setup) -> Self {
        Self::on_bench(WindowBench::with_setup(setup))
    }

    /// Operates an existing window.
    pub fn on_bench(bench: WindowBench) -> Self {
        let position_of = |name: &str| bench.harness.get_by_label(name).rect().center();
        let positions = KEYS.iter().map(|row| (row.key, position_of(row.name_en)));
        Self {
            key_positions: positions.collect(),
            wheel_position: position_of("Handwheel"),
            bench,
        }
    }

    fn click_with(&mut self, key: Key, button: PointerButton) {
        let pos = self.key_positions[&key];
        self.bench.harness.event(Event::PointerMoved(pos));
        for pressed in [true, false] {
            self.bench.harness.event(Event::PointerButton {
                pos,
                button,
                pressed,
                modifiers: Modifiers::default(),
            });
        }
        self.run(CLICK_MS);
    }

    fn click(&mut self, key: Key) {
        self.click_with(key, PointerButton::Primary);
    }

    /// Runs the control. A frame is drawn only for the input.
    fn run(&mut self, ms: u64) {
        self.bench.harness.step();
        self.bench.kernel.run(ms);
    }

    /// Clicks the keys of a character: a compound key is clicked twice for its second
    /// character.
    fn type_character(&mut self, character: char) {
        for row in &KEYS {
            match row.role {
                KeyRole::Character(first, _) if first == character => return self.click(row.key),
                KeyRole::Character(_, Some(second)) if second == character => {
                    self.click(row.key);
                    return self.click(row.key);
                }
                _ => {}
            }
        }
        panic!("no key for «{character}»");
    }

    fn turn_wheel(&mut self, graduations: i32) {
        let mut remaining = graduations;
        self.bench
            .harness
            .event(Event::PointerMoved(self.wheel_position));
        while remaining != 0 {
            let step = remaining.clamp(-DETENTS_PER_STEP, DETENTS_PER_STEP);
            self.bench.harness.event(Event::MouseWheel {
                unit: MouseWheelUnit::Line,
                delta: egui::vec2(0.0, step as f32),
                phase: TouchPhase::Move,
                source: MouseWheelSource::Unknown,
                modifiers: Modifiers::default(),
            });
            self.run(STEP_MS);
            remaining -= step;
        }
    }

    fn is_met(&self, condition: &WaitCondition) -> bool {
        let emulator = self.bench.kernel.emulator();
        match condition {
            WaitCondition::Stopped => emulator.is_stopped(),
            WaitCondition::Text(text) => emulator.screen().text().contains(text),
            other => panic!("the script waits for {other:?}"),
        }
    }

    fn wait_for(&mut self, condition: &WaitCondition, limit: u64) -> Result<(), String> {
        for _ in 0..limit / CHECK_INTERVAL {
            if self.is_met(condition) {
                return Ok(());
            }
            self.bench.kernel.run(CHECK_INTERVAL);
        }
        Err(format!("{condition:?} not within {limit} ms"))
    }

    /// Checks what the control shows, and that the window shows the same.
    fn expect(&mut self, expect: &Expectation) -> Result<(), String> {
        expect
            .check(self.bench.kernel.emulator())
            .map_err(|failure| failure.to_string())?;
        let Expectation::Row(row, text) = expect else {
            return Ok(());
        };
        self.bench.kernel.publish();
        self.bench.harness.step();
        let lcd = self.bench.lcd();
        let fold_spaces = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let row_text = fold_spaces(lcd.lines().nth(*row).unwrap_or_default());
        if row_text.contains(&fold_spaces(text)) {
            return Ok(());
        }
        Err(format!("the window shows\n{lcd}"))
    }

    fn is_up(&self, key: Key) -> bool {
        !self.bench.kernel.emulator().panel().is_held(key)
    }

    fn act(&mut self, action: &ScriptAction) -> Result<(), String> {
        match action {
            ScriptAction::Press(key) => self.click(*key),
            // A right click latches the key for the next one only.
            ScriptAction::Down(key) => self.click_with(*key, PointerButton::Secondary),
            ScriptAction::Up(key) if self.is_up(*key) => {}
            ScriptAction::Up(key) => return Err(format!("{} is still down", key.id())),
            ScriptAction::Type(text) => text.chars().for_each(|c| self.type_character(c)),
            ScriptAction::Turn(graduations, _) => self.turn_wheel(*graduations),
            ScriptAction::Wait(ms) => self.run(*ms),
            ScriptAction::WaitFor(condition, _, limit) => return self.wait_for(condition, *limit),
            ScriptAction::Expect(expect) => return self.expect(expect),
            other => return Err(format!("no hand can do {other:?}")),
        }
        Ok(())
    }

    /// Runs a script and checks its expectations.
    #[track_caller]
    pub fn run_script(&mut self, text: &str) {
        let script = Script::parse(text).expect("a script");
        for line in &script.lines {
            if let Err(failure) = self.act(&line.action) {
                panic!(
                    "line {}: {}: {failure}\n{}",
                    line.number,
                    line.text,
                    self.bench.lcd()
                );
            }
        }
    }
}
