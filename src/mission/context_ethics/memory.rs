//! What one user has told the robot, in the manager's own memory.

use selfneg_core::Rank;
use zeroize::Zeroize;

use super::super::memory::{Cell, Cells, Name, TooLong, nonzero};
use super::super::record::{ActiveProfile, Unusable};
use super::super::specification::MissionRules;
use super::super::user_data::{LOCATION, UserData};
use crate::input::Truth;

/// One user's profiles, status and context, and what follows from them.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct UserMemory {
    /// A name for each profile.
    pub(super) labels: Cells<Name>,
    /// Row by row, a rank for each disposition.
    pub(super) ranks: Cells<Rank>,
    /// In order of disclosure.
    pub(super) status: Cells<Statement>,
    pub(super) context: Cells<Attribute>,
    /// One bit for each inference rule that holds.
    pub(super) inferred: u64,
    pub(super) active: ActiveProfile,
}

/// What a user says of one condition.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct Statement {
    /// The condition's index; one that the rules do not list has an index after theirs.
    pub(super) condition: u16,
    /// 0 where nothing is stated.
    said: u8,
    /// Only of a condition that the rules do not list.
    name: Name,
}

impl Statement {
    const TRUE: u8 = 1;
    const FALSE: u8 = 2;
    const WITHHELD: u8 = 3;

    pub(super) fn is_vacant(&self) -> bool {
        self.said == 0
    }

    pub(super) fn is_true(&self) -> bool {
        self.said == Self::TRUE
    }

    fn say(&mut self, truth: Truth) {
        self.said = match truth {
            Truth::True => Self::TRUE,
            Truth::False => Self::FALSE,
            Truth::Withheld => Self::WITHHELD,
        };
    }
}

impl Cell for Statement {
    fn vacant() -> Self {
        Self { condition: 0, said: 0, name: Name::vacant() }
    }

    fn wipe(&mut self) {
        self.condition.zeroize();
        self.said.zeroize();
        self.name.wipe();
    }

    fn residue(&self) -> usize {
        let numbers = nonzero(&self.condition.to_ne_bytes()).saturating_add(nonzero(&[self.said]));
        numbers.saturating_add(self.name.residue())
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.extend(self.condition.to_ne_bytes());
        into.push(self.said);
        self.name.bytes(into);
    }
}

/// One attribute of a context.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct Attribute {
    name: Name,
    value: Name,
}

impl Cell for Attribute {
    fn vacant() -> Self {
        Self { name: Name::vacant(), value: Name::vacant() }
    }

    fn wipe(&mut self) {
        self.name.wipe();
        self.value.wipe();
    }

    fn residue(&self) -> usize {
        self.name.residue().saturating_add(self.value.residue())
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        self.name.bytes(into);
        self.value.bytes(into);
    }
}

impl From<TooLong> for Unusable {
    fn from(_: TooLong) -> Self {
        Self::NameTooLong
    }
}

impl UserMemory {
    pub(super) fn new(rules: &MissionRules) -> Self {
        let limits = rules.limits();
        let profiles = usize::from(limits.profiles);
        Self {
            labels: Cells::new(profiles),
            ranks: Cells::new(profiles.saturating_mul(rules.bound().dispositions())),
            status: Cells::new(usize::from(limits.conditions)),
            context: Cells::new(usize::from(limits.attributes)),
            inferred: 0,
            active: ActiveProfile::None,
        }
    }

    /// Copies everything of `data` that fits.
    pub(super) fn take(&mut self, data: &UserData, rules: &MissionRules) -> Result<(), Unusable> {
        if data.profiles.len() > self.labels.all().len() {
            return Err(Unusable::TooMuch);
        }
        let dispositions = rules.bound().dispositions();
        for (nth, (profile, label)) in data.profiles.iter().zip(self.labels.all_mut()).enumerate() {
            label.write(profile.label.as_str())?;
            let row = nth.saturating_mul(dispositions);
            for (name, rank) in &profile.ranks {
                let Some(disposition) = rules.bound().disposition(name.as_str()) else { continue };
                let at = row.saturating_add(usize::from(disposition.0));
                if let Some(slot) = self.ranks.all_mut().get_mut(at) {
                    *slot = Rank(*rank);
                }
            }
        }
        for stated in &data.status {
            self.state(stated.condition.as_str(), stated.truth, rules)?;
        }
        for (attribute, value) in &data.context {
            self.set(attribute.as_str(), value.as_str())?;
        }
        Ok(())
    }

    /// Notes what the user says of a condition: in place, or after the others if it is new.
    pub(super) fn state(&mut self, name: &str, truth: Truth, rules: &MissionRules) -> Result<(), Unusable> {
        if rules.is_measured(name) {
            return Ok(());
        }
        let listed = rules.bound().condition(name);
        let known = |statement: &Statement| match listed {
            Some(condition) => {
                !statement.is_vacant() && statement.condition == condition.0 && statement.name.is_vacant()
            }
            None => !statement.is_vacant() && statement.name.is(name),
        };
        let found = self.status.all().iter().position(known);
        let at = found.or_else(|| self.status.all().iter().position(Statement::is_vacant));
        let at = at.ok_or(Unusable::TooMuch)?;
        let statement = self.status.all_mut().get_mut(at).ok_or(Unusable::TooMuch)?;
        if found.is_none() {
            match listed {
                Some(condition) => statement.condition = condition.0,
                None => {
                    statement.name.write(name)?;
                    let index = rules.bound().conditions().saturating_add(at);
                    statement.condition = u16::try_from(index).map_err(|_| Unusable::TooMuch)?;
                }
            }
        }
        statement.say(truth);
        Ok(())
    }

    /// Whether the user has said anything about a listed condition, withholding it included.
    pub(super) fn has_spoken_of(&self, condition: u16) -> bool {
        let same = |statement: &Statement| !statement.is_vacant() && statement.condition == condition;
        self.status.all().iter().any(same)
    }

    /// The name of a condition that the rules do not list.
    pub(super) fn unlisted_name(&self, condition: u16) -> Option<&str> {
        let named = |statement: &&Statement| {
            !statement.is_vacant() && statement.condition == condition && !statement.name.is_vacant()
        };
        let statement = self.status.all().iter().find(named)?;
        std::str::from_utf8(statement.name.written()).ok()
    }

    /// Gives an attribute of the context a value.
    pub(super) fn set(&mut self, attribute: &str, value: &str) -> Result<(), Unusable> {
        let found = self.context.all().iter().position(|cell| cell.name.is(attribute));
        let at = found.or_else(|| self.context.all().iter().position(|cell| cell.name.is_vacant()));
        let cell = at.and_then(|at| self.context.all_mut().get_mut(at)).ok_or(Unusable::TooMuch)?;
        cell.name.write(attribute)?;
        cell.value.write(value)?;
        Ok(())
    }

    pub(super) fn is(&self, attribute: &str, value: &str) -> bool {
        self.context.all().iter().any(|cell| cell.name.is(attribute) && cell.value.is(value))
    }

    pub(super) fn has_location(&self) -> bool {
        self.context.all().iter().any(|cell| cell.name.is(LOCATION))
    }

    pub(super) fn is_at(&self, label: &str) -> bool {
        self.is(LOCATION, label)
    }

    /// Which of the user's profiles is for where the user is.
    pub(super) fn own_profile(&self) -> Option<u16> {
        let place = self.context.all().iter().find(|cell| cell.name.is(LOCATION))?;
        let at = self
            .labels
            .all()
            .iter()
            .position(|label| !label.is_vacant() && label.written() == place.value.written())?;
        u16::try_from(at).ok()
    }

    pub(super) fn gave_no_profile(&self) -> bool {
        self.labels.all().iter().all(Name::is_vacant)
    }

    pub(super) fn wipe(&mut self) {
        self.labels.wipe();
        self.ranks.wipe();
        self.status.wipe();
        self.context.wipe();
        self.inferred.zeroize();
        self.active = ActiveProfile::None;
    }

    pub(super) fn residue(&self) -> usize {
        let active = usize::from(self.active != ActiveProfile::None);
        [
            self.labels.residue(),
            self.ranks.residue(),
            self.status.residue(),
            self.context.residue(),
            nonzero(&self.inferred.to_ne_bytes()),
            active,
        ]
        .into_iter()
        .sum()
    }

    #[cfg(test)]
    pub(super) fn bytes(&self, into: &mut Vec<u8>) {
        self.labels.bytes(into);
        self.ranks.bytes(into);
        self.status.bytes(into);
        self.context.bytes(into);
        into.extend(self.inferred.to_ne_bytes());
    }
}
