//! Debounces the machine inputs (parameter 020).

use serde::{Deserialize, Serialize};

/// Number of bytes in the X area.
pub(crate) const X_BYTES: usize = 30;

/// Debouncing filter of the X inputs. It samples each contact every 4 ms and accepts a
/// change after the number of equal samples in parameter 020.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputFilter {
    accepted: [u8; X_BYTES],
    /// Number of samples in which each bit has differed from the accepted state.
    differing: Vec<u8>,
}

impl Default for InputFilter {
    fn default() -> Self {
        Self {
            accepted: [0; X_BYTES],
            differing: vec![0; X_BYTES * 8],
        }
    }
}

impl InputFilter {
    /// Creates a filter whose accepted contacts are these.
    pub fn from_contacts(contacts: &[u8; X_BYTES]) -> Self {
        Self {
            accepted: *contacts,
            ..Self::default()
        }
    }

    /// Returns the filtered state of all contacts.
    pub const fn accepted(&self) -> &[u8; X_BYTES] {
        &self.accepted
    }

    /// Processes one sample of all contacts. `samples` is parameter 020, 0..=15; a larger
    /// value counts as 2, to which the control corrects it at power-on.
    pub fn sample(&mut self, contacts: &[u8; X_BYTES], samples: i32) {
        let needed = match u8::try_from(samples) {
            Ok(needed @ 0..=15) => needed.max(1),
            _ => 2,
        };
        // In most ticks nothing changes. The compiler vectorises a fold over the bits, but
        // not a search.
        let pending = self.differing.iter().fold(0, |any, count| any | count);
        if pending == 0 && self.accepted == *contacts {
            return;
        }
        for (index, (accepted, contact)) in self.accepted.iter_mut().zip(contacts).enumerate() {
            let differing = &mut self.differing[index * 8..index * 8 + 8];
            let changed = *accepted ^ contact;
            if changed == 0 {
                differing.fill(0);
                continue;
            }
            for (bit, count) in differing.iter_mut().enumerate() {
                if changed & (1 << bit) == 0 {
                    *count = 0;
                    continue;
                }
                *count += 1;
                if *count >= needed {
                    *accepted ^= 1 << bit;
                    *count = 0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_counts_after_two_equal_samples() {
        let mut filter = InputFilter::default();
        let mut contacts = [0; X_BYTES];
        contacts[20] = 1;
        filter.sample(&contacts, 2);
        assert_eq!(filter.accepted()[20], 0);
        filter.sample(&contacts, 2);
        assert_eq!(filter.accepted()[20], 1);
    }

    #[test]
    fn a_bounce_is_filtered_out() {
        let mut filter = InputFilter::default();
        let mut contacts = [0; X_BYTES];
        for sample in 0..100 {
            contacts[0] = u8::from(sample % 2 == 0);
            filter.sample(&contacts, 2);
            assert_eq!(filter.accepted()[0], 0);
        }
    }

    #[test]
    fn a_width_over_fifteen_counts_as_two() {
        let mut filter = InputFilter::default();
        let mut contacts = [0; X_BYTES];
        contacts[3] = 0x80;
        filter.sample(&contacts, 99);
        filter.sample(&contacts, 99);
        assert_eq!(filter.accepted()[3], 0x80);
    }
}
