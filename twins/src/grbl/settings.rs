//! The `$` settings of a board: numbers, formats and values. Most settings of FluidNC are
//! items of its configuration tree.

use std::collections::BTreeMap;

use super::Variant;
use super::config::FluidConfig;

/// Numbers of the settings that are reported without decimals. All others are reported with three.
const WHOLE_NUMBER_SETTINGS: [u16; 19] = [
    0, 1, 2, 3, 4, 5, 6, 10, 13, 20, 21, 22, 23, 26, 30, 31, 32, 33, 38,
];

/// Number and value of each default setting.
const DEFAULTS: [(u16, f64); 34] = [
    (0, 10.0),
    (1, 25.0),
    (2, 0.0),
    (3, 0.0),
    (4, 0.0),
    (5, 0.0),
    (6, 0.0),
    (10, 1.0),
    (11, 0.010),
    (12, 0.002),
    (13, 0.0),
    (20, 0.0),
    (21, 0.0),
    (22, 0.0),
    (23, 0.0),
    (24, 25.0),
    (25, 500.0),
    (26, 250.0),
    (27, 1.0),
    (30, 1000.0),
    (31, 0.0),
    (32, 0.0),
    (100, 250.0),
    (101, 250.0),
    (102, 250.0),
    (110, 500.0),
    (111, 500.0),
    (112, 500.0),
    (120, 10.0),
    (121, 10.0),
    (122, 10.0),
    (130, 200.0),
    (131, 200.0),
    (132, 200.0),
];

/// Number and value of the numbered settings that FluidNC has: report mask and inches.
const FLUIDNC_SETTINGS: [(u16, f64); 2] = [(10, 1.0), (13, 0.0)];

/// The settings that a board stores. They survive a reset.
#[derive(Clone, Debug, PartialEq)]
pub struct GrblSettings {
    numbers: BTreeMap<u16, f64>,
    /// Configuration tree of FluidNC; `None` for other boards.
    tree: Option<FluidConfig>,
}

impl Default for GrblSettings {
    fn default() -> Self {
        Self {
            numbers: DEFAULTS.into_iter().collect(),
            tree: None,
        }
    }
}

impl GrblSettings {
    /// Returns the default settings of grblHAL with spindle synchronization and an encoder
    /// of `pulses` per turn.
    pub fn with_encoder(pulses: u16) -> Self {
        let mut settings = Self::default();
        let more = [(38, f64::from(pulses)), (90, 1.0), (91, 0.01), (92, 0.0)];
        settings.numbers.extend(more);
        settings
    }

    /// Returns the settings of a FluidNC board, as its owner has configured it.
    pub fn with_config_tree() -> Self {
        Self {
            numbers: FLUIDNC_SETTINGS.into_iter().collect(),
            tree: Some(FluidConfig::default()),
        }
    }

    /// Adapts the settings to a firmware: FluidNC gets the default tree if they have none.
    pub(super) fn for_variant(self, variant: Variant) -> Self {
        if variant == Variant::FluidNc && self.tree.is_none() {
            Self::with_config_tree()
        } else {
            self
        }
    }

    pub(super) const fn tree(&self) -> Option<&FluidConfig> {
        self.tree.as_ref()
    }

    pub(super) const fn tree_mut(&mut self) -> Option<&mut FluidConfig> {
        self.tree.as_mut()
    }

    /// Returns the value of a setting by its number; 0 if it is missing.
    pub fn value(&self, number: u16) -> f64 {
        let in_tree = || {
            self.tree
                .as_ref()
                .and_then(|tree| tree.grbl_setting(number))
        };
        let known = self.numbers.get(&number).copied();
        known.or_else(in_tree).unwrap_or(0.0)
    }

    /// Returns whether the setting `number` is on, that is, not 0.
    pub fn is_on(&self, number: u16) -> bool {
        self.value(number) != 0.0
    }

    /// Sets the setting `number`. Returns error 3 for an unknown setting, 4 for a negative
    /// value and 6 for step pulses below 3 µs.
    pub fn set(&mut self, number: u16, value: f64) -> Result<(), u8> {
        let setting = self.numbers.get_mut(&number).ok_or(3_u8)?;
        if value < 0.0 {
            return Err(4);
        }
        if number == 0 && value < 3.0 {
            return Err(6);
        }
        *setting = if WHOLE_NUMBER_SETTINGS.contains(&number) {
            value.trunc()
        } else {
            value
        };
        Ok(())
    }

    /// Returns the X, Y, Z values of a group of settings: 100 pulses/mm, 110 mm/min, 120
    /// mm/s², 130 mm of travel.
    pub fn axis_values(&self, group: u16) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.value(group + axis))
    }

    /// Returns all settings as lines, the answer to `$$`.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.numbers.iter().map(|(number, value)| {
            if WHOLE_NUMBER_SETTINGS.contains(number) {
                format!("${number}={value:.0}\r\n")
            } else {
                format!("${number}={value:.3}\r\n")
            }
        })
    }
}
