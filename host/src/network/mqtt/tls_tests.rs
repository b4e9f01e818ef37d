//! TLS to a broker on this computer that the test itself plays.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_messages::{Language, Message, say};
use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, Stream};
use web_time::{Duration, Instant};

use super::{BrokerUrl, LatheOptions, start_publishing};
use crate::network::service_state::{ServiceState, SharedServiceState};

const WAIT: Duration = Duration::from_secs(20);

fn certificates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/network/mqtt/certificates")
}

/// A broker with the certificate of this name, without TLS if it is empty. Returns its port.
fn start_broker(certificate: &str) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("listens");
    let port = listener.local_addr().expect("an address").port();
    let folder = certificates();
    let config = (!certificate.is_empty()).then(|| {
        let chain = CertificateDer::from_pem_file(folder.join(format!("{certificate}.pem")));
        let key = PrivateKeyDer::from_pem_file(folder.join(format!("{certificate}.key.pem")));
        let config = ServerConfig::builder_with_provider(Arc::new(default_provider()))
            .with_safe_default_protocol_versions()
            .expect("versions")
            .with_no_client_auth()
            .with_single_cert(vec![chain.expect("a certificate")], key.expect("a key"));
        Arc::new(config.expect("a configuration"))
    });
    thread::spawn(move || {
        for mut stream in listener.incoming().map_while(Result::ok) {
            let Some(config) = &config else {
                // As Mosquitto answers bytes that are not MQTT.
                let _ = stream.read(&mut [0; 64]);
                continue;
            };
            let mut server = ServerConnection::new(Arc::clone(config)).expect("a connection");
            let mut tls = Stream::new(&mut server, &mut stream);
            let mut bytes = [0; 4096];
            // A client that refuses the certificate ends here.
            if !matches!(tls.read(&mut bytes), Ok(count) if count > 0 && bytes[0] == 0x10) {
                continue;
            }
            tls.write_all(&[0x20, 2, 0, 0]).expect("sent");
            while matches!(tls.read(&mut bytes), Ok(count) if count > 0) {}
        }
    });
    port
}

/// Connects to a broker and returns the first state that is no attempt.
fn connect(address: &str, ca_file: Option<PathBuf>) -> (BrokerUrl, ServiceState) {
    let mut url = BrokerUrl::parse(address).expect("an address");
    url.ca_file = ca_file;
    let mut simulation = Simulation::new(Setup::default());
    let state = SharedServiceState::default();
    let options = LatheOptions {
        discovery_prefix: None,
        rate_hz: 4,
        language: Language::En,
    };
    let started = start_publishing(&url, &options, &simulation, state.clone());
    let (line, mut feed) = started.expect("a thread");
    let end = Instant::now() + WAIT;
    let reached = loop {
        // The machine ticks whatever the handshake does.
        simulation.tick();
        feed.follow_tick(&simulation, None, None);
        match state.get() {
            ServiceState::Off | ServiceState::Connecting(_) => {}
            reached => break reached,
        }
        assert!(Instant::now() < end, "{address}");
        thread::sleep(Duration::from_millis(1));
    };
    line.end_in_background();
    (url, reached)
}

fn authority() -> Option<PathBuf> {
    Some(certificates().join("authority.pem"))
}

fn assert_refused(address: &str, ca_file: Option<PathBuf>, reason: Message) {
    let (url, state) = connect(address, ca_file);
    let sentence = reason.text(Language::Zh);
    let expected = ServiceState::Failed(say::mqtt_failed(&url, reason));
    assert_eq!(state, expected, "{address}");
    let shown = state.message().text(Language::Zh);
    assert!(shown.contains(&sentence), "{shown}");
}

#[test]
fn a_certificate_of_the_named_authority_is_accepted() {
    let port = start_broker("broker");
    for host in ["localhost", "127.0.0.1"] {
        let (url, state) = connect(&format!("mqtts://{host}:{port}/a"), authority());
        assert_eq!(state, ServiceState::Connected(url.to_string()));
    }
}

#[test]
fn every_refusal_has_its_own_sentence() {
    let broker = format!("mqtts://localhost:{}", start_broker("broker"));
    // The authority of the test is none of the system, and its own certificate alone signs itself.
    let stranger = Some(certificates().join("other.pem"));
    assert_refused(&broker, stranger, say::tls_unknown_authority());
    let expired = format!("mqtts://localhost:{}", start_broker("expired"));
    assert_refused(&expired, authority(), say::tls_expired());
    let other = format!("mqtts://localhost:{}", start_broker("other"));
    assert_refused(&other, authority(), say::tls_wrong_name("localhost"));
    let plain = format!("mqtts://localhost:{}", start_broker(""));
    assert_refused(&plain, authority(), say::tls_missing());
    let no_certificate = certificates().join("README.md");
    let empty = say::tls_ca_empty(no_certificate.display());
    assert_refused(&broker, Some(no_certificate), empty);
    assert_refused(
        &format!("ws://localhost:{}", 9),
        None,
        say::mqtt_web_socket_on_computer(),
    );
}

#[test]
fn without_tls_the_port_of_tls_is_no_broker() {
    let port = start_broker("broker");
    let (_, state) = connect(&format!("mqtt://127.0.0.1:{port}"), None);
    assert!(matches!(state, ServiceState::Failed(_)), "{state:?}");
}
