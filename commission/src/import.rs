//! Detects the format of a measurement file and parses it.

use crate::file_line::FileFault;
use crate::renishaw_ren::ImportedFile;
use crate::{csv, renishaw_ren, renishaw_rtl};

/// Parses a measurement file for X or Z of a lathe. A heading with columns means CSV, a heading
/// `TARGET DATA::` RTL, anything else REN.
///
/// # Errors
/// Returns the first line that is malformed, with the rule.
pub fn read_measurement_file(text: &str) -> Result<ImportedFile, FileFault> {
    read_measurement_file_with_axes(text, &['X', 'Z'])
}

/// Parses a measurement file for a machine whose axes have these letters.
///
/// # Errors
/// Returns the first line that is malformed, with the rule.
pub fn read_measurement_file_with_axes(
    text: &str,
    axes: &[char],
) -> Result<ImportedFile, FileFault> {
    let text = text.trim_start_matches('\u{feff}');
    if csv::is_csv(text) {
        csv::read(text).map(ImportedFile::Measured)
    } else if renishaw_rtl::is_rtl(text) {
        renishaw_rtl::read(text).map(ImportedFile::Measured)
    } else {
        renishaw_ren::read(text, axes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::{ApproachDirection, SlideTravel};
    use crate::pitch_plan::{PitchPlanOptions, plan_pitch_table};
    use crate::table_file::propose_table_values;
    use gsk_core::memory::{ControlParameters, PitchTable};
    use gsk_core::units::Axis;

    /// Random texts of lines of all formats: each text that parses is fitted, planned or refused,
    /// and the control accepts every plan.
    #[test]
    fn random_texts_never_panic() {
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
            let own = (ControlParameters::default(), PitchTable::default());
            let changes = match read_measurement_file(&text) {
                Ok(ImportedFile::Table(table)) => {
                    propose_table_values(Axis::Z, &table, &own.0, &own.1, false)
                }
                Ok(ImportedFile::Measured(measured)) => {
                    let interval =
                        [None, Some(SlideTravel(0.001)), Some(SlideTravel(7.5))][throw(3)];
                    let options = PitchPlanOptions {
                        interval,
                        clear: throw(2) == 0,
                    };
                    crate::fit_screw(&measured, ApproachDirection::Minus)
                        .and_then(|fit| plan_pitch_table(Axis::X, &fit, &own.0, &own.1, options))
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
