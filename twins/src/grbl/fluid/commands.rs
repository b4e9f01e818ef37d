//! Executes lines in FluidNC's main task.

use super::super::config::FluidConfig;
use super::super::{GrblState, GrblTwin};

/// Maximum length of a line (`MAX_LINE_BYTES`) and of a G code block (`MAX_BLOCK_BYTES`),
/// bytes.
pub(super) const MAX_LINE_BYTES: usize = 254;
const MAX_BLOCK_BYTES: usize = 127;

/// Names of the `$` commands that wait for the end of all motion.
const SYNCHRONOUS_COMMANDS: [&str; 13] = [
    "", "$", "#", "I", "CD", "X", "C", "13", "H", "HX", "HY", "HZ", "SLP",
];

impl GrblTwin {
    /// Runs the main task until it has to wait. Its events must be handled before.
    pub(super) fn run_fluid_main(&mut self) {
        loop {
            // An alarm or a completed hold blocks the main task.
            let held = self.state == GrblState::Hold { complete: true };
            if held || self.now < self.fluid.blocked_until.max(self.busy_until) {
                return;
            }
            if self.fluid.is_homing {
                // An alarm that ends homing comes first.
                if self.state == GrblState::Home || !self.fluid.events.is_empty() {
                    return;
                }
                self.fluid.is_homing = false;
                self.send_answer(Ok(()));
            } else if let Some(until) = self.answer_at {
                if self.now < until {
                    return;
                }
                self.answer_at = None;
                self.send_answer(Ok(()));
            } else if let Some(block) = self.waiting_block.take() {
                if !self.execute_block(block) {
                    self.waiting_block = Some(block);
                    return;
                }
            } else if let Some(command) = self.fluid.command.take() {
                if !self.planner.is_empty() || self.state == GrblState::Run {
                    self.fluid.command = Some(command);
                    return;
                }
                if let Some(result) = self.execute_fluid_command(&command) {
                    self.send_answer(result);
                }
            } else if let Some(line) = self.fluid.line.take() {
                self.execute_fluid_line(line.trim_start());
            } else {
                return;
            }
        }
    }

    fn execute_fluid_line(&mut self, line: &str) {
        if let Some(command) = line.strip_prefix('$') {
            let name = command.split('=').next().unwrap_or_default();
            let waits = SYNCHRONOUS_COMMANDS
                .iter()
                .any(|known| known.eq_ignore_ascii_case(name));
            if waits {
                self.fluid.command = Some(command.to_owned());
            } else {
                let result = self.execute_setting(command);
                self.send_answer(result);
            }
            return;
        }
        if line.is_empty() {
            return self.send_answer(Ok(()));
        }
        let result = self.execute_fluid_block(line);
        if let Some(result) = result {
            if result.is_err_and(|number| number != 9) {
                self.send_text(&format!("[MSG:ERR: Bad GCode: {line}]\r\n"));
            }
            self.send_answer(result);
        }
    }

    /// Parses a G code block. Returns an error number, `Ok` in check mode, or `None` if the
    /// block is answered when it is executed.
    fn execute_fluid_block(&mut self, line: &str) -> Option<Result<(), u8>> {
        if self.state == GrblState::Alarm {
            return Some(Err(9));
        }
        if line.len() > MAX_BLOCK_BYTES {
            return Some(Err(14));
        }
        let text = normalize_block(line);
        match self.modal.parse_block(&text, false, self.work_offset) {
            Ok(_) if self.state == GrblState::Check => Some(Ok(())),
            Ok(block) => {
                self.waiting_block = Some(block);
                None
            }
            Err(number) => Some(Err(number)),
        }
    }

    /// Executes a `$` command after the end of all motion. Returns its result, or `None` if
    /// the command is answered later or never.
    fn execute_fluid_command(&mut self, command: &str) -> Option<Result<(), u8>> {
        let is_at_rest = matches!(
            self.state,
            GrblState::Idle | GrblState::Alarm | GrblState::Critical
        );
        let command = command.to_ascii_uppercase();
        let held = matches!(self.state, GrblState::Hold { .. });
        match command.as_str() {
            "$" if held => return Some(Err(8)),
            "I" | "#" | "H" | "HX" | "HY" | "HZ" | "13" if !is_at_rest => return Some(Err(8)),
            "" => self.send_text("HLP:$$ $# $G $I $X $H\r\n"),
            "$" => self.list_grbl_settings(),
            "#" => self.list_offsets(),
            "I" => {
                let text = self.build_info();
                self.send_text(&text);
            }
            "CD" => {
                let text = self.settings.tree().map(FluidConfig::dump);
                self.send_text(&text.unwrap_or_default());
            }
            "X" => self.unlock(),
            "C" if self.state == GrblState::Check => {
                self.send_text("[MSG:INFO: Disabled]\r\n");
                self.push_event(super::FluidEvent::Reset);
                return None;
            }
            "C" if self.state != GrblState::Idle => return Some(Err(8)),
            "C" => {
                self.state = GrblState::Check;
                self.send_text("[MSG:INFO: Enabled]\r\n");
            }
            "13" => {
                let inches = self.settings.value(13);
                self.send_text(&format!("$13={inches:.0}\r\n"));
            }
            "13=0" => return Some(self.settings.set(13, 0.0)),
            "13=1" => return Some(self.settings.set(13, 1.0)),
            "H" => return self.start_homing(None),
            "HX" => return self.start_homing(Some(0)),
            "HZ" => return self.start_homing(Some(1)),
            "HY" => return Some(Err(19)),
            _ => return Some(Err(3)),
        }
        Some(Ok(()))
    }

    /// Executes a `$` line that is answered at once, also in motion. Returns the error number
    /// if it fails.
    fn execute_setting(&mut self, command: &str) -> Result<(), u8> {
        let (name, value) = command.split_once('=').unwrap_or((command, ""));
        let (name, value) = (name.trim(), value.trim());
        if name.eq_ignore_ascii_case("G") {
            let text = self.modal.gc_report();
            self.send_text(&format!("[{text}]\r\n"));
            return Ok(());
        }
        if name == "10" {
            return self.set_report_mask(value);
        }
        let path = name.strip_prefix('/').unwrap_or(name);
        let path = path.strip_suffix('/').unwrap_or(path);
        let tree = self.settings.tree_mut().ok_or(3_u8)?;
        let message = if value.is_empty() {
            Some(tree.show(path)?)
        } else {
            tree.set(path, value)?
        };
        self.update_switch_pulses();
        self.send_text(&message.unwrap_or_default());
        Ok(())
    }

    /// Sets `$10`, the report mask, or shows it if `value` is empty. Returns the error number
    /// if it fails.
    fn set_report_mask(&mut self, value: &str) -> Result<(), u8> {
        if value.is_empty() {
            let fields = self.settings.value(10);
            self.send_text(&format!("$10={fields:.0}\r\n"));
            return Ok(());
        }
        if !matches!(
            self.state,
            GrblState::Idle | GrblState::Alarm | GrblState::Critical
        ) {
            return Err(8);
        }
        let fields: f64 = value.parse().map_err(|_| 2_u8)?;
        if !(0.0..4.0).contains(&fields) {
            return Err(80);
        }
        self.settings.set(10, fields)
    }

    /// Sends the few numbered settings that Grbl hosts read, the answer to `$$`.
    fn list_grbl_settings(&mut self) {
        let mut text = String::new();
        for number in [13, 10] {
            text.push_str(&format!("${number}={:.0}\r\n", self.settings.value(number)));
        }
        for group in [100, 110, 120, 130] {
            for (number, value) in (group..).zip(self.settings.axis_values(group)) {
                text.push_str(&format!("${number}={value:.3}\r\n"));
            }
        }
        self.send_text(&text);
    }

    /// Unlocks the board after an alarm: all axes count as homed, and motors with hard limits
    /// are released.
    fn unlock(&mut self) {
        if self.state != GrblState::Alarm {
            return;
        }
        self.fluid.unhomed = [false; 2];
        for (axis, letter) in ["x", "z"].iter().enumerate() {
            if self.is_config_on(&format!("axes/{letter}/motor0/hard_limits")) {
                self.fluid.blocked_motors[axis] = false;
            }
        }
        self.state = GrblState::Idle;
        self.send_text("[MSG:INFO: Caution: Unlocked]\r\n");
    }
}

/// Removes blanks and comments from a block and converts it to capitals.
fn normalize_block(line: &str) -> String {
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
