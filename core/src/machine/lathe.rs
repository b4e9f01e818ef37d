//! The simulated lathe: its state, one tick of it, and its contacts.

use gsk_plc::address::{Area, BitAddress};
use serde::{Deserialize, Serialize};

use super::axis_drive::AxisDrive;
use super::chuck::{Cylinder, Gearbox};
use super::config::LatheConfig;
use super::faults::{ActiveFaults, Disturbance, LatheFault};
use super::io::{BoardContacts, MachineInputs, MachineOutputs, TrippedLimit};
use super::pins::{self, ContactPin};
use super::spindle_drive::{SpindleDrive, SpindleOutputs};
use super::turret::TurretDrive;
use super::wiring::{MachineWiring, SharedPin};
use crate::memory::ControlParameters;
use crate::units::{Axis, PerAxis, Point, Pulses};

/// Number of X bytes that come from the machine and can be forced.
const X_BYTES: usize = 30;

/// The simulated lathe; its whole state can be saved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulatedLathe {
    config: LatheConfig,
    wiring: MachineWiring,
    axes: PerAxis<AxisDrive>,
    turret: TurretDrive,
    spindle: SpindleDrive,
    chuck: Cylinder,
    tailstock: Cylinder,
    gears: Gearbox,
    coolant: bool,
    lubrication: bool,
    enable: PerAxis<bool>,
    emergency_button: bool,
    overtravel_release: bool,
    faults: ActiveFaults,
    disturbance: Disturbance,
    /// Number of the station whose switch is stuck, from 1; `None` without this fault.
    stuck_station: Option<u8>,
    /// Encoder count at the last one-turn signal before the signal was lost.
    lost_index: i64,
    handwheel: i32,
    forced: [u8; X_BYTES],
    #[serde(rename = "forced_to")]
    forced_levels: [u8; X_BYTES],
    /// Whether a pulse board moves the slides of a real lathe. The switches of the
    /// simulated slides then have no effect.
    #[serde(default)]
    real_slides: bool,
}

impl SimulatedLathe {
    /// Builds and wires the lathe to match the present parameters.
    pub fn new(config: LatheConfig, parameters: &ControlParameters) -> Self {
        let stations = config.turret.stations.unwrap_or(parameters.station_count());
        let contacts = if config.turret.coded {
            8 - stations.leading_zeros()
        } else {
            u32::from(stations)
        };
        let wiring = MachineWiring::new(parameters, contacts);
        let travel = config.chuck.travel_ms;
        Self {
            axes: PerAxis::new(
                AxisDrive::new(Axis::X, &config.x, parameters),
                AxisDrive::new(Axis::Z, &config.z, parameters),
            ),
            turret: TurretDrive::new(&config.turret, stations),
            spindle: SpindleDrive::new(&config.spindle, &wiring, parameters),
            chuck: Cylinder::new(travel),
            tailstock: Cylinder::new(travel),
            gears: Gearbox::new(travel),
            wiring,
            config,
            coolant: false,
            lubrication: false,
            enable: PerAxis::default(),
            emergency_button: false,
            overtravel_release: false,
            faults: ActiveFaults::default(),
            disturbance: Disturbance::default(),
            stuck_station: None,
            lost_index: 0,
            handwheel: 0,
            forced: [0; X_BYTES],
            forced_levels: [0; X_BYTES],
            real_slides: false,
        }
    }

    /// Sets whether a pulse board moves real slides. The simulated slides then no longer
    /// determine the switches.
    pub(crate) const fn set_real_slides(&mut self, real: bool) {
        self.real_slides = real;
        self.axes.x.real = real;
        self.axes.z.real = real;
    }

    /// Replaces the contacts in `inputs` that are wired to a pulse board by the board's.
    pub(crate) fn add_board_contacts(&self, inputs: &mut MachineInputs, board: &BoardContacts) {
        for (byte, (wired, closed)) in board.wired.iter().zip(board.closed).enumerate() {
            inputs.x[byte] = inputs.x[byte] & !wired | wired & closed;
        }
        let mut set = |pin: ContactPin, level: bool| {
            let mask = 1 << pin.1;
            let byte = &mut inputs.x[usize::from(pin.0)];
            *byte = if level { *byte | mask } else { *byte & !mask };
        };
        if board.emergency_stop_open {
            set(pins::EMERGENCY_STOP, false);
        }
        if let Some(closed) = self.wiring.door_level
            && board.door_open
        {
            set(pins::DOOR, !closed);
        }
        let wiring = &self.wiring;
        for (axis, pin) in [
            (Axis::X, pins::DECELERATION_X),
            (Axis::Z, pins::DECELERATION_Z),
        ] {
            let switch = *board.deceleration_switch.get(axis);
            if let Some(pressed) = switch {
                set(pin, pressed == wiring.deceleration_level);
            }
            let shared = switch.filter(|_| *wiring.one_switch.get(axis));
            *inputs.index_pulse.get_mut(axis) =
                board.zero_signal.get(axis).or(shared).unwrap_or(false);
            *inputs.index_latch.get_mut(axis) = None;
        }
    }

    /// Advances the lathe by one tick (1 ms) and writes its sensors into `inputs`.
    /// [`Self::read_contacts`] reads the contacts separately.
    pub fn tick(&mut self, outputs: &MachineOutputs, inputs: &mut MachineInputs) {
        let is_on = |pin: ContactPin| outputs.is_on(usize::from(pin.0), pin.1);
        self.axes.x.follow(outputs.pulses.x, outputs.enable.x);
        self.axes.z.follow(outputs.pulses.z, outputs.enable.z);
        self.enable = outputs.enable;
        self.turret
            .tick(is_on(pins::TURRET_FORWARD), is_on(pins::TURRET_REVERSE));
        let chuck_moves = !self.faults.has(LatheFault::ChuckStuck);
        self.chuck.tick(
            chuck_moves && is_on(pins::CHUCK_INWARD),
            chuck_moves && is_on(pins::CHUCK_OUTWARD),
        );
        self.tailstock
            .tick(is_on(pins::TAILSTOCK_OUT), is_on(pins::TAILSTOCK_BACK));
        self.coolant = is_on(pins::COOLANT);
        self.lubrication = is_on(pins::LUBRICATION);
        let step = (1u8..=4)
            .zip(pins::SPEEDS)
            .find(|(_, pin)| is_on(*pin))
            .map(|(step, _)| step);
        if self.wiring.gears {
            self.gears.tick(step);
        }
        self.spindle.tick(&SpindleOutputs {
            forward: is_on(pins::FORWARD),
            reverse: is_on(pins::REVERSE),
            brake: is_on(pins::BRAKE),
            volts: outputs.spindle_volts,
            step,
            gear: self.gears.gear(),
        });
        self.read_sensors(inputs);
        let noisy = self.faults.has(LatheFault::EncoderNoise);
        inputs.encoder += self.disturbance.noise(noisy);
    }

    /// Reads the contacts after a tick: in ticks before the control samples them, and in
    /// all ticks while contacts bounce.
    pub fn read_contacts(&mut self, inputs: &mut MachineInputs) {
        self.set_contacts(&mut inputs.x);
        let bouncing = self.has_bouncing_contacts();
        self.disturbance.bounce(&mut inputs.x, bouncing);
    }

    /// Whether contacts bounce, because of the fault [`LatheFault::InputBounce`].
    pub(crate) fn has_bouncing_contacts(&self) -> bool {
        self.faults.has(LatheFault::InputBounce)
    }

    /// The present state of all contacts and sensors.
    pub fn inputs(&self) -> MachineInputs {
        let mut inputs = MachineInputs::default();
        self.read_sensors(&mut inputs);
        self.set_contacts(&mut inputs.x);
        inputs
    }

    fn read_sensors(&self, inputs: &mut MachineInputs) {
        let (encoder, mut encoder_index, mut spindle_index) = self.spindle.encoder();
        if self.faults.has(LatheFault::SpindleIndexLost) {
            encoder_index = self.lost_index;
            spindle_index = false;
        }
        self.read_axis_sensors(Axis::X, inputs);
        self.read_axis_sensors(Axis::Z, inputs);
        inputs.encoder = encoder;
        inputs.encoder_index = encoder_index;
        inputs.spindle_index = spindle_index;
        inputs.handwheel = self.handwheel;
        if inputs.board.is_some() {
            inputs.board = None;
        }
    }

    #[inline(always)] // What differs between the axes is known then.
    fn read_axis_sensors(&self, axis: Axis, inputs: &mut MachineInputs) {
        let (pulse, latch) = self.zero_signal(axis);
        *inputs.index_pulse.get_mut(axis) = pulse;
        *inputs.index_latch.get_mut(axis) = latch;
        let failed = self.has_drive_failed(axis);
        *inputs.drive_alarm.get_mut(axis) = self.alarm_signal(axis, failed);
        *inputs.drive_ready.get_mut(axis) = self.ready_signal(axis, failed);
        *inputs.over_limit.get_mut(axis) = self.tripped_limit(axis);
    }

    /// Level of the zero signal of an axis, and the command count at its change in the last
    /// tick; `None` without a change.
    #[inline(always)]
    fn zero_signal(&self, axis: Axis) -> (bool, Option<Pulses>) {
        let lost_signal = match axis {
            Axis::X => LatheFault::IndexX,
            Axis::Z => LatheFault::IndexZ,
        };
        if *self.wiring.one_switch.get(axis) {
            (self.is_on_dog(axis), self.axes.get(axis).dog_latch())
        } else if self.faults.has(lost_signal) {
            (false, None)
        } else {
            self.axes.get(axis).index_signal()
        }
    }

    /// Whether the deceleration switch of a slide is pressed, or stuck by a fault.
    fn is_on_dog(&self, axis: Axis) -> bool {
        let stuck = match axis {
            Axis::X => LatheFault::DogX,
            Axis::Z => LatheFault::DogZ,
        };
        (!self.real_slides && self.axes.get(axis).is_on_dog()) || self.faults.has(stuck)
    }

    /// The limit switch of a slide that is pressed, or stuck by a fault; `None` if neither.
    fn tripped_limit(&self, axis: Axis) -> Option<TrippedLimit> {
        if self.real_slides {
            return None;
        }
        let stuck = match axis {
            Axis::X => LatheFault::LimitX,
            Axis::Z => LatheFault::LimitZ,
        };
        let stuck = || self.faults.has(stuck).then_some(TrippedLimit::Stuck);
        self.axes.get(axis).pressed_limit().or_else(stuck)
    }

    /// Whether a drive reports an alarm or has switched off.
    fn has_drive_failed(&self, axis: Axis) -> bool {
        let fault = match axis {
            Axis::X => LatheFault::DriveX,
            Axis::Z => LatheFault::DriveZ,
        };
        self.faults.has(fault) || self.axes.get(axis).is_tripped()
    }

    /// Level of a drive's alarm line: true = high. A line that is not wired keeps the level
    /// without an alarm.
    fn alarm_signal(&self, axis: Axis, failed: bool) -> bool {
        let wired = match axis {
            Axis::X => self.config.x.alarm_line,
            Axis::Z => self.config.z.alarm_line,
        };
        (wired && failed) == *self.wiring.drive_alarm_level.get(axis)
    }

    /// Level of a drive's ready line: true = high. The drive is ready when enabled and not
    /// failed.
    fn ready_signal(&self, axis: Axis, failed: bool) -> bool {
        let ready = *self.enable.get(axis) && !failed;
        ready == self.wiring.drive_ready_level
    }

    /// Mask of the active station switches: T01 in bit 0, up to T08 in bit 7.
    fn station_switches(&self) -> u8 {
        if self.faults.has(LatheFault::TurretContactsOpen) {
            return 0;
        }
        let coded = self.config.turret.coded;
        let active_switches = |station: Option<u8>| match station {
            Some(station) if coded => station,
            Some(station @ 1..=8) => 1 << (station - 1),
            _ => 0,
        };
        active_switches(self.turret.station()) | active_switches(self.stuck_station)
    }

    fn set_contacts(&self, x: &mut [u8; X_BYTES]) {
        let wiring = &self.wiring;
        // X0 in the low byte, X1 in the high one; no other contacts are wired. All are open
        // at first.
        let mut closed = 0u16;
        let mut set =
            |pin: ContactPin, level: bool| closed |= u16::from(level) << (pin.0 * 8 + pin.1);
        let switches = self.station_switches();
        let station_contact_level =
            |number: u8| (switches >> (number - 1) & 1 == 1) == wiring.station_level;
        // T01–T04 do not share their pins.
        for (number, pin) in (1u8..=4).zip(pins::STATIONS) {
            set(pin, station_contact_level(number));
        }
        let shared = |pin: SharedPin, number: u8, gear_or_chuck: bool| match pin {
            SharedPin::Station => station_contact_level(number),
            SharedPin::Gear => gear_or_chuck == wiring.gear_level,
            SharedPin::Chuck => gear_or_chuck,
            SharedPin::Enable => !wiring.gear_level,
            SharedPin::Closed => true,
            SharedPin::Open => false,
        };
        let in_position = |pin, gear, chuck| match pin {
            SharedPin::Chuck => chuck,
            _ => self.gears.is_in_position(gear) && !self.faults.has(LatheFault::GearStuck),
        };
        let (first, second) = (self.chuck.is_at_first_end(), self.chuck.is_at_second_end());
        set(pins::STATIONS[4], shared(wiring.x0_4, 5, false));
        set(pins::STATIONS[5], shared(wiring.x1_0, 6, false));
        set(
            pins::STATIONS[6],
            shared(wiring.x1_1, 7, in_position(wiring.x1_1, 1, second)),
        );
        set(
            pins::STATIONS[7],
            shared(wiring.x1_2, 8, in_position(wiring.x1_2, 2, first)),
        );
        set(
            pins::DECELERATION_X,
            self.is_on_dog(Axis::X) == wiring.deceleration_level,
        );
        set(
            pins::DECELERATION_Z,
            self.is_on_dog(Axis::Z) == wiring.deceleration_level,
        );
        set(pins::EMERGENCY_STOP, self.is_emergency_loop_closed());
        set(
            pins::TOOL_CLAMPED,
            match wiring.pressure_level {
                Some(good) => self.faults.has(LatheFault::PressureLow) != good,
                None => {
                    let unclamped = self.faults.has(LatheFault::TurretUnclamped);
                    (self.turret.is_clamped() && !unclamped) == wiring.tool_clamped_level
                }
            },
        );
        set(
            pins::DOOR,
            wiring
                .door_level
                .is_some_and(|closed| self.faults.has(LatheFault::DoorOpen) != closed),
        );
        *x = [0; X_BYTES];
        [x[0], x[1]] = closed.to_le_bytes();
        if self.forced != [0; X_BYTES] {
            for (byte, (mask, value)) in x
                .iter_mut()
                .zip(self.forced.iter().zip(&self.forced_levels))
            {
                *byte = (*byte & !mask) | (value & mask);
            }
        }
    }

    /// Whether the loop of the emergency button and the limit switches is closed. The
    /// release button bridges the limit switches.
    pub fn is_emergency_loop_closed(&self) -> bool {
        !self.emergency_button
            && !self.faults.has(LatheFault::EmergencyStop)
            && (self.overtravel_release || !self.is_over_limit())
    }

    /// Whether a limit switch of any axis is tripped.
    pub fn is_over_limit(&self) -> bool {
        let tripped = self.axes.x.pressed_limit().or(self.axes.z.pressed_limit());
        (tripped.is_some() && !self.real_slides)
            || self.faults.has(LatheFault::LimitX)
            || self.faults.has(LatheFault::LimitZ)
    }

    /// Forces a machine input to a level; `None` releases it to its sensor. Addresses other
    /// than X0.0–X29.7 are ignored.
    pub fn force_input(&mut self, address: BitAddress, state: Option<bool>) {
        let byte = usize::from(address.byte);
        if address.area != Area::X || byte >= X_BYTES || address.bit > 7 {
            return;
        }
        let mask = 1 << address.bit;
        self.forced[byte] &= !mask;
        self.forced_levels[byte] &= !mask;
        if let Some(level) = state {
            self.forced[byte] |= mask;
            self.forced_levels[byte] |= u8::from(level) << address.bit;
        }
    }

    /// Sets (`on`) or clears a fault of the lathe.
    pub fn set_fault(&mut self, fault: LatheFault, on: bool) {
        if self.faults.has(fault) == on {
            return;
        }
        self.faults.set(fault, on);
        match fault {
            LatheFault::TurretBlocked => self.turret.blocked = on,
            LatheFault::TurretContactStuck => {
                self.stuck_station = self.turret.station().filter(|_| on);
            }
            LatheFault::SpindleBlocked => self.spindle.blocked = on,
            LatheFault::EncoderLost => self.spindle.encoder_lost = on,
            LatheFault::SlideX => self.axes.x.blocked = on,
            LatheFault::SlideZ => self.axes.z.blocked = on,
            LatheFault::SpindleIndexLost => self.lost_index = self.spindle.encoder().1,
            _ => {}
        }
    }

    /// Whether this fault of the lathe is active.
    pub const fn has_fault(&self, fault: LatheFault) -> bool {
        self.faults.has(fault)
    }

    /// The level that a machine input is forced to; `None` if it is not forced.
    pub fn forced_input(&self, address: BitAddress) -> Option<bool> {
        let byte = usize::from(address.byte);
        let bit = |bytes: &[u8]| {
            bytes
                .get(byte)
                .is_some_and(|byte| byte >> (address.bit & 7) & 1 == 1)
        };
        let held = address.area == Area::X && bit(&self.forced);
        held.then(|| bit(&self.forced_levels))
    }

    /// Returns the number of forced machine inputs.
    pub fn forced_input_count(&self) -> usize {
        let bits = self.forced.iter().map(|byte| byte.count_ones() as usize);
        bits.sum()
    }

    /// Returns the number of active faults.
    pub const fn fault_count(&self) -> usize {
        self.faults.count()
    }

    /// Clears all faults and releases all forced inputs.
    pub fn clear_faults(&mut self) {
        for (_, fault) in LatheFault::ALL {
            self.set_fault(fault, false);
        }
        self.forced = [0; X_BYTES];
        self.forced_levels = [0; X_BYTES];
    }

    /// Presses or releases the emergency button; the panel keeps a pressed button in.
    pub const fn set_emergency_button(&mut self, pressed: bool) {
        self.emergency_button = pressed;
    }

    /// Presses (true) or releases the overtravel release button.
    pub const fn set_overtravel_release(&mut self, held: bool) {
        self.overtravel_release = held;
    }

    /// Turns the handwheel by a number of detents, clockwise positive.
    pub const fn turn_handwheel(&mut self, detents: i32) {
        self.handwheel = self.handwheel.wrapping_add(detents);
    }

    /// Wires the spindle as inverter or switched speeds, with or without gears, by the
    /// present parameters (001.4, 005.5, 164.7, 164.6). A technician does this while the
    /// power is off.
    pub fn rewire_spindle(&mut self, parameters: &ControlParameters) {
        self.wiring.rewire_spindle(parameters);
        self.spindle.set_wiring(&self.wiring);
    }

    /// Assigns the control's pulse count to the present position of the slides.
    pub fn set_count(&mut self, pulses: PerAxis<Pulses>) {
        self.axes.x.set_count(pulses.x);
        self.axes.z.set_count(pulses.z);
    }

    /// Places the slides at another position, mm from the reference point (X in radius).
    pub fn move_slides(&mut self, position: Point) {
        self.axes.x.set_position(position.x);
        self.axes.z.set_position(position.z);
    }

    /// Lets the spindle turn (r/min, negative in reverse) until M03 or M04 takes over.
    pub const fn turn_spindle(&mut self, rpm: f64) {
        self.spindle.start_coasting(rpm);
    }

    /// The description from which the lathe was built.
    pub const fn config(&self) -> &LatheConfig {
        &self.config
    }

    /// Position of the slides, mm from the reference point (X in radius).
    pub fn slide_position(&self) -> Point {
        Point::new(self.axes.x.position(), self.axes.z.position())
    }

    /// Following error of both motors, mm (X in radius).
    pub fn following_error(&self) -> Point {
        Point::new(self.axes.x.following_error(), self.axes.z.following_error())
    }

    /// Returns the spindle speed, r/min; negative in reverse.
    pub const fn spindle_rpm(&self) -> f64 {
        self.spindle.rpm()
    }

    /// Returns the spindle angle, degrees from its start position, 0 to 360.
    pub fn spindle_degrees(&self) -> f64 {
        let turns = self.spindle.turns();
        (turns - turns.floor()) * 360.0
    }

    /// Revolutions of the spindle since the start; in reverse they decrease.
    pub const fn spindle_turns(&self) -> f64 {
        self.spindle.turns()
    }

    /// Detents by which the handwheel has turned since the start, clockwise positive.
    pub const fn handwheel_detents(&self) -> i32 {
        self.handwheel
    }

    /// The station in position, from 1; `None` between stations or without tool post.
    pub fn station(&self) -> Option<u8> {
        self.turret.station()
    }

    /// Whether the tool post is clamped.
    pub const fn is_tool_post_clamped(&self) -> bool {
        self.turret.is_clamped()
    }

    /// Whether the chuck clamps the part.
    pub const fn is_chuck_clamped(&self) -> bool {
        if self.wiring.outer_chuck {
            self.chuck.is_at_second_end()
        } else {
            self.chuck.is_at_first_end()
        }
    }

    /// Whether the tailstock quill is extended.
    pub const fn is_tailstock_forward(&self) -> bool {
        self.tailstock.is_at_first_end()
    }

    /// The gear that is engaged or being engaged, 1–4.
    pub const fn gear(&self) -> u8 {
        self.gears.gear()
    }

    /// Whether coolant flows.
    pub const fn is_coolant_on(&self) -> bool {
        self.coolant
    }

    /// Whether the lubrication pump runs.
    pub const fn is_lubrication_on(&self) -> bool {
        self.lubrication
    }
}
