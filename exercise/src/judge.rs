//! Judges a solution: replays its recording from the start state of the task, follows the machine
//! tick by tick, and gives points.

use std::ops::Deref;
use std::sync::Arc;

use gsk_core::machine::LatheFault;
use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_messages::{Message, say};
use gsk_runner::machining::CollisionFinding;

use crate::criterion::{CriterionRule, ExerciseCriterion, MachineCondition};
use crate::part_size::measure_dimension;
use crate::procedure::{ProcedureLog, alarm_message};
use crate::report::{CriterionVerdict, ExerciseReport, MarkEvidence};
pub use crate::solution_replay::JudgeError;
use crate::solution_replay::{ReplayedSolution, SlicedSolution, SolutionFollower, replay_solution};
use crate::task::ExerciseTask;

/// Time between two checks of the conditions, ticks of 1 ms.
const CHECK_INTERVAL_TICKS: u64 = 20;

/// Judges a recording.
///
/// # Errors
/// The recording is damaged or was not made by an operator on the machine of the task.
pub fn judge(task: &ExerciseTask, recording: &[u8]) -> Result<ExerciseReport, JudgeError> {
    let start = task.create_start().map_err(JudgeError::Start)?;
    let judge = SolutionJudge::new(task, &start);
    give_points(replay_solution(start, judge, recording)?)
}

fn give_points<T: Deref<Target = ExerciseTask>>(
    replayed: ReplayedSolution<SolutionJudge<T>>,
) -> Result<ExerciseReport, JudgeError> {
    // A solution that exceeds the time limit is not replayed to its end.
    let is_over_limit = replayed.judge.is_over();
    match replayed.end {
        Some(end) if replayed.is_whole || is_over_limit => Ok(replayed.judge.finish(&end)),
        _ => Err(JudgeError::Incomplete),
    }
}

/// Judges a recording in slices, between which a page of a browser can be drawn.
#[derive(Debug)]
pub struct SlicedJudging(SlicedSolution<SolutionJudge<Arc<ExerciseTask>>>);

impl SlicedJudging {
    /// Starts to judge a recording.
    ///
    /// # Errors
    /// The recording is damaged.
    pub fn new(task: &Arc<ExerciseTask>, recording: &[u8]) -> Result<Self, JudgeError> {
        let start = task.create_start().map_err(JudgeError::Start)?;
        let judge = SolutionJudge::new(Arc::clone(task), &start);
        SlicedSolution::new(start, judge, recording).map(Self)
    }

    /// Replays at most `ticks` ticks; returns whether the replay has ended.
    pub fn advance(&mut self, ticks: u64) -> bool {
        self.0.advance(ticks)
    }

    /// Returns the report after the end of the replay.
    ///
    /// # Errors
    /// The recording is damaged or was not made by an operator on the machine of the task.
    pub fn finish(self) -> Result<ExerciseReport, JudgeError> {
        self.0.finish().and_then(give_points)
    }

    /// Returns the share of the solution that is replayed, 0 to 1.
    pub fn progress(&self) -> f32 {
        self.0.progress()
    }
}

/// Observes the machine during one solution and decides which criteria are met.
#[derive(Clone, Debug)]
pub struct SolutionJudge<T> {
    task: T,
    start_tick: u64,
    log: ProcedureLog,
    watches: Vec<ConditionProgress>,
    is_over: bool,
}

/// How far the conditions of one criterion have been met.
#[derive(Clone, Debug, Default)]
struct ConditionProgress {
    /// Number of groups of conditions that have held one after another.
    held_groups: usize,
    /// Moment and value that decided the criterion; `None` while it is undecided.
    decided: Option<MarkEvidence>,
}

impl<T: Deref<Target = ExerciseTask>> SolutionJudge<T> {
    /// Creates a judge for a solution that begins in the start state `start` of the task.
    pub fn new(task: T, start: &MachineMoment) -> Self {
        let mut judge = Self {
            start_tick: start.ticks(),
            log: ProcedureLog::new(start),
            watches: vec![ConditionProgress::default(); task.criteria.len()],
            task,
            is_over: false,
        };
        judge.check_conditions(start);
        judge
    }

    /// Returns whether the time limit of the task is exceeded.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Checks an input of the learner before the machine executes it.
    fn note_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) {
        let repairs = self.log.repairs.len();
        self.log.before_input(moment, &recorded.input);
        if self.log.repairs.len() > repairs {
            self.check_repair(moment);
        }
    }

    /// Checks the conditions after a tick of the machine; `collision` is the first collision in it.
    fn follow_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) {
        self.log.after_tick(moment, collision);
        let duration = moment.ticks().saturating_sub(self.start_tick);
        if duration.is_multiple_of(CHECK_INTERVAL_TICKS) {
            self.check_conditions(moment);
        }
        self.is_over = duration >= self.task.time_limit_ms;
    }

    fn check_conditions(&mut self, moment: &MachineMoment) {
        let lathe = moment.emulator.lathe();
        let is_faulty = self.task.faults.iter().any(|fault| lathe.has_fault(*fault));
        let criteria = self.task.criteria.iter().zip(&mut self.watches);
        for (criterion, watch) in criteria.filter(|(_, watch)| watch.decided.is_none()) {
            let is_decided = match &criterion.rule {
                CriterionRule::WorksAfterRepair(_) if is_faulty => false,
                CriterionRule::Reached(conditions) | CriterionRule::Never(conditions) => {
                    all_hold(conditions, moment)
                }
                CriterionRule::InOrder(groups) | CriterionRule::WorksAfterRepair(groups) => {
                    let next = groups.get(watch.held_groups);
                    if next.is_some_and(|group| all_hold(group, moment)) {
                        watch.held_groups += 1;
                    }
                    watch.held_groups == groups.len()
                }
                _ => false,
            };
            if is_decided {
                watch.decided = Some(self.log.evidence(moment));
            }
        }
    }

    /// Records a repair that was made in a state that a criterion forbids.
    fn check_repair(&mut self, moment: &MachineMoment) {
        let criteria = self.task.criteria.iter().zip(&mut self.watches);
        for (criterion, watch) in criteria.filter(|(_, watch)| watch.decided.is_none()) {
            if let CriterionRule::RepairedWhile(conditions) = &criterion.rule
                && let Some(found) = first_unmet(conditions, moment)
            {
                watch.decided = Some(self.log.evidence_of(moment, found));
            }
        }
    }

    /// Ends the solution in the machine state `end` and returns its report.
    pub fn finish(mut self, end: &MachineMoment) -> ExerciseReport {
        self.check_conditions(end);
        let task = &*self.task;
        let mut results: Vec<(bool, MarkEvidence)> = task
            .criteria
            .iter()
            .zip(&self.watches)
            .map(|(criterion, watch)| self.evaluate(criterion, watch, end))
            .collect();
        let demands = task.criteria.iter().zip(&results);
        let has_worked = demands
            .filter(|(criterion, _)| !criterion.is_exclusion())
            .any(|(_, (is_met, _))| *is_met);
        if !has_worked {
            for (is_met, evidence) in results.iter_mut().filter(|(is_met, _)| *is_met) {
                *is_met = false;
                evidence.found = Some(say::exercise_nothing_done());
            }
        }
        let verdicts: Vec<CriterionVerdict> = task
            .criteria
            .iter()
            .zip(results)
            .map(|(criterion, (is_met, evidence))| CriterionVerdict {
                id: criterion.id.clone(),
                points: if is_met { criterion.points } else { 0 },
                max_points: criterion.points,
                is_met,
                evidence,
            })
            .collect();
        ExerciseReport {
            task: task.id.clone(),
            task_hash: task.hash.to_string(),
            points: verdicts.iter().map(|verdict| verdict.points).sum(),
            max_points: task.max_points(),
            duration_ms: end.ticks().saturating_sub(self.start_tick),
            verdicts,
            refused: self.log.refused,
        }
    }

    fn evaluate(
        &self,
        criterion: &ExerciseCriterion,
        watch: &ConditionProgress,
        end: &MachineMoment,
    ) -> (bool, MarkEvidence) {
        let log = &self.log;
        let or_end = |evidence: &Option<MarkEvidence>| {
            let at_end = || log.evidence(end);
            evidence.clone().unwrap_or_else(at_end)
        };
        let absent = |evidence: &Option<MarkEvidence>| (evidence.is_none(), or_end(evidence));
        match &criterion.rule {
            CriterionRule::Size(dimension, size) => {
                let machining = end.part.machining();
                let measured = machining
                    .and_then(|it| measure_dimension(&it.scene().part().section(), dimension));
                let evidence = MarkEvidence {
                    measured,
                    found: measured.is_none().then(say::exercise_no_dimension),
                    ..log.evidence(end)
                };
                (measured.is_some_and(|it| size.contains(it)), evidence)
            }
            CriterionRule::AtEnd(conditions) => {
                let unmet = first_unmet(conditions, end);
                let is_met = unmet.is_none();
                let found = unmet.or_else(|| log.evidence(end).found);
                (
                    is_met,
                    MarkEvidence {
                        found,
                        ..log.evidence(end)
                    },
                )
            }
            CriterionRule::Reached(conditions) => match &watch.decided {
                Some(evidence) => (true, evidence.clone()),
                None => self.not_reached(conditions, end),
            },
            CriterionRule::InOrder(groups) | CriterionRule::WorksAfterRepair(groups) => {
                match &watch.decided {
                    Some(evidence) => (true, evidence.clone()),
                    None => {
                        let missing = groups.get(watch.held_groups);
                        self.not_reached(missing.map_or(&[], Vec::as_slice), end)
                    }
                }
            }
            CriterionRule::Never(_) => absent(&watch.decided),
            CriterionRule::RepairedWhile(_) => {
                let is_met = watch.decided.is_none() && !log.repairs.is_empty();
                (is_met, or_end(&watch.decided))
            }
            CriterionRule::Variable { number, range } => {
                let cnc = end.emulator.cnc();
                let value = match cnc.are_variables_real() {
                    true => cnc.real_variable(*number),
                    false => cnc.variables().get(*number).map(|value| value as f64),
                };
                self.variable_result(value, *range, end)
            }
            CriterionRule::ReferencedBeforeStart => {
                let is_met = log.first_start.is_some() && log.unreferenced_start.is_none();
                let decided = log.unreferenced_start.as_ref().or(log.first_start.as_ref());
                (is_met, or_end(&decided.cloned()))
            }
            CriterionRule::ToolMeasured(number) => match log.tool_cuts.get(number) {
                Some((evidence, is_measured)) => (*is_measured, evidence.clone()),
                None => (false, log.evidence_of(end, say::exercise_no_cut(number))),
            },
            CriterionRule::TriedBeforeCut => {
                let tick =
                    |evidence: &Option<MarkEvidence>| evidence.as_ref().and_then(|it| it.tick);
                let (trial, cut) = (tick(&log.trial), tick(&log.first_cut));
                let is_met = trial.is_some_and(|trial| cut.is_none_or(|cut| trial < cut));
                (
                    is_met,
                    or_end(if is_met { &log.trial } else { &log.first_cut }),
                )
            }
            CriterionRule::NoCrash => absent(&log.crash),
            CriterionRule::NoAlarm => absent(&log.alarm),
            CriterionRule::NoIgnoredAlarm => {
                let alarm = end.emulator.cnc().alarms().first();
                let active = alarm.map(|alarm| log.evidence_of(end, alarm_message(alarm)));
                absent(&log.ignored_alarm.clone().or(active))
            }
            CriterionRule::Within(limit) => {
                let duration = end.ticks().saturating_sub(self.start_tick);
                (duration <= *limit, log.evidence(end))
            }
            CriterionRule::FirstRepair(fault) => {
                let first = log.repairs.first();
                let is_met = first.is_some_and(|repair| repair.fault == *fault);
                (is_met, or_end(&first.map(|repair| repair.evidence.clone())))
            }
            CriterionRule::Repaired(fault) => self.repair_result(*fault, end),
        }
    }

    /// Returns the verdict of a criterion whose conditions were not met, with the first condition
    /// that does not hold at the end.
    fn not_reached(
        &self,
        conditions: &[MachineCondition],
        end: &MachineMoment,
    ) -> (bool, MarkEvidence) {
        let evidence = MarkEvidence {
            found: first_unmet(conditions, end),
            ..self.log.evidence(end)
        };
        (false, evidence)
    }

    fn variable_result(
        &self,
        value: Option<f64>,
        range: (f64, f64),
        end: &MachineMoment,
    ) -> (bool, MarkEvidence) {
        let is_met = value.is_some_and(|value| (range.0..=range.1).contains(&value));
        let evidence = MarkEvidence {
            measured: value,
            ..self.log.evidence(end)
        };
        (is_met, evidence)
    }

    fn repair_result(&self, fault: LatheFault, end: &MachineMoment) -> (bool, MarkEvidence) {
        let repair = self.log.repairs.iter().find(|repair| repair.fault == fault);
        let is_met = repair.is_some() && !end.emulator.lathe().has_fault(fault);
        let evidence = repair.map(|repair| repair.evidence.clone());
        (is_met, evidence.unwrap_or_else(|| self.log.evidence(end)))
    }
}

fn all_hold(conditions: &[MachineCondition], moment: &MachineMoment) -> bool {
    let mut conditions = conditions.iter();
    conditions.all(|condition| condition.expectation.check(&moment.emulator).is_ok())
}

/// Returns a message about the first condition that does not hold; `None` if all hold.
fn first_unmet(conditions: &[MachineCondition], moment: &MachineMoment) -> Option<Message> {
    conditions.iter().find_map(|condition| {
        let unmet = condition.expectation.check(&moment.emulator).err()?;
        Some(say::subject_reason(&condition.text, unmet.message()))
    })
}

impl<T: Deref<Target = ExerciseTask>> SolutionFollower for SolutionJudge<T> {
    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) {
        self.note_input(moment, recorded);
    }

    fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) -> bool {
        self.follow_tick(moment, collision);
        !self.is_over()
    }
}
