//! A linear programme with exact data.

use num_traits::Zero;

use super::rational::Rational;

/// Maximise a sum over variables that all lie between two finite bounds, subject to rows.
///
/// That the bounds are finite is what makes certificates simple: *any* non-negative
/// multipliers of the rows then bound the objective from above.
#[derive(Clone, Debug, Default)]
pub struct LinearProgramme {
    pub(super) gains: Vec<Rational>,
    pub(super) lower: Vec<Rational>,
    pub(super) upper: Vec<Rational>,
    pub(super) rows: Vec<Row>,
}

/// A variable of the programme that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Variable(pub(super) usize);

impl Variable {
    /// The place of its value in a point.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0
    }
}

/// `terms relation limit`.
#[derive(Clone, Debug)]
pub struct Row {
    /// Each variable once, with a coefficient that is not zero.
    pub terms: Vec<(Variable, Rational)>,
    /// How the sum stands to the limit.
    pub relation: Relation,
    /// The right-hand side.
    pub limit: Rational,
}

/// How a row's sum stands to its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Not above it.
    AtMost,
    /// Equal to it.
    Equal,
}

impl LinearProgramme {
    /// Without variables and rows.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One more variable in `lower..=upper`, worth `gain` apiece in the objective.
    pub fn variable(&mut self, lower: Rational, upper: Rational, gain: Rational) -> Variable {
        let variable = Variable(self.gains.len());
        self.lower.push(lower);
        self.upper.push(upper);
        self.gains.push(gain);
        variable
    }

    /// One more row: the terms' sum is at most `limit`.
    pub fn at_most<T: IntoIterator<Item = (Variable, Rational)>>(&mut self, terms: T, limit: Rational) {
        self.row(terms, Relation::AtMost, limit);
    }

    /// One more row: the terms' sum is at least `limit`.
    pub fn at_least<T: IntoIterator<Item = (Variable, Rational)>>(&mut self, terms: T, limit: Rational) {
        self.row(terms.into_iter().map(|(variable, factor)| (variable, -factor)), Relation::AtMost, -limit);
    }

    /// One more row: the terms' sum is `limit`.
    pub fn equal<T: IntoIterator<Item = (Variable, Rational)>>(&mut self, terms: T, limit: Rational) {
        self.row(terms, Relation::Equal, limit);
    }

    fn row<T: IntoIterator<Item = (Variable, Rational)>>(
        &mut self,
        terms: T,
        relation: Relation,
        limit: Rational,
    ) {
        let mut sorted: Vec<(Variable, Rational)> = terms.into_iter().collect();
        sorted.sort_by_key(|(variable, _)| *variable);
        let mut unique: Vec<(Variable, Rational)> = Vec::with_capacity(sorted.len());
        for (variable, factor) in sorted {
            match unique.last_mut() {
                Some((last, sum)) if *last == variable => *sum += factor,
                _ => unique.push((variable, factor)),
            }
        }
        unique.retain(|(_, factor)| !factor.is_zero());
        self.rows.push(Row { terms: unique, relation, limit });
    }

    /// How many variables there are.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.gains.len()
    }

    /// The rows, in the order in which they were added.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

impl Row {
    /// The sum of the terms at a point.
    pub(super) fn at(&self, point: &[Rational]) -> Rational {
        self.terms
            .iter()
            .filter_map(|(variable, factor)| point.get(variable.0).map(|value| value * factor))
            .fold(Rational::zero(), |sum, term| sum + term)
    }
}
