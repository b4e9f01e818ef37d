//! What the window and the thread that executes the program exchange.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};

use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_messages::Message;
use gsk_runner::machining::part_comparison::PartComparison;
use gsk_runner::times::ProgramTimes;
use gsk_workpiece::job::Job;

use super::super::load_curve::LoadCurve;
use super::super::path::{BlockRef, DrawnPath};

/// The result of executing a program for the machine view.
#[derive(Clone, Debug, Default)]
pub struct PreviewResult {
    /// The path of the program, partial while the execution runs.
    pub path: Arc<DrawnPath>,
    /// The machine time of the program by its uses and tools.
    pub times: ProgramTimes,
    /// The alarm that ends the program; `None` if it ends without one.
    pub alarm: Option<Alarm>,
    /// The block of a profile that breaks a rule of its cycle; `None` if there is none. With
    /// such a block the path is the profile without the cycle.
    pub fault_block: Option<BlockRef>,
    /// Whether the executed text is a trial that differs from the control's.
    pub is_trial: bool,
    /// Whether the job is a practice job, because no program determines the part.
    pub is_practice_job: bool,
    /// Whether stock and tools are those of the forms in the program.
    pub is_form_job: bool,
    /// Whether the user has changed the job of the program.
    pub is_changed_job: bool,
    /// Numbers of the tools of the program whose offset in the control is 0 in X and Z.
    pub unset_tools: Vec<u8>,
    /// Whether the program is that of a lesson or an exercise.
    pub is_practice_machine: bool,
    /// The reason why the program's job file cannot be used; `None` if it can or does not exist.
    pub job_file_error: Option<Message>,
    /// The file of the program; `None` without one.
    pub program_file: Option<PathBuf>,
    /// Whether the tool post is on the far side of the spindle.
    pub rear_tool_post: bool,
    /// Number of programs so far. The picture is fitted again when it changes.
    pub program_count: u64,
}

/// Flags by which the window controls the preview thread.
#[derive(Debug)]
pub struct WorkerFlags {
    /// Whether the view is open, so that it needs the path of the program as well as its job.
    pub visible: AtomicBool,
    /// Whether a program runs. Offsets and parameters that it writes then start no execution.
    pub program_runs: AtomicBool,
    /// Incremented by the window when the execution in progress is out of date.
    pub cancel_count: AtomicU64,
}

/// The newest results of the preview thread, for the window.
#[derive(Clone, Debug)]
pub(super) struct PreviewOutputs {
    pub results: Arc<ArrayQueue<PreviewResult>>,
    pub compared: Arc<ArrayQueue<Arc<PartComparison>>>,
    pub loads: Arc<ArrayQueue<Arc<LoadCurve>>>,
}

/// A request of the window to the preview thread.
pub(super) enum PreviewRequest {
    /// The program with this id was opened from this file.
    Opened(ProgramId, PathBuf),
    /// Compare the part that the program makes with the intended part.
    Compare(Arc<Job>),
    /// Compute the load of the program in the stock of a job.
    ComputeLoad(Arc<Job>),
    /// Clamp the stock and mount the tools of a job that the user has changed.
    Clamp(Box<Job>),
    /// The program with this id was opened anew, and its own job applies again.
    Reopened(ProgramId),
    /// Execute this text of a program instead of the control's; `None`: the control's text
    /// again.
    SetTrial(Option<(ProgramId, Program)>),
}
