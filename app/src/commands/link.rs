//! `link`: lists, tests, monitors, simulates and programs pulse boards.

mod board_test;
mod flash;
mod twin;

use std::time::Duration;

use gsk_host::board::BoardSession;
use gsk_host::message_format::{describe_setting_difference, join_on_one_line};
use gsk_host::{loading, platform, ports};
use gsk_link::{LinkConfig, LinkEvent, LinkState};

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{LinkBoardArgs, LinkCommand, LinkMonitorArgs, LinkTestArgs};
use gsk_core::alarm::number;
use gsk_messages::{Message, say};

pub fn link(command: &LinkCommand) -> Result<u8, CommandError> {
    match command {
        LinkCommand::List => list(),
        LinkCommand::Test(args) => test(args),
        LinkCommand::Monitor(args) => monitor(args),
        LinkCommand::Flash(args) => flash::flash_board(args),
        LinkCommand::Twin(args) => twin::run_twin(args),
    }
}

fn list() -> Result<u8, CommandError> {
    let found = ports::list_ports()?;
    if found.is_empty() {
        output::print_message(&say::link_test_no_ports());
        return Ok(EXIT_OK);
    }
    let mut out = String::new();
    for port in found {
        out.push_str(&port.path);
        if let Some(name) = port.by_id {
            out.push_str(&format!("  {}", name.display()));
        }
        out.push('\n');
    }
    output::print(&out);
    Ok(EXIT_OK)
}

/// Opens the board with the link settings of the machine file, the parameters of the control and
/// the options. Returns an error if the settings are wrong or the port cannot be opened.
fn open(args: &LinkBoardArgs) -> Result<BoardSession, CommandError> {
    let setup = loading::command_setup(&args.setup, None, None)?;
    let mut config: LinkConfig = setup.lathe.link.unwrap_or_default();
    if let Some(port) = &args.port {
        config.port.clone_from(port);
    }
    if config.port.is_empty() {
        return Err(say::command_no_port().into());
    }
    config.check()?;
    Ok(BoardSession::open(
        config,
        &setup.memory.parameters,
        &platform::own_executable(),
    )?)
}

/// Prints the alarms among the events. Returns true if any of them is about something other
/// than differing settings.
fn print_alarms(events: &[LinkEvent]) -> bool {
    let mut failed = false;
    for event in events {
        if let LinkEvent::Alarm { number, detail } = event {
            complain!("gsk980td: {number}: {}", output::localize(detail));
            failed |= *number != number::BOARD_SETTINGS;
        }
    }
    failed
}

const fn is_settings_alarm(event: &LinkEvent) -> bool {
    matches!(event, LinkEvent::Alarm { number, .. } if *number == number::BOARD_SETTINGS)
}

/// Reports the state in which the connection stopped, unless an alarm has reported it.
/// Always returns true: the board is not usable.
fn report_state(board: &BoardSession) -> bool {
    match board.link.state() {
        LinkState::Fault | LinkState::Lost | LinkState::Tripped => {}
        LinkState::Off => output::report_error(&say::link_test_broken_off()),
        state => {
            let message = say::link_test_not_ready(board.now().as_secs(), state.name());
            output::report_error(&message);
        }
    }
    true
}

fn test(args: &LinkTestArgs) -> Result<u8, CommandError> {
    let mut board = open(&args.board)?;
    let mut events = board.wait_until_ready();
    if args.write_settings {
        // These settings are written next and are listed there.
        events.retain(|event| !is_settings_alarm(event));
    }
    let mut failed = print_alarms(&events);
    let info = board.link.board().clone();
    if !info.firmware.is_empty() {
        output::print_message(&say::link_test_board(
            &info.firmware,
            info.blocks,
            info.receive_bytes,
        ));
    }
    let differing = differences(&events);
    if differing.is_empty() && board.link.state() != LinkState::Locked {
        failed |= report_state(&board);
    }
    if failed {
        return Ok(EXIT_ALARM);
    }
    if !differing.is_empty() {
        output::print_message(&say::link_test_settings_differ());
        differing.iter().for_each(output::print_message);
        if info.forgets {
            output::print_message(&say::link_test_forgets());
        }
        if !args.write_settings {
            output::print_message(&say::link_test_write());
            return Ok(EXIT_ALARM);
        }
        board.link.write_settings();
        events = board.pump_until(Duration::from_secs(10), |link, _| {
            matches!(
                link.state(),
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            )
        });
        print_alarms(&events);
        if board.link.state() != LinkState::Locked {
            report_state(&board);
            return Ok(EXIT_ALARM);
        }
        output::print_message(&say::link_test_written());
    } else {
        output::print_message(&say::link_test_settings_good());
    }
    output::print_message(&say::link_test_threads(board.link.threads().text()));
    let idle_events = board_test::measure_idle(&mut board);
    let failed = print_alarms(&idle_events);
    let operated = board_test::operated_switches(&board);
    output::print_message(&match operated.is_empty() {
        true => say::link_test_switches_free(),
        false => say::link_test_switches(join_on_one_line(operated.iter().cloned())),
    });
    match args.travel {
        _ if failed || board.link.state() != LinkState::Locked => {
            report_state(&board);
            Ok(EXIT_ALARM)
        }
        Some(_) if !operated.is_empty() => {
            let message = say::link_test_nothing_moves(join_on_one_line(operated));
            output::report_error(&message);
            Ok(EXIT_ALARM)
        }
        Some(millimetres) => board_test::measure_motion(&mut board, millimetres, args.feed),
        None => Ok(EXIT_OK),
    }
}

fn differences(events: &[LinkEvent]) -> Vec<Message> {
    let line = |event: &LinkEvent| match event {
        LinkEvent::Differs(difference) => Some(say::link_test_setting(
            describe_setting_difference(difference),
        )),
        _ => None,
    };
    events.iter().filter_map(line).collect()
}

fn monitor(args: &LinkMonitorArgs) -> Result<u8, CommandError> {
    let mut board = open(&args.board)?;
    board.record_traffic();
    let mut failed = false;
    while args
        .seconds
        .is_none_or(|seconds| board.now() < Duration::from_secs(seconds))
    {
        let events = board.pump();
        print_traffic(&mut board);
        failed |= print_alarms(&events);
        if matches!(board.link.state(), LinkState::Lost | LinkState::Off) {
            break;
        }
    }
    // The bytes that stop the board are part of the traffic.
    board.close();
    print_traffic(&mut board);
    Ok(if failed { EXIT_ALARM } else { EXIT_OK })
}

/// Prints the traffic that was recorded since the last call.
fn print_traffic(board: &mut BoardSession) {
    for line in board.take_traffic() {
        let arrow = if line.is_outward { '>' } else { '<' };
        output::print(&format!(
            "{:9.3} {arrow} {}\n",
            line.at.as_secs_f64(),
            line.text
        ));
    }
}
