//! `selfneg explain`: what each level says, and what it must not say.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod random_mission;
mod rewriting;
mod scaffold;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proptest::prelude::*;
use scaffold::folders::{Place, lists};
use scaffold::program::{document, refusal, selfneg};
use selfneg::audit::Redecided;
use selfneg::case::Case;
use selfneg::explain::{
    Audience, AuditorDecision, Basis, Change, ExplainError, Explained, OtherOrder, explain,
};
use selfneg::run::run;
use selfneg::scenario::Scenario;
use selfneg::trace::schema::evidence::Evidence;
use selfneg::trace::schema::evidence::record::Record;
use selfneg::trace::{Open, Recording, Step, TraceWriter};
use serde_json::Value;

const SCENARIOS: [&str; 6] = ["mall", "three_users", "emergency", "elevator", "withholding", "annotated"];

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenarios/{name}.toml"))
}

/// The example scenarios, driven once for all tests.
static EXAMPLES: LazyLock<Vec<(&str, Recording)>> =
    LazyLock::new(|| SCENARIOS.map(|name| (name, recorded(&example(name)))).to_vec());

fn recorded(scenario: &Path) -> Recording {
    let scenario = Scenario::open(scenario).unwrap();
    let mut writer = TraceWriter::plain(Vec::new()).unwrap();
    run(&scenario, &mut [&mut writer]).unwrap();
    Recording::read(&writer.into_inner().unwrap()).unwrap()
}

/// Sentences and JSON of everything that an audience is told.
fn all_that_is_said(recording: &Recording, audience: Audience) -> String {
    let explained = explain(recording, audience, None).unwrap();
    let texts: Vec<String> = explained.iter().map(|one| one.told().text()).collect();
    format!("{}\n{}", texts.join("\n"), serde_json::to_string_pretty(&explained).unwrap())
}

fn for_auditor(recording: &Recording) -> Vec<AuditorDecision> {
    let explained = explain(recording, Audience::Auditor, None).unwrap();
    let auditor = |one| match one {
        Explained::Auditor(decision) => *decision,
        other => panic!("{other:?}"),
    };
    explained.into_iter().map(auditor).collect()
}

/// The same trace as if nothing personal had ever been written.
fn without_personal(recording: &Recording) -> Recording {
    let mut open = recording.clone();
    open.rules = None;
    open.participants.clear();
    for entry in &mut open.entries {
        match &mut entry.step {
            Step::Event { personal, .. } => *personal = None,
            Step::Reply { personal, .. } => personal.clear(),
        }
    }
    open
}

/// What the public is told, but for whether the decision was made again.
fn but_for_the_check(recording: &Recording) -> Value {
    let mut said = serde_json::to_value(explain(recording, Audience::Public, None).unwrap()).unwrap();
    for one in said.as_array_mut().unwrap() {
        one["redecided"] = Value::Null;
        for section in one["told"]["sections"].as_array_mut().unwrap() {
            let sentences = section["sentences"].as_array_mut().unwrap();
            sentences.retain(|one| !one.as_str().unwrap().starts_with("The decision was"));
        }
    }
    said
}

/// A place of people with nothing ordinary about them: every name and number is one that no
/// sentence has by itself.
struct Canaries(Place);

const USERS: [&str; 3] = ["Qaxandra", "Qborvin", "Qcymbel"];

impl Canaries {
    /// Each user has a condition that only it has, and one that all share.
    fn new() -> Self {
        let place = Place::of_letters();
        let rows: Vec<(String, Vec<String>)> = ["xqone", "xqtwo", "xqthree", "xqshared"]
            .iter()
            .map(|name| (format!("cond-{name}"), vec![format!("disp-{name}")]))
            .collect();
        let all: Vec<String> = rows.iter().flat_map(|(_, row)| row.clone()).collect();
        place.write("disposition_activation.json", &lists(&rows)).write(
            "ethical_implications.json",
            &lists(&[("goal-xqleft".to_owned(), all.clone()), ("goal-xqright".to_owned(), all)]),
        );
        let user = |name: &str, own: &str, ranks: [u8; 4]| {
            format!(
                r#"
[[users]]
name = "{name}"
stands = {{ x = {x}, y = 5.4 }}
leaves = true
profiles.place-xqmall = {{ "disp-xqone" = {}, "disp-xqtwo" = {}, "disp-xqthree" = {}, "disp-xqshared" = {} }}
status = {{ "cond-{own}" = true, "cond-xqshared" = true }}
context = {{ location = "place-xqmall" }}
"#,
                ranks[0],
                ranks[1],
                ranks[2],
                ranks[3],
                x = match own {
                    "xqone" => 24.6,
                    "xqtwo" => 12.4,
                    _ => 15.6,
                },
            )
        };
        let users = [
            user(USERS[0], "xqone", [131, 167, 211, 149]),
            user(USERS[1], "xqtwo", [229, 181, 139, 157]),
            user(USERS[2], "xqthree", [173, 227, 193, 163]),
        ];
        let request = |user: &str, goal: &str, meet: &str, when: &str| {
            format!(
                "\n[[requests]]\nuser = \"{user}\"\ngoal = \"{goal}\"\nmeet = \"{meet}\"\nwhen = {when}\n"
            )
        };
        let goal = |name: &str, place: &str| {
            format!(
                r#"
[[mission.goals]]
name = "{name}"
needs = ["drive"]
tasks = [{{ name = "guide", interruptible = true, actions = ["go to meet them", "to {place}"] }}]
"#
            )
        };
        let head = r#"name = "Canaries"
about = "Nobody in particular."
building = "mall"
start = "charging station"
rules = "."
until = 600

[mission]
capabilities = ["drive"]
"#;
        let actions = r#"
[actions]
"go to meet them" = "meet"
"to bathroom" = { guide = "bathroom" }
"to pharmacy" = { guide = "pharmacy" }
"#;
        let two = [
            request(USERS[0], "goal-xqleft", "flowers", "{ at = 1 }"),
            request(USERS[1], "goal-xqright", "information", "{ at = 30 }"),
        ];
        let third = request(USERS[2], "goal-xqright", "information", "{ at = 30.2 }");
        let goals = goal("goal-xqleft", "bathroom") + &goal("goal-xqright", "pharmacy");
        let common = format!("{head}{goals}{actions}");
        place.write("two.toml", &format!("{common}{}{}{}", users[0], users[1], two.concat()));
        place.write("three.toml", &format!("{common}{}{}{third}", users.concat(), two.concat()));
        Self(place)
    }

    fn recorded(&self, which: &str) -> Recording {
        let recording = recorded(&self.0.of(which));
        assert!(recording.decisions() > 0, "{which}");
        recording
    }
}

/// Every whole number in a text of 100 or more: larger than any count or pseudonym here. What
/// follows a point is no whole number.
fn large_numbers(text: &str) -> BTreeSet<u64> {
    let words = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let whole = words.filter_map(|word| word.trim_end_matches('.').parse::<u64>().ok());
    whole.filter(|&number| number >= 100).collect()
}

/// What is somebody's, by user: words, and numbers.
fn private_to(decisions: &[AuditorDecision], user: u32) -> (BTreeSet<String>, BTreeSet<u64>) {
    let (mut words, mut numbers) = (BTreeSet::new(), BTreeSet::new());
    for decision in decisions {
        for one in decision.users.iter().filter(|one| one.user == user) {
            words.insert(one.name.clone());
            words.insert(one.goal.clone());
            words.extend(one.conditions.iter().cloned());
            numbers.insert(one.own_worth);
            numbers.extend(one.ranks.iter().map(|(_, rank)| u64::from(*rank)));
        }
        for round in decision.transcripts.iter().flat_map(|transcript| &transcript.rounds) {
            // What an offer is worth tells of its sender as much as of its receiver.
            if round.sender == user || round.receiver == user {
                numbers.extend(round.value);
            }
        }
        let welfare = decision.welfare.iter().flat_map(|welfare| &welfare.of_serving);
        numbers.extend(welfare.map(|(_, worth)| *worth));
    }
    (words, numbers)
}

#[test]
fn the_public_is_told_nothing_personal() {
    let canaries = Canaries::new();
    for which in ["two.toml", "three.toml"] {
        let recording = canaries.recorded(which);
        let said = all_that_is_said(&recording, Audience::Public);
        assert!(!said.contains("xq") && !said.contains("Q"), "{said}");
        let told = for_auditor(&recording);
        let said_numbers = large_numbers(&said);
        for user in recording.header.participants.clone() {
            let (_, numbers) = private_to(&told, user);
            assert!(numbers.len() > 5);
            assert!(said_numbers.is_disjoint(&numbers), "{said_numbers:?} {numbers:?}\n{said}");
        }
        // The auditor is told all of it, so these words and numbers could have been found.
        let everything = all_that_is_said(&recording, Audience::Auditor);
        for name in &USERS[..recording.header.participants.len()] {
            assert!(everything.contains(name));
        }
        assert!(everything.contains("cond-xqone") && everything.contains("disp-xqshared"));
        assert!(large_numbers(&everything).len() > 10);
    }
}

#[test]
fn a_user_is_told_nothing_of_another() {
    let canaries = Canaries::new();
    for which in ["two.toml", "three.toml"] {
        let recording = canaries.recorded(which);
        let told = for_auditor(&recording);
        for user in recording.header.participants.clone() {
            let said = all_that_is_said(&recording, Audience::User(user));
            let (own_words, own_numbers) = private_to(&told, user);
            let own_numbers: BTreeSet<u64> = {
                // Only the user's own ranks and what they add up to over the user's own offer.
                let own = told.iter().flat_map(|one| &one.users).filter(|one| one.user == user);
                let own = own.flat_map(|one| {
                    one.ranks.iter().map(|(_, rank)| u64::from(*rank)).chain([one.own_worth])
                });
                own.filter(|number| own_numbers.contains(number)).collect()
            };
            assert!(own_words.iter().any(|word| said.contains(word)), "{said}");
            for other in recording.header.participants.iter().filter(|&&other| other != user) {
                let (words, numbers) = private_to(&told, *other);
                // A goal that both have, and the list of conditions that the rules have, are no
                // secret of the other's; that a condition is true of the other is.
                for word in words.difference(&own_words) {
                    let as_own_change = format!("Had {word:?} been true of you too");
                    let quoted = format!("\"added\": {word:?}");
                    let elsewhere = said.replace(&as_own_change, "").replace(&quoted, "");
                    let elsewhere = elsewhere.replace(&as_own_change.replace('"', "\\\""), "");
                    assert!(!elsewhere.contains(word.as_str()), "{word} of {other} told to {user}:\n{said}");
                }
                let forbidden: BTreeSet<u64> = numbers.difference(&own_numbers).copied().collect();
                assert!(
                    large_numbers(&said).is_disjoint(&forbidden),
                    "numbers of {other} told to {user}: {forbidden:?}\n{said}"
                );
            }
            assert!(!said.contains("disp-xq") || said.contains("weighs"), "{said}");
        }
    }
}

#[test]
fn the_example_scenarios_are_told_without_what_is_not_to_be_told() {
    for (name, recording) in EXAMPLES.iter() {
        let rules = recording.rules.clone().unwrap();
        let said = all_that_is_said(recording, Audience::Public);
        let listed = rules.activation.iter().chain(&rules.implications);
        let of_rules = listed.flat_map(|row| std::iter::once(&row.name).chain(&row.dispositions));
        let of_people = recording.participants.iter().flat_map(|who| {
            let stated = who.status.iter().map(|stated| &stated.condition);
            stated.chain([&who.name, &who.person, &who.location]).chain(&who.goal)
        });
        for word in of_rules.chain(of_people).filter(|word| !word.is_empty()) {
            assert!(!said.contains(word.as_str()), "{name}: {word}\n{said}");
        }
        for who in &recording.participants {
            let said = all_that_is_said(recording, Audience::User(who.user));
            let own: BTreeSet<&str> = who.status.iter().map(|stated| stated.condition.as_str()).collect();
            for other in recording.participants.iter().filter(|other| other.user != who.user) {
                assert!(!said.contains(&other.name), "{name}: {} to {}\n{said}", other.name, who.name);
                for stated in other.status.iter().filter(|stated| !own.contains(stated.condition.as_str())) {
                    let told_as_own = said
                        .replace(&format!("Had \\\"{}\\\" been true of you too", stated.condition), "")
                        .replace(&format!("Had {:?} been true of you too", stated.condition), "")
                        .replace(&format!("\"added\": {:?}", stated.condition), "");
                    let quoted = format!("{:?}", stated.condition);
                    assert!(!told_as_own.contains(&quoted), "{name}: {quoted} to {}\n{said}", who.name);
                }
            }
        }
    }
}

#[test]
fn the_public_is_told_what_open_records_alone_say() {
    for (name, recording) in EXAMPLES.iter() {
        assert_eq!(but_for_the_check(recording), but_for_the_check(&without_personal(recording)), "{name}");
    }
    let canaries = Canaries::new();
    for which in ["two.toml", "three.toml"] {
        let recording = canaries.recorded(which);
        assert_eq!(but_for_the_check(&recording), but_for_the_check(&without_personal(&recording)));
    }
}

#[test]
fn random_missions_are_explained_as_they_were_decided() {
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    });
    let missions = (random_mission::choices(), random_mission::options(), random_mission::policy());
    let mut same_order = 0_u32;
    let mut other_order = 0_u32;
    let counts = std::cell::RefCell::new((&mut same_order, &mut other_order));
    runner
        .run(&missions, |(choices, options, policy)| {
            let recording = Recording::read(&random_mission::trace(choices, options, policy)).unwrap();
            prop_assert_eq!(but_for_the_check(&recording), but_for_the_check(&without_personal(&recording)));
            let told = for_auditor(&recording);
            prop_assert_eq!(u64::try_from(told.len()).unwrap(), recording.decisions());
            for (decision, case) in told.iter().zip(recording.cases()) {
                prop_assert_eq!(decision.redecided, Redecided::Same);
                prop_assert_eq!(&decision.missing, &None);
                let Basis::Negotiated(negotiated) = &decision.open.basis else { continue };
                let Case::Negotiated(case) = case else { panic!("{case:?}") };
                let inputs = case.inputs.unwrap();
                // What is said of the other order from open records is what comes of it.
                let mut swapped = inputs.clone();
                swapped.users.swap(0, 1);
                let first = negotiated.participants[0];
                let by_place = swapped.decide().unwrap().served;
                let served_first_before = decision.open.served == Some(first);
                let same_person = (by_place == 1) == served_first_before;
                match negotiated.other_order {
                    OtherOrder::Same => {
                        prop_assert!(same_person, "{:?}", decision.open);
                        *counts.borrow_mut().0 += 1;
                    }
                    OtherOrder::Other => {
                        prop_assert!(!same_person, "{:?}", decision.open);
                        *counts.borrow_mut().1 += 1;
                    }
                    OtherOrder::NotKnown => {}
                }
                let what_if = decision.counterfactual.as_ref().unwrap();
                for changed in what_if.smallest.iter().chain(&what_if.single) {
                    prop_assert_ne!(Some(changed.served), decision.open.served);
                }
                for user in &negotiated.participants {
                    let own =
                        explain(&recording, Audience::User(*user), Some(decision.open.decision)).unwrap();
                    prop_assert_eq!(own.len(), 1);
                }
            }
            Ok(())
        })
        .unwrap();
    println!("the other order: {same_order} the same, {other_order} another");
    assert!(same_order + other_order >= 5, "{same_order}, {other_order}");
}

/// The program on a trace that holds personal data in the open.
fn told(name: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace.mcap");
    simulate(name, &trace, &["--plaintext"]);
    let output = selfneg().arg("explain").arg(&trace).args(arguments).assert().success().get_output().clone();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    String::from_utf8(output.stdout).unwrap()
}

fn simulate(name: &str, trace: &Path, arguments: &[&str]) {
    selfneg().arg("simulate").arg(example(name)).arg("--trace").arg(trace).args(arguments).assert().success();
}

#[test]
fn the_mall_for_anybody() {
    insta::assert_snapshot!(told("mall", &["--level", "public"]));
}

#[test]
fn the_mall_for_bob() {
    insta::assert_snapshot!(told("mall", &["--user", "Bob"]));
}

#[test]
fn the_mall_for_alice() {
    insta::assert_snapshot!(told("mall", &["--user", "user-1"]));
}

#[test]
fn the_mall_for_the_auditor() {
    insta::assert_snapshot!(told("mall", &[]));
}

#[test]
fn three_users_for_the_auditor() {
    insta::assert_snapshot!(told("three_users", &["1"]));
}

#[test]
fn three_users_for_carol() {
    insta::assert_snapshot!(told("three_users", &["--user", "Carol"]));
}

#[test]
fn an_emergency_for_anybody() {
    insta::assert_snapshot!(told("emergency", &["1", "--level", "public"]));
}

#[test]
fn the_mall_as_json() {
    for (name, arguments) in [
        ("public", &["--level", "public"][..]),
        ("user", &["--user", "2"]),
        ("auditor", &["--level", "auditor"]),
    ] {
        let mut document: Value =
            serde_json::from_str(&told("mall", &[arguments, &["--json"]].concat())).unwrap();
        assert_eq!(document["level"], name);
        document["trace"] = "[trace]".into();
        insta::assert_json_snapshot!(format!("the_mall_as_json_{name}"), document);
    }
}

#[test]
fn in_the_mall_nothing_smaller_than_two_conditions_would_have_helped_bob() {
    let recording = recorded(&example("mall"));
    let [decision] = for_auditor(&recording).try_into().unwrap();
    let what_if = decision.counterfactual.unwrap();
    assert!(what_if.single.is_empty());
    let changes = what_if.smallest.unwrap().changes;
    assert!(changes.iter().all(|change| matches!(change, Change::Withheld { user: 1, .. })), "{changes:?}");
    // Alice disclosed one of two, and with less she would not have stayed.
    let alice = decision.disclosure.iter().find(|side| side.sender == 1).unwrap();
    assert_eq!((alice.disclosed, alice.conditions, alice.least, alice.exact), (1, 2, Some(1), true));
}

#[test]
fn a_false_record_is_called_wrong() {
    let mut recording = recorded(&example("mall"));
    for entry in &mut recording.entries {
        if let Step::Reply { open: Open::Record(open), .. } = &mut entry.step
            && let Some(Record::Decided(decided)) = &mut open.record
        {
            decided.served = 2;
            decided.agreement = Some(2);
        }
    }
    let [decision] = for_auditor(&recording).try_into().unwrap();
    assert_eq!(decision.redecided, Redecided::Differs);
    assert_eq!((decision.counterfactual, decision.welfare), (None, None));
    assert!(decision.missing.is_some());
    for audience in [Audience::Public, Audience::User(2), Audience::Auditor] {
        assert!(all_that_is_said(&recording, audience).contains("is wrong"));
    }
    // A single round that is false is enough.
    let mut recording = recorded(&example("mall"));
    for entry in &mut recording.entries {
        if let Step::Reply { personal, .. } = &mut entry.step {
            for reply in personal {
                if let Some(selfneg::trace::schema::personal::reply::Reply::Worth(worth)) = &mut reply.reply {
                    worth.value += 1;
                }
            }
        }
    }
    let [decision] = for_auditor(&recording).try_into().unwrap();
    assert_eq!(decision.redecided, Redecided::Differs);
}

#[test]
fn an_emergency_without_the_evidence_it_needs_is_called_wrong() {
    let mut recording = recorded(&example("emergency"));
    for entry in &mut recording.entries {
        if let Step::Reply { open: Open::Record(open), .. } = &mut entry.step
            && let Some(Record::EmergencyDecided(known)) = &mut open.record
        {
            known.set_evidence(Evidence::Claimed);
        }
    }
    let explained = explain(&recording, Audience::Public, Some(1)).unwrap();
    assert!(explained[0].is_wrong());
    assert!(explained[0].told().answer[1].contains("should not have acted on it"));
}

#[test]
fn willingness_counts_in_what_the_own_request_weighs() {
    // Alice is close to her goal, which is worth 1 to her; what Bob offers is not worth more.
    let place = Place::mall();
    let text = fs::read_to_string(example("mall")).unwrap();
    let text =
        text.replace("../mall", ".").replace("[mission]\n", "[protocol]\nwillingness = 3\n\n[mission]\n");
    let text = text.replace("[mission]\n", "[mission]\nwillingness = { from-percent = 0 }\n");
    place.write("mall.toml", &text);
    let recording = recorded(&place.of("mall.toml"));
    let [auditor] = for_auditor(&recording).try_into().unwrap();
    assert_eq!((auditor.users[0].own_worth, auditor.users[0].willingness), (7, 3));
    assert_eq!(auditor.transcripts[0].rounds[0].threshold, Some(10));
    let [Explained::User(own)] = &explain(&recording, Audience::User(1), None).unwrap()[..] else { panic!() };
    let own = own.own.as_ref().unwrap();
    assert_eq!((own.own_worth, own.willingness), (7, 3));
    let [Explained::User(bobs)] = &explain(&recording, Audience::User(2), None).unwrap()[..] else {
        panic!()
    };
    assert_eq!(bobs.own.as_ref().unwrap().willingness, 0);
}

#[test]
fn what_cannot_be_explained_is_refused() {
    let recording = recorded(&example("mall"));
    let open = without_personal(&recording);
    assert!(matches!(explain(&open, Audience::Auditor, None), Err(ExplainError::NothingPersonal { .. })));
    assert!(matches!(explain(&open, Audience::User(1), None), Err(ExplainError::NothingPersonal { .. })));
    assert!(matches!(
        explain(&recording, Audience::Public, Some(2)),
        Err(ExplainError::NoSuchDecision { asked: 2, there: 1 })
    ));
    assert!(matches!(explain(&recording, Audience::User(7), None), Err(ExplainError::NoSuchUser { .. })));

    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace.mcap");
    simulate("mall", &trace, &["--plaintext"]);
    let refused = |arguments: &[&str]| {
        let mut command = selfneg();
        command.current_dir(folder.path()).args(["explain", "trace.mcap"]).args(arguments);
        refusal(&mut command, folder.path())
    };
    insta::assert_snapshot!(
        [
            refused(&["2"]),
            refused(&["0"]),
            refused(&["--level", "user"]),
            refused(&["--level", "public", "--user", "Bob"]),
            refused(&["--user", "Bobby"]),
            refused(&["--user", "user-7"]),
            refused(&["--identity", "trace.mcap"]),
        ]
        .join("\n")
    );
    simulate("mall", &trace, &[]);
    insta::assert_snapshot!("left_out", refused(&["--level", "auditor"]));
    let mut command = selfneg();
    command.current_dir(folder.path()).args(["explain", "nothing.mcap"]);
    assert!(refusal(&mut command, folder.path()).contains("nothing.mcap"));
    fs::write(folder.path().join("text.mcap"), "no trace").unwrap();
    let mut command = selfneg();
    command.current_dir(folder.path()).args(["explain", "text.mcap"]);
    assert!(refusal(&mut command, folder.path()).contains("text.mcap"));
}

#[test]
fn a_sealed_trace_needs_the_key_for_more_than_the_public_level() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    selfneg().arg("keygen").arg("--out").arg(at("keys")).assert().success();
    selfneg().arg("keygen").arg("--out").arg(at("others")).assert().success();
    let key = at("keys/auditor.key");
    simulate(
        "three_users",
        &at("trace.mcap"),
        &[
            "--sign",
            at("keys/robot.key").to_str().unwrap(),
            "--seal",
            at("keys/auditor.pub").to_str().unwrap(),
        ],
    );
    let explain = || {
        let mut command = selfneg();
        command.current_dir(folder.path()).args(["explain", "trace.mcap"]);
        command
    };
    let public = document(&mut explain(), 0);
    assert_eq!(public["level"], "public");
    assert_eq!(public["decisions"][0]["redecided"], "unchecked");
    let recipient = fs::read_to_string(at("keys/auditor.pub")).unwrap();
    for arguments in [
        &["--level", "auditor"][..],
        &["--user", "Bob"],
        &["--identity", "others/auditor.key"],
        &["--user", "2", "--identity", "others/auditor.key"],
    ] {
        let complaint = refusal(explain().args(arguments), folder.path());
        assert!(complaint.contains(recipient.trim()) && complaint.contains("--identity"), "{complaint}");
    }
    let auditor = document(explain().arg("--identity").arg(&key), 0);
    assert_eq!(auditor["level"], "auditor");
    assert_eq!(auditor["decisions"][0]["redecided"], "same");
    let open = document(explain().args(["--level", "public", "--identity"]).arg(&key), 0);
    assert_eq!(open["decisions"][0]["redecided"], "same");
    assert!(!open.to_string().contains("Bob"));

    // Carol is erased: of the decision she took part in nothing more can be said.
    selfneg().arg("erase").arg(at("trace.mcap")).arg("user-3").assert().success();
    let erased = document(explain().arg("--identity").arg(&key), 0);
    let decision = &erased["decisions"][0];
    assert_eq!(decision["redecided"], "unchecked");
    assert!(decision["missing"].as_str().unwrap().contains("user 3"), "{decision}");
    assert!(decision["counterfactual"].is_null());
    let own = document(explain().args(["--user", "2", "--identity"]).arg(&key), 0);
    assert!(own["decisions"][0]["own"].is_null());
}

#[test]
fn a_cut_trace_is_explained_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace.mcap");
    simulate("emergency", &trace, &["--plaintext"]);
    let whole = fs::read(&trace).unwrap();
    fs::write(&trace, &whole[..whole.len() - 2_000]).unwrap();
    let output = selfneg().arg("explain").arg(&trace).assert().code(1).get_output().clone();
    let warning = String::from_utf8(output.stderr).unwrap();
    assert!(warning.contains("what comes before it is explained"), "{warning}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("somebody has fallen"));
}
