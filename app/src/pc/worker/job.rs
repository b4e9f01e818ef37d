//! Jobs of several files: a refused file is reported and the job continues with the next
//! one; an error of the connection ends the job.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crossbeam::channel::RecvTimeoutError;
use gsk_messages::say;
use gsk_transfer::{Partition, PcCommand, RemotePath, TransferFault, TransferFile};
use web_time::Instant;

use super::{
    Answer, Choice, Desk, Fate, FilesError, Kind, LOOK, News, Order, PcError, Question, ToSend,
    folder,
};
use crate::pc::{Talk, free_name};
use crate::platform;

impl Desk {
    /// Processes the files of a job; reports their results and the new directory.
    fn job<T>(
        &mut self,
        kind: Kind,
        files: Vec<(String, T)>,
        mut one: impl FnMut(&mut Self, T) -> Result<Fate, PcError>,
    ) {
        let (names, files): (Vec<_>, Vec<_>) = files.into_iter().unzip();
        let all = files.len();
        self.tell.tell(News::Begun(kind, names));
        let mut ended = None;
        for (at, file) in files.into_iter().enumerate() {
            self.tell.tell(News::At(at));
            let fate = match one(self, file) {
                Ok(fate) => fate,
                Err(
                    error @ (PcError::File(_)
                    | PcError::Write(_)
                    | PcError::Files(FilesError::Refused { .. })),
                ) => Fate::Refused(error.message()),
                Err(error) => {
                    self.falls_back(&error);
                    ended = Some(say::transfer_unfinished(at, all, error.message()));
                    break;
                }
            };
            if let Some(talk) = &self.talk {
                self.tell.tell(News::Traffic(talk.traffic()));
            }
            self.tell.tell(News::Ended(at, fate));
        }
        // The cancellation does not apply to the next job.
        self.cancel.store(false, Ordering::Relaxed);
        self.tell.tell(News::Over(ended));
        if self.stage == super::Stage::Connected {
            self.list();
        }
    }

    fn talk(&mut self) -> Result<&mut Talk, PcError> {
        let closed = || FilesError::Gone(std::io::ErrorKind::NotConnected.into());
        self.talk.as_mut().ok_or_else(|| closed().into())
    }

    /// Sends a question to the window and waits for the answer; keeps the line alive
    /// meanwhile.
    fn ask(&mut self, question: Question) -> Result<Answer, PcError> {
        self.tell.tell(News::Asked(question));
        loop {
            match platform::receive(&self.orders, Some(Instant::now() + LOOK)) {
                Ok(Order::Answer(answer)) => return Ok(answer),
                Ok(Order::Close) => {
                    self.close();
                    return Err(FilesError::Cancelled.into());
                }
                // The window sends no other command while it shows the question.
                Ok(_) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(FilesError::Cancelled.into());
                }
                Err(RecvTimeoutError::Timeout) => {
                    self.talk()?.idle()?;
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
        let mut of_all = None;
        self.job(Kind::Send, named.collect(), |desk, file| {
            let bytes = folder::read(&file.path)?;
            let new = TransferFile {
                remote_path: file.place,
                bytes,
                overwrite: file.overwrite,
            };
            desk.send_one(new, &mut of_all)
        });
    }

    fn send_one(
        &mut self,
        new: TransferFile,
        of_all: &mut Option<Choice>,
    ) -> Result<Fate, PcError> {
        match self.talk()?.send(new.clone()) {
            Err(PcError::Files(FilesError::Refused {
                fault: TransferFault::Exists,
                ..
            })) => {}
            result => return result.map(|()| Fate::Done),
        }
        let entries = self.talk()?.list(new.remote_path.partition)?;
        let free = free_name(&new.remote_path.name, &entries);
        let choice = match of_all.clone() {
            Some(choice) => choice,
            None => {
                let answer = self.ask(Question::AtControl {
                    place: new.remote_path.clone(),
                    free: free.clone(),
                    entries,
                })?;
                if answer.of_all {
                    *of_all = Some(match &answer.choice {
                        // The next file gets a different name.
                        Choice::Rename(_) => Choice::Rename(None),
                        choice => choice.clone(),
                    });
                }
                answer.choice
            }
        };
        match choice {
            Choice::Skip => Ok(Fate::Skipped),
            Choice::Overwrite => {
                let new = TransferFile {
                    overwrite: true,
                    ..new
                };
                self.talk()?.send(new).map(|()| Fate::Done)
            }
            Choice::Rename(to) => {
                let name = new.remote_path.name.clone();
                let to = to.or(free);
                let to = to.ok_or_else(|| FilesError::NoFreeName(name.clone()));
                let to = match to {
                    Ok(to) => to,
                    Err(error) => return Ok(Fate::Refused(error.message())),
                };
                let from = new.remote_path.clone();
                let talk = self.talk()?;
                talk.change(&name, PcCommand::Rename { from, to })?;
                talk.send(new).map(|()| Fate::Done)
            }
        }
    }

    pub(super) fn restore(&mut self, path: &Path) {
        let files = match folder::of_folder(path) {
            Ok(files) => files,
            Err(error) => return self.failed(&error),
        };
        let files = files.into_iter().map(|file| ToSend {
            path: file.path,
            place: RemotePath {
                partition: Partition::User,
                name: file.name,
            },
            overwrite: true,
        });
        self.send(files.collect());
    }

    pub(super) fn receive(&mut self, places: Vec<RemotePath>, into: &Path) {
        if let Err(error) = folder::make(into) {
            return self.failed(&error);
        }
        let named = places.into_iter().map(|it| (it.name.to_string(), it));
        let mut of_all = None;
        self.job(Kind::Receive, named.collect(), |desk, place| {
            let Some(path) = desk.path_for(into.join(place.name.as_str()), &mut of_all)? else {
                return Ok(Fate::Skipped);
            };
            let bytes = desk.talk()?.receive(place)?;
            folder::write(&path, &bytes)?;
            Ok(Fate::Done)
        });
    }

    /// Returns the path for a received file; `None`: skip the file.
    fn path_for(
        &mut self,
        path: PathBuf,
        of_all: &mut Option<Choice>,
    ) -> Result<Option<PathBuf>, PcError> {
        if !platform::is_taken(&path) {
            return Ok(Some(path));
        }
        let choice = match of_all.clone() {
            Some(choice) => choice,
            None => {
                let answer = self.ask(Question::OnDisk(path.clone()))?;
                if answer.of_all {
                    *of_all = Some(answer.choice.clone());
                }
                answer.choice
            }
        };
        Ok(match choice {
            Choice::Skip => None,
            Choice::Overwrite => Some(path),
            Choice::Rename(_) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let folder = path.parent().unwrap_or(Path::new("."));
                Some(folder::free(folder, &name))
            }
        })
    }

    pub(super) fn back_up(&mut self, into: &Path) {
        let listed = self.at_port(|talk| talk.list(Partition::User));
        let Some(entries) = listed else { return };
        let places = entries.into_iter().map(|entry| RemotePath {
            partition: Partition::User,
            name: entry.name,
        });
        self.receive(places.collect(), into);
    }

    pub(super) fn delete(&mut self, places: Vec<RemotePath>) {
        let named = places.into_iter().map(|it| (it.name.to_string(), it));
        self.job(Kind::Delete, named.collect(), |desk, place| {
            let name = place.name.clone();
            let deleted = desk.talk()?.change(&name, PcCommand::Delete(place));
            deleted.map(|()| Fate::Done)
        });
    }
}
