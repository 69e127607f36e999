//! The quantities in which the statements are written, summed naively from the users'
//! data and without the engine: ethical impact, depth of acceptance, welfare.
//!
//! Totals are exact in `u64`: at most 65,535 conditions with at most 65,535 dispositions
//! each, mentioned at most 255 times with a rank of at most 255, stay below 2^48.

use selfneg_core::{Activation, Aggregation, Condition, Disposition, MAX_ITEMS, Options, Side};

use crate::case::{OpenCase, OpenUser};

/// No total of ranks can be as large as this.
pub const TOTAL_BOUND: u64 = 1 << 48;

/// The ethical impact of all conditions of `sender` with its goal, in `eyes`: for each
/// disposition, its rank as often as the aggregation counts it.
#[must_use]
pub fn complete_impact(
    activation: Activation<'_>,
    aggregation: Aggregation,
    eyes: &OpenUser<'_>,
    sender: &OpenUser<'_>,
) -> u64 {
    let mut total = 0_u64;
    let mut d = 0_u16;
    while let (Some(rank), true) = (eyes.ranks().get(usize::from(d)), usize::from(d) < MAX_ITEMS) {
        let mentions = match sender.goal().get(usize::from(d)) {
            Some(&mentions) => u64::from(mentions),
            None => 0,
        };
        let each = match aggregation {
            Aggregation::PerCondition => u64::from(rank.0).saturating_mul(mentions),
            Aggregation::PerDisposition if mentions > 0 => u64::from(rank.0),
            Aggregation::PerDisposition => 0,
        };
        let mut c = 0;
        while let Some(&condition) = sender.conditions().get(c) {
            if activates(activation, condition, Disposition(d)) {
                total = total.saturating_add(each);
                if aggregation == Aggregation::PerDisposition {
                    break;
                }
            }
            c += 1;
        }
        d = d.saturating_add(1);
    }
    total
}

/// What the condition at `index` of `sender` adds, in `eyes`, to the ones before it.
#[must_use]
pub fn marginal_impact(
    activation: Activation<'_>,
    aggregation: Aggregation,
    eyes: &OpenUser<'_>,
    sender: &OpenUser<'_>,
    index: usize,
) -> u64 {
    let Some(&condition) = sender.conditions().get(index) else { return 0 };
    let row = activation.of(condition);
    let mut total = 0_u64;
    let mut i = 0;
    while let Some(&disposition) = row.get(i) {
        let d = usize::from(disposition.0);
        if let (Some(rank), Some(&mentions)) = (eyes.ranks().get(d), sender.goal().get(d)) {
            let each = u64::from(rank.0);
            total = total.saturating_add(match aggregation {
                Aggregation::PerCondition => each.saturating_mul(u64::from(mentions)),
                Aggregation::PerDisposition if mentions == 0 => 0,
                Aggregation::PerDisposition => {
                    match first_activated_by(activation, sender, disposition, index) == index {
                        true => each,
                        false => 0,
                    }
                }
            });
        }
        i += 1;
    }
    total
}

/// The index of the first condition of `sender` that activates `disposition`; `limit` if
/// none before `limit` does.
fn first_activated_by(
    activation: Activation<'_>,
    sender: &OpenUser<'_>,
    disposition: Disposition,
    limit: usize,
) -> usize {
    let mut c = 0;
    while c < limit {
        match sender.conditions().get(c) {
            Some(&condition) if activates(activation, condition, disposition) => return c,
            Some(_) => c += 1,
            None => return limit,
        }
    }
    limit
}

fn activates(activation: Activation<'_>, condition: Condition, disposition: Disposition) -> bool {
    let row = activation.of(condition);
    let mut i = 0;
    while let Some(&d) = row.get(i) {
        if d.0 == disposition.0 {
            return true;
        }
        i += 1;
    }
    false
}

/// What an offer must exceed in the eyes of the user on `side`: the ethical impact of its
/// own complete offer, the current user's willingness included.
#[must_use]
pub fn threshold(case: &OpenCase<'_>, options: &Options, side: Side) -> u64 {
    let user = case.user(side);
    let own = complete_impact(case.activation, options.aggregation, user, user);
    match side {
        Side::Current => own.saturating_add(u64::from(options.willingness)),
        Side::Interrupting => own,
    }
}

/// How many offers the user on `side` has: its true conditions, and the current user's
/// willingness.
#[must_use]
pub fn offers(case: &OpenCase<'_>, options: &Options, side: Side) -> usize {
    let conditions = case.user(side).conditions().len();
    match side {
        Side::Current if options.willingness > 0 => conditions.saturating_add(1),
        Side::Current | Side::Interrupting => conditions,
    }
}

/// An offer that the receiver would accept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acceptance {
    /// The least depth at which it would.
    pub depth: usize,
    /// By how much that offer exceeds the receiver's own complete offer.
    pub surplus: u64,
}

/// `k_X`: the least depth at which the other user accepts the offer of the user on `side`,
/// if there is one.
#[must_use]
pub fn acceptance(case: &OpenCase<'_>, options: &Options, side: Side) -> Option<Acceptance> {
    let sender = case.user(side);
    let receiver = case.user(side.other());
    let threshold = threshold(case, options, side.other());
    let mut value = 0_u64;
    let mut index = 0;
    while index < sender.conditions().len() {
        let more = marginal_impact(case.activation, options.aggregation, receiver, sender, index);
        value = value.saturating_add(more);
        index += 1;
        if value > threshold {
            return Some(Acceptance { depth: index, surplus: value.saturating_sub(threshold) });
        }
    }
    None
}

/// Whether each user would accept the other's complete offer.
#[must_use]
pub fn mutual_deference(case: &OpenCase<'_>, options: &Options) -> bool {
    acceptance(case, options, Side::Current).is_some()
        && acceptance(case, options, Side::Interrupting).is_some()
}

/// W: the ethical impact of the complete offer of the user on `side`, summed over both
/// users. The willingness does not count.
#[must_use]
pub fn welfare(case: &OpenCase<'_>, aggregation: Aggregation, side: Side) -> u64 {
    let served = case.user(side);
    complete_impact(case.activation, aggregation, &case.current, served).saturating_add(complete_impact(
        case.activation,
        aggregation,
        &case.interrupting,
        served,
    ))
}

/// Whether the profile of the user on `judge` puts the complete offer of the user on
/// `better` strictly above the other's. The willingness does not count.
#[must_use]
pub fn prefers(case: &OpenCase<'_>, aggregation: Aggregation, judge: Side, better: Side) -> bool {
    let eyes = case.user(judge);
    complete_impact(case.activation, aggregation, eyes, case.user(better))
        > complete_impact(case.activation, aggregation, eyes, case.user(better.other()))
}
