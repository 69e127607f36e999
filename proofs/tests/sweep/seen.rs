//! What can be seen of a pair: its size, and what the engine does with it.

use selfneg_core::{Case, Conclusion, Options, Outcome, Side};
use selfneg_proofs::sweep::{Pair, Person};

/// Conditions and ranks in total.
pub(crate) type Size = (usize, u32);

pub(crate) fn size(pair: &Pair) -> Size {
    size_of(&pair.current, &pair.interrupting)
}

pub(crate) fn size_of(current: &Person, interrupting: &Person) -> Size {
    let people = [current, interrupting];
    (
        people.iter().map(|person| person.conditions.len()).sum(),
        people.iter().flat_map(|person| &person.ranks).map(|rank| u32::from(rank.0)).sum(),
    )
}

/// What the engine does with a pair, as the roles are and swapped.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Seen {
    pub(crate) conclusions: [Conclusion; 2],
    pub(crate) regret: [u64; 2],
}

impl Seen {
    pub(crate) fn of(case: &Case<'_>, options: &Options) -> Self {
        let cases = [*case, case.swapped()];
        let decisions = cases.map(|case| case.decide(options, &mut ()));
        let regret = [0, 1].map(|role| {
            let welfare = cases[role].welfare(options);
            let most = welfare.current.0.max(welfare.interrupting.0);
            most - welfare.of_serving(decisions[role].served).0
        });
        Self { conclusions: decisions.map(|decision| decision.conclusion), regret }
    }

    pub(crate) fn role_dependent(&self) -> bool {
        let unchanged = matches!(
            self.conclusions.map(|conclusion| conclusion.outcome),
            [Outcome::NoAgreement, Outcome::NoAgreement]
                | [Outcome::Agreement(Side::Current), Outcome::Agreement(Side::Interrupting)]
                | [Outcome::Agreement(Side::Interrupting), Outcome::Agreement(Side::Current)]
        );
        !unchanged
    }
}
