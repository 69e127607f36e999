//! The engine has a user's profile in hand, and reads its ranks.
use selfneg_core::{EthicalProfile, Rank};

fn ranks<'a>(profile: EthicalProfile<'a>) -> &'a [Rank] {
    profile.ranks
}

fn main() {
    ranks(EthicalProfile::new(&[Rank(5)]));
}
