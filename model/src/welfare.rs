//! Utilitarian welfare among any number of users.

use selfneg_core::{Activation, Aggregation, Impact, User, impact_of_serving};

/// W of serving `served`: the sum over all `users` of the ethical impact of its complete
/// offer. The willingness to be interrupted does not count.
#[must_use]
pub fn welfare(
    served: &User<'_>,
    users: &[User<'_>],
    activation: Activation<'_>,
    aggregation: Aggregation,
) -> Impact {
    let sum = users
        .iter()
        .map(|user| impact_of_serving(served, user, activation, aggregation).0)
        .fold(0, u64::saturating_add);
    Impact(sum)
}

/// The first of `candidates` that no other candidate exceeds in `welfare`.
#[must_use]
pub fn most_welfare<F: Fn(usize) -> Impact>(candidates: &[usize], welfare: F) -> Option<usize> {
    candidates.iter().copied().reduce(|best, next| if welfare(next) > welfare(best) { next } else { best })
}
