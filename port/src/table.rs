//! The table of foreign codes: the sets of codes that have them, what they become here, and
//! what the reader of a ported program should know. The porter and the manual page use it.

use gsk_messages::{Language, Message, say};

use crate::dialect::CodeSet;

/// The rule by which the porter converts a G or M code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CodeRule {
    /// The code stays, because it means the same on this control.
    Keep,
    /// The code is removed, because this control always behaves so or does not need it.
    Remove,
    /// The code is removed, and the report names the difference.
    RemoveNoted,
    /// The code is refused, because it has no equivalent.
    Refuse,
    /// The code is replaced by the code in the column `becomes`, which means the same.
    Rename,
    /// The code selects lengths in inches.
    Inch,
    /// The code selects lengths in millimetres.
    Metric,
    /// The code selects absolute words: X and Z are positions.
    Absolute,
    /// The code selects incremental words: X and Z are distances.
    Incremental,
    /// The code selects X as a diameter.
    Diameter,
    /// The code selects X as a radius.
    Radius,
    /// The code selects I and K as positions of the arc's centre.
    AbsoluteCenters,
    /// The code selects I and K as distances from the start of the arc to its centre.
    RelativeCenters,
    /// The code selects feed per minute.
    PerMinute,
    /// The code selects feed per revolution.
    PerRevolution,
    /// A code of group 01 that moves the axes: rapid, line or arc.
    Motion,
    /// The code commands a dwell.
    Dwell,
    /// The code returns the axes to the reference point.
    Home,
    /// The code returns the axes to a further reference point.
    SecondHome,
    /// The code moves in machine coordinates.
    MachineCoordinates,
    /// The code selects a coordinate system.
    WorkOffset,
    /// The code sets the coordinates or the maximum spindle speed.
    SetCoordinates,
    /// The code cuts a thread in one pass.
    Thread,
    /// Taps a thread on the axis and returns (G33.1).
    RigidTap,
    /// The code cuts a thread with a variable lead.
    VariableThread,
    /// A roughing cycle along a profile (G71–G73).
    Rough,
    /// The finishing cycle (G70).
    Finish,
    /// A peck drilling or grooving cycle (G74, G75).
    Peck,
    /// A thread cycle of several passes (G76).
    ManyPassThread,
    /// A turning cycle (G90 on this control).
    Turn,
    /// A thread cycle of one pass (G92 on this control).
    ThreadTurn,
    /// A facing cycle (G94 on this control).
    Face,
    /// The code selects constant surface speed.
    SurfaceSpeed,
    /// A drilling cycle (G81–G85).
    Drill,
    /// The code switches nose radius compensation.
    Compensation,
    /// A macro call, or an operation of macro A.
    Macro,
    /// The code is an optional stop.
    OptionalStop,
    /// The code changes the tool (M06).
    ToolChange,
    /// The code calls a subprogram in another program.
    Call,
    /// The code calls a subprogram within the same program.
    LocalCall,
    /// The code switches on the run-out of threads.
    RunOut,
    /// The code switches off the run-out of threads.
    NoRunOut,
}

/// A row of the code table: foreign codes with the rule by which the porter converts them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForeignCodeRow {
    /// Letter of the codes: `G` or `M`.
    pub letter: u8,
    /// Numbers of the codes in tenths: G92.1 is 921.
    pub codes: &'static [i64],
    /// Code sets in which the codes have this meaning.
    pub sets: &'static [CodeSet],
    /// How the porter converts the codes.
    pub rule: CodeRule,
    /// The code of this control that replaces them; empty for codes that are removed or refused.
    pub becomes: &'static str,
    /// Message about the difference, for the user; `None` if there is nothing to note.
    pub note: Option<fn() -> Message>,
}

impl ForeignCodeRow {
    /// Returns the codes as written, such as `G54 G55`, for the table in the documentation.
    pub fn written_codes(&self) -> String {
        let letter = char::from(self.letter);
        let written = |code: &i64| match code % 10 {
            0 => format!("{letter}{:02}", code / 10),
            tenth => format!("{letter}{}.{tenth}", code / 10),
        };
        self.codes.iter().map(written).collect::<Vec<_>>().join(" ")
    }
}

use CodeSet::{FanucA, FanucB, Haas, LinuxCnc, Mach3};

const ALL: &[CodeSet] = &[FanucA, FanucB, Haas, Mach3, LinuxCnc];
const TYPE_A: &[CodeSet] = &[FanucA, Haas];
const FANUC: &[CodeSet] = &[FanucA, FanucB];
const LATHE: &[CodeSet] = &[FanucA, FanucB, Haas];
const RS274: &[CodeSet] = &[Mach3, LinuxCnc];
const NOT_A: &[CodeSet] = &[FanucB, Mach3, LinuxCnc];
const B: &[CodeSet] = &[FanucB];

const fn row(
    letter: u8,
    codes: &'static [i64],
    sets: &'static [CodeSet],
    rule: CodeRule,
    becomes: &'static str,
    note: Option<fn() -> Message>,
) -> ForeignCodeRow {
    ForeignCodeRow {
        letter,
        codes,
        sets,
        rule,
        becomes,
        note,
    }
}

/// All codes that the porter knows. For each code and set the first matching row is valid.
#[rustfmt::skip] // One row a line.
pub(crate) static CODES: &[ForeignCodeRow] = &[
    row(b'G', &[0, 10, 20, 30], ALL, CodeRule::Motion, "G00 G01 G02 G03", Some(say::ported_note_corner)),
    row(b'G', &[40], ALL, CodeRule::Dwell, "G04 P_ X_", Some(say::ported_note_dwell)),
    row(b'G', &[70], &[LinuxCnc], CodeRule::Diameter, "", Some(say::ported_note_diameter)),
    row(b'G', &[80], &[LinuxCnc], CodeRule::Radius, "", Some(say::ported_note_radius)),
    row(b'G', &[90, 610, 611], ALL, CodeRule::RemoveNoted, "", Some(say::ported_note_exact_stop)),
    row(b'G', &[640, 1030, 1870], ALL, CodeRule::Remove, "", Some(say::ported_note_blending)),
    row(b'G', &[100, 110], ALL, CodeRule::Refuse, "", Some(say::ported_note_data_input)),
    row(b'G', &[170, 180], ALL, CodeRule::Remove, "", Some(say::ported_note_plane)),
    row(b'G', &[190], ALL, CodeRule::Refuse, "", Some(say::ported_note_milling)),
    row(b'G', &[200], ALL, CodeRule::Inch, "", Some(say::ported_note_inch)),
    row(b'G', &[210], ALL, CodeRule::Metric, "", Some(say::ported_note_metric)),
    row(b'G', &[700], &[Mach3], CodeRule::Inch, "", Some(say::ported_note_inch)),
    row(b'G', &[710], &[Mach3], CodeRule::Metric, "", Some(say::ported_note_metric)),
    row(b'G', &[280], ALL, CodeRule::Home, "G28 U_ W_", Some(say::ported_note_home)),
    row(b'G', &[300], ALL, CodeRule::SecondHome, "G28 U_ W_", Some(say::ported_note_second_home)),
    row(b'G', &[310, 360, 370, 382, 383], ALL, CodeRule::Refuse, "", Some(say::ported_note_probe)),
    row(b'G', &[320], LATHE, CodeRule::Thread, "G32", Some(say::ported_note_lead)),
    row(b'G', &[330], NOT_A, CodeRule::Thread, "G32", Some(say::ported_note_thread_number)),
    row(b'G', &[331], &[LinuxCnc], CodeRule::RigidTap, "G33", Some(say::ported_note_rigid_tap)),
    row(b'G', &[340], LATHE, CodeRule::VariableThread, "G34 R_", Some(say::ported_note_variable_lead)),
    row(b'G', &[400, 410, 420], ALL, CodeRule::Compensation, "G40 G41 G42", Some(say::ported_note_compensation)),
    row(b'G', &[430, 490], ALL, CodeRule::Remove, "", Some(say::ported_note_tool_length)),
    row(b'G', &[500], LATHE, CodeRule::SetCoordinates, "G50", None),
    row(b'G', &[920], NOT_A, CodeRule::SetCoordinates, "G50", Some(say::ported_note_coordinates)),
    row(b'G', &[500], RS274, CodeRule::Remove, "", Some(say::ported_note_cancel)),
    row(b'G', &[690, 502], ALL, CodeRule::Remove, "", Some(say::ported_note_cancel)),
    row(b'G', &[921, 922], RS274, CodeRule::Remove, "", Some(say::ported_note_cancel)),
    row(b'G', &[510, 680, 512, 1070, 1120, 1121], ALL, CodeRule::Refuse, "", Some(say::ported_note_milling)),
    row(b'G', &[520], ALL, CodeRule::Refuse, "", Some(say::ported_note_local_zero)),
    row(b'G', &[530], ALL, CodeRule::MachineCoordinates, "G28 U0 W0", Some(say::ported_note_machine_coordinates)),
    row(b'G', &[540, 550, 560, 570, 580, 590, 541, 1540, 591, 592, 593], ALL, CodeRule::WorkOffset, "", Some(say::ported_note_work_offset)),
    row(b'G', &[650], LATHE, CodeRule::Macro, "G65 H_", Some(say::ported_note_macro)),
    row(b'G', &[660, 670], LATHE, CodeRule::Refuse, "", Some(say::ported_note_macro)),
    row(b'G', &[700], LATHE, CodeRule::Finish, "G70 P_ Q_", None),
    row(b'G', &[710, 720], LATHE, CodeRule::Rough, "G71 U_ R_ / G72 W_ R_", Some(say::ported_note_rough)),
    row(b'G', &[730], LATHE, CodeRule::Rough, "G73 U_ W_ R_", Some(say::ported_note_pattern)),
    row(b'G', &[740, 750], LATHE, CodeRule::Peck, "G74 G75 R_ P_ Q_", Some(say::ported_note_peck)),
    row(b'G', &[760], ALL, CodeRule::ManyPassThread, "G76 P_ Q_ R_", Some(say::ported_note_thread_cycle)),
    row(b'G', &[900], TYPE_A, CodeRule::Turn, "G90 R_", Some(say::ported_note_taper)),
    row(b'G', &[770], B, CodeRule::Turn, "G90 R_", Some(say::ported_note_taper)),
    row(b'G', &[920], TYPE_A, CodeRule::ThreadTurn, "G92 R_", Some(say::ported_note_thread_taper)),
    row(b'G', &[780], B, CodeRule::ThreadTurn, "G92 R_", Some(say::ported_note_thread_taper)),
    row(b'G', &[940], TYPE_A, CodeRule::Face, "G94 R_", Some(say::ported_note_face_taper)),
    row(b'G', &[790], B, CodeRule::Face, "G94 R_", Some(say::ported_note_face_taper)),
    row(b'G', &[800], ALL, CodeRule::Remove, "", Some(say::ported_note_drill_off)),
    row(b'G', &[810, 820, 830, 840, 850], ALL, CodeRule::Drill, "G00 G01 G33", Some(say::ported_note_drill)),
    row(b'G', &[860, 870, 880, 890], ALL, CodeRule::Refuse, "", Some(say::ported_note_drill_refused)),
    row(b'G', &[730], RS274, CodeRule::Drill, "G00 G01", Some(say::ported_note_drill)),
    row(b'G', &[900], NOT_A, CodeRule::Absolute, "", Some(say::ported_note_absolute)),
    row(b'G', &[910], NOT_A, CodeRule::Incremental, "U_ W_", Some(say::ported_note_incremental)),
    row(b'G', &[901], RS274, CodeRule::AbsoluteCenters, "I_ K_", Some(say::ported_note_centers)),
    row(b'G', &[911], RS274, CodeRule::RelativeCenters, "", None),
    row(b'G', &[930], RS274, CodeRule::Refuse, "", Some(say::ported_note_inverse_time)),
    row(b'G', &[940], NOT_A, CodeRule::PerMinute, "G98", None),
    row(b'G', &[950], NOT_A, CodeRule::PerRevolution, "G99", None),
    row(b'G', &[980], TYPE_A, CodeRule::PerMinute, "G98", None),
    row(b'G', &[990], TYPE_A, CodeRule::PerRevolution, "G99", Some(say::ported_note_first_feed)),
    row(b'G', &[980, 990], NOT_A, CodeRule::Remove, "", Some(say::ported_note_return_level)),
    row(b'G', &[960, 970], ALL, CodeRule::SurfaceSpeed, "G96 G97", Some(say::ported_note_surface_speed)),
    row(b'M', &[0, 30, 50, 80, 90, 300, 990], ALL, CodeRule::Keep, "", None),
    row(b'M', &[40], ALL, CodeRule::Keep, "M05 M04", Some(say::ported_note_reverse)),
    row(b'M', &[10], ALL, CodeRule::OptionalStop, "/ M00", Some(say::ported_note_optional_stop)),
    row(b'M', &[20], ALL, CodeRule::Rename, "M30", None),
    row(b'M', &[60], ALL, CodeRule::ToolChange, "T0101", Some(say::ported_note_tool)),
    row(b'M', &[70, 880], ALL, CodeRule::Rename, "M08", Some(say::ported_note_coolant)),
    row(b'M', &[890], LATHE, CodeRule::Rename, "M09", Some(say::ported_note_coolant)),
    row(b'M', &[170], ALL, CodeRule::Rename, "M99", None),
    row(b'M', &[980], ALL, CodeRule::Call, "M98 P_", Some(say::ported_note_call)),
    row(b'M', &[970], &[Haas], CodeRule::LocalCall, "M98 P_", Some(say::ported_note_local_call)),
    row(b'M', &[230], LATHE, CodeRule::RunOut, "", Some(say::ported_note_run_out)),
    row(b'M', &[240], LATHE, CodeRule::NoRunOut, "G92 J0 K0", Some(say::ported_note_run_out)),
    row(b'M', &[410, 420], LATHE, CodeRule::Keep, "", Some(say::ported_note_gear)),
    row(b'M', &[100], &[Haas], CodeRule::Rename, "M12", Some(say::ported_note_chuck)),
    row(b'M', &[110], &[Haas], CodeRule::Rename, "M13", Some(say::ported_note_chuck)),
    row(b'M', &[680], FANUC, CodeRule::Rename, "M12", Some(say::ported_note_chuck)),
    row(b'M', &[690], FANUC, CodeRule::Rename, "M13", Some(say::ported_note_chuck)),
    row(b'M', &[210], &[Haas], CodeRule::Rename, "M10", Some(say::ported_note_tailstock)),
    row(b'M', &[220], &[Haas], CodeRule::Rename, "M11", Some(say::ported_note_tailstock)),
    row(b'M', &[310, 330, 360, 370, 830, 840, 850, 860], &[Haas], CodeRule::RemoveNoted, "", Some(say::ported_note_accessory)),
    row(b'M', &[480, 490], RS274, CodeRule::Remove, "", Some(say::ported_note_override)),
];

/// Finds the row of a code (tenths: G92 is 920) in a code set; `None` for codes that the table
/// lacks.
pub(crate) fn find_row(letter: u8, code: i64, set: CodeSet) -> Option<&'static ForeignCodeRow> {
    CODES
        .iter()
        .find(|row| row.letter == letter && row.codes.contains(&code) && row.sets.contains(&set))
}

/// A table row for a foreign word other than G and M.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WordRow {
    /// The foreign word, as written in a program.
    pub foreign: &'static str,
    /// The word of this control that replaces it.
    pub becomes: &'static str,
    /// Message about the difference, for the user.
    pub note: fn() -> Message,
}

const fn word(foreign: &'static str, becomes: &'static str, note: fn() -> Message) -> WordRow {
    WordRow {
        foreign,
        becomes,
        note,
    }
}

/// The words that are written differently, for the table in the documentation.
pub(crate) static WORDS: &[WordRow] = &[
    word("X1500 Z-200", "X1.5 Z-0.2", say::ported_note_increments),
    word("F30 E1.5", "F0.3 F1.5", say::ported_note_feed_increments),
    word("N10050", "N50", say::ported_note_long_sequence),
    word(
        "O60761 :0145",
        "O0761 O0145",
        say::ported_note_program_number,
    ),
    word("T1 T101", "T0101", say::ported_note_tool),
    word("; //", "( )", say::ported_note_comment),
    word("#100 IF GOTO WHILE", REFUSED, say::ported_note_macro),
    word("o100 sub call repeat", "M98 P_", say::ported_note_o_word),
    word("A", "X_ Z_", say::ported_note_angle),
    word("Y0 D1 H1", "", say::ported_note_no_effect),
    word("B C V Y", REFUSED, say::ported_note_axis),
];

/// Mark in the printed table for a code or word without an equivalent.
const REFUSED: &str = "✗";

/// Returns the whole table as Markdown, for the documentation and the command line.
pub fn code_table(language: Language) -> String {
    let text = |message: Message| message.text(language);
    let mut out = format!(
        "| {} | {} | {} | {} |\n|---|---|---|---|\n",
        text(say::ported_codes_title()),
        text(say::ported_in_sets()),
        text(say::ported_becomes()),
        text(say::ported_note()),
    );
    let code = |written: &str| match written {
        "" => text(say::ported_removed()),
        REFUSED => REFUSED.to_owned(),
        _ => format!("`{written}`"),
    };
    let mut push = |foreign: &str, sets: &str, becomes: &str, note: String| {
        out.push_str(&format!(
            "| `{foreign}` | {sets} | {} | {note} |\n",
            code(becomes)
        ));
    };
    for row in CODES {
        let names: Vec<&str> = row.sets.iter().map(|set| set.name()).collect();
        let sets = match row.sets.len() == ALL.len() {
            true => text(say::ported_in_all()),
            false => names.join(", "),
        };
        let note = row.note.map_or_else(String::new, |note| text(note()));
        let becomes = match row.rule {
            CodeRule::Refuse => REFUSED,
            _ => row.becomes,
        };
        push(&row.written_codes(), &sets, becomes, note);
    }
    for row in WORDS {
        let sets = text(say::ported_in_all());
        push(row.foreign, &sets, row.becomes, text((row.note)()));
    }
    out
}
