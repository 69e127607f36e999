//! The certificate checker refuses what proves nothing, and the solver's certificates pass
//! it: against brute force over the vertices of random programmes.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may panic")]

use proptest::prelude::*;
use selfneg_model::exact::{
    Attempt, Certificate, LinearProgramme, Rational, Refusal, check, check_infeasible, rational, solve,
};

/// max 3 a + 2 b, a + b <= 4, a + 3 b <= 6, 0 <= a, b <= 3; the best is 3 * 3 + 2 * 1 = 11.
fn small() -> (LinearProgramme, Certificate) {
    let mut programme = LinearProgramme::new();
    let a = programme.variable(rational(0), rational(3), rational(3));
    let b = programme.variable(rational(0), rational(3), rational(2));
    programme.at_most([(a, rational(1)), (b, rational(1))], rational(4));
    programme.at_most([(a, rational(1)), (b, rational(3))], rational(6));
    let certificate =
        Certificate { point: vec![rational(3), rational(1)], multipliers: vec![rational(2), rational(0)] };
    (programme, certificate)
}

#[test]
fn a_right_certificate_proves_the_optimum() {
    let (programme, certificate) = small();
    let certified = check(&programme, &certificate).unwrap();
    assert_eq!((certified.value.clone(), certified.gap()), (rational(11), rational(0)));
    assert!(certified.is_optimal());
}

#[test]
fn a_corrupted_point_is_refused() {
    let (programme, certificate) = small();
    for (variable, value, out_of_bounds) in [(0, 4, true), (0, -1, true), (1, 2, false)] {
        let mut corrupted = certificate.clone();
        corrupted.point[variable] = rational(value);
        match check(&programme, &corrupted).unwrap_err() {
            Refusal::OutOfBounds { .. } => assert!(out_of_bounds),
            Refusal::RowViolated { row: 0 | 1, .. } => assert!(!out_of_bounds),
            other => panic!("{other}"),
        }
    }
    let mut corrupted = certificate;
    corrupted.point.pop();
    assert_eq!(check(&programme, &corrupted).unwrap_err(), Refusal::PointSize { expected: 2, found: 1 });
}

#[test]
fn corrupted_multipliers_are_refused_or_prove_no_optimum() {
    let (programme, certificate) = small();
    let mut negative = certificate.clone();
    negative.multipliers[1] = rational(-1);
    assert!(matches!(check(&programme, &negative).unwrap_err(), Refusal::NegativeMultiplier { row: 1, .. }));
    let mut missing = certificate.clone();
    missing.multipliers.pop();
    assert_eq!(check(&programme, &missing).unwrap_err(), Refusal::MultipliersSize { expected: 2, found: 1 });
    for (row, multiplier) in [(0, 0), (0, 1), (0, 4), (1, 1)] {
        let mut weaker = certificate.clone();
        weaker.multipliers[row] = rational(multiplier);
        let certified = check(&programme, &weaker).unwrap();
        assert!(certified.gap() > rational(0) && !certified.is_optimal(), "row {row} times {multiplier}");
    }
}

#[test]
fn an_equation_must_hold_exactly() {
    let mut programme = LinearProgramme::new();
    let a = programme.variable(rational(0), rational(1), rational(1));
    programme.equal([(a, rational(3))], rational(1));
    let point = |numerator, denominator| Certificate {
        point: vec![Rational::new(i64::into(numerator), i64::into(denominator))],
        multipliers: vec![Rational::new(1.into(), 3.into())],
    };
    assert!(check(&programme, &point(1, 3)).unwrap().is_optimal());
    assert!(matches!(
        check(&programme, &point(333_333_333, 1_000_000_000)).unwrap_err(),
        Refusal::RowViolated { row: 0, .. }
    ));
}

#[test]
fn infeasibility_needs_a_proof() {
    let mut programme = LinearProgramme::new();
    let a = programme.variable(rational(1), rational(5), rational(0));
    programme.at_most([(a, rational(2))], rational(1));
    assert_eq!(check_infeasible(&programme, &[rational(1)]), Ok(()));
    assert!(check_infeasible(&programme, &[rational(0)]).is_err());
    assert!(check_infeasible(&programme, &[rational(-1)]).is_err());
    assert!(matches!(solve(&programme).unwrap(), Attempt::Infeasible { .. }));
    let (feasible, certificate) = small();
    assert!(check_infeasible(&feasible, &certificate.multipliers).is_err());
}

#[test]
fn a_programme_without_variables_is_worth_nothing() {
    let Attempt::Feasible { certified, .. } = solve(&LinearProgramme::new()).unwrap() else { panic!() };
    assert_eq!((certified.value, certified.bound), (rational(0), rational(0)));
    for (limit, feasible) in [(0, true), (1, false), (-1, false)] {
        let mut programme = LinearProgramme::new();
        programme.equal([], rational(limit));
        assert_eq!(matches!(solve(&programme).unwrap(), Attempt::Feasible { .. }), feasible);
    }
}

/// A programme in three variables: its optimum is at a point where three of the rows and
/// bounds hold with equality.
#[derive(Clone, Debug)]
struct Random {
    gains: [i64; 3],
    rows: Vec<([i64; 3], i64)>,
}

const LOWER: i64 = 0;
const UPPER: i64 = 5;

impl Random {
    fn programme(&self) -> LinearProgramme {
        let mut programme = LinearProgramme::new();
        let variables = self.gains.map(|g| programme.variable(rational(LOWER), rational(UPPER), rational(g)));
        for (factors, limit) in &self.rows {
            let terms = variables.iter().zip(factors).map(|(&v, &f)| (v, rational(f)));
            programme.at_most(terms, rational(*limit));
        }
        programme
    }

    /// The best vertex, by Cramer's rule over all triples of planes.
    fn brute_force(&self) -> Option<Rational> {
        let mut planes = self.rows.clone();
        for d in 0..3 {
            let mut unit = [0; 3];
            unit[d] = 1;
            planes.push((unit, UPPER));
            unit[d] = -1;
            planes.push((unit, -LOWER));
        }
        let mut best = None;
        for i in 0..planes.len() {
            for j in 0..i {
                for k in 0..j {
                    let (m, right): (Vec<_>, Vec<_>) = [i, j, k].map(|p| planes[p]).into_iter().unzip();
                    let m = [m[0], m[1], m[2]];
                    let whole = determinant(m);
                    if whole == 0 {
                        continue;
                    }
                    let at = |column: usize| {
                        let mut replaced = m;
                        for row in 0..3 {
                            replaced[row][column] = right[row];
                        }
                        Rational::new(determinant(replaced).into(), whole.into())
                    };
                    let point = [at(0), at(1), at(2)];
                    let dot = |factors: &[i64; 3]| -> Rational {
                        factors.iter().zip(&point).map(|(&f, x)| rational(f) * x).sum()
                    };
                    if planes.iter().all(|(factors, limit)| dot(factors) <= rational(*limit)) {
                        best = best.max(Some(dot(&self.gains)));
                    }
                }
            }
        }
        best
    }
}

fn determinant(m: [[i64; 3]; 3]) -> i64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn random() -> impl Strategy<Value = Random> {
    let row = ([-4_i64..=4, -4..=4, -4..=4], -6_i64..=12);
    ([-5_i64..=5, -5..=5, -5..=5], prop::collection::vec(row, 0..6))
        .prop_map(|(gains, rows)| Random { gains, rows })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_certified_optimum_is_the_best_vertex(random in random()) {
        let programme = random.programme();
        match (solve(&programme).unwrap(), random.brute_force()) {
            (Attempt::Feasible { certificate, certified }, Some(best)) => {
                prop_assert_eq!(&certified.value, &best);
                prop_assert!(certified.is_optimal());
                prop_assert_eq!(check(&programme, &certificate).unwrap(), certified);
            }
            (Attempt::Infeasible { multipliers }, None) => {
                prop_assert_eq!(check_infeasible(&programme, &multipliers), Ok(()));
            }
            (solved, best) => prop_assert!(false, "{solved:?} but brute force finds {best:?}"),
        }
    }
}
