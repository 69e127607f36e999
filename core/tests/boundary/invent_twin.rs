//! Making a user, whose party makes the offers.
use selfneg_core::{Condition, EthicalProfile, Implication, Status, TooManyConditions, User};

fn user<'a>(goal: Implication<'a>, conditions: &'a [Condition]) -> Result<User<'a>, TooManyConditions> {
    Ok(User::new(EthicalProfile::new(&[]), Status::new(conditions)?, goal))
}

fn main() {
    let _ = user;
}
