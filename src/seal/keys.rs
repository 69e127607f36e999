//! The robot's key signs; an auditor's key opens what is personal.

use std::fmt;
use std::io;

use age::secrecy::ExposeSecret as _;
use ed25519_dalek::pkcs8::spki::der::pem::LineEnding;
use ed25519_dalek::pkcs8::{
    DecodePrivateKey as _, DecodePublicKey as _, EncodePrivateKey as _, EncodePublicKey as _, KeypairBytes,
};
use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use zeroize::Zeroizing;

use super::Random;

/// Why a text is no key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// No private key of a robot.
    #[error("not a robot's private key, expected an Ed25519 key as PKCS#8 PEM: {0}")]
    RobotKey(String),
    /// No public key of a robot.
    #[error("not a robot's public key, expected an Ed25519 key as SubjectPublicKeyInfo PEM: {0}")]
    RobotPublicKey(String),
    /// No private key of an auditor.
    #[error("line {line}: not an auditor's private key, expected AGE-SECRET-KEY-1...: {why}")]
    AuditorKey {
        /// Where, from 1.
        line: usize,
        /// Why not.
        why: &'static str,
    },
    /// No public key of an auditor.
    #[error("line {line}: not an auditor's public key, expected age1...: {why}")]
    AuditorPublicKey {
        /// Where, from 1.
        line: usize,
        /// Why not.
        why: &'static str,
    },
    /// Only comments.
    #[error("it holds no key, expected one a line")]
    Empty,
}

/// Signs a robot's traces: an Ed25519 key.
#[derive(Clone)]
pub struct RobotKey(SigningKey);

impl RobotKey {
    /// A new key.
    ///
    /// # Errors
    /// What the randomness fails with.
    pub fn generate(random: &mut dyn Random) -> io::Result<Self> {
        let mut seed = Zeroizing::new([0; 32]);
        random.fill(seed.as_mut_slice())?;
        Ok(Self(SigningKey::from_bytes(&seed)))
    }

    /// From PKCS#8 PEM, as OpenSSL writes it too.
    ///
    /// # Errors
    /// [`KeyError::RobotKey`].
    pub fn from_pem(text: &str) -> Result<Self, KeyError> {
        let key = SigningKey::from_pkcs8_pem(text).map_err(|error| KeyError::RobotKey(error.to_string()))?;
        Ok(Self(key))
    }

    /// As PKCS#8 PEM.
    ///
    /// # Errors
    /// [`KeyError::RobotKey`] if it cannot be encoded.
    pub fn to_pem(&self) -> Result<Zeroizing<String>, KeyError> {
        // Without the public key: OpenSSL does not read it with.
        let pair = KeypairBytes { secret_key: self.0.to_bytes(), public_key: None };
        pair.to_pkcs8_pem(LineEnding::LF).map_err(|error| KeyError::RobotKey(error.to_string()))
    }

    /// The key that others check signatures with.
    #[must_use]
    pub fn public(&self) -> RobotPublicKey {
        RobotPublicKey(self.0.verifying_key())
    }

    pub(crate) fn sign(&self, message: &[u8]) -> [u8; 64] {
        self.0.sign(message).to_bytes()
    }
}

impl fmt::Debug for RobotKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RobotKey(of {})", self.public())
    }
}

/// Checks what a robot signed. It is written as 64 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotPublicKey(VerifyingKey);

impl RobotPublicKey {
    /// From `SubjectPublicKeyInfo` PEM, as OpenSSL writes it too.
    ///
    /// # Errors
    /// [`KeyError::RobotPublicKey`].
    pub fn from_pem(text: &str) -> Result<Self, KeyError> {
        let key = VerifyingKey::from_public_key_pem(text);
        key.map(Self).map_err(|error| KeyError::RobotPublicKey(error.to_string()))
    }

    /// As `SubjectPublicKeyInfo` PEM.
    ///
    /// # Errors
    /// [`KeyError::RobotPublicKey`] if it cannot be encoded.
    pub fn to_pem(&self) -> Result<String, KeyError> {
        let text = self.0.to_public_key_pem(LineEnding::LF);
        text.map_err(|error| KeyError::RobotPublicKey(error.to_string()))
    }

    /// From 64 lower-case hexadecimal digits, as a trace names its key.
    #[must_use]
    pub fn from_hex(text: &str) -> Option<Self> {
        VerifyingKey::from_bytes(&from_hex(text)?).ok().map(Self)
    }

    /// Its 32 bytes.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8; 32] {
        self.0.as_bytes()
    }

    /// Whether the key's owner signed the message; strictly, so that no other message or key
    /// fits the same signature.
    #[must_use]
    pub fn has_signed(&self, message: &[u8], signature: &[u8; 64]) -> bool {
        self.0.verify_strict(message, &Signature::from_bytes(signature)).is_ok()
    }
}

impl fmt::Display for RobotPublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&hex(self.as_bytes()))
    }
}

/// Opens what is personal of the traces sealed to it: an age X25519 identity.
#[derive(Clone)]
pub struct AuditorKey(pub(super) age::x25519::Identity);

impl AuditorKey {
    /// A new key.
    #[must_use]
    pub fn generate() -> Self {
        Self(age::x25519::Identity::generate())
    }

    /// All keys of a file as age-keygen writes it: one a line, `#` begins a comment.
    ///
    /// # Errors
    /// [`KeyError`] if there is none, or a line is none.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, KeyError> {
        parse_lines(text, |line, key| key.parse().map(Self).map_err(|why| KeyError::AuditorKey { line, why }))
    }

    /// As age writes it, in one line.
    #[must_use]
    pub fn to_text(&self) -> Zeroizing<String> {
        Zeroizing::new(self.0.to_string().expose_secret().to_owned())
    }

    /// The key to seal to.
    #[must_use]
    pub fn public(&self) -> AuditorPublicKey {
        AuditorPublicKey(self.0.to_public())
    }
}

impl fmt::Debug for AuditorKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AuditorKey(of {})", self.public())
    }
}

/// Whom a trace is sealed to: an age X25519 recipient, written `age1...`.
#[derive(Clone, Debug)]
pub struct AuditorPublicKey(pub(super) age::x25519::Recipient);

impl AuditorPublicKey {
    /// All keys of a file: one a line, `#` begins a comment.
    ///
    /// # Errors
    /// [`KeyError`] if there is none, or a line is none.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, KeyError> {
        parse_lines(text, |line, key| {
            key.parse().map(Self).map_err(|why| KeyError::AuditorPublicKey { line, why })
        })
    }
}

impl PartialEq for AuditorPublicKey {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl Eq for AuditorPublicKey {}

impl fmt::Display for AuditorPublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

fn parse_lines<T>(
    text: &str,
    parse: impl Fn(usize, &str) -> Result<T, KeyError>,
) -> Result<Vec<T>, KeyError> {
    let lines = (1..).zip(text.lines().map(str::trim));
    let keys = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let keys = keys.map(|(number, line)| parse(number, line)).collect::<Result<Vec<_>, _>>()?;
    if keys.is_empty() { Err(KeyError::Empty) } else { Ok(keys) }
}

/// Lower-case hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The bytes that [`hex`] writes so, and no other spelling of them.
pub(crate) fn from_hex<const N: usize>(text: &str) -> Option<[u8; N]> {
    let digit = |digit: &u8| match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    };
    let mut bytes = [0; N];
    let pairs = text.as_bytes().chunks(2);
    if text.len() != N.saturating_mul(2) {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(pairs) {
        let [high, low] = pair else { return None };
        *byte = digit(high)? << 4 | digit(low)?;
    }
    Some(bytes)
}
