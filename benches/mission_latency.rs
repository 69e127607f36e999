//! How long a decision takes, from the request that interrupts to its outcome, with the whole
//! life cycle of the interrupter's managers: assigned, filled, snapshot, every round, outcome,
//! wiped. Users answer at once; what they would take is not the robot's time.
//!
//! `cargo bench --bench mission_latency`

#![expect(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    reason = "a benchmark prints, and may stop"
)]

use std::time::{Duration, Instant};

use selfneg::demo;
use selfneg::input::{Rules, Truth};
use selfneg::mission::{
    Command, Event, Goal, GoalId, LOCATION, Mission, MissionRules, Output, Place, Profile, Record,
    Specification, Stated, Task, UserData, UserId,
};
use selfneg_core::Options;

const RUNS: usize = 2_000;

fn specification(goals: &[&str]) -> Specification {
    let task = Task { name: "guide".into(), actions: vec!["drive".into()], interruptible: true };
    let goal = |name: &&str| Goal { name: (*name).to_owned(), tasks: vec![task.clone()], ..Goal::default() };
    Specification { goals: goals.iter().map(goal).collect(), ..Specification::default() }
}

/// Users each of whom has all of `conditions` conditions, and who never agree.
fn stubborn(conditions: usize) -> (Rules, UserData) {
    let names: Vec<String> = (0..conditions).map(|nth| format!("c{nth}")).collect();
    let rows: Vec<String> = names.iter().map(|name| format!("\"{name}\": [\"{name}\"]")).collect();
    let list: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let rules = Rules::parse(
        ("activation", &format!("{{{}}}", rows.join(", "))),
        ("implications", &format!("{{\"g\": [{}]}}", list.join(", "))),
    );
    let data = UserData {
        profiles: vec![Profile {
            label: "mall".into(),
            ranks: names.iter().map(|name| (name.as_str().into(), 3)).collect(),
        }],
        status: names
            .iter()
            .map(|name| Stated { condition: name.as_str().into(), truth: Truth::True })
            .collect(),
        context: vec![(LOCATION.into(), "mall".into())],
    };
    (rules.unwrap(), data)
}

/// One decision of a fresh mission among `users`, the first of whom is served; the time from
/// the first interruption to the last outcome, and how many rounds it took.
fn decide(rules: &MissionRules, users: &[(GoalId, UserData)]) -> (Duration, u32) {
    let (mut mission, _) = Mission::new(rules.clone());
    let mut queue: Vec<Event> = Vec::new();
    let mut rounds = 0;
    let mut answers: Vec<UserData> = users.iter().map(|(_, data)| data.clone()).collect();
    let mut began = None;
    for (nth, (goal, _)) in users.iter().enumerate() {
        if nth == 1 {
            began = Some(Instant::now());
        }
        let user = UserId(u32::try_from(nth).unwrap());
        queue.push(Event::Request { user, goal: *goal, place: Place(0) });
        // Interrupters come together: all are asked before anybody answers.
        if nth > 0 && nth + 1 < users.len() {
            continue;
        }
        queue.reverse();
        while let Some(event) = queue.pop() {
            for output in mission.handle(event) {
                match output {
                    Output::Command(Command::AskData { user, ask, .. }) => {
                        let data = std::mem::take(&mut answers[usize::try_from(user.0).unwrap()]);
                        queue.insert(0, Event::Data { user, ask, data });
                    }
                    Output::Command(Command::NextRound) => queue.push(Event::NextRound),
                    Output::Record(Record::Decided { rounds: played, .. }) => rounds = played,
                    _ => {}
                }
            }
        }
    }
    let took = began.expect("somebody interrupts").elapsed();
    assert_eq!(mission.holds_data_of().len(), 1);
    assert!(rounds > 0);
    (took, rounds)
}

fn measure(name: &str, rules: &MissionRules, users: &[(GoalId, UserData)]) {
    let mut times: Vec<Duration> = Vec::with_capacity(RUNS);
    let mut rounds = 0;
    for _ in 0..RUNS {
        let (took, played) = decide(rules, users);
        times.push(took);
        rounds = played;
    }
    times.sort_unstable();
    let at = |share: usize| times[(RUNS - 1) * share / 100];
    println!(
        "{name:<44} {rounds:>4} rounds   median {:>9.1?}   99 % {:>9.1?}   longest {:>9.1?}",
        at(50),
        at(99),
        at(100)
    );
}

fn main() {
    println!("request to outcome, {RUNS} decisions each, one thread");
    let rules = MissionRules::new(
        &demo::rules().unwrap(),
        specification(&["bathroom", "pharmacy"]),
        Options::default(),
        None,
    )
    .unwrap();
    let alice = (rules.goal("bathroom").unwrap(), UserData::from(&demo::alice().unwrap()));
    let bob = (rules.goal("pharmacy").unwrap(), UserData::from(&demo::bob().unwrap()));
    measure("the paper's mall, two users", &rules, &[alice.clone(), bob.clone()]);
    measure("the paper's mall, Bob twice", &rules, &[alice, bob.clone(), bob]);
    for conditions in [6, 10, 60] {
        let (source, data) = stubborn(conditions);
        let rules = MissionRules::new(&source, specification(&["g"]), Options::default(), None).unwrap();
        let user = (rules.goal("g").unwrap(), data);
        measure(
            &format!("two users of {conditions} conditions, no agreement"),
            &rules,
            &[user.clone(), user],
        );
    }
}
