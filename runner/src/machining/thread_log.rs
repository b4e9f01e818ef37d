//! Records where a live part has threads, and their lead: the half section shows grooves only.

use gsk_core::units::Point;

/// Greatest number of thread zones that are stored.
const MAX_ZONES: usize = 16;
/// Least lead along Z, mm, of a thread that is logged; a spiral on a face has none.
const MIN_LEAD_MM: f64 = 0.01;
/// Difference of the leads, as a fraction, up to which two passes belong to the same thread.
const LEAD_TOLERANCE: f64 = 0.02;

/// A range along Z in which a thread was cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadZone {
    /// Least Z of the grooves in the plane of the half section, part coordinates, mm.
    pub low: f64,
    /// Greatest Z of the grooves in the plane of the half section, part coordinates, mm.
    pub high: f64,
    /// Distance along Z per turn of the spindle, mm; negative if the tool moves to the chuck
    /// while the spindle turns forward: a right-hand thread.
    pub lead: f64,
    /// Whether the thread is internal, in a bore.
    pub is_internal: bool,
}

/// The threads of a part, and the last groove of the pass that is being cut.
#[derive(Clone, Debug, Default)]
pub(super) struct ThreadLog {
    zones: Vec<ThreadZone>,
    /// Tip position and spindle turns of the last imprint; `None` before the first one of a
    /// pass.
    last: Option<(Point, f64)>,
}

impl ThreadLog {
    /// Returns the thread zones in the order in which they were begun.
    pub(super) fn zones(&self) -> &[ThreadZone] {
        &self.zones
    }

    /// Ends a pass: the next groove does not continue it.
    pub(super) const fn end_pass(&mut self) {
        self.last = None;
    }

    /// Discards all logged threads.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds a groove that the tool has cut in the drawn plane at a whole number of turns.
    pub(super) fn add_imprint(&mut self, tip: Point, turns: f64, is_internal: bool) {
        let Some((before, turns_before)) = self.last.replace((tip, turns)) else {
            return;
        };
        let lead = (tip.z - before.z) / (turns - turns_before);
        if !lead.is_finite() || lead.abs() < MIN_LEAD_MM {
            return;
        }
        let added = ThreadZone {
            low: tip.z.min(before.z),
            high: tip.z.max(before.z),
            lead,
            is_internal,
        };
        let continues = |zone: &ThreadZone| {
            zone.is_internal == is_internal
                && (zone.lead - lead).abs() <= LEAD_TOLERANCE * lead.abs()
                && added.low <= zone.high + lead.abs()
                && added.high >= zone.low - lead.abs()
        };
        let known = self.zones.iter().position(continues);
        if let Some(zone) = known.and_then(|at| self.zones.get_mut(at)) {
            zone.low = zone.low.min(added.low);
            zone.high = zone.high.max(added.high);
        } else if self.zones.len() < MAX_ZONES {
            self.zones.push(added);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut_pass(log: &mut ThreadLog, from: f64, lead: f64, first_turn: f64, direction: f64) {
        log.end_pass();
        for turn in 0..10 {
            let turn = f64::from(turn);
            let tip = Point::new(9.0, from - lead * turn);
            log.add_imprint(tip, first_turn + turn * direction, false);
        }
    }

    #[test]
    fn passes_of_one_thread_are_one_zone_with_its_lead() {
        let mut log = ThreadLog::default();
        cut_pass(&mut log, 3.0, 1.5, 100.0, 1.0);
        cut_pass(&mut log, 3.2, 1.5, 340.0, 1.0);
        let [zone] = log.zones() else {
            panic!("{:?}", log.zones())
        };
        assert!((zone.lead + 1.5).abs() < 1e-9, "{zone:?}");
        assert!((zone.low + 10.5).abs() < 1e-9 && (zone.high - 3.2).abs() < 1e-9);
    }

    #[test]
    fn a_reversed_spindle_gives_the_other_hand_and_a_zone_of_its_own() {
        let mut log = ThreadLog::default();
        cut_pass(&mut log, 3.0, 1.5, 100.0, -1.0);
        cut_pass(&mut log, 3.0, 2.0, 100.0, 1.0);
        let leads: Vec<f64> = log.zones().iter().map(|zone| zone.lead).collect();
        assert_eq!(leads, [1.5, -2.0]);
    }

    #[test]
    fn a_spiral_on_a_face_and_the_way_between_passes_are_no_thread() {
        let mut log = ThreadLog::default();
        log.add_imprint(Point::new(9.0, 0.0), 1.0, false);
        log.add_imprint(Point::new(8.0, 0.0), 2.0, false);
        log.end_pass();
        log.add_imprint(Point::new(8.0, 9.0), 3.0, false);
        assert_eq!(log.zones(), []);
    }
}
