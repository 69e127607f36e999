//! The fuzz targets' properties hold of their seeds and of what fuzzing once found.
//!
//! `docs/fuzzing.md` tells how to fuzz. What breaks a property is a panic in the target.

#![expect(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

#[path = "../fuzz/src/targets.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    clippy::expect_used,
    clippy::indexing_slicing,
    reason = "shared with the fuzz targets"
)]
mod targets;

use std::fs;
use std::path::{Path, PathBuf};

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

#[test]
fn every_seed_and_every_regression_passes_its_target() {
    for (name, target) in targets::TARGETS {
        let seeds = files(&targets::seeds_of(name));
        assert!(!seeds.is_empty(), "{name} has no seeds");
        for file in seeds {
            target(&fs::read(&file).unwrap());
        }
    }
    for folder in files(Path::new("fuzz/regressions")) {
        let known = targets::TARGETS.iter().find(|(name, _)| folder.ends_with(name));
        let (_, target) = known.unwrap_or_else(|| panic!("{}: no such target", folder.display()));
        for file in files(&folder) {
            target(&fs::read(&file).unwrap());
        }
    }
}

/// Without this a seed that is refused at once would go unnoticed.
#[test]
fn the_seeds_reach_what_lies_behind_the_format() {
    let seed = |target: &str, name: &str| fs::read(targets::seeds_of(target).join(name)).unwrap();
    for bytes in
        [seed("trace", "bare.mcap"), seed("trace", "room.mcap"), targets::packed(&seed("messages", "room"))]
    {
        let recording = selfneg::trace::Recording::read(&bytes).unwrap();
        assert!(recording.is_complete(), "{:?}", recording.damage);
        assert!(recording.decisions() >= 2);
        assert_eq!(recording.replay().unwrap().difference, None);
    }
    for name in ["room.mcap", "bare.mcap"] {
        let found = selfneg::audit::audit(&seed("sealed", name), &targets::keys());
        assert_eq!((found.status, found.findings), (selfneg::audit::Status::Ok, Vec::new()), "{name}");
    }
    for name in ["room", "every-key"] {
        assert!(targets::parsed(&seed("scenario", name)).is_some(), "{name}");
    }
    assert_eq!(targets::room().unwrap().places().count(), 3);
}

/// A cargo-fuzz target is a function and a file; neither without the other.
#[test]
fn every_target_has_its_file_and_its_entry() {
    let manifest = fs::read_to_string("fuzz/Cargo.toml").unwrap();
    let mut expected: Vec<_> = targets::TARGETS.iter().map(|(name, _)| format!("{name}.rs")).collect();
    expected.sort();
    let found: Vec<_> = files(Path::new("fuzz/fuzz_targets"))
        .iter()
        .map(|file| file.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(found, expected);
    for (name, _) in targets::TARGETS {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
    }
}
