//! Concrete users who refute what does not hold: for every property and variant that is
//! expected to fail, at least one of these does, and whoever runs it can see why.

use selfneg_core::{Activation, Condition, Disposition, Options, Rank, Side};

use crate::case::{OpenCase, OpenUser};
use crate::engine::Engine;
use crate::property::{Judgement, Property, Second, Trial};
use crate::transcript::{Memory, Round};

/// A user of a witness. Its goal implies every disposition.
#[derive(Clone, Copy, Debug)]
pub struct User {
    /// The ranks, by disposition.
    pub ranks: &'static [Rank],
    /// The true conditions, in order of disclosure.
    pub conditions: &'static [Condition],
}

/// A case that refutes a property under some variants.
#[derive(Clone, Copy, Debug)]
pub struct Witness {
    /// The property.
    pub property: Property,
    /// The dispositions that each condition activates.
    pub rows: &'static [&'static [Disposition]],
    /// The user whom the robot is serving.
    pub current: User,
    /// The user who asks for something else.
    pub interrupting: User,
    /// What differs in the second case, if the property needs one.
    pub second: Option<(Side, User)>,
}

impl User {
    fn open(&self) -> Option<OpenUser<'static>> {
        OpenUser::new(self.ranks, self.conditions, &[1; 5]).ok()
    }
}

impl Witness {
    /// Whether it refutes its property under `options`, with `engine` doing the
    /// negotiating.
    pub fn refutes<E: Engine>(&self, engine: &E, options: &Options) -> bool {
        let (Ok(activation), Some(current), Some(interrupting)) =
            (Activation::new(self.rows), self.current.open(), self.interrupting.open())
        else {
            return false;
        };
        let case = OpenCase { activation, current, interrupting };
        let second = match self.second {
            None => Second { case, side: Side::Current },
            Some((side, user)) => match user.open() {
                Some(user) => Second { case: case.with(side, user), side },
                None => return false,
            },
        };
        let (mut first_room, mut second_room) = ([Round::BLANK; 12], [Round::BLANK; 12]);
        let mut memory = Memory { first: &mut first_room, second: &mut second_room };
        let trial = Trial { case, second, options: *options };
        self.property.check(engine, &trial, &mut memory) == Judgement::Fails
    }
}

/// Whether a witness of `property` refutes it under `options`.
pub fn refuted<E: Engine>(property: Property, engine: &E, options: &Options) -> bool {
    let mut i = 0;
    while let Some(witness) = WITNESSES.get(i) {
        if witness.property as u8 == property as u8 && witness.refutes(engine, options) {
            return true;
        }
        i += 1;
    }
    false
}

const R0: Rank = Rank(0);
const R1: Rank = Rank(1);
const R3: Rank = Rank(3);
const C0: Condition = Condition(0);
const C1: Condition = Condition(1);
const C2: Condition = Condition(2);
const D0: Disposition = Disposition(0);
const D1: Disposition = Disposition(1);
const D2: Disposition = Disposition(2);
const D3: Disposition = Disposition(3);

/// Each condition activates the disposition of its number.
const SINGLE: &[&[Disposition]] = &[&[D0], &[D1], &[D2]];
/// The first two conditions share a disposition.
const WOVEN: &[&[Disposition]] = &[&[D0, D1], &[D1, D2], &[D3]];

/// The witnesses, found by enumeration: the smallest ones of the domains of
/// `enumeration::Domain::of`, as few as refute every variant.
pub const WITNESSES: &[Witness] = &[
    Witness {
        property: Property::ExactTermination,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R0], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[] },
        second: None,
    },
    Witness {
        property: Property::ExactTermination,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[C0] },
        interrupting: User { ranks: &[R1, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::ExactTermination,
        rows: SINGLE,
        current: User { ranks: &[R0, R1, R3], conditions: &[C1] },
        interrupting: User { ranks: &[R0, R1, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::ExactTermination,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[C0] },
        interrupting: User { ranks: &[R1, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::RoleSymmetry,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[C0] },
        interrupting: User { ranks: &[R1, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::RoleSymmetry,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::RoleSymmetryException,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[C0] },
        interrupting: User { ranks: &[R1, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::RoleSymmetryException,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::Unanimity,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R1], conditions: &[C0, C2] },
        second: None,
    },
    Witness {
        property: Property::OneSidedOptimality,
        rows: SINGLE,
        current: User { ranks: &[R0, R1, R3], conditions: &[C1] },
        interrupting: User { ranks: &[R0, R1, R0], conditions: &[C2] },
        second: None,
    },
    Witness {
        property: Property::HideProofness,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[C0, C1] },
        interrupting: User { ranks: &[R0, R3, R0], conditions: &[C0, C2] },
        second: Some((Side::Current, User { ranks: &[R0, R0, R3], conditions: &[C1] })),
    },
    Witness {
        property: Property::HideProofness,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[C0, C1] },
        interrupting: User { ranks: &[R0, R3, R0], conditions: &[C2] },
        second: Some((Side::Current, User { ranks: &[R0, R0, R3], conditions: &[C1] })),
    },
    Witness {
        property: Property::HideProofness,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[C0, C2] },
        second: Some((Side::Interrupting, User { ranks: &[R0, R0, R0], conditions: &[C2] })),
    },
    Witness {
        property: Property::HidingNeedsDeference,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R0], conditions: &[C0, C1] },
        interrupting: User { ranks: &[R0, R1, R0], conditions: &[C0] },
        second: Some((Side::Current, User { ranks: &[R0, R0, R0], conditions: &[C1] })),
    },
    Witness {
        property: Property::HidingNeedsDeference,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R1], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[C0, C2] },
        second: Some((Side::Interrupting, User { ranks: &[R0, R0, R0], conditions: &[C2] })),
    },
    Witness {
        property: Property::SortedHideProofness,
        rows: WOVEN,
        current: User { ranks: &[R0, R3, R0, R3], conditions: &[C0, C1] },
        interrupting: User { ranks: &[R0, R3, R3, R0], conditions: &[C0, C2] },
        second: Some((Side::Current, User { ranks: &[R0, R3, R0, R3], conditions: &[C1] })),
    },
    Witness {
        property: Property::SortedHideProofness,
        rows: WOVEN,
        current: User { ranks: &[R0, R3, R3, R0], conditions: &[C2] },
        interrupting: User { ranks: &[R0, R0, R0, R3], conditions: &[C0, C1] },
        second: Some((Side::Interrupting, User { ranks: &[R0, R0, R0, R3], conditions: &[C1] })),
    },
    Witness {
        property: Property::SortedHideProofness,
        rows: WOVEN,
        current: User { ranks: &[R0, R3, R3, R0], conditions: &[C0] },
        interrupting: User { ranks: &[R0, R0, R0, R0], conditions: &[C0, C1] },
        second: Some((Side::Interrupting, User { ranks: &[R0, R0, R0, R0], conditions: &[C1] })),
    },
    Witness {
        property: Property::OrderIndependence,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[C0, C1] },
        interrupting: User { ranks: &[R0, R3, R0], conditions: &[C2] },
        second: Some((Side::Current, User { ranks: &[R0, R0, R3], conditions: &[C1, C0] })),
    },
    Witness {
        property: Property::OrderIndependence,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[C0] },
        interrupting: User { ranks: &[R3, R0, R0], conditions: &[C1, C2] },
        second: Some((Side::Interrupting, User { ranks: &[R3, R0, R0], conditions: &[C2, C1] })),
    },
    Witness {
        property: Property::OrderNeedsDeference,
        rows: SINGLE,
        current: User { ranks: &[R0, R0, R3], conditions: &[] },
        interrupting: User { ranks: &[R0, R0, R0], conditions: &[C0, C2] },
        second: Some((Side::Interrupting, User { ranks: &[R0, R0, R0], conditions: &[C2, C0] })),
    },
    Witness {
        property: Property::MisreportProofness,
        rows: SINGLE,
        current: User { ranks: &[R0, R3], conditions: &[] },
        interrupting: User { ranks: &[R0, R0], conditions: &[C1] },
        second: Some((Side::Current, User { ranks: &[R0, R0], conditions: &[] })),
    },
];
