//! Exact numbers, and how floating-point ones become exact.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// A fraction of two whole numbers of any size.
pub type Rational = BigRational;

/// A whole number as a rational.
#[must_use]
pub fn rational<N: Into<BigInt>>(whole: N) -> Rational {
    Rational::from_integer(whole.into())
}

/// The number with so many decimals, rounded to the nearest.
#[must_use]
pub fn decimal(exact: &Rational, places: usize) -> String {
    let scale = (0..places).fold(BigInt::one(), |scale, _| scale * 10);
    let scaled = (exact * Rational::from_integer(scale)).round().to_integer();
    let sign = if scaled.is_negative() { "-" } else { "" };
    let digits = format!("{:0>width$}", scaled.magnitude().to_string(), width = places + 1);
    match digits.split_at_checked(digits.len() - places) {
        Some((whole, part)) if places > 0 => format!("{sign}{whole}.{part}"),
        _ => format!("{sign}{digits}"),
    }
}

/// The nearest floating-point number. Beyond their range: infinite.
pub(super) fn float(exact: &Rational) -> f64 {
    exact.to_f64().unwrap_or(if exact.is_negative() { f64::NEG_INFINITY } else { f64::INFINITY })
}

/// The first convergent of the continued fraction of `float` that is within `tolerance` of
/// it; with tolerance 0 the number itself, exactly. `None` for what is not a finite number.
#[must_use]
pub fn fraction_near(float: f64, tolerance: f64) -> Option<Rational> {
    let exact = Rational::from_float(float)?;
    let tolerance = Rational::from_float(tolerance)?;
    let (mut before, mut last) = ((BigInt::zero(), BigInt::one()), (BigInt::one(), BigInt::zero()));
    let mut rest = exact.clone();
    loop {
        let whole = rest.floor().to_integer();
        let next = (&whole * &last.0 + &before.0, &whole * &last.1 + &before.1);
        let convergent = Rational::new(next.0.clone(), next.1.clone());
        let fraction = rest - Rational::from_integer(whole);
        if (&convergent - &exact).abs() <= tolerance || fraction.is_zero() {
            return Some(convergent);
        }
        rest = fraction.recip();
        before = last;
        last = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_is_found_again() {
        let third = Rational::new(1.into(), 3.into());
        assert_eq!(fraction_near(1.0 / 3.0, 1e-9), Some(third.clone()));
        assert_eq!(fraction_near(-1.0 / 3.0, 1e-9), Some(-third));
        assert_eq!(fraction_near(1e-12, 1e-9), Some(Rational::zero()));
        assert_eq!(fraction_near(f64::NAN, 1e-9), None);
    }

    #[test]
    fn decimals_are_rounded() {
        let written = |numerator: i64, denominator: i64, places| {
            decimal(&Rational::new(numerator.into(), denominator.into()), places)
        };
        assert_eq!(written(1, 3, 4), "0.3333");
        assert_eq!(written(-200, 3, 2), "-66.67");
        assert_eq!(written(1, 200, 3), "0.005");
        assert_eq!(written(7, 2, 0), "4");
    }

    #[test]
    fn without_tolerance_nothing_is_lost() {
        for float in [0.1, -2.5e-7, 1e9 + 0.125] {
            assert_eq!(fraction_near(float, 0.0), Rational::from_float(float));
        }
    }
}
