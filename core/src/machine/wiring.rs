//! The contacts as the machine builder has wired them, by the parameters at that time. A
//! parameter changed later does not rewire the machine.

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::units::{Axis, PerAxis};

/// The signal on a pin that several switches can use: chuck, gears, stations, enables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum SharedPin {
    /// The switch of a station of the tool post.
    Station,
    /// The pin has the in-position switch of a gear.
    Gear,
    /// The pin has the in-position switch of the chuck.
    Chuck,
    /// The pin has an enable contact, which is always active.
    Enable,
    /// A feed override switch that is closed (the nibble of 100 %).
    Closed,
    /// The pin has no signal: the contact is open.
    Open,
}

/// The signal of the first true claim to a pin; `Open` if none is true.
fn first_claim<const N: usize>(claims: [(bool, SharedPin); N]) -> SharedPin {
    claims
        .into_iter()
        .find(|(claimed, _)| *claimed)
        .map_or(SharedPin::Open, |(_, pin)| pin)
}

/// Contact levels (true = closed) and shared pins, as the machine is wired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct MachineWiring {
    /// Level of the contact of a pressed deceleration switch (004.5 DECI).
    #[serde(rename = "on_dog")]
    pub deceleration_level: bool,
    /// Whether each axis has one switch for deceleration and zero (007.0, 007.1 ZC).
    pub one_switch: PerAxis<bool>,
    /// Level of the contact of a tool-post station in position (011.1 TSGN = 0: closed).
    #[serde(rename = "in_station")]
    pub station_level: bool,
    /// Contact level of the clamped tool post (011.0 TCPS = 1: closed).
    #[serde(rename = "tool_clamped")]
    pub tool_clamped_level: bool,
    /// Level of the pressure switch on X0.7 at good pressure; `None`: X0.7 carries *TCP
    /// (168.4 PB3).
    #[serde(rename = "pressure")]
    pub pressure_level: Option<bool>,
    /// Level of the door switch on X1.5 with a closed door; `None`: no door switch (168.6
    /// PB4).
    #[serde(rename = "door")]
    pub door_level: Option<bool>,
    /// Contact level of a gear in position, opposite to that of an active enable (164.5
    /// AGIM).
    #[serde(rename = "gear_in")]
    pub gear_level: bool,
    /// Signal on the pin X0.4.
    pub x0_4: SharedPin,
    pub x1_0: SharedPin,
    pub x1_1: SharedPin,
    pub x1_2: SharedPin,
    /// Level of the ready line of a ready drive (005.2 DRDY), and of the alarm line of a
    /// drive with an alarm (009 ALM).
    #[serde(rename = "drive_ready")]
    pub drive_ready_level: bool,
    #[serde(rename = "drive_alarm")]
    pub drive_alarm_level: PerAxis<bool>,
    /// Number of station contacts of the tool post.
    contacts: u32,
    /// Whether the spindle is analog (001.4), and whether it has gears M41–M44 (164.7
    /// AGER).
    pub analog: bool,
    pub gears: bool,
    /// Whether DOQPS clamps the chuck instead of DOQPJ (168.0 PB1).
    pub outer_chuck: bool,
}

impl MachineWiring {
    /// Wires a machine to match the parameters; `contacts` is the number of station
    /// switches.
    pub fn new(parameters: &ControlParameters, contacts: u32) -> Self {
        // Feed override switches (172.0 SOVI), station switches T05–T08, chuck
        // (168.2 PB2), gears (164.7 AGER, 164.6 AGIN), enables (SPEN, STEN).
        let switches = parameters.has_override_switches();
        let has_many_stations = contacts >= 5;
        let chuck = parameters.watches_chuck();
        let gears = parameters.has_automatic_gears();
        let gear_switches = gears && parameters.watches_gear();
        Self {
            deceleration_level: parameters.is_deceleration_closed(),
            one_switch: PerAxis::new(
                parameters.has_one_zero_switch(Axis::X),
                parameters.has_one_zero_switch(Axis::Z),
            ),
            station_level: parameters.station_level(),
            tool_clamped_level: parameters.tool_clamped_level(),
            pressure_level: parameters.pressure_level(),
            door_level: parameters.door_level(),
            gear_level: parameters.gear_in_level(),
            x0_4: first_claim([
                (switches, SharedPin::Closed),
                (parameters.has_spindle_enable_input(), SharedPin::Enable),
                (has_many_stations, SharedPin::Station),
            ]),
            x1_0: first_claim([
                (switches, SharedPin::Open),
                (has_many_stations, SharedPin::Station),
            ]),
            x1_1: first_claim([
                (switches, SharedPin::Closed),
                (chuck, SharedPin::Chuck),
                (gear_switches, SharedPin::Gear),
                (has_many_stations, SharedPin::Station),
            ]),
            x1_2: first_claim([
                (switches, SharedPin::Open),
                (chuck, SharedPin::Chuck),
                (gear_switches, SharedPin::Gear),
                (parameters.has_start_enable_input(), SharedPin::Enable),
                (has_many_stations, SharedPin::Station),
            ]),
            drive_ready_level: parameters.drive_ready_level(),
            drive_alarm_level: PerAxis::new(
                parameters.drive_alarm_level(Axis::X),
                parameters.drive_alarm_level(Axis::Z),
            ),
            contacts,
            analog: parameters.has_analog_spindle(),
            gears,
            outer_chuck: parameters.is_outer_chuck(),
        }
    }

    /// Rewires the drive of the spindle to match the parameters, and with it the switches
    /// of the gears.
    pub fn rewire_spindle(&mut self, parameters: &ControlParameters) {
        let new = Self::new(parameters, self.contacts);
        self.analog = new.analog;
        self.gears = new.gears;
        (self.x1_1, self.x1_2) = (new.x1_1, new.x1_2);
    }
}
