//! One party of either side.
use selfneg_core::{Current, Interrupting, Negotiation, Options, Party};

fn between<'a>(one: Party<'a, Current>, other: Party<'a, Interrupting>) -> Negotiation<'a> {
    Negotiation::between(one, other, &Options::default())
}

fn main() {
    let _ = between;
}
