//! The faults of the simulated lathe: one table, for training.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// A fault of the simulated lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LatheFault {
    /// Fault: the tool post does not turn.
    TurretBlocked,
    /// The tool post's clamp switch never reports that the post is clamped.
    TurretUnclamped,
    /// The station switch that is active stays active.
    TurretContactStuck,
    /// Fault: all station switches of the tool post stay inactive.
    TurretContactsOpen,
    /// Fault: the spindle does not turn.
    SpindleBlocked,
    /// Fault: no spindle gear reports its position.
    GearStuck,
    /// Fault: the chuck does not move.
    ChuckStuck,
    /// Fault: the spindle encoder sends no counts.
    EncoderLost,
    /// Fault: the counts of the spindle encoder jitter.
    EncoderNoise,
    /// Fault: the spindle encoder sends no one-turn signal.
    SpindleIndexLost,
    /// Fault: the X motor sends no one-turn signal.
    IndexX,
    /// Fault: the Z motor sends no one-turn signal.
    IndexZ,
    /// Fault: the X deceleration switch stays pressed.
    DogX,
    /// Fault: the Z deceleration switch stays pressed.
    DogZ,
    /// Fault: a limit switch of X stays tripped.
    LimitX,
    /// Fault: a limit switch of Z stays tripped.
    LimitZ,
    /// Fault: the X drive reports an alarm.
    DriveX,
    /// Fault: the Z drive reports an alarm.
    DriveZ,
    /// The X slide is jammed: a servo trips, a stepper loses steps.
    SlideX,
    /// The Z slide is jammed: a servo trips, a stepper loses steps.
    SlideZ,
    /// Fault: hydraulic or air pressure is low.
    PressureLow,
    /// Fault: the guard door is open.
    DoorOpen,
    /// Fault: all machine contacts chatter when they change.
    InputBounce,
    /// Fault: the emergency-stop loop is interrupted.
    EmergencyStop,
    /// The insert of the tool in the working position is broken: it cuts no more.
    InsertBroken,
    /// The stock is loose in the chuck: it does not turn with the spindle.
    StockLoose,
}

/// A fault with its script name, its name for the operator, and its effect.
#[derive(Clone, Copy, Debug)]
pub struct FaultRow {
    /// The fault that the row describes.
    pub fault: LatheFault,
    /// Name of the fault in scripts.
    pub name: &'static str,
    label: fn() -> Message,
    effect: fn() -> Message,
}

const fn fault_row(
    fault: LatheFault,
    name: &'static str,
    label: fn() -> Message,
    effect: fn() -> Message,
) -> FaultRow {
    FaultRow {
        fault,
        name,
        label,
        effect,
    }
}

impl FaultRow {
    /// Message that names the fault for the operator.
    pub fn label(&self) -> Message {
        (self.label)()
    }

    /// Returns the message about what the operator sees at the control.
    pub fn effect(&self) -> Message {
        (self.effect)()
    }
}

/// The table of faults, in the order of [`LatheFault`].
pub static FAULTS: [FaultRow; 26] = [
    fault_row(
        LatheFault::TurretBlocked,
        "turret-blocked",
        say::fault_turret_blocked,
        say::fault_effect_turret_blocked,
    ),
    fault_row(
        LatheFault::TurretUnclamped,
        "turret-unclamped",
        say::fault_turret_unclamped,
        say::fault_effect_turret_unclamped,
    ),
    fault_row(
        LatheFault::TurretContactStuck,
        "turret-contact-stuck",
        say::fault_turret_contact_stuck,
        say::fault_effect_turret_contact_stuck,
    ),
    fault_row(
        LatheFault::TurretContactsOpen,
        "turret-contacts-open",
        say::fault_turret_contacts_open,
        say::fault_effect_turret_contacts_open,
    ),
    fault_row(
        LatheFault::SpindleBlocked,
        "spindle-blocked",
        say::fault_spindle_blocked,
        say::fault_effect_spindle_blocked,
    ),
    fault_row(
        LatheFault::GearStuck,
        "gear-stuck",
        say::fault_gear_stuck,
        say::fault_effect_gear_stuck,
    ),
    fault_row(
        LatheFault::ChuckStuck,
        "chuck-stuck",
        say::fault_chuck_stuck,
        say::fault_effect_chuck_stuck,
    ),
    fault_row(
        LatheFault::EncoderLost,
        "encoder-lost",
        say::fault_encoder_lost,
        say::fault_effect_spindle_blocked,
    ),
    fault_row(
        LatheFault::EncoderNoise,
        "encoder-noise",
        say::fault_encoder_noise,
        say::fault_effect_encoder_noise,
    ),
    fault_row(
        LatheFault::SpindleIndexLost,
        "no-spindle-index",
        say::fault_no_spindle_index,
        say::fault_effect_no_spindle_index,
    ),
    fault_row(
        LatheFault::IndexX,
        "no-index-x",
        say::fault_no_index_x,
        say::fault_effect_no_index_x,
    ),
    fault_row(
        LatheFault::IndexZ,
        "no-index-z",
        say::fault_no_index_z,
        say::fault_effect_no_index_z,
    ),
    fault_row(
        LatheFault::DogX,
        "dog-stuck-x",
        say::fault_dog_stuck_x,
        say::fault_effect_dog_stuck_x,
    ),
    fault_row(
        LatheFault::DogZ,
        "dog-stuck-z",
        say::fault_dog_stuck_z,
        say::fault_effect_dog_stuck_z,
    ),
    fault_row(
        LatheFault::LimitX,
        "limit-x",
        say::fault_limit_x,
        say::fault_effect_limit_x,
    ),
    fault_row(
        LatheFault::LimitZ,
        "limit-z",
        say::fault_limit_z,
        say::fault_effect_limit_x,
    ),
    fault_row(
        LatheFault::DriveX,
        "drive-x",
        say::fault_drive_x,
        say::fault_effect_drive_x,
    ),
    fault_row(
        LatheFault::DriveZ,
        "drive-z",
        say::fault_drive_z,
        say::fault_effect_drive_z,
    ),
    fault_row(
        LatheFault::SlideX,
        "slide-x-jammed",
        say::fault_slide_x_jammed,
        say::fault_effect_slide_x_jammed,
    ),
    fault_row(
        LatheFault::SlideZ,
        "slide-z-jammed",
        say::fault_slide_z_jammed,
        say::fault_effect_slide_z_jammed,
    ),
    fault_row(
        LatheFault::PressureLow,
        "pressure-low",
        say::fault_pressure_low,
        say::fault_effect_pressure_low,
    ),
    fault_row(
        LatheFault::DoorOpen,
        "door-open",
        say::fault_door_open,
        say::fault_effect_door_open,
    ),
    fault_row(
        LatheFault::InputBounce,
        "input-bounce",
        say::fault_input_bounce,
        say::fault_effect_input_bounce,
    ),
    fault_row(
        LatheFault::EmergencyStop,
        "e-stop",
        say::fault_e_stop,
        say::fault_effect_e_stop,
    ),
    fault_row(
        LatheFault::InsertBroken,
        "insert-broken",
        say::fault_insert_broken,
        say::fault_effect_insert_broken,
    ),
    fault_row(
        LatheFault::StockLoose,
        "stock-loose",
        say::fault_stock_loose,
        say::fault_effect_stock_loose,
    ),
];

/// Collects the script names with their faults at compile time.
const fn fault_names() -> [(&'static str, LatheFault); FAULTS.len()] {
    let mut names = [("", LatheFault::EmergencyStop); FAULTS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = (FAULTS[index].name, FAULTS[index].fault);
        index += 1;
    }
    names
}

impl LatheFault {
    /// All faults with their names in scripts.
    pub const ALL: [(&'static str, Self); FAULTS.len()] = fault_names();

    /// Returns the row of the fault in the table.
    pub fn row(self) -> &'static FaultRow {
        // The table is in the order of the enumeration (tested below).
        &FAULTS[self as usize]
    }

    /// The fault with a given script name; `None` if no fault has this name.
    pub fn from_name(name: &str) -> Option<Self> {
        FAULTS
            .iter()
            .find(|row| row.name == name)
            .map(|row| row.fault)
    }
}

/// The active faults, as a bit mask: bit n is the n-th fault of [`LatheFault`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct ActiveFaults(u32);

impl ActiveFaults {
    /// Whether this fault is active.
    pub const fn has(self, fault: LatheFault) -> bool {
        self.0 >> (fault as u32) & 1 == 1
    }

    /// Returns the number of active faults.
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Sets (`on`) or clears a fault.
    pub const fn set(&mut self, fault: LatheFault, on: bool) {
        let mask = 1 << (fault as u32);
        self.0 = if on { self.0 | mask } else { self.0 & !mask };
    }
}

/// Source of chattering contacts and jittering encoder counts. The disturbances are
/// deterministic, so that a run can be repeated.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Disturbance {
    /// Levels of X0 (low byte) and X1 (high byte) at the last tick.
    last: u16,
    /// Remaining chatter time of each contact of X0 and X1, ms.
    chatter: [u8; 16],
    seed: u32,
}

/// Duration for which a contact chatters, and duration of each of its levels, ms.
const CHATTER_MS: u8 = 30;
const CHATTER_LEVEL_MS: u8 = 5;
/// Greatest error of the encoder in either direction, counts.
const NOISE_COUNTS: i64 = 40;

impl Disturbance {
    /// Lets contacts of X0 and X1 chatter after each change if `on`: for 30 ms they read
    /// wrong half of the time.
    pub(crate) fn bounce(&mut self, contacts: &mut [u8], on: bool) {
        let [low, high, ..] = contacts else { return };
        let now = u16::from_le_bytes([*low, *high]);
        let changed = now ^ self.last;
        self.last = now;
        if !on {
            self.chatter = [0; 16];
            return;
        }
        let mut disturbed = now;
        for (bit, left_ms) in self.chatter.iter_mut().enumerate() {
            if changed >> bit & 1 == 1 {
                *left_ms = CHATTER_MS;
            }
            if *left_ms / CHATTER_LEVEL_MS % 2 == 1 {
                disturbed ^= 1 << bit;
            }
            *left_ms = left_ms.saturating_sub(1);
        }
        [*low, *high] = disturbed.to_le_bytes();
    }

    /// Error of the encoder in this tick, counts; 0 unless `on`.
    pub const fn noise(&mut self, on: bool) -> i64 {
        if !on {
            return 0;
        }
        // Linear congruential generator of Numerical Recipes.
        self.seed = self
            .seed
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        (self.seed >> 16) as i64 % (2 * NOISE_COUNTS + 1) - NOISE_COUNTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_faults() {
        for (at, row) in FAULTS.iter().enumerate() {
            assert_eq!(row.fault as usize, at, "{}", row.name);
            assert_eq!(LatheFault::from_name(row.name), Some(row.fault));
            assert_eq!(row.fault.row().name, row.name);
        }
    }

    #[test]
    fn a_changed_contact_chatters_and_settles() {
        let mut disturbance = Disturbance::default();
        let mut levels = Vec::new();
        for _ in 0..40 {
            let mut contacts = [0b1000, 0];
            disturbance.bounce(&mut contacts, true);
            levels.push(contacts[0]);
        }
        let changes = levels.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes >= 4, "{levels:?}");
        assert_eq!(levels[35..], [0b1000; 5]);
    }
}
