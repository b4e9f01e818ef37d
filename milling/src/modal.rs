//! Stores the modal codes and words.

use gsk_core::compensation::cutter::CutterSide;

use crate::space::Plane;

/// Group 01: the kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillMotion {
    /// Rapid traverse (G00).
    Rapid,
    /// Straight cut (G01).
    Line,
    /// Arc (G02, G03).
    Arc {
        /// Whether it is G02.
        clockwise: bool,
    },
    /// Thread (G33).
    Thread,
}

impl MillMotion {
    /// Returns the number of the G code.
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

/// Group 08: the tool length offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthOffset {
    /// No length offset (G49).
    Off,
    /// Adds the offset H (G43).
    Plus,
    /// Subtracts the offset H (G44).
    Minus,
}

/// Group 09: the hole cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hole {
    /// High-speed peck drilling (G73).
    HighSpeedPeck,
    /// Left-hand tapping (G74).
    LeftTap,
    /// Fine boring (G76).
    FineBore,
    /// Drilling (G81).
    Drill,
    /// Drilling with a dwell at the bottom (G82).
    DrillDwell,
    /// Peck drilling with full retraction (G83).
    Peck,
    /// Right-hand tapping (G84).
    RightTap,
    /// Boring with retraction at the feed (G85).
    Bore,
    /// Boring with a spindle stop (G86).
    BoreStop,
    /// Back boring (G87).
    BackBore,
    /// Boring with manual retraction (G88).
    BoreByHand,
    /// Boring with a dwell and retraction at the feed (G89).
    BoreDwell,
}

impl Hole {
    /// Returns the number of the G code.
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

/// Group 14: G54 to G59 are 0 to 5, G54.1 P1 to P48 are 6 to 53.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkZero(pub u8);

impl WorkZero {
    /// Number of work zeros.
    pub const COUNT: usize = 54;
    /// Index of G54.1 P1.
    pub const FIRST_ADDITIONAL: u8 = 6;

    /// Returns the code as written: `G54`, `G54.1P12`.
    pub fn name(self) -> String {
        match self.0 {
            low @ ..Self::FIRST_ADDITIONAL => format!("G{}", 54 + low),
            high => format!("G54.1P{}", high - Self::FIRST_ADDITIONAL + 1),
        }
    }
}

/// The state of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleState {
    /// Stopped (M05).
    #[default]
    Stopped,
    /// Turning forward (M03).
    Forward,
    /// Turning in reverse (M04).
    Reverse,
}

/// The modal codes and words of a mill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillModal {
    /// The kind of motion (group 01).
    pub motion: MillMotion,
    /// The plane (group 02).
    pub plane: Plane,
    /// Whether words are incremental (G91, group 03).
    pub incremental: bool,
    /// Whether F is per revolution (G95, group 05).
    pub per_revolution: bool,
    /// Whether words are in inches (G20, group 06).
    pub inch: bool,
    /// Cutter radius compensation (group 07).
    pub cutter: CutterSide,
    /// Tool length offset (group 08).
    pub length: LengthOffset,
    /// The hole cycle (group 09). `None` is G80.
    pub hole: Option<Hole>,
    /// Whether holes return to R (G99, group 10) instead of the initial level (G98).
    pub to_r: bool,
    /// The work zero (group 14).
    pub zero: WorkZero,
    /// Whether every cut ends with an exact stop (G61, group 15).
    pub exact_stop: bool,
    /// Number of the cutter radius offset in force (D).
    pub d: u16,
    /// Number of the tool length offset in force (H).
    pub h: u16,
    /// F, mm/min or mm/rev. 0 if not yet programmed.
    pub feed: f64,
    /// F of threads, mm. 0 if not yet programmed.
    pub lead: f64,
    /// S, r/min.
    pub speed: f64,
    /// State of the spindle.
    pub spindle: SpindleState,
    /// Whether taps are rigid (M29).
    pub rigid: bool,
    /// Whether coolant is on.
    pub coolant: bool,
    /// The tool in the spindle.
    pub tool: u16,
    /// The tool that the last T word called.
    pub called: u16,
    /// The last M code.
    pub m: u16,
}

impl Default for MillModal {
    /// The modal state at power-on.
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
    /// Returns the G code of group 02.
    pub(crate) const fn plane_code(&self) -> u8 {
        match self.plane {
            Plane::Xy => 17,
            Plane::Zx => 18,
            Plane::Yz => 19,
        }
    }

    /// Returns the G code of group 07.
    pub(crate) const fn cutter_code(&self) -> u8 {
        match self.cutter {
            CutterSide::On => 40,
            CutterSide::Left => 41,
            CutterSide::Right => 42,
        }
    }

    /// Returns the G code of group 08.
    pub(crate) const fn length_code(&self) -> u8 {
        match self.length {
            LengthOffset::Off => 49,
            LengthOffset::Plus => 43,
            LengthOffset::Minus => 44,
        }
    }

    /// Returns the codes in force as written, one of each group.
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
