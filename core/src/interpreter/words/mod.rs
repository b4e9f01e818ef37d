//! The words of a block, sorted by meaning.

pub(crate) mod motion_code;

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::MotionCode;
use crate::dialect;
use crate::interpreter::exact::ExactPoint;
use crate::model::{GCode, ModelRecord};
use crate::program::ProgramBlock;
use crate::units::Axis;
use motion_code::find_motion_code;

/// Codes of group 00, which act in their block only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OneShot {
    /// G04: dwells for a time.
    Dwell,
    /// G28, and G27 of the NC-B08: return to the reference point.
    Reference(ReturnRoute),
    /// G50, and G92 of other models: set work coordinates.
    Coordinates,
    /// G54 to G57 of the Huaxing lathes: zero offsets.
    ZeroOffset(ZeroOffsetCode),
    /// G31 and G30 of the Huaxing lathes: scaling on and off.
    Scale {
        /// Whether the code switches scaling on (`true`) or off.
        on: bool,
    },
    /// G75 and G76 of the Huaxing lathes: return to the position at cycle start.
    StartReturn(StartReturn),
    /// G33 and G34 of the Huaxing lathes: one pass of a thread.
    ThreadPass(LeadUnit),
    /// G86 and G87 of the Huaxing lathes: a thread in L passes.
    CountedThread(LeadUnit),
    /// G84 and G85 of the Huaxing lathes: rigid tapping.
    RigidTap(LeadUnit),
    /// G81 (X) and G82 (Z) of the Huaxing lathes: cut in steps along this axis.
    Stepped(Axis),
    /// G83 of the Huaxing lathes: a deep hole.
    DeepHole,
    /// G20 of the Huaxing lathes: a call of blocks in the same file.
    BlockCall,
    /// G22 of the Huaxing lathes: begin of a subprogram in the same file.
    SubprogramBegin,
    /// G24 of the Huaxing lathes: end of a subprogram in the same file.
    SubprogramEnd,
    /// G25 and G26 of the Huaxing lathes: repeat a range of blocks.
    Repeat {
        /// True for G26: after the repetitions the run returns to the block after the code.
        returns: bool,
    },
    /// G27 of the Huaxing lathes: jump to the block N.
    EndlessLoop,
    /// G70: cuts a profile to its final size.
    Finishing,
    /// G71: roughs a profile by turning.
    TurningRough(ContourSource),
    /// G72: roughs a profile by facing.
    FacingRough(ContourSource),
    /// G73: roughs a profile by repeating it.
    Pattern(ContourSource),
    /// G74: cuts along Z in pecks.
    FacePecking,
    /// G75: cuts along X in pecks.
    Grooving,
    /// G76: cuts a thread in several passes.
    CompoundThread,
}

impl OneShot {
    /// The code of group 00 with this meaning; `None` for modal codes, for codes of models
    /// whose programs are not carried out, and for G65, which the reader handles separately.
    #[inline]
    const fn from_meaning(meaning: GCode) -> Option<Self> {
        Some(match meaning {
            GCode::ZeroOffsetOff => Self::ZeroOffset(ZeroOffsetCode::Off),
            GCode::ZeroOffsetAbsolute => Self::ZeroOffset(ZeroOffsetCode::Absolute),
            GCode::ZeroOffsetIncremental => Self::ZeroOffset(ZeroOffsetCode::Added),
            GCode::ZeroOffsetHere => Self::ZeroOffset(ZeroOffsetCode::Here),
            GCode::ScaleOff => Self::Scale { on: false },
            GCode::ScaleOn => Self::Scale { on: true },
            GCode::MachineZero => Self::Reference(ReturnRoute::NamedAxes),
            GCode::StartByMachine => Self::StartReturn(StartReturn::Machine),
            GCode::StartByWork => Self::StartReturn(StartReturn::Work),
            GCode::MetricThreadPass => Self::ThreadPass(LeadUnit::Millimetres),
            GCode::InchThreadPass => Self::ThreadPass(LeadUnit::PerInch),
            GCode::SteppedTurning => Self::Stepped(Axis::X),
            GCode::SteppedFacing => Self::Stepped(Axis::Z),
            GCode::DeepHole => Self::DeepHole,
            GCode::MetricRigidTapping => Self::RigidTap(LeadUnit::Millimetres),
            GCode::InchRigidTapping => Self::RigidTap(LeadUnit::PerInch),
            GCode::MetricThreadCycle => Self::CountedThread(LeadUnit::Millimetres),
            GCode::InchThreadCycle => Self::CountedThread(LeadUnit::PerInch),
            GCode::SubprogramCall => Self::BlockCall,
            GCode::SubprogramBegin => Self::SubprogramBegin,
            GCode::SubprogramEnd => Self::SubprogramEnd,
            GCode::RepeatAndGoOnThere => Self::Repeat { returns: false },
            GCode::RepeatAndComeBack => Self::Repeat { returns: true },
            GCode::EndlessLoop => Self::EndlessLoop,
            GCode::CountedTurningRough => Self::TurningRough(ContourSource::Counted),
            GCode::CountedFacingRough => Self::FacingRough(ContourSource::Counted),
            GCode::CountedPattern => Self::Pattern(ContourSource::Counted),
            GCode::Dwell | GCode::DwellSecondsFirst | GCode::DwellByK => Self::Dwell,
            GCode::Reference => Self::Reference(ReturnRoute::MachineZero),
            GCode::ReferenceByParameter => Self::Reference(ReturnRoute::Parameters),
            GCode::ReferenceDirect => Self::Reference(ReturnRoute::Direct),
            GCode::Coordinates => Self::Coordinates,
            GCode::Finishing => Self::Finishing,
            GCode::TurningRough => Self::TurningRough(ContourSource::Named),
            GCode::FacingRough => Self::FacingRough(ContourSource::Named),
            GCode::Pattern => Self::Pattern(ContourSource::Named),
            GCode::FacePecking => Self::FacePecking,
            GCode::Grooving => Self::Grooving,
            GCode::CompoundThread => Self::CompoundThread,
            _ => return None,
        })
    }

    /// Whether the code is one of the compound cycles G70 to G76.
    pub(crate) const fn is_compound(self) -> bool {
        matches!(
            self,
            Self::Finishing
                | Self::TurningRough(_)
                | Self::FacingRough(_)
                | Self::Pattern(_)
                | Self::FacePecking
                | Self::Grooving
                | Self::CompoundThread
        )
    }
}

/// The blocks that form the contour of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ContourSource {
    /// The blocks from the sequence number P to Q.
    Named,
    /// The next N blocks after the cycle (Huaxing lathes).
    Counted,
}

/// The effect of a code on the zero offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ZeroOffsetCode {
    /// G54: sets the zero offset to 0.
    Off,
    /// G55: sets the zero offset to X and Z.
    Absolute,
    /// G56: adds X and Z to the zero offset.
    Added,
    /// G57: sets the zero offset so that the current position gets the coordinates X and Z, 0
    /// where the word is missing.
    Here,
}

/// Whether a thread lead is in mm or in threads per inch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeadUnit {
    /// The lead is in mm per revolution.
    Millimetres,
    /// The lead is a number of threads per inch.
    PerInch,
}

/// The coordinates with which the tool returns to the start of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartReturn {
    /// G75: the machine coordinates at the start of the run.
    Machine,
    /// G76: work coordinates, as they were at the start or as G92 redefined them.
    Work,
}

/// The route and the target of a return to the reference point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReturnRoute {
    /// The axes move over an intermediate point to the machine zero.
    MachineZero,
    /// Through an intermediate point to the reference point of the model's parameters.
    Parameters,
    /// Straight to the reference point of the model's parameters.
    Direct,
    /// Straight to machine zero, in the programmed axes or in both (G74 of the Huaxing
    /// lathes).
    NamedAxes,
}

/// The words of a block by meaning; `None` for a missing word. Lengths are in millionths of a
/// millimetre, `x` and `u` as written (diameter or radius).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SortedWords {
    /// The code of group 00 in the block; `None` without one.
    pub(crate) one_shot: Option<OneShot>,
    /// The code of group 01 (motion and G90, G92, G94) in the block; `None` without one.
    pub(crate) motion: Option<MotionCode>,
    /// Group 04: 40, 41 or 42 for G40, G41 or G42; `None` without one.
    pub(crate) nose: Option<u8>,
    /// Group 02: true for G96, false for G97; `None` without one.
    pub(crate) surface: Option<bool>,
    /// Group 03: true for G99, false for G98; `None` without one.
    pub(crate) per_revolution: Option<bool>,
    pub(crate) m: Option<u8>,
    pub(crate) s: Option<i64>,
    pub(crate) t: Option<i64>,
    /// Number of digits written after S; 0 if a variable gave the number.
    pub(crate) s_digits: u8,
    /// Number of digits written after T; 0 if a variable gave the number.
    pub(crate) t_digits: u8,
    pub(crate) f: Option<f64>,
    pub(crate) p: Option<i64>,
    pub(crate) x: Option<i64>,
    pub(crate) u: Option<i64>,
    pub(crate) z: Option<i64>,
    pub(crate) w: Option<i64>,
    pub(crate) r: Option<i64>,
    pub(crate) i: Option<i64>,
    pub(crate) k: Option<i64>,
    pub(crate) j: Option<i64>,
    pub(crate) q: Option<i64>,
    pub(crate) l: Option<i64>,
    pub(crate) h: Option<u8>,
    /// L as a factor, in millionths: 1 000 000 for L1; `None` without L.
    pub(crate) l_exact: Option<i64>,
    /// P as a length or lead, in millionths of a millimetre; `None` without P.
    pub(crate) p_exact: Option<i64>,
    /// D in millionths: 1 000 000 for D1, a length in mm or a time in ms; `None` without D.
    pub(crate) d_exact: Option<i64>,
    /// N as a word of a call or cycle (Huaxing), not as a sequence number; `None` without it.
    pub(crate) n: Option<u32>,
    /// True for G91, false for G90; `None` without either.
    pub(crate) incremental: Option<bool>,
    /// Whether the block has G09: it ends with an exact stop.
    pub(crate) exact_stop: bool,
    /// Whether R was written with a decimal point, which decides the unit of R(d) of G76.
    pub(crate) r_has_point: bool,
    /// Number of words of the block besides O and the sequence number N.
    pub(crate) count: u8,
}

impl SortedWords {
    /// Sorts the words of a block by the meaning that the codes have on the model of `record`.
    ///
    /// # Errors
    /// 010 for an unknown G code, 024 for codes of two groups that exclude each other.
    pub(crate) fn from_block(block: &ProgramBlock, record: &ModelRecord) -> Result<Self, Alarm> {
        let mut words = Self::default();
        words.sort_block(block, record)?;
        Ok(words)
    }

    /// Sorts the words of a block into `self`, which must be empty; in place, because the
    /// words are large to move.
    ///
    /// # Errors
    /// As for [`Self::from_block`].
    pub(crate) fn sort_block(
        &mut self,
        block: &ProgramBlock,
        record: &ModelRecord,
    ) -> Result<(), Alarm> {
        let words = self;
        for word in block.words() {
            words.count = words.count.saturating_add(1);
            let value = word.value;
            match word.address {
                b'G' => words.sort_g_code(value.integer(), record)?,
                b'M' => words.m = u8::try_from(value.integer()).ok(),
                b'S' => {
                    words.s = Some(value.integer());
                    words.s_digits = value.digits();
                }
                b'T' => {
                    words.t = Some(value.integer());
                    words.t_digits = value.digits();
                }
                b'P' => {
                    words.p = Some(value.integer());
                    words.p_exact = Some(value.millionths());
                }
                b'F' => words.f = Some(value.mm()),
                b'X' => words.x = Some(value.millionths()),
                b'U' => words.u = Some(value.millionths()),
                b'Z' => words.z = Some(value.millionths()),
                b'W' => words.w = Some(value.millionths()),
                b'Q' => words.q = Some(value.integer()),
                b'L' => {
                    words.l = Some(value.integer());
                    words.l_exact = Some(value.millionths());
                }
                b'N' => words.n = u32::try_from(value.integer()).ok(),
                b'H' => words.h = u8::try_from(value.integer()).ok(),
                b'D' => words.d_exact = Some(value.millionths()),
                b'R' => {
                    words.r = Some(value.millionths());
                    words.r_has_point = value.has_point();
                }
                b'J' => words.j = Some(value.millionths()),
                b'I' => words.i = Some(value.millionths()),
                b'K' => words.k = Some(value.millionths()),
                _ => {}
            }
        }
        if words.one_shot.is_some() && words.motion.is_some() {
            return Err(Alarm::new(number::G_CONFLICT).with_detail(say::codes_of_two_groups()));
        }
        Ok(())
    }

    fn sort_g_code(&mut self, code: i64, record: &ModelRecord) -> Result<(), Alarm> {
        let Some(meaning) = record.g_code(code) else {
            return Err(unknown_g_alarm(code));
        };
        if let Some(motion) = find_motion_code(meaning) {
            self.motion = Some(motion);
            return Ok(());
        }
        match meaning {
            GCode::ExactStop => self.exact_stop = true,
            GCode::Absolute => self.incremental = Some(false),
            GCode::Incremental => self.incremental = Some(true),
            GCode::NoseOff => self.nose = Some(40),
            GCode::NoseLeft => self.nose = Some(41),
            GCode::NoseRight => self.nose = Some(42),
            GCode::SurfaceSpeed => self.surface = Some(true),
            GCode::SpindleSpeed => self.surface = Some(false),
            GCode::FeedPerMinute => self.per_revolution = Some(false),
            GCode::FeedPerRevolution => self.per_revolution = Some(true),
            meaning => match OneShot::from_meaning(meaning) {
                Some(one_shot) => self.one_shot = Some(one_shot),
                None => return Err(unsupported_g_alarm(code)),
            },
        }
        Ok(())
    }

    /// Whether the block must wait until every earlier command is finished.
    pub(crate) fn needs_standstill(&self) -> bool {
        self.one_shot.is_some()
            || self.s.is_some()
            || self.t.is_some()
            || self.surface.is_some()
            || match self.m {
                None => false,
                // A call or return without motion has no effect on the machine.
                Some(98 | 99) => self.has_axis_words(),
                Some(_) => true,
            }
    }

    /// Copies the words of the path; leaves out F, S, T, M and the codes of feed and spindle.
    pub(crate) fn path_only(&self) -> Self {
        Self {
            surface: None,
            per_revolution: None,
            m: None,
            s: None,
            t: None,
            f: None,
            ..*self
        }
    }

    /// Whether X, U, Z or W is programmed.
    pub(crate) const fn has_axis_words(&self) -> bool {
        self.x.is_some() || self.u.is_some() || self.z.is_some() || self.w.is_some()
    }

    /// Whether the block has nothing besides O, N and the words of a lone M98 or M99. Such a
    /// block is no stop of single block.
    pub(crate) fn is_bare_call(&self) -> bool {
        matches!(self.m, Some(98 | 99)) && self.count == 1 + u8::from(self.p.is_some())
    }

    /// R, I and K of the block, as the words of an arc.
    pub(crate) const fn arc_words(&self) -> ArcWords {
        ArcWords {
            r: self.r,
            i: self.i,
            k: self.k,
        }
    }

    /// The targets of X or U and of Z or W; X and Z win over U and W. X and U are multiplied
    /// by `x_factor`, 2 under radius programming. Increments count from `base`.
    pub(crate) fn axis_words(&self, x_factor: i64, base: ExactPoint) -> AxisWords {
        AxisWords {
            x: AxisTarget::from_words(self.x, self.u, x_factor),
            z: AxisTarget::from_words(self.z, self.w, 1),
            base,
        }
    }
}

/// The words of an arc, millionths of a millimetre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ArcWords {
    /// R: the radius, in millionths of a millimetre; `None` if not programmed.
    pub(crate) r: Option<i64>,
    /// I: X distance from the start to the centre as written, in millionths of a millimetre, a
    /// radius on the GSK980TD; `None` if not programmed.
    pub(crate) i: Option<i64>,
    /// K: Z distance from the start to the centre, in millionths of a millimetre; `None` if
    /// not programmed.
    pub(crate) k: Option<i64>,
}

#[cold]
fn unsupported_g_alarm(code: i64) -> Alarm {
    Alarm::new(number::BAD_G).with_detail(say::g_not_carried_out(code))
}

#[cold]
fn unknown_g_alarm(code: i64) -> Alarm {
    let rule = say::g_unknown(code);
    let detail = dialect::with_advice(rule, dialect::advice_for_g_code(code));
    Alarm::new(number::BAD_G).with_detail(detail)
}

/// The programmed target of one axis: absolute, incremental or none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum AxisTarget {
    /// The block has no word for the axis.
    #[default]
    None,
    /// The end point, in units of [`ExactPoint`].
    Absolute(i64),
    /// The distance to the end point, in units of [`ExactPoint`].
    Increment(i64),
}

impl AxisTarget {
    /// The target of an axis from its absolute and its incremental word as written; the
    /// absolute word wins. The value is multiplied by `factor`.
    pub(crate) fn from_words(absolute: Option<i64>, increment: Option<i64>, factor: i64) -> Self {
        match (absolute, increment) {
            (Some(value), _) => Self::Absolute(value * factor),
            (None, Some(value)) => Self::Increment(value * factor),
            (None, None) => Self::None,
        }
    }

    const fn as_increment(self) -> Self {
        match self {
            Self::Absolute(value) => Self::Increment(value),
            other => other,
        }
    }

    /// The end point, with increments counted from `base`; `None` if not programmed.
    pub(crate) const fn resolve(self, base: i64) -> Option<i64> {
        match self {
            Self::None => None,
            Self::Absolute(value) => Some(value),
            Self::Increment(value) => Some(base.saturating_add(value)),
        }
    }
}

/// The programmed targets of both axes, X as a diameter, in units of [`ExactPoint`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct AxisWords {
    pub(crate) x: AxisTarget,
    pub(crate) z: AxisTarget,
    /// The point to which incremental words are added.
    pub(crate) base: ExactPoint,
}

impl AxisWords {
    /// Whether any axis has a word.
    pub(crate) fn has_any(&self) -> bool {
        self.x != AxisTarget::None || self.z != AxisTarget::None
    }

    pub(crate) const fn get(&self, axis: Axis) -> AxisTarget {
        match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
        }
    }

    /// Turns absolute targets into increments if G91 is in force (`incremental`).
    pub(crate) const fn with_incremental(self, incremental: bool) -> Self {
        match incremental {
            true => Self {
                x: self.x.as_increment(),
                z: self.z.as_increment(),
                ..self
            },
            false => self,
        }
    }

    /// The programmed end point. An axis that is not programmed stays at `current`.
    pub(crate) fn resolve_end(&self, current: ExactPoint) -> ExactPoint {
        ExactPoint::new(
            self.x.resolve(self.base.x).unwrap_or(current.x),
            self.z.resolve(self.base.z).unwrap_or(current.z),
        )
    }
}
