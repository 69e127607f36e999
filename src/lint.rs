//! What is legal in rules and users but surely not meant.

use std::collections::{BTreeSet, HashSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::binding::END_OF_GOAL;
use crate::input::{Rules, Truth, User};

/// The paper's scale of ranks.
const SCALE: std::ops::RangeInclusive<u8> = 1..=5;

/// One thing to look at.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The file it is in.
    pub file: PathBuf,
    /// What kind of thing it is.
    pub kind: Kind,
    /// The names concerned, in the file's order.
    pub names: Vec<String>,
}

/// The kinds of finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Conditions of a status that no rule activates.
    ConditionNotActivated,
    /// Dispositions that some goal implies and nothing activates.
    DispositionNotActivated,
    /// Dispositions that some condition activates and no goal implies.
    DispositionNotImplied,
    /// A disposition that one list names more than once.
    DispositionRepeated,
    /// Dispositions of the rules that a profile does not rank: they count 0.
    DispositionNotRanked,
    /// Ranks for dispositions that no rule names: they count nothing.
    RankWithoutRule,
    /// A profile in which every disposition has the same rank.
    RanksAllEqual,
    /// Ranks outside 1..=5.
    RankOutsideScale,
    /// A user's own goal that the rules do not list.
    GoalNotListed,
    /// A status without any true condition: the user has no offer, or only its willingness.
    NothingToOffer,
}

impl Kind {
    const fn sentence(self) -> &'static str {
        match self {
            Self::ConditionNotActivated => "conditions that no rule activates, disclosed without effect",
            Self::DispositionNotActivated => "dispositions that no condition activates",
            Self::DispositionNotImplied => "dispositions that no goal implies",
            Self::DispositionRepeated => {
                "lists that name a disposition twice (under a goal it then counts twice per condition)"
            }
            Self::DispositionNotRanked => "dispositions missing from the profile, which count 0",
            Self::RankWithoutRule => "ranks for dispositions that no rule names, which count nothing",
            Self::RanksAllEqual => "all ranks are equal, so the profile prefers nothing",
            Self::RankOutsideScale => "ranks outside the paper's scale 1..=5",
            Self::GoalNotListed => "a goal that the rules do not list",
            Self::NothingToOffer => {
                "no condition is true, so this user quits without an offer (being close to its goal aside)"
            }
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.kind.sentence())?;
        if !self.names.is_empty() {
            write!(f, ": {}", shortened(&self.names))?;
        }
        Ok(())
    }
}

/// The names, or the first and last of many.
#[must_use]
pub fn shortened(names: &[String]) -> String {
    match names {
        [first, second, .., last] if names.len() > 8 => {
            format!("{first}, {second}, ... {last} ({} in all)", names.len())
        }
        _ => names.join(", "),
    }
}

/// What stands out in the rules.
#[must_use]
pub fn lint_rules(rules: &Rules) -> Vec<Finding> {
    let activated: HashSet<&str> = names_of(&rules.activation).collect();
    let implied: HashSet<&str> = names_of(&rules.implications).collect();
    let unique = |names: &mut dyn Iterator<Item = &str>| -> Vec<String> {
        let mut seen = HashSet::new();
        names.filter(|name| seen.insert(name.to_string())).map(str::to_owned).collect()
    };
    let mut findings = Findings::default();
    findings.note(
        &rules.implications_file,
        Kind::DispositionNotActivated,
        unique(&mut names_of(&rules.implications).filter(|name| !activated.contains(name))),
    );
    findings.note(
        &rules.activation_file,
        Kind::DispositionNotImplied,
        unique(&mut names_of(&rules.activation).filter(|name| !implied.contains(name))),
    );
    findings.note(&rules.activation_file, Kind::DispositionRepeated, repeated(&rules.activation));
    findings.note(&rules.implications_file, Kind::DispositionRepeated, repeated(&rules.implications));
    findings.0
}

/// What stands out in one user under these rules. `own_goal` says whether the user's own
/// goal counts, or another one was given in its place.
#[must_use]
pub fn lint_user(rules: &Rules, user: &User, own_goal: bool) -> Vec<Finding> {
    let activating: HashSet<&str> = rules
        .activation
        .iter()
        .filter(|(_, activated)| !activated.is_empty())
        .map(|(name, _)| name.as_str())
        .collect();
    let named: BTreeSet<&str> = names_of(&rules.activation).chain(names_of(&rules.implications)).collect();
    let ranked: HashSet<&str> = user.profile.iter().map(|(name, _)| name.as_str()).collect();
    let mut findings = Findings::default();
    findings.note(
        &user.files.status,
        Kind::ConditionNotActivated,
        user.status
            .iter()
            .filter(|(_, truth)| *truth != Truth::Withheld)
            .map(|(name, _)| name.as_str())
            .filter(|name| !activating.contains(name) && *name != END_OF_GOAL)
            .map(str::to_owned)
            .collect(),
    );
    if user.true_conditions().all(|name| name == END_OF_GOAL && !activating.contains(name)) {
        findings.0.push(Finding {
            file: user.files.status.clone(),
            kind: Kind::NothingToOffer,
            names: vec![],
        });
    }
    findings.note(
        &user.files.profiles,
        Kind::DispositionNotRanked,
        named.iter().filter(|name| !ranked.contains(*name)).map(|&name| name.to_owned()).collect(),
    );
    findings.note(
        &user.files.profiles,
        Kind::RankWithoutRule,
        user.profile
            .iter()
            .map(|(name, _)| name)
            .filter(|name| !named.contains(name.as_str()))
            .cloned()
            .collect(),
    );
    findings.note(
        &user.files.profiles,
        Kind::RankOutsideScale,
        user.profile
            .iter()
            .filter(|(_, rank)| !SCALE.contains(&rank.0))
            .map(|(name, rank)| format!("{name} = {}", rank.0))
            .collect(),
    );
    if let [(_, first), rest @ ..] = user.profile.as_slice()
        && !rest.is_empty()
        && rest.iter().all(|(_, rank)| rank == first)
    {
        findings.note(&user.files.profiles, Kind::RanksAllEqual, vec![first.0.to_string()]);
    }
    let listed = |goal: &String| rules.implications.iter().any(|(name, _)| name == goal);
    findings.note(
        &user.files.goal,
        Kind::GoalNotListed,
        user.goal.iter().filter(|goal| own_goal && !listed(goal)).cloned().collect(),
    );
    findings.0
}

#[derive(Default)]
struct Findings(Vec<Finding>);

impl Findings {
    fn note(&mut self, file: &Path, kind: Kind, names: Vec<String>) {
        if !names.is_empty() {
            self.0.push(Finding { file: file.to_owned(), kind, names });
        }
    }
}

fn names_of(lists: &[(String, Vec<String>)]) -> impl Iterator<Item = &str> {
    lists.iter().flat_map(|(_, names)| names).map(String::as_str)
}

/// `key: disposition` for every disposition that a key's list repeats.
fn repeated(lists: &[(String, Vec<String>)]) -> Vec<String> {
    let mut found = Vec::new();
    for (key, names) in lists {
        let mut seen = HashSet::new();
        for name in names {
            if !seen.insert(name) {
                found.push(format!("{key}: {name}"));
            }
        }
    }
    found
}
