//! An offer is handed to the other side, whichever side that is.
use selfneg_core::party::Role;
use selfneg_core::{Offer, Party, Verdict};

fn relay<'a, R: Role>(receiver: &mut Party<'a, R>, offer: &Offer<'a, R::Other>) -> Verdict {
    receiver.judge(offer, &mut ())
}

fn main() {
    let _ = relay::<selfneg_core::Current>;
}
