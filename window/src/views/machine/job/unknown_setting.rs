//! Gives a job a zero and tool lengths that the control does not know, so that the tools must be
//! set by trial cuts.

use std::collections::BTreeMap;

use gsk_core::units::Diameter;
use gsk_workpiece::job::{DiameterPoint, Job};

/// Distance of the tip from the bar at the usual start of the slides, X -100 Z -150 in machine
/// coordinates, mm.
const START_DISTANCE: DiameterPoint = DiameterPoint {
    x: Diameter(41.3),
    z: 36.7,
};
/// Default start position of the slides, machine coordinates.
const START: DiameterPoint = DiameterPoint {
    x: Diameter(-100.0),
    z: -150.0,
};
/// Lengths of the tools in the order of their numbers, X as a diameter, mm; further tools begin
/// again. The first tool is the reference.
const LENGTHS: [(f64, f64); 6] = [
    (0.0, 0.0),
    (-2.37, 1.46),
    (6.42, -2.73),
    (-3.18, 4.11),
    (9.64, -7.25),
    (-11.3, 5.92),
];

/// Sets zero and tool lengths. The same job always gets the same values.
pub fn make_unknown(job: &mut Job) {
    let outside = 2.0 * job.stock.radius();
    job.zero = Some(DiameterPoint {
        x: Diameter(START.x.0 - outside - START_DISTANCE.x.0),
        z: START.z - job.stock.front() - START_DISTANCE.z,
    });
    job.lengths = unknown_lengths(job);
}

/// Sets zero and tool lengths to those of the control.
pub fn make_known(job: &mut Job) {
    job.zero = None;
    job.lengths.clear();
}

/// Whether zero and tool lengths are those of [`make_unknown`], but for tools that were added since.
pub fn is_unknown(job: &Job) -> bool {
    let unknown = unknown_lengths(job);
    let mut lengths = job.lengths.iter();
    job.zero.is_some()
        && !job.lengths.is_empty()
        && lengths.all(|(tool, length)| unknown.get(tool) == Some(length))
}

fn unknown_lengths(job: &Job) -> BTreeMap<u8, DiameterPoint> {
    (job.tools.keys().copied())
        .zip(LENGTHS.into_iter().cycle())
        .map(|(tool, (x, z))| {
            let x = Diameter(x);
            (tool, DiameterPoint { x, z })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::stock::Stock;
    use gsk_workpiece::tool::Tool;

    fn unknown_setting_is_undone(job: &mut Job) -> bool {
        let before = is_unknown(job);
        make_known(job);
        before && !is_unknown(job)
    }

    #[test]
    fn every_tool_has_a_length_of_its_own_and_begins_outside_of_the_bar() {
        let mut job = Job::new(Stock::bar(50.0, 1.0, 81.0));
        job.tools = (1..=4).map(|number| (number, Tool::turning())).collect();
        make_unknown(&mut job);
        job.check().expect("a valid job");
        let zero = job.zero.expect("a zero").point();
        let mut seen = Vec::new();
        for length in job.lengths.values() {
            assert!(!seen.contains(length), "{length:?}");
            seen.push(*length);
            let tip = START.point() - zero - length.point();
            assert!(tip.x > job.stock.radius() + 10.0, "{tip:?}");
            assert!(tip.z > job.stock.front() + 10.0, "{tip:?}");
        }
        assert_eq!(seen.len(), 4);
        assert!(unknown_setting_is_undone(&mut job));
    }
}
