//! Starts what the options of a command switch on in the network.

use gsk_core::simulation::Simulation;
use gsk_host::message_format::describe_io_error;
use gsk_host::network::mqtt::{self, BrokerLine, DEFAULT_RATE_HZ, LatheOptions};
use gsk_host::network::mtconnect::{AgentFeed, AgentServer, MachinePacer};
use gsk_host::network::service_state::{ServiceState, SharedServiceState};
use gsk_messages::say;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::script::TickObserver;

use super::{CommandError, output};
use crate::cli::{MqttArgs, MtconnectArgs};

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

/// Starts to publish to a broker if an option requests it. Returns an error if the password cannot
/// be read or the system starts no thread; a broker that is not reached yet is no error.
pub fn start_broker_line(
    args: &MqttArgs,
    simulation: &Simulation,
    state: SharedServiceState,
) -> Result<Option<(BrokerLine, AgentFeed)>, CommandError> {
    let Some(url) = &args.mqtt else {
        return Ok(None);
    };
    let mut url = url.clone();
    url.ca_file.clone_from(&args.mqtt_ca);
    mqtt::read_password(&mut url, args.mqtt_password_file.as_deref())?;
    let options = LatheOptions {
        discovery_prefix: args.mqtt_discovery.clone(),
        rate_hz: args.mqtt_rate.unwrap_or(DEFAULT_RATE_HZ),
        language: output::language(),
    };
    let failed = |error| say::mqtt_failed(&url, describe_io_error(&error));
    let started = mqtt::start_publishing(&url, &options, simulation, state);
    Ok(Some(started.map_err(failed)?))
}

/// Reports a new state of the connection to a broker.
fn report_broker(state: &ServiceState) {
    match state {
        ServiceState::Connected(url) => output::report_error(&say::mqtt_connected(url)),
        ServiceState::Failed(reason) => output::report_error(reason),
        ServiceState::Off | ServiceState::Listening(_) | ServiceState::Connecting(_) => {}
    }
}

/// Passes the state of a machine that a command ticks itself to the network.
pub struct CommandNetwork {
    feeds: Vec<AgentFeed>,
    /// The part that the program makes; `None` without a job.
    part: Option<LivePart>,
    /// Slows a simulated machine down; `None` with a board, which sets the pace.
    pacer: Option<MachinePacer>,
    /// Answers requests as long as the command runs.
    _server: Option<AgentServer>,
    /// Publishes as long as the command runs.
    _line: Option<BrokerLine>,
}

impl CommandNetwork {
    /// Starts what the options request; `None` if they request nothing. `part` is the part that the
    /// program makes; `has_board`: a board moves the slides. Returns an error if the agent cannot listen
    /// or the password cannot be read.
    pub fn start(
        (agent, broker): (&MtconnectArgs, &MqttArgs),
        simulation: &Simulation,
        part: Option<LivePart>,
        has_board: bool,
    ) -> Result<Option<Self>, CommandError> {
        let agent = start_agent(agent, simulation)?;
        let state = SharedServiceState::with_report(report_broker);
        let broker = start_broker_line(broker, simulation, state)?;
        let (server, agent_feed) = agent.unzip();
        let (line, broker_feed) = broker.unzip();
        let feeds: Vec<AgentFeed> = agent_feed.into_iter().chain(broker_feed).collect();
        let part = part.map(|mut part| {
            part.set_measures_load(!has_board);
            part
        });
        Ok((!feeds.is_empty()).then(|| Self {
            feeds,
            part,
            pacer: (!has_board).then(MachinePacer::default),
            _server: server,
            _line: line,
        }))
    }
}

impl TickObserver for CommandNetwork {
    /// Passes the state on. A simulated machine keeps to the speed of a real lathe.
    fn follow_tick(&mut self, simulation: &Simulation) {
        let part = self.part.as_mut();
        let (job, load) = part.map_or((None, None), |part| {
            part.follow_tick(simulation);
            (Some(part.machining().job()), part.load())
        });
        for feed in &mut self.feeds {
            feed.follow_tick(simulation, job, load);
        }
        if let Some(pacer) = &mut self.pacer {
            pacer.wait_for_tick();
        }
    }
}
