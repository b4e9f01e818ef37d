//! Sorts the words of a block by their meaning.

use gsk_core::alarm::{Alarm, number};
use gsk_core::compensation::cutter::CutterSide;
use gsk_core::model::{GCode, ModelRecord};
use gsk_core::program::{ProgramBlock, WordNumber};
use gsk_messages::say;

use crate::axes::Axes;
use crate::modal::{Hole, LengthOffset, MillMotion, WorkZero};
use crate::space::{AxisValues, Length, MillAxis, Plane};

/// Codes of rough milling, of which the manual gives the numbers only (002:1280-1295).
const ROUGH_MILLING: [i64; 4] = [110, 111, 134, 135];

/// A G code that acts only in its block (group 00).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OneShotCode {
    Dwell,
    OffsetInput,
    ReferenceCheck,
    Reference,
    ReferenceBack,
    FurtherReference,
    Skip,
    Measure,
    Local,
    Machine,
    Coordinates,
}

/// Whether a code switches a function on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OnOff {
    On,
    Off,
}

/// The words of a block, sorted by their meaning; `None` where the block has no such word.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BlockWords {
    pub(crate) one_shot: Option<OneShotCode>,
    pub(crate) motion: Option<MillMotion>,
    pub(crate) plane: Option<Plane>,
    pub(crate) incremental: Option<bool>,
    pub(crate) per_revolution: Option<bool>,
    pub(crate) inch: Option<bool>,
    pub(crate) cutter: Option<CutterSide>,
    pub(crate) length: Option<LengthOffset>,
    /// The hole cycle; `Some(None)` is G80, which ends it.
    pub(crate) hole: Option<Option<Hole>>,
    pub(crate) to_r: Option<bool>,
    pub(crate) scaling: Option<OnOff>,
    pub(crate) zero: Option<WorkZero>,
    /// Whether the block has G54.1, whose P selects the work zero.
    pub(crate) additional: bool,
    pub(crate) exact_mode: Option<bool>,
    pub(crate) exact_stop: bool,
    pub(crate) rotation: Option<OnOff>,
    pub(crate) polar: Option<OnOff>,
    pub(crate) letters: Letters,
    /// The letter of a word that no code of a mill takes: of an axis that the machine does not
    /// have, or of a lathe; otherwise `None`.
    pub(crate) unused_word: Option<char>,
}

/// The values of the words of a block by their letters, as programmed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Letters {
    pub(crate) axes: AxisValues<Option<WordNumber>>,
    pub(crate) center: AxisValues<Option<WordNumber>>,
    pub(crate) r: Option<WordNumber>,
    pub(crate) q: Option<WordNumber>,
    pub(crate) p: Option<WordNumber>,
    pub(crate) l: Option<WordNumber>,
    pub(crate) f: Option<WordNumber>,
    pub(crate) s: Option<WordNumber>,
    pub(crate) t: Option<WordNumber>,
    pub(crate) m: Option<WordNumber>,
    pub(crate) d: Option<WordNumber>,
    pub(crate) h: Option<WordNumber>,
}

/// The number after G in G54.1, in millionths.
const ADDITIONAL: i64 = 54_100_000;

impl BlockWords {
    pub(crate) fn parse(
        block: &ProgramBlock,
        record: &ModelRecord,
        axes: Axes,
    ) -> Result<Self, Alarm> {
        let mut words = Self::default();
        let mut further = AxisValues::default();
        for word in block.words() {
            match word.address {
                b'G' if word.value.millionths() == ADDITIONAL => words.additional = true,
                b'G' => words.take_code(word.value, record)?,
                letter @ b'A'..=b'C' => {
                    let letter = char::from(letter);
                    if let Some(axis) = axes.axis(letter) {
                        further.set(axis, Some(word.value));
                    } else {
                        words.unused_word = words.unused_word.or(Some(letter));
                    }
                }
                letter if record.is_argument_only(letter) => {
                    words.unused_word = words.unused_word.or(Some(letter.into()));
                }
                _ => {}
            }
        }
        let number = |address| block.number(address);
        words.letters = Letters {
            axes: AxisValues([
                number(b'X'),
                number(b'Y'),
                number(b'Z'),
                further.get(MillAxis::Fourth),
                further.get(MillAxis::Fifth),
            ]),
            center: AxisValues::basic([number(b'I'), number(b'J'), number(b'K')], None),
            r: number(b'R'),
            q: number(b'Q'),
            p: number(b'P'),
            l: number(b'L'),
            f: number(b'F'),
            s: number(b'S'),
            t: number(b'T'),
            m: number(b'M'),
            d: number(b'D'),
            h: number(b'H'),
        };
        Ok(words)
    }

    fn take_code(&mut self, value: WordNumber, record: &ModelRecord) -> Result<(), Alarm> {
        let code = value.integer();
        let known = record
            .g_code(code)
            .filter(|_| value.millionths() % 1_000_000 == 0);
        let Some(meaning) = known else {
            let written = value.to_string();
            let detail = match ROUGH_MILLING.contains(&code) && written == code.to_string() {
                true => say::mill_g_not_on_pc(code),
                false => say::mill_g_unknown(written),
            };
            return Err(Alarm::new(number::BAD_G).with_detail(detail));
        };
        match meaning {
            GCode::Dwell => self.take_one_shot(OneShotCode::Dwell)?,
            GCode::OffsetInput => self.take_one_shot(OneShotCode::OffsetInput)?,
            GCode::ReferenceCheck => self.take_one_shot(OneShotCode::ReferenceCheck)?,
            GCode::Reference => self.take_one_shot(OneShotCode::Reference)?,
            GCode::ReferenceBack => self.take_one_shot(OneShotCode::ReferenceBack)?,
            GCode::FurtherReference => self.take_one_shot(OneShotCode::FurtherReference)?,
            GCode::Skip => self.take_one_shot(OneShotCode::Skip)?,
            GCode::ToolMeasure => self.take_one_shot(OneShotCode::Measure)?,
            GCode::LocalCoordinates => self.take_one_shot(OneShotCode::Local)?,
            GCode::MachineCoordinates => self.take_one_shot(OneShotCode::Machine)?,
            GCode::Coordinates => self.take_one_shot(OneShotCode::Coordinates)?,
            GCode::Rapid => self.motion = Some(MillMotion::Rapid),
            GCode::Line => self.motion = Some(MillMotion::Line),
            GCode::PlaneArcClockwise => self.motion = Some(MillMotion::Arc { clockwise: true }),
            GCode::PlaneArcCounterclockwise => {
                self.motion = Some(MillMotion::Arc { clockwise: false });
            }
            GCode::Thread => self.motion = Some(MillMotion::Thread),
            GCode::PlaneXy => self.plane = Some(Plane::Xy),
            GCode::PlaneZx => self.plane = Some(Plane::Zx),
            GCode::PlaneYz => self.plane = Some(Plane::Yz),
            GCode::Absolute => self.incremental = Some(false),
            GCode::Incremental => self.incremental = Some(true),
            GCode::FeedPerMinute => self.per_revolution = Some(false),
            GCode::FeedPerRevolution => self.per_revolution = Some(true),
            GCode::InchInput => self.inch = Some(true),
            GCode::MetricInput => self.inch = Some(false),
            GCode::CutterOff => self.cutter = Some(CutterSide::On),
            GCode::CutterLeft => self.cutter = Some(CutterSide::Left),
            GCode::CutterRight => self.cutter = Some(CutterSide::Right),
            GCode::LengthPlus => self.length = Some(LengthOffset::Plus),
            GCode::LengthMinus => self.length = Some(LengthOffset::Minus),
            GCode::LengthOff => self.length = Some(LengthOffset::Off),
            GCode::ScalingOn => self.scaling = Some(OnOff::On),
            GCode::ScalingOff => self.scaling = Some(OnOff::Off),
            GCode::RotationOn => self.rotation = Some(OnOff::On),
            GCode::RotationOff => self.rotation = Some(OnOff::Off),
            GCode::PolarOn => self.polar = Some(OnOff::On),
            GCode::PolarOff => self.polar = Some(OnOff::Off),
            GCode::WorkCoordinates1 => self.zero = Some(WorkZero(0)),
            GCode::WorkCoordinates2 => self.zero = Some(WorkZero(1)),
            GCode::WorkCoordinates3 => self.zero = Some(WorkZero(2)),
            GCode::WorkCoordinates4 => self.zero = Some(WorkZero(3)),
            GCode::WorkCoordinates5 => self.zero = Some(WorkZero(4)),
            GCode::WorkCoordinates6 => self.zero = Some(WorkZero(5)),
            GCode::ExactStop => self.exact_stop = true,
            GCode::ExactStopMode => self.exact_mode = Some(true),
            GCode::CuttingMode => self.exact_mode = Some(false),
            GCode::ReturnInitial => self.to_r = Some(false),
            GCode::ReturnR => self.to_r = Some(true),
            GCode::DrillingOff => self.hole = Some(None),
            GCode::HighSpeedPeck => self.hole = Some(Some(Hole::HighSpeedPeck)),
            GCode::LeftTapping => self.hole = Some(Some(Hole::LeftTap)),
            GCode::FineBoring => self.hole = Some(Some(Hole::FineBore)),
            GCode::Drilling => self.hole = Some(Some(Hole::Drill)),
            GCode::DrillingDwell => self.hole = Some(Some(Hole::DrillDwell)),
            GCode::PeckDrilling => self.hole = Some(Some(Hole::Peck)),
            GCode::RightTapping => self.hole = Some(Some(Hole::RightTap)),
            GCode::Boring => self.hole = Some(Some(Hole::Bore)),
            GCode::BoringStop => self.hole = Some(Some(Hole::BoreStop)),
            GCode::BackBoring => self.hole = Some(Some(Hole::BackBore)),
            GCode::BoringByHand => self.hole = Some(Some(Hole::BoreByHand)),
            GCode::BoringDwell => self.hole = Some(Some(Hole::BoreDwell)),
            // Codes of lathes.
            _ => {
                let detail = say::mill_g_not_checked(code, meaning.text());
                return Err(Alarm::new(number::BAD_G).with_detail(detail));
            }
        }
        Ok(())
    }

    fn take_one_shot(&mut self, code: OneShotCode) -> Result<(), Alarm> {
        if self.one_shot.is_some_and(|before| before != code) {
            let detail = say::mill_one_shots();
            return Err(Alarm::new(number::G_CONFLICT).with_detail(detail));
        }
        self.one_shot = Some(code);
        Ok(())
    }

    /// Refuses a word that no code takes. Not called for a macro call, where it is an
    /// argument.
    pub(crate) fn check_axes(&self) -> Result<(), Alarm> {
        let detail = match self.unused_word {
            Some(letter @ ('U' | 'V' | 'W')) => {
                say::mill_increment_of_lathe(letter, char::from(letter as u8 + 3))
            }
            Some('E') => say::address_unknown('E'),
            Some(letter) => say::mill_axis_missing(letter),
            None => return Ok(()),
        };
        Err(Alarm::new(number::BAD_ADDRESS).with_detail(detail))
    }

    /// Returns whether the block has a word for any axis.
    pub(crate) fn has_axes(&self) -> bool {
        self.letters.axes.0.iter().any(Option::is_some)
    }

    /// Checks that the codes of a block can be combined. Errors: alarm 024 if not.
    pub(crate) fn check(&self) -> Result<(), Alarm> {
        let holes = self.hole.is_some_and(|hole| hole.is_some());
        // A reference return is a rapid. G53 moves at rapid or feed.
        let allowed = |motion: &MillMotion| match self.one_shot {
            Some(OneShotCode::Machine) => true,
            Some(
                OneShotCode::Reference | OneShotCode::FurtherReference | OneShotCode::ReferenceBack,
            ) => *motion == MillMotion::Rapid,
            _ => false,
        };
        let motion = self.motion.filter(|motion| !allowed(motion));
        let apart = self.one_shot.is_some() && (motion.is_some() || holes);
        if apart || (holes && self.motion.is_some()) {
            let detail = say::mill_one_shots();
            return Err(Alarm::new(number::G_CONFLICT).with_detail(detail));
        }
        Ok(())
    }
}

/// Returns the length of a word whose number is in inches (`inch`) or millimetres.
pub(crate) fn length(value: WordNumber, inch: bool) -> Length {
    let metric = if inch { value.inches_to_mm() } else { value };
    Length::from_nm(metric.millionths())
}
