//! A user judges the other one's offer.
use selfneg_core::{Current, Interrupting, Party, Verdict};

fn judge_others<'a>(
    mut current: Party<'a, Current>,
    mut interrupting: Party<'a, Interrupting>,
) -> Option<Verdict> {
    let offer = interrupting.offer()?;
    Some(current.judge(&offer, &mut ()))
}

fn main() {
    let _ = judge_others;
}
