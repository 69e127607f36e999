//! Linear programmes solved in floating point and certified in exact rationals.

mod certificate;
mod elimination;
mod programme;
mod rational;
mod solve;

pub use certificate::{Certificate, Certified, Refusal, check, check_infeasible};
pub use programme::{LinearProgramme, Relation, Row, Variable};
pub use rational::{Rational, decimal, fraction_near, rational};
pub use solve::{Attempt, SolveError, solve};
