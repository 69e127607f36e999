//! What each option changes, on a smallest case. "Smallest" is checked, not claimed: no
//! case of the small domain with fewer conditions, or with as many and a smaller sum of
//! ranks, shows the difference.

mod naive;
mod situation;
mod small_domain;

use std::error::Error;
use std::str::FromStr;

use selfneg_core::{
    Aggregation, Conclusion, Ending, Fallback, Options, Outcome, QuitRule, Side, TieRule, UnknownName,
};

use Ending::{Accepted, BothQuit, HeldOfferStands, LiteralQuit, Tie};
use Side::{Current, Interrupting};
use situation::{Person, Situation};
use small_domain::{size, smallest};

const NONE: Outcome = Outcome::NoAgreement;
const CURRENT: Outcome = Outcome::Agreement(Current);
const INTERRUPTING: Outcome = Outcome::Agreement(Interrupting);

const PUBLISHED: Options = Options {
    quit: QuitRule::Exhausted,
    aggregation: Aggregation::PerCondition,
    tie: TieRule::FirstSender,
    fallback: Fallback::FirstCome,
    willingness: 0,
};
const LITERAL: Options = Options { quit: QuitRule::Literal, ..PUBLISHED };
const PER_DISPOSITION: Options = Options { aggregation: Aggregation::PerDisposition, ..PUBLISHED };
const TIE_FALLBACK: Options = Options { tie: TieRule::Fallback, ..PUBLISHED };
const TIE_SURPLUS: Options = Options { tie: TieRule::Surplus, ..PUBLISHED };
const UTILITARIAN: Options = Options { fallback: Fallback::Utilitarian, ..PUBLISHED };
const WILLING: Options = Options { willingness: 1, ..PUBLISHED };

/// Condition `c` activates disposition `c`, both goals imply both dispositions.
fn one_to_one(interrupting: (&[u8], &[u16]), current: (&[u8], &[u16])) -> Situation {
    let person = |(ranks, status): (&[u8], &[u16])| Person {
        ranks: ranks.to_vec(),
        status: status.to_vec(),
        mentions: vec![1, 1],
    };
    Situation { rows: vec![vec![0], vec![1]], current: person(current), interrupting: person(interrupting) }
}

fn conclusion(outcome: Outcome, rounds: u32, ending: Ending) -> Conclusion {
    Conclusion { outcome, rounds, ending }
}

fn negotiate(situation: &Situation, options: Options) -> Conclusion {
    situation.with(|case| case.negotiate(&options))
}

fn outcome(situation: &Situation, options: Options) -> Outcome {
    negotiate(situation, options).outcome
}

fn served(situation: &Situation, options: Options) -> Side {
    situation.with(|case| case.decide(&options, &mut ()).served)
}

#[test]
fn default_is_the_published_system() {
    assert_eq!(Options::default(), PUBLISHED);
}

/// The current user has one condition, which the interrupter, with none, ranks 1.
#[test]
fn quit_literal_ends_it_before_the_other_user_was_heard() {
    let example = one_to_one((&[1, 0], &[]), (&[0, 0], &[0]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(CURRENT, 2, Accepted));
    assert_eq!(negotiate(&example, LITERAL), conclusion(NONE, 1, LiteralQuit(Interrupting)));
    assert_eq!(size(&example), (1, 1));
    assert_eq!(smallest(2, |s| outcome(s, PUBLISHED) != outcome(s, LITERAL)), Some((1, 1)));
}

/// The smallest case in which both users have something to say: the current user rejects
/// the interrupter's only offer, and has as few itself.
#[test]
fn quit_literal_takes_effect_in_the_round_of_the_rejection() {
    let example = one_to_one((&[0, 1], &[0]), (&[0, 0], &[1]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(CURRENT, 2, Accepted));
    assert_eq!(negotiate(&example, LITERAL), conclusion(NONE, 1, LiteralQuit(Current)));
}

#[test]
fn quit_literal_leaves_the_same_winner_or_none() {
    for conditions in 0..=2 {
        for situation in small_domain::cases(conditions) {
            let [published, literal] = [PUBLISHED, LITERAL].map(|options| outcome(&situation, options));
            assert!(literal == published || literal == NONE, "{situation:?}");
        }
    }
}

/// Two conditions of the interrupter and one of the current user activate the same
/// disposition; the current user ranks it 1.
#[test]
fn aggregation_counts_a_shared_disposition_twice_or_once() {
    let mentions = vec![1, 1];
    let example = Situation {
        rows: vec![vec![0], vec![0], vec![0]],
        interrupting: Person { ranks: vec![0, 0], status: vec![0, 1], mentions: mentions.clone() },
        current: Person { ranks: vec![1, 0], status: vec![2], mentions },
    };
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(INTERRUPTING, 3, Accepted));
    assert_eq!(negotiate(&example, PER_DISPOSITION), conclusion(NONE, 5, BothQuit));
    assert_eq!(size(&example), (3, 1));
    assert_eq!(smallest(3, |s| outcome(s, PUBLISHED) != outcome(s, PER_DISPOSITION)), Some((3, 1)));
}

/// One condition each, and the interrupter's goal names the disposition twice.
#[test]
fn aggregation_counts_a_goals_repeated_disposition_twice_or_once() {
    let mut example = one_to_one((&[0], &[0]), (&[1], &[0]));
    assert_eq!(outcome(&example, PUBLISHED), NONE);
    example.interrupting.mentions = vec![2];
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(INTERRUPTING, 1, Accepted));
    assert_eq!(negotiate(&example, PER_DISPOSITION), conclusion(NONE, 4, BothQuit));
}

/// What a goal does not imply counts for nothing, whatever conditions activate it.
#[test]
fn only_what_the_offers_own_goal_implies_counts() {
    let mut example = one_to_one((&[0, 0], &[0]), (&[1, 0], &[]));
    assert_eq!(outcome(&example, PUBLISHED), INTERRUPTING);
    example.current.mentions = vec![0, 0];
    assert_eq!(outcome(&example, PUBLISHED), INTERRUPTING);
    example.interrupting.mentions = vec![0, 1];
    assert_eq!(outcome(&example, PUBLISHED), NONE);
}

/// Mutual deference at depth 1: each ranks only the other's condition.
#[test]
fn tie_fallback_is_no_agreement_where_the_first_sender_wins() {
    let example = one_to_one((&[0, 1], &[0]), (&[1, 0], &[1]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(INTERRUPTING, 1, Accepted));
    assert_eq!(negotiate(&example, TIE_FALLBACK), conclusion(NONE, 2, Tie));
    assert_eq!(size(&example), (2, 2));
    assert_eq!(smallest(2, |s| outcome(s, PUBLISHED) != outcome(s, TIE_FALLBACK)), Some((2, 2)));
}

/// The same with gains of 1 and 1, of 2 for the current user, of 2 for the interrupter.
#[test]
fn tie_surplus_serves_the_user_whose_offer_gives_the_other_more() {
    let equal = one_to_one((&[0, 1], &[0]), (&[1, 0], &[1]));
    assert_eq!(negotiate(&equal, TIE_SURPLUS), conclusion(NONE, 2, Tie));
    let current_gains_more = one_to_one((&[0, 1], &[0]), (&[2, 0], &[1]));
    assert_eq!(negotiate(&current_gains_more, TIE_SURPLUS), conclusion(INTERRUPTING, 2, Tie));
    let interrupter_gains_more = one_to_one((&[0, 2], &[0]), (&[1, 0], &[1]));
    assert_eq!(negotiate(&interrupter_gains_more, TIE_SURPLUS), conclusion(CURRENT, 2, Tie));

    for (example, expected) in
        [(equal, NONE), (current_gains_more, INTERRUPTING), (interrupter_gains_more, CURRENT)]
    {
        let found = smallest(2, |s| negotiate(s, TIE_SURPLUS) == conclusion(expected, 2, Tie));
        assert_eq!(found, Some(size(&example)), "{expected}");
    }
}

/// The utility, not the value: here the current user's offer is worth more (3 over 2), but
/// the interrupter has more of its own to give up (2 over 0).
#[test]
fn tie_surplus_compares_what_is_gained_beyond_the_own_offer() {
    let example = one_to_one((&[2, 3], &[0]), (&[2, 0], &[1]));
    assert_eq!(negotiate(&example, TIE_SURPLUS), conclusion(INTERRUPTING, 2, Tie));
}

#[test]
fn a_held_offer_stands_if_the_reply_is_rejected_and_the_reply_is_a_round() {
    let example = one_to_one((&[0, 0], &[0]), (&[1, 0], &[1]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(INTERRUPTING, 1, Accepted));
    for held in [TIE_FALLBACK, TIE_SURPLUS] {
        assert_eq!(negotiate(&example, held), conclusion(INTERRUPTING, 2, HeldOfferStands));
        // The interrupter's rejection of the reply would be a literal quit.
        let literal = Options { quit: QuitRule::Literal, ..held };
        assert_eq!(negotiate(&example, literal), conclusion(INTERRUPTING, 2, HeldOfferStands));
    }
    let differs = |s: &Situation| negotiate(s, PUBLISHED) != negotiate(s, TIE_FALLBACK);
    assert_eq!(smallest(2, differs), Some(size(&example)));
}

#[test]
fn an_offer_is_not_held_for_a_user_without_an_offer_of_that_depth() {
    let without_any = one_to_one((&[0, 0], &[0]), (&[1, 0], &[]));
    let with_too_few = one_to_one((&[0, 0], &[1, 0]), (&[1, 0], &[1]));
    for held in [TIE_FALLBACK, TIE_SURPLUS] {
        assert_eq!(negotiate(&without_any, held), conclusion(INTERRUPTING, 1, Accepted));
        assert_eq!(negotiate(&with_too_few, held), conclusion(INTERRUPTING, 3, Accepted));
    }
}

/// The interrupter made its offer of that depth a round ago.
#[test]
fn an_offer_of_the_current_user_is_never_held() {
    let example = one_to_one((&[0, 1], &[0]), (&[0, 0], &[1]));
    for options in [PUBLISHED, TIE_FALLBACK, TIE_SURPLUS] {
        assert_eq!(negotiate(&example, options), conclusion(CURRENT, 2, Accepted));
    }
}

/// Nobody accepts anything; only the interrupter gets anything out of being served.
#[test]
fn fallback_utilitarian_serves_the_user_with_more_welfare() {
    let example = one_to_one((&[1, 0], &[0]), (&[0, 0], &[]));
    for options in [PUBLISHED, UTILITARIAN] {
        assert_eq!(negotiate(&example, options), conclusion(NONE, 3, BothQuit));
    }
    assert_eq!(served(&example, PUBLISHED), Current);
    assert_eq!(served(&example, UTILITARIAN), Interrupting);
    assert_eq!(size(&example), (1, 1));
    assert_eq!(smallest(2, |s| served(s, PUBLISHED) != served(s, UTILITARIAN)), Some((1, 1)));
}

#[test]
fn fallback_utilitarian_serves_the_current_user_at_equal_welfare() {
    let nobody_cares = one_to_one((&[0, 0], &[0]), (&[0, 0], &[1]));
    assert_eq!(served(&nobody_cares, UTILITARIAN), Current);
    let each_cares_for_itself = one_to_one((&[1, 0], &[0]), (&[0, 1], &[1]));
    assert_eq!(served(&each_cares_for_itself, UTILITARIAN), Current);
    assert_eq!(served(&each_cares_for_itself.swapped(), UTILITARIAN), Current);
}

#[test]
fn a_fallback_has_no_say_in_an_agreement() {
    let example = one_to_one((&[0, 0], &[0]), (&[2, 1], &[1]));
    for options in [PUBLISHED, UTILITARIAN] {
        assert_eq!(outcome(&example, options), INTERRUPTING);
        assert_eq!(served(&example, options), Interrupting);
    }
}

/// The interrupter's one condition is worth 1 to the current user, whose willingness is
/// worth 1 too.
#[test]
fn willingness_adds_to_the_current_users_own_offer_and_adds_a_round() {
    let example = one_to_one((&[0, 0], &[0]), (&[1, 0], &[]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(INTERRUPTING, 1, Accepted));
    assert_eq!(negotiate(&example, WILLING), conclusion(NONE, 4, BothQuit));
    assert_eq!(size(&example), (1, 1));
    assert_eq!(smallest(2, |s| outcome(s, PUBLISHED) != outcome(s, WILLING)), Some((1, 1)));
}

/// The smallest case of all: nobody has a condition, the willingness is the only offer.
#[test]
fn willingness_is_one_more_offer_whatever_it_is_worth() {
    let example = one_to_one((&[0, 0], &[]), (&[0, 0], &[]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(NONE, 2, BothQuit));
    for willingness in [1, 2, 255] {
        assert_eq!(negotiate(&example, Options { willingness, ..PUBLISHED }), conclusion(NONE, 3, BothQuit));
    }
}

/// It can hold back a tie: the current user has an offer of depth 1 now.
#[test]
fn willingness_is_an_offer_that_a_held_one_waits_for() {
    let example = one_to_one((&[0, 0], &[0]), (&[2, 0], &[]));
    assert_eq!(negotiate(&example, TIE_FALLBACK), conclusion(INTERRUPTING, 1, Accepted));
    let willing = Options { willingness: 1, ..TIE_FALLBACK };
    assert_eq!(negotiate(&example, willing), conclusion(INTERRUPTING, 2, HeldOfferStands));
}

#[test]
fn willingness_does_not_count_in_welfare() {
    let example = one_to_one((&[1, 0], &[0]), (&[0, 0], &[]));
    let willing = Options { willingness: 255, ..UTILITARIAN };
    let [without, with] = [UTILITARIAN, willing].map(|options| example.with(|case| case.welfare(&options)));
    assert_eq!(without, with);
    assert_eq!(served(&example, willing), Interrupting);
}

/// Published: a user without conditions makes the program crash. Here it quits at once.
#[test]
fn a_user_without_conditions_quits_in_its_first_turn() {
    let neither = one_to_one((&[1, 1], &[]), (&[1, 1], &[]));
    assert_eq!(negotiate(&neither, PUBLISHED), conclusion(NONE, 2, BothQuit));
    assert_eq!(negotiate(&neither, LITERAL), conclusion(NONE, 1, LiteralQuit(Interrupting)));

    let interrupter_without = one_to_one((&[0, 0], &[]), (&[1, 1], &[0, 1]));
    assert_eq!(negotiate(&interrupter_without, PUBLISHED), conclusion(NONE, 4, BothQuit));
    assert_eq!(negotiate(&interrupter_without, LITERAL), conclusion(NONE, 1, LiteralQuit(Interrupting)));

    let current_without = interrupter_without.swapped();
    assert_eq!(negotiate(&current_without, PUBLISHED), conclusion(NONE, 4, BothQuit));
    assert_eq!(negotiate(&current_without, LITERAL), conclusion(NONE, 1, LiteralQuit(Current)));
}

/// Its own complete offer is worth 0 to it.
#[test]
fn a_user_without_conditions_accepts_whatever_is_worth_something_to_it() {
    let interrupter_without = one_to_one((&[0, 1], &[]), (&[1, 1], &[0, 1]));
    assert_eq!(negotiate(&interrupter_without, PUBLISHED), conclusion(CURRENT, 3, Accepted));
    let current_without = interrupter_without.swapped();
    for options in [PUBLISHED, TIE_FALLBACK, TIE_SURPLUS] {
        assert_eq!(negotiate(&current_without, options), conclusion(INTERRUPTING, 3, Accepted));
    }
    assert_eq!(negotiate(&current_without, LITERAL), conclusion(NONE, 1, LiteralQuit(Current)));
}

/// A true condition that is worth nothing to anybody is a round all the same.
#[test]
fn a_condition_without_a_row_is_disclosed() {
    let example = one_to_one((&[1, 1], &[7]), (&[1, 1], &[65_535]));
    assert_eq!(negotiate(&example, PUBLISHED), conclusion(NONE, 4, BothQuit));
}

/// The design's example: the interrupter has a and b, the current user has c; the current
/// user ranks b's disposition 1, the interrupter c's. The current user wins, and loses
/// once the interrupter hides a.
#[test]
fn opting_out_can_turn_a_loss_into_a_win() {
    let [a, b, c] = [2, 0, 1];
    let open = one_to_one((&[0, 1], &[a, b]), (&[1, 0], &[c]));
    assert_eq!(negotiate(&open, PUBLISHED), conclusion(CURRENT, 2, Accepted));
    let mut hiding = open.clone();
    hiding.interrupting.status = vec![b];
    assert_eq!(negotiate(&hiding, PUBLISHED), conclusion(INTERRUPTING, 1, Accepted));

    let hiding_helps = |s: &Situation| {
        [Current, Interrupting].into_iter().any(|side| {
            let won = Outcome::Agreement(side);
            outcome(s, PUBLISHED) == Outcome::Agreement(side.other())
                && (0..s.person(side).status.len()).any(|hidden| {
                    let mut fewer = s.clone();
                    match side {
                        Current => fewer.current.status.remove(hidden),
                        Interrupting => fewer.interrupting.status.remove(hidden),
                    };
                    outcome(&fewer, PUBLISHED) == won
                })
        })
    };
    assert_eq!(size(&open), (3, 2));
    assert_eq!(smallest(3, hiding_helps), Some((3, 2)));
}

/// Whether the same user is agreed on when the two swap parts.
fn role_symmetric(situation: &Situation, options: Options) -> bool {
    let [ahead, behind] = [situation, &situation.swapped()].map(|s| outcome(s, options).winner());
    ahead == behind.map(Side::other)
}

/// Role symmetry and its exception: the interrupter wins both times.
#[test]
fn only_mutual_deference_at_one_depth_makes_the_roles_matter() {
    let example = one_to_one((&[0, 1], &[0]), (&[1, 0], &[1]));
    for situation in [example.clone(), example.swapped()] {
        assert_eq!(outcome(&situation, PUBLISHED), INTERRUPTING);
    }
    assert_eq!(smallest(3, |s| !role_symmetric(s, PUBLISHED)), Some(size(&example)));

    for situation in (0..=2).flat_map(small_domain::cases) {
        let [k_i, k_c] =
            [Interrupting, Current].map(|side| naive::Outlook::of(&situation, side, &PUBLISHED).accepted_at);
        let tie = k_i.is_some() && k_i == k_c;
        assert_eq!(role_symmetric(&situation, PUBLISHED), !tie, "{situation:?}");
        for held in [TIE_FALLBACK, TIE_SURPLUS] {
            assert!(role_symmetric(&situation, held), "{situation:?}");
        }
    }
}

/// Under `literal` it fails without any tie: whoever interrupts without conditions ends it
/// before the other is heard.
#[test]
fn literal_makes_the_roles_matter_without_a_tie() {
    let example = one_to_one((&[1, 0], &[]), (&[0, 0], &[0]));
    assert_eq!(outcome(&example, LITERAL), NONE);
    assert_eq!(outcome(&example.swapped(), LITERAL), INTERRUPTING);
}

fn names_are_read_back<T>(all: &[T], names: &[&str], name: fn(T) -> &'static str)
where
    T: Copy + Default + PartialEq + std::fmt::Debug + std::fmt::Display + FromStr<Err = UnknownName>,
{
    assert_eq!(all.iter().map(|&value| name(value)).collect::<Vec<_>>(), names);
    assert_eq!(all.first(), Some(&T::default()));
    for &value in all {
        assert_eq!(value.to_string(), name(value));
        assert_eq!(format!("{value:>16}|{value:<16}|"), format!("{0:>16}|{0:<16}|", name(value)));
        assert_eq!(name(value).parse(), Ok(value));
        assert_eq!(name(value).to_uppercase().parse::<T>(), Err(UnknownName));
    }
    assert_eq!("".parse::<T>(), Err(UnknownName));
}

#[test]
fn names_are_those_of_the_command_line_and_are_read_back() {
    names_are_read_back(QuitRule::ALL, &["exhausted", "literal"], QuitRule::name);
    names_are_read_back(Aggregation::ALL, &["per-condition", "per-disposition"], Aggregation::name);
    names_are_read_back(TieRule::ALL, &["first-sender", "fallback", "surplus"], TieRule::name);
    names_are_read_back(Fallback::ALL, &["first-come", "utilitarian"], Fallback::name);
}

#[test]
fn an_unknown_name_is_refused_in_words() {
    let error = "exhaustive".parse::<QuitRule>().unwrap_err();
    assert_eq!(error.to_string(), "no value of this option has that name");
    assert!(error.source().is_none());
}

#[test]
fn a_variant_is_written_in_one_word() {
    assert_eq!(PUBLISHED.to_string(), "exhausted/per-condition/first-sender/first-come/w0");
    let other = Options {
        quit: QuitRule::Literal,
        aggregation: Aggregation::PerDisposition,
        tie: TieRule::Surplus,
        fallback: Fallback::Utilitarian,
        willingness: 255,
    };
    assert_eq!(other.to_string(), "literal/per-disposition/surplus/utilitarian/w255");
    let written: std::collections::BTreeSet<String> =
        situation::variants().map(|options| options.to_string()).collect();
    assert_eq!(written.len(), situation::variants().count());
}

#[test]
fn sides_and_outcomes_have_the_names_of_the_published_logs() {
    for outcome in [CURRENT, INTERRUPTING, NONE] {
        assert_eq!(outcome.to_string(), outcome.name());
        assert_eq!(outcome.winner().map(Outcome::Agreement).unwrap_or(NONE), outcome);
    }
    assert_eq!([CURRENT, INTERRUPTING, NONE].map(Outcome::name), ["current", "interrupting", "no-agreement"]);
    for side in [Current, Interrupting] {
        assert_eq!(side.to_string(), Outcome::Agreement(side).name());
        assert_eq!(side.other().other(), side);
        assert_ne!(side.other(), side);
    }
    assert_eq!(format!("{:>14}|{:<9}|", INTERRUPTING, Current), "  interrupting|current  |");
}
