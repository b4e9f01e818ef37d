//! What the machine file says about the picture of the lathe in space. Nothing of it changes
//! the machine.

use gsk_plc::address::{Area, BitAddress};
use serde::{Deserialize, Serialize};

/// The appearance of the lathe in the 3D view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PictureConfig {
    /// Construction of the lathe. `None`: a slant bed for a tool post beyond the axis, else a
    /// bench lathe for a chuck of up to 100 mm, else a flat bed.
    pub construction: Option<LatheConstruction>,
    /// Distance of the steady rest from the front of the chuck's body, mm; `None`: no steady
    /// rest.
    pub steady_rest: Option<f64>,
    /// Signals that light the lamps of the tower.
    pub tower: TowerSignals,
}

/// The construction of the lathe in the 3D view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LatheConstruction {
    /// A horizontal bed with a tool post in front of the axis.
    FlatBed,
    /// An inclined bed with a turret beyond the axis.
    SlantBed,
    /// A small lathe on a bench, with a tool post in front of the axis.
    Bench,
}

/// Addresses of the signals that light the lamps of the tower, such as `Y8.0`; empty: the lamp
/// is not wired.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TowerSignals {
    /// Name of the signal that lights the green lamp.
    pub green: String,
    /// Name of the signal that lights the yellow lamp.
    pub yellow: String,
    /// Name of the signal that lights the red lamp.
    pub red: String,
}

impl Default for TowerSignals {
    /// Run, feed hold and alarm. The standard ladder has no output for an alarm.
    fn default() -> Self {
        Self {
            green: "Y8.0".to_owned(),
            yellow: "Y9.0".to_owned(),
            red: "F1.0".to_owned(),
        }
    }
}

impl TowerSignals {
    /// The addresses of the green, yellow and red lamp by their fields; `None`: not wired.
    ///
    /// # Errors
    /// A text that is no bit of Y or F, with its field.
    pub fn addresses(&self) -> Result<[Option<BitAddress>; 3], (&'static str, &str)> {
        let lamps = [
            ("green", &self.green),
            ("yellow", &self.yellow),
            ("red", &self.red),
        ];
        let mut addresses = [None; 3];
        for (address, (field, text)) in addresses.iter_mut().zip(lamps) {
            if text.is_empty() {
                continue;
            }
            let parsed: Option<BitAddress> = text.parse().ok();
            let signal = parsed.filter(|it| matches!(it.area, Area::Y | Area::F));
            *address = Some(signal.ok_or((field, text.as_str()))?);
        }
        Ok(addresses)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lamp_has_a_signal_of_the_ladder_or_of_the_control_or_none() {
        let [green, yellow, red] = TowerSignals::default().addresses().unwrap();
        assert_eq!(green, Some(BitAddress::new(Area::Y, 8, 0)));
        assert_eq!(yellow, Some(BitAddress::new(Area::Y, 9, 0)));
        assert_eq!(red, Some(BitAddress::new(Area::F, 1, 0)));
        let tower = |red: &str| TowerSignals {
            red: red.to_owned(),
            ..TowerSignals::default()
        };
        assert_eq!(tower("").addresses().unwrap()[2], None);
        for wrong in ["X1.0", "Y2", "lamp", "Y99.0"] {
            assert_eq!(tower(wrong).addresses(), Err(("red", wrong)));
        }
    }
}
