//! Naming the sides there are.
use selfneg_core::Side;
use selfneg_core::party::Role;

fn other<R: Role>() -> Side {
    <R::Other as Role>::SIDE
}

fn main() {
    assert_eq!(other::<selfneg_core::Current>(), Side::Interrupting);
}
