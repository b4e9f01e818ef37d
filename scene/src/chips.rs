//! Chips that fly from the cut and fall into the tray. Their number is bounded, and the same
//! cuts at the same times give the same chips.

use core::f32::consts::TAU;
use std::collections::VecDeque;

use glam::{Quat, Vec3, vec3};

use crate::part::material::{ChipShape, PartMaterial};

/// Greatest number of chips, flying or in the tray.
pub const MAX_CHIPS: usize = 140;
/// Time between two chips that a cut throws, s.
const CHIP_INTERVAL_S: f32 = 0.045;
/// Acceleration with which chips fall, mm/s²: slower than real, so that the eye follows.
const GRAVITY: f32 = 2200.0;
/// Time after which a spark disappears, s.
const SPARK_LIFE_S: f32 = 0.35;

/// A cut that makes chips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipSource {
    /// Position of the cut in the scene, mm.
    pub at: Vec3,
    /// Direction in which the chips leave the cut, of any length.
    pub away: Vec3,
    /// Feed, mm per turn.
    pub feed: f32,
    /// Cutting speed, m/min.
    pub speed: f32,
    /// Material of the part that is cut.
    pub material: PartMaterial,
    /// Height at which chips come to rest, mm.
    pub tray_y: f32,
}

/// Shape, colour and position of a chip at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipState {
    /// Whether the chip is a needle, a curl, a ribbon or a spark.
    pub shape: ChipShape,
    /// Colour as sRGB bytes.
    pub color: [u8; 3],
    /// Position of the chip in the scene, mm.
    pub position: Vec3,
    /// Orientation of the chip.
    pub turn: Quat,
}

/// A chip with the data of its flight, from which its position at any time follows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ThrownChip {
    shape: ChipShape,
    color: [u8; 3],
    born_s: f32,
    from: Vec3,
    velocity: Vec3,
    axis: Vec3,
    /// Speed of its rotation while it flies, turns per second.
    spin: f32,
    /// Time from the throw until it reaches the tray, s.
    flight_s: f32,
}

/// All chips that fly or are in the tray.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChipFlow {
    chips: VecDeque<ThrownChip>,
    now_s: f32,
    next_s: f32,
    /// Number of chips thrown so far; it is the random seed of the next chip.
    thrown: u32,
}

/// Returns a pseudorandom number from -1 to 1 that depends only on `seed` and `salt`.
fn scatter(seed: u32, salt: u32) -> f32 {
    let mut value = seed.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
    value ^= value >> 15;
    value = value.wrapping_mul(0x2c1b_3c6d);
    value ^= value >> 12;
    (value & 0xffff) as f32 / 32_767.5 - 1.0
}

impl ChipFlow {
    /// Moves all chips by `elapsed_s` seconds, and throws new ones if `source` is a cut.
    pub fn advance(&mut self, elapsed_s: f32, source: Option<&ChipSource>) {
        let elapsed_s = if elapsed_s.is_finite() {
            elapsed_s.clamp(0.0, 0.5)
        } else {
            0.0
        };
        self.now_s += elapsed_s;
        let is_dead = |it: &ThrownChip, now: f32| {
            it.shape == ChipShape::Spark && now - it.born_s > SPARK_LIFE_S
        };
        let now = self.now_s;
        self.chips.retain(|it| !is_dead(it, now));
        let Some(source) = source.filter(|it| it.at.is_finite() && it.away.is_finite()) else {
            self.next_s = self.next_s.max(self.now_s);
            return;
        };
        while self.next_s <= self.now_s {
            let material = source.material;
            let shape = material.chip_shape(source.feed);
            self.throw(source, shape, material.chip_color(source.speed));
            if material.spark_speed().is_some_and(|it| source.speed > it) {
                for _ in 0..2 {
                    self.throw(source, ChipShape::Spark, [255, 214, 120]);
                }
            }
            self.next_s += CHIP_INTERVAL_S;
        }
    }

    /// Removes all chips.
    pub fn clear(&mut self) {
        self.chips.clear();
    }

    /// Whether any chip still flies.
    pub fn is_moving(&self) -> bool {
        let flies = |it: &ThrownChip| self.now_s - it.born_s < it.flight_s;
        self.chips.iter().any(flies)
    }

    /// Returns shape, colour and position of all chips at this moment.
    pub fn states(&self) -> Vec<ChipState> {
        let state = |chip: &ThrownChip| {
            let time = (self.now_s - chip.born_s).min(chip.flight_s);
            let fall = Vec3::NEG_Y * (GRAVITY * 0.5 * time * time);
            ChipState {
                shape: chip.shape,
                color: chip.color,
                position: chip.from + chip.velocity * time + fall,
                turn: Quat::from_axis_angle(chip.axis, time * chip.spin * TAU),
            }
        };
        self.chips.iter().map(state).collect()
    }

    fn throw(&mut self, source: &ChipSource, shape: ChipShape, color: [u8; 3]) {
        self.thrown = self.thrown.wrapping_add(1);
        let random = |salt| scatter(self.thrown, salt);
        let is_spark = shape == ChipShape::Spark;
        let force =
            (90.0 + source.speed.clamp(0.0, 400.0) * 0.5) * if is_spark { 2.5 } else { 1.0 };
        let away = source.away.normalize_or(Vec3::Z);
        let velocity = away * force * (0.7 + 0.3 * random(1))
            + vec3(
                130.0 * random(2),
                330.0 + 130.0 * random(3),
                70.0 * random(4),
            );
        // Chips pile up: they rest at slightly different heights.
        let tray = source.tray_y + 5.0 + 5.0 * random(5);
        let height = (source.at.y - tray).max(0.0);
        let up = velocity.y;
        let flight_s = (up + (up * up + 2.0 * GRAVITY * height).sqrt()) / GRAVITY;
        self.chips.push_back(ThrownChip {
            shape,
            color,
            born_s: self.now_s,
            from: source.at,
            velocity,
            axis: vec3(random(6), random(7), random(8)).normalize_or(Vec3::X),
            spin: 2.0 + 2.0 * random(9),
            flight_s,
        });
        while self.chips.len() > MAX_CHIPS {
            self.chips.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(feed: f32, speed: f32) -> ChipSource {
        ChipSource {
            at: vec3(100.0, 0.0, 20.0),
            away: Vec3::Z,
            feed,
            speed,
            material: PartMaterial::Steel,
            tray_y: -250.0,
        }
    }

    #[test]
    fn the_number_of_chips_is_bounded_and_all_come_to_rest_in_the_tray() {
        let mut flow = ChipFlow::default();
        for _ in 0..3000 {
            flow.advance(0.033, Some(&source(0.2, 120.0)));
            assert!(flow.states().len() <= MAX_CHIPS);
        }
        assert_eq!(flow.states().len(), MAX_CHIPS);
        assert!(flow.is_moving());
        for _ in 0..60 {
            flow.advance(0.1, None);
        }
        assert!(!flow.is_moving());
        for chip in flow.states() {
            assert!((chip.position.y + 245.0).abs() < 5.5, "{chip:?}");
        }
        flow.clear();
        assert_eq!(flow.states(), []);
    }

    #[test]
    fn the_same_cut_gives_the_same_chips() {
        let run = || {
            let mut flow = ChipFlow::default();
            for step in 0..200 {
                let cut = source(0.1 + step as f32 * 0.002, 150.0);
                flow.advance(0.03, (step % 50 < 40).then_some(&cut));
            }
            flow.states()
        };
        assert!(!run().is_empty());
        assert_eq!(run(), run());
    }

    #[test]
    fn sparks_fly_only_at_too_high_a_speed_and_go_out() {
        let has_spark =
            |flow: &ChipFlow| flow.states().iter().any(|it| it.shape == ChipShape::Spark);
        let mut flow = ChipFlow::default();
        flow.advance(0.2, Some(&source(0.2, 300.0)));
        assert!(!has_spark(&flow));
        flow.advance(0.2, Some(&source(0.2, 600.0)));
        assert!(has_spark(&flow));
        flow.advance(0.5, None);
        assert!(!has_spark(&flow));
        let brass = ChipSource {
            material: PartMaterial::Brass,
            ..source(0.2, 600.0)
        };
        flow.advance(0.2, Some(&brass));
        assert!(!has_spark(&flow));
    }
}
