//! Seals results in the format of minisign: Ed25519 over the BLAKE2b hash of the bytes.
//!
//! ```text
//! untrusted comment: signature of a GSK980TD exercise result
//! base64(ED, key number, signature of the hash)
//! trusted comment: 03-face-and-turn
//! base64(signature of the first signature and the trusted comment)
//! ```
//!
//! `minisign -V` verifies a seal; keys are files that minisign reads, without a password. A seal
//! proves that a file was not altered after it was sealed. It does not prove the work of a
//! learner who has the key on his computer: only the replay does.

use core::fmt;

use base64ct::{Base64, Encoding};
use blake2::{Blake2b256, Blake2b512, Digest};
use ed25519_dalek::{Signature, Signer, SigningKey, VerifyingKey};

/// First line of a seal. minisign does not sign it, so a reader compares it.
const SEAL_COMMENT: &str = "untrusted comment: signature of a GSK980TD exercise result";
const TRUSTED_COMMENT: &str = "trusted comment: ";
const SECRET_COMMENT: &str = "untrusted comment: GSK980TD exercise key, without a password";
const PUBLIC_COMMENT: &str = "untrusted comment: minisign public key of GSK980TD exercise results";

/// Algorithm identifier of minisign keys: Ed25519.
const KEY_ALGORITHM: [u8; 2] = *b"Ed";
const HASHED_ALGORITHM: [u8; 2] = *b"ED";
const CHECKSUM_ALGORITHM: [u8; 2] = *b"B2";
/// Bytes of a key file that mean: no key derivation, because the key has no password.
const NO_DERIVATION: [u8; 2] = [0, 0];
/// Size of the salt and both limits of the key derivation in a key file, bytes.
const DERIVATION_BYTES: usize = 32 + 8 + 8;
const NUMBER_BYTES: usize = 8;
const KEY_BYTES: usize = 32;
const SIGNATURE_BYTES: usize = 64;

/// Number that identifies a key, as minisign shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct KeyNumber([u8; NUMBER_BYTES]);

impl fmt::Display for KeyNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // minisign shows the number as a little-endian integer.
        let mut digits = self.0.iter().rev();
        digits.try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}

/// The private key with which results are sealed.
pub struct SealKey {
    number: KeyNumber,
    key: SigningKey,
}

impl fmt::Debug for SealKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SealKey({})", self.number)
    }
}

/// The public key with which seals are verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SealPublicKey {
    number: KeyNumber,
    key: VerifyingKey,
}

impl SealKey {
    /// Creates a private key from random bytes and a random number.
    pub fn from_random(seed: &[u8; KEY_BYTES], number: [u8; NUMBER_BYTES]) -> Self {
        Self {
            number: KeyNumber(number),
            key: SigningKey::from_bytes(seed),
        }
    }

    /// Returns the number that identifies the key.
    pub const fn number(&self) -> KeyNumber {
        self.number
    }

    /// Returns the public key that verifies the seals of this key.
    pub fn public_key(&self) -> SealPublicKey {
        SealPublicKey {
            number: self.number,
            key: self.key.verifying_key(),
        }
    }

    /// Returns the private key as the text of a minisign key file.
    pub fn to_text(&self) -> String {
        let mut bytes = Vec::new();
        bytes.extend(KEY_ALGORITHM);
        bytes.extend(NO_DERIVATION);
        bytes.extend(CHECKSUM_ALGORITHM);
        bytes.extend([0; DERIVATION_BYTES]);
        bytes.extend(self.number.0);
        bytes.extend(self.key.to_keypair_bytes());
        bytes.extend(self.checksum());
        format!("{SECRET_COMMENT}\n{}\n", Base64::encode_string(&bytes))
    }

    fn checksum(&self) -> [u8; 32] {
        let mut hasher = Blake2b256::new();
        hasher.update(KEY_ALGORITHM);
        hasher.update(self.number.0);
        hasher.update(self.key.to_keypair_bytes());
        hasher.finalize().into()
    }

    /// Reads a private key from the text of a minisign key file; `None` if it is damaged or has a
    /// password.
    pub fn from_text(text: &str) -> Option<Self> {
        let bytes = Base64::decode_vec(text.lines().nth(1)?.trim()).ok()?;
        let number_start = 6 + DERIVATION_BYTES;
        let key_start = number_start + NUMBER_BYTES;
        let head: [u8; 6] = bytes.get(..6)?.try_into().ok()?;
        let expected = [KEY_ALGORITHM, NO_DERIVATION, CHECKSUM_ALGORITHM].concat();
        if head[..] != expected[..] {
            return None;
        }
        let number = bytes.get(number_start..key_start)?.try_into().ok()?;
        let pair = bytes.get(key_start..key_start + 2 * KEY_BYTES)?;
        let key = SealKey {
            number: KeyNumber(number),
            key: SigningKey::from_keypair_bytes(pair.try_into().ok()?).ok()?,
        };
        let checksum = bytes.get(key_start + 2 * KEY_BYTES..)?;
        (checksum == key.checksum()).then_some(key)
    }

    /// Returns the seal (minisign signature) of `bytes`. `comment` is a line that the seal also
    /// covers.
    pub fn seal(&self, bytes: &[u8], comment: &str) -> String {
        let signature = self.key.sign(&Blake2b512::digest(bytes));
        let mut first = Vec::new();
        first.extend(HASHED_ALGORITHM);
        first.extend(self.number.0);
        first.extend(signature.to_bytes());
        let mut covered = signature.to_bytes().to_vec();
        covered.extend(comment.as_bytes());
        let second = self.key.sign(&covered).to_bytes();
        format!(
            "{SEAL_COMMENT}\n{}\n{TRUSTED_COMMENT}{comment}\n{}\n",
            Base64::encode_string(&first),
            Base64::encode_string(&second)
        )
    }
}

impl SealPublicKey {
    /// Returns the number that identifies the key.
    pub const fn number(&self) -> KeyNumber {
        self.number
    }

    /// Returns the public key as minisign writes it: one line of base64.
    pub fn to_line(&self) -> String {
        let mut bytes = KEY_ALGORITHM.to_vec();
        bytes.extend(self.number.0);
        bytes.extend(self.key.as_bytes());
        Base64::encode_string(&bytes)
    }

    /// Returns the public key as the text of a minisign key file.
    pub fn to_text(&self) -> String {
        format!("{PUBLIC_COMMENT}\n{}\n", self.to_line())
    }

    /// Reads a public key from a line of base64; `None` if the line is not a key.
    pub fn from_line(line: &str) -> Option<Self> {
        let bytes = Base64::decode_vec(line).ok()?;
        let rest = bytes.strip_prefix(&KEY_ALGORITHM)?;
        let (number, key) = rest.split_at_checked(NUMBER_BYTES)?;
        Some(Self {
            number: KeyNumber(number.try_into().ok()?),
            key: VerifyingKey::from_bytes(key.try_into().ok()?).ok()?,
        })
    }

    /// Returns whether a seal is valid for these bytes and this comment. A change of any byte makes
    /// it invalid.
    pub fn verifies(&self, bytes: &[u8], comment: &str, seal: &str) -> bool {
        self.check(bytes, comment, seal).is_some()
    }

    fn check(&self, bytes: &[u8], comment: &str, seal: &str) -> Option<()> {
        let rest = seal.strip_prefix(SEAL_COMMENT)?.strip_prefix('\n')?;
        let (first, rest) = rest.split_once('\n')?;
        let (trusted, rest) = rest.split_once('\n')?;
        let second = rest.strip_suffix('\n')?;
        if trusted.strip_prefix(TRUSTED_COMMENT)? != comment {
            return None;
        }
        let first = Base64::decode_vec(first).ok()?;
        let first = first.strip_prefix(&HASHED_ALGORITHM)?;
        let signature = first.strip_prefix(&self.number.0)?;
        let hash = Blake2b512::digest(bytes);
        self.verify_signature(&hash, signature)?;
        let covered = [signature, comment.as_bytes()].concat();
        self.verify_signature(&covered, &Base64::decode_vec(second).ok()?)
    }

    fn verify_signature(&self, covered: &[u8], signature: &[u8]) -> Option<()> {
        let bytes: [u8; SIGNATURE_BYTES] = signature.try_into().ok()?;
        let signature = Signature::from_bytes(&bytes);
        self.key.verify_strict(covered, &signature).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> SealKey {
        SealKey::from_random(&[7; 32], [1, 2, 3, 4, 5, 6, 7, 8])
    }

    #[test]
    fn a_key_survives_its_file_and_a_damaged_one_is_refused() {
        let text = key().to_text();
        let read = SealKey::from_text(&text).expect("a key");
        assert_eq!(read.public_key(), key().public_key());
        assert_eq!(read.number().to_string(), "0807060504030201");
        let damaged = text.replacen("RWQ", "RWR", 1);
        assert!(damaged == text || SealKey::from_text(&damaged).is_none());
        assert!(SealKey::from_text("untrusted comment: x\nAAAA\n").is_none());
        let line = key().public_key().to_line();
        assert_eq!(SealPublicKey::from_line(&line), Some(key().public_key()));
    }

    #[test]
    fn a_seal_covers_every_byte() {
        let (bytes, comment) = (b"points: 10".as_slice(), "01-reference");
        let seal = key().seal(bytes, comment);
        let public = key().public_key();
        assert!(public.verifies(bytes, comment, &seal));
        assert!(!public.verifies(b"points: 11", comment, &seal));
        assert!(!public.verifies(bytes, "02-spindle", &seal));
        let other = SealKey::from_random(&[8; 32], [1, 2, 3, 4, 5, 6, 7, 8]);
        assert!(!other.public_key().verifies(bytes, comment, &seal));
        for index in 0..seal.len() {
            let mut altered = seal.clone().into_bytes();
            altered[index] ^= 1;
            let altered = String::from_utf8(altered).expect("ASCII");
            assert!(!public.verifies(bytes, comment, &altered), "byte {index}");
        }
    }
}
