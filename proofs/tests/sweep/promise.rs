//! What a class of the sweep promises, straight from the definitions of the protocol.

use selfneg_core::Aggregation;
use selfneg_proofs::sweep::{Domain, Grain, Pair, Person};

/// D(0), D(1), ...: what the other's offers are worth to `receiver`, less its own complete
/// offer. Straight from the definitions.
fn gains(domain: &Domain, aggregation: Aggregation, receiver: &Person, sender: &Person) -> Vec<i64> {
    let disposition = |condition: u16| {
        let mut next = 0;
        domain
            .conditions_per_disposition()
            .iter()
            .position(|&count| {
                next += u16::from(count);
                condition < next
            })
            .unwrap()
    };
    let impact = |person: &Person, depth: usize| {
        let mut disclosed: Vec<usize> =
            person.conditions.iter().take(depth).map(|condition| disposition(condition.0)).collect();
        if aggregation == Aggregation::PerDisposition {
            disclosed.dedup();
        }
        disclosed.iter().map(|&d| i64::from(receiver.ranks[d].0)).sum::<i64>()
    };
    let own = impact(receiver, usize::MAX);
    (0..=sender.conditions.len()).map(|depth| impact(sender, depth) - own).collect()
}

/// All that the documentation of [`Grain`] promises of a class.
#[derive(PartialEq, Eq, Hash, Debug, Clone)]
pub(crate) struct Promise {
    lengths: [usize; 2],
    depths: [Option<usize>; 4],
    signs: [i64; 4],
    welfare: i64,
    ties: [Option<i64>; 2],
}

pub(crate) fn promise(domain: &Domain, grain: &Grain, pair: &Pair) -> Promise {
    let current = gains(domain, grain.aggregation, &pair.current, &pair.interrupting);
    let interrupting = gains(domain, grain.aggregation, &pair.interrupting, &pair.current);
    let willing = i64::from(grain.willingness);
    let first = |gains: &[i64], over: i64| {
        gains.iter().position(|&gain| gain > over).map(|depth| (depth, gains[depth] - over))
    };
    let depth = |accepted: Option<(usize, i64)>| accepted.map(|(depth, _)| depth);
    let tie = |c: Option<(usize, i64)>, i: Option<(usize, i64)>| match (c, i) {
        (Some((k, surplus)), Some((l, other))) if k == l && grain.surplus => Some((surplus - other).signum()),
        _ => None,
    };
    let last = |gains: &[i64]| *gains.last().unwrap();
    let firsts = [
        first(&current, 0),
        first(&current, willing),
        first(&interrupting, 0),
        first(&interrupting, willing),
    ];
    Promise {
        lengths: [pair.current.conditions.len(), pair.interrupting.conditions.len()],
        depths: firsts.map(depth),
        signs: [
            last(&current).signum(),
            (last(&current) - willing).signum(),
            last(&interrupting).signum(),
            (last(&interrupting) - willing).signum(),
        ],
        welfare: last(&interrupting) - last(&current),
        ties: [tie(firsts[1], firsts[2]), tie(firsts[0], firsts[3])],
    }
}
