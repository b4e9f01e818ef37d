//! Takes the configuration of the host: which object is at which pin.

use super::{Engine, Objects, Request, StepPort, WHEEL_ENCODER};
use crate::encoders::{AxisEncoder, EdgeCounter, Handwheel, MAX_COUNTS, SpindleEncoder};
use crate::messages::{Command, PINS, Reason};
use crate::outputs::OutputChannel;
use crate::stepper::Stepper;
use crate::stops::{Guard, StopGroup, StopInput};
use crate::storage::Vec;

/// Number of the first pin that is free: those before it are the serial port.
const FIRST_PIN: u32 = 2;
/// Pin number of a signal that is not connected.
const NO_PIN: u32 = 255;
/// Greatest number of objects.
const MAX_OIDS: u32 = 64;

fn check_pin(pin: u32, reason: Reason) -> Result<u32, Reason> {
    // GPIO 23, 24 and 25 are the power supply and the lamp of a Pico.
    let is_free = (FIRST_PIN..PINS).contains(&pin) && !(23..=25).contains(&pin);
    is_free.then_some(pin).ok_or(reason)
}

fn add<T, const N: usize>(objects: &mut Vec<T, N>, object: T) -> Result<(), Reason> {
    objects.push(object).map_err(|_| Reason::AssignOid)
}

impl Engine {
    /// Forgets the configuration. The positions of the axes are forgotten with it.
    pub(super) fn clear_configuration(&mut self) {
        self.crc = None;
        self.oid_count = None;
        self.objects = Objects::new();
        self.lease = None;
    }

    pub(super) fn configure(
        &mut self,
        request: &Request,
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        let values = request.values;
        match request.command {
            Command::AllocateOids if self.oid_count.is_some() => {
                return Err(Reason::OidsAllocated);
            }
            Command::AllocateOids => {
                self.oid_count = Some(values[0]);
                return Ok(());
            }
            Command::FinalizeConfig if self.crc.is_some() => {
                return Err(Reason::AlreadyFinalized);
            }
            Command::FinalizeConfig => {
                self.crc = Some(values[0]);
                return Ok(());
            }
            _ => {}
        }
        let oid = values[0];
        let is_allocated = self.oid_count.is_some_and(|count| oid < count) && oid < MAX_OIDS;
        if !is_allocated || self.objects.oids >> oid & 1 != 0 || self.crc.is_some() {
            return Err(Reason::AssignOid);
        }
        self.objects.oids |= 1 << oid;
        self.add_object(request, port)
    }

    fn add_object(&mut self, request: &Request, port: &mut impl StepPort) -> Result<(), Reason> {
        let values = request.values;
        let [oid, pin, ..] = values;
        match request.command {
            Command::ConfigStepper => {
                let pins = [
                    check_pin(pin, Reason::NoOutputPin)?,
                    check_pin(values[2], Reason::NoOutputPin)?,
                ];
                let axis = self.objects.steppers.len();
                add(&mut self.objects.steppers, Stepper::new(oid))?;
                port.set_up_stepper(axis, pins, values[3] != 0, values[4]);
            }
            Command::ConfigTrsync => {
                let group = StopGroup {
                    oid,
                    ..StopGroup::default()
                };
                add(&mut self.objects.groups, group)?;
            }
            Command::ConfigEndstop => {
                let pin = check_pin(pin, Reason::NoInputPin)?;
                port.set_up_input(pin, values[2] != 0);
                let input = StopInput {
                    oid,
                    pin,
                    ..StopInput::default()
                };
                add(&mut self.objects.inputs, input)?;
            }
            Command::ConfigGuard => {
                let pin = check_pin(pin, Reason::NoInputPin)?;
                port.set_up_input(pin, values[2] != 0);
                let guard = Guard::new(pin, values[3] != 0, values[4]);
                add(&mut self.objects.guards, guard)?;
                let guards = self.objects.guards.iter();
                self.objects.guard_levels =
                    guards.map(|guard| (guard.pin, guard.is_high)).collect();
            }
            Command::ConfigDigitalOut => {
                self.add_output(oid, pin, 0, [values[2], values[3], values[4]], port)?;
            }
            Command::ConfigPwmOut => {
                let cycle = values[2].max(1);
                self.add_output(oid, pin, cycle, [values[3], values[4], values[5]], port)?;
            }
            Command::ConfigCounter => {
                let pin = check_pin(pin, Reason::NoInputPin)?;
                port.set_up_input(pin, values[2] != 0);
                let counter = EdgeCounter {
                    oid,
                    pin,
                    ..EdgeCounter::default()
                };
                add(&mut self.objects.counters, counter)?;
            }
            _ => return self.add_encoder(request, port),
        }
        Ok(())
    }

    fn add_output(
        &mut self,
        oid: u32,
        pin: u32,
        cycle_ticks: u32,
        [value, default, max_duration]: [u32; 3],
        port: &mut impl StepPort,
    ) -> Result<(), Reason> {
        let pin = check_pin(pin, Reason::NoOutputPin)?;
        port.set_up_output(pin, cycle_ticks, value);
        let output = OutputChannel {
            oid,
            pin,
            cycle_ticks,
            default,
            max_duration,
            ..OutputChannel::default()
        };
        add(&mut self.objects.outputs, output)
    }

    fn add_encoder(&mut self, request: &Request, port: &mut impl StepPort) -> Result<(), Reason> {
        let values = request.values;
        let oid = values[0];
        let pin_a = check_pin(values[1], Reason::NoInputPin)?;
        check_pin(pin_a + 1, Reason::NoInputPin)?;
        if request.command == Command::ConfigSpindle {
            if self.objects.spindle.is_some()
                || values[3] <= MAX_COUNTS as u32
                || values[3] > 1 << 24
            {
                return Err(Reason::AssignOid);
            }
            let mut index_pin = None;
            if values[2] != NO_PIN {
                let pin = check_pin(values[2], Reason::NoInputPin)?;
                port.set_up_input(pin, true);
                index_pin = Some(pin);
            }
            port.set_up_encoder(0, pin_a);
            let raw = port.encoder(0);
            let spindle = SpindleEncoder::new(oid, values[3], index_pin, raw);
            self.objects.spindle = Some(spindle);
            return Ok(());
        }
        if request.command == Command::ConfigWheel {
            if self.objects.wheel.is_some() {
                return Err(Reason::AssignOid);
            }
            port.set_up_encoder(WHEEL_ENCODER, pin_a);
            self.objects.wheel = Some(Handwheel {
                oid,
                ..Handwheel::default()
            });
            return Ok(());
        }
        let mut steppers = self.objects.steppers.iter();
        let axis = steppers.position(|stepper| stepper.oid == values[2]);
        let axis = axis.ok_or(Reason::InvalidOidType)?;
        port.set_up_encoder(1 + axis, pin_a);
        let encoder = AxisEncoder {
            axis,
            counts: values[3] as i32,
            steps: values[4] as i32,
            limit: values[5] as i32,
            reference: (port.encoder(1 + axis), self.position(axis)),
        };
        add(&mut self.objects.axis_encoders, encoder)
    }
}
