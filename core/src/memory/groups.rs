//! The parameters by function, from `assets/tables/parameter-groups.tsv` (decision DATA-1).

use std::sync::LazyLock;

use gsk_messages::{Message, say};

use super::table::{ParameterRow, row};

const TABLE: &str = include_str!("../../../assets/tables/parameter-groups.tsv");

/// What parameters are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ParameterGroup {
    /// Axes, their drives, gear and directions.
    Axes,
    /// Speeds and accelerations.
    Speeds,
    /// What protects machine and operator.
    Safety,
    /// Spindle, gears, encoder.
    Spindle,
    /// Tool post, offsets, nose radius.
    Tools,
    /// Threads.
    Threads,
    /// Codes and cycles of programs.
    Codes,
    /// Backlash.
    Backlash,
    /// Pitch errors.
    Pitch,
    /// Machine zero.
    Zero,
    /// Chuck, tailstock, lubrication, M codes, inputs.
    Auxiliary,
    /// Editing, pages, keys.
    Display,
    /// The serial port.
    Serial,
    /// How the control is after power-on.
    PowerOn,
    /// Numbers without a function.
    Reserved,
}

impl ParameterGroup {
    /// All of them, as the table has them.
    pub const ALL: [Self; 15] = [
        Self::Axes,
        Self::Speeds,
        Self::Safety,
        Self::Spindle,
        Self::Tools,
        Self::Threads,
        Self::Codes,
        Self::Backlash,
        Self::Pitch,
        Self::Zero,
        Self::Auxiliary,
        Self::Display,
        Self::Serial,
        Self::PowerOn,
        Self::Reserved,
    ];

    /// How its row of the table begins.
    const fn key(self) -> &'static str {
        match self {
            Self::Axes => "axes",
            Self::Speeds => "speeds",
            Self::Safety => "safety",
            Self::Spindle => "spindle",
            Self::Tools => "tools",
            Self::Threads => "threads",
            Self::Codes => "codes",
            Self::Backlash => "backlash",
            Self::Pitch => "pitch",
            Self::Zero => "zero",
            Self::Auxiliary => "auxiliary",
            Self::Display => "display",
            Self::Serial => "serial",
            Self::PowerOn => "power-on",
            Self::Reserved => "reserved",
        }
    }

    /// Its name.
    pub fn name(self) -> Message {
        match self {
            Self::Axes => say::parameter_group_axes(),
            Self::Speeds => say::parameter_group_speeds(),
            Self::Safety => say::parameter_group_safety(),
            Self::Spindle => say::parameter_group_spindle(),
            Self::Tools => say::parameter_group_tools(),
            Self::Threads => say::parameter_group_threads(),
            Self::Codes => say::parameter_group_codes(),
            Self::Backlash => say::parameter_group_backlash(),
            Self::Pitch => say::parameter_group_pitch(),
            Self::Zero => say::parameter_group_zero(),
            Self::Auxiliary => say::parameter_group_auxiliary(),
            Self::Display => say::parameter_group_display(),
            Self::Serial => say::parameter_group_serial(),
            Self::PowerOn => say::parameter_group_power_on(),
            Self::Reserved => say::parameter_group_reserved(),
        }
    }

    /// Its data parameters and bits of state parameters, by number.
    pub fn rows(self) -> &'static [&'static ParameterRow] {
        static GROUPS: LazyLock<Vec<(&str, Vec<&'static ParameterRow>)>> = LazyLock::new(|| {
            let lines = TABLE.lines().skip(1);
            lines
                .filter_map(|line| line.split_once('\t'))
                .map(|(key, members)| {
                    let members = members.split_whitespace();
                    (key, members.filter_map(member).collect())
                })
                .collect()
        });
        let group = GROUPS.iter().find(|(key, _)| *key == self.key());
        group.map_or(&[], |(_, rows)| rows)
    }
}

/// `022`, `004.3`.
fn member(written: &str) -> Option<&'static ParameterRow> {
    match written.split_once('.') {
        Some((number, bit)) => row(number.parse().ok()?, Some(bit.parse().ok()?)),
        None => row(written.parse().ok()?, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::rows;

    #[test]
    fn every_parameter_has_one_function() {
        let mut grouped: Vec<&ParameterRow> = Vec::new();
        for group in ParameterGroup::ALL {
            assert!(!group.rows().is_empty(), "{group:?}");
            assert!(
                group.rows().is_sorted_by_key(|row| row.number),
                "{group:?} by number"
            );
            grouped.extend(group.rows());
        }
        // A member that is no parameter would be missing here.
        let members = TABLE.lines().skip(1).flat_map(|line| {
            let (_, members) = line.split_once('\t').unwrap();
            members.split_whitespace()
        });
        assert_eq!(members.count(), grouped.len());
        assert_eq!(TABLE.lines().count() - 1, ParameterGroup::ALL.len());
        // Of a state parameter with named bits these stand for it.
        let has_bits = |number| {
            rows()
                .iter()
                .any(|it| it.number == number && it.bit.is_some())
        };
        for row in rows() {
            let times = grouped.iter().filter(|it| core::ptr::eq(**it, row)).count();
            let wanted = usize::from(row.bit.is_some() || !has_bits(row.number));
            assert_eq!(times, wanted, "{} {:?}", row.number, row.bit);
        }
    }
}
