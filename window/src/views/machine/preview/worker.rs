//! The window's handle of the thread that executes the selected program for the machine view: its
//! path, its times, and the job of its part.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crossbeam::channel::{Sender, unbounded};
use crossbeam::queue::ArrayQueue;
use egui::Context;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_host::kernel::Console;
use gsk_host::platform;
use gsk_runner::machining::part_comparison::PartComparison;
use gsk_workpiece::job::Job;

use super::super::load_curve::LoadCurve;
use super::changed_jobs::ChangedJobs;
use super::exchange::{PreviewOutputs, PreviewRequest, PreviewResult, WorkerFlags};
use super::thread::PreviewThread;

/// The window's handle of the preview worker, which ends when the handle is dropped.
pub struct PreviewWorker {
    requests: Sender<PreviewRequest>,
    outputs: PreviewOutputs,
    /// Flags by which the window controls the preview thread.
    pub flags: Arc<WorkerFlags>,
}

impl PreviewWorker {
    /// Starts the worker thread. `changed` holds the jobs that the user has changed.
    pub fn start(console: &Console, context: &Context, changed: &ChangedJobs) -> Self {
        let (requests, from_view) = unbounded();
        let outputs = PreviewOutputs {
            results: Arc::new(ArrayQueue::new(1)),
            compared: Arc::new(ArrayQueue::new(1)),
            loads: Arc::new(ArrayQueue::new(1)),
        };
        let flags = Arc::new(WorkerFlags {
            visible: AtomicBool::new(false),
            program_runs: AtomicBool::new(false),
            cancel_count: AtomicU64::new(0),
        });
        let control = (console.clone(), context.clone());
        let (to_window, with) = (outputs.clone(), Arc::clone(&flags));
        let mut work = PreviewThread::new(control, from_view, to_window, with, changed.clone());
        // Without a thread there is no path in the picture. Nothing else depends on it.
        let _ = platform::start_task("lathe view", move || work.run_once());
        Self {
            requests,
            outputs,
            flags,
        }
    }

    /// Reports to the worker that a program was opened from a file.
    pub fn report_opened_file(&self, program: ProgramId, file: PathBuf) {
        self.flags.cancel_count.fetch_add(1, Ordering::Relaxed);
        let _ = self.requests.send(PreviewRequest::Opened(program, file));
    }

    /// Reports to the worker that a program without a file, such as a sample, was opened anew: its
    /// own stock and tools replace those to which the user has changed them.
    pub fn report_reopened(&self, program: ProgramId) {
        let _ = self.requests.send(PreviewRequest::Reopened(program));
    }

    /// Requests a comparison of the intended part with the part that the program makes.
    pub fn compare(&self, job: Arc<Job>) {
        let _ = self.requests.send(PreviewRequest::Compare(job));
    }

    /// Requests the load of the program in the stock of `job`.
    pub fn request_load(&self, job: Arc<Job>) {
        let _ = self.requests.send(PreviewRequest::ComputeLoad(job));
    }

    /// Requests that the stock and the tools of `job` are used. The job belongs to the
    /// selected program until that program gets another one.
    pub fn clamp(&self, job: Job) {
        let _ = self.requests.send(PreviewRequest::Clamp(Box::new(job)));
    }

    /// Requests the execution of another text of a program than the control's; `None`: the
    /// control's text again.
    pub fn set_trial(&self, text: Option<(ProgramId, Program)>) {
        self.flags.cancel_count.fetch_add(1, Ordering::Relaxed);
        let _ = self.requests.send(PreviewRequest::SetTrial(text));
    }

    /// Removes and returns the newest comparison; `None` without a new one.
    pub fn take_comparison(&self) -> Option<Arc<PartComparison>> {
        self.outputs.compared.pop()
    }

    /// Removes and returns the newest load; `None` without a new one.
    pub fn take_load(&self) -> Option<Arc<LoadCurve>> {
        self.outputs.loads.pop()
    }

    /// Removes and returns the newest result; `None` without a new one.
    pub fn take_result(&self) -> Option<PreviewResult> {
        self.outputs.results.pop()
    }
}

impl Drop for PreviewWorker {
    fn drop(&mut self) {
        self.flags.cancel_count.fetch_add(1, Ordering::Relaxed);
    }
}
