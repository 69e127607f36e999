//! The part of Kani's API that the harnesses use, for type-checking only.

pub use kani_stub_macros::{proof, solver, unwind};

/// A value of a type that has every value.
pub trait Arbitrary {
    /// One of them.
    fn any() -> Self;
}

impl Arbitrary for u8 {
    fn any() -> Self {
        0
    }
}

/// Any value.
pub fn any<T: Arbitrary>() -> T {
    T::any()
}

/// Leaves out the runs in which this does not hold.
pub fn assume(_condition: bool) {}

/// Whether a run can get here with this holding.
#[macro_export]
macro_rules! cover {
    ($condition:expr, $message:literal) => {{
        let _: bool = $condition;
        let _: &'static str = $message;
    }};
}
