//! Memory for user data: allocated once, overwritten in place.
//!
//! Every list of user data in the mission is one of these. It never grows, so it leaves no
//! old copy behind; it hands out no owned copies; wiping overwrites every cell of the
//! allocation, not only those in use, by `zeroize`'s volatile writes, which the compiler must
//! not remove. [`Cells::residue`] then reads all of it again.

use selfneg_core::{Condition, Rank};
use zeroize::Zeroize;

/// The longest name, in bytes of UTF-8: of a context label, an attribute, its value, or a
/// condition that the rules do not list.
pub const NAME_BYTES: usize = 64;

/// One cell of user data.
pub(super) trait Cell: Sized {
    /// A cell that holds nothing: all zeroes.
    fn vacant() -> Self;
    /// Overwrites it with zeroes.
    fn wipe(&mut self);
    /// How many of its bytes are not zero.
    fn residue(&self) -> usize;
    /// Its bytes, for tests that look for traces of data.
    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>);
}

/// A fixed number of cells.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct Cells<T: Cell>(Box<[T]>);

impl<T: Cell> Cells<T> {
    pub(super) fn new(number: usize) -> Self {
        Self((0..number).map(|_| T::vacant()).collect())
    }

    pub(super) fn all(&self) -> &[T] {
        &self.0
    }

    pub(super) fn all_mut(&mut self) -> &mut [T] {
        &mut self.0
    }

    pub(super) fn first(&self, number: usize) -> &[T] {
        self.0.get(..number).unwrap_or(&self.0)
    }

    pub(super) fn wipe(&mut self) {
        for cell in &mut self.0 {
            cell.wipe();
        }
    }

    /// How many bytes of the whole allocation are not zero.
    pub(super) fn residue(&self) -> usize {
        self.0.iter().map(Cell::residue).sum()
    }

    #[cfg(test)]
    pub(super) fn bytes(&self, into: &mut Vec<u8>) {
        for cell in &self.0 {
            cell.bytes(into);
        }
    }
}

impl<T: Cell> Drop for Cells<T> {
    fn drop(&mut self) {
        for cell in &mut self.0 {
            cell.wipe();
        }
    }
}

pub(super) fn nonzero(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte != 0).count()
}

/// A name, in place.
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct Name {
    bytes: [u8; NAME_BYTES],
    length: u8,
}

impl std::fmt::Debug for Name {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Name(..)")
    }
}

/// The name is longer than [`NAME_BYTES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooLong;

impl Name {
    /// Copies `text` into this memory.
    pub(super) fn write(&mut self, text: &str) -> Result<(), TooLong> {
        self.wipe();
        let length = u8::try_from(text.len()).map_err(|_| TooLong)?;
        let place = self.bytes.get_mut(..text.len()).ok_or(TooLong)?;
        place.copy_from_slice(text.as_bytes());
        self.length = length;
        Ok(())
    }

    pub(super) fn is(&self, text: &str) -> bool {
        self.written() == text.as_bytes()
    }

    pub(super) fn is_vacant(&self) -> bool {
        self.length == 0
    }

    pub(super) fn written(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or(&[])
    }
}

impl Cell for Name {
    fn vacant() -> Self {
        Self { bytes: [0; NAME_BYTES], length: 0 }
    }

    fn wipe(&mut self) {
        self.bytes.zeroize();
        self.length.zeroize();
    }

    fn residue(&self) -> usize {
        nonzero(&self.bytes).saturating_add(nonzero(&[self.length]))
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.extend(self.bytes);
        into.push(self.length);
    }
}

/// A rank, as the engine reads it.
impl Cell for Rank {
    fn vacant() -> Self {
        Self(0)
    }

    fn wipe(&mut self) {
        self.0.zeroize();
    }

    fn residue(&self) -> usize {
        nonzero(&[self.0])
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.push(self.0);
    }
}

/// A condition, as the engine reads it.
impl Cell for Condition {
    fn vacant() -> Self {
        Self(0)
    }

    fn wipe(&mut self) {
        self.0.zeroize();
    }

    fn residue(&self) -> usize {
        nonzero(&self.0.to_ne_bytes())
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.extend(self.0.to_ne_bytes());
    }
}
