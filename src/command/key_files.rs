//! Keys as files.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::slice;

use zeroize::Zeroizing;

use super::CommandError;
use super::private_file::{Readers, create_new};
use crate::input::InputError;
use crate::seal::{AuditorKey, AuditorPublicKey, KeyError, RobotKey, RobotPublicKey};

/// Most bytes that are read of a key file.
const MAX_BYTES: u64 = 1 << 16;

/// The robot's private key.
pub(super) fn robot_key(file: &Path) -> Result<RobotKey, CommandError> {
    parsed(file, RobotKey::from_pem)
}

/// The robot's public key.
pub(super) fn robot_public_key(file: &Path) -> Result<RobotPublicKey, CommandError> {
    parsed(file, RobotPublicKey::from_pem)
}

/// Auditors' private keys, of all files.
pub(super) fn auditor_keys(files: &[PathBuf]) -> Result<Vec<AuditorKey>, CommandError> {
    let keys = files.iter().map(|file| parsed(file, AuditorKey::parse_all));
    Ok(keys.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Auditors' public keys, of all files, each once.
pub(super) fn auditor_public_keys(files: &[PathBuf]) -> Result<Vec<AuditorPublicKey>, CommandError> {
    let mut keys: Vec<AuditorPublicKey> = Vec::new();
    for file in files {
        for key in parsed(file, AuditorPublicKey::parse_all)? {
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }
    Ok(keys)
}

fn parsed<T>(file: &Path, parse: impl Fn(&str) -> Result<T, KeyError>) -> Result<T, CommandError> {
    let mut text = Zeroizing::new(String::new());
    let read = File::open(file).and_then(|opened| opened.take(MAX_BYTES).read_to_string(&mut text));
    read.map_err(|source| InputError::Unreadable { file: file.to_owned(), source })?;
    parse(&text).map_err(|source| CommandError::Key { file: file.to_owned(), source })
}

/// Randomness of the system.
pub(super) fn random(bytes: &mut [u8]) -> io::Result<()> {
    getrandom::fill(bytes).map_err(io::Error::other)
}

/// The files of a pair of keys: the private one, and the public one.
pub(super) struct Pair {
    pub(super) private: (PathBuf, Zeroizing<String>),
    pub(super) public: (PathBuf, String),
}

/// A robot's keys as files.
pub(super) fn robot_pair(folder: &Path, key: &RobotKey) -> Result<Pair, CommandError> {
    let (private, public) = (folder.join("robot.key"), folder.join("robot.pub"));
    let unusable = |source| CommandError::Key { file: private.clone(), source };
    let texts = (key.to_pem().map_err(unusable)?, key.public().to_pem().map_err(unusable)?);
    Ok(Pair { private: (private, texts.0), public: (public, texts.1) })
}

/// An auditor's keys as files.
pub(super) fn auditor_pair(folder: &Path, key: &AuditorKey) -> Pair {
    let public = key.public();
    let private = Zeroizing::new(format!("# public key: {public}\n{}\n", key.to_text().as_str()));
    Pair {
        private: (folder.join("auditor.key"), private),
        public: (folder.join("auditor.pub"), format!("{public}\n")),
    }
}

/// Writes the pairs, all of them or none. What is there is an error, and stays.
pub(super) fn write_new(folder: &Path, pairs: &[Pair]) -> Result<(), CommandError> {
    let unwritable = |source| CommandError::Unwritable { file: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(unwritable)?;
    let mut written: Vec<&Path> = Vec::new();
    for Pair { private, public } in pairs {
        let files = [
            (&private.0, private.1.as_bytes(), Readers::Owner),
            (&public.0, public.1.as_bytes(), Readers::Anybody),
        ];
        for (file, text, readers) in files {
            if let Err(error) = create_new(file, text, readers) {
                for file in written {
                    let _ = fs::remove_file(file);
                }
                return Err(error);
            }
            written.push(file);
        }
    }
    Ok(())
}

/// The keys of a folder that makes its own: what is there is used, what is missing is made.
pub(super) fn of_folder(folder: &Path) -> Result<(RobotKey, AuditorPublicKey), CommandError> {
    let [robot, robot_pub, auditor, auditor_pub] =
        ["robot.key", "robot.pub", "auditor.key", "auditor.pub"].map(|name| folder.join(name));
    let differs = |file: &Path, key: &Path| {
        let what = format!("{}: it is not the public key of {}", file.display(), key.display());
        Err(CommandError::Arguments(what))
    };
    let signer = if robot.exists() {
        let key = robot_key(&robot)?;
        if !robot_pub.exists() {
            let pair = robot_pair(folder, &key)?;
            create_new(&robot_pub, pair.public.1.as_bytes(), Readers::Anybody)?;
        } else if robot_public_key(&robot_pub)? != key.public() {
            return differs(&robot_pub, &robot);
        }
        key
    } else {
        let key = RobotKey::generate(&mut random).map_err(CommandError::Recording)?;
        write_new(folder, &[robot_pair(folder, &key)?])?;
        key
    };
    let recipient = if auditor.exists() {
        let public = auditor_keys(slice::from_ref(&auditor))?.first().map(AuditorKey::public);
        let public =
            public.ok_or_else(|| CommandError::Key { file: auditor.clone(), source: KeyError::Empty })?;
        if !auditor_pub.exists() {
            create_new(&auditor_pub, format!("{public}\n").as_bytes(), Readers::Anybody)?;
        } else if !auditor_public_keys(slice::from_ref(&auditor_pub))?.contains(&public) {
            return differs(&auditor_pub, &auditor);
        }
        public
    } else {
        let key = AuditorKey::generate();
        write_new(folder, &[auditor_pair(folder, &key)])?;
        key.public()
    };
    Ok((signer, recipient))
}
