//! `link`: pulse boards, found, tried, watched, played.

mod drill;
mod twin;

use std::time::Duration;

use gsk_link::{LinkConfig, LinkEvent, LinkState};

use super::{ALARM, CommandError, FINE, output};
use crate::board::Board;
use crate::cli::{LinkBoardArgs, LinkCommand, LinkMonitorArgs, LinkTestArgs};
use crate::saying::{differs, listed};
use crate::{loading, platform, ports};
use gsk_core::alarm::number;
use gsk_messages::{Message, say};

/// Carries out a link command.
pub fn link(command: &LinkCommand) -> Result<u8, CommandError> {
    match command {
        LinkCommand::List => list(),
        LinkCommand::Test(args) => test(args),
        LinkCommand::Monitor(args) => monitor(args),
        LinkCommand::Twin(args) => twin::twin(args),
    }
}

fn list() -> Result<u8, CommandError> {
    let found = ports::list()?;
    if found.is_empty() {
        output::say(&say::link_test_no_ports());
        return Ok(FINE);
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
    Ok(FINE)
}

/// The board that is meant, with the settings of the machine file and the
/// parameters of the control.
fn open(args: &LinkBoardArgs) -> Result<Board, CommandError> {
    let setup = loading::setup(&args.setup, None, None)?;
    let mut config: LinkConfig = setup.lathe.link.unwrap_or_default();
    if let Some(port) = &args.port {
        config.port.clone_from(port);
    }
    if config.port.is_empty() {
        return Err(CommandError::NoPort);
    }
    config.check()?;
    Ok(Board::open(
        config,
        &setup.memory.parameters,
        &platform::own_program(),
    )?)
}

/// Prints alarms; whether there was one besides differing settings.
fn report(events: &[LinkEvent]) -> bool {
    let mut failed = false;
    for event in events {
        if let LinkEvent::Alarm { number, detail } = event {
            complain!("gsk980td: {number}: {}", output::worded(detail));
            failed |= *number != number::BOARD_SETTINGS;
        }
    }
    failed
}

/// Whether an event is the alarm of settings that differ.
const fn is_about_settings(event: &LinkEvent) -> bool {
    matches!(event, LinkEvent::Alarm { number, .. } if *number == number::BOARD_SETTINGS)
}

/// Says where the dialogue has stopped; an alarm says it by itself. True: it is no
/// board that can be worked with.
fn tell_state(board: &Board) -> bool {
    match board.link.state() {
        LinkState::Fault | LinkState::Lost | LinkState::Tripped => {}
        LinkState::Off => output::complain_of(&say::link_test_broken_off()),
        state => {
            let said = say::link_test_not_ready(board.now().as_secs(), state.name());
            output::complain_of(&said);
        }
    }
    true
}

fn test(args: &LinkTestArgs) -> Result<u8, CommandError> {
    let mut board = open(&args.board)?;
    let mut events = board.get_known();
    if args.write_settings {
        // They are about to be written, and stand in the list.
        events.retain(|event| !is_about_settings(event));
    }
    let mut failed = report(&events);
    let info = board.link.board().clone();
    if !info.firmware.is_empty() {
        output::say(&say::link_test_board(
            &info.firmware,
            info.blocks,
            info.receive_bytes,
        ));
    }
    let differ = differences(&events);
    if differ.is_empty() && board.link.state() != LinkState::Locked {
        failed |= tell_state(&board);
    }
    if failed {
        return Ok(ALARM);
    }
    if !differ.is_empty() {
        output::say(&say::link_test_settings_differ());
        differ.iter().for_each(output::say);
        if info.forgets {
            output::say(&say::link_test_forgets());
        }
        if !args.write_settings {
            output::say(&say::link_test_write());
            return Ok(ALARM);
        }
        board.link.write_settings();
        events = board.wait(Duration::from_secs(10), |link, _| {
            matches!(
                link.state(),
                LinkState::Locked | LinkState::Fault | LinkState::Lost
            )
        });
        report(&events);
        if board.link.state() != LinkState::Locked {
            tell_state(&board);
            return Ok(ALARM);
        }
        output::say(&say::link_test_written());
    } else {
        output::say(&say::link_test_settings_good());
    }
    output::say(&say::link_test_threads(board.link.threads().text()));
    let meanwhile = drill::idle(&mut board);
    let failed = report(&meanwhile);
    let operated = drill::operated(&board);
    output::say(&match operated.is_empty() {
        true => say::link_test_switches_free(),
        false => say::link_test_switches(listed(operated.iter().cloned())),
    });
    match args.travel {
        _ if failed || board.link.state() != LinkState::Locked => {
            tell_state(&board);
            Ok(ALARM)
        }
        Some(_) if !operated.is_empty() => {
            let said = say::link_test_nothing_moves(listed(operated));
            output::complain_of(&said);
            Ok(ALARM)
        }
        Some(millimetres) => drill::motion(&mut board, millimetres, args.feed),
        None => Ok(FINE),
    }
}

fn differences(events: &[LinkEvent]) -> Vec<Message> {
    let line = |event: &LinkEvent| match event {
        LinkEvent::Differs(difference) => Some(say::link_test_setting(differs(difference))),
        _ => None,
    };
    events.iter().filter_map(line).collect()
}

fn monitor(args: &LinkMonitorArgs) -> Result<u8, CommandError> {
    let mut board = open(&args.board)?;
    board.watch();
    let mut failed = false;
    while args
        .seconds
        .is_none_or(|seconds| board.now() < Duration::from_secs(seconds))
    {
        let events = board.pump();
        print_traffic(&mut board);
        failed |= report(&events);
        if matches!(board.link.state(), LinkState::Lost | LinkState::Off) {
            break;
        }
    }
    // What stops the board belongs to it, too.
    board.close();
    print_traffic(&mut board);
    Ok(if failed { ALARM } else { FINE })
}

/// Prints what was said since the last call.
fn print_traffic(board: &mut Board) {
    for line in board.traffic() {
        let arrow = if line.outward { '>' } else { '<' };
        output::print(&format!(
            "{:9.3} {arrow} {}\n",
            line.at.as_secs_f64(),
            line.text
        ));
    }
}
