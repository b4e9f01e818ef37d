//! The part that the simulated lathe cuts while `operate` plays a script.

use gsk_core::machine::LatheFault;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_history::machine_part::{MachinePart, NamedJob, PartInput};
use gsk_host::job::{self, JobArgs};
use gsk_runner::script::CutFollower;

use super::{CommandError, output};
use crate::cli::OperateArgs;

/// A part whose cuts and collisions have the effects that they have in the window.
pub struct OperatedPart(MachinePart);

impl OperatedPart {
    /// Clamps the stock of the program's job, if the options switch its effects on. Returns an error
    /// if there is no job.
    pub fn from_args(args: &OperateArgs, setup: &Setup) -> Result<Option<Self>, CommandError> {
        if !args.overload {
            return Ok(None);
        }
        let chosen = job::choose(&JobArgs::default(), args.program.as_deref(), setup)?;
        let mut part = MachinePart::default();
        part.apply(PartInput::Overload(true));
        part.apply(PartInput::Job(Some(Box::new(NamedJob {
            name: chosen.file_name(),
            job: chosen.job,
        }))));
        Ok(Some(Self(part)))
    }
}

impl CutFollower for OperatedPart {
    fn follow_tick(&mut self, simulation: &Simulation) -> Vec<LatheFault> {
        let collision = self.0.follow_tick(simulation);
        let effect = self.0.cut_effect(collision.as_ref(), simulation);
        let cut = effect.cut_fault.map(|it| it.message());
        let crash = collision.map(|it| it.collision.message());
        for message in cut.into_iter().chain(crash) {
            output::report_error(&message);
        }
        effect.faults().collect()
    }
}
