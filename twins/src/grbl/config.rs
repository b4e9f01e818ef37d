//! The configuration of a FluidNC board, a tree of named items. Startup reads the file;
//! `$/path=value` changes only the memory.

use core::fmt::Write;

/// Paths and values of the default configuration in listing order: an example for a lathe. A
/// path that ends with a slash is a section without items.
const DEFAULTS: &[(&str, &str)] = &[
    ("board", "Breakout"),
    ("name", "Lathe"),
    ("meta", ""),
    ("stepping/engine", "RMT"),
    ("stepping/idle_ms", "255"),
    ("stepping/pulse_us", "10"),
    ("stepping/dir_delay_us", "1"),
    ("stepping/disable_delay_us", "0"),
    ("stepping/segments", "12"),
    ("spi/miso_pin", "gpio.19"),
    ("spi/mosi_pin", "gpio.23"),
    ("spi/sck_pin", "gpio.18"),
    ("sdcard/cs_pin", "gpio.5"),
    ("sdcard/card_detect_pin", "NO_PIN"),
    ("sdcard/frequency_hz", "8000000"),
    ("kinematics/Cartesian/", ""),
    ("axes/shared_stepper_disable_pin", "gpio.13:low"),
    ("axes/shared_stepper_reset_pin", "NO_PIN"),
    ("axes/homing_runs", "2"),
    ("axes/x/steps_per_mm", "80.000000"),
    ("axes/x/max_rate_mm_per_min", "5000.000000"),
    ("axes/x/acceleration_mm_per_sec2", "100.000000"),
    ("axes/x/max_travel_mm", "300.000000"),
    ("axes/x/soft_limits", "false"),
    ("axes/x/idle_disable", "true"),
    ("axes/x/homing/cycle", "1"),
    ("axes/x/homing/allow_single_axis", "true"),
    ("axes/x/homing/positive_direction", "true"),
    ("axes/x/homing/mpos_mm", "0.000000"),
    ("axes/x/homing/feed_mm_per_min", "100.000000"),
    ("axes/x/homing/seek_mm_per_min", "500.000000"),
    ("axes/x/homing/settle_ms", "250"),
    ("axes/x/homing/seek_scaler", "1.100000"),
    ("axes/x/homing/feed_scaler", "1.100000"),
    ("axes/x/motor0/limit_neg_pin", "NO_PIN"),
    ("axes/x/motor0/limit_pos_pin", "gpio.36:low"),
    ("axes/x/motor0/limit_all_pin", "NO_PIN"),
    ("axes/x/motor0/hard_limits", "false"),
    ("axes/x/motor0/pulloff_mm", "1.000000"),
    ("axes/x/motor0/stepstick/step_pin", "gpio.12"),
    ("axes/x/motor0/stepstick/direction_pin", "gpio.14"),
    ("axes/x/motor0/stepstick/disable_pin", "NO_PIN"),
    ("axes/x/motor0/stepstick/ms1_pin", "NO_PIN"),
    ("axes/x/motor0/stepstick/ms2_pin", "NO_PIN"),
    ("axes/x/motor0/stepstick/ms3_pin", "NO_PIN"),
    ("axes/x/motor0/stepstick/reset_pin", "NO_PIN"),
    ("axes/y/steps_per_mm", "80.000000"),
    ("axes/y/max_rate_mm_per_min", "5000.000000"),
    ("axes/y/acceleration_mm_per_sec2", "100.000000"),
    ("axes/y/max_travel_mm", "300.000000"),
    ("axes/y/soft_limits", "false"),
    ("axes/y/idle_disable", "true"),
    ("axes/y/motor0/limit_neg_pin", "NO_PIN"),
    ("axes/y/motor0/limit_pos_pin", "NO_PIN"),
    ("axes/y/motor0/limit_all_pin", "NO_PIN"),
    ("axes/y/motor0/hard_limits", "false"),
    ("axes/y/motor0/pulloff_mm", "1.000000"),
    ("axes/y/motor0/stepstick/step_pin", "gpio.26"),
    ("axes/y/motor0/stepstick/direction_pin", "gpio.15"),
    ("axes/y/motor0/stepstick/disable_pin", "NO_PIN"),
    ("axes/y/motor0/stepstick/ms1_pin", "NO_PIN"),
    ("axes/y/motor0/stepstick/ms2_pin", "NO_PIN"),
    ("axes/y/motor0/stepstick/ms3_pin", "NO_PIN"),
    ("axes/y/motor0/stepstick/reset_pin", "NO_PIN"),
    ("axes/z/steps_per_mm", "80.000000"),
    ("axes/z/max_rate_mm_per_min", "5000.000000"),
    ("axes/z/acceleration_mm_per_sec2", "100.000000"),
    ("axes/z/max_travel_mm", "300.000000"),
    ("axes/z/soft_limits", "false"),
    ("axes/z/idle_disable", "true"),
    ("axes/z/homing/cycle", "1"),
    ("axes/z/homing/allow_single_axis", "true"),
    ("axes/z/homing/positive_direction", "true"),
    ("axes/z/homing/mpos_mm", "0.000000"),
    ("axes/z/homing/feed_mm_per_min", "100.000000"),
    ("axes/z/homing/seek_mm_per_min", "800.000000"),
    ("axes/z/homing/settle_ms", "250"),
    ("axes/z/homing/seek_scaler", "1.100000"),
    ("axes/z/homing/feed_scaler", "1.100000"),
    ("axes/z/motor0/limit_neg_pin", "NO_PIN"),
    ("axes/z/motor0/limit_pos_pin", "gpio.39:low"),
    ("axes/z/motor0/limit_all_pin", "NO_PIN"),
    ("axes/z/motor0/hard_limits", "false"),
    ("axes/z/motor0/pulloff_mm", "1.000000"),
    ("axes/z/motor0/stepstick/step_pin", "gpio.27"),
    ("axes/z/motor0/stepstick/direction_pin", "gpio.33"),
    ("axes/z/motor0/stepstick/disable_pin", "NO_PIN"),
    ("axes/z/motor0/stepstick/ms1_pin", "NO_PIN"),
    ("axes/z/motor0/stepstick/ms2_pin", "NO_PIN"),
    ("axes/z/motor0/stepstick/ms3_pin", "NO_PIN"),
    ("axes/z/motor0/stepstick/reset_pin", "NO_PIN"),
    ("control/safety_door_pin", "NO_PIN"),
    ("control/reset_pin", "NO_PIN"),
    ("control/feed_hold_pin", "NO_PIN"),
    ("control/cycle_start_pin", "NO_PIN"),
    ("control/macro0_pin", "NO_PIN"),
    ("control/macro1_pin", "NO_PIN"),
    ("control/macro2_pin", "NO_PIN"),
    ("control/macro3_pin", "NO_PIN"),
    ("control/fault_pin", "NO_PIN"),
    ("control/estop_pin", "gpio.34:low"),
    ("control/homing_button_pin", "NO_PIN"),
    ("coolant/flood_pin", "gpio.2"),
    ("coolant/mist_pin", "NO_PIN"),
    ("coolant/delay_ms", "0"),
    ("probe/pin", "gpio.32:low:pu"),
    ("probe/toolsetter_pin", "NO_PIN"),
    ("probe/check_mode_start", "true"),
    ("probe/hard_stop", "false"),
    ("probe/probe_hard_limit", "false"),
    ("macros/startup_line0", ""),
    ("macros/startup_line1", ""),
    ("macros/macro0", ""),
    ("macros/macro1", ""),
    ("macros/macro2", ""),
    ("macros/macro3", ""),
    ("macros/after_homing", ""),
    ("macros/after_reset", ""),
    ("macros/after_unlock", ""),
    ("start/must_home", "false"),
    ("start/deactivate_parking", "false"),
    ("start/check_limits", "true"),
    ("parking/enable", "false"),
    ("parking/axis", "Z"),
    ("parking/target_mpos_mm", "-5.000000"),
    ("parking/rate_mm_per_min", "800.000000"),
    ("parking/pullout_distance_mm", "5.000000"),
    ("parking/pullout_rate_mm_per_min", "250.000000"),
    ("user_outputs/digital0_pin", "NO_PIN"),
    ("user_outputs/digital1_pin", "NO_PIN"),
    ("user_inputs/digital0_pin", "NO_PIN"),
    ("user_inputs/digital1_pin", "NO_PIN"),
    ("10V/forward_pin", "gpio.16"),
    ("10V/reverse_pin", "gpio.17"),
    ("10V/pwm_hz", "5000"),
    ("10V/direction_pin", "NO_PIN"),
    ("10V/output_pin", "gpio.25"),
    ("10V/enable_pin", "gpio.4"),
    ("10V/tool_num", "0"),
    ("10V/speed_map", "0=0.00% 1000=100.00%"),
    ("10V/off_on_alarm", "false"),
    ("10V/atc", ""),
    ("10V/m6_macro", ""),
    ("10V/s0_with_disable", "true"),
    ("10V/disable_with_s0", "false"),
    ("10V/spinup_ms", "0"),
    ("10V/spindown_ms", "0"),
    ("arc_tolerance_mm", "0.002000"),
    ("junction_deviation_mm", "0.010000"),
    ("verbose_errors", "true"),
    ("report_inches", "false"),
    ("enable_parking_override_control", "false"),
    ("use_line_numbers", "false"),
    ("planner_blocks", "16"),
];

/// Minimum and maximum values by the names of the items. Other items have no limits.
const RANGES: [(&str, f64, f64); 21] = [
    ("idle_ms", 0.0, 10_000_000.0),
    ("pulse_us", 0.0, 30.0),
    ("dir_delay_us", 0.0, 10.0),
    ("disable_delay_us", 0.0, 1_000_000.0),
    ("segments", 6.0, 20.0),
    ("homing_runs", 1.0, 5.0),
    ("steps_per_mm", 0.001, 100_000.0),
    ("max_rate_mm_per_min", 0.001, 250_000.0),
    ("acceleration_mm_per_sec2", 0.001, 100_000.0),
    ("max_travel_mm", 0.1, 10_000_000.0),
    ("cycle", -1.0, 6.0),
    ("feed_mm_per_min", 1.0, 100_000.0),
    ("seek_mm_per_min", 1.0, 100_000.0),
    ("settle_ms", 0.0, 1000.0),
    ("seek_scaler", 1.0, 100.0),
    ("feed_scaler", 1.0, 100.0),
    ("pulloff_mm", 0.1, 100_000.0),
    ("pwm_hz", 1.0, 20_000_000.0),
    ("arc_tolerance_mm", 0.001, 1.0),
    ("junction_deviation_mm", 0.01, 1.0),
    ("planner_blocks", 10.0, 120.0),
];

/// Text in the configuration for a pin that is not connected.
const NO_PIN: &str = "NO_PIN";

/// The type of a configuration item, which determines which values are valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ItemType {
    /// The firmware cannot change the item while it runs; its message calls the type by this
    /// word.
    Fixed(&'static str),
    Switch,
    Whole,
    Real,
    Text,
}

#[derive(Clone, Debug, PartialEq)]
struct ConfigItem {
    path: &'static str,
    item_type: ItemType,
    file: String,
    memory: String,
}

impl ConfigItem {
    fn new_default(path: &'static str, value: &str) -> Self {
        let item_type = match item_name(path) {
            "engine" => ItemType::Fixed("step_engine"),
            leaf if leaf.ends_with("pin") => ItemType::Fixed("Pin"),
            _ if value == "true" || value == "false" => ItemType::Switch,
            _ if value.parse::<i64>().is_ok() => ItemType::Whole,
            _ if value.parse::<f64>().is_ok() => ItemType::Real,
            _ => ItemType::Text,
        };
        Self {
            path,
            item_type,
            file: value.to_owned(),
            memory: value.to_owned(),
        }
    }

    /// Converts a value to the firmware's format. Returns the converted value, `None` if it is
    /// wrong, and a warning or error message, if any.
    fn format_value(&self, value: &str) -> (Option<String>, Option<String>) {
        let number = value
            .trim()
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite());
        let bad = || (None, Some("[MSG:ERR: This is no number]\r\n".to_owned()));
        match (self.item_type, number) {
            (ItemType::Text | ItemType::Fixed(_), _) => (Some(value.to_owned()), None),
            (ItemType::Switch, _) if is_one_of(value, ["true", "yes", "on"]) => {
                (Some("true".to_owned()), None)
            }
            (ItemType::Switch, _) if is_one_of(value, ["false", "no", "off"]) => {
                (Some("false".to_owned()), None)
            }
            (_, None) => bad(),
            (ItemType::Switch, Some(number)) => (Some((number != 0.0).to_string()), None),
            (item_type, Some(number)) => {
                let range = RANGES.iter().find(|range| range.0 == item_name(self.path));
                let (least, most) = range.map_or((f64::MIN, f64::MAX), |range| (range.1, range.2));
                let clamped = number.clamp(least, most);
                let text = if item_type == ItemType::Whole {
                    format!("{:.0}", clamped.trunc())
                } else {
                    format!("{:.6}", clamped as f32)
                };
                let message = (clamped.to_bits() != number.to_bits()).then(|| {
                    format!("[MSG:WARN: {value} is held within {least:.3} to {most:.3}]\r\n")
                });
                (Some(text), message)
            }
        }
    }
}

fn is_one_of(value: &str, words: [&str; 3]) -> bool {
    words.iter().any(|word| value.eq_ignore_ascii_case(word))
}

/// Returns the last part of a path, which is the name of the item.
fn item_name(path: &str) -> &str {
    path.rsplit_once('/').map_or(path, |(_, name)| name)
}

/// The configuration tree of FluidNC: its items in listing order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FluidConfig(Vec<ConfigItem>);

impl Default for FluidConfig {
    fn default() -> Self {
        let item = |&(path, value): &(&'static str, &str)| ConfigItem::new_default(path, value);
        Self(DEFAULTS.iter().map(item).collect())
    }
}

impl FluidConfig {
    fn find(&self, path: &str) -> Option<&ConfigItem> {
        let named = |item: &&ConfigItem| item.path.eq_ignore_ascii_case(path);
        self.0.iter().find(named)
    }

    /// Returns the value of an item in memory; `None` for an unknown path.
    pub(super) fn value(&self, path: &str) -> Option<&str> {
        Some(self.find(path)?.memory.as_str())
    }

    /// Returns the value of an item in memory as a number; 0 if it is missing.
    pub(super) fn number(&self, path: &str) -> f64 {
        let value = self.value(path).and_then(|value| value.parse().ok());
        value.unwrap_or(0.0)
    }

    /// Returns whether a switch item is on in memory.
    pub(super) fn is_on(&self, path: &str) -> bool {
        self.value(path) == Some("true")
    }

    /// Returns whether the pin of an item is connected, that is, not `NO_PIN`.
    pub(super) fn is_wired(&self, path: &str) -> bool {
        self.value(path).is_some_and(|pin| pin != NO_PIN)
    }

    /// Copies the values of the configuration file into memory, as power-on does.
    pub(super) fn load_file(&mut self) {
        for item in &mut self.0 {
            item.memory.clone_from(&item.file);
        }
    }

    /// Returns the value of an item in the file, for items that only startup reads; `None` for
    /// an unknown path.
    pub(super) fn file_value(&self, path: &str) -> Option<&str> {
        Some(self.find(path)?.file.as_str())
    }

    /// Changes an item in file and memory, as the owner of the board does. Returns error 3 for
    /// an unknown item and 2 for a wrong value.
    pub(super) fn set_in_file(&mut self, path: &str, value: &str) -> Result<(), u8> {
        let named = |item: &&mut ConfigItem| item.path.eq_ignore_ascii_case(path);
        let item = self.0.iter_mut().find(named).ok_or(3_u8)?;
        item.file = item.format_value(value).0.ok_or(2_u8)?;
        item.memory.clone_from(&item.file);
        Ok(())
    }

    /// Removes the items of a section from the configuration file.
    #[cfg(test)]
    pub(super) fn remove_section(&mut self, section: &str) {
        let within = |path: &str| {
            path.strip_prefix(section)
                .is_some_and(|rest| rest.starts_with('/'))
        };
        self.0.retain(|item| !within(item.path));
    }

    /// Executes `$/path=value`. Returns the message before `ok`, if any; error 3 for an
    /// unknown item.
    pub(super) fn set(&mut self, path: &str, value: &str) -> Result<Option<String>, u8> {
        let named = |item: &&mut ConfigItem| item.path.eq_ignore_ascii_case(path);
        let item = self.0.iter_mut().find(named).ok_or(3_u8)?;
        if let ItemType::Fixed(what) = item.item_type {
            let message = format!("Runtime setting of {what} objects is not supported\r\n");
            return Ok(Some(message));
        }
        let (text, message) = item.format_value(value);
        if let Some(text) = text {
            item.memory = text;
        }
        Ok(message)
    }

    /// Executes `$/path`. Returns the text of the item or section; error 3 for an unknown
    /// path.
    pub(super) fn show(&self, path: &str) -> Result<String, u8> {
        if let Some(item) = self.find(path) {
            let value = match item.item_type {
                // A single item has three decimals, the listing has six.
                ItemType::Real => format!("{:.3}", self.number(path)),
                _ => item.memory.clone(),
            };
            return Ok(format!("$/{path}={value}\r\n"));
        }
        let prefix = format!("{path}/").to_ascii_lowercase();
        let within = |item: &&ConfigItem| item.path.to_ascii_lowercase().starts_with(&prefix);
        let items: Vec<&ConfigItem> = self.0.iter().filter(within).collect();
        if items.is_empty() {
            return Err(3);
        }
        Ok(format!(
            "/{path}:\r\n{}",
            format_items(&items, prefix.len(), 1)
        ))
    }

    /// Returns the text of the whole configuration, the answer to `$CD`.
    pub(super) fn dump(&self) -> String {
        format_items(&self.0.iter().collect::<Vec<_>>(), 0, 0)
    }

    /// Returns the value of the item that corresponds to a Grbl setting number; `None` without
    /// such an item.
    pub(super) fn grbl_setting(&self, number: u16) -> Option<f64> {
        let item = match number / 10 {
            10 => "steps_per_mm",
            11 => "max_rate_mm_per_min",
            12 => "acceleration_mm_per_sec2",
            13 => "max_travel_mm",
            _ if number == 11 => return Some(self.number("junction_deviation_mm")),
            _ => return None,
        };
        let axis = ["x", "y", "z"].get(usize::from(number % 10))?;
        Some(self.number(&format!("axes/{axis}/{item}")))
    }
}

/// Formats items as lines with `indent` blanks, without the first `skip` characters of their
/// paths.
fn format_items(items: &[&ConfigItem], skip: usize, indent: usize) -> String {
    let mut text = String::new();
    let mut open: Vec<&str> = Vec::new();
    let mut blank = false;
    let close_section = |text: &mut String, count: usize, blank: &mut bool| {
        if count > 0 && !*blank {
            text.push_str("\r\n");
            *blank = true;
        }
    };
    for item in items {
        let path = &item.path[skip..];
        let (sections, name) = path.rsplit_once('/').unwrap_or(("", path));
        let sections: Vec<&str> = sections
            .split('/')
            .filter(|part| !part.is_empty())
            .collect();
        let common = open
            .iter()
            .zip(&sections)
            .take_while(|(a, b)| a == b)
            .count();
        close_section(&mut text, open.len() - common, &mut blank);
        open.truncate(common);
        for section in &sections[common..] {
            let depth = 2 * (indent + open.len());
            let _ = write!(text, "{:depth$}{section}: \r\n", "");
            open.push(section);
            blank = false;
        }
        if name.is_empty() {
            continue;
        }
        let depth = 2 * (indent + open.len());
        let quote = if item.memory.contains(':') { "'" } else { "" };
        let _ = write!(
            text,
            "{:depth$}{name}: {quote}{}{quote}\r\n",
            "", item.memory
        );
        blank = false;
    }
    close_section(&mut text, open.len(), &mut blank);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_indented_and_a_section_ends_with_one_empty_line() {
        let mut config = FluidConfig::default();
        let pin = "axes/x/motor0/stepstick/direction_pin";
        config.set_in_file(pin, "gpio.14:low").unwrap();
        let text = config.dump();
        assert!(text.starts_with("board: Breakout\r\nname: Lathe\r\nmeta: \r\nstepping: \r\n"));
        assert!(text.contains("  segments: 12\r\n\r\nspi: \r\n  miso_pin: gpio.19\r\n"));
        assert!(text.contains("kinematics: \r\n  Cartesian: \r\n\r\naxes: \r\n"));
        let driver = "      stepstick: \r\n        step_pin: gpio.12\r\n        \
                      direction_pin: 'gpio.14:low'\r\n";
        assert!(text.contains(driver), "{text}");
        assert!(text.contains("        reset_pin: NO_PIN\r\n\r\n  y: \r\n"));
        assert!(text.contains("    steps_per_mm: 80.000000\r\n"));
        assert!(text.ends_with("  spindown_ms: 0\r\n\r\narc_tolerance_mm: 0.002000\r\njunction_deviation_mm: 0.010000\r\nverbose_errors: true\r\nreport_inches: false\r\nenable_parking_override_control: false\r\nuse_line_numbers: false\r\nplanner_blocks: 16\r\n"));
        assert!(!text.contains("\r\n\r\n\r\n"));
    }

    #[test]
    fn a_path_shows_an_item_or_a_section() {
        let config = FluidConfig::default();
        let shown = config.show("axes/x/steps_per_mm");
        assert_eq!(shown, Ok("$/axes/x/steps_per_mm=80.000\r\n".into()));
        let shown = config.show("start").unwrap();
        assert!(
            shown.starts_with("/start:\r\n  must_home: false\r\n"),
            "{shown}"
        );
        assert_eq!(config.show("axes/a"), Err(3));
        assert_eq!(config.show("star"), Err(3));
    }

    #[test]
    fn values_are_accepted_clamped_or_refused() {
        let mut config = FluidConfig::default();
        assert_eq!(config.set("AXES/x/steps_per_mm", "1234.567"), Ok(None));
        // The firmware stores single-precision numbers.
        assert_eq!(config.value("axes/x/steps_per_mm"), Some("1234.567017"));
        let message = config.set("axes/x/homing/settle_ms", "5000").unwrap();
        assert!(message.unwrap().starts_with("[MSG:WARN:"));
        assert_eq!(config.value("axes/x/homing/settle_ms"), Some("1000"));
        let message = config.set("axes/x/motor0/limit_pos_pin", "NO_PIN").unwrap();
        assert!(message.unwrap().contains("Pin objects"));
        assert!(config.is_wired("axes/x/motor0/limit_pos_pin"));
        assert_eq!(config.set("start/must_home", "YES"), Ok(None));
        assert!(config.is_on("start/must_home"));
        assert!(config.set("start/must_home", "perhaps").unwrap().is_some());
        assert_eq!(config.set("start", "1"), Err(3));
        config.load_file();
        assert!(!config.is_on("start/must_home"), "the file was not written");
    }
}
