//! `plot`: the toolpath as a picture.

use gsk_core::preview::{End, preview};

use super::run::title;
use super::{ALARM, FINE};
use crate::cli::PlotArgs;
use crate::loading;
use crate::picture::{self, Drawing, RapidRates};
use crate::report::AlarmReport;

/// Draws a program. What comes before an alarm is drawn, too.
pub fn plot(args: &PlotArgs) -> Result<u8, String> {
    picture::check_name(&args.output)?;
    let mut setup = loading::setup(&args.setup)?;
    loading::open(&mut setup, std::slice::from_ref(&args.file))?.print();
    let rates = RapidRates::of(&setup.parameters);
    let mut drawing = Drawing::new(title(&args.file));
    let preview = preview(&setup, &setup.programs, &mut |executed| {
        drawing.push(executed, rates);
    });
    picture::write(&args.output, &drawing)?;
    if let Some(alarm) = &preview.alarm {
        eprintln!(
            "gsk980td: {}",
            AlarmReport::new(alarm, &setup.programs).sentence()
        );
    }
    Ok(if matches!(preview.end, End::Alarm | End::Limit) {
        ALARM
    } else {
        FINE
    })
}
