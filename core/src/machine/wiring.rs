//! The contacts as the machine builder has wired them, by the parameters at that time. A
//! parameter changed later does not rewire the machine.

use serde::{Deserialize, Serialize};

use crate::memory::Parameters;
use crate::units::{Axis, PerAxis};

/// The signal on a pin that chuck, gears, stations and enable switches share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum SharedPin {
    /// A station switch of the tool post.
    Station,
    /// The gear's in-position switch.
    Gear,
    /// The chuck's in-position switch.
    Chuck,
    /// An enable contact, which is always active.
    Enable,
    /// A feed override switch that is closed (the nibble of 100 %).
    Closed,
    /// No signal.
    Open,
}

/// The first signal that claims a pin.
fn first<const N: usize>(claims: [(bool, SharedPin); N]) -> SharedPin {
    claims
        .into_iter()
        .find(|(claimed, _)| *claimed)
        .map_or(SharedPin::Open, |(_, pin)| pin)
}

/// Polarities of the contacts and signals of the shared pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Wiring {
    /// Contact level of a pressed deceleration switch (004.5 DECI).
    #[serde(rename = "on_dog")]
    pub on_dog: bool,
    /// One switch for deceleration and zero (007.0, 007.1 ZC).
    pub one_switch: PerAxis<bool>,
    /// Contact level of a station in place (011.1 TSGN = 0: closed).
    #[serde(rename = "in_station")]
    pub in_station: bool,
    /// Contact level of the clamped tool post (011.0 TCPS = 1: closed).
    #[serde(rename = "tool_clamped")]
    pub tool_clamped: bool,
    /// Level of the pressure switch on X0.7 at good pressure; `None`: X0.7 carries *TCP
    /// (168.4 PB3).
    #[serde(rename = "pressure")]
    pub pressure: Option<bool>,
    /// Level of the door switch on X1.5 with a closed door; `None`: no door switch (168.6
    /// PB4).
    #[serde(rename = "door")]
    pub door: Option<bool>,
    /// Contact level of a gear in position; an active enable has the other one (164.5 AGIM).
    #[serde(rename = "gear_in")]
    pub gear_in: bool,
    /// Signals on X0.4, X1.0, X1.1 and X1.2.
    pub x0_4: SharedPin,
    pub x1_0: SharedPin,
    pub x1_1: SharedPin,
    pub x1_2: SharedPin,
    /// Signal level of a ready drive (005.2 DRDY) and of a drive with an alarm (009 ALM).
    #[serde(rename = "drive_ready")]
    pub drive_ready: bool,
    #[serde(rename = "drive_alarm")]
    pub drive_alarm: PerAxis<bool>,
    /// Number of station contacts of the tool post.
    contacts: u32,
    /// Whether the spindle is analog (001.4), and has gears M41–M44 (164.7 AGER).
    pub analog: bool,
    pub gears: bool,
    /// Whether DOQPS clamps the chuck instead of DOQPJ (168.0 PB1).
    pub outer_chuck: bool,
}

impl Wiring {
    /// Wires a machine by the parameters; `contacts` is the number of station switches.
    pub fn new(parameters: &Parameters, contacts: u32) -> Self {
        // Feed override switches (172.0 SOVI), station switches T05–T08, chuck
        // (168.2 PB2), gears (164.7 AGER, 164.6 AGIN), enables (SPEN, STEN).
        let switches = parameters.has_override_switches();
        let many = contacts >= 5;
        let chuck = parameters.watches_chuck();
        let gears = parameters.automatic_gears();
        let gear_switches = gears && parameters.watches_gear();
        Self {
            on_dog: parameters.closed_means_deceleration(),
            one_switch: PerAxis::new(
                parameters.one_zero_switch(Axis::X),
                parameters.one_zero_switch(Axis::Z),
            ),
            in_station: parameters.station_level(),
            tool_clamped: parameters.tool_clamped_level(),
            pressure: parameters.pressure_level(),
            door: parameters.door_level(),
            gear_in: parameters.gear_in_level(),
            x0_4: first([
                (switches, SharedPin::Closed),
                (parameters.spindle_is_enabled_outside(), SharedPin::Enable),
                (many, SharedPin::Station),
            ]),
            x1_0: first([(switches, SharedPin::Open), (many, SharedPin::Station)]),
            x1_1: first([
                (switches, SharedPin::Closed),
                (chuck, SharedPin::Chuck),
                (gear_switches, SharedPin::Gear),
                (many, SharedPin::Station),
            ]),
            x1_2: first([
                (switches, SharedPin::Open),
                (chuck, SharedPin::Chuck),
                (gear_switches, SharedPin::Gear),
                (parameters.start_is_enabled_outside(), SharedPin::Enable),
                (many, SharedPin::Station),
            ]),
            drive_ready: parameters.drive_ready_level(),
            drive_alarm: PerAxis::new(
                parameters.drive_alarm_level(Axis::X),
                parameters.drive_alarm_level(Axis::Z),
            ),
            contacts,
            analog: parameters.analog_spindle(),
            gears,
            outer_chuck: parameters.outer_chuck(),
        }
    }

    /// Rewires the drive of the spindle, and with it the switches of the gears.
    pub fn fit_spindle(&mut self, parameters: &Parameters) {
        let new = Self::new(parameters, self.contacts);
        self.analog = new.analog;
        self.gears = new.gears;
        (self.x1_1, self.x1_2) = (new.x1_1, new.x1_2);
    }
}
