//! What a control starts from.

use std::sync::{Arc, LazyLock};

use gsk_plc::address::BitAddress;
use gsk_plc::{Ladder, Plc, Retained};

use crate::alarm::Alarm;
use crate::machine::LatheConfig;
use crate::memory::{
    Authority, Counters, Disks, Offsets, Parameters, PitchTable, Settings, Variables,
};
use crate::program::ProgramMemory;
use crate::units::{Axis, PerAxis, Point};

/// K12: the tool in position, kept by the ladder.
pub(crate) const TOOL_IN_POSITION: u16 = 12;
/// 075: the same, kept by the control; 0: nothing known.
pub(crate) const TOOL_PARAMETER: u16 = 75;

/// The standard ladder, as instruction list.
pub const STANDARD_LADDER: &str = include_str!("../../assets/ladder/standard.il");

/// Everything a control and its simulated lathe start from.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Parameters.
    pub parameters: Parameters,
    /// Tool offsets.
    pub offsets: Offsets,
    /// Pitch error table.
    pub pitch: PitchTable,
    /// Macro variables.
    pub variables: Variables,
    /// The rows of the setting page, 英制编程 among them.
    pub settings: Settings,
    /// Operation level and passwords.
    pub authority: Authority,
    /// The electronic disks.
    pub disks: Disks,
    /// Program memory.
    pub programs: ProgramMemory,
    /// Part counter and cutting time.
    pub counters: Counters,
    /// The machine's ladder.
    pub ladder: Arc<Ladder>,
    /// What the PLC kept over power-off; `None`: its initial values.
    pub plc_retained: Option<Retained>,
    /// The simulated lathe.
    pub lathe: LatheConfig,
    /// The parameters it was wired for; `None`: those found now.
    pub wired: Option<Parameters>,
    /// The tool's machine position; the work zero is the machine zero.
    pub start: Option<Point>,
    /// The absolute coordinates at power-off; with 004.7 ABOT = 0 they stay.
    pub absolute: Option<Point>,
    /// What was found wrong with the memory: alarms of the power-on.
    pub alarms: Vec<Alarm>,
    /// Whether both axes already have their reference.
    pub referenced: bool,
    /// Axes whose machine zero was set by hand and is kept (method A).
    pub zero_kept: PerAxis<bool>,
    /// Speed of a spindle that already turns forward, r/min.
    pub spindle_rpm: Option<f64>,
    /// Machine inputs held at a value.
    pub forced_inputs: Vec<(BitAddress, bool)>,
}

/// The standard ladder, compiled once.
pub fn standard_ladder() -> Arc<Ladder> {
    static LADDER: LazyLock<Arc<Ladder>> =
        LazyLock::new(|| match Ladder::compile(STANDARD_LADDER) {
            Ok(ladder) => Arc::new(ladder),
            Err(errors) => unreachable!("the standard ladder is part of the program: {errors}"),
        });
    Arc::clone(&LADDER)
}

impl Setup {
    /// The tool in position at power-on: 075, or what the ladder kept in K12.
    pub fn tool_in_position(&self) -> u8 {
        match u8::try_from(self.parameters.value(TOOL_PARAMETER)) {
            Ok(tool) if tool > 0 => return tool,
            _ => {}
        }
        match &self.plc_retained {
            Some(retained) => retained
                .k
                .get(usize::from(TOOL_IN_POSITION))
                .copied()
                .unwrap_or(0),
            None => Plc::new(Arc::clone(&self.ladder))
                .memory()
                .k(TOOL_IN_POSITION),
        }
    }

    /// Whether an axis has its reference at power-on: a zero that no switch tells
    /// (014 ZRS = 0) is kept.
    pub(crate) fn is_referenced(&self, axis: Axis) -> bool {
        let kept = *self.zero_kept.get(axis) && !self.parameters.has_zero_switch(axis);
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
}

impl Default for Setup {
    /// What a dry run starts from: factory parameters with an analog spindle, both
    /// axes referenced, the tool at X300 Z300, no dogs and no hard limits.
    fn default() -> Self {
        let mut parameters = Parameters::default();
        let analog = parameters.set_bit(1, 4, true);
        debug_assert!(analog.is_ok(), "001.4 exists");
        Self {
            parameters,
            offsets: Offsets::default(),
            pitch: PitchTable::default(),
            variables: Variables::default(),
            settings: Settings::default(),
            authority: Authority::default(),
            disks: Disks::default(),
            programs: ProgramMemory::default(),
            counters: Counters::default(),
            ladder: standard_ladder(),
            plc_retained: None,
            lathe: LatheConfig::free(),
            wired: None,
            start: Some(Point::new(150.0, 300.0)),
            absolute: None,
            alarms: Vec::new(),
            referenced: true,
            zero_kept: PerAxis::default(),
            spindle_rpm: None,
            forced_inputs: Vec::new(),
        }
    }
}
