//! Stores the modal codes and words.

use gsk_core::compensation::cutter::CutterSide;

use crate::space::Plane;

/// The modal kind of motion (G codes of group 01).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillMotion {
    /// Rapid traverse is in force (G00).
    Rapid,
    /// Straight cuts are in force (G01).
    Line,
    /// Arcs are in force (G02, G03).
    Arc {
        /// Whether the arc is clockwise (G02).
        clockwise: bool,
    },
    /// Thread cutting is in force (G33).
    Thread,
}

impl MillMotion {
    /// Returns the number of the motion's G code.
    pub const fn code(self) -> u8 {
        match self {
            Self::Rapid => 0,
            Self::Line => 1,
            Self::Arc { clockwise: true } => 2,
            Self::Arc { clockwise: false } => 3,
            Self::Thread => 33,
        }
    }
}

/// The modal tool length offset (G codes of group 08).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthOffset {
    /// No tool length offset is in force (G49).
    Off,
    /// The tool length offset H is added (G43).
    Plus,
    /// The tool length offset H is subtracted (G44).
    Minus,
}

/// The modal hole cycle (G codes of group 09).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hole {
    /// The hole cycle for high-speed peck drilling (G73).
    HighSpeedPeck,
    /// The hole cycle for left-hand tapping (G74).
    LeftTap,
    /// The hole cycle for fine boring (G76).
    FineBore,
    /// The hole cycle for drilling (G81).
    Drill,
    /// The hole cycle for drilling with a dwell at the bottom (G82).
    DrillDwell,
    /// The hole cycle for peck drilling with full retraction (G83).
    Peck,
    /// The hole cycle for right-hand tapping (G84).
    RightTap,
    /// The hole cycle for boring with retraction at the feed (G85).
    Bore,
    /// The hole cycle for boring with a spindle stop (G86).
    BoreStop,
    /// The hole cycle for back boring (G87).
    BackBore,
    /// The hole cycle for boring with manual retraction (G88).
    BoreByHand,
    /// The hole cycle for boring with a dwell and retraction at the feed (G89).
    BoreDwell,
}

impl Hole {
    /// Returns the number of the cycle's G code.
    pub const fn code(self) -> u8 {
        match self {
            Self::HighSpeedPeck => 73,
            Self::LeftTap => 74,
            Self::FineBore => 76,
            Self::Drill => 81,
            Self::DrillDwell => 82,
            Self::Peck => 83,
            Self::RightTap => 84,
            Self::Bore => 85,
            Self::BoreStop => 86,
            Self::BackBore => 87,
            Self::BoreByHand => 88,
            Self::BoreDwell => 89,
        }
    }
}

/// A work zero (group 14) by its index: G54 to G59 are 0 to 5, G54.1 P1 to P48 are 6 to 53.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkZero(pub u8);

impl WorkZero {
    /// Number of work zeros of a mill.
    pub const COUNT: usize = 54;
    /// Index of the first additional work zero (G54.1 P1).
    pub const FIRST_ADDITIONAL: u8 = 6;

    /// Returns the code of the work zero as it is programmed: `G54`, `G54.1P12`.
    pub fn name(self) -> String {
        match self.0 {
            low @ ..Self::FIRST_ADDITIONAL => format!("G{}", 54 + low),
            high => format!("G54.1P{}", high - Self::FIRST_ADDITIONAL + 1),
        }
    }
}

/// Whether the spindle is stopped, turns forward or turns in reverse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleState {
    /// The spindle is stopped (M05).
    #[default]
    Stopped,
    /// The spindle turns forward (M03).
    Forward,
    /// The spindle turns in reverse (M04).
    Reverse,
}

/// The codes and words that remain in force for the next blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillModal {
    /// The kind of motion in force (group 01).
    pub motion: MillMotion,
    /// The plane of arcs and holes in force (group 02).
    pub plane: Plane,
    /// Whether axis words are incremental (G91) instead of absolute (G90, group 03).
    pub incremental: bool,
    /// Whether F is a feed per revolution (G95) instead of per minute (G94, group 05).
    pub per_revolution: bool,
    /// Whether lengths are in inches (G20) instead of mm (G21, group 06).
    pub inch: bool,
    /// On which side of the path cutter radius compensation is, or off (group 07).
    pub cutter: CutterSide,
    /// Whether the tool length offset is added, subtracted or off (group 08).
    pub length: LengthOffset,
    /// The hole cycle in force (group 09); `None` under G80.
    pub hole: Option<Hole>,
    /// Whether the tool returns to R after a hole (G99, group 10) instead of the initial level
    /// (G98).
    pub to_r: bool,
    /// The work zero in force (group 14).
    pub zero: WorkZero,
    /// Whether every cut ends with an exact stop (G61, group 15).
    pub exact_stop: bool,
    /// Number of the cutter radius offset in force (word D).
    pub d: u16,
    /// Number of the tool length offset in force (word H).
    pub h: u16,
    /// The feed in force (F), mm/min or mm/rev; 0 if not yet programmed.
    pub feed: f64,
    /// The lead of threads in force (F of G33), mm; 0 if not yet programmed.
    pub lead: f64,
    /// The spindle speed in force (S), r/min.
    pub speed: f64,
    /// Whether the spindle turns, and in which direction.
    pub spindle: SpindleState,
    /// Whether taps are rigid: the spindle and Z move synchronously (M29).
    pub rigid: bool,
    /// Whether the coolant is on.
    pub coolant: bool,
    /// Number of the tool in the spindle.
    pub tool: u16,
    /// Number of the tool that the last T word called.
    pub called: u16,
    /// Number of the M code that was executed last.
    pub m: u16,
}

impl Default for MillModal {
    /// Returns the modal state at power-on.
    fn default() -> Self {
        Self {
            motion: MillMotion::Rapid,
            plane: Plane::Xy,
            incremental: false,
            per_revolution: false,
            inch: false,
            cutter: CutterSide::On,
            length: LengthOffset::Off,
            hole: None,
            to_r: false,
            zero: WorkZero(0),
            exact_stop: false,
            d: 0,
            h: 0,
            feed: 0.0,
            lead: 0.0,
            speed: 0.0,
            spindle: SpindleState::Stopped,
            rigid: false,
            coolant: false,
            tool: 0,
            called: 0,
            m: 0,
        }
    }
}

impl MillModal {
    /// Returns the number of the G code of the plane in force (group 02).
    pub(crate) const fn plane_code(&self) -> u8 {
        match self.plane {
            Plane::Xy => 17,
            Plane::Zx => 18,
            Plane::Yz => 19,
        }
    }

    /// Returns the number of the G code of the cutter compensation in force (group 07).
    pub(crate) const fn cutter_code(&self) -> u8 {
        match self.cutter {
            CutterSide::On => 40,
            CutterSide::Left => 41,
            CutterSide::Right => 42,
        }
    }

    /// Returns the number of the G code of the length offset in force (group 08).
    pub(crate) const fn length_code(&self) -> u8 {
        match self.length {
            LengthOffset::Off => 49,
            LengthOffset::Plus => 43,
            LengthOffset::Minus => 44,
        }
    }

    /// Returns the G codes in force as they are programmed, one of each group.
    pub fn codes(&self) -> Vec<String> {
        let numbers = [
            self.motion.code(),
            self.plane_code(),
            90 + u8::from(self.incremental),
            94 + u8::from(self.per_revolution),
            21 - u8::from(self.inch),
            self.cutter_code(),
            self.length_code(),
            self.hole.map_or(80, Hole::code),
            98 + u8::from(self.to_r),
            if self.exact_stop { 61 } else { 64 },
        ];
        let mut codes: Vec<String> = numbers.map(|code| format!("G{code:02}")).into();
        codes.push(self.zero.name());
        codes
    }
}
