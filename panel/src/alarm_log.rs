//! Records alarms with their time and block. The control keeps no record: its alarm page shows
//! active alarms and RESET clears it.

use std::collections::VecDeque;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;

/// Greatest number of recorded alarms; the oldest is removed first.
pub const MAX_RECORDS: usize = 100;

/// An alarm that was raised, with the block and the time at which it was raised.
#[derive(Clone, Debug, PartialEq)]
pub struct AlarmRecord {
    /// The raised alarm: number, program, line and reason.
    pub alarm: Alarm,
    /// Text of the program block that raised the alarm; empty if no block raised it.
    pub block: String,
    /// Machine time since power-on at which the alarm was raised, ms.
    pub at_ms: u64,
    /// The control's date when the alarm was raised, YYYYMMDD.
    pub date: u32,
    /// The control's time of day when the alarm was raised, hhmmss.
    pub time: u32,
}

/// The alarms and ladder messages since the control was opened, the newest first.
#[derive(Clone, Debug, Default)]
pub struct AlarmLog {
    records: VecDeque<AlarmRecord>,
    /// Numbers of the alarms and messages that were active at the last update.
    active: Vec<u16>,
}

impl AlarmLog {
    /// Returns the recorded alarms, the newest first.
    pub fn newest_first(&self) -> impl Iterator<Item = &AlarmRecord> {
        self.records.iter()
    }

    /// Records alarms and ladder messages that have become active. Call it every tick. Returns
    /// their number.
    pub fn update(&mut self, cnc: &Cnc) -> usize {
        let message = cnc.active_message();
        let active = || cnc.alarms().iter().chain(&message);
        let same = active()
            .map(|alarm| alarm.number)
            .eq(self.active.iter().copied());
        if same {
            return 0;
        }
        let new: Vec<&Alarm> = active()
            .filter(|alarm| !self.active.contains(&alarm.number))
            .collect();
        // The newest is at the front.
        for alarm in new.iter().rev() {
            self.records.push_front(new_record(alarm, cnc));
        }
        self.records.truncate(MAX_RECORDS);
        let raised = new.len();
        self.active = active().map(|alarm| alarm.number).collect();
        raised
    }

    /// Removes the newest records, because the control went back to a moment before them.
    pub fn remove_newest(&mut self, count: usize, cnc: &Cnc) {
        self.records.drain(..count.min(self.records.len()));
        let message = cnc.active_message();
        let active = cnc.alarms().iter().chain(&message);
        self.active = active.map(|alarm| alarm.number).collect();
    }
}

fn new_record(alarm: &Alarm, cnc: &Cnc) -> AlarmRecord {
    let block = alarm.source.and_then(|source| {
        let program = cnc.programs().get(source.program)?;
        Some(program.line(source.line).trim().to_owned())
    });
    let (date, time) = cnc.date_and_time();
    AlarmRecord {
        alarm: alarm.clone(),
        block: block.unwrap_or_default(),
        at_ms: cnc.ticks(),
        date,
        time,
    }
}

#[cfg(test)]
mod tests {
    use gsk_core::command::ProgramId;
    use gsk_core::memory::DayTime;
    use gsk_core::setup::Setup;

    use super::*;
    use crate::emulator::{Emulator, WaitCondition};
    use crate::keys::Key;

    fn run(emulator: &mut Emulator, record: &mut AlarmLog, ms: u64) {
        for _ in 0..ms {
            emulator.tick();
            record.update(emulator.cnc());
        }
    }

    #[test]
    fn an_alarm_is_recorded_once_with_its_block_and_stays_after_reset() {
        let mut setup = Setup {
            day_time: DayTime::from_text("2024-02-29 23:59:58").unwrap(),
            ..Setup::default()
        };
        let stored = setup
            .memory
            .programs
            .store("O0007;\nG04 X0.1;\nN20 G77 X1;\nM30;\n");
        assert_eq!(stored, Ok(7));
        setup.memory.programs.select(ProgramId::Stored(7));
        let mut emulator = Emulator::new(setup);
        emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
        let mut record = AlarmLog::default();
        emulator.press(Key::Auto);
        for round in 1..=2 {
            emulator.key_down(Key::CycleStart);
            run(&mut emulator, &mut record, 100);
            emulator.key_up(Key::CycleStart);
            run(&mut emulator, &mut record, 2_000);
            assert_eq!(record.newest_first().count(), round);
            let newest = record.newest_first().next().unwrap();
            assert_eq!(newest.alarm.number, 10);
            assert_eq!(newest.block, "N20 G77 X1;");
            let source = newest.alarm.source.unwrap();
            assert_eq!((source.program, source.line), (ProgramId::Stored(7), 3));
            assert!(newest.at_ms > 0 && newest.at_ms <= emulator.cnc().ticks());
            assert!(newest.date == 20_240_301 || newest.date == 20_240_229);
            emulator.key_down(Key::Reset);
            run(&mut emulator, &mut record, 200);
            emulator.key_up(Key::Reset);
            run(&mut emulator, &mut record, 200);
            assert!(emulator.cnc().alarms().is_empty());
        }
        let times: Vec<u64> = record.newest_first().map(|it| it.at_ms).collect();
        assert!(times[0] > times[1], "the newest first");
    }

    #[test]
    fn the_record_is_bounded() {
        let mut emulator = Emulator::new(Setup::default());
        emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
        let mut record = AlarmLog::default();
        for _ in 0..MAX_RECORDS + 5 {
            emulator.key_down(Key::EmergencyStop);
            run(&mut emulator, &mut record, 60);
            emulator.key_up(Key::EmergencyStop);
            emulator.key_down(Key::EmergencyStop);
            run(&mut emulator, &mut record, 60);
            emulator.key_up(Key::EmergencyStop);
            emulator.press(Key::Reset);
            run(&mut emulator, &mut record, 1);
        }
        assert_eq!(record.newest_first().count(), MAX_RECORDS);
        assert!(
            record
                .newest_first()
                .all(|it| it.alarm.number == 207 && it.block.is_empty())
        );
    }
}
