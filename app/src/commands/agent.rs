//! Starts the MTConnect agent of a command.

use gsk_core::simulation::Simulation;
use gsk_host::mtconnect::{AgentFeed, AgentServer, MachinePacer};
use gsk_messages::say;
use gsk_runner::script::TickObserver;
use gsk_workpiece::job::Job;

use super::{CommandError, output};
use crate::cli::MtconnectArgs;

/// Starts the agent if an option requests it, and reports its address. Returns an error if it
/// cannot listen.
pub fn start_agent(
    args: &MtconnectArgs,
    simulation: &Simulation,
) -> Result<Option<(AgentServer, AgentFeed)>, CommandError> {
    let Some(address) = &args.mtconnect else {
        return Ok(None);
    };
    let schema = args.mtconnect_schema.unwrap_or_default();
    let (server, feed) =
        AgentServer::start(address, schema, simulation).map_err(|error| error.message())?;
    output::report_error(&say::mtconnect_listening(server.url()));
    Ok(Some((server, feed)))
}

/// The MTConnect agent of a command that executes the ticks of the machine itself.
pub struct CommandAgent {
    feed: AgentFeed,
    /// Job of the program; `None` without one.
    job: Option<Job>,
    /// Slows a simulated machine down; `None` with a board, which sets the pace.
    pacer: Option<MachinePacer>,
    /// The server that answers requests while the command runs.
    _server: AgentServer,
}

impl CommandAgent {
    /// Starts the agent if an option requests it. `job` is the job of the program; `has_board`: a
    /// board moves the slides. Returns an error if the agent cannot listen.
    pub fn start(
        args: &MtconnectArgs,
        simulation: &Simulation,
        job: Option<Job>,
        has_board: bool,
    ) -> Result<Option<Self>, CommandError> {
        let started = start_agent(args, simulation)?;
        Ok(started.map(|(server, feed)| Self {
            feed,
            job,
            pacer: (!has_board).then(MachinePacer::default),
            _server: server,
        }))
    }
}

impl TickObserver for CommandAgent {
    /// Passes the state on. A simulated machine keeps to the speed of a real lathe.
    fn follow_tick(&mut self, simulation: &Simulation) {
        self.feed.follow_tick(simulation, self.job.as_ref());
        if let Some(pacer) = &mut self.pacer {
            pacer.wait_for_tick();
        }
    }
}
