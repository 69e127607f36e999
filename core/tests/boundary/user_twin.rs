//! Having a user take part.
use selfneg_core::{Activation, Current, Options, Party, User};

fn party<'a>(user: User<'a>) -> Party<'a, Current> {
    Party::current(user, Activation::EMPTY, &Options::default())
}

fn main() {
    let _ = party;
}
