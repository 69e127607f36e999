//! Seals: who may read what is personal of a trace, and how a change is seen.
//!
//! A sealed trace is signed by the robot's key and encrypted to the auditors' keys. Everything
//! here is a function of bytes and keys; files are read and written by the commands, and
//! randomness comes in as [`Random`]. `docs/seal.md` says what a seal proves and what not.
//!
//! ```
//! use selfneg::demo;
//! use selfneg::run::run;
//! use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal, SealState};
//! use selfneg::trace::{TraceWriter, open};
//!
//! let mut random = |bytes: &mut [u8]| getrandom::fill(bytes).map_err(std::io::Error::other);
//! let (robot, auditor) = (RobotKey::generate(&mut random)?, AuditorKey::generate());
//! let robot_pub = robot.public();
//!
//! // On the robot.
//! let privacy = Privacy::Sealed(vec![auditor.public()]);
//! let seal = Seal { privacy, signer: Some(robot), random: Box::new(random) };
//! let mut writer = TraceWriter::create(Vec::new(), seal)?;
//! run(&demo::scenario()?, &mut [&mut writer])?;
//! let bytes = writer.into_inner().unwrap_or_default();
//!
//! // At the auditor's.
//! let opened = open(&bytes, &[auditor])?;
//! let SealState::Signed(report) = opened.seal else { panic!("it is not signed") };
//! assert_eq!(report.key, robot_pub);
//! assert!(report.complete && report.faults.is_empty());
//! assert!(opened.recording.replay()?.difference.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod chain;
pub mod checkpoint;
pub mod commitment;
pub mod envelope;
pub mod keys;
mod random;
pub mod verification;

pub use keys::{AuditorKey, AuditorPublicKey, KeyError, RobotKey, RobotPublicKey};
pub use random::Random;
pub use verification::{SealFault, SealPlace, SealReport, SealState};

use keys::hex;

/// Who may read what is personal of a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Privacy {
    /// Everybody who has the trace: for fictional data.
    Plain,
    /// Nobody: it is not written.
    LeftOut,
    /// These auditors, each with its own key.
    Sealed(Vec<AuditorPublicKey>),
}

/// What a trace's seal is made with.
pub struct Seal {
    /// Who may read what is personal.
    pub privacy: Privacy,
    /// Who signs, if anybody.
    pub signer: Option<RobotKey>,
    /// For the trace's identity and the commitments' salts. Not used by a trace that is
    /// neither signed nor sealed.
    pub random: Box<dyn Random>,
}

impl std::fmt::Debug for Seal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Seal")
            .field("privacy", &self.privacy)
            .field("signer", &self.signer)
            .finish_non_exhaustive()
    }
}

/// What tells one trace from all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceId(pub [u8; 32]);

impl std::fmt::Display for TraceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&hex(&self.0))
    }
}
