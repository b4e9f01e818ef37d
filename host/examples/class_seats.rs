//! Seats of a class in one process, for `tests/oracles/class_load.py`: some are running kernels at
//! the speed of a real lathe, the others publish states without a machine.
//!
//! `class_seats CODE@BROKER KERNELS REPLAYED SECONDS`
//!
//! It prints how much machine time has passed in the wall time, and the delays from the cause of an
//! alarm to the view of the class.

use std::time::{Duration, Instant};

use gsk_core::machine::LatheFault;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::kernel::{Command, Console, Kernel, OpenedProgram, SNAPSHOT_TICKS, StorePolicy};
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::class::seat_report::SeatReport;
use gsk_host::network::class::{ClassLink, SeatFeed, SeatOptions, start_seat};
use gsk_host::network::mqtt::BrokerLine;
use gsk_host::network::service_state::SharedServiceState;
use gsk_host::network::{ClassSettings, NetworkSettings};
use gsk_messages::Language;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;

const PROGRAM: &str = include_str!("../../assets/programs/01-stepped-shaft.CNC");
/// Time between two alarms.
const ALARM_INTERVAL: Duration = Duration::from_millis(1500);
/// Longest time for which an alarm is awaited.
const ALARM_TIMEOUT: Duration = Duration::from_secs(10);

struct KernelSeat {
    kernel: Kernel,
    console: Console,
    name: String,
}

impl KernelSeat {
    fn new(class: &ClassAddress, number: usize) -> Self {
        let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        let name = format!("seat {number}");
        let class = ClassSettings {
            is_on: true,
            code: class.code.to_string(),
            broker: class.broker.without_password(),
            name: name.clone(),
            allows_faults: true,
            password: String::new(),
            ca: String::new(),
        };
        let settings = NetworkSettings {
            class,
            ..NetworkSettings::default()
        };
        kernel.set_network(&settings, Language::En);
        Self {
            kernel,
            console,
            name,
        }
    }

    /// Runs the machine for the time of a snapshot, and publishes it.
    fn run(&mut self) {
        self.kernel.run(SNAPSHOT_TICKS);
        self.kernel.publish();
    }
}

/// An alarm that was caused and has not been seen.
struct PendingAlarm {
    seat: usize,
    name: String,
    since: Instant,
}

fn is_in_trouble(link: &ClassLink, name: &str) -> bool {
    let roster = link.roster();
    let seats = roster.by_urgency();
    let mut found = seats.iter().filter(|seat| seat.report.name == name);
    found.any(|seat| seat.report.trouble.is_some())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().collect();
    let [_, class, kernels, replayed, seconds] = words.as_slice() else {
        return Err("class_seats CODE@BROKER KERNELS REPLAYED SECONDS".into());
    };
    let class = ClassAddress::parse(class)?;
    let (kernels, replayed): (usize, usize) = (kernels.parse()?, replayed.parse()?);
    let seconds = Duration::from_secs(seconds.parse()?);
    let mut seats: Vec<KernelSeat> = (0..kernels).map(|it| KernelSeat::new(&class, it)).collect();
    let mut others: Vec<(BrokerLine, SeatFeed)> = Vec::new();
    for number in 0..replayed {
        let options = SeatOptions {
            class: class.clone(),
            name: format!("replayed {number}"),
        };
        others.push(start_seat(&options, SharedServiceState::default())?);
    }
    let link = ClassLink::start(&class, std::env::temp_dir(), || {})?;
    // The control starts; then every machine runs a program.
    for _ in 0..200 {
        seats.iter_mut().for_each(KernelSeat::run);
    }
    for seat in &seats {
        seat.console.send(Command::OpenSample {
            program: Box::new(OpenedProgram {
                name: "01-stepped-shaft.CNC".to_owned(),
                path: None,
                store_policy: StorePolicy::Replace,
                program: Program::new(PROGRAM),
                subprograms: Vec::new(),
            }),
            starts: true,
        });
    }
    let (start, mut steps, mut busy) = (Instant::now(), 0_u32, Duration::ZERO);
    let mut delays: Vec<Duration> = Vec::new();
    let mut lost = 0;
    let mut pending: Option<PendingAlarm> = None;
    let mut next_alarm = start + ALARM_INTERVAL;
    let step = Duration::from_millis(SNAPSHOT_TICKS);
    while start.elapsed() < seconds {
        let begin = Instant::now();
        for seat in &mut seats {
            seat.run();
        }
        steps += 1;
        for (number, (_, feed)) in others.iter_mut().enumerate() {
            // A line each second, as a running program has.
            if (steps as usize + number).is_multiple_of(40) {
                feed.report(SeatReport {
                    name: format!("replayed {number}"),
                    is_running: true,
                    program: Some("O0001".to_owned()),
                    line: Some(steps / 40),
                    ..SeatReport::default()
                });
            }
        }
        if let Some(alarm) = pending.take() {
            if is_in_trouble(&link, &alarm.name) {
                delays.push(alarm.since.elapsed());
                let console = &seats[alarm.seat].console;
                console.send(Command::ClearFaults);
                console.send(Command::Tap(Key::Reset));
            } else if alarm.since.elapsed() > ALARM_TIMEOUT {
                lost += 1;
            } else {
                pending = Some(alarm);
            }
        } else if Instant::now() >= next_alarm && !seats.is_empty() {
            next_alarm = Instant::now() + ALARM_INTERVAL;
            let seat = (steps as usize * 7919) % seats.len();
            let (name, console) = (seats[seat].name.clone(), &seats[seat].console);
            console.send(Command::Fault(LatheFault::DriveX, true));
            pending = Some(PendingAlarm {
                seat,
                name,
                since: Instant::now(),
            });
        }
        busy += begin.elapsed();
        if let Some(rest) = (step * steps).checked_sub(start.elapsed()) {
            std::thread::sleep(rest);
        }
    }
    delays.sort();
    let at = |share: usize| delays.get((delays.len().max(1) - 1) * share / 100);
    let ms = |delay: Option<&Duration>| delay.map_or(0, Duration::as_millis);
    println!(
        "{{\"machine_s\":{:.2},\"wall_s\":{:.2},\"busy\":{:.3},\"alarms\":{},\"lost\":{lost},\
         \"median_ms\":{},\"worst_ms\":{},\"seats\":{:?}}}",
        f64::from(steps) * step.as_secs_f64(),
        start.elapsed().as_secs_f64(),
        busy.as_secs_f64() / start.elapsed().as_secs_f64(),
        delays.len(),
        ms(at(50)),
        ms(delays.last()),
        link.roster().count().0
    );
    // The seats leave in parallel: each waits for its farewell.
    std::process::exit(0);
}
