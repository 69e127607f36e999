//! Reading the user, its undisclosed conditions included, from a party.
use selfneg_core::{Interrupting, Party, User};

fn user<'a>(party: Party<'a, Interrupting>) -> User<'a> {
    party.user
}

fn main() {
    let _ = user;
}
