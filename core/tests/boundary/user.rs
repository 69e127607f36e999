//! Reading the profile of a user.
use selfneg_core::{EthicalProfile, User};

fn profile<'a>(user: User<'a>) -> EthicalProfile<'a> {
    user.profile
}

fn main() {
    let _ = profile;
}
