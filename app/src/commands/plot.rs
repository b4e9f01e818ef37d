//! `plot`: draws the toolpath as a picture.

use gsk_core::preview::{End, Slip, preview_while};
use gsk_messages::{Language, say};
use gsk_runner::curves::RapidRates;
use gsk_runner::picture::{self, Drawing, Format};
use gsk_runner::report::{self, AlarmReport};
use gsk_runner::words::clock;

use super::run::title;
use super::{ALARM, COLLISION, CommandError, FINE, mill, output};
use crate::apart::{Read, keep_apart};
use crate::cli::PlotArgs;
use crate::picture::{NameError, check_name};
use crate::{job, loading};

/// Draws a program. The moves before an alarm are drawn as well.
pub fn plot(args: &PlotArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.setup.model().is_mill() {
        return mill::plot(args, language);
    }
    check_name(&args.output)?;
    let format = Format::of(&args.output)?;
    if args.solid && format != Format::Png {
        return Err(NameError::NoLines(args.output.clone()).into());
    }
    let main = args.file.as_path();
    let read = Read {
        files: core::iter::once(main)
            .chain(args.setup.read_files())
            .collect(),
        main: Some(main),
        data: args.setup.data.as_deref(),
    };
    keep_apart(&read, &[&args.output])?;
    let mut setup = loading::setup(&args.setup, args.look.work_zero, language)?;
    loading::open(&mut setup, std::slice::from_ref(&args.file))?.print(language);
    let target = output::reserve(&args.output)?;
    let rates = RapidRates::of(&setup.memory);
    let mut drawing = Drawing::new(title(&args.file), args.picture.look());
    let mut machining = match args.part.wanted() || args.solid || args.picture.needs_part() {
        true => {
            let chosen = job::choose(&args.part, Some(main), &setup)?;
            if let Some(said) = chosen.set_work_zero(&mut setup) {
                complain!("gsk980td: {}", report::said(&said, language));
            }
            Some(chosen.machining())
        }
        false => None,
    };
    let mut watch = output::watch(&setup.memory.programs, args.look.limits.begin(), true);
    let preview = preview_while(
        &setup,
        &setup.memory.programs,
        &mut |executed| {
            drawing.push(executed, rates);
            if let Some(machining) = &mut machining {
                machining.moved(executed, rates);
            }
        },
        &mut |progress| watch.goes_on(progress),
    );
    drop(watch);
    drawing.end(preview.time_s);
    let bytes = match &machining {
        Some(machining) if args.solid => {
            let rear = setup.lathe.rear_tool_post;
            picture::of_solid(machining, rear, &drawing.title, drawing.look().size)?
        }
        _ => {
            if let Some(machining) = &machining {
                drawing.stand_before(machining);
            }
            picture::encode(format, &drawing, language.unwrap_or(Language::En))?
        }
    };
    target.write(&bytes)?;
    let drawn = say::plot_written(args.output.display(), clock(preview.time_s));
    output::print(&format!("{}\n", report::said(&drawn, language)));
    let shortfall = picture::shortfall(&drawing).filter(|_| !args.solid);
    if let Some(said) = shortfall {
        complain!("gsk980td: {}", report::said(&said, language));
    }
    let of_place = preview.cautions.iter();
    for caution in of_place.filter(|caution| caution.slip == Slip::MachineZero) {
        let said = report::said(&caution.sentence(), language);
        complain!("gsk980td: {said}");
    }
    if let Some(alarm) = &preview.alarm {
        let alarm = AlarmReport::new(alarm, &setup.memory.programs, language);
        complain!("gsk980td: {}", alarm.sentence(language));
    }
    if preview.end == End::Limit {
        let said = report::said(&say::report_limit(), language);
        complain!("gsk980td: {}: {said}", args.file.display());
    }
    let collided = machining.is_some_and(|machining| !machining.findings().is_empty());
    Ok(match preview.end {
        _ if collided => COLLISION,
        End::Alarm | End::Limit => ALARM,
        End::M30 | End::M02 | End::M99 | End::Text => FINE,
    })
}
