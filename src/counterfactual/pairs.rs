//! Two changes at a time.

use super::{Counterfactual, Edit, Trial, additions, others, ranks, withholdings};
use crate::precedence::PrecedenceError;

/// No more pairs than this are tried: seconds, not minutes.
pub const MAX_PAIRS: u64 = 100_000;

/// What came of trying two changes at a time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pairs {
    /// A single change of somebody's data does it.
    NotNeeded,
    /// The first pair of the smallest sum that does it.
    Found(Counterfactual),
    /// None does: all of this number were tried.
    NoneOf {
        /// How many pairs there are.
        pairs: u64,
    },
    /// None of the smallest does; the others were not tried.
    NoneOfTheFirst {
        /// How many were tried.
        pairs: u64,
    },
}

impl Trial<'_> {
    /// Tries pairs of changes to two different things, those of the smallest sum of sizes
    /// first.
    pub(super) fn pairs(&mut self, at_most: u64) -> Result<Pairs, PrecedenceError> {
        let by_size = self.by_size();
        let largest = by_size.len();
        let mut tried = 0_u64;
        for sum in 2..=largest.saturating_mul(2) {
            for smaller in 1..=sum / 2 {
                let larger = sum.saturating_sub(smaller);
                let (Some(few), Some(many)) = (bucket(&by_size, smaller), bucket(&by_size, larger)) else {
                    continue;
                };
                for (nth, &first) in few.iter().enumerate() {
                    let skip = if smaller == larger { nth.saturating_add(1) } else { 0 };
                    for &second in many.iter().skip(skip).filter(|second| differ(first, **second)) {
                        if tried == at_most {
                            return Ok(Pairs::NoneOfTheFirst { pairs: tried });
                        }
                        tried = tried.saturating_add(1);
                        if let Some(found) = self.changed(&[first, second])? {
                            return Ok(Pairs::Found(found));
                        }
                    }
                }
            }
        }
        Ok(Pairs::NoneOf { pairs: tried })
    }

    /// The single changes of data by their size: entry 0 holds those of size 1.
    fn by_size(&self) -> Vec<Vec<Edit>> {
        let mut by_size: Vec<Vec<Edit>> = vec![Vec::new(); usize::from(self.scale)];
        let users = 0..self.question.users.len();
        let conditions = |user| withholdings(self.question, user).chain(additions(self.question, user));
        let all_ranks = |user| {
            ranks(self.question, user)
                .flat_map(move |(disposition, from)| others(user, disposition, from, self.scale))
        };
        let all = users.clone().flat_map(conditions).chain(users.flat_map(all_ranks));
        for edit in all {
            let at = usize::try_from(edit.size().saturating_sub(1)).unwrap_or(usize::MAX);
            if let Some(edits) = by_size.get_mut(at) {
                edits.push(edit);
            }
        }
        by_size
    }
}

fn bucket(by_size: &[Vec<Edit>], size: usize) -> Option<&[Edit]> {
    by_size.get(size.checked_sub(1)?).map(Vec::as_slice)
}

/// Whether they change different things.
fn differ(first: Edit, second: Edit) -> bool {
    match (first, second) {
        (
            Edit::Rank { user, disposition, .. },
            Edit::Rank { user: other_user, disposition: other_disposition, .. },
        ) => (user, disposition) != (other_user, other_disposition),
        _ => first != second,
    }
}
