//! The scenarios of `examples/scenarios`: who is served in which order, what is recorded, and
//! the stories, as they are told.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;
mod watching;

use std::path::Path;
use std::time::Duration;

use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use scaffold::program::selfneg;
use selfneg::mission::{Closing, Command, Dropped, Event, GoalEnd, Output, Record, Served, UserId};
use selfneg::run::{Ended, HowItEnded, Outcome, Sketch, Storybook, Watcher, run};
use selfneg::scenario::{OnDisk, Scenario};
use selfneg_sim::World;
use watching::Log;

const ALICE: UserId = UserId(1);
const BOB: UserId = UserId(2);
const ALL: [&str; 6] = ["mall", "three_users", "emergency", "elevator", "withholding", "annotated"];

fn scenario(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenarios");
    Scenario::open(&folder.join(name).with_extension("toml")).unwrap()
}

/// Runs one of the scenarios.
fn played(name: &str) -> (Outcome, Log, String) {
    let (mut log, mut story) = (Log::default(), Storybook::default());
    let outcome = run(&scenario(name), &mut [&mut log, &mut story]).unwrap();
    (outcome, log, story.to_text())
}

#[test]
fn every_run_ends_with_every_request_and_nothing_of_anybody_is_left() {
    for name in ALL {
        let (outcome, log, _) = played(name);
        assert!(outcome.is_all_right(), "{name}: {outcome:#?}");
        let left = log.records().filter(|record| matches!(record, Record::Wiped { left: 1.., .. })).count();
        assert_eq!(left, 0, "{name}");
        let wiped = |user| log.records().any(|r| matches!(r, Record::Wiped { user: of, .. } if *of == user));
        for participant in &scenario(name).participants {
            assert!(wiped(participant.pseudonym), "{name}: {participant:?}");
        }
    }
}

#[test]
fn the_same_scenario_gives_the_same_calls_of_a_watcher() {
    for name in ALL {
        let (first, second) = (played(name), played(name));
        assert!(!first.1.lines.is_empty());
        assert_eq!(first.1.lines.join("\n"), second.1.lines.join("\n"), "{name}");
        assert_eq!(first.0, second.0);
    }
}

#[test]
fn a_watcher_is_shown_events_before_replies_and_time_never_goes_back() {
    for name in ALL {
        let (_, log, _) = played(name);
        assert!(log.lines.first().unwrap().contains("begin"), "{name}");
        assert!(log.lines.last().unwrap().contains("end"), "{name}");
        assert!(log.times.is_sorted(), "{name}");
        let longest = log.shown.windows(2).map(|two| two[1] - two[0]).max().unwrap();
        assert!(longest <= Duration::from_millis(220), "{name}: {longest:?}");
        let decided = log.lines.iter().filter(|line| line.contains(" decided")).count();
        let decisions = log
            .records()
            .filter(|record| matches!(record, Record::Decided { .. } | Record::EmergencyDecided { .. }))
            .count();
        assert_eq!(decided, decisions, "{name}");
    }
}

#[test]
fn in_the_mall_alice_keeps_precedence_and_bob_is_served_after_her() {
    let (outcome, log, story) = played("mall");
    assert_eq!(outcome.served(), ["Alice", "Bob"]);
    assert_eq!(outcome.ended, Ended::Idle);
    assert!(log.records().any(|record| matches!(
        record,
        Record::Decided { agreement: Some(ALICE), served: ALICE, rounds: 2, .. }
    )));
    assert!(!log.records().any(|record| matches!(record, Record::GoalEnded { end: GoalEnd::Preempted, .. })));
    insta::assert_snapshot!("mall", story);
}

#[test]
fn of_three_users_each_is_served_after_one_decision() {
    let (outcome, log, story) = played("three_users");
    assert_eq!(outcome.served(), ["Alice", "Bob", "Carol"]);
    assert_eq!(outcome.decisions, 1);
    let negotiations = log.records().filter(|r| matches!(r, Record::NegotiationStarted { .. })).count();
    assert_eq!(negotiations, 3);
    let decided = log.records().find_map(|record| match record {
        Record::Decided { participants, agreement, .. } => Some((participants.len(), *agreement)),
        _ => None,
    });
    assert_eq!(decided, Some((3, None)));
    insta::assert_snapshot!("three_users", story);
}

#[test]
fn a_verified_emergency_breaks_a_negotiation_off_and_goes_first() {
    let (outcome, log, story) = played("emergency");
    assert_eq!(outcome.served(), ["Alice", "Bob"]);
    let records: Vec<&Record> = log.records().collect();
    let at = |wanted: &dyn Fn(&Record) -> bool| records.iter().position(|record| wanted(record)).unwrap();
    let unverified = at(&|record| matches!(record, Record::EmergencyUnverified { .. }));
    let certain = at(&|record| matches!(record, Record::EmergencyDecided { .. }));
    let dropped = at(&|record| matches!(record, Record::NegotiationsDropped { why: Dropped::Emergency }));
    let started = at(&|record| matches!(record, Record::GoalStarted { served: Served::Emergency(_), .. }));
    let reached = at(&|record| {
        matches!(record, Record::GoalEnded { served: Served::Emergency(_), end: GoalEnd::Reached, .. })
    });
    let alice = at(&|record| {
        matches!(record, Record::GoalEnded { served: Served::User(ALICE), end: GoalEnd::Reached, .. })
    });
    assert!(unverified < certain && certain < dropped && dropped < started);
    assert!(started < reached && reached < alice);
    // The claim has had no effect but its record.
    assert_eq!(records.iter().filter(|r| matches!(r, Record::GoalStarted { .. })).count(), 4);
    insta::assert_snapshot!("emergency", story);
}

#[test]
fn nobody_is_asked_while_a_task_must_not_be_interrupted() {
    let (outcome, log, story) = played("elevator");
    assert_eq!(outcome.served(), ["Alice", "Bob"]);
    let asks = log
        .outputs
        .iter()
        .position(|(_, output)| matches!(output, Output::Command(Command::AskData { user: BOB, .. })));
    let ride = log.outputs.iter().position(|(_, output)| {
        matches!(output, Output::Record(Record::TaskStarted { task: 1, interruptible: false, .. }))
    });
    let after = log.outputs.iter().position(|(_, output)| {
        matches!(output, Output::Record(Record::TaskStarted { task: 2, interruptible: true, .. }))
    });
    let requested = log.events.iter().find(|(_, event)| matches!(event, Event::Request { user: BOB, .. }));
    let at = |position: Option<usize>| log.outputs[position.unwrap()].0;
    assert!(at(ride) < requested.unwrap().0 && requested.unwrap().0 < at(after));
    // Between the tasks the robot is at a safe point: there Bob is asked, not before.
    assert!(at(asks) >= at(after), "{:?} {:?}", at(asks), at(after));
    insta::assert_snapshot!("elevator", story);
}

#[test]
fn of_a_user_who_withholds_everything_nothing_is_disclosed() {
    let (outcome, log, story) = played("withholding");
    assert_eq!(outcome.served(), ["Alice", "Dora"]);
    let dora_offers = log.records().any(|record| {
        matches!(record, Record::Round { sender: BOB, round: selfneg::mission::Round::Offer { .. }, .. })
    });
    assert!(!dora_offers, "{story}");
    insta::assert_snapshot!("withholding", story);
}

#[test]
fn the_annotated_scenario_is_told_as_it_says() {
    let (outcome, _, story) = played("annotated");
    assert_eq!(outcome.ended, Ended::ShutDown);
    let how = |user: &str| outcome.requests.iter().find(|request| request.user == user).unwrap().how;
    assert_eq!(how("Alice"), Some(HowItEnded::Closed(Closing::Reached)));
    insta::assert_snapshot!("annotated", story);
}

#[test]
fn the_picture_shows_every_floor_where_the_robot_was() {
    for (name, floors) in [("mall", 1), ("elevator", 2)] {
        let mut sketch = Sketch::default();
        run(&scenario(name), &mut [&mut sketch]).unwrap();
        let drawn = sketch.to_svg();
        assert_eq!(drawn.matches(" floor</tspan>").count(), floors);
        assert!(drawn.contains("keeps precedence"));
    }
    assert_eq!(Sketch::default().to_svg(), "");
}

#[test]
fn simulate_prints_the_story_or_one_document() {
    let run = |flags: &[&str]| {
        let mut command = selfneg();
        command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["simulate", "examples/scenarios/mall.toml"]);
        let output = command.args(flags).assert().code(0).stderr("").get_output().stdout.clone();
        String::from_utf8(output).unwrap()
    };
    let story = run(&[]);
    assert!(story.contains("00:01 Alice asks for the bathroom"), "{story}");
    assert!(story.contains("  Bob (pharmacy): asked at 00:38, served at "), "{story}");
    let document: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    assert_eq!(document["scenario"], "The paper's mall");
    assert_eq!(document["requests"][0]["how"]["closed"], "reached");
    assert_eq!(document["ended"], "idle");
    assert!(document["story"].as_array().unwrap().len() > 20);
}

/// The emergency's scenario with other moments and answers: whatever users do, the run ends by
/// itself, every request is closed, and nothing of anybody is left in memory.
#[test]
fn whatever_happens_when_every_request_comes_to_an_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenarios");
    let text = std::fs::read_to_string(folder.join("emergency.toml")).unwrap();
    let (setting, _) = text.split_at(text.find("[[requests]]").unwrap());
    let answers = prop_oneof![Just("\"never\"".to_owned()), (0.0..3.0).prop_map(|s| format!("{s:.2}"))];
    let when = (0.0..150.0).prop_map(|at| format!("when = {{ at = {at:.2} }}"));
    let happening = prop_oneof![
        3 => (0..3_usize, 0..2_usize).prop_map(|(user, goal)| format!(
            "[[requests]]\nuser = {:?}\ngoal = {:?}\nmeet = \"information\"\n",
            ["Alice", "Bob", "Eve"][user], ["bathroom", "pharmacy"][goal]
        )),
        2 => (0..3_usize).prop_map(|user| format!("[[withdrawals]]\nuser = {:?}\n", ["Alice", "Bob", "Eve"][user])),
        1 => (0..3_usize).prop_map(|user| format!(
            "[[updates]]\nuser = {:?}\nstatus = {{ \"disabled\" = true }}\n", ["Alice", "Bob", "Eve"][user]
        )),
        1 => any::<bool>().prop_map(|fire| format!(
            "[[emergencies]]\ncategory = {:?}\nplace = \"shoes\"\nevidence = \"sensed\"\n",
            if fire { "a fire" } else { "somebody has fallen" }
        )),
    ];
    let cases = (answers.clone(), answers, prop::collection::vec((happening, when), 1..8), any::<bool>());
    let config = ProptestConfig {
        cases: 24,
        failure_persistence: None,
        max_shrink_iters: 16,
        ..ProptestConfig::default()
    };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let ended = runner.run(&cases, |(bob, eve, happenings, shut_down)| {
        let mut text = setting.replace("until = 600", "until = 7200");
        let at = text.rfind("leaves = true").unwrap();
        text.insert_str(at, &format!("answers-after = {bob}\n"));
        text.push_str(&format!(
            "[[users]]\nname = \"Eve\"\nanswers-after = {eve}\nstands = {{ x = 16.0, y = 6.0 }}\n\
             context = {{ location = \"mall\" }}\nprofiles.mall = {{ \"elderly people\" = 5 }}\n"
        ));
        for (what, when) in &happenings {
            text.push_str(&format!("{what}{when}\n"));
        }
        if shut_down {
            text.push_str("[shutdown]\nat = 100\n");
        }
        let base = OnDisk { base: folder.clone() };
        let scenario = Scenario::parse(&text, Path::new("random.toml"), &base).unwrap();
        let mut log = Log::default();
        let outcome = run(&scenario, &mut [&mut log]).unwrap();
        prop_assert!(outcome.ended != Ended::TimeUp, "{}\n{:#?}", text, outcome);
        prop_assert!(outcome.every_request_closed(), "{}\n{:#?}", text, outcome);
        let left = log.records().any(|record| matches!(record, Record::Wiped { left: 1.., .. }));
        prop_assert!(!left, "{}", text);
        Ok(())
    });
    ended.unwrap();
}

/// Where a user is, and where and how fast the robot is, whenever the world is shown.
struct Steps {
    user: &'static str,
    seen: Vec<(Duration, Option<f64>, f64)>,
    reached: Option<usize>,
    abandoned: Option<usize>,
}

impl Watcher for Steps {
    fn output(&mut self, _: Duration, output: &Output) -> std::io::Result<()> {
        match output {
            Output::Record(Record::GoalEnded { end: GoalEnd::Reached, .. }) => {
                self.reached.get_or_insert(self.seen.len());
            }
            Output::Record(Record::GoalEnded { end: GoalEnd::Abandoned, .. }) => {
                self.abandoned.get_or_insert(self.seen.len());
            }
            _ => {}
        }
        Ok(())
    }

    fn world(&mut self, at: Duration, world: &World) -> std::io::Result<()> {
        let robot = world.robot();
        let apart = world.person(self.user).map(|user| user.position.distance(robot.pose.position));
        self.seen.push((at, apart, robot.twist.linear));
        Ok(())
    }
}

impl Steps {
    fn of(name: &str, user: &'static str) -> Self {
        let mut steps = Self { user, seen: Vec::new(), reached: None, abandoned: None };
        run(&scenario(name), &mut [&mut steps]).unwrap();
        steps
    }
}

#[test]
fn a_guided_user_walks_behind_the_robot_and_leaves_when_served() {
    let steps = Steps::of("mall", "Alice");
    let reached = steps.reached.unwrap();
    // From a while after the robot has set out with her until it is there.
    for (at, apart, _) in steps.seen[..reached].iter().filter(|(at, ..)| at.as_secs() >= 20) {
        assert!((0.5..2.0).contains(&apart.unwrap()), "{at:?}: {apart:?}");
    }
    assert_eq!(steps.seen[reached + 1].1, None);
}

#[test]
fn a_robot_that_is_told_to_stop_stands_soon_after() {
    let steps = Steps::of("annotated", "Carol");
    let abandoned = steps.abandoned.unwrap();
    let begin = steps.seen[abandoned].0;
    assert!(steps.seen[abandoned - 1].2 > 0.1, "it was driving");
    let mut after = steps.seen[abandoned..].iter().filter(|(at, ..)| *at > begin + Duration::from_secs(3));
    assert!(after.all(|(.., speed)| *speed == 0.0));
}

/// A watcher that fails ends the run.
#[test]
fn what_keeps_a_watcher_from_recording_ends_the_run() {
    struct Full;
    impl Watcher for Full {
        fn decided(&mut self, _: Duration) -> std::io::Result<()> {
            Err(std::io::Error::other("the disk is full"))
        }
    }
    let (mut log, mut full) = (Log::default(), Full);
    let error = run(&scenario("mall"), &mut [&mut log, &mut full]).unwrap_err();
    assert_eq!(error.to_string(), "the disk is full");
    assert!(!log.lines.last().unwrap().contains("end"));
}
