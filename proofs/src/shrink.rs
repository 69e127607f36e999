//! Makes a counterexample readable without making it say anything else: fewer conditions,
//! smaller ranks, and numbers without gaps.

use selfneg_core::{Condition, Disposition, Rank};

use crate::counterexample::{Counterexample, OwnedUser};
use crate::engine::Engine;
use crate::property::{Judgement, Property};

/// The counterexample made smaller as long as it still refutes `property`.
pub fn shrink<E: Engine>(property: Property, engine: &E, counterexample: Counterexample) -> Counterexample {
    let refutes = |candidate: &Counterexample| candidate.judge(property, engine) == Judgement::Fails;
    let mut best = counterexample;
    let mut improved = true;
    while improved {
        improved = false;
        for edit in edits(&best) {
            let candidate = edit.apply(&best);
            if candidate != best && refutes(&candidate) {
                best = candidate;
                improved = true;
            }
        }
    }
    let tidy = renumbered(&best);
    if refutes(&tidy) { tidy } else { best }
}

fn everyone(counterexample: &mut Counterexample) -> impl Iterator<Item = &mut OwnedUser> {
    counterexample.users.iter_mut().chain(counterexample.altered.as_mut().map(|altered| &mut altered.user))
}

/// One way to make a counterexample smaller.
enum Edit {
    /// A user has a condition no longer, in its altered version neither.
    Drop(Vec<(usize, Condition)>),
    /// A condition activates a disposition no longer.
    Detach(usize, Disposition),
    /// Ranks of one disposition become smaller, in all versions of the users at these
    /// places (the altered version comes after the users).
    Lower(Vec<usize>, usize, fn(u8) -> u8),
}

impl Edit {
    fn apply(&self, from: &Counterexample) -> Counterexample {
        let mut to = from.clone();
        match self {
            Self::Drop(which) => {
                for (index, condition) in which {
                    for user in to.users.iter_mut().skip(*index).take(1) {
                        user.conditions.retain(|other| other != condition);
                    }
                    if let Some(altered) = to.altered.as_mut().filter(|altered| altered.index == *index) {
                        altered.user.conditions.retain(|other| other != condition);
                    }
                }
            }
            Self::Detach(condition, disposition) => {
                if let Some(row) = to.activation.get_mut(*condition) {
                    row.retain(|other| other != disposition);
                }
            }
            Self::Lower(places, disposition, lower) => {
                for (place, user) in everyone(&mut to).enumerate() {
                    if let Some(rank) = user.ranks.get_mut(*disposition).filter(|_| places.contains(&place)) {
                        *rank = Rank(lower(rank.0));
                    }
                }
            }
        }
        to
    }
}

/// The ways to make `from` smaller, the largest steps first.
fn edits(from: &Counterexample) -> Vec<Edit> {
    let mut edits = Vec::new();
    let of = |index: usize| from.users.get(index).map_or(&[][..], |user| user.conditions.as_slice());
    let longest = from.users.iter().map(|user| user.conditions.len()).max().unwrap_or(0);
    for size in [longest / 2, longest / 4, 8, 2, 1] {
        for start in (0..longest).step_by(size.max(1)) {
            let chunk = |index: usize| {
                of(index)
                    .iter()
                    .skip(start)
                    .take(size)
                    .map(move |&condition| (index, condition))
                    .collect::<Vec<_>>()
            };
            // From both at once too: often only the difference of two depths matters.
            edits.push(Edit::Drop(chunk(0).into_iter().chain(chunk(1)).collect()));
            edits.push(Edit::Drop(chunk(0)));
            edits.push(Edit::Drop(chunk(1)));
        }
    }
    if longest <= 16 {
        for &condition in of(0) {
            edits.extend(of(1).iter().map(|&other| Edit::Drop(vec![(0, condition), (1, other)])));
        }
    }
    for (condition, row) in from.activation.iter().enumerate() {
        edits.extend(row.iter().map(|&disposition| Edit::Detach(condition, disposition)));
    }
    let versions = from.users.len() + usize::from(from.altered.is_some());
    let mut groups: Vec<Vec<usize>> = vec![(0..versions).collect()];
    groups.extend(from.altered.as_ref().map(|altered| vec![altered.index, from.users.len()]));
    groups.extend((0..versions).map(|version| vec![version]));
    let dispositions = from.users.iter().map(|user| user.ranks.len()).max().unwrap_or(0);
    for disposition in 0..dispositions {
        let lower: [fn(u8) -> u8; 4] =
            [|_| 0, |rank| rank.min(1), |rank| rank / 2, |rank| rank.saturating_sub(1)];
        for lower in lower {
            edits.extend(groups.iter().map(|group| Edit::Lower(group.clone(), disposition, lower)));
        }
    }
    edits
}

/// The same with only the conditions and dispositions that matter, numbered from 0.
fn renumbered(from: &Counterexample) -> Counterexample {
    let mut conditions: Vec<Condition> = Vec::new();
    for user in everyone(&mut from.clone()) {
        conditions.extend(
            user.conditions
                .iter()
                .filter(|condition| !conditions.contains(condition))
                .copied()
                .collect::<Vec<_>>(),
        );
    }
    conditions.sort();
    let row =
        |condition: &Condition| from.activation.get(usize::from(condition.0)).cloned().unwrap_or_default();
    let mut dispositions: Vec<Disposition> = conditions.iter().flat_map(row).collect();
    dispositions.sort();
    dispositions.dedup();
    let number = |place: usize| u16::try_from(place).unwrap_or(u16::MAX);
    let condition_number = |condition: &Condition| {
        Condition(number(conditions.iter().position(|other| other == condition).unwrap_or(usize::MAX)))
    };
    let disposition_number = |disposition: &Disposition| {
        Disposition(number(dispositions.iter().position(|other| other == disposition).unwrap_or(usize::MAX)))
    };
    let mut to = from.clone();
    to.activation =
        conditions.iter().map(|condition| row(condition).iter().map(disposition_number).collect()).collect();
    for user in everyone(&mut to) {
        user.conditions = user.conditions.iter().map(condition_number).collect();
        let rank = |d: &Disposition| user.ranks.get(usize::from(d.0)).copied().unwrap_or(Rank(0));
        let ranks = dispositions.iter().map(rank).collect();
        let mentions = |d: &Disposition| user.goal.get(usize::from(d.0)).copied().unwrap_or(0);
        let goal = dispositions.iter().map(mentions).collect();
        user.ranks = ranks;
        user.goal = goal;
    }
    to
}
