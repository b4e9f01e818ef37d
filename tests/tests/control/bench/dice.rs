//! Random numbers and rounds of random tests.

/// A reproducible random number generator.
pub struct TestRandom(pub u64);

impl TestRandom {
    pub fn below(&mut self, limit: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) % u64::from(limit)) as u32
    }
}

/// The number of rounds: `usual`, or that of `ROUNDS=200` in the environment.
pub fn round_count(usual: u32) -> u32 {
    let wanted = std::env::var("ROUNDS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(usual)
}
