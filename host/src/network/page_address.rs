//! The addresses at which other computers reach this one: the page of the agent, and a broker.

use gsk_telemetry::BrokerUrl;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};

/// The address of the page as other computers write it; `None` if the agent serves this computer
/// only. `url` is the address at which the agent listens.
pub fn page_url(url: &str) -> Option<String> {
    let address: SocketAddr = url
        .trim_start_matches("http://")
        .trim_end_matches('/')
        .parse()
        .ok()?;
    let ip = match address.ip() {
        ip if ip.is_unspecified() => own_ip()?,
        ip => ip,
    };
    let reachable = !ip.is_loopback();
    reachable.then(|| format!("http://{}/", SocketAddr::new(ip, address.port())))
}

/// The address of a broker as other computers write it; `None` if it serves this computer only,
/// which has no network.
pub fn reachable_broker(broker: &BrokerUrl) -> Option<BrokerUrl> {
    let is_local = |host: &str| {
        let address = host.parse::<IpAddr>();
        host.eq_ignore_ascii_case("localhost") || address.is_ok_and(|ip| ip.is_loopback())
    };
    let host = match broker.host.as_str() {
        host if is_local(host) => own_ip()?.to_string(),
        host => host.to_owned(),
    };
    Some(BrokerUrl {
        host,
        ..broker.clone()
    })
}

/// The address of this computer in its network; `None` without a network. The system looks up
/// the route; nothing is sent.
fn own_ip() -> Option<IpAddr> {
    /// An address of documentation, which no computer has.
    const SOMEWHERE: (Ipv4Addr, u16) = (Ipv4Addr::new(192, 0, 2, 1), 9);
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    socket.connect(SOMEWHERE).ok()?;
    let ip = socket.local_addr().ok()?.ip();
    (!ip.is_unspecified()).then_some(ip)
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "tests fail by panicking")]
mod tests {
    use super::*;

    #[test]
    fn a_phone_does_not_reach_this_computer_alone() {
        assert_eq!(page_url("http://127.0.0.1:5000/"), None);
        assert_eq!(page_url("http://[::1]:5000/"), None);
        let url = page_url("http://192.168.1.5:80/");
        assert_eq!(url.as_deref(), Some("http://192.168.1.5:80/"));
        let broker = |text: &str| BrokerUrl::parse(text).expect("an address");
        let other = broker("mqtts://ann@pc/a");
        assert_eq!(reachable_broker(&other).as_ref(), Some(&other));
        let local = reachable_broker(&broker("mqtt://localhost:1884/a"));
        let is_open = |url: &BrokerUrl| url.host != "localhost" && url.port == 1884;
        assert!(local.is_none_or(|url| is_open(&url)));
        // Without a network there is no address.
        let own = page_url("http://0.0.0.0:5000/");
        assert!(own.is_none_or(|url| !url.contains("0.0.0.0") && url.ends_with(":5000/")));
    }
}
