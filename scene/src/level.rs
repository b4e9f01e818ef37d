//! Levels of detail, and the choice of one by measured times.

/// Time between two pictures above which a level of detail counts as too slow, s.
const SLOW_S: f64 = 0.060;
/// Time between two pictures up to which a level of detail counts as fast, s.
const FAST_S: f64 = 0.040;
/// Number of pictures whose times are judged together.
const JUDGED_PICTURES: usize = 24;
/// Number of judgements in a row that must be fast before a higher level of detail is tried.
const FAST_JUDGEMENTS: u32 = 6;

/// Level of detail of the picture, from the least to the most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneLevel {
    /// The picture is drawn without OpenGL, by [`crate::software`].
    Processor,
    /// While something moves, the picture is drawn at a third of its size, with half the sides of
    /// the part, and shadows every six pictures.
    Coarse,
    /// While something moves, the picture is drawn at half its size.
    #[default]
    Half,
    /// The picture is drawn at its full size; by a graphics card with soft shadow edges and new
    /// shadows in each picture.
    Full,
}

impl SceneLevel {
    /// Returns the factor by which the picture is smaller than its viewport while something moves.
    pub const fn moving_share(self) -> i32 {
        match self {
            Self::Processor | Self::Coarse => 3,
            Self::Half => 2,
            Self::Full => 1,
        }
    }

    /// Number of pictures after which the shadows are drawn again while something moves.
    /// `is_software`: the processor computes OpenGL.
    pub const fn shadow_pictures(self, is_software: bool) -> u32 {
        match self {
            Self::Processor | Self::Coarse => 6,
            Self::Half => 3,
            Self::Full if is_software => 3,
            Self::Full => 1,
        }
    }

    /// Number of pictures after which the stationary parts are drawn again while something moves,
    /// to renew the shadows that moving parts cast on them. `is_software`: the processor computes
    /// OpenGL.
    pub const fn layer_pictures(self, is_software: bool) -> u32 {
        match self {
            Self::Full if !is_software => 1,
            _ => 15,
        }
    }

    /// Whether the level of detail draws soft edges of shadows. `is_software`: the processor
    /// computes OpenGL.
    pub const fn has_soft_shadow(self, is_software: bool) -> bool {
        matches!(self, Self::Full) && !is_software
    }

    /// Returns the number of sides of the finest part that are merged to one drawn side.
    pub const fn sides_per_side(self) -> u32 {
        match self {
            Self::Processor | Self::Coarse => 2,
            Self::Half | Self::Full => 1,
        }
    }
}

/// Chooses the level of detail from the measured times between pictures.
#[derive(Clone, Debug, Default)]
pub struct LevelChooser {
    /// Current level of detail; `None` before the first picture.
    level: Option<SceneLevel>,
    /// Highest level of detail that was not too slow; `None` if none is known.
    ceiling: Option<SceneLevel>,
    times_s: Vec<f64>,
    fast_judgements: u32,
}

impl LevelChooser {
    /// Returns the current level of detail. If `is_software`, the processor computes OpenGL, and
    /// the choice begins with half the size.
    pub fn level(&mut self, is_software: bool) -> SceneLevel {
        *self.level.get_or_insert(match is_software {
            true => SceneLevel::Half,
            false => SceneLevel::Full,
        })
    }

    /// Adds the time from one picture to the next while something moves, s. Returns the new level
    /// of detail if it has changed.
    pub fn add_time(&mut self, time_s: f64) -> Option<SceneLevel> {
        let level = self.level?;
        self.times_s.push(time_s);
        if self.times_s.len() < JUDGED_PICTURES {
            return None;
        }
        self.times_s.sort_by(f64::total_cmp);
        // A single interruption does not count.
        let usual_s = self.times_s[JUDGED_PICTURES * 3 / 4];
        self.times_s.clear();
        let chosen = if usual_s > SLOW_S {
            self.fast_judgements = 0;
            let lower = match level {
                SceneLevel::Full => SceneLevel::Half,
                SceneLevel::Half | SceneLevel::Coarse | SceneLevel::Processor => SceneLevel::Coarse,
            };
            self.ceiling = Some(lower);
            lower
        } else if usual_s < FAST_S {
            self.fast_judgements += 1;
            let higher = match level {
                SceneLevel::Processor | SceneLevel::Coarse => SceneLevel::Half,
                SceneLevel::Half | SceneLevel::Full => SceneLevel::Full,
            };
            let is_allowed = self.ceiling.is_none_or(|ceiling| higher <= ceiling);
            match is_allowed && self.fast_judgements >= FAST_JUDGEMENTS {
                true => higher,
                false => level,
            }
        } else {
            self.fast_judgements = 0;
            level
        };
        if chosen == level {
            return None;
        }
        self.fast_judgements = 0;
        self.level = Some(chosen);
        Some(chosen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed(chooser: &mut LevelChooser, time_s: f64, pictures: usize) -> Vec<SceneLevel> {
        let changes = (0..pictures).filter_map(|_| chooser.add_time(time_s));
        changes.collect()
    }

    #[test]
    fn a_slow_computer_gets_lower_levels_and_keeps_them() {
        let mut chooser = LevelChooser::default();
        assert_eq!(chooser.level(false), SceneLevel::Full);
        let changes = feed(&mut chooser, 0.09, 100);
        assert_eq!(changes, [SceneLevel::Half, SceneLevel::Coarse]);
        // Each level that was too slow is not tried again.
        assert_eq!(feed(&mut chooser, 0.034, 2000), []);
    }

    #[test]
    fn a_fast_software_renderer_gets_the_full_size_after_a_while() {
        let mut chooser = LevelChooser::default();
        assert_eq!(chooser.level(true), SceneLevel::Half);
        assert_eq!(feed(&mut chooser, 0.034, 100), []);
        assert_eq!(feed(&mut chooser, 0.034, 100), [SceneLevel::Full]);
        assert_eq!(chooser.level(true), SceneLevel::Full);
    }

    #[test]
    fn single_interruptions_and_usual_times_change_nothing() {
        let mut chooser = LevelChooser::default();
        chooser.level(true);
        for at in 0..500 {
            let time_s = if at % 10 == 0 { 0.5 } else { 0.05 };
            assert_eq!(chooser.add_time(time_s), None);
        }
    }
}
