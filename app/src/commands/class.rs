//! `class`: shows the seats of a class to the instructor.

use std::path::PathBuf;
use std::thread;

use gsk_host::files::exercises;
use gsk_host::message_format::describe_io_error;
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::class::class_table::write_table;
use gsk_host::network::class::{ClassEvent, ClassLink};
use gsk_host::network::mqtt::{self, BrokerTransport, BrokerUrl};
use gsk_host::network::service_state::ServiceState;
use gsk_host::platform;
use gsk_host::termination::{TERMINATED_EXIT_CODE, TerminationFlag};
use gsk_messages::say;
use gsk_window::class_window::{self, ClassStart, SeatPage};
use web_time::{Duration, Instant};

use super::{CommandError, EXIT_OK, output};
use crate::cli::ClassArgs;

/// Folder for results, unless an option names another one.
const RESULT_FOLDER: &str = "class-results";
/// Time between two tables.
const TABLE_INTERVAL: Duration = Duration::from_secs(1);
/// Time between two checks for news.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Shows a class until its window is closed, or as tables. Returns an error if the password cannot
/// be read or the window cannot be opened.
pub fn show_class(args: &ClassArgs) -> Result<u8, CommandError> {
    let mut broker = args.broker.clone();
    broker.ca_file.clone_from(&args.mqtt_ca);
    mqtt::read_password(&mut broker, args.mqtt_password_file.as_deref())?;
    let class = ClassAddress {
        code: args.code.clone(),
        broker,
    };
    let results = args.results.clone();
    let results = results.unwrap_or_else(|| PathBuf::from(RESULT_FOLDER));
    if args.text {
        return print_tables(&class, results, args);
    }
    if !platform::has_display() {
        return Err(say::window_no_display("FILE").into());
    }
    let seat_page = args.seat_page.clone().map(|url| SeatPage {
        url,
        class: ClassAddress {
            code: class.code.clone(),
            broker: web_broker(args),
        },
    });
    class_window::run(ClassStart {
        page_address: args.page.clone(),
        seat_page,
        class,
        results,
        language: output::language(),
        exercises: exercises::load_exercises(args.data.as_deref()),
        data: args.data.clone(),
    })?;
    Ok(EXIT_OK)
}

/// The broker as a page in a browser reaches it.
fn web_broker(args: &ClassArgs) -> BrokerUrl {
    let broker = &args.broker;
    args.seat_broker.clone().unwrap_or_else(|| BrokerUrl {
        transport: BrokerTransport::WebSocket,
        port: BrokerTransport::WebSocket.default_port(),
        password: None,
        ca_file: None,
        ..broker.clone()
    })
}

/// Prints the table of the seats whenever it has changed.
fn print_tables(
    class: &ClassAddress,
    results: PathBuf,
    args: &ClassArgs,
) -> Result<u8, CommandError> {
    let ending = TerminationFlag::install_signal_handlers()?;
    let link = ClassLink::start(class, results, || {});
    let link = link.map_err(|error| describe_io_error(&error))?;
    let page = args.page.as_deref();
    let page = page.map(|address| link.serve_page(address)).transpose()?;
    if let Some(page) = &page {
        output::report_error(&say::class_page_listening(page.url()));
    }
    let end = args
        .seconds
        .map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut printed = String::new();
    let mut reported = ServiceState::Off;
    let mut next = Instant::now();
    loop {
        if ending.is_requested() {
            return Ok(TERMINATED_EXIT_CODE);
        }
        if end.is_some_and(|end| Instant::now() >= end) {
            return Ok(EXIT_OK);
        }
        let state = link.state().get();
        if state != reported {
            output::report_error(&state.message());
            reported = state;
        }
        while let Some(event) = link.take_event() {
            if let ClassEvent::Message(message) = event {
                output::report_error(&message);
            }
        }
        if Instant::now() >= next {
            next = Instant::now() + TABLE_INTERVAL;
            let table = write_table(&link.roster(), output::language());
            if table != printed && matches!(reported, ServiceState::Connected(_)) {
                output::print(&format!("{table}\n"));
                printed = table;
            }
        }
        thread::sleep(POLL_INTERVAL);
    }
}
