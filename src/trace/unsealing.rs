//! The clear copy of a sealed trace: everything viewable, nothing proved.

use std::collections::BTreeMap;
use std::io;

use prost::Message as _;

use super::copying::Copy;
use super::error::TraceError;
use super::format::{FORMAT_KEY, FORMAT_RECORD, UNSEALED_RECORD};
use super::opening::{Decrypted, Opened, PersonalPart, decrypt, merge};
use super::recording::{Recording, decoded};
use super::scan::Scan;
use super::schema::Schema;
use super::schema::evidence::{End, Header, Privacy};
use crate::seal::AuditorKey;
use crate::seal::verification::{SealState, head, verify};

/// Why there is no clear copy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UnsealError {
    /// It cannot be read.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// There is nothing to unseal.
    #[error("it is not sealed: {0}")]
    NotSealed(&'static str),
    /// The keys are others'.
    #[error("none of the keys given opens it; it is sealed to {0}")]
    Locked(String),
    /// The copy cannot be made.
    #[error("the copy cannot be made: {0}")]
    Copy(#[from] io::Error),
}

/// A clear copy, and what it is a copy of.
#[derive(Clone, Debug)]
pub struct Unsealed {
    /// The copy: a plain trace.
    pub bytes: Vec<u8>,
    /// The sealed trace.
    pub opened: Opened,
}

/// Makes a clear copy of a whole file in memory: a plain trace with everything that could be
/// decrypted, in the order in which it was written. Of a damaged one everything before the
/// damage is in it.
///
/// # Errors
/// [`UnsealError`].
pub fn unseal(bytes: &[u8], identities: &[AuditorKey]) -> Result<Unsealed, UnsealError> {
    let scan = Scan::of(bytes);
    let decrypted = decrypt(&scan, identities)?;
    match decrypted.privacy {
        PersonalPart::Plain => return Err(UnsealError::NotSealed("what is personal is in the open")),
        PersonalPart::LeftOut => return Err(UnsealError::NotSealed("what is personal was left out of it")),
        PersonalPart::Locked => return Err(UnsealError::Locked(recipients(&scan))),
        PersonalPart::Open => {}
    }
    let merged = merge(&scan, &decrypted.messages);
    let recording = Recording::of(&scan, merged.iter().copied())?;
    let mut copy = Copy::begin()?;
    let format = scan.format.clone().unwrap_or_default();
    copy.note(FORMAT_RECORD, BTreeMap::from([(FORMAT_KEY.to_owned(), format)]))?;
    let seal = verify(&scan);
    copy.note(UNSEALED_RECORD, origin(&scan, &seal, &decrypted.erased))?;
    let mut sequence = 0_u32;
    for message in merged {
        let data = match Schema::of_name(&message.schema) {
            Some(Schema::Sealed) => continue,
            Some(Schema::Header) => {
                let header: Header = decoded(message)?;
                Header { privacy: Privacy::Plain.into(), ..header }.encode_to_vec()
            }
            Some(Schema::End) => {
                let end: End = decoded(message)?;
                End { messages: u64::from(sequence), ..end }.encode_to_vec()
            }
            _ => message.data.clone(),
        };
        copy.message(message, sequence, &data)?;
        sequence = sequence.checked_add(1).ok_or_else(|| io::Error::other("too many messages"))?;
    }
    let bytes = copy.finish()?;
    let Decrypted { privacy, segments, erased, unopened, .. } = decrypted;
    Ok(Unsealed { bytes, opened: Opened { recording, seal, privacy, segments, erased, unopened } })
}

fn recipients(scan: &Scan) -> String {
    let recipients = head(scan).map(|head| head.recipients).unwrap_or_default();
    let recipients: Vec<String> = recipients.iter().map(ToString::to_string).collect();
    if recipients.is_empty() { "nobody known".to_owned() } else { recipients.join(", ") }
}

/// What the copy says of its original.
fn origin(scan: &Scan, seal: &SealState, erased: &[String]) -> BTreeMap<String, String> {
    let trace = head(scan).map_or_else(String::new, |head| head.trace.to_string());
    let (robot, chain) = match seal {
        SealState::Signed(report) => (report.key.to_string(), report.chain.clone()),
        _ => (String::new(), String::new()),
    };
    let entries = [("trace", trace), ("robot", robot), ("chain", chain), ("erased", erased.join(" "))];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
