//! The main loop of Grbl and grblHAL: reads, answers and executes lines.

use super::block::{CutFeed, ParsedBlock};
use super::planner::PlannedBlock;
use super::report::format_axes;
use super::{
    GrblState, GrblTwin, LINE_NS, MAX_LINE_BYTES, MIN_CUT_SPEED, SETTING_WRITE_NS, Variant,
};

impl GrblTwin {
    /// Runs the main loop of the firmware until it has to wait.
    pub(super) fn run_main_loop(&mut self) {
        let busy = |twin: &Self| {
            twin.waits_for_reset
                || twin.main_loop_blocked
                || twin.homing.is_some()
                || twin.pass.is_some()
        };
        while self.now >= self.busy_until && !busy(self) {
            if let Some(until) = self.answer_at {
                if self.now < until {
                    return;
                }
                self.answer_at = None;
                self.send_answer(Ok(()));
            }
            if let Some(block) = self.waiting_block.take() {
                if !self.execute_block(block) {
                    self.waiting_block = Some(block);
                    return;
                }
                continue;
            }
            let Some(byte) = self.received.pop_front() else {
                return;
            };
            self.append_byte(byte);
        }
    }

    /// Adds a received byte to the current line. CR and LF each end the line.
    fn append_byte(&mut self, byte: u8) {
        match byte {
            b'\n' | b'\r' => {
                let line = core::mem::take(&mut self.line);
                let too_long = core::mem::take(&mut self.too_long);
                self.in_comment = false;
                self.busy_until = self.now + if line.is_empty() { 0 } else { LINE_NS };
                if too_long {
                    self.send_answer(Err(11));
                    return;
                }
                self.execute_line(&line);
            }
            b'(' => self.in_comment = true,
            b')' => self.in_comment = false,
            _ if self.in_comment || byte <= b' ' || byte == b'/' => {}
            b';' => self.in_comment = true,
            _ if self.line.len() + 1 >= MAX_LINE_BYTES => self.too_long = true,
            _ => self.line.push(byte.to_ascii_uppercase()),
        }
    }

    fn execute_line(&mut self, line: &[u8]) {
        if line.is_empty() {
            self.error_latch = false;
            self.send_answer(Ok(()));
            return;
        }
        let text = String::from_utf8_lossy(line).into_owned();
        if let Some(command) = text.strip_prefix('$') {
            let result = self.execute_command(command);
            if let Some(result) = result {
                self.send_answer(result);
            }
            return;
        }
        if self.error_latch {
            self.send_answer(Err(9));
            return;
        }
        if self.state == GrblState::Alarm {
            self.send_answer(Err(9));
            return;
        }
        match self
            .modal
            .parse_block(&text, self.has_spindle_sync(), self.work_offset)
        {
            Ok(_) if self.state == GrblState::Check => self.send_answer(Ok(())),
            Ok(block) => self.waiting_block = Some(block),
            Err(number) => self.send_answer(Err(number)),
        }
    }

    /// Executes a block. Returns false if the block must wait for the planner.
    pub(super) fn execute_block(&mut self, block: ParsedBlock) -> bool {
        if block.waits_for_empty_queue && !(self.planner.is_empty() && self.state != GrblState::Run)
        {
            return false;
        }
        if let Some(seconds) = block.dwell {
            if !self.planner.is_empty() {
                return false;
            }
            self.answer_at = Some(self.now + (seconds.max(0.0) * 1e9) as u64);
            return true;
        }
        self.spindle_code = self.modal.spindle_code;
        self.coolant = self.modal.coolant;
        if let (Some(target), Some(lead)) = (block.target, block.lead) {
            if let Err(number) = self.begin_pass(block, target, lead) {
                self.modal.position = self.position_mm();
                self.send_answer(Err(number));
            }
            return true;
        }
        if let Some(target) = block.target {
            if self.planner.is_full() {
                return false;
            }
            self.plan_move(target, block);
        }
        if block.ends_program && self.variant == Variant::FluidNc {
            self.send_text("[MSG:INFO: Program End]\r\n");
        }
        self.send_answer(Ok(()));
        if block.ends_program && self.variant != Variant::FluidNc {
            self.send_text("[MSG:Pgm End]\r\n");
        }
        true
    }

    pub(super) fn plan_move(&mut self, target: [f64; 3], block: ParsedBlock) {
        if !self.check_homed() {
            return;
        }
        let scale = self.settings.axis_values(100);
        let from = self.planner_end_position();
        let wanted = [0, 1, 2].map(|axis| (target[axis] * scale[axis]).round() as i64);
        let steps = [0, 1, 2].map(|axis| wanted[axis] - from[axis]);
        if steps == [0; 3] {
            return;
        }
        let distance = [0, 1, 2].map(|axis| steps[axis] as f64 / scale[axis]);
        let length = distance.iter().map(|part| part * part).sum::<f64>().sqrt();
        let direction = distance.map(|part| part / length);
        // No axis exceeds its maximum speed or acceleration.
        let within = |limits: [f64; 3]| {
            (0..3)
                .filter(|&axis| direction[axis] != 0.0)
                .map(|axis| limits[axis] / direction[axis].abs())
                .fold(f64::INFINITY, f64::min)
        };
        let fastest = within(self.settings.axis_values(110)) / 60.0;
        let nominal = match block.feed {
            _ if block.rapid => fastest,
            CutFeed::Speed(speed) => speed.min(fastest),
            CutFeed::Duration(seconds) => (length / seconds).min(fastest),
        };
        let block = PlannedBlock::new(
            steps,
            direction,
            length,
            nominal.max(MIN_CUT_SPEED),
            within(self.settings.axis_values(120)),
        );
        self.planner.push(block, self.settings.value(11));
        if self.state == GrblState::Idle {
            self.state = GrblState::Run;
        }
    }

    /// Returns the position of X, Y, Z at the end of the planned motion, pulses.
    fn planner_end_position(&self) -> [i64; 3] {
        let ahead = self.planner.pending_pulses();
        let planner_error = self.planner_error();
        [0, 1, 2].map(|axis| self.position[axis] + ahead[axis] + planner_error[axis])
    }

    /// Executes a `$` line. Returns its result, or `None` if the line is answered later or
    /// never.
    fn execute_command(&mut self, command: &str) -> Option<Result<(), u8>> {
        match command {
            "$" => {
                let lines: String = self.settings.lines().collect();
                self.send_text(&lines);
            }
            "#" => self.list_offsets(),
            "G" => {
                let text = self.modal.gc_report();
                self.send_text(&format!("[{text}]\r\n"));
            }
            "I" => {
                let text = self.build_info();
                self.send_text(&text);
            }
            "X" if self.state == GrblState::Alarm => {
                self.state = GrblState::Idle;
                self.send_text("[MSG:Caution: Unlocked]\r\n");
            }
            "X" => {}
            "C" if self.state == GrblState::Check => {
                self.state = GrblState::Idle;
                self.send_answer(Ok(()));
                self.restart_firmware();
                return None;
            }
            "C" if self.state == GrblState::Idle => {
                self.state = GrblState::Check;
                self.send_text("[MSG:Enabled]\r\n");
            }
            "H" if !self.settings.is_on(22) => return Some(Err(5)),
            "H" => return self.begin_homing([true, true]),
            "HX" if self.can_home_single_axis() => return self.begin_homing([true, false]),
            "HZ" if self.can_home_single_axis() => return self.begin_homing([false, true]),
            _ => return self.write_setting(command).err().map(Err),
        }
        Some(Ok(()))
    }

    /// Sends the work offsets, the answer to `$#`. Only that of G54 can differ from 0.
    pub(super) fn list_offsets(&mut self) {
        for system in 54..=59 {
            let offset = if system == 54 {
                self.work_offset
            } else {
                [0.0; 3]
            };
            self.send_text(&format!("[G{system}:{}]\r\n", format_axes(offset)));
        }
        self.send_text("[G28:0.000,0.000,0.000]\r\n[G30:0.000,0.000,0.000]\r\n");
        self.send_text("[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n");
    }

    fn write_setting(&mut self, command: &str) -> Result<(), u8> {
        let (number, value) = command.split_once('=').ok_or(3_u8)?;
        if !matches!(self.state, GrblState::Idle | GrblState::Alarm) {
            return Err(8);
        }
        let number = number.parse().map_err(|_| 3_u8)?;
        let value: f64 = value.parse().map_err(|_| 2_u8)?;
        self.settings.set(number, value)?;
        self.update_switch_pulses();
        // The answer follows after the setting is written; until then the board receives
        // nothing.
        self.answer_at = Some(self.now);
        if self.variant == Variant::Grbl {
            self.deaf_until = self.now + SETTING_WRITE_NS;
            self.answer_at = Some(self.deaf_until);
        }
        Ok(())
    }
}
