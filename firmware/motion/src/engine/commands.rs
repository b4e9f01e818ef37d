//! Executes the commands of the host.

use super::{Engine, EngineState, Request, StepPort};
use crate::angle::Segment;
use crate::clock_steps::{ClockRun, is_before};
use crate::messages::{Command, FIRST_REASON_ID, QUEUE_SIZE, Reason, Response};
use crate::stepper::{Entry, Stepper};
use crate::stops::{StopGroup, StopInput};

impl Engine {
    /// Executes a command.
    pub fn execute(&mut self, request: &Request, port: &mut impl StepPort) {
        let result = match self.state {
            EngineState::ShutDown(reason) => self.execute_in_shutdown(request, reason, port),
            EngineState::Stopping(_) => self.execute_in_stop(request, port),
            EngineState::Running => self.execute_running(request, port),
        };
        if let Err(reason) = result {
            self.shut_down(reason, port);
        }
    }

    fn execute_in_shutdown(
        &mut self,
        request: &Request,
        reason: Reason,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        match request.command {
            Command::GetConfig
            | Command::GetUptime
            | Command::StepperGetPosition
            | Command::Reset => return self.execute_running(request, port),
            Command::Identify | Command::EmergencyStop => {}
            Command::ClearShutdown => self.state = EngineState::Running,
            Command::ConfigReset => {
                self.clear_configuration();
                self.state = EngineState::Running;
            }
            _ => {
                let id = FIRST_REASON_ID + reason as u32;
                self.send(Response::IsShutdown, [id.into(), 0, 0, 0]);
            }
        }
        Ok(())
    }

    /// Executes a command during a planned stop: queries, and what stops at once.
    fn execute_in_stop(
        &mut self,
        request: &Request,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        match request.command {
            Command::Identify
            | Command::GetConfig
            | Command::GetUptime
            | Command::StepperGetPosition
            | Command::EndstopQueryState
            | Command::TrsyncTrigger
            | Command::EmergencyStop
            | Command::Reset => self.execute_running(request, port),
            _ => Ok(()),
        }
    }

    fn execute_running(
        &mut self,
        request: &Request,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        let values = request.values;
        match request.command {
            Command::Identify => return Err(fault_reason(values[0])),
            Command::GetConfig => self.report_config(),
            Command::GetUptime => {
                let clock = port.clock();
                let values = [(clock >> 32) as i64, i64::from(clock as u32), 0, 0];
                self.send(Response::Uptime, values);
            }
            Command::EmergencyStop => return Err(Reason::CommandRequest),
            Command::ClearShutdown => return Err(Reason::NotShutdown),
            Command::ConfigReset => return Err(Reason::ResetNotShutdown),
            Command::Reset => port.restart(),
            Command::StepperGetPosition => {
                let position = self.stepper(values[0])?.position;
                let values = [values[0].into(), position.into(), 0, 0];
                self.send(Response::StepperPosition, values);
            }
            Command::ResetStepClock => self.stepper(values[0])?.reset_step_clock(values[1])?,
            Command::SetNextStepDir => self.stepper(values[0])?.next_is_up = values[1] != 0,
            Command::QueueStep
            | Command::BeginAngle
            | Command::BeginTap
            | Command::QueueAngle
            | Command::EndAngle => return self.queue_entry(request, port),
            Command::StepperStopOnTrigger => {
                self.group(values[1])?;
                let stepper = self.stepper(values[0])?;
                if stepper.trsync.is_some() {
                    return Err(Reason::SignalActive);
                }
                stepper.trsync = Some(values[1]);
            }
            Command::TrsyncStart | Command::TrsyncSetTimeout | Command::TrsyncTrigger => {
                return self.execute_group(request, port);
            }
            Command::EndstopHome | Command::EndstopQueryState => {
                return self.execute_input(request, port);
            }
            Command::QueueDigitalOut | Command::QueuePwmOut => {
                let now = port.clock() as u32;
                let mut outputs = self.objects.outputs.iter_mut();
                let output = outputs.find(|output| output.oid == values[0]);
                let output = output.ok_or(Reason::InvalidOidType)?;
                output.queue(values[1], values[2], now)?;
            }
            Command::QueryCounter => {
                let mut counters = self.objects.counters.iter_mut();
                let counter = counters.find(|counter| counter.oid == values[0]);
                let counter = counter.ok_or(Reason::InvalidOidType)?;
                counter.next = Some(values[1]);
                counter.poll_ticks = values[2];
                counter.report = values[1].wrapping_add(values[3]);
                counter.report_ticks = values[3];
            }
            Command::QueryEncoder => {
                let is_known = self
                    .objects
                    .spindle
                    .is_some_and(|spindle| spindle.oid == values[0]);
                if !is_known {
                    return Err(Reason::InvalidOidType);
                }
                self.encoder_report.next = Some(values[1]);
                self.encoder_report.rest_ticks = values[2];
            }
            Command::QueryWheel => {
                let wheel = self.objects.wheel.as_mut();
                let wheel = wheel.filter(|wheel| wheel.oid == values[0]);
                let wheel = wheel.ok_or(Reason::InvalidOidType)?;
                wheel.next = Some(values[1]);
                wheel.rest_ticks = values[2];
            }
            Command::RenewLease => return self.renew_lease(values[0], values[1], port),
            _ => return self.configure(request, port),
        }
        Ok(())
    }

    fn report_config(&mut self) {
        let is_shut_down = !matches!(self.state, EngineState::Running);
        let values = [
            self.crc.is_some().into(),
            self.crc.unwrap_or(0).into(),
            is_shut_down.into(),
            QUEUE_SIZE as i64,
        ];
        self.send(Response::Config, values);
    }

    /// Extends the lease if the host means the same configuration.
    fn renew_lease(
        &mut self,
        crc: u32,
        clock: u32,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        if self.crc != Some(crc) {
            return Err(Reason::LeaseHash);
        }
        if is_before(clock, port.clock() as u32) {
            return Err(Reason::TimerTooClose);
        }
        self.lease = Some(clock);
        Ok(())
    }

    fn queue_entry(&mut self, request: &Request, port: &mut impl StepPort) -> Result<(), Reason> {
        let values = request.values;
        if self.crc.is_none() {
            return Err(Reason::NotConfigured);
        }
        let turn = self
            .objects
            .spindle
            .map_or(0, |spindle| spindle.angle.counts_per_turn);
        let is_armed = |oid: Option<u32>| {
            let mut groups = self.objects.groups.iter();
            let group = groups.find(|group| Some(group.oid) == oid);
            group.is_some_and(|group| group.can_trigger && group.expires.is_some())
        };
        let mut steppers = self.objects.steppers.iter();
        let known = steppers.find(|stepper| stepper.oid == values[0]);
        let has_lease = self.lease.is_some()
            || known.is_some_and(|stepper| stepper.is_stopped() || is_armed(stepper.trsync));
        if known.is_some() && !has_lease {
            return Err(Reason::NoLease);
        }
        let queued: usize = self
            .objects
            .steppers
            .iter()
            .map(Stepper::queue_length)
            .sum();
        if queued >= QUEUE_SIZE {
            return Err(Reason::QueueOverflow);
        }
        let stepper = self.stepper(values[0])?;
        let entry = match request.command {
            Command::QueueStep => Entry::Clock(ClockRun {
                interval: values[1],
                count: values[2] as u16,
                add: values[3] as i16,
                is_up: stepper.next_is_up,
            }),
            Command::BeginAngle | Command::BeginTap if values[2] >= turn => {
                return Err(Reason::NoSpindle);
            }
            Command::BeginTap if values[6] == 0 || values[6] > i32::MAX as u32 => {
                return Err(Reason::InvalidCount);
            }
            Command::BeginAngle | Command::BeginTap => Entry::Begin {
                clock: values[1],
                start: values[2],
                denominator: values[3],
                phase: values[4],
                is_reverse: values[5] != 0,
            },
            Command::QueueAngle if values[1] > i32::MAX as u32 => return Err(Reason::InvalidCount),
            Command::QueueAngle => Entry::Angle(Segment {
                length: values[1] as i32,
                numerator: values[2] as i32,
                add: values[3] as i32,
            }),
            _ => Entry::End,
        };
        let now = port.clock() as u32;
        stepper.queue(entry, now)?;
        if request.command == Command::BeginTap {
            stepper.queue(Entry::Depth(values[6]), now)?;
        }
        Ok(())
    }

    fn execute_group(&mut self, request: &Request, port: &mut impl StepPort) -> Result<(), Reason> {
        let values = request.values;
        let now = port.clock() as u32;
        let group = self.group(values[0])?;
        match request.command {
            Command::TrsyncStart => {
                *group = StopGroup {
                    oid: values[0],
                    can_trigger: true,
                    expire_reason: values[3],
                    report: (values[2] > 0).then_some(values[1]),
                    report_ticks: values[2],
                    ..StopGroup::default()
                };
            }
            Command::TrsyncSetTimeout if is_before(values[1], now) => {
                return Err(Reason::TimerTooClose);
            }
            Command::TrsyncSetTimeout => {
                if group.can_trigger {
                    group.expires = Some(values[1]);
                }
            }
            _ => {
                // The trigger reports its state. If it happened before, the report is repeated.
                let has_triggered = !group.can_trigger;
                self.trigger(values[0], values[1], port);
                if has_triggered {
                    self.report_group(values[0], now);
                }
            }
        }
        Ok(())
    }

    fn execute_input(&mut self, request: &Request, port: &mut impl StepPort) -> Result<(), Reason> {
        let values = request.values;
        let pins = port.pins();
        if request.command == Command::EndstopQueryState {
            let input = *self.input(values[0])?;
            let values = [
                values[0].into(),
                input.next.is_some().into(),
                input.next.unwrap_or(0).into(),
                i64::from(pins >> input.pin & 1),
            ];
            self.send(Response::EndstopState, values);
            return Ok(());
        }
        if values[3] == 0 {
            self.input(values[0])?.next = None;
            self.objects.collect_input_levels();
            return Ok(());
        }
        self.group(values[6])?;
        let input = self.input(values[0])?;
        *input = StopInput {
            oid: values[0],
            pin: input.pin,
            sample_ticks: values[2],
            sample_count: values[3],
            is_high: values[5] != 0,
            trsync: values[6],
            reason: values[7],
            ..StopInput::default()
        };
        input.watch(values[1]);
        self.objects.collect_input_levels();
        Ok(())
    }

    pub(super) fn stepper(&mut self, oid: u32) -> Result<&mut Stepper, Reason> {
        let mut steppers = self.objects.steppers.iter_mut();
        let stepper = steppers.find(|stepper| stepper.oid == oid);
        stepper.ok_or(Reason::InvalidOidType)
    }

    fn group(&mut self, oid: u32) -> Result<&mut StopGroup, Reason> {
        let mut groups = self.objects.groups.iter_mut();
        let group = groups.find(|group| group.oid == oid);
        group.ok_or(Reason::InvalidOidType)
    }

    fn input(&mut self, oid: u32) -> Result<&mut StopInput, Reason> {
        let mut inputs = self.objects.inputs.iter_mut();
        let input = inputs.find(|input| input.oid == oid);
        input.ok_or(Reason::InvalidOidType)
    }
}

/// Returns the reason of a block that cannot be executed.
fn fault_reason(number: u32) -> Reason {
    if number == Reason::InvalidCommand as u32 {
        Reason::InvalidCommand
    } else {
        Reason::ParserError
    }
}
