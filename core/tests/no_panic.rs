//! No panic can be reached from the crate's functions: for each one below the linker
//! refuses this test if the optimiser cannot remove every path to a panic. In release mode
//! only: `cargo test --release -p selfneg-core --test no_panic`.
//!
//! The crate's source files are compiled into this test, since across crates the optimiser
//! would see through them only with link-time optimisation. What is not checked: the
//! `Display` of names and errors, which calls whatever the caller writes to; and observers,
//! which are the caller's own.
#![cfg(not(debug_assertions))]
#![allow(dead_code, unreachable_pub, reason = "whole modules are here, of which some is checked")]

#[path = "../src/decision.rs"]
mod decision;
#[path = "../src/impact.rs"]
mod impact;
#[path = "../src/observer.rs"]
mod observer;
#[path = "../src/options.rs"]
mod options;
#[path = "../src/outcome.rs"]
mod outcome;
#[path = "../src/party.rs"]
mod party;
#[path = "../src/policy.rs"]
mod policy;
#[path = "../src/protocol.rs"]
mod protocol;
#[path = "../src/rules.rs"]
mod rules;
#[path = "../src/user.rs"]
mod user;
#[path = "../src/welfare.rs"]
mod welfare;

use std::hint::black_box;

use no_panic::no_panic;

use decision::{Case, Decision};
use impact::Impact;
use observer::{Disclosure, Observer, Ruling, Weighing};
use options::{Aggregation, Fallback, Options, QuitRule, TieRule, UnknownName};
use outcome::{Conclusion, Outcome, Side};
use party::{Current, Interrupting, Offer, Party, Verdict};
use policy::{Arrival, Pairing};
use protocol::{Negotiation, Step};
use rules::{Activation, Condition, Disposition, Implication, RulesError};
use user::{EthicalProfile, Rank, Status, TooManyConditions, User};
use welfare::{Welfare, impact_of_serving};

/// An observer that uses all it is told and cannot panic.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
struct Digest(u64);

impl Observer for Digest {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        let condition = match discloses {
            Disclosure::Condition(condition) => u64::from(condition.0),
            Disclosure::Willingness => u64::MAX,
        };
        self.0 ^= u64::from(round) ^ condition ^ (depth as u64) ^ (sender as u64);
    }
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        self.0 ^= weighing.value.0 ^ weighing.threshold.0 ^ (receiver as u64);
    }
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        self.0 ^= (receiver as u64) ^ (ruling as u64);
    }
    fn quit(&mut self, round: u32, sender: Side) {
        self.0 ^= u64::from(round) ^ (sender as u64);
    }
    fn concluded(&mut self, conclusion: Conclusion) {
        self.0 ^= u64::from(conclusion.rounds);
    }
}

#[no_panic]
fn activation<'a>(rows: &'a [&'a [Disposition]]) -> Result<Activation<'a>, RulesError> {
    Activation::new(rows)
}

#[no_panic]
fn activated<'a>(activation: Activation<'a>, condition: Condition) -> &'a [Disposition] {
    activation.of(condition)
}

#[no_panic]
fn status(conditions: &[Condition]) -> Result<Status<'_>, TooManyConditions> {
    Status::new(conditions)
}

#[no_panic]
fn mentions(goal: Implication<'_>, disposition: Disposition) -> u8 {
    goal.mentions(disposition)
}

#[no_panic]
fn negotiate(case: &Case<'_>, options: &Options) -> Conclusion {
    case.negotiate(options)
}

#[no_panic]
fn negotiation<'a>(case: &Case<'a>, options: &Options) -> Negotiation<'a> {
    case.negotiation(options)
}

#[no_panic]
fn step<'a>(negotiation: Negotiation<'a>, digest: &mut Digest) -> Step<'a> {
    negotiation.step(digest)
}

#[no_panic]
fn decide(case: &Case<'_>, options: &Options) -> Decision {
    case.decide(options, &mut ())
}

#[no_panic]
fn decide_observed(case: &Case<'_>, options: &Options, digest: &mut Digest) -> Decision {
    case.decide(options, digest)
}

#[no_panic]
fn welfare_of_both(case: &Case<'_>, options: &Options) -> Welfare {
    case.welfare(options)
}

#[no_panic]
fn regret(welfare: Welfare, served: Side) -> (Side, Impact) {
    (welfare.best(), welfare.regret(served))
}

#[no_panic]
fn impact_on(case: &Case<'_>, options: &Options) -> Impact {
    impact_of_serving(&case.current, &case.interrupting, case.activation, options.aggregation)
}

#[no_panic]
fn current<'a>(case: &Case<'a>, options: &Options) -> Party<'a, Current> {
    Party::current(case.current, case.activation, options)
}

#[no_panic]
fn interrupting<'a>(case: &Case<'a>, options: &Options) -> Party<'a, Interrupting> {
    Party::interrupting(case.interrupting, case.activation, options)
}

#[no_panic]
fn offer<'a>(party: &mut Party<'a, Interrupting>) -> Option<Offer<'a, Interrupting>> {
    party.offer()
}

#[no_panic]
fn discloses<'a>(offer: &Offer<'a, Interrupting>) -> (usize, &'a [Condition], Disclosure) {
    (offer.depth(), offer.conditions(), offer.discloses())
}

#[no_panic]
fn judge<'a>(party: &mut Party<'a, Current>, offer: &Offer<'a, Interrupting>) -> Verdict {
    party.judge(offer, &mut ())
}

#[no_panic]
fn has_offers(party: &Party<'_, Current>, depth: usize) -> (bool, bool, usize) {
    (party.has_offer(depth), party.has_yet_to_offer(depth), party.offers_made())
}

#[no_panic]
fn published(outcomes: [Outcome; 3]) -> Option<Arrival> {
    let [ab, ac, bc] = outcomes;
    policy::published(|pairing| match pairing {
        Pairing::AB => ab,
        Pairing::AC => ac,
        Pairing::BC => bc,
    })
}

#[no_panic]
fn named(name: &str) -> (Result<QuitRule, UnknownName>, Result<TieRule, UnknownName>) {
    (name.parse(), name.parse())
}

/// Calls every function above with data the optimiser cannot know, so that none is left out
/// of the program.
#[test]
fn no_function_links_a_panic() {
    let row = [Disposition(0)];
    let rows = [&row[..], &[]];
    let [conditions, others] = [[Condition(0), Condition(1)], [Condition(1), Condition(0)]];
    let user = |rank: &'static [Rank], conditions| {
        User::new(EthicalProfile::new(rank), status(black_box(conditions)).unwrap(), Implication::new(&[1]))
    };
    let case = black_box(Case {
        activation: activation(black_box(&rows)).unwrap(),
        current: user(&[Rank(3)], &conditions),
        interrupting: user(&[Rank(2)], &others),
    });
    assert_eq!(activated(case.activation, black_box(Condition(0))), row);
    assert_eq!(mentions(Implication::new(&[1]), black_box(Disposition(0))), 1);

    for (&quit, &tie) in QuitRule::ALL.iter().zip(TieRule::ALL) {
        for &aggregation in Aggregation::ALL {
            for &fallback in Fallback::ALL {
                let options = black_box(Options { quit, aggregation, tie, fallback, willingness: 1 });
                let conclusion = negotiate(&case, &options);
                let mut observed = Digest::default();
                let decision = decide_observed(&case, &options, &mut observed);
                assert_eq!(decision, decide(&case, &options));
                assert_eq!(decision.conclusion, conclusion);

                let mut stepped = Digest::default();
                let mut under_way = negotiation(&case, &options);
                while let Step::Ongoing(next) = step(under_way, &mut stepped) {
                    under_way = next;
                }
                assert_eq!(stepped, observed);

                let (best, none) = regret(welfare_of_both(&case, &options), Side::Current);
                assert_eq!((best, none), (Side::Current, Impact(0)));
                assert_eq!(impact_on(&case, &options), Impact(2));

                let mut judging = current(&case, &options);
                let offered = offer(&mut interrupting(&case, &options)).unwrap();
                assert_eq!(discloses(&offered).0, 1);
                assert_eq!(judge(&mut judging, &offered), Verdict::Rejected);
                assert_eq!(has_offers(&judging, black_box(3)), (true, true, 0));
            }
        }
    }
    assert_eq!(published(black_box([Outcome::NoAgreement; 3])), None);
    assert_eq!(named(black_box("literal")), (Ok(QuitRule::Literal), Err(UnknownName)));
}
