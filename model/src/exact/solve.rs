//! Clarabel solves in floating point; the result is made exact, and then checked.
//!
//! An interior-point solver ends near the middle of the set of optima, where every row and
//! bound is either clearly tight or clearly slack. So its answer says which of them are
//! tight; those are solved as equations in rationals, and what the equations leave free
//! keeps its floating-point value. The point and the multipliers found in this way satisfy
//! complementary slackness exactly, which makes their gap 0, if the guess was right. Whether
//! it was, the [check](super::check) decides.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use num_traits::{Signed, Zero};
use thiserror::Error;

use super::certificate::{Certificate, Certified, Refusal, check, check_infeasible};
use super::elimination::{Equation, solution_near};
use super::programme::{LinearProgramme, Relation};
use super::rational::{Rational, float, fraction_near};

/// What is proved of a programme.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Attempt {
    /// A feasible point, and how far at most it is from the best.
    Feasible {
        /// The evidence.
        certificate: Certificate,
        /// What it proves.
        certified: Certified,
    },
    /// There is no feasible point.
    Infeasible {
        /// The evidence, for [`check_infeasible`].
        multipliers: Vec<Rational>,
    },
}

/// Nothing could be proved.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The solver refused the data.
    #[error("the solver refused the programme: {0}")]
    Refused(String),
    /// The solver gave up.
    #[error("the solver ended with {0}")]
    Unsolved(String),
    /// The solver's result could not be made exact.
    #[error("the solver's result could not be certified: {0}")]
    Uncertified(Refusal),
    /// The equations of the rows that seem tight contradict each other.
    #[error("the solver's result could not be made exact")]
    Inexact,
}

/// How far a floating-point number may be from the fraction it becomes, tried in this order:
/// simple fractions if they will do, exactly the number if not.
const TOLERANCES: [f64; 3] = [1e-5, 1e-8, 0.0];

/// The optimum of a programme, with a certificate that has been checked. The gap is almost
/// always 0; where it is not, the point is feasible and the gap is stated.
///
/// # Errors
/// [`SolveError`] if nothing can be proved.
pub fn solve(programme: &LinearProgramme) -> Result<Attempt, SolveError> {
    if programme.variables() == 0 {
        return without_variables(programme);
    }
    let answer = Floating::solve(programme)?;
    if answer.infeasible {
        let mut refusal = None;
        for tolerance in TOLERANCES {
            let multipliers = answer.scaled_multipliers(programme, tolerance);
            match check_infeasible(programme, &multipliers) {
                Ok(()) => return Ok(Attempt::Infeasible { multipliers }),
                Err(error) => refusal = Some(error),
            }
        }
        return Err(refusal.map_or(SolveError::Inexact, SolveError::Uncertified));
    }
    let mut best: Option<(Certificate, Certified)> = None;
    let mut refusal = SolveError::Inexact;
    for tolerance in TOLERANCES {
        let Some(point) = answer.exact_point(programme, tolerance) else { continue };
        let candidates = [
            answer.exact_multipliers(programme, tolerance),
            Some(answer.rounded_multipliers(programme, tolerance)),
        ];
        for multipliers in candidates.into_iter().flatten() {
            let certificate = Certificate { point: point.clone(), multipliers };
            match check(programme, &certificate) {
                Ok(certified) if certified.is_optimal() => {
                    return Ok(Attempt::Feasible { certificate, certified });
                }
                Ok(certified) => {
                    if best.as_ref().is_none_or(|(_, known)| certified.gap() < known.gap()) {
                        best = Some((certificate, certified));
                    }
                }
                Err(error) => refusal = SolveError::Uncertified(error),
            }
        }
    }
    match best {
        Some((certificate, certified)) => Ok(Attempt::Feasible { certificate, certified }),
        None => Err(refusal),
    }
}

/// There is one point, the empty one. The solver takes no such programme.
fn without_variables(programme: &LinearProgramme) -> Result<Attempt, SolveError> {
    let mut multipliers = vec![Rational::zero(); programme.rows.len()];
    let certificate = Certificate { point: Vec::new(), multipliers: multipliers.clone() };
    match check(programme, &certificate) {
        Ok(certified) => Ok(Attempt::Feasible { certificate, certified }),
        Err(Refusal::RowViolated { row }) => {
            if let Some((multiplier, broken)) = multipliers.get_mut(row).zip(programme.rows.get(row)) {
                *multiplier = -broken.limit.signum();
            }
            check_infeasible(programme, &multipliers).map_err(SolveError::Uncertified)?;
            Ok(Attempt::Infeasible { multipliers })
        }
        Err(refusal) => Err(SolveError::Uncertified(refusal)),
    }
}

/// The solver's word.
struct Floating {
    infeasible: bool,
    point: Vec<f64>,
    /// By row of the programme.
    multipliers: Vec<f64>,
    /// By row: whether it holds with equality.
    tight: Vec<bool>,
    /// By variable: at which bound it is.
    pinned: Vec<Option<Bound>>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Bound {
    Lower,
    Upper,
}

impl Floating {
    fn solve(programme: &LinearProgramme) -> Result<Self, SolveError> {
        let layout = Layout::of(programme);
        let (variables, rows) = (programme.variables(), layout.limits.len());
        let objective: Vec<f64> = programme.gains.iter().map(|gain| -float(gain)).collect();
        let (places_of_rows, values): (Vec<(usize, usize)>, Vec<f64>) =
            layout.entries.iter().map(|&(row, column, value)| ((row, column), value)).unzip();
        let (places, columns): (Vec<usize>, Vec<usize>) = places_of_rows.into_iter().unzip();
        let matrix = CscMatrix::new_from_triplets(rows, variables, places, columns, values);
        let cones = [ZeroConeT(layout.equalities), NonnegativeConeT(rows - layout.equalities)];
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 200,
            tol_gap_abs: 1e-10,
            tol_gap_rel: 1e-10,
            tol_feas: 1e-10,
            ..DefaultSettings::default()
        };
        let nothing = CscMatrix::zeros((variables, variables));
        let mut solver = DefaultSolver::new(&nothing, &objective, &matrix, &layout.limits, &cones, settings)
            .map_err(|error| SolveError::Refused(error.to_string()))?;
        solver.solve();
        let solution = solver.solution;
        let infeasible = match solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress => false,
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => true,
            other => return Err(SolveError::Unsolved(format!("{other:?}"))),
        };
        let dual = |row: usize| solution.z.get(row).copied().unwrap_or(0.0);
        let tight = |row: usize| dual(row) > solution.s.get(row).copied().unwrap_or(0.0);
        let pinned = layout
            .bounds
            .iter()
            .map(|&bounds| match bounds {
                BoundRows::Fixed => Some(Bound::Lower),
                BoundRows::Between { lower, upper } if tight(lower) || tight(upper) => {
                    Some(if dual(lower) > dual(upper) { Bound::Lower } else { Bound::Upper })
                }
                BoundRows::Between { .. } => None,
            })
            .collect();
        Ok(Self {
            infeasible,
            multipliers: layout.rows.iter().map(|&row| dual(row)).collect(),
            tight: layout.rows.iter().map(|&row| row < layout.equalities || tight(row)).collect(),
            pinned,
            point: solution.x,
        })
    }

    /// The tight rows as equations in the variables that are at no bound.
    fn exact_point(&self, programme: &LinearProgramme, tolerance: f64) -> Option<Vec<Rational>> {
        let bounds = programme.lower.iter().zip(&programme.upper);
        let guess: Vec<Rational> = self
            .point
            .iter()
            .zip(&self.pinned)
            .zip(bounds)
            .map(|((&value, pinned), (lower, upper))| match pinned {
                Some(Bound::Lower) => Some(lower.clone()),
                Some(Bound::Upper) => Some(upper.clone()),
                None => fraction_near(value, tolerance),
            })
            .collect::<Option<_>>()?;
        let mut unknowns = Vec::new();
        let mut place = vec![None; guess.len()];
        for (variable, slot) in place.iter_mut().enumerate() {
            if self.pinned.get(variable) == Some(&None) {
                *slot = Some(unknowns.len());
                unknowns.push(variable);
            }
        }
        let tight = programme.rows.iter().zip(&self.tight).filter(|(_, tight)| **tight);
        let equations = tight
            .map(|(row, _)| {
                let mut right = row.limit.clone();
                let mut terms = Vec::new();
                for (variable, factor) in &row.terms {
                    match place.get(variable.index()).copied().flatten() {
                        Some(unknown) => terms.push((unknown, factor.clone())),
                        None => right -= factor * guess.get(variable.index())?,
                    }
                }
                Some((terms, right))
            })
            .collect::<Option<Vec<Equation>>>()?;
        let start: Vec<Rational> =
            unknowns.iter().filter_map(|&variable| guess.get(variable).cloned()).collect();
        let solved = solution_near(equations, &start)?;
        let mut point = guess;
        for (variable, value) in unknowns.into_iter().zip(solved) {
            *point.get_mut(variable)? = value;
        }
        Some(point)
    }

    /// Multipliers of the tight rows by which a variable that is at no bound gains nothing.
    fn exact_multipliers(&self, programme: &LinearProgramme, tolerance: f64) -> Option<Vec<Rational>> {
        let rounded = self.rounded_multipliers(programme, tolerance);
        let unknowns: Vec<usize> =
            self.tight.iter().enumerate().filter(|(_, tight)| **tight).map(|(row, _)| row).collect();
        let mut equations: Vec<Equation> =
            programme.gains.iter().map(|gain| (Vec::new(), gain.clone())).collect();
        for (unknown, &row) in unknowns.iter().enumerate() {
            for (variable, factor) in &programme.rows.get(row)?.terms {
                equations.get_mut(variable.index())?.0.push((unknown, factor.clone()));
            }
        }
        let free = equations.into_iter().zip(&self.pinned).filter(|(_, pinned)| pinned.is_none());
        let start: Vec<Rational> = unknowns.iter().filter_map(|&row| rounded.get(row).cloned()).collect();
        let solved = solution_near(free.map(|(equation, _)| equation).collect(), &start)?;
        let mut multipliers = vec![Rational::zero(); programme.rows.len()];
        for (row, value) in unknowns.into_iter().zip(solved) {
            *multipliers.get_mut(row)? = value;
        }
        Some(multipliers)
    }

    /// The solver's multipliers as fractions, none negative that must not be.
    fn rounded_multipliers(&self, programme: &LinearProgramme, tolerance: f64) -> Vec<Rational> {
        self.multipliers
            .iter()
            .zip(&programme.rows)
            .map(|(&multiplier, row)| {
                let fraction = fraction_near(multiplier, tolerance).unwrap_or_else(Rational::zero);
                match row.relation {
                    Relation::AtMost if fraction.is_negative() => Rational::zero(),
                    Relation::AtMost | Relation::Equal => fraction,
                }
            })
            .collect()
    }

    /// The same, the largest made 1: only their ratios matter for a proof of infeasibility.
    fn scaled_multipliers(&self, programme: &LinearProgramme, tolerance: f64) -> Vec<Rational> {
        let largest = self.multipliers.iter().fold(0.0_f64, |most, multiplier| most.max(multiplier.abs()));
        let scale = if largest > 0.0 { largest } else { 1.0 };
        let scaled = Self {
            infeasible: self.infeasible,
            point: Vec::new(),
            multipliers: self.multipliers.iter().map(|multiplier| multiplier / scale).collect(),
            tight: Vec::new(),
            pinned: Vec::new(),
        };
        scaled.rounded_multipliers(programme, tolerance)
    }
}

/// Where the programme's rows and bounds are among the solver's rows, equalities first.
struct Layout {
    equalities: usize,
    entries: Vec<(usize, usize, f64)>,
    limits: Vec<f64>,
    rows: Vec<usize>,
    bounds: Vec<BoundRows>,
}

#[derive(Clone, Copy)]
enum BoundRows {
    /// The two bounds are one number.
    Fixed,
    Between {
        lower: usize,
        upper: usize,
    },
}

impl Layout {
    fn of(programme: &LinearProgramme) -> Self {
        let fixed = programme.lower.iter().zip(&programme.upper).filter(|(lower, upper)| lower == upper);
        let equal = programme.rows.iter().filter(|row| row.relation == Relation::Equal);
        let equalities = fixed.count() + equal.count();
        let mut layout = Self {
            equalities,
            entries: Vec::new(),
            limits: Vec::new(),
            rows: Vec::new(),
            bounds: Vec::new(),
        };
        let mut next = [0, equalities];
        let mut take = |relation: Relation| {
            let [equality, inequality] = &mut next;
            let counter = if relation == Relation::Equal { equality } else { inequality };
            let row = *counter;
            *counter += 1;
            row
        };
        let mut limits = Vec::new();
        for row in &programme.rows {
            let at = take(row.relation);
            layout.rows.push(at);
            limits.push((at, float(&row.limit)));
            for (variable, factor) in &row.terms {
                layout.entries.push((at, variable.index(), float(factor)));
            }
        }
        for (variable, (lower, upper)) in programme.lower.iter().zip(&programme.upper).enumerate() {
            if lower == upper {
                let at = take(Relation::Equal);
                layout.entries.push((at, variable, 1.0));
                limits.push((at, float(lower)));
                layout.bounds.push(BoundRows::Fixed);
            } else {
                let (below, above) = (take(Relation::AtMost), take(Relation::AtMost));
                layout.entries.extend([(below, variable, -1.0), (above, variable, 1.0)]);
                limits.extend([(below, -float(lower)), (above, float(upper))]);
                layout.bounds.push(BoundRows::Between { lower: below, upper: above });
            }
        }
        limits.sort_unstable_by_key(|&(at, _)| at);
        layout.limits = limits.into_iter().map(|(_, limit)| limit).collect();
        layout
    }
}
