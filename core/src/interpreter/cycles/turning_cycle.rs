//! G90: outer and inner turning cycle (manual I-3.2.5.1).
//!
//! ```text
//!   X ^    D <-----------4------------ A       1 rapid X to B
//!     |    ^                           |       2 cut B -> C
//!     |    3                           1       3 cut X to D
//!     |    |                           v       4 rapid Z to A
//!     |    C <___________2____________ B       R = X_B - X_C, a radius
//!     +---------------------------------> Z    B = (X_C + 2R, Z_A)
//! ```

use crate::alarm::Alarm;
use crate::interpreter::cycles::box_cycle::{BoxCycle, check_taper};
use crate::interpreter::exact::{CoordinateRange, ExactPoint};
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::state::State;
use crate::interpreter::state::cycle_words::CycleData;
use crate::units::Axis;

/// Plans a G90 from the current position to the end point of `data` and back.
///
/// # Errors
/// 015 for the taper, 043 for a corner outside the stroke, 011 without a feed.
pub(crate) fn plan_cycle(
    state: &State,
    data: CycleData,
    range: CoordinateRange<'_>,
) -> Result<BoxCycle, Alarm> {
    let (start, end) = (state.position, data.end);
    // U counts here as a radius, because R is one.
    check_taper(data.r, (end.x - start.x) / 2, ("G90", "U/2"))?;
    let b = ExactPoint::new(end.x + 2 * data.r, start.z);
    let d = ExactPoint::new(start.x, end.z);
    let note = PassNote::Box {
        axis: Axis::X,
        a: start,
        c: end,
        taper: data.r,
    };
    BoxCycle::new(state, [b, end, d, start], range, note)
}
