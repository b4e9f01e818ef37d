//! What a control starts from.

mod ladder;

use gsk_plc::RetainedMemory;
use gsk_plc::address::BitAddress;

pub use ladder::{MachineLadder, STANDARD_LADDER, dnc_teach_ladder, standard_ladder};

use crate::alarm::Alarm;
use crate::battery::Memory;
use crate::machine::{LatheConfig, SlideEnds};
use crate::memory::{DayTime, Parameters};
use crate::units::{Axis, PerAxis, Point};

/// K12: the tool in position, kept by the ladder.
pub(crate) const TOOL_IN_POSITION: u16 = 12;

/// Everything a control and its simulated lathe start from.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What the battery keeps.
    pub memory: Memory,
    /// The machine's ladder.
    pub ladder: MachineLadder,
    /// What the PLC kept over power-off; `None`: its initial values.
    pub plc_retained: Option<RetainedMemory>,
    /// The simulated lathe.
    pub lathe: LatheConfig,
    /// The parameters it was wired for; `None`: those found now.
    pub wired: Option<Parameters>,
    /// The tool's machine position; without `absolute` the work zero is the machine zero.
    pub start: Option<Point>,
    /// Where the slides really stand, mm from the reference point (X in radius), where
    /// that is not `start`: before the zero return the control does not know it.
    pub slides: Option<Point>,
    /// The absolute coordinates at power-off; with 004.7 ABOT = 0 they stay. A preview
    /// takes them as they are: `start - absolute` is the work zero.
    pub absolute: Option<Point>,
    /// What was found wrong with the memory: alarms of the power-on.
    pub alarms: Vec<Alarm>,
    /// Whether both axes already have their reference.
    pub referenced: bool,
    /// Axes whose machine zero was set by hand and is kept (method A).
    pub zero_kept: PerAxis<bool>,
    /// Speed of a spindle that already turns forward, r/min.
    pub spindle_rpm: Option<f64>,
    /// Date and time of day, from which the control counts on by its ticks.
    pub day_time: DayTime,
    /// Machine inputs held at a value.
    pub forced_inputs: Vec<(BitAddress, bool)>,
}

impl Setup {
    /// The tool in position at power-on: 075, or what the ladder kept in K12.
    pub(crate) fn tool_in_position(&self) -> u8 {
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
            None => self.ladder.start_value_of_k(TOOL_IN_POSITION),
        }
    }

    /// Whether an axis has its reference at power-on: a zero that no switch tells
    /// (014 ZRS = 0) is kept.
    pub(crate) fn is_referenced(&self, axis: Axis) -> bool {
        let kept = *self.zero_kept.get(axis) && !self.memory.parameters.has_zero_switch(axis);
        self.referenced || kept
    }

    /// The training lathe as it is delivered: factory parameters but for the analog
    /// spindle it has, dogs and limit switches, no reference yet.
    pub fn delivered() -> Self {
        Self {
            lathe: LatheConfig::default(),
            start: None,
            referenced: false,
            ..Self::default()
        }
    }

    /// What an operator script that names no machine starts from: a dry run's, but for
    /// the lathe. Its slides have switches and ends, since scripts move them by hand.
    pub fn at_the_panel() -> Self {
        Self {
            lathe: LatheConfig::roomy(),
            ..Self::default()
        }
    }

    /// The same with the power chuck of the training lathe in use: M12 and M13 act
    /// (164.0 SLQP = 1), and the spindle starts without it, too (164.1 SLSP = 1).
    #[must_use]
    pub fn with_chuck(mut self) -> Self {
        self.memory.parameters.fit_chuck();
        self
    }

    /// The axes that stand beyond the ends of their slides.
    pub fn beyond_ends(&self) -> Vec<(Axis, SlideEnds)> {
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
    /// What a dry run starts from: factory parameters with an analog spindle, both
    /// axes referenced, the tool at X300 Z300, no dogs and no limit switches.
    fn default() -> Self {
        let mut parameters = Parameters::default();
        parameters.fit_analog_spindle();
        Self {
            memory: Memory {
                parameters,
                ..Memory::default()
            },
            ladder: MachineLadder::default(),
            plc_retained: None,
            lathe: LatheConfig::free(),
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
