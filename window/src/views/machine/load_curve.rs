//! The load of the cuts of a program over its machine time.

use gsk_core::preview::{PreviewProgress, preview_with_progress};
use gsk_core::setup::Setup;
use gsk_messages::{Message, say};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::Job;

/// Greatest number of moments of a curve. A longer program has no load after them.
const MAX_MOMENTS: usize = 1_000_000;

/// The load at one moment of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadMoment {
    /// Machine time, s.
    pub time_s: f32,
    pub force_n: f32,
    pub power_kw: f32,
    pub torque_nm: f32,
}

/// The load over the machine time of a program.
#[derive(Clone, Debug, Default)]
pub struct LoadCurve {
    /// The material; `None` if the table has no constants for that of the job.
    pub material: Option<CuttingMaterial>,
    /// Whether the job names no grade.
    pub is_assumed: bool,
    /// Rated power of the spindle, kW; `None` if the machine file gives none.
    pub rated_power_kw: Option<f32>,
    /// Greatest force, power and torque of the program.
    pub greatest: LoadMoment,
    /// The moments at which a tool cuts, in the order of time.
    moments: Vec<LoadMoment>,
}

impl LoadCurve {
    /// Cuts the part of a job with the selected program and records the load. `can_continue`
    /// returns false to cancel; the result is then `None`.
    pub fn compute(
        setup: &Setup,
        job: &Job,
        can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
    ) -> Option<Self> {
        let mut curve = Self {
            material: job.cutting_material(),
            is_assumed: job.stock.grade.is_none(),
            rated_power_kw: setup.lathe.load.power_kw.map(|power| power as f32),
            ..Self::default()
        };
        let Some(material) = curve.material else {
            return Some(curve);
        };
        let rates = RapidRates::from_memory(&setup.memory);
        let mut machining = Machining::new(job.clone());
        let mut is_cancelled = false;
        preview_with_progress(
            setup,
            &setup.memory.programs,
            &mut |executed| {
                if curve.moments.len() >= MAX_MOMENTS {
                    return;
                }
                let load = machining.execute_move_with_load(executed, rates, &material);
                for (load, cut) in load
                    .iter()
                    .flat_map(|it| it.loads.iter().map(move |cut| (it, cut)))
                {
                    curve.add(LoadMoment {
                        time_s: (load.start_s + load.duration_s * cut.share) as f32,
                        force_n: cut.force_n as f32,
                        power_kw: cut.power_kw as f32,
                        torque_nm: cut.torque_nm as f32,
                    });
                }
            },
            &mut |progress| {
                is_cancelled |= !can_continue(progress);
                !is_cancelled
            },
        );
        (!is_cancelled).then_some(curve)
    }

    fn add(&mut self, moment: LoadMoment) {
        let greatest = &mut self.greatest;
        greatest.force_n = greatest.force_n.max(moment.force_n);
        greatest.power_kw = greatest.power_kw.max(moment.power_kw);
        greatest.torque_nm = greatest.torque_nm.max(moment.torque_nm);
        self.moments.push(moment);
    }

    /// The moments between two machine times, s.
    pub fn between(&self, from_s: f32, to_s: f32) -> &[LoadMoment] {
        let first = self.moments.partition_point(|it| it.time_s < from_s);
        let end = self.moments.partition_point(|it| it.time_s <= to_s);
        self.moments.get(first..end).unwrap_or_default()
    }

    /// The moment with the greatest force between two machine times, s; `None` if nothing is
    /// cut.
    pub fn heaviest(&self, from_s: f32, to_s: f32) -> Option<LoadMoment> {
        let moments = self.between(from_s, to_s).iter().copied();
        moments.max_by(|a, b| a.force_n.total_cmp(&b.force_n))
    }

    /// The force at a moment as a share of the greatest one, 0 to 1.
    pub fn share(&self, moment: LoadMoment) -> f32 {
        match self.greatest.force_n > 0.0 {
            true => moment.force_n / self.greatest.force_n,
            false => 0.0,
        }
    }

    /// Whether a moment needs more power than the spindle has.
    pub fn is_overload(&self, moment: LoadMoment) -> bool {
        self.rated_power_kw
            .is_some_and(|rated| moment.power_kw > rated)
    }

    /// What the curve shows: the material and the greatest load, what is assumed, and whether the
    /// spindle is too weak.
    pub fn messages(&self) -> Vec<Message> {
        let Some(material) = &self.material else {
            return vec![say::report_load_no_material()];
        };
        let greatest = &self.greatest;
        let mut messages = vec![say::report_load(
            material.name,
            material.kc11,
            material.mc,
            format_args!("{:.0}", greatest.force_n),
            format_args!("{:.2}", greatest.power_kw),
            format_args!("{:.1}", greatest.torque_nm),
        )];
        if self.is_assumed {
            messages.push(say::report_load_assumed(material.name));
        }
        if let Some(rated) = self.rated_power_kw.filter(|_| self.is_overload(*greatest)) {
            messages.push(say::load_power_exceeded(
                format_args!("{:.2}", greatest.power_kw),
                format_args!("{rated:.2}"),
            ));
        }
        messages
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::ProgramId;
    use gsk_core::program::Program;
    use gsk_workpiece::stock::Stock;
    use gsk_workpiece::tool::Tool;

    #[test]
    fn a_pass_of_twice_the_depth_has_about_twice_the_force() {
        let text = "G50 X100 Z50\nG97 G99 M03 S500\nT0101\nG00 X48 Z2\nG01 Z-30 F0.2\nG00 X50 Z2\n\
                    X44\nG01 Z-30\nG00 X100 Z50\nM30\n";
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        let mut job = Job::new(Stock::bar(50.0, 0.0, 70.0));
        job.tools.insert(1, Tool::turning());
        let curve = LoadCurve::compute(&setup, &job, &mut |_| true).expect("not cancelled");
        assert!(curve.is_assumed);
        let all = curve.between(0.0, f32::MAX);
        let middle = all.len() / 2;
        let mean =
            |part: &[LoadMoment]| part.iter().map(|it| it.force_n).sum::<f32>() / part.len() as f32;
        let (first, second) = (mean(&all[..middle]), mean(&all[middle..]));
        assert!((1.7..2.1).contains(&(second / first)), "{first} {second}");
        let last = all[all.len() - 1];
        assert!(
            curve
                .heaviest(0.0, last.time_s)
                .is_some_and(|it| curve.share(it) == 1.0)
        );
        assert_eq!(curve.heaviest(last.time_s + 1.0, f32::MAX), None);
    }
}
