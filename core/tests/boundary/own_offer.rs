//! A user judges its own offer.
use selfneg_core::{Current, Party, Verdict};

fn judge_own(mut current: Party<'_, Current>) -> Option<Verdict> {
    let offer = current.offer()?;
    Some(current.judge(&offer, &mut ()))
}

fn main() {
    let _ = judge_own;
}
