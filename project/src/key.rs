//! Keys: name each value of a project and map it to a file and a line name.

use gsk_core::memory::ElectronicDisk;
use gsk_core::plc::{Area, ByteAddress};
use gsk_core::program;
use gsk_core::units::Axis;

/// Selects a set of parameters, tool offsets and pitch errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DataSet {
    /// The set that the control uses.
    Control,
    /// The set saved on electronic disk N1.
    N1,
    /// The set saved on electronic disk N2.
    N2,
    /// The set saved on electronic disk N3.
    N3,
    /// The set saved on electronic disk N4.
    N4,
}

impl DataSet {
    /// The writable electronic disks with their names.
    pub const DISKS: [(Self, ElectronicDisk, &'static str); 4] = [
        (Self::N1, ElectronicDisk::N1, "N1"),
        (Self::N2, ElectronicDisk::N2, "N2"),
        (Self::N3, ElectronicDisk::N3, "N3"),
        (Self::N4, ElectronicDisk::N4, "N4"),
    ];

    /// Returns the name of the electronic disk (`N1`); `None` for the set in use.
    pub fn disk_name(self) -> Option<&'static str> {
        let row = Self::DISKS.iter().find(|(set, ..)| *set == self);
        row.map(|(_, _, name)| *name)
    }
}

/// A switch of the setting page, or the option of macro B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SettingSwitch {
    /// Enables macro B.
    MacroB,
    /// 奇偶校检: parity check.
    Parity,
    /// ISO 代码: program transfer in ISO code, otherwise EIA.
    Iso,
    /// 英制编程: programs in inches.
    Inch,
    /// 自动序号: automatic sequence numbers.
    Numbering,
}

impl SettingSwitch {
    /// All switches with their names in the file.
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
pub enum OffsetColumn {
    /// X in mm as the offset page shows it: a diameter, or a radius with 004.4 ORC = 1.
    X,
    /// Z in mm.
    Z,
    /// Nose radius in mm.
    R,
    /// Position of the imaginary tool nose, 0 to 9.
    T,
}

impl OffsetColumn {
    /// All columns with their names in the file.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::X, "X"),
        (Self::Z, "Z"),
        (Self::R, "R"),
        (Self::T, "T"),
    ];
}

/// A counter of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectCounter {
    /// Machined parts, 0 to 9999.
    Parts,
    /// Cutting feed time, ms.
    CuttingMs,
    /// Required parts, 0 to 9999. Without a line: 0.
    Required,
    /// Time with cycle start on, ms. Without a line: 0.
    StartedMs,
}

impl ProjectCounter {
    /// All counters with their names in the file.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Parts, "parts"),
        (Self::CuttingMs, "cutting-ms"),
        (Self::Required, "required"),
        (Self::StartedMs, "started-ms"),
    ];

    /// Whether the line is omitted at 0. Folders of older versions lack these lines.
    pub const fn is_optional(self) -> bool {
        matches!(self, Self::Required | Self::StartedMs)
    }
}

/// A setting of the panel: LCD brightness or an item of the graphic page. Lengths of the
/// graphic page are in µm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PanelSetting {
    /// LCD brightness, in steps from 0.
    Brightness,
    /// 坐标选择: coordinate system; `on` is ZX.
    Zx,
    /// 缩放比例: scale, in hundredths of a dot per millimetre.
    Scale,
    /// 图形中心: X of the graphic centre, µm.
    CenterX,
    /// 图形中心: Z of the graphic centre, µm.
    CenterZ,
    /// X最大值: upper X limit of the graphic, µm.
    MaxX,
    /// Z最大值: upper Z limit of the graphic, µm.
    MaxZ,
    /// X最小值: lower X limit of the graphic, µm.
    MinX,
    /// Z最小值: lower Z limit of the graphic, µm.
    MinZ,
    /// Whether the graphic page records motion.
    Drawing,
}

impl PanelSetting {
    /// All settings with their names in the file.
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

/// Names one value of a project. The order is the order of the lines in the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectKey {
    /// Version of the folder format.
    Format,
    /// The control model.
    Model,
    /// A switch of the setting page, or the option of macro B.
    Setting(SettingSwitch),
    /// The selected program.
    Selected,
    /// A parameter that only this model has, by its number.
    ModelParameter(u16),
    /// A data parameter, or a bit (0 to 7) of a state parameter: set, number, bit.
    Parameter(DataSet, u16, Option<u8>),
    /// A value of a tool offset: set, offset number, column.
    Offset(DataSet, u8, OffsetColumn),
    /// A pitch error in µm: set, point, axis.
    Pitch(DataSet, u8, Axis),
    /// A retained macro variable, by its number.
    Variable(u16),
    /// A counter.
    Counter(ProjectCounter),
    /// A setting of the panel.
    Panel(PanelSetting),
    /// A retained PLC address: K, D300 to D999, T80 to T99, C, DC, DT.
    Data(ByteAddress),
    /// The text of the ladder.
    Ladder,
    /// The text of a program, by its number.
    Program(u16),
    /// The text of the job of a program, by the program number.
    Job(u16),
    /// The text of the machine file.
    Machine,
}

/// A project file with one value per line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectTable {
    /// `project.gpr`: format, model, settings, selected program.
    Head,
    /// `model-parameters.txt`: parameters that only this model has.
    ModelParameters,
    /// `parameters.txt`: parameters of a set.
    Parameters(DataSet),
    /// `offsets.txt`: tool offsets of a set.
    Offsets(DataSet),
    /// `pitch.txt`: pitch errors of a set.
    Pitch(DataSet),
    /// `variables.txt`: macro variables.
    Variables,
    /// `counters.txt`: counters.
    Counters,
    /// `panel.txt`: settings of the panel.
    Panel,
    /// `ladder/data.txt`: retained PLC data.
    Data,
}

/// A folder with this file is a project.
pub(crate) const HEAD_FILE: &str = "project.gpr";
/// The ladder as instruction list.
pub(crate) const LADDER_FILE: &str = "ladder/main.il";
pub(crate) const MACHINE_FILE: &str = "machine.ron";
const PARAMETERS_FILE: &str = "parameters.txt";
const OFFSETS_FILE: &str = "offsets.txt";
const PITCH_FILE: &str = "pitch.txt";
const PROGRAMS_FOLDER: &str = "programs/";

impl ProjectTable {
    /// Returns the path of the file in the folder.
    pub fn path(self) -> String {
        let in_set_folder = |set: DataSet, name: &str| match set.disk_name() {
            Some(disk) => format!("disks/{disk}/{name}"),
            None => name.to_owned(),
        };
        match self {
            Self::Head => HEAD_FILE.to_owned(),
            Self::ModelParameters => "model-parameters.txt".to_owned(),
            Self::Parameters(set) => in_set_folder(set, PARAMETERS_FILE),
            Self::Offsets(set) => in_set_folder(set, OFFSETS_FILE),
            Self::Pitch(set) => in_set_folder(set, PITCH_FILE),
            Self::Variables => "variables.txt".to_owned(),
            Self::Counters => "counters.txt".to_owned(),
            Self::Panel => "panel.txt".to_owned(),
            Self::Data => "ladder/data.txt".to_owned(),
        }
    }

    /// Lists all tables, those of the electronic disks included.
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Head,
            Self::ModelParameters,
            Self::Variables,
            Self::Counters,
            Self::Panel,
            Self::Data,
        ];
        let disks = DataSet::DISKS.iter().map(|(set, ..)| *set);
        for set in [DataSet::Control].into_iter().chain(disks) {
            all.extend([Self::Parameters(set), Self::Offsets(set), Self::Pitch(set)]);
        }
        all
    }

    /// Finds the table of a path.
    pub(crate) fn from_path(path: &str) -> Option<Self> {
        Self::all().into_iter().find(|table| table.path() == path)
    }

    /// Parses the name of a line in this file. The key need not exist in the control.
    pub(crate) fn parse_key(self, name: &str) -> Option<ProjectKey> {
        match self {
            Self::Head => match name {
                "format" => Some(ProjectKey::Format),
                "model" => Some(ProjectKey::Model),
                "selected" => Some(ProjectKey::Selected),
                _ => find_by_name(&SettingSwitch::ALL, name).map(ProjectKey::Setting),
            },
            Self::ModelParameters => parse_number(name).map(ProjectKey::ModelParameter),
            Self::Parameters(set) => match name.split_once('.') {
                None => Some(ProjectKey::Parameter(set, parse_number(name)?, None)),
                Some((parameter, bit)) => {
                    let bit = parse_number(bit).filter(|bit| *bit < 8)?;
                    Some(ProjectKey::Parameter(
                        set,
                        parse_number(parameter)?,
                        Some(bit as u8),
                    ))
                }
            },
            Self::Offsets(set) => {
                let (row, column) = name.split_once('.')?;
                let row = u8::try_from(parse_number(row)?).ok()?;
                Some(ProjectKey::Offset(
                    set,
                    row,
                    find_by_name(&OffsetColumn::ALL, column)?,
                ))
            }
            Self::Pitch(set) => {
                let (point, axis) = name.split_once('.')?;
                let point = u8::try_from(parse_number(point)?).ok()?;
                let axis = find_by_name(&[(Axis::X, "X"), (Axis::Z, "Z")], axis)?;
                Some(ProjectKey::Pitch(set, point, axis))
            }
            Self::Variables => parse_number(name.strip_prefix('#')?).map(ProjectKey::Variable),
            Self::Counters => find_by_name(&ProjectCounter::ALL, name).map(ProjectKey::Counter),
            Self::Panel => find_by_name(&PanelSetting::ALL, name).map(ProjectKey::Panel),
            Self::Data => {
                let at = name.find(|letter: char| letter.is_ascii_digit())?;
                let (letters, digits) = name.split_at(at);
                let areas = RETAINED_AREAS.iter().map(|(area, _)| *area);
                let area = areas.into_iter().find(|area| area.letter() == letters)?;
                Some(ProjectKey::Data(ByteAddress::new(
                    area,
                    parse_number(digits)?,
                )))
            }
        }
    }
}

/// The PLC areas that the battery retains, each from this byte or entry on (manual PLC-I 3).
pub(crate) const RETAINED_AREAS: [(Area, u16); 6] = [
    (Area::K, 0),
    (Area::D, 300),
    (Area::T, 80),
    (Area::C, 0),
    (Area::Dc, 0),
    (Area::Dt, 0),
];

fn find_by_name<T: Copy>(words: &[(T, &str)], name: &str) -> Option<T> {
    let found = words.iter().find(|(_, word)| *word == name);
    found.map(|(item, _)| *item)
}

pub(crate) fn find_name<T: Copy + PartialEq>(words: &[(T, &'static str)], item: T) -> &'static str {
    let found = words.iter().find(|(known, _)| *known == item);
    found.map_or("", |(_, word)| word)
}

/// Parses a number without sign and blanks.
fn parse_number(digits: &str) -> Option<u16> {
    let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}

/// Parses a program name like `O0001`.
fn parse_program_number(name: &str) -> Option<u16> {
    let digits = name.strip_prefix('O').filter(|digits| digits.len() == 4)?;
    parse_number(digits).filter(|number| program::PROGRAM_NUMBERS.contains(number))
}

impl ProjectKey {
    /// Returns the path of the file that holds only this value (program, job, ladder, machine
    /// file); `None` for a line of a table.
    pub fn own_file(self) -> Option<String> {
        match self {
            Self::Ladder => Some(LADDER_FILE.to_owned()),
            Self::Machine => Some(MACHINE_FILE.to_owned()),
            Self::Program(number) => Some(format!("{PROGRAMS_FOLDER}O{number:04}.CNC")),
            Self::Job(number) => Some(format!("{PROGRAMS_FOLDER}O{number:04}.job.ron")),
            _ => None,
        }
    }

    /// Finds the key of a file that holds only one value.
    pub(crate) fn from_path(path: &str) -> Option<Self> {
        match path {
            LADDER_FILE => return Some(Self::Ladder),
            MACHINE_FILE => return Some(Self::Machine),
            _ => {}
        }
        let name = path.strip_prefix(PROGRAMS_FOLDER)?;
        match name.split_once('.')? {
            (name, "CNC") => parse_program_number(name).map(Self::Program),
            (name, "job.ron") => parse_program_number(name).map(Self::Job),
            _ => None,
        }
    }

    /// Returns the table that has a line for the key; `None` for a value that is stored in a separate file.
    pub fn table(self) -> Option<ProjectTable> {
        match self {
            Self::Format | Self::Model | Self::Setting(_) | Self::Selected => {
                Some(ProjectTable::Head)
            }
            Self::ModelParameter(_) => Some(ProjectTable::ModelParameters),
            Self::Parameter(set, ..) => Some(ProjectTable::Parameters(set)),
            Self::Offset(set, ..) => Some(ProjectTable::Offsets(set)),
            Self::Pitch(set, ..) => Some(ProjectTable::Pitch(set)),
            Self::Variable(_) => Some(ProjectTable::Variables),
            Self::Counter(_) => Some(ProjectTable::Counters),
            Self::Panel(_) => Some(ProjectTable::Panel),
            Self::Data(_) => Some(ProjectTable::Data),
            Self::Ladder | Self::Program(_) | Self::Job(_) | Self::Machine => None,
        }
    }

    /// Returns the path of the file that holds the value.
    pub fn path(self) -> String {
        match self.table() {
            Some(table) => table.path(),
            None => self.own_file().unwrap_or_default(),
        }
    }

    /// Returns the name of the line in the file; for a value in a separate file its path.
    pub fn name(self) -> String {
        match self {
            Self::Format => "format".to_owned(),
            Self::Model => "model".to_owned(),
            Self::Setting(switch) => find_name(&SettingSwitch::ALL, switch).to_owned(),
            Self::Selected => "selected".to_owned(),
            Self::ModelParameter(number) | Self::Parameter(_, number, None) => {
                format!("{number:03}")
            }
            Self::Parameter(_, number, Some(bit)) => format!("{number:03}.{bit}"),
            Self::Offset(_, row, word) => {
                format!("{row:03}.{}", find_name(&OffsetColumn::ALL, word))
            }
            Self::Pitch(_, point, Axis::X) => format!("{point:03}.X"),
            Self::Pitch(_, point, Axis::Z) => format!("{point:03}.Z"),
            Self::Variable(number) => format!("#{number}"),
            Self::Counter(count) => find_name(&ProjectCounter::ALL, count).to_owned(),
            Self::Panel(word) => find_name(&PanelSetting::ALL, word).to_owned(),
            Self::Data(address) => address.to_string(),
            Self::Ladder | Self::Program(_) | Self::Job(_) | Self::Machine => {
                self.own_file().unwrap_or_default()
            }
        }
    }
}

/// A group of values that can be imported separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectSection {
    /// The control model and the parameters that only it has.
    Model,
    /// The switches of the setting page and the option of macro B.
    Settings,
    /// Parameters in use.
    Parameters,
    /// Tool offsets in use.
    Offsets,
    /// Pitch errors in use.
    Pitch,
    /// Macro variables.
    Variables,
    /// Counters.
    Counters,
    /// The electronic disks.
    Disks,
    /// Settings of the panel.
    Panel,
    /// Programs and the selection of one.
    Programs,
    /// The ladder with its messages, comments and start values.
    Ladder,
    /// Retained PLC data.
    Data,
    /// The machine file.
    Machine,
    /// The jobs of programs.
    Jobs,
}

impl ProjectSection {
    /// All sections with their words on the command line.
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

    /// Whether a control stores this section. The others exist only in the folder.
    pub const fn is_in_control(self) -> bool {
        !matches!(self, Self::Machine | Self::Jobs)
    }

    /// Returns the word of the section on the command line.
    pub fn word(self) -> &'static str {
        find_name(&Self::ALL, self)
    }

    /// Finds the section of a command line word.
    pub fn from_word(name: &str) -> Option<Self> {
        find_by_name(&Self::ALL, name)
    }

    /// Returns the section that a key belongs to.
    pub const fn from_key(key: ProjectKey) -> Self {
        match key {
            ProjectKey::Format | ProjectKey::Model | ProjectKey::ModelParameter(_) => Self::Model,
            ProjectKey::Setting(_) => Self::Settings,
            ProjectKey::Selected | ProjectKey::Program(_) => Self::Programs,
            ProjectKey::Parameter(DataSet::Control, ..) => Self::Parameters,
            ProjectKey::Offset(DataSet::Control, ..) => Self::Offsets,
            ProjectKey::Pitch(DataSet::Control, ..) => Self::Pitch,
            ProjectKey::Parameter(..) | ProjectKey::Offset(..) | ProjectKey::Pitch(..) => {
                Self::Disks
            }
            ProjectKey::Variable(_) => Self::Variables,
            ProjectKey::Counter(_) => Self::Counters,
            ProjectKey::Panel(_) => Self::Panel,
            ProjectKey::Data(_) => Self::Data,
            ProjectKey::Ladder => Self::Ladder,
            ProjectKey::Job(_) => Self::Jobs,
            ProjectKey::Machine => Self::Machine,
        }
    }
}
