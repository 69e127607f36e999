//! For each property and variant, whether it holds: the table that every engine's verdict
//! is compared with, in both directions.
//!
//! It is written as rules, each with the reason in one line. "Theorem" below means that
//! the reason is an argument for users of every size, written for people and not checked
//! by a machine; the engines establish the same verdicts for the domains that they name,
//! on the code. Every verdict *fails* is established by a concrete counterexample.
//!
//! Throughout, `k_X` is the least depth at which the other user accepts X's offer. It
//! depends on the prefixes of X's own list and on the other's total only; with further
//! conditions an offer's worth never falls, under either aggregation.

use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};

use crate::property::Property;
use crate::property::policy::PolicyProperty;

/// Whether a property holds for a variant. There is no third value: every property is a
/// statement about every variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// No case refutes it.
    Holds,
    /// Some case does.
    Fails,
}

impl Verdict {
    /// `holds` or `fails`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "fails",
        }
    }

    const fn from_bool(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// What is expected of `property` under `options`, for willingness 0, 1 and 2 (a greater
/// one is as 2).
///
/// - `termination`: theorem, always. Every round uses up an offer or is a quit, and
///   nobody quits twice.
/// - `exact-termination`: theorem under `exhausted` with `first-sender`, where the only way
///   to no agreement is that both quit, and each has made all its offers by then. Fails
///   under the other tie rules (a tie without agreement ends early) and under `literal`.
/// - `closed-form`: theorem, always: the rounds before a least depth of acceptance are
///   rejections, and the quit rule says which of the offers are made at all.
/// - `determinism`, `decision-locality`, `transcript-locality`, `bounded-disclosure`,
///   `no-overflow`, `no-panic`: theorem, always; by what the engine can see and by the
///   bound of 2^48 on every total. `transcript-locality` carries the conditions that the
///   quit and tie rules need in its own statement.
/// - `role-symmetry`: theorem under `exhausted` with `fallback` or `surplus` and without
///   willingness, where the closed form does not mention who interrupts. Fails with
///   `first-sender` (equal depths), under `literal` (the interrupting user's offer of a
///   depth comes first, and its receiver ends the negotiation), and with willingness (it
///   moves to whoever is current).
/// - `role-symmetry-exception`: theorem under `exhausted` with `first-sender` and without
///   willingness, by the closed form. Fails elsewhere.
/// - `unanimity`: theorem with `utilitarian`, always: if both profiles prefer X then X
///   rejects the other's offers, so X wins or there is no agreement, and X has more
///   welfare. Theorem with `first-come` under `exhausted` without willingness: then the
///   other accepts X's complete offer. Fails with `first-come` under `literal` (the
///   negotiation ends too early) and with willingness (it lets the current user reject
///   what its profile prefers).
/// - `one-sided-optimality`: theorem for willingness up to 1, whatever the rest: the loser
///   gains at least 1 beyond its willingness and the winner loses nothing, or at most the
///   willingness; so it fails from 2 on.
/// - `gaining-last`: theorem, always: k of the user who gains stays, the other's does not
///   fall, and under `literal` the one offer that becomes possible is too deep to matter.
/// - `hide-proofness`: fails, always: hiding brings the decisive condition forward.
/// - `hiding-needs-mutual-deference`: theorem under `exhausted`: to win after hiding, X
///   must have an acceptable offer, so its complete one was acceptable before; it lost all
///   the same, so the other's was too. Fails under `literal`, where having fewer offers
///   changes when the negotiation ends.
/// - `sorted-hide-proofness`: theorem with `per-condition`: the first k of a part of a
///   non-increasing list sum to no more than the first k of the list, so hiding delays
///   one's own offers and hastens the other's. Fails with `per-disposition`: what a
///   condition adds grows when one that activates the same disposition is hidden.
/// - `order-independence`: fails, always. `order-needs-mutual-deference`: theorem under
///   `exhausted`: order moves `k_X` but does not make it come or go, and a k without a
///   counterpart wins at whatever depth. Fails under `literal`.
/// - `misreport-proofness`: fails, always: over-ranking what only oneself has raises one's
///   own total above every offer.
#[must_use]
pub const fn expected(property: Property, options: &Options) -> Verdict {
    let exhausted = matches!(options.quit, QuitRule::Exhausted);
    let first_sender = matches!(options.tie, TieRule::FirstSender);
    let unwilling = options.willingness == 0;
    Verdict::from_bool(match property {
        Property::Termination
        | Property::ClosedForm
        | Property::Determinism
        | Property::DecisionLocality
        | Property::TranscriptLocality
        | Property::BoundedDisclosure
        | Property::GainingLast
        | Property::NoOverflow
        | Property::NoPanic => true,
        Property::ExactTermination => exhausted && first_sender,
        Property::RoleSymmetry => exhausted && !first_sender && unwilling,
        Property::RoleSymmetryException => exhausted && first_sender && unwilling,
        Property::Unanimity => matches!(options.fallback, Fallback::Utilitarian) || (exhausted && unwilling),
        Property::OneSidedOptimality => options.willingness <= 1,
        Property::HidingNeedsDeference | Property::OrderNeedsDeference => exhausted,
        Property::SortedHideProofness => matches!(options.aggregation, Aggregation::PerCondition),
        Property::HideProofness | Property::OrderIndependence | Property::MisreportProofness => false,
    })
}

/// What is expected of a property of the published policy for three users, under every
/// variant of the bilateral negotiations.
///
/// - `condorcet-consistency`: holds for each of the 27 triples of outcomes, which is all
///   that a policy can look at.
/// - `agreement-has-cause`: likewise; the policy hands on the winner of a negotiation.
/// - `unbeaten-service`: fails: without agreement between A and B the outcome between A
///   and C is final, though B may beat its winner.
#[must_use]
pub const fn expected_of_policy(property: PolicyProperty, options: &Options) -> Verdict {
    let _ = options;
    Verdict::from_bool(match property {
        PolicyProperty::CondorcetConsistency | PolicyProperty::AgreementHasCause => true,
        PolicyProperty::UnbeatenService => false,
    })
}

/// Whether the fallback has any part in a property: if not, variants that differ in the
/// fallback only share their verdict and their cases.
#[must_use]
pub const fn looks_at_fallback(property: Property) -> bool {
    matches!(property, Property::Unanimity | Property::MisreportProofness | Property::NoPanic)
}
