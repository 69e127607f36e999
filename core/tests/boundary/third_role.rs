//! A side of one's own, to which either user would have to talk.
use selfneg_core::party::sealed::Sealed;

enum Eavesdropper {}

impl Sealed for Eavesdropper {}

fn main() {}
