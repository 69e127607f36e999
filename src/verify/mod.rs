//! Every property under every variant, by every engine that runs here, against the expected
//! verdicts.

pub mod counterexample;
mod cover;
mod policies;
pub mod table;

use std::str::FromStr;
use std::time::{Duration, Instant};

use selfneg_core::Options;
use selfneg_proofs::counterexample::Counterexample;
use selfneg_proofs::engine::Core;
use selfneg_proofs::expected::{Verdict, expected};
use selfneg_proofs::property::Property;
use selfneg_proofs::property::policy::PolicyProperty;
use selfneg_proofs::report::{Method, Report, is_swept, verify_every_variant, verify_swept};
use selfneg_proofs::sweep::{Counts, Detail, Domain, DomainError, SweepError};
use selfneg_proofs::variant::variants;

use crate::precedence::Policy;

/// A property of two users, or of a policy for three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Of two users.
    Two(Property),
    /// Of three users under this policy.
    Three(Policy, PolicyProperty),
}

impl Subject {
    /// Every one, in the order of the tables.
    pub fn all() -> impl Iterator<Item = Self> {
        let two = Property::ALL.iter().map(|&property| Self::Two(property));
        let three = Policy::ALL.into_iter().flat_map(|policy| {
            PolicyProperty::ALL.iter().map(move |&property| Self::Three(policy, property))
        });
        two.chain(three)
    }

    /// `role-symmetry`, or with the policy `published/unbeaten-service`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Two(property) => property.name().to_owned(),
            Self::Three(policy, property) => format!("{policy}/{property}"),
        }
    }

    /// Whether it compares a run with the one in which the two users swap their parts.
    #[must_use]
    pub const fn compares_roles(self) -> bool {
        matches!(self, Self::Two(Property::RoleSymmetry | Property::RoleSymmetryException))
    }

    /// What it says, in one sentence.
    #[must_use]
    pub const fn statement(self) -> &'static str {
        match self {
            Self::Two(property) => property.statement(),
            Self::Three(_, property) => property.statement(),
        }
    }
}

/// A name that no property has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no property has that name; `selfneg verify --list` lists them")]
pub struct UnknownSubject;

impl FromStr for Subject {
    type Err = UnknownSubject;

    fn from_str(name: &str) -> Result<Self, UnknownSubject> {
        Self::all().find(|subject| subject.name() == name).ok_or(UnknownSubject)
    }
}

/// What to check, and how hard.
#[derive(Clone, Debug)]
pub struct Request {
    /// Which properties.
    pub subjects: Vec<Subject>,
    /// The domain that is swept whole, and whose outcomes are counted.
    pub domain: Domain,
    /// A domain in which conditions share dispositions, so that the aggregations differ. It
    /// is swept too.
    pub shared_domain: Domain,
    /// How many random cases for each property and variant.
    pub random_cases: u32,
    /// Where the random cases start.
    pub seed: u64,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The domain that was swept.
    pub domain: Domain,
    /// How often the published variant does what, over that domain.
    pub counts: Counts,
    /// One row for each property and variant.
    pub rows: Vec<Row>,
    /// How long it took.
    pub time: Duration,
}

/// One property under one variant.
#[derive(Clone, Debug)]
pub struct Row {
    /// The property.
    pub subject: Subject,
    /// The variant.
    pub options: Options,
    /// What is expected.
    pub expected: Verdict,
    /// What each engine found.
    pub evidence: Vec<Report>,
}

impl Row {
    /// *Fails* as soon as one engine has a counterexample.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match self.counterexample() {
            Some(_) => Verdict::Fails,
            None => Verdict::Holds,
        }
    }

    /// The smallest counterexample that any engine found.
    #[must_use]
    pub fn counterexample(&self) -> Option<&Counterexample> {
        self.evidence.iter().filter_map(|report| report.counterexample.as_ref()).min_by_key(|found| {
            found.users.iter().map(selfneg_proofs::counterexample::OwnedUser::size).fold(
                (0usize, 0u64),
                |(conditions, ranks), (more_conditions, more_ranks)| {
                    (conditions.saturating_add(more_conditions), ranks.saturating_add(more_ranks))
                },
            )
        })
    }

    /// The engine whose word counts most: of those that bear the verdict out, the one that
    /// looked at the most cases of a whole domain.
    #[must_use]
    pub fn principal(&self) -> Option<&Report> {
        let verdict = self.verdict();
        let whole =
            self.evidence.iter().filter(|report| report.method != "random" && report.verdict == verdict);
        whole
            .max_by_key(|report| report.cases)
            .or_else(|| self.evidence.iter().find(|report| report.verdict == verdict))
    }

    /// Whether the verdict is the expected one, and the evidence says anything: a *holds*
    /// for which no whole domain met the premise is not borne out.
    #[must_use]
    pub fn is_as_expected(&self) -> bool {
        let borne_out = self.evidence.iter().any(|report| report.method != "random" && report.nonvacuous > 0);
        self.verdict() == self.expected && borne_out
    }
}

impl Verification {
    /// Whether every verdict is the expected one.
    #[must_use]
    pub fn is_as_expected(&self) -> bool {
        self.rows.iter().all(Row::is_as_expected)
    }
}

/// Why nothing was verified.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The domain cannot be swept.
    #[error("domain: {0}")]
    Domain(#[from] DomainError),
    /// The sweep does not add up.
    #[error("sweep: {0}")]
    Sweep(#[from] SweepError),
}

/// How far a verification is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// What is being done.
    pub task: &'static str,
    /// Tasks done.
    pub done: u64,
    /// Tasks in all.
    pub of: u64,
}

/// Checks what is asked for. `progress` is told before each task.
///
/// # Errors
/// [`VerifyError`] if the domain cannot be swept.
pub fn verify<F: FnMut(Progress)>(request: &Request, mut progress: F) -> Result<Verification, VerifyError> {
    let start = Instant::now();
    let two: Vec<Property> = request
        .subjects
        .iter()
        .filter_map(|&subject| match subject {
            Subject::Two(property) => Some(property),
            Subject::Three(..) => None,
        })
        .collect();
    let subjects = u64::try_from(request.subjects.len()).unwrap_or(u64::MAX);
    let of = subjects.saturating_mul(2).saturating_add(3);
    let mut done = 0u64;
    let mut begin = |task: &'static str| {
        progress(Progress { task, done, of });
        done = done.saturating_add(1);
    };
    begin("counting outcomes over the domain");
    let counts = Counts::of(&request.domain, &Options::default(), Detail::ByPattern, &|_| ())?;
    let mut reports: Vec<Report> = Vec::new();
    if two.iter().any(|&property| is_swept(property)) {
        begin("sweeping the domain");
        reports.extend(verify_swept(&two, &Core, &request.domain, &|_| ())?);
        begin("sweeping the published activation");
        reports.extend(verify_swept(&two, &Core, &request.shared_domain, &|_| ())?);
    }
    let random = Method::Random { cases: request.random_cases, seed: request.seed };
    for &property in &two {
        begin(property.name());
        reports.extend(verify_every_variant(property, &Core, Method::Enumeration));
        if request.random_cases > 0 {
            begin(property.name());
            reports.extend(verify_every_variant(property, &Core, random));
        }
    }
    let mut rows = Vec::new();
    for &subject in &request.subjects {
        match subject {
            Subject::Two(property) => rows.extend(variants().map(|options| {
                Row {
                    subject,
                    options,
                    expected: expected(property, &options),
                    evidence: reports
                        .iter()
                        .filter(|report| report.property == property.name() && report.options == options)
                        .cloned()
                        .collect(),
                }
            })),
            Subject::Three(policy, property) => {
                begin(property.name());
                rows.extend(policies::verify(policy, property).into_iter().map(|report| Row {
                    subject,
                    options: report.options,
                    expected: report.expected,
                    evidence: vec![report],
                }));
            }
        }
    }
    Ok(Verification { domain: request.domain.clone(), counts, rows, time: start.elapsed() })
}
