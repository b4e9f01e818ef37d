//! Keys: name each value of a project and map it to a file and a line name.

use gsk_core::memory::ElectronicDisk;
use gsk_core::plc::{Area, ByteAddress};
use gsk_core::program;
use gsk_core::units::Axis;

/// One of the sets of parameters, tool offsets and pitch errors that a control stores.
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
    /// The writable electronic disks with their names, for example `N1`.
    pub const DISKS: [(Self, ElectronicDisk, &'static str); 4] = [
        (Self::N1, ElectronicDisk::N1, "N1"),
        (Self::N2, ElectronicDisk::N2, "N2"),
        (Self::N3, ElectronicDisk::N3, "N3"),
        (Self::N4, ElectronicDisk::N4, "N4"),
    ];

    /// Returns the name of the set's electronic disk, for example `N1`; `None` for the set in
    /// use.
    pub fn disk_name(self) -> Option<&'static str> {
        let row = Self::DISKS.iter().find(|(set, ..)| *set == self);
        row.map(|(_, _, name)| *name)
    }
}

/// A switch of the setting page, or the macro B option, which projects store like one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SettingSwitch {
    /// Whether the control has macro B, which is an option.
    MacroB,
    /// 奇偶校检: whether received programs are checked for parity.
    Parity,
    /// ISO 代码: whether programs are transferred in ISO code, otherwise in EIA code.
    Iso,
    /// 英制编程: whether programs are in inches.
    Inch,
    /// 自动序号: whether the editor inserts sequence numbers.
    Numbering,
}

impl SettingSwitch {
    /// All switches with their names in `project.gpr`.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::MacroB, "macro-b"),
        (Self::Parity, "parity"),
        (Self::Iso, "iso"),
        (Self::Inch, "inch"),
        (Self::Numbering, "numbering"),
    ];
}

/// A column of the offset page, which stores one value of a tool offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OffsetColumn {
    /// X in mm as the offset page shows it: a diameter, or a radius with 004.4 ORC = 1.
    X,
    /// Z offset in mm.
    Z,
    /// Nose radius in mm.
    R,
    /// Position of the imaginary tool nose, 0 to 9.
    T,
}

impl OffsetColumn {
    /// All columns with their names in `offsets.txt`.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::X, "X"),
        (Self::Z, "Z"),
        (Self::R, "R"),
        (Self::T, "T"),
    ];
}

/// A counter that the control retains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectCounter {
    /// Number of machined parts, 0 to 9999.
    Parts,
    /// Time spent cutting, ms.
    CuttingMs,
    /// Number of required parts, 0 to 9999; 0 if the file has no line for it.
    Required,
    /// Time with cycle start on, ms; 0 if the file has no line for it.
    StartedMs,
}

impl ProjectCounter {
    /// All counters with their names in `counters.txt`.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Parts, "parts"),
        (Self::CuttingMs, "cutting-ms"),
        (Self::Required, "required"),
        (Self::StartedMs, "started-ms"),
    ];

    /// Returns whether the counter's line is omitted at 0. Folders of older versions lack
    /// these lines.
    pub const fn is_optional(self) -> bool {
        matches!(self, Self::Required | Self::StartedMs)
    }
}

/// A panel setting: LCD brightness or an item of the graphic page. Lengths of the graphic page
/// are in µm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PanelSetting {
    /// LCD brightness, 0 (darkest) to 15.
    Brightness,
    /// 坐标选择: plane of the graphic; `on` is ZX, `off` is XZ.
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
    /// Whether the graphic page is adding motion to its picture.
    Drawing,
}

impl PanelSetting {
    /// All settings with their names in `panel.txt`.
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

/// Names one value of a project. The order of keys is the order of the lines in the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectKey {
    /// Version of the folder format, in `project.gpr`.
    Format,
    /// The model of the control.
    Model,
    /// A switch of the setting page, or the macro B option.
    Setting(SettingSwitch),
    /// The number of the selected program.
    Selected,
    /// A parameter that only this model has, by its number.
    ModelParameter(u16),
    /// A data parameter, or a bit (0 to 7) of a state parameter: set, number, bit.
    Parameter(DataSet, u16, Option<u8>),
    /// A value of a tool offset: set, offset number, column.
    Offset(DataSet, u8, OffsetColumn),
    /// A pitch error in µm: set, point, axis.
    Pitch(DataSet, u8, Axis),
    /// The value of a retained macro variable, by its number.
    Variable(u16),
    /// The value of a counter.
    Counter(ProjectCounter),
    /// The value of a panel setting.
    Panel(PanelSetting),
    /// The value at a retained PLC address: K, D300 to D999, T80 to T99, C, DC, DT.
    Data(ByteAddress),
    /// The text of the ladder, as instruction list.
    Ladder,
    /// The text of a program, by its number.
    Program(u16),
    /// The text of the job of a program, by the program number.
    Job(u16),
    /// The text of the machine file.
    Machine,
}

/// A project file that has one value on each line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectTable {
    /// `project.gpr`: format version, model, setting switches, selected program.
    Head,
    /// `model-parameters.txt`: parameters that only this model has.
    ModelParameters,
    /// `parameters.txt`: parameters of the control or a disk.
    Parameters(DataSet),
    /// `offsets.txt`: tool offsets of the control or a disk.
    Offsets(DataSet),
    /// `pitch.txt`: pitch errors of the control or a disk.
    Pitch(DataSet),
    /// `variables.txt`: values of the macro variables.
    Variables,
    /// `counters.txt`: counts of parts and times.
    Counters,
    /// `panel.txt`: settings of panel and graphic page.
    Panel,
    /// `ladder/data.txt`: PLC data that are retained over power-off.
    Data,
}

/// The file by which a folder is recognized as a project.
pub(crate) const HEAD_FILE: &str = "project.gpr";
/// The file with the ladder as instruction list.
pub(crate) const LADDER_FILE: &str = "ladder/main.il";
pub(crate) const MACHINE_FILE: &str = "machine.ron";
const PARAMETERS_FILE: &str = "parameters.txt";
const OFFSETS_FILE: &str = "offsets.txt";
const PITCH_FILE: &str = "pitch.txt";
const PROGRAMS_FOLDER: &str = "programs/";

impl ProjectTable {
    /// Returns the path of this table's file in the project folder.
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

    /// Returns all tables, those of the electronic disks included.
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

    /// Returns the table whose file has this path; `None` if it is no table.
    pub(crate) fn from_path(path: &str) -> Option<Self> {
        Self::all().into_iter().find(|table| table.path() == path)
    }

    /// Returns the key of a line with this name in this file; `None` if the form is invalid.
    /// The key need not exist in the control.
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

/// Parses a number without sign and blanks; `None` if invalid.
fn parse_number(digits: &str) -> Option<u16> {
    let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}

/// Parses a program name like `O0001` to its number; `None` if invalid.
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

    /// Returns the key of a file that holds only one value; `None` if the path is not such a
    /// file.
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

    /// Returns the table that has a line for the key; `None` for a value that is stored in a
    /// separate file.
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

    /// Returns the path of the file that holds the key's value.
    pub fn path(self) -> String {
        match self.table() {
            Some(table) => table.path(),
            None => self.own_file().unwrap_or_default(),
        }
    }

    /// Returns the name of the key's line in the file; for a value in a separate file its
    /// path.
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

/// A group of project values that can be imported separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectSection {
    /// Section: the control model and the parameters that only it has.
    Model,
    /// Section: the switches of the setting page and the option of macro B.
    Settings,
    /// Section: the parameters that the control uses.
    Parameters,
    /// Section: the tool offsets that the control uses.
    Offsets,
    /// Section: the pitch errors that the control uses.
    Pitch,
    /// Section: the values of the macro variables.
    Variables,
    /// Section: the counters of parts and times.
    Counters,
    /// Section: parameters, offsets and pitch errors on the electronic disks.
    Disks,
    /// Section: LCD brightness and settings of the graphic page.
    Panel,
    /// Section: the programs, and the number of the selected one.
    Programs,
    /// Section: the ladder with its messages, comments and start values.
    Ladder,
    /// Section: the PLC data that are retained over power-off.
    Data,
    /// Section: the machine file, which describes the lathe.
    Machine,
    /// Section: the jobs of programs: blank and tools.
    Jobs,
}

impl ProjectSection {
    /// All sections with the words that name them on the command line.
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

    /// Returns whether a control stores this section. The others exist only in the folder.
    pub const fn is_in_control(self) -> bool {
        !matches!(self, Self::Machine | Self::Jobs)
    }

    /// Returns the word that names the section on the command line.
    pub fn word(self) -> &'static str {
        find_name(&Self::ALL, self)
    }

    /// Returns the section that a command line word names; `None` for an unknown word.
    pub fn from_word(name: &str) -> Option<Self> {
        find_by_name(&Self::ALL, name)
    }

    /// Returns the section to which a key's value belongs.
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
