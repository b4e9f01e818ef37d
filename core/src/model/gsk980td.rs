//! The record of the GSK980TD: table 3-7 and chapter I-3.3 of its manual. It is not a file in
//! `assets/models/`, so that a start need not parse one; the files of the other models omit
//! what they have in common with it.

use std::collections::BTreeMap;

use super::conventions::{Conventions, Increments, MacroForm, ToolForm, WorkPlane, XMeasure};
use super::program_capacity::ProgramCapacity;
use super::record::{MFunction, ModelRecord};
use super::{GCode, MCode, ModelId};

/// The meanings of the G codes.
const G_CODES: [(u8, GCode); 28] = [
    (0, GCode::Rapid),
    (1, GCode::Line),
    (2, GCode::ArcClockwise),
    (3, GCode::ArcCounterclockwise),
    (4, GCode::Dwell),
    (28, GCode::Reference),
    (32, GCode::Thread),
    (33, GCode::Tapping),
    (34, GCode::VariableThread),
    (40, GCode::NoseOff),
    (41, GCode::NoseLeft),
    (42, GCode::NoseRight),
    (50, GCode::Coordinates),
    (65, GCode::MacroCommand),
    (70, GCode::Finishing),
    (71, GCode::TurningRough),
    (72, GCode::FacingRough),
    (73, GCode::Pattern),
    (74, GCode::FacePecking),
    (75, GCode::Grooving),
    (76, GCode::CompoundThread),
    (90, GCode::TurningCycle),
    (92, GCode::ThreadCycle),
    (94, GCode::FacingCycle),
    (96, GCode::SurfaceSpeed),
    (97, GCode::SpindleSpeed),
    (98, GCode::FeedPerMinute),
    (99, GCode::FeedPerRevolution),
];

/// The functions of the M codes.
const M_CODES: [(u8, MCode); 19] = [
    (0, MCode::Stop),
    (3, MCode::SpindleForward),
    (4, MCode::SpindleReverse),
    (5, MCode::SpindleStop),
    (8, MCode::CoolantOn),
    (9, MCode::CoolantOff),
    (10, MCode::TailstockForward),
    (11, MCode::TailstockBack),
    (12, MCode::ChuckClamp),
    (13, MCode::ChuckRelease),
    (30, MCode::End),
    (32, MCode::LubricationOn),
    (33, MCode::LubricationOff),
    (41, MCode::Gear1),
    (42, MCode::Gear2),
    (43, MCode::Gear3),
    (44, MCode::Gear4),
    (98, MCode::Call),
    (99, MCode::Return),
];

/// The modal groups of the G codes.
const GROUPS: [&[u8]; 4] = [
    &[0, 1, 2, 3, 32, 33, 34, 90, 92, 94],
    &[96, 97],
    &[98, 99],
    &[40, 41, 42],
];

/// The record of the GSK980TD.
impl Default for ModelRecord {
    fn default() -> Self {
        let functions =
            M_CODES.map(|(number, meaning)| (number, MFunction::without_outputs(meaning)));
        Self {
            id: ModelId::Gsk980td,
            program_name: "O0001".to_owned(),
            capacity: ProgramCapacity::default(),
            alarm_letter: None,
            least_rapid_override: None,
            tool_digits: 4,
            offsets_by_shift: false,
            n_after_g: false,
            own_variables: false,
            first_input: 0,
            contacts: None,
            key_edges: BTreeMap::new(),
            followers: Vec::new(),
            followed: Vec::new(),
            teaches: false,
            last_sequence: 9999,
            last_program: 9999,
            word_limits: BTreeMap::new(),
            dwell_limits: None,
            delivered: BTreeMap::new(),
            ranges: BTreeMap::new(),
            greatest_coordinate: 9_999_999,
            addresses: String::new(),
            argument_addresses: String::new(),
            conventions: conventions(),
            g: BTreeMap::from(G_CODES),
            g_decided: Vec::new(),
            ladder_m: None,
            m_calls: None,
            m_macros: None,
            m: BTreeMap::from(functions),
            m_decided: Vec::new(),
            g_table: Vec::new(),
        }
    }
}

fn conventions() -> Conventions {
    Conventions {
        x: XMeasure::Diameter,
        increments: Increments::Letters,
        plane: WorkPlane::Zx,
        tool: ToolForm::ToolAndOffset(4),
        macros: MacroForm::A,
        first_feed: None,
        greatest_feed: 8000,
        limits_speed_by_coordinates: true,
        counts_calls_by_l: false,
        groups: GROUPS.map(<[u8]>::to_vec).to_vec(),
    }
}
