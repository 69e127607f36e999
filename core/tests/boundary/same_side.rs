//! The offer of one current user is handed to another one, whichever side that is.
use selfneg_core::party::Role;
use selfneg_core::{Offer, Party, Verdict};

fn relay<'a, R: Role>(receiver: &mut Party<'a, R>, offer: &Offer<'a, R>) -> Verdict {
    receiver.judge(offer, &mut ())
}

fn main() {
    let _ = relay::<selfneg_core::Current>;
}
