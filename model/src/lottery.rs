//! Whom to serve first, as a lottery: the best one by three criteria, each with exact
//! evidence.
//!
//! ```
//! use selfneg_model::{Impacts, exact::rational, lottery};
//!
//! // In whose eyes (rows) serving whom (columns) is worth what.
//! let impacts = Impacts::of_rows(vec![vec![7, 2], vec![5, 4]]).ok_or("not square")?;
//! let best = lottery::utilitarian(&impacts)?;
//! assert_eq!(best.shares, [rational(1), rational(0)]);
//! assert_eq!((best.value, best.bound), (rational(12), rational(12)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, ExponentialConeT, IPSolver, NonnegativeConeT, SupportedConeT, ZeroConeT,
};
use num_traits::{One, Signed, ToPrimitive};
use thiserror::Error;

use crate::exact::{
    Attempt, LinearProgramme, Rational, SolveError, Variable, fraction_near, rational, solve,
};
use crate::impacts::Impacts;

/// The most users for whom a lottery is computed.
pub const MAX_USERS: usize = 128;

/// A lottery over whom to serve first, and the proof of how good it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lottery {
    /// Each user's chance to be served first, by arrival. They add up to 1.
    pub shares: Vec<Rational>,
    /// What the lottery is worth by its criterion.
    pub value: Rational,
    /// What no lottery exceeds. Proved by exact arithmetic; equal to `value` if the lottery
    /// is proved optimal.
    pub bound: Rational,
}

/// A lottery for Nash welfare, the product of all users' expected impacts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NashLottery {
    /// Each user's chance to be served first, by arrival. They add up to 1.
    pub shares: Vec<Rational>,
    /// The geometric mean of the expected impacts under any lottery is at most this many
    /// times that under this one. At least 1; 1 if the lottery is proved optimal.
    pub factor: Rational,
    /// Users to whom nothing is worth anything. The product leaves them out.
    pub indifferent: Vec<usize>,
}

/// Why there is no lottery.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LotteryError {
    /// There is nobody to serve.
    #[error("nobody is there to be served: expected at least one user")]
    NoUsers,
    /// More than [`MAX_USERS`].
    #[error("{found} users, at most {MAX_USERS}")]
    TooManyUsers {
        /// How many there are.
        found: usize,
    },
    /// The optimum could not be found or not be proved.
    #[error(transparent)]
    Unsolved(#[from] SolveError),
    /// The solver refused the conic programme.
    #[error("the solver refused the conic programme: {0}")]
    Refused(String),
}

/// The lottery with the largest expected welfare, in ranks. Users of equal welfare may share.
///
/// # Errors
/// [`LotteryError`].
pub fn utilitarian(impacts: &Impacts) -> Result<Lottery, LotteryError> {
    let mut programme = LinearProgramme::new();
    let shares: Vec<Variable> = users(impacts)?
        .map(|served| programme.variable(rational(0), rational(1), rational(impacts.welfare(served))))
        .collect();
    programme.equal(shares.iter().map(|&share| (share, rational(1))), rational(1));
    solved(&programme, shares.len())
}

/// The lottery under which the user who expects least expects most, in ranks.
///
/// # Errors
/// [`LotteryError`].
pub fn egalitarian(impacts: &Impacts) -> Result<Lottery, LotteryError> {
    let mut programme = LinearProgramme::new();
    let shares: Vec<Variable> =
        users(impacts)?.map(|_| programme.variable(rational(0), rational(1), rational(0))).collect();
    programme.equal(shares.iter().map(|&share| (share, rational(1))), rational(1));
    let most = users(impacts)?.flat_map(|user| impacts.in_eyes_of(user)).max().copied().unwrap_or(0);
    let least = programme.variable(rational(0), rational(most), rational(1));
    for user in users(impacts)? {
        let expected = shares.iter().zip(impacts.in_eyes_of(user));
        let terms = expected.map(|(&share, &impact)| (share, rational(impact)));
        programme.at_least(terms.chain([(least, rational(-1))]), rational(0));
    }
    solved(&programme, shares.len())
}

/// Rounding of the solver's shares: simple fractions if they do, exactly its numbers if not.
const ROUNDINGS: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 0.0];

/// A factor below 1 + 1/this is good enough to stop looking for a better rounding.
const FINE: u32 = 1_000_000;

/// The lottery with the largest product of expected impacts, over the users to whom anything
/// is worth anything.
///
/// For positive expectations U of this lottery and U* of any other, the geometric mean of
/// the ratios U*/U is at most their arithmetic mean, and that is linear in the other
/// lottery: it is largest for one that serves a single user. So the factor is the largest
/// over users s of the mean over u of `EI_u(s) / U_u`, a rational number that needs no
/// logarithm.
///
/// # Errors
/// [`LotteryError`].
pub fn nash(impacts: &Impacts) -> Result<NashLottery, LotteryError> {
    let cares = |&user: &usize| impacts.in_eyes_of(user).iter().any(|&impact| impact > 0);
    let (caring, indifferent): (Vec<usize>, Vec<usize>) = users(impacts)?.partition(cares);
    if caring.is_empty() {
        let shares = users(impacts)?.map(|user| rational(u8::from(user == 0))).collect();
        return Ok(NashLottery { shares, factor: Rational::one(), indifferent });
    }
    let floating = nash_in_floating_point(impacts, &caring)?;
    let even = vec![Rational::new(1.into(), impacts.users().into()); impacts.users()];
    // Equal shares are worth something to everyone who cares, so there is always a factor.
    let mut best = (factor(impacts, &caring, &even), even);
    for rounding in ROUNDINGS {
        let Some(shares) = distribution(&floating, rounding) else { continue };
        let Some(factor) = factor(impacts, &caring, &shares) else { continue };
        let fine = (&factor - Rational::one()) * rational(FINE) <= Rational::one();
        if best.0.as_ref().is_none_or(|known| factor < *known) {
            best = (Some(factor), shares);
        }
        if fine {
            break;
        }
    }
    let (factor, shares) = best;
    let factor = factor.map_or_else(Rational::one, |factor| rounded_up(&factor));
    Ok(NashLottery { shares, factor, indifferent })
}

/// The next number with nine decimals: still a bound, and one that people can read.
fn rounded_up(factor: &Rational) -> Rational {
    let decimals = rational(1_000_000_000);
    (factor * &decimals).ceil() / decimals
}

/// By how much at most any lottery's geometric mean exceeds that of `shares`. `None` if the
/// latter is 0.
fn factor(impacts: &Impacts, caring: &[usize], shares: &[Rational]) -> Option<Rational> {
    let expected: Vec<(usize, Rational)> = caring
        .iter()
        .map(|&user| {
            let of = impacts.in_eyes_of(user).iter().zip(shares);
            (user, of.map(|(&impact, share)| rational(impact) * share).sum())
        })
        .collect();
    if expected.iter().any(|(_, expected): &(usize, Rational)| !expected.is_positive()) {
        return None;
    }
    let ratios = |served: usize| -> Rational {
        expected.iter().map(|(user, expected)| rational(impacts.of_serving(served, *user)) / expected).sum()
    };
    (0..impacts.users()).map(ratios).max().map(|largest| largest / rational(caring.len()))
}

/// Fractions near the given numbers, scaled to add up to 1.
fn distribution(floating: &[f64], rounding: f64) -> Option<Vec<Rational>> {
    let mut shares = floating
        .iter()
        .map(|&share| fraction_near(if share < 1e-7 { 0.0 } else { share }, rounding))
        .collect::<Option<Vec<Rational>>>()?;
    let sum: Rational = shares.iter().sum();
    if !sum.is_positive() {
        return None;
    }
    for share in &mut shares {
        *share /= &sum;
    }
    Some(shares)
}

/// Maximise the sum of `t_u` where `(t_u, 1, U_u)` is in the exponential cone, which says
/// that `t_u <= ln U_u`.
fn nash_in_floating_point(impacts: &Impacts, caring: &[usize]) -> Result<Vec<f64>, LotteryError> {
    let lotteries = impacts.users();
    let variables = lotteries + caring.len();
    let mut entries: Vec<(usize, usize, f64)> = (0..lotteries).map(|share| (0, share, 1.0)).collect();
    let mut limits = vec![1.0];
    entries.extend((0..lotteries).map(|share| (1 + share, share, -1.0)));
    limits.extend(std::iter::repeat_n(0.0, lotteries));
    let mut cones: Vec<SupportedConeT<f64>> = vec![ZeroConeT(1), NonnegativeConeT(lotteries)];
    for (nth, &user) in caring.iter().enumerate() {
        let row = limits.len();
        entries.push((row, lotteries + nth, -1.0));
        // The product's maximum does not depend on the scale of any one user's impacts.
        let own = impacts.in_eyes_of(user);
        let scale = own.iter().max().and_then(ToPrimitive::to_f64).unwrap_or(1.0);
        for (share, impact) in own.iter().enumerate() {
            entries.push((row + 2, share, -impact.to_f64().unwrap_or(0.0) / scale));
        }
        limits.extend([0.0, 1.0, 0.0]);
        cones.push(ExponentialConeT());
    }
    let mut rows = Vec::new();
    let mut columns = Vec::new();
    let mut values = Vec::new();
    for (row, column, value) in entries {
        rows.push(row);
        columns.push(column);
        values.push(value);
    }
    let matrix = CscMatrix::new_from_triplets(limits.len(), variables, rows, columns, values);
    let objective: Vec<f64> =
        (0..variables).map(|variable| if variable < lotteries { 0.0 } else { -1.0 }).collect();
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-11,
        tol_gap_rel: 1e-11,
        ..DefaultSettings::default()
    };
    let nothing = CscMatrix::zeros((variables, variables));
    let mut solver = DefaultSolver::new(&nothing, &objective, &matrix, &limits, &cones, settings)
        .map_err(|error| LotteryError::Refused(error.to_string()))?;
    solver.solve();
    // Whatever the solver ended with, the exact factor says how good it is.
    let mut shares = solver.solution.x;
    shares.truncate(lotteries);
    Ok(shares)
}

fn users(impacts: &Impacts) -> Result<std::ops::Range<usize>, LotteryError> {
    match impacts.users() {
        0 => Err(LotteryError::NoUsers),
        found if found > MAX_USERS => Err(LotteryError::TooManyUsers { found }),
        users => Ok(0..users),
    }
}

/// The first `users` variables of the programme are the shares.
fn solved(programme: &LinearProgramme, users: usize) -> Result<Lottery, LotteryError> {
    match solve(programme)? {
        Attempt::Feasible { certificate, certified } => {
            let mut shares = certificate.point;
            shares.truncate(users);
            Ok(Lottery { shares, value: certified.value, bound: certified.bound })
        }
        Attempt::Infeasible { .. } => Err(SolveError::Inexact.into()),
    }
}
