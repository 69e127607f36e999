//! The exhaustive sweep against definitions, literal enumeration and known figures.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test that panics fails")]

mod checks;
mod classes;
mod figures;
mod literal;
mod promise;
mod seen;
mod variants;
