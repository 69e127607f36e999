//! The ways in which the published nodes fail, each as a scenario with the right behaviour.
//! The same event orders are among those that the model checker explores.

mod mission_environment;

use std::path::Path;

use mission_environment::{
    ALICE, BOB, CAROL, Environment, alice, alice_who_defers, bob_who_defers, bob_who_insists, data,
};
use selfneg::input::{InputError, User};
use selfneg::mission::{Closing, Command, Event, Output, Record, Text, Unusable, Waiting};

#[test]
fn a_user_without_true_conditions_does_not_hang_the_negotiation() {
    let mut robot = Environment::serving(alice());
    robot.request(BOB, "t2").data(BOB, data([1, 1, 1], &[])).negotiate();
    assert!(robot.has_record(|r| matches!(r, Record::Decided { served: ALICE, .. })));
    assert_eq!(robot.held(), [ALICE]);

    let mut robot = Environment::serving(data([1, 1, 1], &[]));
    robot.request(BOB, "t2").data(BOB, data([1, 1, 1], &[])).negotiate();
    assert!(robot.has_record(|r| matches!(r, Record::Decided { agreement: None, served: ALICE, .. })));
    assert_eq!(robot.held(), [ALICE]);
}

/// In the published system Carol would be negotiated with Bob's profile.
#[test]
fn a_user_whose_profile_never_arrives_is_not_negotiated_with_the_previous_ones() {
    let mut robot = Environment::serving(alice());
    robot.request(BOB, "t2").data(BOB, bob_who_defers()).negotiate();
    assert_eq!(robot.held(), [ALICE]);
    robot.request(CAROL, "t2");
    let before = robot.all.len();
    robot.timeout(CAROL);
    assert!(!robot.all[before..].iter().any(|output| matches!(
        output,
        Output::Record(Record::NegotiationStarted { .. } | Record::Round { .. } | Record::Decided { .. })
    )));
    assert!(robot.has_record(|r| *r == Record::DataMissing { user: CAROL }));
    assert_eq!((robot.mission.current_user(), robot.held()), (Some(ALICE), vec![ALICE]));
}

/// The same, seen from the memory: what a manager held is not there for its next user.
#[test]
fn a_profile_of_another_user_does_not_decide_for_users_who_have_none_of_their_own() {
    let decide = |with_bob_before: bool| {
        let mut robot = Environment::serving(alice_who_defers());
        if with_bob_before {
            robot.request(BOB, "t2").data(BOB, data([9, 9, 9], &["c"])).negotiate();
        }
        let mut carol = data([0, 0, 0], &["b"]);
        carol.profiles.clear();
        robot.request(CAROL, "t2").data(CAROL, carol);
        robot.has_record(|r| *r == Record::DataUnusable { user: CAROL, why: Unusable::UnknownContext })
    };
    assert!(decide(false));
    assert!(decide(true));
}

#[test]
fn an_unknown_context_label_leaves_no_manager_active() {
    let mut robot = Environment::serving(alice());
    let mut lost = bob_who_insists();
    lost.context = vec![("location".into(), "moon".into())];
    robot.request(BOB, "t2").data(BOB, lost);
    assert!(robot.has_record(|r| *r == Record::DataUnusable { user: BOB, why: Unusable::UnknownContext }));
    assert_eq!(robot.held(), [ALICE]);
    assert_eq!(robot.mission.current_user(), Some(ALICE));
    assert_eq!(robot.mission.open_requests(), [ALICE, BOB]);
    assert!(
        robot.last_has(|o| matches!(
            o,
            Output::Command(Command::Wait { user: BOB, why: Waiting::DataUnusable })
        ))
    );
}

#[test]
fn a_second_interruption_during_preparation_is_negotiated_too() {
    let mut robot = Environment::serving(alice());
    robot.request(BOB, "t2").request(CAROL, "t2");
    robot.data(BOB, bob_who_defers()).data(CAROL, data([5, 1, 1], &["c"])).negotiate();
    let everybody = vec![ALICE, BOB, CAROL];
    assert!(
        robot.has_record(|r| matches!(r, Record::Decided { participants, .. } if *participants == everybody))
    );
}

#[test]
fn an_interruption_while_idle_is_answered_at_once() {
    let mut robot = Environment::new();
    robot.request(BOB, "t2");
    assert!(robot.last_has(|o| matches!(o, Output::Command(Command::AskData { user: BOB, .. }))));
    robot.data(BOB, bob_who_insists());
    assert_eq!(robot.mission.current_user(), Some(BOB));
    robot.finish_goal();
    assert_eq!(robot.closed(BOB), Some(Closing::Reached));
    assert!(robot.mission.is_idle());
}

#[test]
fn a_status_that_arrives_after_the_timeout_is_not_used_later() {
    let mut robot = Environment::serving(alice_who_defers());
    robot.request(BOB, "t2");
    let old = robot.ask_of(BOB).unwrap();
    robot.timeout(BOB);
    robot.send(Event::Data { user: BOB, ask: old, data: bob_who_insists() });
    assert!(robot.last_has(|o| matches!(o, Output::Record(Record::Ignored { user: Some(BOB), .. }))));
    assert_eq!(robot.held(), [ALICE]);

    // Bob's turn comes: he is asked again, and the old answer still counts for nothing.
    robot.finish_goal();
    assert_ne!(robot.ask_of(BOB), Some(old));
    robot.send(Event::Data { user: BOB, ask: old, data: bob_who_insists() });
    assert!(robot.last_has(|o| matches!(o, Output::Record(Record::Ignored { user: Some(BOB), .. }))));
    assert_eq!(robot.mission.current_user(), None);
    robot.data(BOB, bob_who_insists());
    assert_eq!(robot.mission.current_user(), Some(BOB));
}

/// Such a file is refused by the reader, so the data do not arrive, and the mission goes on.
#[test]
fn the_text_false_is_not_true() {
    let texts = [
        r#"{"mall": {"A": 1, "B": 5, "C": 1}}"#,
        r#"{"b": "false"}"#,
        r#"{"location": "mall"}"#,
        r#"{"goal": "t2"}"#,
    ];
    let read = User::parse("Bob", Path::new("Bob"), texts);
    assert!(matches!(read, Err(InputError::Unexpected { .. })));

    let event = r#"{"event": "status", "user": 2, "condition": "b", "truth": "false"}"#;
    assert!(serde_json::from_str::<Event>(event).is_err());
    let event = r#"{"event": "status", "user": 2, "condition": "b", "truth": null}"#;
    let withheld = selfneg::input::Truth::Withheld;
    let expected = Event::Status { user: BOB, condition: Text::from("b"), truth: withheld };
    assert_eq!(serde_json::from_str::<Event>(event).unwrap(), expected);

    let mut robot = Environment::serving(alice_who_defers());
    robot.request(BOB, "t2").timeout(BOB);
    assert_eq!((robot.mission.current_user(), robot.held()), (Some(ALICE), vec![ALICE]));
}
