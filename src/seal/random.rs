//! Randomness from outside.

use std::io;

/// Unpredictable bytes.
pub trait Random {
    /// Fills the slice.
    ///
    /// # Errors
    /// What the source fails with.
    fn fill(&mut self, bytes: &mut [u8]) -> io::Result<()>;
}

impl<F: FnMut(&mut [u8]) -> io::Result<()>> Random for F {
    fn fill(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self(bytes)
    }
}
