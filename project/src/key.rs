//! What names a value of the control, and where it stands in the folder.

use gsk_core::memory::Disk;
use gsk_core::plc::{Area, ByteAddress};
use gsk_core::program;
use gsk_core::units::Axis;

/// Whose parameters, offsets and pitch errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Set {
    /// Those in force.
    Control,
    /// Those saved on electronic disk N1.
    N1,
    /// On N2.
    N2,
    /// On N3.
    N3,
    /// On N4.
    N4,
}

impl Set {
    /// The electronic disks that can be saved on, with their names.
    pub const DISKS: [(Self, Disk, &'static str); 4] = [
        (Self::N1, Disk::N1, "N1"),
        (Self::N2, Disk::N2, "N2"),
        (Self::N3, Disk::N3, "N3"),
        (Self::N4, Disk::N4, "N4"),
    ];

    /// The name of its disk.
    pub fn disk(self) -> Option<&'static str> {
        let row = Self::DISKS.iter().find(|(set, ..)| *set == self);
        row.map(|(_, _, name)| *name)
    }
}

/// An option of the control: a row of the setting page, or macro B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Switch {
    /// The option of macro B.
    MacroB,
    /// 奇偶校检.
    Parity,
    /// ISO 代码.
    Iso,
    /// 英制编程.
    Inch,
    /// 自动序号.
    Numbering,
}

impl Switch {
    /// All of them, by their names in the file.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::MacroB, "macro-b"),
        (Self::Parity, "parity"),
        (Self::Iso, "iso"),
        (Self::Inch, "inch"),
        (Self::Numbering, "numbering"),
    ];
}

/// A column of the offset page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OffsetWord {
    /// X, mm, as the page counts it: a diameter, or a radius with 004.4 ORC = 1.
    X,
    /// Z, mm.
    Z,
    /// Nose radius, mm.
    R,
    /// Position of the imaginary tool nose, 0 to 9.
    T,
}

impl OffsetWord {
    /// All of them, by their names in the file.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::X, "X"),
        (Self::Z, "Z"),
        (Self::R, "R"),
        (Self::T, "T"),
    ];
}

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Count {
    /// Parts made, 0 to 9999.
    Parts,
    /// Time in cutting feed, ms.
    CuttingMs,
    /// Parts to be made, 0 to 9999; no line: 0.
    Required,
    /// Time with cycle start on, ms; no line: 0.
    StartedMs,
}

impl Count {
    /// All of them, by their names in the file.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Parts, "parts"),
        (Self::CuttingMs, "cutting-ms"),
        (Self::Required, "required"),
        (Self::StartedMs, "started-ms"),
    ];

    /// Whether it is left out where it is 0: older folders have none of it.
    pub const fn may_be_missing(self) -> bool {
        matches!(self, Self::Required | Self::StartedMs)
    }
}

/// What the panel keeps: brightness, and the setting of the graphic in thousandths of a
/// millimetre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PanelWord {
    /// Brightness of the LCD.
    Brightness,
    /// 坐标选择: on is ZX.
    Zx,
    /// 缩放比例, hundredths of a dot for a millimetre.
    Scale,
    /// 图形中心, X.
    CenterX,
    /// 图形中心, Z.
    CenterZ,
    /// X最大值.
    MaxX,
    /// Z最大值.
    MaxZ,
    /// X最小值.
    MinX,
    /// Z最小值.
    MinZ,
    /// Whether motion is recorded.
    Drawing,
}

impl PanelWord {
    /// All of them, by their names in the file.
    pub const ALL: [(Self, &'static str); 10] = [
        (Self::Brightness, "brightness"),
        (Self::Zx, "zx"),
        (Self::Scale, "scale"),
        (Self::CenterX, "center-x"),
        (Self::CenterZ, "center-z"),
        (Self::MaxX, "max-x"),
        (Self::MaxZ, "max-z"),
        (Self::MinX, "min-x"),
        (Self::MinZ, "min-z"),
        (Self::Drawing, "drawing"),
    ];
}

/// What names a value. They are in the order of the lines in the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// Which form of the folder it is.
    Format,
    /// The control model.
    Model,
    /// An option.
    Switch(Switch),
    /// The selected program.
    Selected,
    /// A parameter that only this model has.
    ModelParameter(u16),
    /// A data parameter, or a bit of a state parameter.
    Parameter(Set, u16, Option<u8>),
    /// A value of a tool offset.
    Offset(Set, u8, OffsetWord),
    /// A pitch error, µm.
    Pitch(Set, u8, Axis),
    /// A macro variable that lasts.
    Variable(u16),
    /// A counter.
    Count(Count),
    /// A value that the panel keeps.
    Panel(PanelWord),
    /// A value that the PLC keeps: K, D300 to D999, T80 to T99, C, DC, DT.
    Data(ByteAddress),
    /// The text of the ladder.
    Ladder,
    /// The text of a program.
    Program(u16),
    /// The text of the job of a program.
    Job(u16),
    /// The text of the machine file.
    Machine,
}

/// A file with a value a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    /// Format, model, options, selected program.
    Head,
    /// Parameters that only the model has.
    ModelParameters,
    /// Parameters.
    Parameters(Set),
    /// Tool offsets.
    Offsets(Set),
    /// Pitch errors.
    Pitch(Set),
    /// Macro variables.
    Variables,
    /// Counters.
    Counters,
    /// What the panel keeps.
    Panel,
    /// What the PLC keeps.
    Data,
}

/// The file that makes a folder a project.
pub(crate) const HEAD: &str = "project.gpr";
/// The ladder, as instruction list.
pub(crate) const LADDER: &str = "ladder/main.il";
/// The machine file.
pub(crate) const MACHINE: &str = "machine.ron";
const PARAMETERS: &str = "parameters.txt";
const OFFSETS: &str = "offsets.txt";
const PITCH: &str = "pitch.txt";
const PROGRAMS: &str = "programs/";

impl Table {
    /// Its file in the folder.
    pub fn path(self) -> String {
        let own = |set: Set, name: &str| match set.disk() {
            Some(disk) => format!("disks/{disk}/{name}"),
            None => name.to_owned(),
        };
        match self {
            Self::Head => HEAD.to_owned(),
            Self::ModelParameters => "model-parameters.txt".to_owned(),
            Self::Parameters(set) => own(set, PARAMETERS),
            Self::Offsets(set) => own(set, OFFSETS),
            Self::Pitch(set) => own(set, PITCH),
            Self::Variables => "variables.txt".to_owned(),
            Self::Counters => "counters.txt".to_owned(),
            Self::Panel => "panel.txt".to_owned(),
            Self::Data => "ladder/data.txt".to_owned(),
        }
    }

    /// All of them.
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Head,
            Self::ModelParameters,
            Self::Variables,
            Self::Counters,
            Self::Panel,
            Self::Data,
        ];
        let disks = Set::DISKS.iter().map(|(set, ..)| *set);
        for set in [Set::Control].into_iter().chain(disks) {
            all.extend([Self::Parameters(set), Self::Offsets(set), Self::Pitch(set)]);
        }
        all
    }

    /// The table of a file.
    pub(crate) fn of(path: &str) -> Option<Self> {
        Self::all().into_iter().find(|table| table.path() == path)
    }

    /// What is named so in this file, whether the control has it or not.
    pub(crate) fn key(self, name: &str) -> Option<Key> {
        match self {
            Self::Head => match name {
                "format" => Some(Key::Format),
                "model" => Some(Key::Model),
                "selected" => Some(Key::Selected),
                _ => word(&Switch::ALL, name).map(Key::Switch),
            },
            Self::ModelParameters => number(name).map(Key::ModelParameter),
            Self::Parameters(set) => match name.split_once('.') {
                None => Some(Key::Parameter(set, number(name)?, None)),
                Some((of, bit)) => {
                    let bit = number(bit).filter(|bit| *bit < 8)?;
                    Some(Key::Parameter(set, number(of)?, Some(bit as u8)))
                }
            },
            Self::Offsets(set) => {
                let (row, column) = name.split_once('.')?;
                let row = u8::try_from(number(row)?).ok()?;
                Some(Key::Offset(set, row, word(&OffsetWord::ALL, column)?))
            }
            Self::Pitch(set) => {
                let (point, axis) = name.split_once('.')?;
                let point = u8::try_from(number(point)?).ok()?;
                let axis = word(&[(Axis::X, "X"), (Axis::Z, "Z")], axis)?;
                Some(Key::Pitch(set, point, axis))
            }
            Self::Variables => number(name.strip_prefix('#')?).map(Key::Variable),
            Self::Counters => word(&Count::ALL, name).map(Key::Count),
            Self::Panel => word(&PanelWord::ALL, name).map(Key::Panel),
            Self::Data => {
                let at = name.find(|letter: char| letter.is_ascii_digit())?;
                let (letters, digits) = name.split_at(at);
                let areas = KEPT.iter().map(|(area, _)| *area);
                let area = areas.into_iter().find(|area| area.letter() == letters)?;
                Some(Key::Data(ByteAddress::new(area, number(digits)?)))
            }
        }
    }
}

/// The areas of the PLC that the battery keeps, each from this byte or entry on
/// (manual PLC-I 3).
pub(crate) const KEPT: [(Area, u16); 6] = [
    (Area::K, 0),
    (Area::D, 300),
    (Area::T, 80),
    (Area::C, 0),
    (Area::Dc, 0),
    (Area::Dt, 0),
];

fn word<T: Copy>(words: &[(T, &str)], name: &str) -> Option<T> {
    let found = words.iter().find(|(_, word)| *word == name);
    found.map(|(what, _)| *what)
}

pub(crate) fn name_of<T: Copy + PartialEq>(words: &[(T, &'static str)], what: T) -> &'static str {
    let found = words.iter().find(|(own, _)| *own == what);
    found.map_or("", |(_, word)| word)
}

/// Digits alone: no sign, no blank.
fn number(digits: &str) -> Option<u16> {
    let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}

/// The program number in a name like `O0001`.
fn program_number(name: &str) -> Option<u16> {
    let digits = name.strip_prefix('O').filter(|digits| digits.len() == 4)?;
    number(digits).filter(|number| program::RANGE.contains(number))
}

impl Key {
    /// The file that it has for itself: programs and other texts.
    pub fn file(self) -> Option<String> {
        match self {
            Self::Ladder => Some(LADDER.to_owned()),
            Self::Machine => Some(MACHINE.to_owned()),
            Self::Program(number) => Some(format!("{PROGRAMS}O{number:04}.CNC")),
            Self::Job(number) => Some(format!("{PROGRAMS}O{number:04}.job.ron")),
            _ => None,
        }
    }

    /// What has a file for itself.
    pub(crate) fn of_file(path: &str) -> Option<Self> {
        match path {
            LADDER => return Some(Self::Ladder),
            MACHINE => return Some(Self::Machine),
            _ => {}
        }
        let name = path.strip_prefix(PROGRAMS)?;
        match name.split_once('.')? {
            (name, "CNC") => program_number(name).map(Self::Program),
            (name, "job.ron") => program_number(name).map(Self::Job),
            _ => None,
        }
    }

    /// The file in which it has a line; none of what has a file for itself.
    pub fn table(self) -> Option<Table> {
        match self {
            Self::Format | Self::Model | Self::Switch(_) | Self::Selected => Some(Table::Head),
            Self::ModelParameter(_) => Some(Table::ModelParameters),
            Self::Parameter(set, ..) => Some(Table::Parameters(set)),
            Self::Offset(set, ..) => Some(Table::Offsets(set)),
            Self::Pitch(set, ..) => Some(Table::Pitch(set)),
            Self::Variable(_) => Some(Table::Variables),
            Self::Count(_) => Some(Table::Counters),
            Self::Panel(_) => Some(Table::Panel),
            Self::Data(_) => Some(Table::Data),
            Self::Ladder | Self::Program(_) | Self::Job(_) | Self::Machine => None,
        }
    }

    /// The file it stands in.
    pub fn path(self) -> String {
        match self.table() {
            Some(table) => table.path(),
            None => self.file().unwrap_or_default(),
        }
    }

    /// Its name in that file; of what has a file for itself the name of that.
    pub fn name(self) -> String {
        match self {
            Self::Format => "format".to_owned(),
            Self::Model => "model".to_owned(),
            Self::Switch(switch) => name_of(&Switch::ALL, switch).to_owned(),
            Self::Selected => "selected".to_owned(),
            Self::ModelParameter(number) | Self::Parameter(_, number, None) => {
                format!("{number:03}")
            }
            Self::Parameter(_, number, Some(bit)) => format!("{number:03}.{bit}"),
            Self::Offset(_, row, word) => {
                format!("{row:03}.{}", name_of(&OffsetWord::ALL, word))
            }
            Self::Pitch(_, point, Axis::X) => format!("{point:03}.X"),
            Self::Pitch(_, point, Axis::Z) => format!("{point:03}.Z"),
            Self::Variable(number) => format!("#{number}"),
            Self::Count(count) => name_of(&Count::ALL, count).to_owned(),
            Self::Panel(word) => name_of(&PanelWord::ALL, word).to_owned(),
            Self::Data(address) => address.to_string(),
            Self::Ladder | Self::Program(_) | Self::Job(_) | Self::Machine => {
                self.file().unwrap_or_default()
            }
        }
    }
}

/// A part of the control that can be taken over alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// The control model and the parameters that only it has.
    Model,
    /// The options.
    Settings,
    /// Parameters.
    Parameters,
    /// Tool offsets.
    Offsets,
    /// Pitch errors.
    Pitch,
    /// Macro variables.
    Variables,
    /// Counters.
    Counters,
    /// The electronic disks.
    Disks,
    /// What the panel keeps.
    Panel,
    /// Programs, and which of them is selected.
    Programs,
    /// The ladder with its messages, comments and start values.
    Ladder,
    /// What the PLC keeps.
    Data,
    /// The machine file.
    Machine,
    /// The jobs of programs.
    Jobs,
}

impl Section {
    /// All of them, by their words.
    pub const ALL: [(Self, &'static str); 14] = [
        (Self::Model, "model"),
        (Self::Settings, "settings"),
        (Self::Parameters, "parameters"),
        (Self::Offsets, "offsets"),
        (Self::Pitch, "pitch"),
        (Self::Variables, "variables"),
        (Self::Counters, "counters"),
        (Self::Disks, "disks"),
        (Self::Panel, "panel"),
        (Self::Programs, "programs"),
        (Self::Ladder, "ladder"),
        (Self::Data, "data"),
        (Self::Machine, "machine"),
        (Self::Jobs, "jobs"),
    ];

    /// Whether a control holds it; what it does not hold stands in the folder alone.
    pub const fn is_in_control(self) -> bool {
        !matches!(self, Self::Machine | Self::Jobs)
    }

    /// Its word.
    pub fn word(self) -> &'static str {
        name_of(&Self::ALL, self)
    }

    /// The section of a word.
    pub fn of_word(name: &str) -> Option<Self> {
        word(&Self::ALL, name)
    }

    /// Where a key belongs.
    pub const fn of(key: Key) -> Self {
        match key {
            Key::Format | Key::Model | Key::ModelParameter(_) => Self::Model,
            Key::Switch(_) => Self::Settings,
            Key::Selected | Key::Program(_) => Self::Programs,
            Key::Parameter(Set::Control, ..) => Self::Parameters,
            Key::Offset(Set::Control, ..) => Self::Offsets,
            Key::Pitch(Set::Control, ..) => Self::Pitch,
            Key::Parameter(..) | Key::Offset(..) | Key::Pitch(..) => Self::Disks,
            Key::Variable(_) => Self::Variables,
            Key::Count(_) => Self::Counters,
            Key::Panel(_) => Self::Panel,
            Key::Data(_) => Self::Data,
            Key::Ladder => Self::Ladder,
            Key::Job(_) => Self::Jobs,
            Key::Machine => Self::Machine,
        }
    }
}
