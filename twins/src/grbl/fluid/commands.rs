//! Lines as FluidNC's main task carries them out.

use super::super::config::Config;
use super::super::{GrblTwin, State};

/// The longest line, and the longest block of G code.
pub(super) const LINE_BYTES: usize = 254;
const BLOCK_BYTES: usize = 127;

/// Commands that wait for the end of all motion, by name.
const WAITING: [&str; 13] = [
    "", "$", "#", "I", "CD", "X", "C", "13", "H", "HX", "HY", "HZ", "SLP",
];

impl GrblTwin {
    /// The main task's turn, its events handled.
    pub(super) fn fluid_work(&mut self) {
        loop {
            // It is kept by an alarm, or by a hold it waits in.
            let held = self.state == State::Hold { complete: true };
            if held || self.now < self.fluid.blocked_until.max(self.busy_until) {
                return;
            }
            if self.fluid.homes {
                // An alarm that ends it comes first.
                if self.state == State::Home || !self.fluid.events.is_empty() {
                    return;
                }
                self.fluid.homes = false;
                self.answer(Ok(()));
            } else if let Some(until) = self.answers_at {
                if self.now < until {
                    return;
                }
                self.answers_at = None;
                self.answer(Ok(()));
            } else if let Some(asked) = self.waiting.take() {
                if !self.carry_out(asked) {
                    self.waiting = Some(asked);
                    return;
                }
            } else if let Some(command) = self.fluid.command.take() {
                if !self.planner.is_empty() || self.state == State::Run {
                    self.fluid.command = Some(command);
                    return;
                }
                if let Some(result) = self.fluid_command(&command) {
                    self.answer(result);
                }
            } else if let Some(line) = self.fluid.line.take() {
                self.begin(line.trim_start());
            } else {
                return;
            }
        }
    }

    fn begin(&mut self, line: &str) {
        if let Some(command) = line.strip_prefix('$') {
            let name = command.split('=').next().unwrap_or_default();
            let waits = WAITING.iter().any(|known| known.eq_ignore_ascii_case(name));
            if waits {
                self.fluid.command = Some(command.to_owned());
            } else {
                let result = self.setting(command);
                self.answer(result);
            }
            return;
        }
        if line.is_empty() {
            return self.answer(Ok(()));
        }
        let result = self.block(line);
        if let Some(result) = result {
            if result.is_err_and(|number| number != 9) {
                self.say(&format!("[MSG:ERR: Bad GCode: {line}]\r\n"));
            }
            self.answer(result);
        }
    }

    /// A block of G code; None where it is answered when it is carried out.
    fn block(&mut self, line: &str) -> Option<Result<(), u8>> {
        if self.state == State::Alarm {
            return Some(Err(9));
        }
        if line.len() > BLOCK_BYTES {
            return Some(Err(14));
        }
        let text = collapsed(line);
        match self.modal.read(&text, false, self.work_offset) {
            Ok(_) if self.state == State::Check => Some(Ok(())),
            Ok(asked) => {
                self.waiting = Some(asked);
                None
            }
            Err(number) => Some(Err(number)),
        }
    }

    /// A command that has waited for the end of all motion.
    fn fluid_command(&mut self, command: &str) -> Option<Result<(), u8>> {
        let calm = matches!(self.state, State::Idle | State::Alarm | State::Critical);
        let command = command.to_ascii_uppercase();
        let held = matches!(self.state, State::Hold { .. });
        match command.as_str() {
            "$" if held => return Some(Err(8)),
            "I" | "#" | "H" | "HX" | "HY" | "HZ" | "13" if !calm => return Some(Err(8)),
            "" => self.say("HLP:$$ $# $G $I $X $H\r\n"),
            "$" => self.list_numbers(),
            "#" => self.list_offsets(),
            "I" => {
                let text = self.identity();
                self.say(&text);
            }
            "CD" => {
                let text = self.settings.tree().map(Config::dump);
                self.say(&text.unwrap_or_default());
            }
            "X" => self.unlock(),
            "C" if self.state == State::Check => {
                self.say("[MSG:INFO: Disabled]\r\n");
                self.put(super::Event::Reset);
                return None;
            }
            "C" if self.state != State::Idle => return Some(Err(8)),
            "C" => {
                self.state = State::Check;
                self.say("[MSG:INFO: Enabled]\r\n");
            }
            "13" => {
                let inches = self.settings.value(13);
                self.say(&format!("$13={inches:.0}\r\n"));
            }
            "13=0" => return Some(self.settings.set(13, 0.0)),
            "13=1" => return Some(self.settings.set(13, 1.0)),
            "H" => return self.begin_cycles(None),
            "HX" => return self.begin_cycles(Some(0)),
            "HZ" => return self.begin_cycles(Some(1)),
            "HY" => return Some(Err(19)),
            _ => return Some(Err(3)),
        }
        Some(Ok(()))
    }

    /// What is answered at once, in motion too.
    fn setting(&mut self, command: &str) -> Result<(), u8> {
        let (name, value) = command.split_once('=').unwrap_or((command, ""));
        let (name, value) = (name.trim(), value.trim());
        if name.eq_ignore_ascii_case("G") {
            let text = self.modal.text();
            self.say(&format!("[{text}]\r\n"));
            return Ok(());
        }
        if name == "10" {
            return self.report_fields(value);
        }
        let path = name.strip_prefix('/').unwrap_or(name);
        let path = path.strip_suffix('/').unwrap_or(path);
        let tree = self.settings.tree_mut().ok_or(3_u8)?;
        let told = if value.is_empty() {
            Some(tree.show(path)?)
        } else {
            tree.set(path, value)?
        };
        self.set_switches();
        self.say(&told.unwrap_or_default());
        Ok(())
    }

    /// `$10`: kept for good.
    fn report_fields(&mut self, value: &str) -> Result<(), u8> {
        if value.is_empty() {
            let fields = self.settings.value(10);
            self.say(&format!("$10={fields:.0}\r\n"));
            return Ok(());
        }
        if !matches!(self.state, State::Idle | State::Alarm | State::Critical) {
            return Err(8);
        }
        let fields: f64 = value.parse().map_err(|_| 2_u8)?;
        if !(0.0..4.0).contains(&fields) {
            return Err(80);
        }
        self.settings.set(10, fields)
    }

    /// `$$`: what hosts of Grbl look for, and no more.
    fn list_numbers(&mut self) {
        let mut text = String::new();
        for number in [13, 10] {
            text.push_str(&format!("${number}={:.0}\r\n", self.settings.value(number)));
        }
        for group in [100, 110, 120, 130] {
            for (number, value) in (group..).zip(self.settings.axes(group)) {
                text.push_str(&format!("${number}={value:.3}\r\n"));
            }
        }
        self.say(&text);
    }

    /// Out of an alarm all axes count as homed, and the motors of hard limits make pulses
    /// again.
    fn unlock(&mut self) {
        if self.state != State::Alarm {
            return;
        }
        self.fluid.unhomed = [false; 2];
        for (axis, letter) in ["x", "z"].iter().enumerate() {
            if self.is_set(&format!("axes/{letter}/motor0/hard_limits")) {
                self.fluid.limited[axis] = false;
            }
        }
        self.state = State::Idle;
        self.say("[MSG:INFO: Caution: Unlocked]\r\n");
    }
}

/// A block without blanks and comments, in capitals.
fn collapsed(line: &str) -> String {
    let mut text = String::new();
    let mut comment = false;
    for letter in line.chars() {
        match letter {
            '(' => comment = true,
            ')' => comment = false,
            ';' if !comment => break,
            _ if comment || letter.is_ascii_whitespace() => {}
            _ => text.push(letter.to_ascii_uppercase()),
        }
    }
    text
}
