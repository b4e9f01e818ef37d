//! Executes the commands of the host.

use super::block;
use super::dictionary::{self, Command, Response, response_id};
use super::objects::{EdgeCounter, Endstop, Trsync, TwinOutput};
use super::stepper::{QueueResult, Stepper};
use super::{CLOCK_HZ, ConfigObject, KlipperTwin, MOVE_QUEUE_SIZE, pins};

/// Greatest number of parameters of a command.
const MAX_PARAMETERS: usize = 8;
/// Delay of a step of a moving stepper, ticks, from which on the firmware shuts down.
const MAX_PAST_TICKS: i64 = CLOCK_HZ as i64 / 1000;

const SECOND: u64 = 1_000_000_000;

/// The text with which the firmware reports a shutdown.
type ShutdownReason = &'static str;

impl KlipperTwin {
    /// Executes the commands in a block. Returns the number of commands executed.
    pub(super) fn execute(&mut self, mut content: &[u8]) -> u64 {
        let mut count = 0;
        while !content.is_empty() && self.boots_at.is_none() {
            let known = block::decode_vlq(&mut content).and_then(dictionary::find_command);
            let Some((command, parameters)) = known else {
                self.shut_down("Invalid command");
                return count;
            };
            let mut numbers = [0; MAX_PARAMETERS];
            for number in numbers.iter_mut().take(parameters) {
                match block::decode_vlq(&mut content) {
                    Some(value) => *number = value,
                    None => {
                        self.shut_down("Command parser error");
                        return count;
                    }
                }
            }
            count += 1;
            self.count_command();
            let result = match self.shutdown {
                Some(reason) => self.execute_in_shutdown(command, numbers, reason),
                None => self.execute_command(command, numbers),
            };
            if let Err(reason) = result {
                self.shut_down(reason);
            }
        }
        count
    }

    fn count_command(&mut self) {
        self.statistics.command_count += 1;
        self.recent_command_times.push_back(self.now);
        while self
            .recent_command_times
            .front()
            .is_some_and(|at| at + SECOND <= self.now)
        {
            self.recent_command_times.pop_front();
        }
        self.statistics.max_commands_per_s = self
            .statistics
            .max_commands_per_s
            .max(self.recent_command_times.len() as u32);
    }

    fn execute_in_shutdown(
        &mut self,
        command: Command,
        parameters: [u32; MAX_PARAMETERS],
        reason: ShutdownReason,
    ) -> Result<(), ShutdownReason> {
        match command {
            Command::Identify | Command::GetConfig | Command::GetUptime | Command::Reset => {
                self.execute_command(command, parameters)
            }
            Command::EmergencyStop => Ok(()),
            Command::ClearShutdown => {
                self.shutdown = None;
                Ok(())
            }
            Command::ConfigReset => {
                self.shutdown = None;
                self.crc = None;
                self.oid_count = None;
                self.oids.clear();
                Ok(())
            }
            _ => {
                self.send_response(
                    Response::IsShutdown,
                    &[dictionary::static_string_id(reason)],
                );
                Ok(())
            }
        }
    }

    fn execute_command(
        &mut self,
        command: Command,
        parameters: [u32; MAX_PARAMETERS],
    ) -> Result<(), ShutdownReason> {
        match command {
            Command::Identify => self.identify(parameters[0], parameters[1]),
            Command::GetConfig => self.send_response(
                Response::Config,
                &[
                    i64::from(self.crc.is_some()),
                    self.crc.unwrap_or(0).into(),
                    i64::from(self.shutdown.is_some()),
                    MOVE_QUEUE_SIZE as i64,
                ],
            ),
            Command::GetUptime => {
                let clock = self.clock();
                self.send_response(Response::Uptime, &[clock >> 32, i64::from(clock as u32)]);
            }
            Command::AllocateOids if self.oid_count.is_some() => {
                return Err("oids already allocated");
            }
            Command::AllocateOids => self.oid_count = Some(parameters[0]),
            Command::FinalizeConfig if self.crc.is_some() => return Err("Already finalized"),
            Command::FinalizeConfig => self.crc = Some(parameters[0]),
            Command::EmergencyStop => return Err("Command request"),
            Command::ClearShutdown => return Err("Shutdown cleared when not shutdown"),
            Command::ConfigReset => return Err("config_reset only available when shutdown"),
            Command::Reset => self.press_reset(),
            Command::ConfigStepper
            | Command::ConfigTrsync
            | Command::ConfigEndstop
            | Command::ConfigDigitalOut
            | Command::ConfigPwmOut
            | Command::ConfigCounter => return self.add_object(command, parameters),
            Command::ResetStepClock => {
                let clock = self.extend_clock(parameters[1]);
                self.stepper(parameters[0])?.reset_step_clock(clock)?;
            }
            Command::SetNextStepDir => self.stepper(parameters[0])?.up = parameters[1] != 0,
            Command::QueueStep => return self.queue_step(parameters),
            Command::StepperGetPosition => {
                let position = self.stepper(parameters[0])?.position;
                self.send_response(
                    Response::StepperPosition,
                    &[parameters[0].into(), i64::from(position as i32)],
                );
            }
            Command::StepperStopOnTrigger => {
                self.trsync(parameters[1])?;
                let stepper = self.stepper(parameters[0])?;
                if stepper.trsync.is_some() {
                    return Err("Can't add signal that is already active");
                }
                stepper.trsync = Some(parameters[1]);
            }
            Command::TrsyncStart | Command::TrsyncSetTimeout | Command::TrsyncTrigger => {
                return self.trsync_command(command, parameters);
            }
            Command::EndstopHome => return self.start_endstop(parameters),
            Command::EndstopQueryState => {
                let endstop = self.endstop(parameters[0])?.clone();
                let level = self.pin_level(endstop.pin);
                self.send_response(
                    Response::EndstopState,
                    &[
                        parameters[0].into(),
                        i64::from(endstop.next.is_some()),
                        i64::from(endstop.next.unwrap_or(0) as u32),
                        i64::from(level),
                    ],
                );
            }
            Command::QueueDigitalOut | Command::QueuePwmOut => {
                self.statistics.output_command_count += 1;
                return self.queue_output(parameters);
            }
            Command::QueryCounter => {
                let clock = self.future_clock(parameters[1])?;
                let Some(ConfigObject::EdgeCounter(counter)) = self.oids.get_mut(&parameters[0])
                else {
                    return Err("Invalid oid type");
                };
                counter.next = Some(clock);
                counter.poll = parameters[2].into();
                counter.report = clock + i64::from(parameters[3]);
                counter.report_every = parameters[3].into();
            }
        }
        Ok(())
    }

    fn identify(&mut self, offset: u32, count: u32) {
        self.statistics.identify_count += 1;
        let from = (offset as usize).min(self.dictionary.len());
        let to = (from + count as usize).min(self.dictionary.len());
        let piece = self.dictionary[from..to].to_vec();
        let mut content = Vec::new();
        block::encode_vlq(&mut content, response_id(Response::Identify));
        block::encode_vlq(&mut content, offset.into());
        content.push(piece.len() as u8);
        content.extend(piece);
        self.send(&content);
    }

    fn add_object(
        &mut self,
        command: Command,
        parameters: [u32; MAX_PARAMETERS],
    ) -> Result<(), ShutdownReason> {
        let within = self.oid_count.is_some_and(|most| parameters[0] < most);
        if !within || self.oids.contains_key(&parameters[0]) || self.crc.is_some() {
            return Err("Can't assign oid");
        }
        match command {
            Command::ConfigStepper => pins::check_output(parameters[1])
                .and_then(|()| pins::check_output(parameters[2]))?,
            Command::ConfigDigitalOut => pins::check_output(parameters[1])?,
            Command::ConfigPwmOut => pins::check_pwm(parameters[1])?,
            Command::ConfigEndstop | Command::ConfigCounter => pins::check_input(parameters[1])?,
            _ => {}
        }
        let output = |max_duration: u32, value: u32, default: u32, pulse_width| {
            let output = TwinOutput {
                pin: parameters[1],
                default,
                max_duration: max_duration.into(),
                pulse_width,
                ..TwinOutput::default()
            };
            ConfigObject::Output(output, value)
        };
        let object = match command {
            Command::ConfigStepper => ConfigObject::Stepper(Stepper::new()),
            Command::ConfigTrsync => ConfigObject::Trsync(Trsync::default()),
            Command::ConfigEndstop => ConfigObject::Endstop(Endstop {
                pin: parameters[1],
                ..Endstop::default()
            }),
            Command::ConfigDigitalOut => output(parameters[4], parameters[2], parameters[3], false),
            Command::ConfigPwmOut => output(parameters[5], parameters[3], parameters[4], true),
            _ => ConfigObject::EdgeCounter(EdgeCounter {
                pin: parameters[1],
                ..EdgeCounter::default()
            }),
        };
        self.oids.insert(parameters[0], object);
        Ok(())
    }

    fn queue_step(&mut self, parameters: [u32; MAX_PARAMETERS]) -> Result<(), ShutdownReason> {
        if parameters[2] == 0 {
            return Err("Invalid count parameter");
        }
        if self.queue_entries() >= MOVE_QUEUE_SIZE {
            return Err("Move queue overflow");
        }
        let now = self.clock();
        let (count, add) = (parameters[2] & 0xFFFF, parameters[3] as i32);
        let stepper = self.stepper(parameters[0])?;
        let due = stepper.due();
        match stepper.queue(parameters[1], count, add) {
            QueueResult::Started(first) => {
                self.statistics.min_lead_ns =
                    self.statistics.min_lead_ns.min((first - now) * 125 / 2);
                if first < now {
                    return Err("Timer too close");
                }
            }
            QueueResult::Waiting if due.is_some_and(|due| due < now - MAX_PAST_TICKS) => {
                return Err("Stepper too far in past");
            }
            QueueResult::Waiting | QueueResult::Dropped => {}
        }
        self.statistics.max_queue_entries =
            self.statistics.max_queue_entries.max(self.queue_entries());
        Ok(())
    }

    fn queue_output(&mut self, parameters: [u32; MAX_PARAMETERS]) -> Result<(), ShutdownReason> {
        if self.queue_entries() >= MOVE_QUEUE_SIZE {
            return Err("Move queue overflow");
        }
        let (clock, now) = (self.extend_clock(parameters[1]), self.clock());
        let Some(ConfigObject::Output(output, _)) = self.oids.get_mut(&parameters[0]) else {
            return Err("Invalid oid type");
        };
        if output.queue.is_empty() {
            if output
                .max_duration_end
                .is_some_and(|max_duration_end| clock > max_duration_end)
            {
                return Err(output.exceeded_reason());
            }
            if clock < now {
                return Err("Timer too close");
            }
        }
        output.queue.push_back((clock, parameters[2]));
        Ok(())
    }

    fn trsync_command(
        &mut self,
        command: Command,
        parameters: [u32; MAX_PARAMETERS],
    ) -> Result<(), ShutdownReason> {
        match command {
            Command::TrsyncStart => {
                let report = self.future_clock(parameters[1])?;
                let trsync = self.trsync(parameters[0])?;
                *trsync = Trsync {
                    can_trigger: true,
                    expire_reason: parameters[3],
                    report: (parameters[2] > 0).then_some(report),
                    report_ticks: parameters[2].into(),
                    ..Trsync::default()
                };
            }
            Command::TrsyncSetTimeout => {
                if self.trsync(parameters[0])?.can_trigger {
                    let clock = self.future_clock(parameters[1])?;
                    self.trsync(parameters[0])?.expires = Some(clock);
                }
            }
            _ => {
                self.trsync(parameters[0])?;
                // The trigger reports its state. If it happened before, the report is
                // repeated.
                let triggered = !self.trsync(parameters[0])?.can_trigger;
                self.trigger_trsync(parameters[0], parameters[1]);
                if triggered {
                    self.report_trsync(parameters[0]);
                }
            }
        }
        Ok(())
    }

    fn start_endstop(&mut self, parameters: [u32; MAX_PARAMETERS]) -> Result<(), ShutdownReason> {
        if parameters[3] == 0 {
            self.endstop(parameters[0])?.next = None;
            return Ok(());
        }
        self.trsync(parameters[6])?;
        let clock = self.future_clock(parameters[1])?;
        let endstop = self.endstop(parameters[0])?;
        *endstop = Endstop {
            pin: endstop.pin,
            next: Some(clock),
            sample_ticks: parameters[2].into(),
            sample_count: parameters[3],
            rest_ticks: parameters[4].into(),
            level: parameters[5] != 0,
            trsync: parameters[6],
            reason: parameters[7],
            matching_samples: 0,
        };
        Ok(())
    }

    fn future_clock(&self, low: u32) -> Result<i64, ShutdownReason> {
        let clock = self.extend_clock(low);
        if clock < self.clock() {
            return Err("Timer too close");
        }
        Ok(clock)
    }

    fn stepper(&mut self, oid: u32) -> Result<&mut Stepper, ShutdownReason> {
        match self.oids.get_mut(&oid) {
            Some(ConfigObject::Stepper(stepper)) => Ok(stepper),
            _ => Err("Invalid oid type"),
        }
    }

    fn endstop(&mut self, oid: u32) -> Result<&mut Endstop, ShutdownReason> {
        match self.oids.get_mut(&oid) {
            Some(ConfigObject::Endstop(endstop)) => Ok(endstop),
            _ => Err("Invalid oid type"),
        }
    }

    fn trsync(&mut self, oid: u32) -> Result<&mut Trsync, ShutdownReason> {
        match self.oids.get_mut(&oid) {
            Some(ConfigObject::Trsync(trsync)) => Ok(trsync),
            _ => Err("Invalid oid type"),
        }
    }
}
