//! The conditions in `transcript-locality` are all needed: without each of them a user's
//! undisclosed data does change the transcript, so the statement is as strong as it can be.

use selfneg_core::{Activation, Condition, Disposition, Options, QuitRule, Rank, Side, TieRule};
use selfneg_proofs::case::{OpenCase, OpenUser};
use selfneg_proofs::engine::{Core, Engine};
use selfneg_proofs::property::{Judgement, Property, Second, Trial};
use selfneg_proofs::transcript::{Memory, Recorder, Round};

/// Condition 0 is worth 1 to the current user, the others nothing to anyone.
const ROWS: &[&[Disposition]] = &[&[Disposition(0)], &[], &[], &[]];

/// Gives the current user condition 3 too, which nobody values, and says whether the
/// transcript changed and what the property makes of it.
fn add_to_current(
    current: &[Condition],
    interrupting: &[Condition],
    options: Options,
) -> Option<(bool, Judgement)> {
    let (ranks, nothing) = ([Rank(1)], [Rank(0)]);
    let goal = [1];
    let mut longer = current.to_vec();
    longer.push(Condition(3));
    let case = OpenCase {
        activation: Activation::new(ROWS).ok()?,
        current: OpenUser::new(&ranks, current, &goal).ok()?,
        interrupting: OpenUser::new(&nothing, interrupting, &goal).ok()?,
    };
    let second = Second {
        case: case.with(Side::Current, OpenUser::new(&ranks, &longer, &goal).ok()?),
        side: Side::Current,
    };
    let (mut first_room, mut second_room) = ([Round::BLANK; 16], [Round::BLANK; 16]);
    let mut first = Recorder::new(&mut first_room);
    Core.negotiate(&case, &options, &mut first);
    let mut again = Recorder::new(&mut second_room);
    Core.negotiate(&second.case, &options, &mut again);
    let changed = !first.is_same(&again);
    let (mut first_room, mut second_room) = ([Round::BLANK; 16], [Round::BLANK; 16]);
    let mut memory = Memory { first: &mut first_room, second: &mut second_room };
    Some((changed, Property::TranscriptLocality.check(&Core, &Trial { case, second, options }, &mut memory)))
}

const WORTH: Condition = Condition(0);
const PLAIN: Condition = Condition(1);
const OTHER: Condition = Condition(2);

#[test]
fn nothing_may_be_added_to_a_user_who_had_quit() {
    let added = add_to_current(&[], &[PLAIN], Options::default());
    assert_eq!(added, Some((true, Judgement::Vacuous)));
}

#[test]
fn under_held_ties_nothing_may_be_added_to_a_user_without_an_offer_of_that_depth() {
    for tie in [TieRule::Fallback, TieRule::Surplus] {
        let options = Options { tie, ..Options::default() };
        assert_eq!(add_to_current(&[OTHER], &[PLAIN, WORTH], options), Some((true, Judgement::Vacuous)));
    }
    // Under the published rule it may.
    let added = add_to_current(&[OTHER], &[PLAIN, WORTH], Options::default());
    assert_eq!(added, Some((false, Judgement::Holds)));
}

#[test]
fn under_the_literal_quit_rule_the_number_of_conditions_must_stay() {
    let options = Options { quit: QuitRule::Literal, ..Options::default() };
    assert_eq!(add_to_current(&[OTHER], &[PLAIN, WORTH], options), Some((true, Judgement::Vacuous)));
}
