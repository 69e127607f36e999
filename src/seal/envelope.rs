//! Encryption to auditors: compress, pad, encrypt with age; and back.
//!
//! The content of an age file is one zstd frame and a skippable frame that pads it: what
//! `age -d -i KEY FILE | zstd -d` prints is what was sealed.

use std::io::{self, Read as _, Write as _};

use age::{Decryptor, Encryptor};
use zeroize::Zeroizing;

use super::keys::{AuditorKey, AuditorPublicKey};

/// Most bytes that an envelope may hold. Ours are written when they have about 256 KiB.
const MAX_BYTES: u64 = 16 << 20;

/// No envelope is shorter before its encryption.
const LEAST_BYTES: u64 = 512;

/// The first magic number of frames that zstd passes over, as the format has it.
const SKIPPABLE: [u8; 4] = [0x50, 0x2A, 0x4D, 0x18];

/// Why an envelope does not open.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvelopeError {
    /// It is not for these keys.
    #[error("no key fits")]
    NoKeyFits,
    /// It is no age file any more.
    #[error("it does not decrypt: {0}")]
    Broken(String),
    /// It decrypts to something else than was sealed.
    #[error("its content is not as sealed: {0}")]
    Content(String),
}

/// Encrypts to all recipients, each of whom alone can open it. Its length says little of the
/// content's (Padmé: at most about a ninth more).
///
/// # Errors
/// Without a recipient, of more than 16 MiB, which nobody would open, or what the system's
/// randomness fails with.
pub fn seal(content: &[u8], recipients: &[AuditorPublicKey]) -> io::Result<Vec<u8>> {
    if u64::try_from(content.len()).unwrap_or(u64::MAX) > MAX_BYTES {
        return Err(io::Error::other(format!("a segment of more than {MAX_BYTES} bytes")));
    }
    let encryptor = Encryptor::with_recipients(recipients.iter().map(|key| &key.0 as &dyn age::Recipient))
        .map_err(io::Error::other)?;
    let padded = packed(content)?;
    let mut sealed = Vec::new();
    let mut writer = encryptor.wrap_output(&mut sealed)?;
    writer.write_all(&padded)?;
    writer.finish()?;
    Ok(sealed)
}

/// Compressed and padded.
fn packed(content: &[u8]) -> io::Result<Zeroizing<Vec<u8>>> {
    let mut packed = Zeroizing::new(zstd::stream::encode_all(content, 0)?);
    pad(&mut packed)?;
    Ok(packed)
}

/// What was sealed.
///
/// # Errors
/// [`EnvelopeError`].
pub fn open(sealed: &[u8], keys: &[AuditorKey]) -> Result<Zeroizing<Vec<u8>>, EnvelopeError> {
    let broken = |error: age::DecryptError| match error {
        age::DecryptError::NoMatchingKeys => EnvelopeError::NoKeyFits,
        error => EnvelopeError::Broken(error.to_string()),
    };
    let decryptor = Decryptor::new(sealed).map_err(broken)?;
    let mut reader =
        decryptor.decrypt(keys.iter().map(|key| &key.0 as &dyn age::Identity)).map_err(broken)?;
    let mut padded = Zeroizing::new(Vec::new());
    reader.read_to_end(&mut padded).map_err(|error| EnvelopeError::Broken(error.to_string()))?;
    let content = |error: io::Error| EnvelopeError::Content(error.to_string());
    let decoder = zstd::stream::read::Decoder::new(padded.as_slice()).map_err(content)?;
    let mut opened = Zeroizing::new(Vec::new());
    let read = decoder.take(MAX_BYTES + 1).read_to_end(&mut opened).map_err(content)?;
    if u64::try_from(read).unwrap_or(u64::MAX) > MAX_BYTES {
        return Err(EnvelopeError::Content(format!("more than {MAX_BYTES} bytes")));
    }
    Ok(opened)
}

/// Appends a skippable frame, so that the whole has a length of Padmé.
fn pad(frame: &mut Zeroizing<Vec<u8>>) -> io::Result<()> {
    let length = u64::try_from(frame.len()).unwrap_or(u64::MAX);
    let header = u64::try_from(SKIPPABLE.len()).unwrap_or(4).saturating_mul(2);
    let with_header = length.saturating_add(header);
    let zeros = padded_length(with_header).saturating_sub(with_header);
    let size = u32::try_from(zeros).map_err(|_| io::Error::other("a segment of more than 4 GiB"))?;
    frame.extend(SKIPPABLE);
    frame.extend(size.to_le_bytes());
    frame.extend(std::iter::repeat_n(0, usize::try_from(zeros).map_err(io::Error::other)?));
    Ok(())
}

/// The least length of Padmé that is not shorter: of its binary digits, only as many as its
/// exponent has may differ from zero.
fn padded_length(length: u64) -> u64 {
    let length = length.max(LEAST_BYTES);
    let exponent = length.ilog2();
    let free = exponent.saturating_sub(exponent.max(1).ilog2().saturating_add(1));
    let mask = (1_u64 << free).wrapping_sub(1);
    length.saturating_add(mask) & !mask
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

        #[test]
        fn padding_is_short_and_leaves_few_lengths(length in 0_u64..1 << 40) {
            let padded = padded_length(length);
            prop_assert!(padded >= length.max(LEAST_BYTES));
            prop_assert!(padded - length.max(LEAST_BYTES) <= length.max(LEAST_BYTES) * 12 / 100);
            prop_assert_eq!(padded_length(padded), padded);
        }

        #[test]
        fn what_is_sealed_opens(content in prop::collection::vec(any::<u8>(), 0..3_000)) {
            let key = AuditorKey::generate();
            let sealed = seal(&content, &[key.public()]).unwrap();
            let opened = open(&sealed, &[key]).unwrap();
            prop_assert_eq!(opened.as_slice(), content);
        }
    }

    #[test]
    fn each_of_two_recipients_opens_and_a_third_does_not() {
        let keys = [AuditorKey::generate(), AuditorKey::generate()];
        let sealed = seal(b"content", &[keys[0].public(), keys[1].public()]).unwrap();
        for key in keys {
            assert_eq!(open(&sealed, &[AuditorKey::generate(), key]).unwrap().as_slice(), b"content");
        }
        assert_eq!(open(&sealed, &[AuditorKey::generate()]), Err(EnvelopeError::NoKeyFits));
        assert_eq!(open(&sealed, &[]), Err(EnvelopeError::NoKeyFits));
        assert!(seal(b"content", &[]).is_err());
    }

    #[test]
    fn what_is_too_much_is_neither_sealed_nor_opened() {
        let key = AuditorKey::generate();
        let most = usize::try_from(MAX_BYTES).unwrap();
        let sealed = seal(&vec![0; most], &[key.public()]).unwrap();
        assert_eq!(open(&sealed, std::slice::from_ref(&key)).unwrap().len(), most);
        assert!(seal(&vec![0; most + 1], &[key.public()]).is_err());
        let padded = packed(&vec![0; most + 1]).unwrap();
        let recipient = key.public();
        let encryptor =
            Encryptor::with_recipients(std::iter::once(&recipient.0 as &dyn age::Recipient)).unwrap();
        let mut forged = Vec::new();
        let mut writer = encryptor.wrap_output(&mut forged).unwrap();
        writer.write_all(&padded).unwrap();
        writer.finish().unwrap();
        let opened = open(&forged, &[key]).map(|content| content.len());
        assert_eq!(opened, Err(EnvelopeError::Content("more than 16777216 bytes".to_owned())));
    }

    /// age adds a few bytes at random on top.
    #[test]
    fn equal_lengths_say_nothing_of_short_contents() {
        for content in [&b""[..], b"yes", b"a much longer answer than yes"] {
            assert_eq!(packed(content).unwrap().len(), 512);
        }
    }

    #[test]
    fn every_flipped_byte_is_an_error() {
        let key = [AuditorKey::generate()];
        let sealed = seal(b"content", &[key[0].public()]).unwrap();
        for at in 0..sealed.len() {
            let mut flipped = sealed.clone();
            flipped[at] ^= 1;
            assert!(open(&flipped, &key).is_err(), "byte {at}");
        }
    }
}
