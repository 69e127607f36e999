//! The *utility function*. A user's utility of an offer, EI(offer) - EI(own complete
//! offer), is the engine's: [`Weighing::surplus`](selfneg_core::Weighing::surplus). Here is
//! the utility of all together, for the fallback `utilitarian`.

use selfneg_core::{Activation, User};
use selfneg_model::{most_welfare, welfare};

use super::super::specification::MissionRules;
use super::super::user_managers::UserManagers;
use super::engine::{EngineError, user};

/// Which of `candidates`, by their place among `participants`, is best served for the
/// welfare of all participants.
pub(super) fn best_served(
    candidates: &[usize],
    participants: &[&UserManagers],
    rules: &MissionRules,
) -> Result<Option<usize>, EngineError> {
    let rows = rules.bound().rows();
    let activation = Activation::new(&rows)?;
    let users: Vec<User<'_>> =
        participants.iter().map(|managers| user(managers, rules)).collect::<Result<_, _>>()?;
    let worth = |served: usize| {
        users.get(served).map_or_else(Default::default, |served| {
            welfare(served, &users, activation, rules.options.aggregation)
        })
    };
    Ok(most_welfare(candidates, worth))
}
