//! A connection to a broker on this computer that the test itself plays.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_messages::Language;
use web_time::{Duration, Instant};

use super::{BrokerLine, BrokerUrl, LatheOptions, parse_rate, start_publishing};
use crate::network::mtconnect::AgentFeed;
use crate::network::service_state::{ServiceState, SharedServiceState};

const WAIT: Duration = Duration::from_secs(10);
const ACCEPTED: [u8; 4] = [0x20, 2, 0, 0];

struct Bench {
    simulation: Simulation,
    listener: TcpListener,
    url: BrokerUrl,
    state: SharedServiceState,
    started: Option<(BrokerLine, AgentFeed)>,
}

impl Bench {
    fn new() -> Self {
        let simulation = Simulation::new(Setup::default());
        let listener = TcpListener::bind("127.0.0.1:0").expect("listens");
        let address = listener.local_addr().expect("an address");
        let url = BrokerUrl::parse(&format!("mqtt://{address}/hall/7")).expect("an address");
        let state = SharedServiceState::default();
        let options = LatheOptions {
            discovery_prefix: None,
            rate_hz: 4,
            language: Language::En,
        };
        let started = start_publishing(&url, &options, &simulation, state.clone());
        Self {
            simulation,
            listener,
            url,
            state,
            started: Some(started.expect("a thread")),
        }
    }

    /// Takes the next client, and answers its CONNECT.
    fn accept(&self) -> TcpStream {
        let (mut stream, _) = self.listener.accept().expect("a client");
        stream.set_read_timeout(Some(WAIT)).expect("an option");
        let mut bytes = [0; 512];
        let count = stream.read(&mut bytes).expect("CONNECT");
        let text = String::from_utf8_lossy(&bytes[..count]).into_owned();
        assert!(bytes[0] == 0x10 && text.contains("hall/7/online"), "{text}");
        stream.write_all(&ACCEPTED).expect("sent");
        stream
    }

    fn tick(&mut self, ticks: u32) {
        let feed = self.started.as_mut().map(|(_, feed)| feed);
        let feed = feed.expect("runs");
        for _ in 0..ticks {
            self.simulation.tick();
            feed.follow_tick(&self.simulation, None, None);
        }
    }

    fn wait_for(&self, is_reached: impl Fn(&ServiceState) -> bool) {
        let end = Instant::now() + WAIT;
        while !is_reached(&self.state.get()) {
            assert!(Instant::now() < end, "{:?}", self.state.get());
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Reads until a text has arrived; returns everything.
fn read_until(stream: &mut TcpStream, text: &str) -> String {
    let mut received = String::new();
    while !received.contains(text) {
        let mut bytes = [0; 4096];
        let count = stream.read(&mut bytes).expect("received");
        assert!(count > 0, "{text}: {received}");
        received.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    received
}

#[test]
fn a_lathe_publishes_and_says_when_it_leaves() {
    let mut bench = Bench::new();
    let mut stream = bench.accept();
    bench.tick(40);
    read_until(&mut stream, "\"execution\":\"READY\"");
    let address = bench.url.to_string();
    bench.wait_for(|state| *state == ServiceState::Connected(address.clone()));
    bench.started.take();
    let last = read_until(&mut stream, "offline");
    // DISCONNECT follows: the broker keeps the last will to itself.
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).expect("the end");
    let ends_so = last.ends_with("\u{fffd}\0") || rest.ends_with(&[0xe0, 0]);
    assert!(ends_so, "{last:?} {rest:?}");
}

#[test]
fn a_broker_that_returns_receives_the_whole_state_again() {
    let mut bench = Bench::new();
    let mut stream = bench.accept();
    bench.tick(40);
    read_until(&mut stream, "\"execution\":\"READY\"");
    drop(stream);
    bench.wait_for(|state| matches!(state, ServiceState::Failed(_)));
    let gone = Instant::now();
    let mut stream = bench.accept();
    read_until(&mut stream, "\"execution\":\"READY\"");
    assert!(gone.elapsed() < Duration::from_secs(5));
}

#[test]
fn a_broker_that_reads_nothing_does_not_delay_ticks() {
    let mut bench = Bench::new();
    let stream = bench.accept();
    let start = Instant::now();
    // Far more states than queue and connection hold.
    bench.tick(60_000);
    let with_broker = start.elapsed();
    drop(stream);
    let mut alone = Simulation::new(Setup::default());
    let start = Instant::now();
    for _ in 0..60_000 {
        alone.tick();
    }
    let limit = start.elapsed() * 20 + Duration::from_secs(5);
    assert!(with_broker < limit, "{with_broker:?}");
}

#[test]
fn rates_have_limits() {
    assert_eq!(parse_rate("1"), Ok(1));
    assert_eq!(parse_rate("50"), Ok(50));
    for word in ["0", "51", "-1", "x", ""] {
        assert!(parse_rate(word).is_err(), "{word}");
    }
}
