//! Users as plain data that outlives the search that found them.

use std::panic::{AssertUnwindSafe, catch_unwind};

use selfneg_core::{Activation, Condition, Disposition, Options, Rank, Side};

use crate::case::{OpenCase, OpenUser};
use crate::engine::Engine;
use crate::property::{Judgement, Property, Second, Trial};
use crate::transcript::{Memory, Round};

/// One user's data.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct OwnedUser {
    /// The ranks, by disposition.
    pub ranks: Vec<Rank>,
    /// The true conditions, in order of disclosure.
    pub conditions: Vec<Condition>,
    /// How often the goal mentions each disposition.
    pub goal: Vec<u8>,
}

impl OwnedUser {
    /// The user as a statement takes it; `None` if it has more conditions than
    /// [`MAX_ITEMS`](selfneg_core::MAX_ITEMS).
    #[must_use]
    pub fn open(&self) -> Option<OpenUser<'_>> {
        OpenUser::new(&self.ranks, &self.conditions, &self.goal).ok()
    }

    /// What "small" means for a counterexample: fewer conditions, then a smaller sum of
    /// ranks, then lexicographically.
    #[must_use]
    pub fn size(&self) -> (usize, u64) {
        (self.conditions.len(), self.ranks.iter().map(|rank| u64::from(rank.0)).sum())
    }
}

/// Two users and the rules.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnedCase {
    /// The dispositions that each condition activates.
    pub activation: Vec<Vec<Disposition>>,
    /// The user whom the robot is serving.
    pub current: OwnedUser,
    /// The user who asks for something else.
    pub interrupting: OwnedUser,
}

impl OwnedCase {
    /// Calls `look` with the case as a statement takes it; `None` if `selfneg_core`
    /// refuses the rules or a user.
    pub fn open<T>(&self, look: impl FnOnce(&OpenCase<'_>) -> T) -> Option<T> {
        let rows: Vec<&[Disposition]> = self.activation.iter().map(Vec::as_slice).collect();
        let activation = Activation::new(&rows).ok()?;
        let (current, interrupting) = (self.current.open()?, self.interrupting.open()?);
        Some(look(&OpenCase { activation, current, interrupting }))
    }

    /// The user on `side`.
    #[must_use]
    pub fn user(&self, side: Side) -> &OwnedUser {
        match side {
            Side::Current => &self.current,
            Side::Interrupting => &self.interrupting,
        }
    }
}

/// The second version of one user in a two-run property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Altered {
    /// Which of [`Counterexample::users`] it replaces.
    pub index: usize,
    /// What it is replaced by.
    pub user: OwnedUser,
}

/// A case that refutes a property, in full: anyone can run it again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counterexample {
    /// The dispositions that each condition activates.
    pub activation: Vec<Vec<Disposition>>,
    /// The users by arrival: the current one, then the one or two who interrupt.
    pub users: Vec<OwnedUser>,
    /// What differs in the second run of a two-run property.
    pub altered: Option<Altered>,
    /// The variant.
    pub options: Options,
}

impl Counterexample {
    /// What the case says of `property` with `engine` doing the negotiating. It is vacuous
    /// if it is not a case of two users, or one that `selfneg_core` refuses.
    pub fn judge<E: Engine>(&self, property: Property, engine: &E) -> Judgement {
        let [current, interrupting] = self.users.as_slice() else { return Judgement::Vacuous };
        let case = OwnedCase {
            activation: self.activation.clone(),
            current: current.clone(),
            interrupting: interrupting.clone(),
        };
        let mut second = case.clone();
        let mut side = Side::Current;
        if let Some(altered) = &self.altered {
            match altered.index {
                0 => second.current = altered.user.clone(),
                _ => {
                    second.interrupting = altered.user.clone();
                    side = Side::Interrupting;
                }
            }
        }
        judge(property, engine, &case, (&second, side), &self.options)
    }
}

/// What a case, with a second one that differs on the given side, says of `property`.
pub(crate) fn judge<E: Engine>(
    property: Property,
    engine: &E,
    case: &OwnedCase,
    (second, side): (&OwnedCase, Side),
    options: &Options,
) -> Judgement {
    let conditions = |case: &OwnedCase| case.current.conditions.len() + case.interrupting.conditions.len();
    let mut first_room = vec![Round::BLANK; conditions(case) + 4];
    let mut second_room = vec![Round::BLANK; conditions(second) + 4];
    let mut memory = Memory { first: &mut first_room, second: &mut second_room };
    let judgement = case.open(|case| {
        second.open(|second| {
            let trial = Trial { case: *case, second: Second { case: *second, side }, options: *options };
            guarded(property, engine, &trial, &mut memory)
        })
    });
    judgement.flatten().unwrap_or(Judgement::Vacuous)
}

/// A panic refutes a property as any other wrong answer does.
pub(crate) fn guarded<E: Engine>(
    property: Property,
    engine: &E,
    trial: &Trial<'_>,
    memory: &mut Memory<'_>,
) -> Judgement {
    catch_unwind(AssertUnwindSafe(|| property.check(engine, trial, memory))).unwrap_or(Judgement::Fails)
}
