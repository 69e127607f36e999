//! The check that turns a claim into a fact. It trusts nothing of where a certificate
//! comes from: all arithmetic is exact, and it is short enough to read.

use num_traits::{Signed, Zero};
use thiserror::Error;

use super::programme::{LinearProgramme, Relation};
use super::rational::Rational;

/// A claimed optimum: a point, and a multiplier for every row that bounds all points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Certificate {
    /// A value for every variable.
    pub point: Vec<Rational>,
    /// A multiplier for every row; not negative for rows that say *at most*.
    pub multipliers: Vec<Rational>,
}

/// What a certificate proves: some feasible point is worth `value`, and none is worth more
/// than `bound`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Certified {
    /// What the certificate's point is worth.
    pub value: Rational,
    /// What no feasible point exceeds.
    pub bound: Rational,
}

impl Certified {
    /// By how much the point may fall short of the optimum; 0 if it is optimal.
    #[must_use]
    pub fn gap(&self) -> Rational {
        &self.bound - &self.value
    }

    /// Whether the point is proved optimal.
    #[must_use]
    pub fn is_optimal(&self) -> bool {
        self.value == self.bound
    }
}

/// Why a certificate proves nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// The point has not one value for every variable.
    #[error("{found} values for {expected} variables")]
    PointSize {
        /// The programme's variables.
        expected: usize,
        /// The point's values.
        found: usize,
    },
    /// There is not one multiplier for every row.
    #[error("{found} multipliers for {expected} rows")]
    MultipliersSize {
        /// The programme's rows.
        expected: usize,
        /// The multipliers.
        found: usize,
    },
    /// A value is outside its variable's bounds.
    #[error("variable {variable}: its value is out of bounds")]
    OutOfBounds {
        /// The variable's index.
        variable: usize,
    },
    /// The point violates a row.
    #[error("row {row}: the point violates it")]
    RowViolated {
        /// The row's index.
        row: usize,
    },
    /// A row that says *at most* has a negative multiplier.
    #[error("row {row}: its multiplier is negative")]
    NegativeMultiplier {
        /// The row's index.
        row: usize,
    },
    /// The multipliers do not show that there is no feasible point.
    #[error("the multipliers leave room for a feasible point")]
    NotInfeasible,
}

/// Checks a certificate: the point satisfies every row and bound, and the multipliers
/// prove their upper bound.
///
/// # Errors
/// [`Refusal`], the first reason found.
pub fn check(programme: &LinearProgramme, certificate: &Certificate) -> Result<Certified, Refusal> {
    let value = value(programme, &certificate.point)?;
    let bound = bound(programme, &programme.gains, &certificate.multipliers)?;
    Ok(Certified { value, bound })
}

/// Checks a proof that no point satisfies all rows and bounds: multipliers by which the
/// constant objective 0 would be bounded by less than 0.
///
/// # Errors
/// [`Refusal`] if they prove no such thing.
pub fn check_infeasible(programme: &LinearProgramme, multipliers: &[Rational]) -> Result<(), Refusal> {
    let nothing = vec![Rational::zero(); programme.variables()];
    let bound = bound(programme, &nothing, multipliers)?;
    if bound.is_negative() { Ok(()) } else { Err(Refusal::NotInfeasible) }
}

/// The objective at a feasible point.
fn value(programme: &LinearProgramme, point: &[Rational]) -> Result<Rational, Refusal> {
    if point.len() != programme.variables() {
        return Err(Refusal::PointSize { expected: programme.variables(), found: point.len() });
    }
    let bounds = programme.lower.iter().zip(&programme.upper);
    for (variable, (value, (lower, upper))) in point.iter().zip(bounds).enumerate() {
        if value < lower || value > upper {
            return Err(Refusal::OutOfBounds { variable });
        }
    }
    for (row, constraint) in programme.rows.iter().enumerate() {
        let sum = constraint.at(point);
        let kept = match constraint.relation {
            Relation::AtMost => sum <= constraint.limit,
            Relation::Equal => sum == constraint.limit,
        };
        if !kept {
            return Err(Refusal::RowViolated { row });
        }
    }
    Ok(point.iter().zip(&programme.gains).map(|(value, gain)| value * gain).sum())
}

/// Adds `multiplier * (limit - sum)`, which is not negative at a feasible point, for every
/// row to the objective, then takes each variable at its better bound.
fn bound(
    programme: &LinearProgramme,
    gains: &[Rational],
    multipliers: &[Rational],
) -> Result<Rational, Refusal> {
    if multipliers.len() != programme.rows.len() {
        return Err(Refusal::MultipliersSize { expected: programme.rows.len(), found: multipliers.len() });
    }
    let mut total = Rational::zero();
    let mut rest = gains.to_vec();
    for (row, (constraint, multiplier)) in programme.rows.iter().zip(multipliers).enumerate() {
        if constraint.relation == Relation::AtMost && multiplier.is_negative() {
            return Err(Refusal::NegativeMultiplier { row });
        }
        total += multiplier * &constraint.limit;
        for (variable, factor) in &constraint.terms {
            if let Some(gain) = rest.get_mut(variable.0) {
                *gain -= multiplier * factor;
            }
        }
    }
    for (gain, (lower, upper)) in rest.iter().zip(programme.lower.iter().zip(&programme.upper)) {
        total += gain * if gain.is_negative() { lower } else { upper };
    }
    Ok(total)
}
