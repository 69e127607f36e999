//! Erases what is personal of one person, and leaves the seal of the rest as it is.

use std::collections::BTreeSet;
use std::io;

use prost::Message as _;

use super::copying::Copy;
use super::error::TraceError;
use super::recording::decoded;
use super::scan::Scan;
use super::schema::Schema;
use super::schema::evidence::{Privacy, Sealed};
use super::topic::Whose;

/// Why nothing is erased.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EraseError {
    /// It cannot be read.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// What is behind the damage would be lost.
    #[error("damaged, and erasing would lose what is behind the damage: {0}")]
    Damaged(TraceError),
    /// What no writer writes would be lost.
    #[error("at byte {at} it holds {what}, which no trace does and erasing would lose")]
    Added {
        /// Where.
        at: u64,
        /// What.
        what: String,
    },
    /// There is nothing apart that could be erased.
    #[error("it is not sealed, so nobody's data can be erased from it: {0}")]
    NotSealed(&'static str),
    /// There is no such person.
    #[error("{person}: nobody's data here are under this name, expected one of {}", known.join(", "))]
    Unknown {
        /// Who was asked for.
        person: String,
        /// Who is there.
        known: Vec<String>,
    },
    /// The file cannot be written anew.
    #[error("it cannot be written anew: {0}")]
    Copy(#[from] io::Error),
}

/// A trace without somebody's data.
#[derive(Clone, Debug)]
pub struct Erased {
    /// The trace.
    pub bytes: Vec<u8>,
    /// How many segments about that person alone lost their content now.
    pub own: u64,
    /// How many about several people, that person perhaps among them.
    pub several: u64,
}

/// Takes the content out of all segments about a subject (`user-2`, `bystander-1`), and out of
/// those about several people. Digests, signatures and everything else stay as they are. Of a
/// trace that was cut, what is intact is kept.
///
/// # Errors
/// [`EraseError`].
pub fn erase(bytes: &[u8], person: &str) -> Result<Erased, EraseError> {
    let scan = Scan::of(bytes);
    match scan.header()?.privacy() {
        Privacy::Unspecified | Privacy::Plain => {
            return Err(EraseError::NotSealed("what is personal is in the open"));
        }
        Privacy::LeftOut => return Err(EraseError::NotSealed("what is personal was left out of it")),
        Privacy::Sealed => {}
    }
    match &scan.damage {
        None | Some(TraceError::Truncated { .. }) => {}
        Some(damage) => return Err(EraseError::Damaged(damage.clone())),
    }
    if let Some(added) = scan.added.first() {
        return Err(EraseError::Added { at: added.at, what: added.what.clone() });
    }
    let known = people(&scan)?;
    if !known.contains(person) {
        let known = known.into_iter().collect();
        return Err(EraseError::Unknown { person: person.to_owned(), known });
    }
    let mut notes = scan.notes.iter().peekable();
    let mut copy = Copy::begin()?;
    let (mut own, mut several) = (0_u64, 0_u64);
    for (place, message) in (0..).zip(&scan.messages) {
        while let Some(note) = notes.next_if(|note| note.messages <= place) {
            copy.note(&note.name, note.entries.clone())?;
        }
        let mut data = message.data.clone();
        if *message.schema == *Schema::Sealed.name() {
            let sealed: Sealed = decoded(message)?;
            let count = match sealed.subject.as_str() {
                subject if subject == person => Some(&mut own),
                subject if subject == Whose::Several.to_string() => Some(&mut several),
                _ => None,
            };
            if let Some(count) = count {
                *count = count.saturating_add(u64::from(sealed.ciphertext.is_some()));
                data = Sealed { ciphertext: None, ..sealed }.encode_to_vec();
            }
        }
        copy.message(message, message.sequence, &data)?;
    }
    for note in notes {
        copy.note(&note.name, note.entries.clone())?;
    }
    Ok(Erased { bytes: copy.finish()?, own, several })
}

/// Who has segments of their own.
fn people(scan: &Scan) -> Result<BTreeSet<String>, TraceError> {
    let mut people = BTreeSet::new();
    for message in scan.messages.iter().filter(|message| *message.schema == *Schema::Sealed.name()) {
        people.insert(decoded::<Sealed>(message)?.subject);
    }
    people.remove(&Whose::Everyone.to_string());
    people.remove(&Whose::Several.to_string());
    Ok(people)
}
