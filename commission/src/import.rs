//! Files of measurements: which of the forms a text has.

use crate::line::FileFault;
use crate::ren::Imported;
use crate::{csv, ren, rtl};

/// Reads a text about X or Z of a lathe: CSV where its first line with content is a
/// heading with columns, a linear measurement (RTL) where it has the heading of targets,
/// the text of a calibration (REN) otherwise.
///
/// # Errors
/// The first line that cannot be.
pub fn read(text: &str) -> Result<Imported, FileFault> {
    read_of(text, &['X', 'Z'])
}

/// The same about an axis of a machine that has these.
///
/// # Errors
/// As [`read`].
pub fn read_of(text: &str, axes: &[char]) -> Result<Imported, FileFault> {
    let text = text.trim_start_matches('\u{feff}');
    if csv::is_csv(text) {
        csv::read(text).map(Imported::Measured)
    } else if rtl::is_rtl(text) {
        rtl::read(text).map(Imported::Measured)
    } else {
        ren::read(text, axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::{Direction, Travel};
    use crate::plan::{PlanWish, plan};
    use crate::table_file::add_table;
    use gsk_core::memory::{Parameters, PitchTable};
    use gsk_core::units::Axis;

    /// Texts put together from pieces of both forms at random: whatever is read is fitted,
    /// planned or refused, and what is planned the control takes.
    #[test]
    fn no_text_stops_the_program() {
        const HEADS: [&str; 5] = [
            "run,direction,target,deviation\n",
            "target,deviation\n",
            "axis: Z\nspacing: 10\n",
            "TARGET DATA::\nTargets :\n0 -10 -20.5\nRun Target Data:\n",
            "",
        ];
        const LINES: [&str; 18] = [
            "1,+,-300,2\n",
            "1,-,-300,8\n",
            "2,-,-10.5,8\n",
            "1,+,0,-9000\n",
            "-10,3\n",
            "-20 4\n",
            "-0.001,0\n",
            "9999.999,1\n",
            "run: 1 -\n",
            "run: 2 +\n",
            "255 -10 1\n",
            "backlash=7\n",
            "-2540 -255\n",
            "nan,inf\n",
            "1e300 1\n",
            "偏差,;\n",
            "1 2 -3\n",
            "2 3 4\n",
        ];
        let mut seed = 7_u64;
        let mut throw = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % below
        };
        let (mut tables, mut plans) = (0, 0);
        for _ in 0..20_000 {
            let lines = (0..throw(7)).map(|_| LINES[throw(LINES.len())]);
            let lines: String = lines.collect();
            let text = format!("{}{lines}", HEADS[throw(HEADS.len())]);
            let own = (Parameters::default(), PitchTable::default());
            let changes = match read(&text) {
                Ok(Imported::Table(table)) => add_table(Axis::Z, &table, &own.0, &own.1, false),
                Ok(Imported::Measured(measured)) => {
                    let interval = [None, Some(Travel(0.001)), Some(Travel(7.5))][throw(3)];
                    let wish = PlanWish {
                        interval,
                        clear: throw(2) == 0,
                    };
                    crate::fit(&measured, Direction::Minus)
                        .and_then(|fit| plan(Axis::X, &fit, &own.0, &own.1, wish))
                        .inspect(|_| plans += 1)
                        .map(|plan| plan.proposal)
                }
                Err(_) => continue,
            };
            let Ok(proposal) = changes else {
                continue;
            };
            tables += 1;
            let (mut parameters, mut pitch) = own;
            for change in proposal.changes {
                change.apply(&mut parameters, &mut pitch).unwrap();
            }
        }
        assert!(tables > 100 && plans > 20, "{tables} {plans}");
    }
}
