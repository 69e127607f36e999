//! Gauss-Jordan elimination in rationals.

use num_traits::Zero;

use super::rational::Rational;

/// An equation: unknowns by index with their factors, and the right-hand side.
pub(super) type Equation = (Vec<(usize, Rational)>, Rational);

/// The solution of the equations in which every unknown that they leave free has its value
/// of `guess`. `None` if they contradict each other.
pub(super) fn solution_near(equations: Vec<Equation>, guess: &[Rational]) -> Option<Vec<Rational>> {
    let mut solved: Vec<(usize, Vec<Rational>, Rational)> = Vec::new();
    for (terms, right) in equations {
        let mut row = vec![Rational::zero(); guess.len()];
        for (unknown, factor) in terms {
            *row.get_mut(unknown)? += factor;
        }
        let mut right = right;
        for (pivot, earlier, value) in &solved {
            let factor = row.get(*pivot)?.clone();
            subtract(&mut row, &mut right, &factor, earlier, value);
        }
        let Some(pivot) = row.iter().position(|factor| !factor.is_zero()) else {
            if right.is_zero() {
                continue;
            }
            return None;
        };
        let lead = row.get(pivot)?.recip();
        for factor in row.iter_mut().filter(|factor| !factor.is_zero()) {
            *factor *= &lead;
        }
        right *= &lead;
        for (_, earlier, value) in &mut solved {
            let factor = earlier.get(pivot)?.clone();
            subtract(earlier, value, &factor, &row, &right);
        }
        solved.push((pivot, row, right));
    }
    let mut solution = guess.to_vec();
    for (pivot, row, right) in &solved {
        let mut value = right.clone();
        for (unknown, factor) in row.iter().enumerate() {
            if unknown != *pivot && !factor.is_zero() {
                value -= factor * guess.get(unknown)?;
            }
        }
        *solution.get_mut(*pivot)? = value;
    }
    Some(solution)
}

fn subtract(
    row: &mut [Rational],
    right: &mut Rational,
    factor: &Rational,
    other: &[Rational],
    value: &Rational,
) {
    if factor.is_zero() {
        return;
    }
    for (mine, theirs) in row.iter_mut().zip(other) {
        if !theirs.is_zero() {
            *mine -= factor * theirs;
        }
    }
    *right -= factor * value;
}

#[cfg(test)]
mod tests {
    use super::super::rational::rational;
    use super::*;

    #[test]
    fn free_unknowns_keep_their_guess() {
        // a + b = 3, 2 a + 2 b = 6, c = 5
        let equations = vec![
            (vec![(0, rational(1)), (1, rational(1))], rational(3)),
            (vec![(0, rational(2)), (1, rational(2))], rational(6)),
            (vec![(2, rational(1))], rational(5)),
        ];
        let guess = [rational(9), rational(1), rational(9)];
        assert_eq!(solution_near(equations, &guess), Some(vec![rational(2), rational(1), rational(5)]));
    }

    #[test]
    fn a_contradiction_has_no_solution() {
        let equations = vec![(vec![(0, rational(1))], rational(3)), (vec![(0, rational(2))], rational(7))];
        assert_eq!(solution_near(equations, &[rational(0)]), None);
    }
}
