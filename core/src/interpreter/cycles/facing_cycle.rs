//! G94: facing cycle (manual I-3.2.5.2).
//!
//! ```text
//!   X ^    B <-----------1------------ A       1 rapid Z to B
//!     |    |                           ^       2 cut B -> C
//!     |    2                           4       3 cut Z to D
//!     |    v                           |       4 rapid X to A
//!     |    C ____________3___________> D       R = Z_B - Z_C
//!     +---------------------------------> Z    B = (X_A, Z_C + R)
//! ```

use crate::alarm::Alarm;
use crate::interpreter::cycles::box_cycle::{BoxCycle, check_taper};
use crate::interpreter::exact::{CoordinateRange, ExactPoint};
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::state::State;
use crate::interpreter::state::cycle_words::CycleData;
use crate::units::Axis;

/// Plans a G94 from the current position to the end point of `data` and back.
///
/// # Errors
/// 015 for the taper, 043 for a corner outside the stroke, 011 without a feed.
pub(crate) fn plan_cycle(
    state: &State,
    data: CycleData,
    range: CoordinateRange<'_>,
) -> Result<BoxCycle, Alarm> {
    let (start, end) = (state.position, data.end);
    check_taper(data.r, end.z - start.z, ("G94", "W"))?;
    let b = ExactPoint::new(start.x, end.z + data.r);
    let d = ExactPoint::new(end.x, start.z);
    let note = PassNote::Box {
        axis: Axis::Z,
        a: start,
        c: end,
        taper: data.r,
    };
    BoxCycle::new(state, [b, end, d, start], range, note)
}
