//! What the commands of the host do.

use super::block;
use super::dictionary::{self, Command, Response, response_id};
use super::objects::{Counter, Endstop, Group, Output};
use super::stepper::{Queued, Stepper};
use super::{KlipperTwin, Object, QUEUE, RATE, pins};

/// Most parameters of a command.
const MOST: usize = 8;
/// Later than this a step of a moving axis is not made, ticks.
const TOO_FAR: i64 = RATE as i64 / 1000;

const SECOND: u64 = 1_000_000_000;

/// A reason to shut down.
type Reason = &'static str;

impl KlipperTwin {
    /// Carries out the commands of a block; how many there were.
    pub(super) fn execute(&mut self, mut content: &[u8]) -> u64 {
        let mut count = 0;
        while !content.is_empty() && self.boots_at.is_none() {
            let known = block::take(&mut content).and_then(dictionary::command);
            let Some((command, parameters)) = known else {
                self.shut_down("Invalid command");
                return count;
            };
            let mut numbers = [0; MOST];
            for number in numbers.iter_mut().take(parameters) {
                match block::take(&mut content) {
                    Some(value) => *number = value,
                    None => {
                        self.shut_down("Command parser error");
                        return count;
                    }
                }
            }
            count += 1;
            self.note_command();
            let result = match self.shutdown {
                Some(reason) => self.command_when_down(command, numbers, reason),
                None => self.command(command, numbers),
            };
            if let Err(reason) = result {
                self.shut_down(reason);
            }
        }
        count
    }

    fn note_command(&mut self) {
        self.figures.commands += 1;
        self.recent.push_back(self.now);
        while self
            .recent
            .front()
            .is_some_and(|at| at + SECOND <= self.now)
        {
            self.recent.pop_front();
        }
        self.figures.busiest = self.figures.busiest.max(self.recent.len() as u32);
    }

    fn command_when_down(
        &mut self,
        command: Command,
        n: [u32; MOST],
        reason: Reason,
    ) -> Result<(), Reason> {
        match command {
            Command::Identify | Command::GetConfig | Command::GetUptime | Command::Reset => {
                self.command(command, n)
            }
            Command::EmergencyStop => Ok(()),
            Command::ClearShutdown => {
                self.shutdown = None;
                Ok(())
            }
            Command::ConfigReset => {
                self.shutdown = None;
                self.crc = None;
                self.most_oids = None;
                self.oids.clear();
                Ok(())
            }
            _ => {
                self.say(Response::IsShutdown, &[dictionary::text_id(reason)]);
                Ok(())
            }
        }
    }

    fn command(&mut self, command: Command, n: [u32; MOST]) -> Result<(), Reason> {
        match command {
            Command::Identify => self.identify(n[0], n[1]),
            Command::GetConfig => self.say(
                Response::Config,
                &[
                    i64::from(self.crc.is_some()),
                    self.crc.unwrap_or(0).into(),
                    i64::from(self.shutdown.is_some()),
                    QUEUE as i64,
                ],
            ),
            Command::GetUptime => {
                let clock = self.clock();
                self.say(Response::Uptime, &[clock >> 32, i64::from(clock as u32)]);
            }
            Command::AllocateOids if self.most_oids.is_some() => {
                return Err("oids already allocated");
            }
            Command::AllocateOids => self.most_oids = Some(n[0]),
            Command::FinalizeConfig if self.crc.is_some() => return Err("Already finalized"),
            Command::FinalizeConfig => self.crc = Some(n[0]),
            Command::EmergencyStop => return Err("Command request"),
            Command::ClearShutdown => return Err("Shutdown cleared when not shutdown"),
            Command::ConfigReset => return Err("config_reset only available when shutdown"),
            Command::Reset => self.press_reset(),
            Command::ConfigStepper
            | Command::ConfigTrsync
            | Command::ConfigEndstop
            | Command::ConfigDigitalOut
            | Command::ConfigPwmOut
            | Command::ConfigCounter => return self.configure(command, n),
            Command::ResetStepClock => {
                let clock = self.whole(n[1]);
                self.stepper(n[0])?.set_clock(clock)?;
            }
            Command::SetNextStepDir => self.stepper(n[0])?.up = n[1] != 0,
            Command::QueueStep => return self.queue_step(n),
            Command::StepperGetPosition => {
                let position = self.stepper(n[0])?.position;
                self.say(
                    Response::StepperPosition,
                    &[n[0].into(), i64::from(position as i32)],
                );
            }
            Command::StepperStopOnTrigger => {
                self.group(n[1])?;
                let stepper = self.stepper(n[0])?;
                if stepper.group.is_some() {
                    return Err("Can't add signal that is already active");
                }
                stepper.group = Some(n[1]);
            }
            Command::TrsyncStart | Command::TrsyncSetTimeout | Command::TrsyncTrigger => {
                return self.group_command(command, n);
            }
            Command::EndstopHome => return self.home(n),
            Command::EndstopQueryState => {
                let endstop = self.endstop(n[0])?.clone();
                let level = self.level(endstop.pin);
                self.say(
                    Response::EndstopState,
                    &[
                        n[0].into(),
                        i64::from(endstop.next.is_some()),
                        i64::from(endstop.next.unwrap_or(0) as u32),
                        i64::from(level),
                    ],
                );
            }
            Command::QueueDigitalOut | Command::QueuePwmOut => {
                self.figures.outputs += 1;
                return self.queue_output(n);
            }
            Command::QueryCounter => {
                let clock = self.in_time(n[1])?;
                let Some(Object::Counter(counter)) = self.oids.get_mut(&n[0]) else {
                    return Err("Invalid oid type");
                };
                counter.next = Some(clock);
                counter.poll = n[2].into();
                counter.report = clock + i64::from(n[3]);
                counter.report_every = n[3].into();
            }
        }
        Ok(())
    }

    fn identify(&mut self, offset: u32, count: u32) {
        self.figures.identify += 1;
        let from = (offset as usize).min(self.dictionary.len());
        let to = (from + count as usize).min(self.dictionary.len());
        let piece = self.dictionary[from..to].to_vec();
        let mut content = Vec::new();
        block::put(&mut content, response_id(Response::Identify));
        block::put(&mut content, offset.into());
        content.push(piece.len() as u8);
        content.extend(piece);
        self.send(&content);
    }

    fn configure(&mut self, command: Command, n: [u32; MOST]) -> Result<(), Reason> {
        let within = self.most_oids.is_some_and(|most| n[0] < most);
        if !within || self.oids.contains_key(&n[0]) || self.crc.is_some() {
            return Err("Can't assign oid");
        }
        match command {
            Command::ConfigStepper => pins::output(n[1]).and_then(|()| pins::output(n[2]))?,
            Command::ConfigDigitalOut => pins::output(n[1])?,
            Command::ConfigPwmOut => pins::pulse_width(n[1])?,
            Command::ConfigEndstop | Command::ConfigCounter => pins::input(n[1])?,
            _ => {}
        }
        let output = |longest: u32, value: u32, default: u32, pulse_width| {
            let output = Output {
                pin: n[1],
                default,
                longest: longest.into(),
                pulse_width,
                ..Output::default()
            };
            Object::Output(output, value)
        };
        let object = match command {
            Command::ConfigStepper => Object::Stepper(Stepper::new()),
            Command::ConfigTrsync => Object::Group(Group::default()),
            Command::ConfigEndstop => Object::Endstop(Endstop {
                pin: n[1],
                ..Endstop::default()
            }),
            Command::ConfigDigitalOut => output(n[4], n[2], n[3], false),
            Command::ConfigPwmOut => output(n[5], n[3], n[4], true),
            _ => Object::Counter(Counter {
                pin: n[1],
                ..Counter::default()
            }),
        };
        self.oids.insert(n[0], object);
        Ok(())
    }

    fn queue_step(&mut self, n: [u32; MOST]) -> Result<(), Reason> {
        if n[2] == 0 {
            return Err("Invalid count parameter");
        }
        if self.queued() >= QUEUE {
            return Err("Move queue overflow");
        }
        let now = self.clock();
        let (count, add) = (n[2] & 0xFFFF, n[3] as i32);
        let stepper = self.stepper(n[0])?;
        let due = stepper.due();
        match stepper.queue(n[1], count, add) {
            Queued::Starts(first) => {
                self.figures.lead = self.figures.lead.min((first - now) * 125 / 2);
                if first < now {
                    return Err("Timer too close");
                }
            }
            Queued::Waits if due.is_some_and(|due| due < now - TOO_FAR) => {
                return Err("Stepper too far in past");
            }
            Queued::Waits | Queued::Dropped => {}
        }
        self.figures.queue = self.figures.queue.max(self.queued());
        Ok(())
    }

    fn queue_output(&mut self, n: [u32; MOST]) -> Result<(), Reason> {
        if self.queued() >= QUEUE {
            return Err("Move queue overflow");
        }
        let (clock, now) = (self.whole(n[1]), self.clock());
        let Some(Object::Output(output, _)) = self.oids.get_mut(&n[0]) else {
            return Err("Invalid oid type");
        };
        if output.queue.is_empty() {
            if output.until.is_some_and(|until| clock > until) {
                return Err(output.exceeds());
            }
            if clock < now {
                return Err("Timer too close");
            }
        }
        output.queue.push_back((clock, n[2]));
        Ok(())
    }

    fn group_command(&mut self, command: Command, n: [u32; MOST]) -> Result<(), Reason> {
        match command {
            Command::TrsyncStart => {
                let report = self.in_time(n[1])?;
                let group = self.group(n[0])?;
                *group = Group {
                    can_trigger: true,
                    expire_reason: n[3],
                    report: (n[2] > 0).then_some(report),
                    report_ticks: n[2].into(),
                    ..Group::default()
                };
            }
            Command::TrsyncSetTimeout => {
                if self.group(n[0])?.can_trigger {
                    let clock = self.in_time(n[1])?;
                    self.group(n[0])?.expires = Some(clock);
                }
            }
            _ => {
                self.group(n[0])?;
                // The report of the trigger is the answer, or that of an older one.
                let triggered = !self.group(n[0])?.can_trigger;
                self.trigger(n[0], n[1]);
                if triggered {
                    self.report(n[0]);
                }
            }
        }
        Ok(())
    }

    fn home(&mut self, n: [u32; MOST]) -> Result<(), Reason> {
        if n[3] == 0 {
            self.endstop(n[0])?.next = None;
            return Ok(());
        }
        self.group(n[6])?;
        let clock = self.in_time(n[1])?;
        let endstop = self.endstop(n[0])?;
        *endstop = Endstop {
            pin: endstop.pin,
            next: Some(clock),
            sample: n[2].into(),
            samples: n[3],
            rest: n[4].into(),
            level: n[5] != 0,
            group: n[6],
            reason: n[7],
            agreed: 0,
        };
        Ok(())
    }

    fn in_time(&self, low: u32) -> Result<i64, Reason> {
        let clock = self.whole(low);
        if clock < self.clock() {
            return Err("Timer too close");
        }
        Ok(clock)
    }

    fn stepper(&mut self, oid: u32) -> Result<&mut Stepper, Reason> {
        match self.oids.get_mut(&oid) {
            Some(Object::Stepper(stepper)) => Ok(stepper),
            _ => Err("Invalid oid type"),
        }
    }

    fn endstop(&mut self, oid: u32) -> Result<&mut Endstop, Reason> {
        match self.oids.get_mut(&oid) {
            Some(Object::Endstop(endstop)) => Ok(endstop),
            _ => Err("Invalid oid type"),
        }
    }

    fn group(&mut self, oid: u32) -> Result<&mut Group, Reason> {
        match self.oids.get_mut(&oid) {
            Some(Object::Group(group)) => Ok(group),
            _ => Err("Invalid oid type"),
        }
    }
}
