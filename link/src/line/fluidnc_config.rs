//! The settings of FluidNC: a tree of named items. `$CD` reports all as one text; a line
//! like `$/axes/x/steps_per_mm=400` changes one until power-off.

use super::super::SettingDifference;
use super::required::{Setting, SettingDeviation, figure};

/// Greatest number of items that the link stores; further ones are ignored.
const MAX_ITEMS: usize = 2000;
/// Nesting depth of sections from which on a line is ignored.
const MAX_DEPTH: usize = 12;
/// Number that the link gives to settings that let the board start motion without a command; Grbl
/// does not have them.
const OWN_MOTION: u16 = 1000;
/// Number that the link gives to the setting for the kinematics of the axes, which Grbl does not
/// have.
const KINEMATICS: u16 = 1001;

/// The rule by which the required value of an item of FluidNC follows from the value of Grbl's
/// setting.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ItemKind {
    /// The value of the item is the number that is the value of the setting.
    Figure,
    /// The item must be `true` unless the value of Grbl's setting is 0.
    Switch,
    /// The item is `false` if the bit of the axis in the value of the setting is set.
    NotBit,
    /// The item is a pin, which has `:low` if the bit of the axis in the value of the setting is
    /// set.
    Pin,
    /// The item is a list of pairs `speed=percent` whose last speed is the value of the setting.
    /// The list may be missing.
    Scale,
    /// The item must have an empty value, whatever Grbl's setting is.
    Empty,
    /// The item is a pin that must not be wired.
    Unwired,
    /// The item is a section that must exist.
    Section,
}

/// Whether a written configuration item takes effect at once or after a restart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EffectTime {
    AtOnce,
    /// The item takes effect when the board starts. Writing it has no effect: at the start the
    /// board reads its file again.
    AtStart,
}

use EffectTime::{AtOnce, AtStart};
use ItemKind::{Empty, Figure, NotBit, Pin, Scale, Section, Switch, Unwired};

/// Grbl's number and FluidNC's path of each setting: `?` stands for each axis, `*` for any
/// name. The levels of enable outputs and limit inputs ($4, $5) are missing: they depend
/// on the circuits of the board, which its owner has configured.
const ITEMS: [(u16, &str, ItemKind, EffectTime); 33] = [
    (0, "stepping/pulse_us", Figure, AtStart),
    (1, "stepping/idle_ms", Figure, AtOnce),
    (2, "axes/?/motor0/*/step_pin", Pin, AtStart),
    (3, "axes/?/motor0/*/direction_pin", Pin, AtStart),
    (11, "junction_deviation_mm", Figure, AtOnce),
    (13, "report_inches", Switch, AtOnce),
    (20, "axes/?/soft_limits", Switch, AtOnce),
    (21, "axes/?/motor0/hard_limits", Switch, AtOnce),
    (22, "start/must_home", Switch, AtOnce),
    (23, "axes/?/homing/positive_direction", NotBit, AtOnce),
    (24, "axes/?/homing/feed_mm_per_min", Figure, AtOnce),
    (25, "axes/?/homing/seek_mm_per_min", Figure, AtOnce),
    (26, "axes/?/homing/settle_ms", Figure, AtOnce),
    (27, "axes/?/motor0/pulloff_mm", Figure, AtOnce),
    (30, "*/speed_map", Scale, AtStart),
    (100, "axes/?/steps_per_mm", Figure, AtOnce),
    (110, "axes/?/max_rate_mm_per_min", Figure, AtOnce),
    (120, "axes/?/acceleration_mm_per_sec2", Figure, AtOnce),
    (OWN_MOTION, "parking/enable", Switch, AtOnce),
    (OWN_MOTION, "macros/startup_line0", Empty, AtStart),
    (OWN_MOTION, "macros/startup_line1", Empty, AtStart),
    (OWN_MOTION, "macros/after_homing", Empty, AtStart),
    (OWN_MOTION, "macros/after_reset", Empty, AtStart),
    (OWN_MOTION, "macros/after_unlock", Empty, AtStart),
    (OWN_MOTION, "control/safety_door_pin", Unwired, AtStart),
    (OWN_MOTION, "control/feed_hold_pin", Unwired, AtStart),
    (OWN_MOTION, "control/cycle_start_pin", Unwired, AtStart),
    (OWN_MOTION, "control/homing_button_pin", Unwired, AtStart),
    (OWN_MOTION, "control/macro0_pin", Unwired, AtStart),
    (OWN_MOTION, "control/macro1_pin", Unwired, AtStart),
    (OWN_MOTION, "control/macro2_pin", Unwired, AtStart),
    (OWN_MOTION, "control/macro3_pin", Unwired, AtStart),
    (KINEMATICS, "kinematics/Cartesian", Section, AtStart),
];

/// The letter of each axis, and the index that is its bit in a mask and its offset in the numbers
/// of settings from 100 on.
const AXES: [(&str, u16); 2] = [("x", 0), ("z", 2)];

/// The items of FluidNC's configuration that a board has reported.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FluidNcConfig {
    items: Vec<(String, String)>,
    /// Names of the sections that enclose the next line, from the outermost.
    sections: Vec<String>,
}

impl FluidNcConfig {
    /// Adds a line of the answer to `$CD` to the items; skips invalid lines.
    pub(super) fn take(&mut self, line: &str) {
        let indented = line.len() - line.trim_start_matches(' ').len();
        let Some((name, value)) = line.trim().split_once(':') else {
            return;
        };
        let depth = indented / 2;
        let fits = depth <= self.sections.len() && depth < MAX_DEPTH;
        if indented % 2 == 1 || !fits || self.items.len() >= MAX_ITEMS {
            return;
        }
        self.sections.truncate(depth);
        self.sections.push(name.to_owned());
        let value = value.trim().trim_matches('\'').to_owned();
        self.items.push((self.sections.join("/"), value));
    }

    /// Returns the value of an item, which is empty for a section; `None` if the item is
    /// missing.
    pub(super) fn value(&self, path: &str) -> Option<&str> {
        self.find(path).map(|(_, value)| value)
    }

    fn find(&self, path: &str) -> Option<(&str, &str)> {
        let found = self.items.iter().find(|(item, _)| fits(item, path))?;
        Some((&found.0, &found.1))
    }

    /// Returns the items that differ from the required settings, each with the line that corrects
    /// it, if a line can.
    pub(super) fn deviations(&self, settings: &[Setting]) -> Vec<SettingDeviation> {
        let mut deviations = Vec::new();
        for (number, path, kind, acts) in ITEMS {
            let axes = if path.contains('?') {
                &AXES[..]
            } else {
                &AXES[..1]
            };
            for (letter, index) in axes {
                let number = number + if number >= 100 { *index } else { 0 };
                let setting = settings.iter().find(|setting| setting.number == number);
                let wanted = setting.map_or(0.0, |setting| setting.value);
                let path = path.replace('?', letter);
                let deviation = self.deviation(number, &path, kind, wanted, *index);
                deviations.extend(deviation.map(|difference| {
                    SettingDeviation {
                        line: (acts == AtOnce)
                            .then(|| format!("$/{}={}", difference.name, difference.wanted)),
                        difference,
                    }
                }));
            }
        }
        deviations
    }

    fn deviation(
        &self,
        number: u16,
        path: &str,
        kind: ItemKind,
        wanted: f64,
        bit: u16,
    ) -> Option<SettingDifference> {
        let item = self.find(path);
        let is_set = wanted as u32 >> bit & 1 == 1;
        let value = item.map(|(_, value)| value);
        let (is_met, wanted) = match kind {
            Figure => {
                let reported = value.and_then(|value| value.parse().ok());
                let setting = Setting {
                    number,
                    value: wanted,
                };
                (
                    reported.is_some_and(|reported| setting.is_met_by(reported)),
                    figure(wanted),
                )
            }
            Switch | NotBit => {
                let on = if kind == Switch {
                    wanted != 0.0
                } else {
                    !is_set
                };
                (
                    value == Some(if on { "true" } else { "false" }),
                    on.to_string(),
                )
            }
            Pin => {
                let low = value.is_some_and(|pin| pin.to_lowercase().contains(":low"));
                let wanted = if is_set { ":low" } else { "not :low" };
                (item.is_some() && low == is_set, wanted.to_owned())
            }
            Scale => {
                let last = value
                    .and_then(|pairs| pairs.rsplit(' ').next())
                    .unwrap_or("None");
                let speed = last
                    .split_once('=')
                    .and_then(|(speed, _)| speed.parse().ok());
                (
                    last == "None" || speed == Some(wanted),
                    format!("…{wanted:.0}=100%"),
                )
            }
            Empty => (value.is_none_or(str::is_empty), "(empty)".to_owned()),
            Unwired => (value.is_none_or(|pin| pin == "NO_PIN"), "NO_PIN".to_owned()),
            Section => (item.is_some(), "there".to_owned()),
        };
        (!is_met).then(|| SettingDifference {
            number,
            name: item.map_or(path, |(path, _)| path).to_owned(),
            board: value.map(str::to_owned),
            wanted,
        })
    }
}

/// Whether the path of an item matches a pattern in which `*` stands for any one name.
fn fits(path: &str, pattern: &str) -> bool {
    let mut names = path.split('/');
    pattern.split('/').all(|wanted| {
        names
            .next()
            .is_some_and(|name| wanted == "*" || name == wanted)
    }) && names.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LinkConfig;
    use crate::drives::{AxisRates, Drives};
    use crate::line::RequiredSettings;
    use gsk_units::PerAxis;

    /// An answer to `$CD`: two spaces for each level, quotes around a value with a colon, an empty
    /// line after some sections.
    const CONFIG_DUMP: &str = "\
board: None
name: lathe
stepping: 
  engine: RMT
  idle_ms: 255
  pulse_us: 10

kinematics: 
  Cartesian: 

axes: 
  x: 
    steps_per_mm: 400.000000
    homing: 
      cycle: 1
      positive_direction: false
    motor0: 
      hard_limits: true
      pulloff_mm: 1.000000
      stepstick: 
        step_pin: gpio.12
        direction_pin: 'gpio.14:low'
        disable_pin: NO_PIN

  y: 
    steps_per_mm: 80.000000
    motor0: 
      null_motor: 

macros: 
  startup_line0: 
  after_reset: $SD/Run=home.nc
10V: 
  speed_map: 0=0.00% 3000=100.00%

planner_blocks: 16
";

    fn parsed(text: &str) -> FluidNcConfig {
        let mut items = FluidNcConfig::default();
        text.lines().for_each(|line| items.take(line));
        items
    }

    #[test]
    fn items_are_found_by_their_path() {
        let items = parsed(CONFIG_DUMP);
        for (path, value) in [
            ("board", "None"),
            ("stepping/pulse_us", "10"),
            ("axes/x/steps_per_mm", "400.000000"),
            ("axes/y/steps_per_mm", "80.000000"),
            ("axes/x/homing/cycle", "1"),
            ("axes/x/motor0/*/direction_pin", "gpio.14:low"),
            ("*/speed_map", "0=0.00% 3000=100.00%"),
            ("kinematics/Cartesian", ""),
            ("planner_blocks", "16"),
        ] {
            assert_eq!(items.value(path), Some(value), "{path}");
        }
        for path in [
            "x/steps_per_mm",
            "axes/z/steps_per_mm",
            "axes/*",
            "axes/x/motor0/step_pin",
        ] {
            assert_eq!(
                items.value(path).filter(|value| !value.is_empty()),
                None,
                "{path}"
            );
        }
    }

    #[test]
    fn a_line_with_a_wrong_indent_is_skipped() {
        // Two levels deeper than the line above, or half a level.
        for line in [
            "    steps_per_mm: 400",
            " steps_per_mm: 400",
            "steps_per_mm 400",
        ] {
            let items = parsed(&format!("axes: \n{line}\n"));
            assert_eq!(items.items.len(), 1, "{line}: {items:?}");
        }
        let endless = "  ".repeat(MAX_DEPTH + 3) + "a: 1";
        assert_eq!(parsed(&endless), FluidNcConfig::default());
    }

    #[test]
    fn differing_items_come_with_the_line_that_corrects_them() {
        // X has half the pulse weight of Z: the control counts diameters.
        let drives = Drives {
            pulse_weight: PerAxis::new(0.0025, 0.005),
            rates: PerAxis::new(
                AxisRates::new(3800.0, 100.0, 8000.0),
                AxisRates::new(7600.0, 100.0, 8000.0),
            ),
        };
        let config: LinkConfig = ron::from_str("(x: (invert_direction: true))").unwrap();
        let required = RequiredSettings::new(&drives, &config);
        let deviations = parsed(CONFIG_DUMP).deviations(&required.settings);
        let of = |name: &str| {
            let mut all = deviations.iter();
            let found = all.find(|one| one.difference.name == name);
            found.map(|one| {
                let SettingDifference { board, wanted, .. } = one.difference.clone();
                (board.unwrap_or_default(), wanted, one.line.clone())
            })
        };
        let differs = |board: &str, wanted: &str, line: Option<&str>| {
            Some((board.to_owned(), wanted.to_owned(), line.map(str::to_owned)))
        };
        // Right values.
        for path in [
            "axes/x/steps_per_mm",
            "axes/x/motor0/stepstick/direction_pin",
            "axes/x/motor0/stepstick/step_pin",
            "axes/x/motor0/hard_limits",
            "stepping/pulse_us",
            "macros/startup_line0",
            "kinematics/Cartesian",
        ] {
            assert_eq!(of(path), None, "{path}");
        }
        assert_eq!(
            of("axes/x/homing/positive_direction"),
            differs(
                "false",
                "true",
                Some("$/axes/x/homing/positive_direction=true")
            ),
        );
        // An axis that the board did not report.
        assert_eq!(
            of("axes/z/steps_per_mm"),
            differs("", "200", Some("$/axes/z/steps_per_mm=200")),
        );
        // Items that only the owner can change.
        assert_eq!(
            of("axes/z/motor0/*/direction_pin"),
            differs("", "not :low", None)
        );
        assert_eq!(
            of("10V/speed_map"),
            differs("0=0.00% 3000=100.00%", "…1000=100%", None),
        );
        assert_eq!(
            of("macros/after_reset"),
            differs("$SD/Run=home.nc", "(empty)", None),
        );
    }
}
