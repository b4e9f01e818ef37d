//! `link twin`: a board without hardware, behind a pseudo terminal, at the pace of
//! the wall clock.

use std::time::{Duration, Instant};

use gsk_twins::grbl::{GrblTwin, Settings, State, Variant};
use gsk_twins::wire::Damage;

use super::super::{FINE, output};
use crate::cli::{LinkTwinArgs, TwinBoard};
use crate::ports::Port;

/// Bytes ahead for which damage is prepared.
const AHEAD: u64 = 4096;

/// Plays a board until its time is up.
pub fn twin(args: &LinkTwinArgs) -> Result<u8, String> {
    let (mut near, _far, name) = Port::pair()?;
    let variant = match args.firmware {
        TwinBoard::Grbl => Variant::Grbl,
        TwinBoard::Grblhal => Variant::GrblHal,
    };
    let mut board = GrblTwin::new(variant, Settings::default());
    output::print(&format!("{name}\n"))?;
    if args.delay_ms > 0 {
        board
            .to_board
            .damage(0, Damage::HeldUp(args.delay_ms * 1_000_000));
    }
    let start = Instant::now();
    let mut damaged = 0;
    let mut shown = (State::Idle, [0, 0]);
    while args
        .seconds
        .is_none_or(|seconds| start.elapsed() < Duration::from_secs(seconds))
    {
        if let Some(every) = args.lose_every {
            while damaged < board.to_board.given() + AHEAD {
                damaged += every;
                board.to_board.damage(damaged, Damage::Lost);
            }
        }
        let bytes = near.read().map_err(|error| error.to_string())?;
        board.write(&bytes);
        let elapsed = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        board.advance(elapsed.saturating_sub(board.now()));
        let mut said = board.read();
        while !said.is_empty() {
            let count = near.write(&said).map_err(|error| error.to_string())?;
            said.drain(..count);
        }
        let now = (board.state(), board.pulses());
        let changed = now.0 != shown.0 || (now.0 == State::Idle && now.1 != shown.1);
        if changed {
            shown = now;
            output::print(&format!(
                "{:9.3} {:?}, X {} Z {} pulses\n",
                elapsed as f64 * 1e-9,
                now.0,
                now.1[0],
                now.1[1]
            ))?;
        }
    }
    Ok(FINE)
}
