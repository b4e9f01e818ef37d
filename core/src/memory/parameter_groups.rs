//! Groups the parameters by function, from `assets/tables/parameter-groups.tsv` (decision
//! DATA-1).

use std::sync::LazyLock;

use gsk_messages::{Message, say};

use super::parameter_table::{ParameterRow, parameter_row};

const TABLE: &str = include_str!("../../../assets/tables/parameter-groups.tsv");

/// A group of parameters that serve the same function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ParameterGroup {
    /// The axes: their drives, gear ratios and directions.
    Axes,
    /// Parameters for speeds and accelerations of the axes.
    Speeds,
    /// Protection of machine and operator: limits, switches, door.
    Safety,
    /// Parameters for the spindle, its gears and its encoder.
    Spindle,
    /// Parameters for tool post, offsets and nose radius.
    Tools,
    /// Parameters for cutting threads.
    Threads,
    /// G and M codes and cycles in programs.
    Codes,
    /// Parameters for backlash compensation.
    Backlash,
    /// Parameters for pitch error compensation.
    Pitch,
    /// Parameters for machine zero and reference return.
    Zero,
    /// Parameters for chuck, tailstock, lubrication, M codes and inputs.
    Auxiliary,
    /// Parameters for editing, pages and keys.
    Display,
    /// Parameters for the serial port.
    Serial,
    /// Parameters for the state of the control after power-on.
    PowerOn,
    /// Parameter numbers that have no function.
    Reserved,
}

impl ParameterGroup {
    /// All groups, in the order of `parameter-groups.tsv`.
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

    /// The first field of the group's row in `parameter-groups.tsv`.
    const fn table_key(self) -> &'static str {
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

    /// Returns the name of the group for the operator.
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

    /// The data parameters and bits of state parameters in this group, by number.
    pub fn rows(self) -> &'static [&'static ParameterRow] {
        static GROUPS: LazyLock<Vec<(&str, Vec<&'static ParameterRow>)>> = LazyLock::new(|| {
            let lines = TABLE.lines().skip(1);
            lines
                .filter_map(|line| line.split_once('\t'))
                .map(|(key, members)| {
                    let members = members.split_whitespace();
                    (key, members.filter_map(parse_member).collect())
                })
                .collect()
        });
        let group = GROUPS.iter().find(|(key, _)| *key == self.table_key());
        group.map_or(&[], |(_, rows)| rows)
    }
}

/// Parses a parameter such as `022` or a bit such as `004.3`; `None` if it does not exist.
fn parse_member(written: &str) -> Option<&'static ParameterRow> {
    match written.split_once('.') {
        Some((number, bit)) => parameter_row(number.parse().ok()?, Some(bit.parse().ok()?)),
        None => parameter_row(written.parse().ok()?, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::parameter_rows;

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
        // An invalid member would be missing here.
        let members = TABLE.lines().skip(1).flat_map(|line| {
            let (_, members) = line.split_once('\t').unwrap();
            members.split_whitespace()
        });
        assert_eq!(members.count(), grouped.len());
        assert_eq!(TABLE.lines().count() - 1, ParameterGroup::ALL.len());
        // Named bits of a state parameter are members instead of the parameter.
        let has_bits = |number| {
            parameter_rows()
                .iter()
                .any(|it| it.number == number && it.bit.is_some())
        };
        for row in parameter_rows() {
            let times = grouped.iter().filter(|it| core::ptr::eq(**it, row)).count();
            let wanted = usize::from(row.bit.is_some() || !has_bits(row.number));
            assert_eq!(times, wanted, "{} {:?}", row.number, row.bit);
        }
    }
}
