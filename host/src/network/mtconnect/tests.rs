//! A server with clients on this computer.

use std::io::{Read, Write};
use std::net::TcpStream;

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_mtconnect::SchemaVersion;
use web_time::{Duration, Instant};

use super::{AgentFeed, AgentServer};

const WAIT: Duration = Duration::from_secs(10);

struct Bench {
    simulation: Simulation,
    feed: AgentFeed,
    server: AgentServer,
    address: String,
}

impl Bench {
    fn new() -> Self {
        let simulation = Simulation::new(Setup::default());
        let schema = SchemaVersion::default();
        let started = AgentServer::start("127.0.0.1:0", schema, &simulation);
        let (server, feed) = started.expect("listens");
        let url = server.url();
        let address = url.trim_start_matches("http://").trim_end_matches('/');
        Self {
            simulation,
            feed,
            address: address.to_owned(),
            server,
        }
    }

    fn tick(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.simulation.tick();
            self.feed.follow_tick(&self.simulation, None, None);
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).expect("connects");
        stream.set_read_timeout(Some(WAIT)).expect("an option");
        stream
    }

    /// Sends bytes to the agent and returns its answer.
    fn send(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        stream.write_all(bytes).expect("sent");
        let mut answer = Vec::new();
        // A refused client may be cut off.
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn get(&self, target: &str) -> String {
        let request =
            format!("GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        self.send(request.as_bytes())
    }

    /// Repeats the request `target` until the answer contains a text.
    fn wait_for(&self, target: &str, text: &str) -> String {
        let end = Instant::now() + WAIT;
        loop {
            let answer = self.get(target);
            if answer.contains(text) {
                return answer;
            }
            assert!(Instant::now() < end, "{text}: {answer}");
        }
    }
}

#[test]
fn clients_read_the_state_of_the_machine() {
    let mut bench = Bench::new();
    bench.tick(100);
    let current = bench.wait_for("/current", ">AVAILABLE</Availability>");
    assert!(current.starts_with("HTTP/1.1 200 OK\r\n"), "{current}");
    assert!(bench.get("/probe").contains("<Linear id=\"x\""));
    assert!(bench.get("/GSK980TD/sample?count=3").contains("<Streams>"));
    assert!(
        bench
            .get("/status.json")
            .contains("\"execution\":\"READY\"")
    );
    assert!(bench.get("/").contains("<MTConnectDevices"));
    let page = bench.send(
        b"GET /?lang=zh HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: text/html\r\n\
          Connection: close\r\n\r\n",
    );
    assert!(
        page.contains("lang=\"zh-CN\"") && page.contains("default-src 'none'"),
        "{page}"
    );
}

#[test]
fn a_stream_continues_while_the_machine_ticks() {
    let mut bench = Bench::new();
    let mut stream = bench.connect();
    let request = "GET /sample?interval=10&heartbeat=50 HTTP/1.1\r\nHost: localhost\r\n\r\n";
    stream.write_all(request.as_bytes()).expect("sent");
    let mut received = String::new();
    let end = Instant::now() + WAIT;
    while received.matches("Content-length").count() < 4 {
        bench.tick(20);
        let mut bytes = [0; 4096];
        let count = stream.read(&mut bytes).expect("received");
        received.push_str(&String::from_utf8_lossy(&bytes[..count]));
        assert!(count > 0 && Instant::now() < end, "{received}");
    }
    assert!(received.contains("multipart/x-mixed-replace"), "{received}");
    drop(bench.server);
    // The stream ends with the agent.
    let mut rest = Vec::new();
    assert!(stream.read_to_end(&mut rest).is_ok());
}

#[test]
fn nothing_is_written_and_foreign_names_are_refused() {
    let bench = Bench::new();
    for method in ["PUT", "POST", "DELETE", "OPTIONS"] {
        let answer = bench.send(format!("{method} /current HTTP/1.1\r\n\r\n").as_bytes());
        assert!(answer.starts_with("HTTP/1.1 405 "), "{answer}");
        assert!(
            answer.contains("Allow: GET") && answer.contains("UNSUPPORTED"),
            "{answer}"
        );
    }
    let answer = bench.send(b"GET /current HTTP/1.0\r\nHost: machine.example:5000\r\n\r\n");
    assert!(answer.contains("errorCode=\"INVALID_URI\""), "{answer}");
    assert!(bench.get("/programs/O0001").contains("errorCode="));
    assert!(bench.get("/current?path=nonsense").contains("INVALID_PATH"));
}

#[test]
fn malformed_requests_and_a_crowd_leave_the_agent_alive() {
    let bench = Bench::new();
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize
    };
    let pieces = [
        "GET ",
        "PUT ",
        "/sample?from=",
        "%",
        "\r\n",
        "\r\n\r\n",
        "\0",
        "HTTP/1.1",
        "Host: ",
        "&=",
    ];
    for _ in 0..200 {
        let words = (0..random() % 12).map(|_| pieces[random() % pieces.len()]);
        let request: String = words.collect();
        let mut stream = bench.connect();
        // The agent may have closed the connection.
        let _ = stream.write_all(request.as_bytes());
    }
    let crowd: Vec<TcpStream> = (0..150).map(|_| bench.connect()).collect();
    let end = Instant::now() + WAIT;
    let mut refused = 0;
    for mut stream in crowd {
        let mut answer = [0; 12];
        stream
            .set_read_timeout(Some(Duration::from_millis(20)))
            .expect("an option");
        if stream
            .read(&mut answer)
            .is_ok_and(|count| count == answer.len())
        {
            assert_eq!(&answer, b"HTTP/1.1 503");
            refused += 1;
        }
    }
    assert!(refused > 50 && Instant::now() < end, "{refused}");
    bench.wait_for("/probe", "<MTConnectDevices");
}
