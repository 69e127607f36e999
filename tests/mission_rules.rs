//! Each rule that the mission keeps, as a scenario that fails without it.

#![expect(clippy::unwrap_used, reason = "a test may stop")]

mod mission_environment;

use mission_environment::{
    ALICE, BOB, CAROL, Environment, alice, alice_who_defers, bob_who_defers, bob_who_insists, data, profile,
    rules, specification, stated,
};
use selfneg::input::{Rules, Truth};
use selfneg::mission::{
    ActiveProfile, Closing, Command, ContextImplication, Disclosed, Dropped, Event, Evidence, GoalEnd,
    Inference, MissionRules, Output, Place, Record, Refusal, Round, Served, Specification,
    SpecificationError, Staff, Unusable, UserData, UserId, Waiting,
};
use selfneg::precedence::Policy;
use selfneg_core::{Fallback, Options};

/// Bob interrupts Alice at once and takes precedence.
fn bob_wins() -> Environment {
    let mut robot = Environment::serving(alice_who_defers());
    robot.request(BOB, "t2").data(BOB, bob_who_insists()).negotiate();
    assert_eq!(robot.mission.current_user(), Some(BOB));
    robot
}

/// A user who has nothing to offer and accepts nothing: the other side discloses everything.
fn unmoved() -> UserData {
    data([0, 0, 0], &[])
}

fn first_round(robot: &Environment) -> (u64, u64) {
    robot
        .records()
        .find_map(|record| match record {
            Record::Round { round: Round::Offer { value, threshold, .. }, .. } => Some((*value, *threshold)),
            _ => None,
        })
        .unwrap()
}

fn disclosed(robot: &Environment, by: UserId) -> Vec<Disclosed> {
    robot
        .records()
        .filter_map(|record| match record {
            Record::Round { sender, round: Round::Offer { discloses, .. }, .. } if *sender == by => {
                Some(*discloses)
            }
            _ => None,
        })
        .collect()
}

mod memory {
    use super::*;

    #[test]
    fn idle_holds_nothing_serving_one_negotiating_both_then_one_then_nothing() {
        let mut robot = Environment::new();
        assert!(robot.mission.is_idle());
        robot.request(ALICE, "t1").data(ALICE, alice());
        assert_eq!(robot.held(), [ALICE]);
        robot.request(BOB, "t2").data(BOB, bob_who_defers());
        assert_eq!(robot.held(), [ALICE, BOB]);
        robot.negotiate();
        assert_eq!(robot.held(), [ALICE]);
        robot.finish_goal().send(Event::Withdraw { user: BOB });
        assert!(robot.held().is_empty());
        assert_eq!(robot.mission.residue(), 0);
    }

    #[test]
    fn the_current_user_without_precedence_is_wiped_and_only_the_request_is_kept() {
        let mut robot = bob_wins();
        assert_eq!(robot.held(), [BOB]);
        assert_eq!(robot.mission.open_requests(), [ALICE, BOB]);
        let wiped = |r: &Record| matches!(r, Record::Wiped { user: ALICE, left: 0, .. });
        assert!(robot.has_record(wiped));

        robot.finish_goal();
        assert!(robot.last_has(|o| matches!(o, Output::Command(Command::AskData { user: ALICE, .. }))));
        assert_eq!(robot.mission.current_user(), None);
        robot.data(ALICE, alice());
        let goal = robot.mission.rules().goal("t1").unwrap();
        assert!(robot.last_has(|o| matches!(
            o,
            Output::Command(Command::Execute { goal: g, place: Place(101), .. }) if *g == goal
        )));
    }

    #[test]
    fn an_interrupter_without_precedence_is_served_afterwards() {
        let mut robot = Environment::serving(alice());
        robot.request(BOB, "t2").data(BOB, bob_who_defers()).negotiate();
        let wait = Command::Wait { user: BOB, why: Waiting::NoPrecedence };
        assert!(robot.last_has(|o| *o == Output::Command(wait)));
        assert_eq!(robot.mission.open_requests(), [ALICE, BOB]);
        robot.finish_goal().data(BOB, bob_who_defers());
        assert_eq!(robot.mission.current_user(), Some(BOB));
    }

    #[test]
    fn a_deferred_user_who_no_longer_wants_it_is_not_served() {
        let mut robot = bob_wins();
        robot.finish_goal().send(Event::Withdraw { user: ALICE });
        assert_eq!(robot.closed(ALICE), Some(Closing::Withdrawn));
        assert!(robot.mission.is_idle());
    }
}

mod readiness {
    use super::*;

    #[test]
    fn no_negotiation_before_the_interrupters_data_are_there() {
        let mut robot = Environment::serving(alice());
        robot.request(BOB, "t2");
        assert!(!robot.round_due);
        assert!(!robot.has_record(|r| matches!(r, Record::NegotiationStarted { .. })));
        robot.data(BOB, bob_who_defers());
        assert!(robot.round_due);
    }

    #[test]
    fn data_that_do_not_arrive_leave_the_current_mission_as_it_is() {
        let mut robot = Environment::serving(alice());
        let running = robot.running;
        robot.request(BOB, "t2").timeout(BOB);
        assert!(robot.has_record(|r| *r == Record::DataMissing { user: BOB }));
        assert_eq!((robot.mission.current_user(), robot.running), (Some(ALICE), running));
        assert_eq!(robot.held(), [ALICE]);
        assert_eq!(robot.mission.open_requests(), [ALICE, BOB]);
    }
}

mod requests {
    use super::*;

    #[test]
    fn a_goal_beyond_the_robots_capabilities_is_refused_before_anybody_is_asked() {
        let mut robot = Environment::serving(alice());
        robot.request(BOB, "fly");
        let goal = robot.mission.rules().goal("fly").unwrap();
        let refusal = Command::Refuse { user: BOB, goal, why: Refusal::Incapable };
        assert!(robot.last_has(|o| *o == Output::Command(refusal)));
        assert!(!robot.last_has(|o| matches!(o, Output::Command(Command::AskData { .. }))));
        assert_eq!(robot.mission.open_requests(), [ALICE]);
    }

    #[test]
    fn a_task_that_may_not_be_interrupted_makes_the_request_wait_not_vanish() {
        let mut robot = Environment::serving(alice_who_defers());
        robot.action_done();
        robot.request(BOB, "t2");
        let wait = Command::Wait { user: BOB, why: Waiting::NotInterruptible };
        assert!(robot.last_has(|o| *o == Output::Command(wait)));
        assert!(!robot.last_has(|o| matches!(o, Output::Command(Command::AskData { .. }))));
        robot.action_done();
        assert!(!robot.last_has(|o| matches!(o, Output::Command(Command::AskData { .. }))));
        robot.action_done();
        assert!(robot.last_has(|o| matches!(o, Output::Command(Command::AskData { user: BOB, .. }))));
        robot.data(BOB, bob_who_insists()).negotiate();
        assert_eq!(robot.mission.current_user(), Some(BOB));
    }

    #[test]
    fn the_robot_does_not_enter_such_a_task_while_a_negotiation_is_open() {
        let mut robot = Environment::serving(alice_who_defers());
        robot.request(BOB, "t2").action_done();
        assert!(robot.has_record(|r| *r == Record::Held { task: 1 }));
        assert_eq!(robot.running, None);
        robot.timeout(BOB);
        assert!(robot.running.is_some());
        assert!(robot.has_record(|r| matches!(r, Record::TaskStarted { task: 1, interruptible: false, .. })));
    }

    #[test]
    fn an_interruption_in_the_middle_of_a_negotiation_joins_it() {
        let mut robot = Environment::serving(data([5, 1, 1], &["a"]));
        robot.request(BOB, "t2").data(BOB, bob_who_defers());
        robot.send(Event::NextRound);
        robot.request(CAROL, "t2");
        assert!(robot.last_has(|o| matches!(o, Output::Command(Command::AskData { user: CAROL, .. }))));
        robot.negotiate();
        assert!(!robot.has_record(|r| matches!(r, Record::Decided { .. })), "Carol's data are awaited");
        robot.data(CAROL, data([5, 1, 1], &["c"])).negotiate();
        let all = vec![ALICE, BOB, CAROL];
        assert!(robot.has_record(|r| matches!(
            r,
            Record::Decided { participants, policy: Policy::Published, .. } if *participants == all
        )));
    }

    #[test]
    fn with_more_interrupters_than_the_published_policy_knows_condorcet_decides() {
        let mut robot = Environment::serving(alice());
        let dave = UserId(4);
        robot.request(BOB, "t2").request(CAROL, "t2").request(dave, "t2");
        robot.data(BOB, bob_who_defers()).data(CAROL, data([5, 1, 1], &["c"]));
        robot.data(dave, data([5, 1, 1], &["c"])).negotiate();
        assert!(robot.has_record(|r| matches!(
            r,
            Record::Decided { participants, policy: Policy::Condorcet, .. } if participants.len() == 4
        )));
    }

    #[test]
    fn a_user_who_asks_twice_keeps_the_first_request() {
        let mut robot = Environment::serving(alice());
        robot.request(ALICE, "t2");
        assert!(robot.last_has(|o| matches!(
            o,
            Output::Command(Command::Refuse { user: ALICE, why: Refusal::AlreadyAsking, .. })
        )));
        assert_eq!(robot.mission.current_user(), Some(ALICE));
    }

    #[test]
    fn what_does_not_fit_goes_to_human_staff() {
        let mut robot = Environment::serving(alice());
        for nth in 2..=6 {
            robot.request(UserId(nth), "t2");
        }
        robot.request(UserId(7), "t2");
        assert_eq!(robot.closed(UserId(7)), Some(Closing::Staff(Staff::NoRoom)));
        assert_eq!(robot.mission.open_requests().len(), 6);
        assert_eq!(robot.held().len(), 4);
    }

    #[test]
    fn from_the_specified_number_of_deferrals_on_a_request_goes_to_human_staff() {
        let mut robot = Environment::serving(alice());
        robot.request(BOB, "t2").timeout(BOB);
        robot.finish_goal().timeout(BOB);
        assert_eq!(robot.closed(BOB), None);
        assert!(robot.has_record(|r| matches!(r, Record::Deferred { user: BOB, times: 2, .. })));
        robot.timeout(BOB);
        assert_eq!(robot.closed(BOB), Some(Closing::Staff(Staff::DeferredTooOften)));
        assert!(robot.has_record(|r| matches!(r, Record::StaffCalled { user: Some(BOB), .. })));
        assert!(robot.mission.is_idle());
    }

    #[test]
    fn shutdown_hands_every_request_to_human_staff_and_ends_at_a_safe_point() {
        let mut robot = Environment::serving(alice());
        robot.action_done();
        robot.request(BOB, "t2").send(Event::Shutdown);
        for user in [ALICE, BOB] {
            assert_eq!(robot.closed(user), Some(Closing::Staff(Staff::Shutdown)));
        }
        assert!(robot.held().is_empty());
        assert!(!robot.mission.is_over(), "still in the lift");
        robot.action_done().action_done();
        assert!(robot.mission.is_over() && robot.mission.is_idle());
        robot.request(CAROL, "t1");
        assert_eq!(robot.closed(CAROL), Some(Closing::Staff(Staff::Shutdown)));
    }

    #[test]
    fn who_withdraws_in_a_task_that_may_not_be_interrupted_is_wiped_at_once() {
        let mut robot = Environment::serving(alice());
        robot.action_done();
        robot.send(Event::Withdraw { user: ALICE });
        assert!(robot.held().is_empty() && robot.mission.open_requests().is_empty());
        assert!(robot.running.is_some());
        robot.action_done().action_done();
        assert!(robot.mission.is_idle());
        assert!(robot.has_record(|r| matches!(r, Record::GoalEnded { end: GoalEnd::Abandoned, .. })));
    }

    #[test]
    fn if_the_goal_ends_during_a_negotiation_the_interrupter_is_next() {
        let mut robot = Environment::serving(alice());
        for _ in 0..4 {
            robot.action_done();
        }
        robot.request(BOB, "t2").data(BOB, bob_who_defers());
        robot.send(Event::NextRound).action_done();
        assert_eq!(robot.closed(ALICE), Some(Closing::Reached));
        assert!(robot.has_record(|r| *r == Record::NegotiationsDropped { why: Dropped::NobodyLeft }));
        assert_eq!(robot.mission.current_user(), Some(BOB));
    }
}

mod willingness {
    use super::*;

    fn started_with(actions: usize) -> u8 {
        let options = Options { willingness: 7, ..Options::default() };
        let mut robot = Environment::with(specification(), options, None);
        robot.request(ALICE, "t1").data(ALICE, alice());
        for _ in 0..actions {
            robot.action_done();
        }
        robot.request(BOB, "t2").data(BOB, unmoved());
        let started = robot.records().find_map(|record| match record {
            Record::NegotiationStarted { willingness, .. } => Some(*willingness),
            _ => None,
        });
        robot.negotiate();
        let tells = disclosed(&robot, ALICE).contains(&Disclosed::Willingness);
        assert_eq!(tells, started.is_some_and(|worth| worth > 0));
        started.unwrap()
    }

    /// Five actions; the variant's willingness counts from 80 % on.
    #[test]
    fn it_comes_from_real_progress() {
        assert_eq!(started_with(3), 0);
        assert_eq!(started_with(4), 7);
    }

    #[test]
    fn what_a_status_says_of_it_does_not_count() {
        let mut robot = Environment::new();
        robot.request(ALICE, "t1").data(ALICE, data([5, 1, 1], &["end of goal"]));
        robot.request(BOB, "t2").data(BOB, unmoved()).negotiate();
        assert!(disclosed(&robot, ALICE).is_empty());
    }
}

mod hard_ethics {
    use super::*;

    fn serves_emergency(robot: &Environment, name: &str) -> bool {
        let category = robot.mission.rules().category(name).unwrap();
        let served = Served::Emergency(category);
        let goals = robot.records().filter_map(|record| match record {
            Record::GoalStarted { served, .. } => Some(Some(*served)),
            Record::GoalEnded { .. } => Some(None),
            _ => None,
        });
        goals.last().flatten() == Some(served)
    }

    #[test]
    fn a_certain_emergency_overrides_in_the_middle_of_a_negotiation() {
        let mut robot = Environment::serving(alice());
        robot.request(BOB, "t2").data(BOB, bob_who_defers()).send(Event::NextRound);
        assert!(robot.round_due);
        robot.emergency("fire", Evidence::Sensed);
        assert!(robot.has_record(|r| *r == Record::NegotiationsDropped { why: Dropped::Emergency }));
        assert!(serves_emergency(&robot, "fire"));
        assert!(robot.held().is_empty());
        assert_eq!(robot.mission.open_requests(), [ALICE, BOB]);

        // Afterwards Alice is asked again, and Bob may still interrupt her.
        robot.finish_goal().data(ALICE, alice()).data(BOB, bob_who_defers()).negotiate();
        assert!(robot.has_record(|r| matches!(r, Record::Decided { served: ALICE, .. })));
    }

    #[test]
    fn a_claim_has_no_effect_but_is_recorded() {
        for (category, evidence) in [
            ("boarding", Evidence::Claimed),
            ("boarding", Evidence::Sensed),
            ("fire", Evidence::Claimed),
            ("fire", Evidence::Verified),
        ] {
            let mut robot = Environment::serving(alice());
            robot.emergency(category, evidence);
            assert_eq!(robot.last.len(), 1);
            assert!(robot.last_has(|o| matches!(o, Output::Record(Record::EmergencyUnverified { .. }))));
            assert_eq!(robot.mission.current_user(), Some(ALICE));
        }
    }

    #[test]
    fn a_verified_claim_overrides() {
        let mut robot = Environment::serving(alice());
        robot.emergency("boarding", Evidence::Verified);
        assert!(serves_emergency(&robot, "boarding"));
    }

    #[test]
    fn in_a_task_that_may_not_be_interrupted_it_is_decided_at_once_and_acted_on_at_the_safe_point() {
        let mut robot = Environment::serving(alice());
        robot.action_done();
        robot.emergency("fire", Evidence::Sensed);
        assert!(robot.last_has(|o| matches!(o, Output::Record(Record::EmergencyDecided { .. }))));
        assert_eq!(robot.mission.current_user(), Some(ALICE));
        robot.action_done();
        assert_eq!(robot.mission.current_user(), Some(ALICE));
        robot.action_done();
        assert!(serves_emergency(&robot, "fire"));
    }

    #[test]
    fn the_graver_goes_first_then_the_earlier() {
        let mut robot = Environment::serving(alice());
        robot.action_done();
        robot.emergency("boarding", Evidence::Verified).emergency("fire", Evidence::Sensed);
        robot.action_done().action_done();
        assert!(serves_emergency(&robot, "fire"));
        let boarding = robot.mission.rules().category("boarding").unwrap();
        let starts_boarding = |r: &Record| matches!(r, Record::GoalStarted { served: Served::Emergency(c), .. } if *c == boarding);
        assert!(!robot.has_record(starts_boarding));
        robot.finish_goal();
        assert!(serves_emergency(&robot, "boarding"));

        // A graver one displaces, which waits; an equal one does not.
        robot.emergency("fall", Evidence::Sensed);
        assert!(serves_emergency(&robot, "fall"));
        let starts =
            |robot: &Environment| robot.records().filter(|r| matches!(r, Record::GoalStarted { .. })).count();
        let before = starts(&robot);
        robot.emergency("fall", Evidence::Sensed);
        assert_eq!(starts(&robot), before);
        robot.finish_goal();
        assert!(serves_emergency(&robot, "fall"));
        robot.finish_goal();
        assert!(serves_emergency(&robot, "boarding"));
    }

    #[test]
    fn of_two_equally_grave_the_earlier_goes_first() {
        for [earlier, later] in [["fire", "smoke"], ["smoke", "fire"]] {
            let mut robot = Environment::serving(alice());
            robot.action_done();
            robot.emergency(earlier, Evidence::Sensed).emergency(later, Evidence::Sensed);
            robot.action_done().action_done();
            assert!(serves_emergency(&robot, earlier));
            robot.finish_goal();
            assert!(serves_emergency(&robot, later));
        }
    }

    #[test]
    fn nobody_interrupts_an_emergency() {
        let mut robot = Environment::new();
        robot.emergency("fire", Evidence::Sensed).request(BOB, "t2");
        assert!(robot.last_has(|o| matches!(o, Output::Command(Command::Wait { user: BOB, .. }))));
        assert!(robot.held().is_empty());
        robot.finish_goal();
        assert!(robot.last_has(|o| matches!(o, Output::Command(Command::AskData { user: BOB, .. }))));
    }
}

mod snapshot {
    use super::*;

    /// Bob's profile would turn the outcome if it changed in the middle.
    #[test]
    fn changes_that_arrive_meanwhile_count_afterwards() {
        let outcome = |changes_at: &str| {
            let mut robot = Environment::serving(alice_who_defers());
            let mut bob = bob_who_insists();
            bob.status.insert(0, stated("c", Truth::True));
            robot.request(BOB, "t2");
            if changes_at == "before" {
                bob.status = vec![stated("c", Truth::True)];
            }
            robot.data(BOB, bob);
            robot.send(Event::NextRound);
            if changes_at == "during" {
                let truth = Truth::Withheld;
                robot.send(Event::Status { user: BOB, condition: "b".into(), truth });
            }
            robot.negotiate();
            robot.mission.current_user()
        };
        assert_eq!(outcome("never"), Some(BOB));
        assert_eq!(outcome("during"), Some(BOB));
        assert_eq!(outcome("before"), Some(ALICE));
    }

    #[test]
    fn afterwards_they_do_count() {
        let mut robot = Environment::serving(alice_who_defers());
        robot.request(BOB, "t2").data(BOB, unmoved());
        robot.send(Event::Status { user: ALICE, condition: "c".into(), truth: Truth::True }).negotiate();
        assert!(!disclosed(&robot, ALICE).contains(&Disclosed::Listed(2)));
        robot.request(CAROL, "t2").data(CAROL, unmoved()).negotiate();
        assert!(disclosed(&robot, ALICE).contains(&Disclosed::Listed(2)));
    }
}

mod context {
    use super::*;

    fn with_two_profiles() -> UserData {
        let mut data = alice();
        data.profiles.push(profile("ward", [2, 9, 1]));
        data
    }

    #[test]
    fn a_context_update_selects_the_active_profile() {
        let mut robot = Environment::serving(with_two_profiles());
        let activated = |n| Record::ProfileActivated { user: ALICE, profile: ActiveProfile::Own(n) };
        assert!(robot.has_record(|r| *r == activated(0)));
        robot.send(Event::Context { user: ALICE, attribute: "location".into(), value: "ward".into() });
        assert!(robot.has_record(|r| *r == activated(1)));
        robot.request(BOB, "t2").data(BOB, bob_who_insists()).negotiate();
        assert_eq!(first_round(&robot), (9, 2), "Alice weighs by her profile of the ward");
    }

    #[test]
    fn a_context_without_a_profile_keeps_the_active_one() {
        let mut robot = Environment::serving(with_two_profiles());
        robot.send(Event::Context { user: ALICE, attribute: "location".into(), value: "moon".into() });
        assert!(robot.has_record(|r| *r == Record::ProfileKept { user: ALICE }));
    }

    fn dark() -> Specification {
        let inference =
            Inference { attribute: "light".to_owned(), value: "dark".to_owned(), condition: "c".to_owned() };
        Specification { inferences: vec![inference], ..specification() }
    }

    fn alice_in_the_dark_discloses(about_c: Option<Truth>) -> Vec<Disclosed> {
        let mut robot = Environment::with(dark(), Options::default(), None);
        let mut alice = alice();
        alice.context.push(("light".into(), "dark".into()));
        alice.status.extend(about_c.map(|truth| stated("c", truth)));
        robot.request(ALICE, "t1").data(ALICE, alice);
        robot.request(BOB, "t2").data(BOB, unmoved()).negotiate();
        disclosed(&robot, ALICE)
    }

    #[test]
    fn conditions_are_inferred_from_the_context_by_declared_rules() {
        assert_eq!(alice_in_the_dark_discloses(None), [Disclosed::Listed(0), Disclosed::Listed(2)]);
    }

    #[test]
    fn what_a_user_has_withheld_or_denied_is_never_inferred() {
        assert_eq!(alice_in_the_dark_discloses(Some(Truth::Withheld)), [Disclosed::Listed(0)]);
        assert_eq!(alice_in_the_dark_discloses(Some(Truth::False)), [Disclosed::Listed(0)]);
    }

    #[test]
    fn a_withheld_condition_is_never_disclosed() {
        let mut robot = Environment::new();
        let mut alice = alice();
        alice.status.push(stated("b", Truth::Withheld));
        robot.request(ALICE, "t1").data(ALICE, alice);
        robot.request(BOB, "t2").data(BOB, unmoved()).negotiate();
        assert_eq!(disclosed(&robot, ALICE), [Disclosed::Listed(0)]);
    }

    #[test]
    fn a_condition_that_only_the_user_names_is_disclosed_and_activates_nothing() {
        let mut robot = Environment::serving(data([5, 1, 1], &["a", "left-handed"]));
        robot.request(BOB, "t2").data(BOB, unmoved()).negotiate();
        assert_eq!(disclosed(&robot, ALICE), [Disclosed::Listed(0), Disclosed::Unlisted(1)]);
        let mut robot = Environment::serving(data([5, 1, 1], &["left-handed"]));
        robot.request(BOB, "t2").data(BOB, unmoved()).negotiate();
        assert_eq!(disclosed(&robot, ALICE), [Disclosed::Unlisted(0)]);
        assert!(robot.has_record(|r| matches!(r, Record::Decided { agreement: None, .. })));
    }

    #[test]
    fn a_goals_implication_can_depend_on_the_context() {
        let in_the = |place: &str| {
            let mut specification = specification();
            specification.goals[1].implications = vec![ContextImplication {
                attribute: "location".to_owned(),
                value: "ward".to_owned(),
                dispositions: vec!["A".to_owned()],
            }];
            let mut robot = Environment::with(specification, Options::default(), None);
            robot.request(ALICE, "t1").data(ALICE, alice());
            let mut bob = bob_who_insists();
            bob.profiles.push(profile("ward", [1, 5, 1]));
            bob.context = vec![("location".into(), place.into())];
            robot.request(BOB, "t2").data(BOB, bob).negotiate();
            first_round(&robot).0
        };
        assert_eq!(in_the("mall"), 1, "b, and so B, in Alice's eyes");
        assert_eq!(in_the("ward"), 0, "there the goal does not imply B");
    }

    fn normative() -> Specification {
        let ranks = [("A", 1), ("B", 7), ("C", 1)].map(|(name, rank)| (name.to_owned(), rank));
        let normative = [("mall".to_owned(), ranks.into())].into();
        Specification { normative, ..specification() }
    }

    #[test]
    fn a_user_who_gave_no_profile_gets_the_normative_default() {
        let mut robot = Environment::with(normative(), Options::default(), None);
        let mut alice = alice();
        alice.profiles.clear();
        robot.request(ALICE, "t1").data(ALICE, alice);
        robot.request(BOB, "t2").data(BOB, bob_who_insists()).negotiate();
        assert_eq!(first_round(&robot), (7, 1));
    }

    #[test]
    fn a_users_own_profile_goes_before_the_normative_one_and_is_not_replaced_by_it() {
        let mut robot = Environment::with(normative(), Options::default(), None);
        robot.request(ALICE, "t1").data(ALICE, alice());
        robot.request(BOB, "t2");
        let mut elsewhere = bob_who_insists();
        elsewhere.profiles = vec![profile("ward", [1, 5, 1])];
        robot.data(BOB, elsewhere);
        let unusable = Record::DataUnusable { user: BOB, why: Unusable::UnknownContext };
        assert!(robot.has_record(|r| *r == unusable));
        assert!(
            robot.has_record(
                |r| *r == Record::ProfileActivated { user: ALICE, profile: ActiveProfile::Own(0) }
            )
        );
    }
}

mod negotiation {
    use selfneg::binding::{BoundRules, GoalChoice};
    use selfneg::demo;
    use selfneg::precedence::decide;
    use selfneg::transcript;

    use super::*;

    /// Stepped by events, with snapshots: round by round what the engine does in one go.
    #[test]
    fn it_is_the_engines() {
        let goal = |name: &str| selfneg::mission::Goal {
            name: name.to_owned(),
            tasks: specification().goals[0].tasks.clone(),
            ..Default::default()
        };
        let specification =
            Specification { goals: vec![goal("bathroom"), goal("pharmacy")], ..Default::default() };
        for fallback in Fallback::ALL {
            for swapped in [false, true] {
                let options = Options { fallback: *fallback, ..Options::default() };
                let mut users = [demo::alice().unwrap(), demo::bob().unwrap()];
                if swapped {
                    users.reverse();
                }
                let source = demo::rules().unwrap();
                let mut bound = BoundRules::new(source.clone()).unwrap();
                let both = users.each_ref().map(|u| bound.bind(u, &GoalChoice::OwnFile).unwrap());
                let expected = decide(&bound, &both, options, Policy::Published).unwrap();

                let mut robot = Environment::under(&source, specification.clone(), options, None);
                for (user, data) in [ALICE, BOB].into_iter().zip(&users) {
                    robot.request(user, data.goal.as_deref().unwrap()).data(user, data.into());
                }
                robot.negotiate();
                let served = robot.mission.current_user().unwrap();
                assert_eq!(served, [ALICE, BOB][expected.served]);
                let offers = expected.negotiations[0].rounds.iter().map(|round| match round.event {
                    transcript::Event::Quit => None,
                    transcript::Event::Offer { weighing, .. } => {
                        Some((weighing.value.0, weighing.threshold.0))
                    }
                });
                let played = robot.records().filter_map(|record| match record {
                    Record::Round { round: Round::Quit, .. } => Some(None),
                    Record::Round { round: Round::Offer { value, threshold, .. }, .. } => {
                        Some(Some((*value, *threshold)))
                    }
                    _ => None,
                });
                assert_eq!(played.collect::<Vec<_>>(), offers.collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn without_agreement_the_variants_fallback_decides() {
        let served = |fallback| {
            let options = Options { fallback, ..Options::default() };
            let mut robot = Environment::with(specification(), options, None);
            robot.request(ALICE, "t1").data(ALICE, data([5, 4, 1], &["a"]));
            robot.request(BOB, "t2").data(BOB, data([1, 9, 1], &["b"])).negotiate();
            assert!(robot.has_record(|r| matches!(r, Record::Decided { agreement: None, .. })));
            robot.mission.current_user()
        };
        assert_eq!(served(Fallback::FirstCome), Some(ALICE));
        assert_eq!(served(Fallback::Utilitarian), Some(BOB));
    }
}

mod specifications {
    use super::*;

    fn refused(change: impl FnOnce(&mut Specification)) -> SpecificationError {
        let mut specification = specification();
        change(&mut specification);
        MissionRules::new(&rules(), specification, Options::default(), None).unwrap_err()
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        assert!(matches!(
            refused(|s| s.goals[0].name = "t9".into()),
            SpecificationError::UnlistedGoal { .. }
        ));
        assert!(matches!(refused(|s| s.goals[0].name = "t2".into()), SpecificationError::Twice(_)));
        assert!(matches!(refused(|s| s.goals[0].tasks.clear()), SpecificationError::NothingToDo(_)));
        assert!(matches!(refused(|s| s.limits.users = 1), SpecificationError::Size { .. }));
        let most = |s: &mut Specification| {
            (s.limits.users, s.limits.conditions, s.limits.requests) = (255, 60_000, 255);
        };
        assert!(matches!(refused(most), SpecificationError::Size { what: "limits", .. }));
        assert!(matches!(
            refused(|s| s.emergencies[0].goal = "nap".into()),
            SpecificationError::UnlistedGoal { .. }
        ));
        assert!(matches!(
            refused(|s| {
                s.normative.insert("mall".into(), [("Z".to_owned(), 1)].into());
            }),
            SpecificationError::Unknown { .. }
        ));
    }

    #[test]
    fn a_specification_and_an_event_survive_being_written() {
        let text = serde_json::to_string(&specification()).unwrap();
        assert_eq!(serde_json::from_str::<Specification>(&text).unwrap(), specification());
        let mut robot = Environment::new();
        robot.request(ALICE, "t1");
        let event = Event::Data { user: ALICE, ask: robot.ask_of(ALICE).unwrap(), data: alice() };
        let text = serde_json::to_string(&event).unwrap();
        assert_eq!(serde_json::from_str::<Event>(&text).unwrap(), event);
        assert!(serde_json::to_string(&robot.all).is_ok());
    }

    #[test]
    fn rules_without_conditions_will_do() {
        let rules = Rules::parse(("a", "{}"), ("i", r#"{"t1": [], "t2": [], "t3": [], "fly": []}"#));
        let mut robot = Environment::under(&rules.unwrap(), specification(), Options::default(), None);
        robot.request(ALICE, "t1").data(ALICE, alice());
        robot.request(BOB, "t2").data(BOB, bob_who_insists()).negotiate();
        assert_eq!(robot.mission.current_user(), Some(ALICE));
    }
}
