//! Findings of many files, said once each.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use crate::lint::{Finding, Kind};

/// A kind of finding with more different lists of names than this is told by one example.
const TOLD_APART: usize = 4;

/// One line for each kind of finding and each list of names, with the number of files.
pub(super) fn summarised(findings: &[Finding]) -> Vec<String> {
    let mut kinds: BTreeMap<Kind, BTreeMap<&[String], BTreeSet<&PathBuf>>> = BTreeMap::new();
    for finding in findings {
        kinds.entry(finding.kind).or_default().entry(&finding.names).or_default().insert(&finding.file);
    }
    let mut lines = Vec::new();
    for (kind, by_names) in kinds {
        let files: BTreeSet<&&PathBuf> = by_names.values().flatten().collect();
        let told: Vec<_> = if by_names.len() <= TOLD_APART {
            by_names.iter().map(|(names, files)| (names, files.len())).collect()
        } else {
            by_names.iter().take(1).map(|(names, _)| (names, files.len())).collect()
        };
        for (names, count) in told {
            let Some(example) = by_names.get(*names).and_then(|files| files.first()) else { continue };
            let finding = Finding { file: (*example).clone(), kind, names: names.to_vec() };
            lines.push(match count {
                1 => finding.to_string(),
                2 => format!("{finding} (and likewise in another file)"),
                _ => format!("{finding} (and likewise in {} other files)", count.saturating_sub(1)),
            });
        }
    }
    lines
}
