//! The policies for three users, as the properties take them.

use selfneg_core::policy::{Arrival, Pairing};
use selfneg_model::{Condorcet, Precedence};
use selfneg_proofs::engine::Core;
use selfneg_proofs::enumeration::Domain;
use selfneg_proofs::expected::{Verdict, expected_of_policy};
use selfneg_proofs::property::policy::{self, Bilateral, PolicyProperty, Published};
use selfneg_proofs::report::{Report, verify_policy};
use selfneg_proofs::variant::variants;

use crate::precedence::Policy;

/// A property of a policy under every variant of the bilateral negotiations.
pub(super) fn verify(policy: Policy, property: PolicyProperty) -> Vec<Report> {
    variants()
        .map(|options| match policy {
            Policy::Published => {
                let expected = expected_of_policy(property, &options);
                verify_policy(property, &options, &Published, &Core, &Domain::TWO, expected)
            }
            // Whoever is agreed on beats everyone else, by definition.
            Policy::Condorcet => {
                verify_policy(property, &options, &OfThree, &Core, &Domain::TWO, Verdict::Holds)
            }
        })
        .collect()
}

/// `condorcet` among three users.
struct OfThree;

impl policy::Policy for OfThree {
    fn choose(&self, outcomes: Bilateral) -> Option<Arrival> {
        let condorcet = Condorcet::negotiate(3, |earlier, later| {
            outcomes.of(match (earlier, later) {
                (0, 1) => Pairing::AB,
                (0, _) => Pairing::AC,
                _ => Pairing::BC,
            })
        });
        match condorcet.precedence() {
            Precedence::Agreement(0) => Some(Arrival::A),
            Precedence::Agreement(1) => Some(Arrival::B),
            Precedence::Agreement(_) => Some(Arrival::C),
            Precedence::NoAgreement { .. } => None,
        }
    }
}
