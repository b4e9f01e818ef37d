//! Sends a ladder to a control and reads the ladder of a control, as GSKCC does (manual PLC-III
//! 6).

use gsk_panel::panel::LADDER_FILE;
use gsk_transfer::{FileName, Partition, RemotePath, TransferFault, TransferFile};

use super::{FilesError, PcError, TransferObserver, TransferSession};

/// Observes nothing.
struct UnobservedTransfer;

impl TransferObserver for UnobservedTransfer {}

/// Returns the path of the ladder at a control.
///
/// # Errors
/// Never: the name is valid.
fn ladder_path() -> Result<RemotePath, PcError> {
    Ok(RemotePath {
        partition: Partition::User,
        name: FileName::new(LADDER_FILE).map_err(FilesError::from)?,
    })
}

/// Connects with the control at a port of the computer, `baud` bits per second, sends an
/// instruction list, and disconnects. The control runs it from its next power-on.
///
/// # Errors
/// The port cannot be opened, the control does not answer, or it refuses the ladder.
pub fn send_ladder(port: &str, baud: u32, list: &str) -> Result<(), PcError> {
    let mut session = TransferSession::open(port, baud, Box::new(UnobservedTransfer))?;
    session.connect()?;
    let sent = session.send(TransferFile {
        remote_path: ladder_path()?,
        bytes: list.as_bytes().to_vec(),
        overwrite: true,
    });
    session.close();
    sent
}

/// Connects with the control at a port of the computer, `baud` bits per second, reads its ladder
/// as an instruction list, and disconnects.
///
/// # Errors
/// The port cannot be opened, the control does not answer or refuses, or its file is no text.
pub fn read_ladder(port: &str, baud: u32) -> Result<String, PcError> {
    let mut session = TransferSession::open(port, baud, Box::new(UnobservedTransfer))?;
    session.connect()?;
    let path = ladder_path()?;
    let name = path.name.clone();
    let received = session.receive(path);
    session.close();
    String::from_utf8(received?).map_err(|_| {
        let fault = TransferFault::Content;
        FilesError::Refused { name, fault }.into()
    })
}
