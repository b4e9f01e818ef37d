//! `plot`: the toolpath as a picture.

use gsk_core::preview::{End, preview};
use gsk_core::setup::Setup;

use super::run::title;
use super::{ALARM, FINE};
use crate::cli::PlotArgs;
use crate::picture::{self, Drawing, RapidRates};
use crate::report::AlarmReport;
use crate::{loading, retained};

/// Draws a program. What comes before an alarm is drawn, too.
pub fn plot(args: &PlotArgs) -> Result<u8, String> {
    picture::check_name(&args.output)?;
    let mut setup = Setup::default();
    if let Some(path) = &args.setup.data {
        let data =
            crate::files::data_dir::DataDir::open(path).map_err(|error| error.to_string())?;
        for complaint in retained::load(&data, &mut setup).complaints {
            eprintln!("gsk980td: {complaint}");
        }
    }
    loading::apply(&mut setup, &args.setup)?;
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
