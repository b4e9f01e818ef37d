//! `plot`: draws the toolpath as a picture.

use core::iter;

use gsk_core::preview::{CautionKind, preview_with_progress};
use gsk_core::setup::Setup;
use gsk_host::files::overwrite_guard::{CommandInputs, check_overwrites};
use gsk_host::{job, loading};
use gsk_messages::Language;
use gsk_plot::{PathDrawing, PictureFormat};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report;
use gsk_window::{SceneRecorder, encode_scene};

use super::results::{report_end, report_picture};
use super::run::picture_title;
use super::{CommandError, EXIT_COLLISION, mill, output};
use crate::cli::PlotArgs;
use crate::picture::{PictureNameError, check_name};

/// Draws the toolpath of a program into a picture. The moves before an alarm are drawn as
/// well.
pub fn plot(args: &PlotArgs, language: Option<Language>) -> Result<u8, CommandError> {
    if args.setup.selected_model().is_mill() {
        return mill::plot(args, language);
    }
    check_name(&args.output)?;
    let format = PictureFormat::from_file_name(&args.output)?;
    if (args.solid || args.scene.scene) && format != PictureFormat::Png {
        return Err(PictureNameError::SolidNotPng(args.output.clone()).into());
    }
    let main = args.file.as_path();
    let inputs = CommandInputs {
        files: iter::once(main).chain(args.setup.input_files()).collect(),
        main_program: Some(main),
        data_dir: args.setup.data.as_deref(),
    };
    check_overwrites(&inputs, &[&args.output])?;
    let mut setup = loading::command_setup(&args.setup, args.look.work_zero, language)?;
    loading::open_program(&mut setup, std::slice::from_ref(&args.file))?.print(language);
    let target = output::reserve_file(&args.output)?;
    let rates = RapidRates::from_memory(&setup.memory);
    let mut drawing = PathDrawing::new(picture_title(&args.file), args.picture.to_look());
    let needs_part = args.solid || args.scene.scene || args.picture.needs_part();
    let mut machining = match args.part.is_requested() || needs_part {
        true => {
            let job_choice = job::choose(&args.part, Some(main), &setup)?;
            if let Some(message) = job_choice.set_work_zero(&mut setup) {
                complain!("gsk980td: {}", report::message_text(&message, language));
            }
            Some(job_choice.create_machining())
        }
        false => None,
    };
    let rear_tool_post = setup.lathe.rear_tool_post;
    let mut recorder = machining
        .as_ref()
        .filter(|_| args.scene.scene)
        .map(|machining| create_recorder(args, machining, &setup));
    let mut watch = output::watch_preview(&setup.memory.programs, args.look.limits.start(), true);
    let preview = preview_with_progress(
        &setup,
        &setup.memory.programs,
        &mut |executed| {
            drawing.add_move(executed, rates);
            match (&mut machining, &mut recorder) {
                (Some(part), Some(recorder)) => recorder.execute_move(part, executed, rates),
                (Some(part), None) => part.execute_move(executed, rates),
                (None, _) => {}
            }
        },
        &mut |progress| watch.update_progress(progress),
    );
    drop(watch);
    drawing.end(preview.time_s);
    let size = drawing.options().size;
    let bytes = match (&machining, recorder) {
        (Some(machining), Some(recorder)) => {
            let lathes = recorder.into_lathes(machining);
            encode_scene(&lathes, args.scene.camera.into(), size)?
        }
        (Some(machining), None) if args.solid => {
            gsk_plot::encode_solid(machining, rear_tool_post, &drawing.title, size)?
        }
        _ => {
            if let Some(machining) = &machining {
                drawing.add_scenery(machining);
            }
            gsk_plot::encode(format, &drawing, language.unwrap_or(Language::En))?
        }
    };
    target.write(&bytes)?;
    let shortfall =
        gsk_plot::missing_moves_message(&drawing).filter(|_| !args.solid && !args.scene.scene);
    report_picture(args, preview.time_s, shortfall.as_ref(), language);
    let cautions = preview.cautions.iter();
    for caution in cautions.filter(|caution| caution.kind == CautionKind::MachineZero) {
        let text = report::message_text(&caution.message_with_line(), language);
        complain!("gsk980td: {text}");
    }
    let programs = &setup.memory.programs;
    let exit_code = report_end(
        args,
        preview.end,
        preview.alarm.as_ref(),
        programs,
        language,
    );
    let collided = machining.is_some_and(|machining| !machining.findings().is_empty());
    Ok(if collided { EXIT_COLLISION } else { exit_code })
}

/// Creates the recorder that draws the lathe in 3D.
fn create_recorder(args: &PlotArgs, machining: &Machining, setup: &Setup) -> SceneRecorder {
    let frames = args.scene.frames.unwrap_or(1);
    let time_s = match frames {
        1 => 0.0,
        _ => find_duration_s(args, setup),
    };
    SceneRecorder::new(machining, &setup.lathe, frames as usize, time_s)
}

/// The machine time of the program, s, up to an alarm or a limit.
fn find_duration_s(args: &PlotArgs, setup: &Setup) -> f64 {
    let mut watch = output::watch_preview(&setup.memory.programs, args.look.limits.start(), true);
    let preview = preview_with_progress(
        setup,
        &setup.memory.programs,
        &mut |_| {},
        &mut |progress| watch.update_progress(progress),
    );
    preview.time_s
}
