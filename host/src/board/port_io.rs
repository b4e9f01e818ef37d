//! Moves bytes between the guarded port of a board and its link, and records the traffic.

use std::io;
use std::path::Path;
use std::thread;

use gsk_link::LinkConfig;
use web_time::{Duration, Instant};

use crate::board::host_clock::HostClock;
use crate::guard::{GuardError, Orphan, PortGuard};

/// Longest time to write the last bytes to a board before the port is closed.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// Time between two attempts to write the remaining bytes.
const RETRY_INTERVAL: Duration = Duration::from_millis(2);

/// One line of the recorded traffic between PC and board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrafficLine {
    /// Time since the port was opened.
    pub at: Duration,
    /// True if the line went from the PC to the board.
    pub is_outward: bool,
    /// The text of the line; bytes that are not text appear as `\xNN`.
    pub text: String,
}

/// An open port. Dropping it without [`PortIo::close`] stops the board.
pub struct PortIo {
    /// The connection to the guard process; `None` after the port was closed.
    guard: Option<PortGuard>,
    clock: HostClock,
    /// Time of the last read of the port, since the port was opened; zero before the first
    /// read.
    last_read: Duration,
    lookahead: Duration,
    /// Bytes of texts that are not complete yet: [0] to the board, [1] from the board.
    incomplete: [Vec<u8>; 2],
    /// The traffic since the last call of [`PortIo::take_traffic`]: time, whether it went to
    /// the board, and bytes. Empty unless it is recorded.
    recorded: Vec<(Duration, bool, Vec<u8>)>,
    is_recording: bool,
}

impl PortIo {
    /// Opens the port exclusively; `program` is the executable file of the guard process,
    /// which holds the port.
    ///
    /// # Errors
    /// The holder does not start, or cannot open the port; the message names the port.
    pub fn open(config: &LinkConfig, program: &Path) -> Result<Self, GuardError> {
        Ok(Self {
            guard: Some(PortGuard::open(program, &config.port, config.baud)?),
            clock: HostClock::start(),
            last_read: Duration::ZERO,
            lookahead: config.lookahead(),
            incomplete: [Vec::new(), Vec::new()],
            recorded: Vec::new(),
            is_recording: false,
        })
    }

    /// Starts or stops the recording of the traffic for [`PortIo::take_traffic`].
    pub fn set_recording(&mut self, on: bool) {
        self.is_recording = on;
        if !on {
            self.recorded.clear();
        }
    }

    /// Returns the time since the port was opened, including sleep of the computer.
    pub fn now(&self) -> Duration {
        self.clock.now()
    }

    /// Returns the time by which only the wall clock has advanced since the last call; zero if
    /// the clocks agree.
    pub fn take_jump(&mut self) -> Duration {
        self.clock.take_wall_clock_jump()
    }

    /// Returns the id of the guard process that holds the port; `None` after the port was
    /// closed.
    pub fn holder_process_id(&self) -> Option<u32> {
        self.guard.as_ref().map(PortGuard::process_id)
    }

    /// Returns the bytes of the board that have arrived; waits at most 2 ms for the first one.
    ///
    /// # Errors
    /// The port is gone.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let guard = self.guard.as_mut();
        let bytes = guard.map_or_else(|| Ok(Vec::new()), PortGuard::read)?;
        self.last_read = self.clock.now();
        self.record(false, &bytes);
        Ok(bytes)
    }

    /// Writes as many bytes as the port takes now; returns their number. Writes none if
    /// the last read is longer ago than the lookahead: the program was stopped or asleep
    /// and the board has run out of motion, so new motion waits until the link has judged
    /// the absence. If the port is gone, the next read reports it.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        if self.clock.now().saturating_sub(self.last_read) > self.lookahead {
            return 0;
        }
        self.write_now(bytes)
    }

    fn write_now(&mut self, bytes: &[u8]) -> usize {
        let guard = self.guard.as_mut();
        let count = guard.map_or(bytes.len(), |guard| guard.write(bytes));
        self.record(true, &bytes[..count]);
        count
    }

    /// Sets the bytes that the guard process sends to stop the board when this program is
    /// gone; empty: it does not stop the board.
    pub fn set_stop_bytes(&mut self, bytes: &[u8]) {
        if let Some(guard) = &mut self.guard {
            guard.set_stop_bytes(bytes);
        }
    }

    /// Renews the lease at every turn of the caller. `is_moving`: slides or spindle are in
    /// motion; the holder then stops the board if the program falls silent.
    pub fn renew_lease(&mut self, is_moving: bool) {
        if let Some(guard) = &mut self.guard {
            guard.renew_lease(is_moving, self.lookahead);
        }
    }

    /// Returns and removes the state in which the board was left, after [`PortIo::read`] has
    /// failed; `None` if the port itself has failed.
    pub fn take_orphan(&mut self) -> Option<Orphan> {
        self.guard.as_mut().and_then(PortGuard::take_orphan)
    }

    /// Writes the last bytes, which stop the board, for at most half a second, and closes
    /// the port.
    pub fn close(&mut self, mut bytes: &[u8]) {
        let begun = Instant::now();
        while !bytes.is_empty() && begun.elapsed() < CLOSE_TIMEOUT {
            let count = self.write_now(bytes);
            bytes = &bytes[count..];
            if count == 0 {
                thread::sleep(RETRY_INTERVAL);
            }
        }
        if let Some(guard) = self.guard.take() {
            guard.close();
        }
    }

    /// Returns the traffic since the last call, split into texts by the link: `next_text`
    /// takes the next text from the bytes of one direction.
    pub fn take_traffic(
        &mut self,
        mut next_text: impl FnMut(bool, &mut Vec<u8>) -> Option<String>,
    ) -> Vec<TrafficLine> {
        let mut lines = Vec::new();
        for (at, outward, bytes) in self.recorded.drain(..) {
            let collected = &mut self.incomplete[usize::from(!outward)];
            collected.extend(bytes);
            while let Some(text) = next_text(outward, collected) {
                lines.push(TrafficLine {
                    at,
                    is_outward: outward,
                    text,
                });
            }
        }
        lines
    }

    fn record(&mut self, outward: bool, bytes: &[u8]) {
        if self.is_recording && !bytes.is_empty() {
            let at = self.clock.now();
            self.recorded.push((at, outward, bytes.to_vec()));
        }
    }
}
