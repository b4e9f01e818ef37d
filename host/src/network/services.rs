//! The services that run: what feeds them, and their states.

use std::path::PathBuf;

use gsk_core::simulation::Simulation;
use gsk_messages::{Language, Message, say};
use gsk_runner::machining::CutLoad;
use gsk_workpiece::job::Job;

use super::settings::{AgentSettings, BrokerSettings, ClassSettings, NetworkSettings};
use crate::message_format::describe_io_error;
use crate::network::class::class_address::{ClassAddress, ClassCode};
use crate::network::class::{SeatFeed, SeatOptions, start_seat};
use crate::network::mqtt::{
    self, BrokerLine, DEFAULT_DISCOVERY_PREFIX, DEFAULT_RATE_HZ, LatheOptions, parse_broker,
};
use crate::network::mtconnect::{AgentFeed, AgentServer, SchemaVersion, parse_address};
use crate::network::service_state::{ServiceState, SharedServiceState};

/// The states of all services, for the window.
#[derive(Clone, Debug, Default)]
pub struct NetworkStates {
    /// The MTConnect agent.
    pub agent: SharedServiceState,
    /// The connection to the MQTT broker.
    pub broker: SharedServiceState,
    /// The connection to the broker of the class.
    pub class: SharedServiceState,
}

/// The services that follow the ticks of a machine.
#[derive(Debug, Default)]
pub struct NetworkServices {
    states: NetworkStates,
    settings: NetworkSettings,
    agent_feed: Option<AgentFeed>,
    /// The agent that the settings have switched on.
    agent_server: Option<AgentServer>,
    broker_feed: Option<AgentFeed>,
    /// The connection that the settings have switched on.
    broker_line: Option<BrokerLine>,
    /// The seat of a class, with its connection.
    seat: Option<(SeatFeed, BrokerLine)>,
}

impl NetworkServices {
    /// The states of the services.
    pub const fn states(&self) -> &NetworkStates {
        &self.states
    }

    /// Feeds an MTConnect agent that an option of the command line has started at `url`.
    pub fn connect_agent(&mut self, feed: AgentFeed, url: String) {
        self.agent_feed = Some(feed);
        self.states.agent.mark_by_option();
        self.states.agent.set(ServiceState::Listening(url));
    }

    /// Feeds a connection to an MQTT broker that an option of the command line has started.
    pub fn connect_broker(&mut self, feed: AgentFeed) {
        self.broker_feed = Some(feed);
        self.states.broker.mark_by_option();
    }

    /// Switches services on and off whose settings have changed. Returns whether the seat of a
    /// class has begun.
    pub fn apply(
        &mut self,
        settings: &NetworkSettings,
        simulation: &Simulation,
        language: Language,
    ) -> bool {
        if self.settings.agent != settings.agent && !self.states.agent.is_by_option() {
            (self.agent_feed, self.agent_server) = (None, None);
            self.states.agent.set(ServiceState::Off);
            if settings.agent.is_on
                && let Err(reason) = self.start_agent(&settings.agent, simulation)
            {
                self.states.agent.set(ServiceState::Failed(reason));
            }
        }
        if self.settings.broker != settings.broker && !self.states.broker.is_by_option() {
            self.broker_feed = None;
            if let Some(line) = self.broker_line.take() {
                line.end_in_background();
            }
            self.states.broker.set(ServiceState::Off);
            if settings.broker.is_on
                && let Err(reason) = self.start_broker(&settings.broker, simulation, language)
            {
                self.states.broker.set(ServiceState::Failed(reason));
            }
        }
        let begins_class = self.settings.class != settings.class;
        if begins_class {
            if let Some((_, line)) = self.seat.take() {
                line.end_in_background();
            }
            self.states.class.set(ServiceState::Off);
            if settings.class.is_on
                && let Err(reason) = self.start_seat(&settings.class)
            {
                self.states.class.set(ServiceState::Failed(reason));
            }
        }
        self.settings.clone_from(settings);
        begins_class
    }

    fn start_seat(&mut self, settings: &ClassSettings) -> Result<(), Message> {
        let name = settings.name.trim();
        if name.is_empty() {
            return Err(say::class_name_missing());
        }
        let code = ClassCode::parse(settings.code.trim()).map_err(|error| error.message())?;
        let mut broker = parse_broker(settings.broker.trim()).map_err(|error| error.message())?;
        broker.ca_file = ca_file(&settings.ca);
        if !settings.password.is_empty() {
            broker.password = Some(settings.password.clone());
        }
        mqtt::read_password(&mut broker, None)?;
        let options = SeatOptions {
            class: ClassAddress { code, broker },
            name: name.to_owned(),
        };
        let started = start_seat(&options, self.states.class.clone());
        let (line, feed) = started.map_err(|error| describe_io_error(&error))?;
        self.seat = Some((feed, line));
        Ok(())
    }

    /// Whether this is a seat of a class.
    pub const fn has_seat(&self) -> bool {
        self.seat.is_some()
    }

    /// The seat of a class; `None` outside a class.
    pub fn seat_feed(&mut self) -> Option<&mut SeatFeed> {
        self.seat.as_mut().map(|(feed, _)| feed)
    }

    /// The learner's name in the class, and whether he allows faults.
    pub fn seat_name(&self) -> (&str, bool) {
        let class = &self.settings.class;
        (class.name.trim(), class.allows_faults)
    }

    fn start_agent(
        &mut self,
        settings: &AgentSettings,
        simulation: &Simulation,
    ) -> Result<(), Message> {
        let address = parse_address(settings.address.trim()).map_err(|error| error.message())?;
        let started = AgentServer::start(&address, SchemaVersion::default(), simulation);
        let (server, feed) = started.map_err(|error| error.message())?;
        self.states.agent.set(ServiceState::Listening(server.url()));
        (self.agent_feed, self.agent_server) = (Some(feed), Some(server));
        Ok(())
    }

    fn start_broker(
        &mut self,
        settings: &BrokerSettings,
        simulation: &Simulation,
        language: Language,
    ) -> Result<(), Message> {
        let mut url = parse_broker(settings.url.trim()).map_err(|error| error.message())?;
        url.ca_file = ca_file(&settings.ca);
        if !settings.password.is_empty() {
            url.password = Some(settings.password.clone());
        }
        mqtt::read_password(&mut url, None)?;
        let options = LatheOptions {
            discovery_prefix: settings
                .has_discovery
                .then(|| DEFAULT_DISCOVERY_PREFIX.to_owned()),
            rate_hz: DEFAULT_RATE_HZ,
            language,
        };
        let state = self.states.broker.clone();
        let failed = |error| say::mqtt_failed(&url, describe_io_error(&error));
        let started = mqtt::start_publishing(&url, &options, simulation, state);
        let (line, feed) = started.map_err(failed)?;
        (self.broker_feed, self.broker_line) = (Some(feed), Some(line));
        Ok(())
    }

    /// Whether a service needs the state of the machine.
    pub const fn follows_ticks(&self) -> bool {
        self.agent_feed.is_some() || self.broker_feed.is_some()
    }

    /// Passes the state of the machine on after a tick. `job` is the job of the program, `load`
    /// that of the current cut.
    pub fn follow_tick(
        &mut self,
        simulation: &Simulation,
        job: Option<&Job>,
        load: Option<CutLoad>,
    ) {
        for feed in self.agent_feed.iter_mut().chain(&mut self.broker_feed) {
            feed.follow_tick(simulation, job, load);
        }
    }
}

/// The file with authorities that a field names; `None` for an empty one.
fn ca_file(field: &str) -> Option<PathBuf> {
    let path = field.trim();
    (!path.is_empty()).then(|| PathBuf::from(path))
}
