//! Distance of the slides from the machine coordinates of a control without a valid reference.

use gsk_core::simulation::Simulation;
use gsk_core::units::{Axis, Point};

/// Distances up to which slides and control count as equal, mm: play and errors of the screw, and
/// rounding.
const TOLERANCE_MM: f64 = 0.2;
/// Change of a machine coordinate in a tick above which the control has set it, mm: no slide
/// moves at 60 m/min.
const JUMP_MM: f64 = 1.0;

/// Distance from the machine coordinates of the control to the position of the slides. It is read
/// at the start, and again when the control sets its coordinates, as at the end of a machine zero
/// return. Pulses that a drive loses between do not change it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SlideShift {
    pub distance: Point,
    /// Machine coordinates after the last tick, mm.
    last_coordinates: Point,
}

impl SlideShift {
    /// Follows a tick. `is_first`: nothing is known about an earlier tick.
    pub fn follow_tick(&mut self, simulation: &Simulation, is_first: bool) {
        let coordinates = simulation.cnc.position_machine();
        let last = core::mem::replace(&mut self.last_coordinates, coordinates);
        let change = coordinates - last;
        let has_jumped = |axis| change.get(axis).abs() > JUMP_MM;
        if is_first || has_jumped(Axis::X) || has_jumped(Axis::Z) {
            self.distance = measure(simulation);
        }
    }
}

/// Returns the present distance, mm, of the slides from the machine coordinates of the control. The simulated
/// slides say nothing about real ones.
pub fn measure(simulation: &Simulation) -> Point {
    let lathe = &simulation.lathe;
    if simulation.cnc.has_board() {
        return Point::default();
    }
    let slides = lathe.slide_position() + lathe.following_error();
    let mut distance = slides - simulation.cnc.position_machine();
    for axis in [Axis::X, Axis::Z] {
        let along = distance.get_mut(axis);
        if along.abs() <= TOLERANCE_MM {
            *along = 0.0;
        }
    }
    distance
}
