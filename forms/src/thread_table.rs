//! The table of threads and the diameters that follow from diameter and pitch.
//!
//! | Standard | Source | Formulas of the basic profile |
//! |---|---|---|
//! | ISO metric, coarse and fine | ISO 261, 262, 724 | D2 = D − 0.6495 P, D1 = D − 1.0825 P, d3 = d − 1.2269 P |
//! | UNC, UNF | ASME B1.1 | the same profile |
//! | G | ISO 228-1 | D2 = D − 0.6403 P, D1 = D − 1.2807 P |
//! | Tr | ISO 2904 | d2 = D − 0.5 P, D1 = D − P, d3 = D − P − 2 ac, D4 = D + 2 ac |
//! | NPT | ASME B1.20.1 | E0 = D − (0.05 D + 1.1 in) P, height 0.8 P, taper 1:16 |

use libm::sqrt;

use crate::thousandths::Thousandths;

/// The table: standard, designation, diameter in mm, pitch or threads per inch, and for NPT
/// the length of hand-tight engagement L1 in mm.
const TABLE: &str = include_str!("../../assets/tables/threads.tsv");
/// The word for a thread with its own diameter and pitch.
pub(crate) const FREE: &str = "FREE";
/// Millimetres of an inch.
const INCH_MM: f64 = 25.4;

/// The standard of a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThreadStandard {
    /// ISO metric, coarse.
    IsoCoarse,
    /// ISO metric, fine.
    IsoFine,
    /// Unified coarse.
    UnifiedCoarse,
    /// Unified fine.
    UnifiedFine,
    /// Pipe threads where pressure-tight joints are not made on the threads.
    Bsp,
    /// ISO metric trapezoidal.
    Trapezoidal,
    /// American pipe thread, taper 1:16.
    Npt,
}

impl ThreadStandard {
    const WORDS: [(&'static str, Self, &'static str); 7] = [
        ("iso-coarse", Self::IsoCoarse, "ISO 261"),
        ("iso-fine", Self::IsoFine, "ISO 262"),
        ("unc", Self::UnifiedCoarse, "ASME B1.1"),
        ("unf", Self::UnifiedFine, "ASME B1.1"),
        ("bsp", Self::Bsp, "ISO 228-1"),
        ("trapezoidal", Self::Trapezoidal, "ISO 2904"),
        ("npt", Self::Npt, "ASME B1.20.1"),
    ];

    /// The document that lists the threads.
    pub fn source(self) -> &'static str {
        let mut words = Self::WORDS.iter();
        words.find(|it| it.1 == self).map_or("", |it| it.2)
    }

    /// The angle between the flanks, degrees.
    pub const fn flank_angle(self) -> f64 {
        match self {
            Self::Bsp => 55.0,
            Self::Trapezoidal => 30.0,
            _ => 60.0,
        }
    }
}

/// The pitch of a thread as its standard gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThreadPitch {
    /// Pitch, mm.
    Millimetres(f64),
    /// Threads per inch.
    PerInch(f64),
}

impl ThreadPitch {
    /// The pitch, mm.
    pub const fn mm(self) -> f64 {
        match self {
            Self::Millimetres(pitch) => pitch,
            Self::PerInch(count) => INCH_MM / count,
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadRow {
    /// The standard.
    pub standard: ThreadStandard,
    /// The designation, for instance `M20x1.5`.
    pub designation: &'static str,
    /// The nominal diameter, mm; of NPT the outside diameter of the pipe.
    pub diameter_mm: f64,
    /// The pitch.
    pub pitch: ThreadPitch,
    /// The length of hand-tight engagement of a taper thread, mm; 0 otherwise.
    pub gauge_mm: f64,
}

/// The diameters of a thread at its front face, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadProfile {
    /// Angle between the flanks, degrees.
    pub flank_angle: f64,
    /// Pitch diameter.
    pub pitch_diameter: f64,
    /// Diameter of the blank: the crests outside, the hole inside.
    pub blank: f64,
    /// Diameter at the bottom of the groove.
    pub root: f64,
    /// Change of diameter per mm of length; 0 for a straight thread.
    pub taper: f64,
}

impl ThreadProfile {
    /// Height of the thread that is cut, mm.
    pub fn depth(&self) -> f64 {
        libm::fabs(self.blank - self.root) / 2.0
    }
}

impl ThreadRow {
    fn parse(line: &'static str) -> Option<Self> {
        let mut fields = line.split('\t');
        let word = fields.next()?;
        let standard = ThreadStandard::WORDS.iter().find(|it| it.0 == word)?.1;
        let designation = fields.next()?;
        let diameter_mm = fields.next()?.parse().ok()?;
        let (value, unit) = fields.next()?.split_once(' ')?;
        let value = value.parse().ok()?;
        Some(Self {
            standard,
            designation,
            diameter_mm,
            pitch: match unit {
                "/in" => ThreadPitch::PerInch(value),
                _ => ThreadPitch::Millimetres(value),
            },
            gauge_mm: fields.next()?.parse().unwrap_or(0.0),
        })
    }

    /// The thread with this diameter and pitch, mm, in the ISO metric profile.
    pub(crate) const fn free(diameter_mm: f64, pitch_mm: f64) -> Self {
        Self {
            standard: ThreadStandard::IsoFine,
            designation: FREE,
            diameter_mm,
            pitch: ThreadPitch::Millimetres(pitch_mm),
            gauge_mm: 0.0,
        }
    }

    /// The diameters outside or inside.
    pub fn profile(&self, is_inside: bool) -> ThreadProfile {
        let (d, pitch) = (self.diameter_mm, self.pitch.mm());
        let (pitch_diameter, blank, root, taper) = match self.standard {
            ThreadStandard::Bsp => {
                let height = 0.640_327 * pitch;
                let (crest, bottom) = (d, d - 2.0 * height);
                let sides = if is_inside {
                    (bottom, crest)
                } else {
                    (crest, bottom)
                };
                (d - height, sides.0, sides.1, 0.0)
            }
            ThreadStandard::Trapezoidal => {
                let clearance = trapezoidal_clearance(pitch);
                let sides = match is_inside {
                    true => (d - pitch, d + 2.0 * clearance),
                    false => (d, d - pitch - 2.0 * clearance),
                };
                (d - 0.5 * pitch, sides.0, sides.1, 0.0)
            }
            ThreadStandard::Npt => {
                let end = d - (0.05 * d + 1.1 * INCH_MM) * pitch / INCH_MM;
                let height = 0.8 * pitch;
                match is_inside {
                    true => {
                        let face = end + self.gauge_mm / 16.0;
                        (face, face - height, face + height, -1.0 / 16.0)
                    }
                    false => (end, end + height, end - height, 1.0 / 16.0),
                }
            }
            _ => {
                let triangle = sqrt(3.0) / 2.0 * pitch;
                let sides = match is_inside {
                    true => (d - 1.25 * triangle, d),
                    false => (d, d - 17.0 / 12.0 * triangle),
                };
                (d - 0.75 * triangle, sides.0, sides.1, 0.0)
            }
        };
        ThreadProfile {
            flank_angle: self.standard.flank_angle(),
            pitch_diameter,
            blank,
            root,
            taper,
        }
    }
}

/// Clearance at the crest of trapezoidal threads, mm.
fn trapezoidal_clearance(pitch: f64) -> f64 {
    match pitch {
        pitch if pitch < 2.0 => 0.15,
        pitch if pitch < 6.0 => 0.25,
        pitch if pitch < 14.0 => 0.5,
        _ => 1.0,
    }
}

/// All threads of the table.
pub fn thread_rows() -> impl Iterator<Item = ThreadRow> {
    TABLE.lines().skip(1).filter_map(ThreadRow::parse)
}

/// The index of the thread with this designation, in upper or lower case; `None` if the table
/// does not have it.
pub fn find_thread(designation: &str) -> Option<usize> {
    thread_rows().position(|row| row.designation.eq_ignore_ascii_case(designation))
}

/// The designation of a row; `FREE` without one.
pub(crate) fn designation(row: Option<usize>) -> &'static str {
    row.and_then(|row| thread_rows().nth(row))
        .map_or(FREE, |row| row.designation)
}

/// The table as text with tabs: designation, source, pitch, pitch diameter; crest, root and
/// height outside; hole, root and height inside; all in mm, at the front face.
pub fn thread_table_text() -> String {
    let mut text = String::from("thread\tsource\tP\td2\td\td3\th3\tD1\tD4\tH1\n");
    for row in thread_rows() {
        let (outside, inside) = (row.profile(false), row.profile(true));
        let numbers = [
            row.pitch.mm(),
            outside.pitch_diameter,
            outside.blank,
            outside.root,
            outside.depth(),
            inside.blank,
            inside.root,
            inside.depth(),
        ];
        let numbers = numbers.map(|it| Thousandths::round(it).to_string());
        let numbers = numbers.join("\t");
        text.push_str(&format!(
            "{}\t{}\t{numbers}\n",
            row.designation,
            row.standard.source()
        ));
    }
    text
}
