//! What the tests of the program share: folders to give it, ways to run it, and a second
//! opinion on what it should decide.
#![allow(dead_code, reason = "every test file uses its own part")]

pub(crate) mod folders;
pub(crate) mod naive;
pub(crate) mod program;
