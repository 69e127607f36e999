//! How often the policies for three users serve somebody whom another present user beats.
//!
//! What a policy does with three users depends on their three bilateral outcomes only, so
//! triples are counted by these, and each policy is run once on each of the 27 combinations.

use selfneg_core::policy::{self, Arrival, Pairing};
use selfneg_core::{Activation, Case, Options, Outcome, RulesError, Side, TooManyConditions};
use selfneg_model::{Condorcet, Precedence};
use selfneg_proofs::sweep::{Domain, Person};

use crate::precedence::Policy;

/// The most users of a domain all triples of which are gone through.
pub const MAX_SWEPT_USERS: u64 = 1500;

/// Triples by the outcomes of their three negotiations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Triples {
    /// How many there are.
    pub total: u64,
    /// By outcome of AB, AC and BC.
    counts: [[[u64; 3]; 3]; 3],
}

/// What a policy does with triples. Without agreement, first come is first served.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Served {
    /// The policy.
    pub policy: Policy,
    /// Triples in which it gives somebody precedence.
    pub agreements: u64,
    /// Those of them in which another present user beats that one.
    pub beaten_agreements: u64,
    /// Triples left to the fallback in which another present user beats whom it serves.
    pub beaten_fallbacks: u64,
}

/// Why policies cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PoliciesError {
    /// Too many triples to go through.
    #[error(
        "the domain has {users} users, at most {MAX_SWEPT_USERS} for all their triples; sample some instead \
         with --sample"
    )]
    TooManyUsers {
        /// The domain's users.
        users: u64,
    },
    /// The engine refused the domain's rules.
    #[error("rules: {0}")]
    Rules(#[from] RulesError),
    /// The engine refused a status.
    #[error("status: {0}")]
    Status(#[from] TooManyConditions),
}

const OUTCOMES: [Outcome; 3] =
    [Outcome::Agreement(Side::Current), Outcome::Agreement(Side::Interrupting), Outcome::NoAgreement];

fn code(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Agreement(Side::Current) => 0,
        Outcome::Agreement(Side::Interrupting) => 1,
        Outcome::NoAgreement => 2,
    }
}

impl Triples {
    fn none() -> Self {
        Self { total: 0, counts: [[[0; 3]; 3]; 3] }
    }

    fn add(&mut self, ab: u8, ac: u8, bc: u8) {
        let place = self.counts.get_mut(usize::from(ab)).and_then(|of| of.get_mut(usize::from(ac)));
        if let Some(count) = place.and_then(|of| of.get_mut(usize::from(bc))) {
            *count += 1;
            self.total += 1;
        }
    }

    /// All ordered triples of users of a domain, the same user more than once included.
    ///
    /// # Errors
    /// [`PoliciesError`] for a domain of more than [`MAX_SWEPT_USERS`].
    pub fn swept(domain: &Domain, options: &Options) -> Result<Self, PoliciesError> {
        if domain.users() > MAX_SWEPT_USERS {
            return Err(PoliciesError::TooManyUsers { users: domain.users() });
        }
        let activation = domain.activation()?;
        let people: Vec<Person> = domain.people().collect();
        let mut outcomes: Vec<Vec<u8>> = Vec::new();
        for current in &people {
            let row = people.iter().map(|other| outcome(current, other, activation, options));
            outcomes.push(row.collect::<Result<_, _>>()?);
        }
        let mut triples = Self::none();
        for of_a in &outcomes {
            for (&ab, of_b) in of_a.iter().zip(&outcomes) {
                for (&ac, &bc) in of_a.iter().zip(of_b) {
                    triples.add(ab, ac, bc);
                }
            }
        }
        Ok(triples)
    }

    /// Random ordered triples of users of a domain: every rank and every condition
    /// independent and uniform. The same seed makes the same triples.
    ///
    /// # Errors
    /// [`PoliciesError`] if the engine refuses the domain, which it does not.
    pub fn sampled(
        domain: &Domain,
        options: &Options,
        triples: u64,
        seed: u64,
    ) -> Result<Self, PoliciesError> {
        let activation = domain.activation()?;
        let mut random = fastrand::Rng::with_seed(seed);
        let mut sample = Self::none();
        for _ in 0..triples {
            let [a, b, c] = [(); 3].map(|()| domain_person(domain, &mut random));
            sample.add(
                outcome(&a, &b, activation, options)?,
                outcome(&a, &c, activation, options)?,
                outcome(&b, &c, activation, options)?,
            );
        }
        Ok(sample)
    }

    /// What a policy does with these triples.
    #[must_use]
    pub fn served_by(&self, policy: Policy) -> Served {
        let mut served = Served { policy, agreements: 0, beaten_agreements: 0, beaten_fallbacks: 0 };
        let combinations = self.counts.iter().zip(OUTCOMES).flat_map(|(of_ab, ab)| {
            of_ab.iter().zip(OUTCOMES).flat_map(move |(of_ac, ac)| {
                of_ac.iter().zip(OUTCOMES).map(move |(&count, bc)| (ab, ac, bc, count))
            })
        });
        for (ab, ac, bc, count) in combinations {
            let negotiate = |earlier: usize, later: usize| match (earlier, later) {
                (0, 1) => ab,
                (0, 2) => ac,
                _ => bc,
            };
            let condorcet = Condorcet::negotiate(3, negotiate);
            let beats = condorcet.beats();
            let precedence = match policy {
                Policy::Condorcet => condorcet.precedence(),
                Policy::Published => {
                    let winner = policy::published(|pairing| match pairing {
                        Pairing::AB => ab,
                        Pairing::AC => ac,
                        Pairing::BC => bc,
                    });
                    match winner {
                        Some(Arrival::A) => Precedence::Agreement(0),
                        Some(Arrival::B) => Precedence::Agreement(1),
                        Some(Arrival::C) => Precedence::Agreement(2),
                        None => Precedence::NoAgreement { candidates: vec![0, 1, 2] },
                    }
                }
            };
            match precedence {
                Precedence::Agreement(winner) => {
                    served.agreements += count;
                    if !beats.beaten_by(winner).is_empty() {
                        served.beaten_agreements += count;
                    }
                }
                Precedence::NoAgreement { candidates } => {
                    let first = candidates.first().copied().unwrap_or(0);
                    if !beats.beaten_by(first).is_empty() {
                        served.beaten_fallbacks += count;
                    }
                }
            }
        }
        served
    }
}

fn outcome(
    current: &Person,
    interrupting: &Person,
    activation: Activation<'_>,
    options: &Options,
) -> Result<u8, TooManyConditions> {
    let case = Case { activation, current: current.user()?, interrupting: interrupting.user()? };
    Ok(code(case.negotiate(options).outcome))
}

fn domain_person(domain: &Domain, random: &mut fastrand::Rng) -> Person {
    let conditions = (0..domain.conditions())
        .filter(|_| random.bool())
        .filter_map(|condition| u16::try_from(condition).ok())
        .map(selfneg_core::Condition)
        .collect();
    let ranks = (0..domain.dispositions()).map(|_| selfneg_core::Rank(random.u8(domain.ranks()))).collect();
    Person { conditions, ranks }
}
