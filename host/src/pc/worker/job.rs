//! Jobs of several files: a refused file is reported and the job continues with the next
//! one; an error of the connection ends the job.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crossbeam::channel::RecvTimeoutError;
use gsk_messages::say;
use gsk_transfer::{Partition, PcCommand, RemotePath, TransferFault, TransferFile};
use web_time::Instant;

use super::{
    ANSWER_POLL_INTERVAL, FileJobKind, FileResult, FilesError, NameConflict, NameConflictAnswer,
    NameConflictChoice, PcError, PcWorkerCommand, PcWorkerEvent, PcWorkerThread, ToSend, folder,
};
use crate::pc::{TransferSession, free_name};
use crate::platform;

impl PcWorkerThread {
    /// Processes the files of a job one after another; sends their results, and then the new
    /// directory of the control, to the window.
    fn run_job<T>(
        &mut self,
        kind: FileJobKind,
        files: Vec<(String, T)>,
        mut process_file: impl FnMut(&mut Self, T) -> Result<FileResult, PcError>,
    ) {
        let (names, files): (Vec<_>, Vec<_>) = files.into_iter().unzip();
        let all = files.len();
        self.events.send(PcWorkerEvent::JobBegun(kind, names));
        let mut ended = None;
        for (at, file) in files.into_iter().enumerate() {
            self.events.send(PcWorkerEvent::FileBegun(at));
            let fate = match process_file(self, file) {
                Ok(fate) => fate,
                Err(
                    error @ (PcError::File(_)
                    | PcError::Write(_)
                    | PcError::Files(FilesError::Refused { .. })),
                ) => FileResult::Refused(error.message()),
                Err(error) => {
                    self.lower_stage(&error);
                    ended = Some(say::transfer_unfinished(at, all, error.message()));
                    break;
                }
            };
            if let Some(talk) = &self.session {
                self.events.send(PcWorkerEvent::Totals(talk.totals()));
            }
            self.events.send(PcWorkerEvent::FileEnded(at, fate));
        }
        // The cancellation does not apply to the next job.
        self.cancel.store(false, Ordering::Relaxed);
        self.events.send(PcWorkerEvent::JobFinished(ended));
        if self.stage == super::ConnectionStage::Connected {
            self.list();
        }
    }

    fn session(&mut self) -> Result<&mut TransferSession, PcError> {
        let closed = || FilesError::Gone(std::io::ErrorKind::NotConnected.into());
        self.session.as_mut().ok_or_else(|| closed().into())
    }

    /// Sends a question to the window and waits for the answer; keeps the connection alive
    /// meanwhile.
    fn query(&mut self, question: NameConflict) -> Result<NameConflictAnswer, PcError> {
        self.events.send(PcWorkerEvent::Conflict(question));
        loop {
            match platform::receive(&self.commands, Some(Instant::now() + ANSWER_POLL_INTERVAL)) {
                Ok(PcWorkerCommand::Answer(answer)) => return Ok(answer),
                Ok(PcWorkerCommand::Close) => {
                    self.close();
                    return Err(FilesError::Cancelled.into());
                }
                // The window sends no other command while it shows the question.
                Ok(_) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(FilesError::Cancelled.into());
                }
                Err(RecvTimeoutError::Timeout) => {
                    self.session()?.poll()?;
                }
            }
            if self.cancel.load(Ordering::Relaxed) {
                return Err(FilesError::Cancelled.into());
            }
        }
    }

    pub(super) fn send(&mut self, files: Vec<ToSend>) {
        let named = files
            .into_iter()
            .map(|it| (it.path.display().to_string(), it));
        let mut for_all = None;
        self.run_job(FileJobKind::Send, named.collect(), |desk, file| {
            let bytes = folder::read_file(&file.path)?;
            let new = TransferFile {
                remote_path: file.location,
                bytes,
                overwrite: file.overwrite,
            };
            desk.send_one(new, &mut for_all)
        });
    }

    fn send_one(
        &mut self,
        new: TransferFile,
        for_all: &mut Option<NameConflictChoice>,
    ) -> Result<FileResult, PcError> {
        match self.session()?.send(new.clone()) {
            Err(PcError::Files(FilesError::Refused {
                fault: TransferFault::Exists,
                ..
            })) => {}
            result => return result.map(|()| FileResult::Done),
        }
        let entries = self.session()?.list(new.remote_path.partition)?;
        let free = free_name(&new.remote_path.name, &entries);
        let choice = match for_all.clone() {
            Some(choice) => choice,
            None => {
                let answer = self.query(NameConflict::AtControl {
                    location: new.remote_path.clone(),
                    free_name: free.clone(),
                    entries,
                })?;
                if answer.for_all {
                    *for_all = Some(match &answer.choice {
                        // The next file gets a different name.
                        NameConflictChoice::Rename(_) => NameConflictChoice::Rename(None),
                        choice => choice.clone(),
                    });
                }
                answer.choice
            }
        };
        match choice {
            NameConflictChoice::Skip => Ok(FileResult::Skipped),
            NameConflictChoice::Overwrite => {
                let new = TransferFile {
                    overwrite: true,
                    ..new
                };
                self.session()?.send(new).map(|()| FileResult::Done)
            }
            NameConflictChoice::Rename(to) => {
                let name = new.remote_path.name.clone();
                let to = to.or(free);
                let to = to.ok_or_else(|| FilesError::NoFreeName(name.clone()));
                let to = match to {
                    Ok(to) => to,
                    Err(error) => return Ok(FileResult::Refused(error.message())),
                };
                let from = new.remote_path.clone();
                let talk = self.session()?;
                talk.change(&name, PcCommand::Rename { from, to })?;
                talk.send(new).map(|()| FileResult::Done)
            }
        }
    }

    pub(super) fn restore(&mut self, path: &Path) {
        let files = match folder::list_control_files(path) {
            Ok(files) => files,
            Err(error) => return self.report_failure(&error),
        };
        let files = files.into_iter().map(|file| ToSend {
            path: file.path,
            location: RemotePath {
                partition: Partition::User,
                name: file.name,
            },
            overwrite: true,
        });
        self.send(files.collect());
    }

    pub(super) fn receive(&mut self, places: Vec<RemotePath>, into: &Path) {
        if let Err(error) = folder::make_folder(into) {
            return self.report_failure(&error);
        }
        let named = places.into_iter().map(|it| (it.name.to_string(), it));
        let mut for_all = None;
        self.run_job(FileJobKind::Receive, named.collect(), |desk, place| {
            let Some(path) = desk.path_for(into.join(place.name.as_str()), &mut for_all)? else {
                return Ok(FileResult::Skipped);
            };
            let bytes = desk.session()?.receive(place)?;
            folder::write_file(&path, &bytes)?;
            Ok(FileResult::Done)
        });
    }

    /// Returns the path to which a received file is written; `None` if the operator skips the
    /// file. `for_all` keeps a choice for all files of the job.
    fn path_for(
        &mut self,
        path: PathBuf,
        for_all: &mut Option<NameConflictChoice>,
    ) -> Result<Option<PathBuf>, PcError> {
        if !platform::is_taken(&path) {
            return Ok(Some(path));
        }
        let choice = match for_all.clone() {
            Some(choice) => choice,
            None => {
                let answer = self.query(NameConflict::OnDisk(path.clone()))?;
                if answer.for_all {
                    *for_all = Some(answer.choice.clone());
                }
                answer.choice
            }
        };
        Ok(match choice {
            NameConflictChoice::Skip => None,
            NameConflictChoice::Overwrite => Some(path),
            NameConflictChoice::Rename(_) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let folder = path.parent().unwrap_or(Path::new("."));
                Some(folder::free_path(folder, &name))
            }
        })
    }

    pub(super) fn back_up(&mut self, into: &Path) {
        let listed = self.with_port(|talk| talk.list(Partition::User));
        let Some(entries) = listed else { return };
        let places = entries.into_iter().map(|entry| RemotePath {
            partition: Partition::User,
            name: entry.name,
        });
        self.receive(places.collect(), into);
    }

    pub(super) fn delete(&mut self, places: Vec<RemotePath>) {
        let named = places.into_iter().map(|it| (it.name.to_string(), it));
        self.run_job(FileJobKind::Delete, named.collect(), |desk, place| {
            let name = place.name.clone();
            let deleted = desk.session()?.change(&name, PcCommand::Delete(place));
            deleted.map(|()| FileResult::Done)
        });
    }
}
