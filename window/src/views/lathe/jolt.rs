//! Shakes the picture once when a crash stops the lathe.

use gsk_runner::machining::CollisionFinding;

/// Duration of the shake of the picture after a crash, s.
const JOLT_S: f64 = 0.6;
/// First deflection of the shake, mm.
const DEFLECTION_MM: f64 = 14.0;
/// Decay of the shake, per second.
const DECAY: f64 = 7.0;
const FREQUENCY: f64 = 70.0;

/// Shakes the picture after a crash: the last crash and its time.
#[derive(Default)]
pub struct PictureJolt {
    crash: Option<CollisionFinding>,
    began_at_s: Option<f64>,
}

impl PictureJolt {
    /// The deflection of the picture along x and y, mm. `crash`: the one that stops the lathe.
    pub fn deflection(&mut self, crash: Option<CollisionFinding>, now_s: f64) -> [f32; 2] {
        if crash != self.crash {
            self.began_at_s = crash.map(|_| now_s);
            self.crash = crash;
        }
        let Some(age_s) = self.began_at_s.map(|began| now_s - began) else {
            return [0.0; 2];
        };
        if !(0.0..JOLT_S).contains(&age_s) {
            self.began_at_s = None;
            return [0.0; 2];
        }
        let strength = DEFLECTION_MM * (-DECAY * age_s).exp();
        let phase = FREQUENCY * age_s;
        [
            (strength * phase.cos()) as f32,
            (strength * 0.5 * phase.sin()) as f32,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::units::Point;
    use gsk_workpiece::collision::{Collision, Obstacle, TouchingPart};

    #[test]
    fn a_crash_jolts_the_picture_once() {
        let crash = CollisionFinding {
            source: None,
            tool: 1,
            collision: Collision {
                touching_part: TouchingPart::RapidInsert,
                obstacle: Obstacle::Stock,
                tip: Point::new(20.0, -5.0),
                contact: Point::new(20.0, -5.0),
                depth: 2.0,
            },
        };
        let mut jolt = PictureJolt::default();
        assert_eq!(jolt.deflection(None, 1.0), [0.0; 2]);
        assert!(jolt.deflection(Some(crash), 2.0)[0] > 10.0);
        assert!(jolt.deflection(Some(crash), 2.3) != [0.0; 2]);
        for at in [2.7, 3.0, 9.0] {
            assert_eq!(jolt.deflection(Some(crash), at), [0.0; 2]);
        }
        assert_eq!(jolt.deflection(None, 10.0), [0.0; 2]);
        assert!(jolt.deflection(Some(crash), 11.0)[0] > 10.0);
    }
}
