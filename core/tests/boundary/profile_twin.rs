//! Whoever made the profile may read the ranks it was made from.
use selfneg_core::{EthicalProfile, Rank};

fn ranks<'a>((_profile, ranks): (EthicalProfile<'a>, &'a [Rank])) -> &'a [Rank] {
    ranks
}

fn main() {
    let own = [Rank(5)];
    ranks((EthicalProfile::new(&own), &own));
}
