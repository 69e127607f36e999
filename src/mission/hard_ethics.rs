//! *Hard ethics*: predefined emergencies, decided before and over any negotiation.

use zeroize::Zeroize;

use super::event::{CategoryId, Evidence, Place};
use super::memory::{Cell, Cells, nonzero};
use super::specification::{MissionRules, Proof};

/// Emergencies that are certain and wait for a safe point or for a graver one to end, in
/// order of arrival.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct HardEthics {
    waiting: Cells<Pending>,
}

/// A certain emergency.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
struct Pending {
    /// 0: no emergency; n: the n-th category, from 1.
    category: u32,
    place: u32,
}

impl Cell for Pending {
    fn vacant() -> Self {
        Self { category: 0, place: 0 }
    }

    fn wipe(&mut self) {
        self.category.zeroize();
        self.place.zeroize();
    }

    fn residue(&self) -> usize {
        nonzero(&self.category.to_ne_bytes()).saturating_add(nonzero(&self.place.to_ne_bytes()))
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.extend(self.category.to_ne_bytes());
        into.extend(self.place.to_ne_bytes());
    }
}

impl Pending {
    fn category(&self) -> Option<CategoryId> {
        self.category.checked_sub(1).and_then(|nth| u16::try_from(nth).ok()).map(CategoryId)
    }
}

/// Whether this evidence is what the category needs. A claim alone never is.
pub(super) fn is_certain(category: CategoryId, evidence: Evidence, rules: &MissionRules) -> bool {
    let Some((category, _)) = rules.category_of(category) else { return false };
    match category.proof {
        Proof::Sensed => evidence == Evidence::Sensed,
        Proof::Verified => evidence == Evidence::Verified,
    }
}

/// How grave a category is.
pub(super) fn gravity(category: CategoryId, rules: &MissionRules) -> u8 {
    rules.category_of(category).map_or(0, |(category, _)| category.gravity)
}

impl HardEthics {
    pub(super) fn new(rules: &MissionRules) -> Self {
        Self { waiting: Cells::new(usize::from(rules.limits().emergencies)) }
    }

    /// Keeps a certain emergency; false if there is no room.
    pub(super) fn keep(&mut self, category: CategoryId, place: Place) -> bool {
        match self.waiting.all_mut().iter_mut().find(|cell| cell.category == 0) {
            Some(cell) => {
                cell.category = u32::from(category.0).saturating_add(1);
                cell.place = place.0;
                true
            }
            None => false,
        }
    }

    /// Puts an emergency back that a graver one has displaced: it arrived before all that
    /// wait. False if there is no room.
    pub(super) fn keep_first(&mut self, category: CategoryId, place: Place) -> bool {
        let cells = self.waiting.all_mut();
        if cells.last().is_none_or(|last| last.category != 0) {
            return false;
        }
        cells.rotate_right(1);
        self.keep(category, place)
    }

    /// Takes the gravest out, of these the earliest.
    pub(super) fn take_gravest(&mut self, rules: &MissionRules) -> Option<(CategoryId, Place)> {
        let category = self.gravest(rules)?;
        Some((category, self.take(category)?))
    }

    /// The gravest.
    pub(super) fn gravest(&self, rules: &MissionRules) -> Option<CategoryId> {
        self.waiting
            .all()
            .iter()
            .filter_map(Pending::category)
            .reduce(|first, next| if gravity(next, rules) > gravity(first, rules) { next } else { first })
    }

    /// Takes the earliest of this category out.
    fn take(&mut self, category: CategoryId) -> Option<Place> {
        let at = self.waiting.all().iter().position(|cell| cell.category() == Some(category))?;
        let place = self.waiting.all().get(at).map(|cell| Place(cell.place));
        if let Some(rest) = self.waiting.all_mut().get_mut(at..) {
            if let Some(cell) = rest.first_mut() {
                cell.wipe();
            }
            rest.rotate_left(1);
        }
        place
    }

    pub(super) fn residue(&self) -> usize {
        self.waiting.residue()
    }
}
