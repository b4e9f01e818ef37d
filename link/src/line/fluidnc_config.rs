//! The settings of FluidNC: named items in a tree, told as one text (`$CD`), written one
//! by one for as long as the board has power (`$/axes/x/steps_per_mm=400`).

use super::super::SettingDifference;
use super::required::{Setting, SettingDeviation, figure};

/// What lies beyond is not kept: no board tells so many items, nor nests them so deep.
const MAX_ITEMS: usize = 2000;
const MAX_DEPTH: usize = 12;
/// What no number of Grbl stands for: motion that the board makes by itself, and how its
/// axes hang together.
const OWN_MOTION: u16 = 1000;
const KINEMATICS: u16 = 1001;

/// How an item follows from the setting of the same meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ItemKind {
    /// The same figure.
    Figure,
    /// `true` for all figures but 0.
    Switch,
    /// `false` where the bit of the axis is set.
    NotBit,
    /// A pin, `:low` where the bit of the axis is set.
    Pin,
    /// Pairs of speed and share; the last has this speed. A board without speeds has none.
    Scale,
    /// There is nothing.
    Empty,
    /// A pin that is not wired.
    Unwired,
    /// There is this section.
    Section,
}

/// When an item acts that is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EffectTime {
    AtOnce,
    /// When the board starts; by then it has read its own file again.
    AtStart,
}

use EffectTime::{AtOnce, AtStart};
use ItemKind::{Empty, Figure, NotBit, Pin, Scale, Section, Switch, Unwired};

/// Setting of the same meaning and path: `?` is one axis after the other, `*` any name.
/// Not here are the levels of enable outputs and limit inputs ($4, $5): they follow from
/// the circuits of the board, which its owner has described.
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

/// An axis among those of the board: its letter and its place, which is the bit of a mask
/// and what its numbers are larger by.
const AXES: [(&str, u16); 2] = [("x", 0), ("z", 2)];

/// What a board has reported of its items.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FluidNcConfig {
    items: Vec<(String, String)>,
    /// Names of the sections around the next line.
    sections: Vec<String>,
}

impl FluidNcConfig {
    /// Takes a line of the text in; what is none is left out.
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

    /// The value of an item; empty for a section.
    pub(super) fn value(&self, path: &str) -> Option<&str> {
        self.find(path).map(|(_, value)| value)
    }

    fn find(&self, path: &str) -> Option<(&str, &str)> {
        let found = self.items.iter().find(|(item, _)| fits(item, path))?;
        Some((&found.0, &found.1))
    }

    /// What is not as it must be.
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

/// Whether a path is the one that is looked for, in which `*` stands for one name.
fn fits(path: &str, looked_for: &str) -> bool {
    let mut names = path.split('/');
    looked_for.split('/').all(|wanted| {
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

    /// As `$CD` writes it: two blanks a level, quotes around a colon, a blank line behind
    /// some sections.
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
    fn a_line_that_lost_a_blank_is_no_item_of_another_section() {
        // Nested deeper than anything around it, or by half a level.
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
    fn what_differs_is_named_with_the_line_that_mends_it() {
        // A gear of 1/5: X counts diameters.
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
        // As they must be.
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
        // Nothing told of Z.
        assert_eq!(
            of("axes/z/steps_per_mm"),
            differs("", "200", Some("$/axes/z/steps_per_mm=200")),
        );
        // For the owner.
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
