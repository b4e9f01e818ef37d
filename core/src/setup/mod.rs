//! The initial state of a control and its simulated lathe.

mod ladder;

use gsk_plc::RetainedMemory;
use gsk_plc::address::BitAddress;

pub use ladder::{MachineLadder, STANDARD_LADDER, dnc_teach_ladder, standard_ladder};

use crate::alarm::Alarm;
use crate::battery::BatteryMemory;
use crate::machine::{LatheConfig, SlideEnds};
use crate::memory::{ControlParameters, DayTime};
use crate::units::{Axis, PerAxis, Point};

/// Byte of the K area (K12) in which the ladder stores the number of the tool in position.
pub(crate) const TOOL_IN_POSITION: u16 = 12;

/// The initial state of a control and its simulated lathe.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Battery-backed memory: parameters, offsets, programs and other data.
    pub memory: BatteryMemory,
    /// The PLC ladder of the machine.
    pub ladder: MachineLadder,
    /// Retained memory of the PLC; `None` for the initial values of the ladder.
    pub plc_retained: Option<RetainedMemory>,
    /// Configuration of the simulated lathe.
    pub lathe: LatheConfig,
    /// The parameters for whose contact levels the lathe was wired; `None` for those in
    /// `memory`.
    pub wired: Option<ControlParameters>,
    /// Machine position of the tool (X as a radius), mm; `None` if unset. Without `absolute`,
    /// the work zero is the machine zero.
    pub start: Option<Point>,
    /// True position of the slides from the reference point (X as a radius), mm, which the
    /// control does not know before the reference return; `None` for the position `start`.
    pub slides: Option<Point>,
    /// Absolute coordinates at power-off (X as a radius), mm. The control keeps them with
    /// 004.7 ABOT = 0; a preview always uses them: `start - absolute` is the work zero.
    pub absolute: Option<Point>,
    /// Alarms raised at power-on by errors in the stored data.
    pub alarms: Vec<Alarm>,
    /// Whether both axes are already referenced at power-on.
    pub referenced: bool,
    /// Whether the machine zero of an axis was set by hand and is kept over power-off (method
    /// A).
    pub zero_kept: PerAxis<bool>,
    /// Speed of a spindle that already turns forward, r/min; `None` if it is stopped.
    pub spindle_rpm: Option<f64>,
    /// Local date and time of day at power-on.
    pub day_time: DayTime,
    /// Inputs of the machine that are forced, each with its level (`true` = 1).
    pub forced_inputs: Vec<(BitAddress, bool)>,
}

impl Setup {
    /// The number of the tool in position at power-on: parameter 075, or K12 of the ladder if
    /// 075 is 0.
    pub fn tool_in_position(&self) -> u8 {
        match self.memory.parameters.tool_in_position() {
            0 => {}
            tool => return tool,
        }
        match &self.plc_retained {
            Some(retained) => retained
                .k
                .get(usize::from(TOOL_IN_POSITION))
                .copied()
                .unwrap_or(0),
            None => self.ladder.initial_k(TOOL_IN_POSITION),
        }
    }

    /// Whether an axis is referenced at power-on: both are, or its zero is kept, which needs
    /// 014 ZRS = 0 (no zero switch).
    pub(crate) fn is_referenced(&self, axis: Axis) -> bool {
        let kept = *self.zero_kept.get(axis) && !self.memory.parameters.has_zero_switch(axis);
        self.referenced || kept
    }

    /// The training lathe as delivered, not referenced: factory parameters except for an
    /// analog spindle, with dogs and limit switches.
    pub fn delivered() -> Self {
        Self {
            lathe: LatheConfig::default(),
            start: None,
            referenced: false,
            ..Self::default()
        }
    }

    /// The initial state for an operator script without a machine file: that of a dry run, but
    /// the slides have switches and ends, since scripts jog them.
    pub fn for_operator_script() -> Self {
        Self {
            lathe: LatheConfig::with_long_slides(),
            ..Self::default()
        }
    }

    /// Returns the setup with a power chuck: M12 and M13 act (164.0 SLQP = 1), and the spindle
    /// also starts without clamping (164.1 SLSP = 1).
    #[must_use]
    pub fn with_chuck(mut self) -> Self {
        self.memory.parameters.fit_chuck();
        self
    }

    /// The axes whose start position is beyond the ends of their slides, each with those ends
    /// (X as a diameter, mm).
    pub fn axes_beyond_ends(&self) -> Vec<(Axis, SlideEnds)> {
        let Some(start) = self.start else {
            return Vec::new();
        };
        let (x, z) = (start.diameter().0, start.z);
        [(Axis::X, &self.lathe.x, x), (Axis::Z, &self.lathe.z, z)]
            .map(|(axis, config, at)| (axis, config.slide_ends(axis), at))
            .into_iter()
            .filter(|(_, ends, at)| !(ends.minus..=ends.plus).contains(at))
            .map(|(axis, ends, _)| (axis, ends))
            .collect()
    }
}

impl Default for Setup {
    /// The initial state for a dry run: factory parameters with an analog spindle, both axes
    /// referenced, the tool at X300 Z300, no dogs and no limit switches.
    fn default() -> Self {
        let mut parameters = ControlParameters::default();
        parameters.fit_analog_spindle();
        Self {
            memory: BatteryMemory {
                parameters,
                ..BatteryMemory::default()
            },
            ladder: MachineLadder::default(),
            plc_retained: None,
            lathe: LatheConfig::without_limits(),
            wired: None,
            start: Some(Point::new(150.0, 300.0)),
            slides: None,
            absolute: None,
            alarms: Vec::new(),
            referenced: true,
            zero_kept: PerAxis::default(),
            spindle_rpm: None,
            day_time: DayTime::default(),
            forced_inputs: Vec::new(),
        }
    }
}
