//! A current user's party where the interrupter's is needed.
use selfneg_core::{Current, Negotiation, Options, Party};

fn between<'a>(one: Party<'a, Current>, other: Party<'a, Current>) -> Negotiation<'a> {
    Negotiation::between(one, other, &Options::default())
}

fn main() {
    let _ = between;
}
