//! Rounds of random tests.

/// Numbers that look random and are the same each time.
pub struct Dice(pub u64);

impl Dice {
    pub fn below(&mut self, most: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) % u64::from(most)) as u32
    }
}

/// More rounds with `ROUNDS=200` in the environment.
pub fn rounds(usual: u32) -> u32 {
    let wanted = std::env::var("ROUNDS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(usual)
}
