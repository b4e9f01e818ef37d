//! The firmware's main loop: lines are read, answered, carried out.

use super::block::{Asked, Pace};
use super::planner::Block;
use super::report::figures;
use super::{GrblTwin, LEAST_CUT, LINE_BYTES, LINE_NS, SETTING_WRITE_NS, State, Variant};

impl GrblTwin {
    /// The firmware's main loop: one line after the other.
    pub(super) fn work(&mut self) {
        let busy =
            |twin: &Self| twin.silent || twin.stuck || twin.homing.is_some() || twin.pass.is_some();
        while self.now >= self.busy_until && !busy(self) {
            if let Some(until) = self.answers_at {
                if self.now < until {
                    return;
                }
                self.answers_at = None;
                self.answer(Ok(()));
            }
            if let Some(asked) = self.waiting.take() {
                if !self.carry_out(asked) {
                    self.waiting = Some(asked);
                    return;
                }
                continue;
            }
            let Some(byte) = self.received.pop_front() else {
                return;
            };
            self.collect(byte);
        }
    }

    /// Takes a character into the line; CR and LF each end one.
    fn collect(&mut self, byte: u8) {
        match byte {
            b'\n' | b'\r' => {
                let line = core::mem::take(&mut self.line);
                let too_long = core::mem::take(&mut self.too_long);
                self.in_comment = false;
                self.busy_until = self.now + if line.is_empty() { 0 } else { LINE_NS };
                if too_long {
                    self.answer(Err(11));
                    return;
                }
                self.execute(&line);
            }
            b'(' => self.in_comment = true,
            b')' => self.in_comment = false,
            _ if self.in_comment || byte <= b' ' || byte == b'/' => {}
            b';' => self.in_comment = true,
            _ if self.line.len() + 1 >= LINE_BYTES => self.too_long = true,
            _ => self.line.push(byte.to_ascii_uppercase()),
        }
    }

    fn execute(&mut self, line: &[u8]) {
        if line.is_empty() {
            self.error_latch = false;
            self.answer(Ok(()));
            return;
        }
        let text = String::from_utf8_lossy(line).into_owned();
        if let Some(command) = text.strip_prefix('$') {
            let result = self.command(command);
            if let Some(result) = result {
                self.answer(result);
            }
            return;
        }
        if self.error_latch {
            self.answer(Err(9));
            return;
        }
        if self.state == State::Alarm {
            self.answer(Err(9));
            return;
        }
        match self
            .modal
            .read(&text, self.has_spindle_sync(), self.work_offset)
        {
            Ok(_) if self.state == State::Check => self.answer(Ok(())),
            Ok(asked) => self.waiting = Some(asked),
            Err(number) => self.answer(Err(number)),
        }
    }

    /// Tries to carry a block out; false while it must wait.
    pub(super) fn carry_out(&mut self, asked: Asked) -> bool {
        if asked.drains && !(self.planner.is_empty() && self.state != State::Run) {
            return false;
        }
        if let Some(seconds) = asked.dwell {
            if !self.planner.is_empty() {
                return false;
            }
            self.answers_at = Some(self.now + (seconds.max(0.0) * 1e9) as u64);
            return true;
        }
        self.spindle = self.modal.spindle;
        self.coolant = self.modal.coolant;
        if let (Some(target), Some(lead)) = (asked.target, asked.lead) {
            if let Err(number) = self.begin_pass(asked, target, lead) {
                self.modal.position = self.millimetres();
                self.answer(Err(number));
            }
            return true;
        }
        if let Some(target) = asked.target {
            if self.planner.is_full() {
                return false;
            }
            self.plan(target, asked);
        }
        if asked.ends && self.variant == Variant::FluidNc {
            self.say("[MSG:INFO: Program End]\r\n");
        }
        self.answer(Ok(()));
        if asked.ends && self.variant != Variant::FluidNc {
            self.say("[MSG:Pgm End]\r\n");
        }
        true
    }

    pub(super) fn plan(&mut self, target: [f64; 3], asked: Asked) {
        if !self.may_plan() {
            return;
        }
        let scale = self.settings.axes(100);
        let from = self.planned_position();
        let wanted = [0, 1, 2].map(|axis| (target[axis] * scale[axis]).round() as i64);
        let steps = [0, 1, 2].map(|axis| wanted[axis] - from[axis]);
        if steps == [0; 3] {
            return;
        }
        let way = [0, 1, 2].map(|axis| steps[axis] as f64 / scale[axis]);
        let length = way.iter().map(|part| part * part).sum::<f64>().sqrt();
        let direction = way.map(|part| part / length);
        // No axis faster, nor sooner faster, than its own setting.
        let within = |limits: [f64; 3]| {
            (0..3)
                .filter(|&axis| direction[axis] != 0.0)
                .map(|axis| limits[axis] / direction[axis].abs())
                .fold(f64::INFINITY, f64::min)
        };
        let fastest = within(self.settings.axes(110)) / 60.0;
        let nominal = match asked.pace {
            _ if asked.rapid => fastest,
            Pace::Speed(speed) => speed.min(fastest),
            Pace::Time(seconds) => (length / seconds).min(fastest),
        };
        let block = Block::new(
            steps,
            direction,
            length,
            nominal.max(LEAST_CUT),
            within(self.settings.axes(120)),
        );
        self.planner.push(block, self.settings.value(11));
        if self.state == State::Idle {
            self.state = State::Run;
        }
    }

    /// Where the queue ends, pulses.
    fn planned_position(&self) -> [i64; 3] {
        let ahead = self.planner.pulses_ahead();
        let astray = self.astray();
        [0, 1, 2].map(|axis| self.position[axis] + ahead[axis] + astray[axis])
    }

    /// A `$` line; None where the answer comes later or never.
    fn command(&mut self, command: &str) -> Option<Result<(), u8>> {
        match command {
            "$" => {
                let lines: String = self.settings.lines().collect();
                self.say(&lines);
            }
            "#" => self.list_offsets(),
            "G" => {
                let text = self.modal.text();
                self.say(&format!("[{text}]\r\n"));
            }
            "I" => {
                let text = self.identity();
                self.say(&text);
            }
            "X" if self.state == State::Alarm => {
                self.state = State::Idle;
                self.say("[MSG:Caution: Unlocked]\r\n");
            }
            "X" => {}
            "C" if self.state == State::Check => {
                self.state = State::Idle;
                self.answer(Ok(()));
                self.start_firmware();
                return None;
            }
            "C" if self.state == State::Idle => {
                self.state = State::Check;
                self.say("[MSG:Enabled]\r\n");
            }
            "H" if !self.settings.is_on(22) => return Some(Err(5)),
            "H" => return self.begin_homing([true, true]),
            "HX" if self.homes_single_axes() => return self.begin_homing([true, false]),
            "HZ" if self.homes_single_axes() => return self.begin_homing([false, true]),
            _ => return self.write_setting(command).err().map(Err),
        }
        Some(Ok(()))
    }

    /// `$#`: nothing but G54 is offset.
    pub(super) fn list_offsets(&mut self) {
        for system in 54..=59 {
            let offset = if system == 54 {
                self.work_offset
            } else {
                [0.0; 3]
            };
            self.say(&format!("[G{system}:{}]\r\n", figures(offset)));
        }
        self.say("[G28:0.000,0.000,0.000]\r\n[G30:0.000,0.000,0.000]\r\n");
        self.say("[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n");
    }

    fn write_setting(&mut self, command: &str) -> Result<(), u8> {
        let (number, value) = command.split_once('=').ok_or(3_u8)?;
        if !matches!(self.state, State::Idle | State::Alarm) {
            return Err(8);
        }
        let number = number.parse().map_err(|_| 3_u8)?;
        let value: f64 = value.parse().map_err(|_| 2_u8)?;
        self.settings.set(number, value)?;
        self.set_switches();
        // The answer comes when the memory is written; until then nothing is heard.
        self.answers_at = Some(self.now);
        if self.variant == Variant::Grbl {
            self.deaf_until = self.now + SETTING_WRITE_NS;
            self.answers_at = Some(self.deaf_until);
        }
        Ok(())
    }
}
