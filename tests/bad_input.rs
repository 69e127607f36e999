//! Input that cannot be used: exit code 2, and one line that names file, key and what was
//! expected. Never a panic.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use scaffold::folders::Place;
use scaffold::program::{negotiate, refusal, selfneg};
use selfneg::binding::{BoundRules, GoalChoice};
use selfneg::input::{InputError, Rules, User};
use selfneg::lint::{lint_rules, lint_user};
use selfneg::precedence::{Policy, decide};
use selfneg::record::DecisionRecord;
use selfneg::story;
use selfneg_core::Options;

const PROFILES: &str = "Alice/ethic_profiles.json";
const STATUS: &str = "Bob/user_status.json";
const CONTEXT: &str = "Alice/context.json";
const GOAL: &str = "Bob/goal.json";
const ACTIVATION: &str = "disposition_activation.json";
const IMPLICATIONS: &str = "ethical_implications.json";
const FILES: [&str; 6] = [PROFILES, STATUS, CONTEXT, GOAL, ACTIVATION, IMPLICATIONS];

/// What `negotiate` says of the mall with one file replaced.
fn told_of(file: &str, bytes: &[u8]) -> String {
    let place = Place::mall();
    place.write_bytes(file, bytes);
    told_in(&place)
}

fn told_in(place: &Place) -> String {
    let told = refusal(&mut negotiate(place, &["Alice", "Bob"], &[]), place.path());
    told.strip_prefix("./").unwrap_or(&told).to_owned()
}

#[test]
fn a_file_that_is_not_there() {
    for file in FILES.into_iter().filter(|&file| file != GOAL) {
        let place = Place::mall();
        fs::remove_file(place.of(file)).unwrap();
        let told = told_in(&place);
        assert!(told.starts_with(&format!("{file}: cannot be read: No such file")), "{told}");
    }
    let place = Place::mall();
    let told = refusal(&mut negotiate(&place, &["Alice", "Carol"], &[]), place.path());
    assert!(told.starts_with("Carol: cannot be read"), "{told}");
    let told = refusal(selfneg().args(["lint", "--rules", "/nowhere/to/be/found"]), place.path());
    assert!(told.starts_with("/nowhere/to/be/found/disposition_activation.json: cannot be read"), "{told}");
}

#[test]
fn a_rank_that_is_none() {
    for (rank, found) in [
        ("-1", "-1"),
        ("2.5", "2.5"),
        ("5.0", "5.0"),
        ("1e0", "1.0"),
        ("-0", "-0.0"),
        ("256", "256"),
        ("18446744073709551616", "1.8446744073709552e+19"),
        ("99999999999999999999", "1e+20"),
        (r#""3""#, r#"the text "3""#),
        ("true", "true"),
        ("null", "null"),
        ("[3]", "a list"),
        ("{}", "an object"),
    ] {
        let profiles = format!(r#"{{"mall": {{"elderly people": {rank}}}}}"#);
        let expected = format!(
            "{PROFILES}: mall: elderly people: expected a rank: a whole number from 0 to 255, found {found}"
        );
        assert_eq!(told_of(PROFILES, profiles.as_bytes()), expected);
    }
}

#[test]
fn a_bad_rank_in_a_profile_that_is_not_active() {
    let told = told_of(PROFILES, br#"{"mall": {"elderly people": 1}, "airport": {"elderly people": 300}}"#);
    assert!(told.starts_with(&format!("{PROFILES}: airport: elderly people: expected a rank")), "{told}");
}

#[test]
fn a_number_beyond_all_numbers() {
    for number in ["1e400", "-1e400"] {
        let told = told_of(PROFILES, format!(r#"{{"mall": {{"elderly people": {number}}}}}"#).as_bytes());
        assert!(
            told.starts_with(&format!(
                "{PROFILES}: not valid JSON: mall: elderly people: number out of range"
            ))
        );
        assert!(told.contains("line 1 column"), "{told}");
    }
}

#[test]
fn ranks_0_and_255_are_taken() {
    let place = Place::mall();
    place.write(PROFILES, r#"{"mall": {"elderly people": 0, "people in urgency": 255}}"#);
    negotiate(&place, &["Alice", "Bob"], &[]).assert().code(0);
}

#[test]
fn a_condition_that_is_neither_true_nor_false() {
    for (value, found) in [
        (r#""false""#, r#"the text "false""#),
        ("0", "0"),
        ("1", "1"),
        ("[]", "a list"),
        (r#"{"value": true}"#, "an object"),
    ] {
        let told = told_of(STATUS, format!(r#"{{"tall": true, "elderly": {value}}}"#).as_bytes());
        assert_eq!(
            told,
            format!("{STATUS}: elderly: expected true, false, or null if withheld, found {found}")
        );
    }
}

#[test]
fn a_location_without_profile() {
    assert_eq!(
        told_of(CONTEXT, br#"{"location": "moon"}"#),
        format!(
            "{CONTEXT}: location: \"moon\" has no ethical profile, expected one of \"mall\" of {PROFILES}"
        )
    );
    let place = Place::mall();
    place.write(PROFILES, "{}");
    assert!(told_in(&place).contains("there are none"));
}

#[test]
fn a_context_without_location() {
    assert_eq!(
        told_of(CONTEXT, br#"{"place": "mall"}"#),
        format!("{CONTEXT}: has no key \"location\", expected the label of the user's ethical profile")
    );
    for (value, found) in [("3", "3"), ("null", "null"), (r#"["mall"]"#, "a list")] {
        assert_eq!(
            told_of(CONTEXT, format!(r#"{{"location": {value}}}"#).as_bytes()),
            format!("{CONTEXT}: location: expected the label of the user's ethical profile, found {found}")
        );
    }
}

#[test]
fn a_goal_that_is_none() {
    assert_eq!(
        told_of(GOAL, br#"{"goal": "moon"}"#),
        format!(
            "{GOAL}: goal \"moon\" is not listed, expected one of \"bathroom\", \"pharmacy\" of ./{IMPLICATIONS}"
        )
    );
    assert_eq!(told_of(GOAL, b"{}"), format!("{GOAL}: has no key \"goal\", expected the goal's name"));
    assert_eq!(told_of(GOAL, br#"{"goal": 7}"#), format!("{GOAL}: goal: expected the goal's name, found 7"));
}

#[test]
fn rules_that_are_no_lists_of_dispositions() {
    for file in [ACTIVATION, IMPLICATIONS] {
        assert_eq!(
            told_of(file, br#"{"elderly": "elderly people"}"#),
            format!("{file}: elderly: expected a list of dispositions, found the text \"elderly people\"")
        );
        for (item, found) in [("3", "3"), ("null", "null"), ("[]", "a list"), (r#"{"d": 1}"#, "an object")] {
            assert_eq!(
                told_of(file, format!(r#"{{"elderly": ["elderly people", {item}]}}"#).as_bytes()),
                format!("{file}: elderly: expected a disposition's name in quotes, found {found}")
            );
        }
    }
}

#[test]
fn a_key_twice() {
    for (file, text, key) in [
        (PROFILES, r#"{"mall": {}, "mall": {}}"#, "mall"),
        (PROFILES, r#"{"mall": {"a": 1, "b": 2, "a": 1}}"#, "mall: a"),
        (PROFILES, r#"{"mall": {"a": [{"x": 1, "x": 1}]}}"#, "mall: a: x"),
        (STATUS, r#"{"elderly": true, "elderly": true}"#, "elderly"),
        (STATUS, r#"{"elderly": true, "\u0065lderly": null}"#, "elderly"),
        (CONTEXT, r#"{"location": "mall", "location": "mall"}"#, "location"),
        (CONTEXT, r#"{"location": "mall", "time": {"day": 1, "day": 2}}"#, "time: day"),
        (GOAL, r#"{"goal": "pharmacy", "goal": "pharmacy"}"#, "goal"),
        (ACTIVATION, r#"{"elderly": [], "elderly": []}"#, "elderly"),
        (ACTIVATION, r#"{"elderly": [[{"x": 1, "x": 1}]]}"#, "elderly: x"),
        (IMPLICATIONS, r#"{"bathroom": [], "pharmacy": [], "bathroom": []}"#, "bathroom"),
    ] {
        let expected = format!("{file}: {key}: this key stands here twice, expected each key once");
        assert_eq!(told_of(file, text.as_bytes()), expected, "{text}");
    }
}

#[test]
fn a_key_that_would_not_be_seen() {
    let told = told_of(PROFILES, br#"{"mall": {"": -1}}"#);
    assert!(told.starts_with(&format!("{PROFILES}: mall: \"\": expected a rank")), "{told}");
    let told = told_of(PROFILES, br#"{"mall": {"two\nlines\u001b[2J": -1}}"#);
    assert!(
        told.starts_with(&format!(r#"{PROFILES}: mall: "two\nlines\u{{1b}}[2J": expected a rank"#)),
        "{told}"
    );
}

#[test]
fn names_with_line_breaks_do_not_break_a_warning() {
    let place = Place::mall();
    place.write(STATUS, r#"{"two\nlines\u001b[2J": true}"#);
    let output = negotiate(&place, &["Alice", "Bob"], &[]).assert().code(0).get_output().clone();
    for said in [output.stdout, output.stderr] {
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains(r"two\nlines\u{1b}[2J"), "{said}");
        assert!(!said.contains('\u{1b}'), "{said}");
    }
}

#[test]
fn the_wrong_kind_of_document() {
    for file in FILES {
        for (text, found) in
            [("[]", "a list"), ("7", "7"), (r#""text""#, "the text \"text\""), ("null", "null")]
        {
            let told = told_of(file, text.as_bytes());
            assert!(told.starts_with(&format!("{file}: expected an object")), "{told}");
            assert!(told.ends_with(&format!("found {found}")), "{told}");
        }
    }
    let told = told_of(PROFILES, br#"{"mall": [1, 2]}"#);
    assert_eq!(told, format!("{PROFILES}: mall: expected an object {{disposition: rank}}, found a list"));
}

#[test]
fn what_is_not_json() {
    for file in FILES {
        for (bytes, said) in [
            (&b""[..], "not valid JSON: EOF while parsing a value at line 1 column 0"),
            (b"   \n", "not valid JSON: EOF"),
            (b"{", "not valid JSON: EOF while parsing an object"),
            (b"{'mall': 1}", "not valid JSON: key must be a string at line 1 column 2"),
            (b"{} {}", "not valid JSON: trailing characters at line 1 column 4"),
            (b"{\"a\": [1,]}", "not valid JSON: a: trailing comma at line 1 column 10"),
            (b"{\"a\": NaN}", "not valid JSON: a: expected value at line 1 column 7"),
            (b"\xef\xbb\xbf{}", "not valid JSON: begins with a byte order mark, expected UTF-8 without one"),
            (b"{\"caf\xe9\": 1}", "cannot be read: stream did not contain valid UTF-8"),
            (b"\xff\xfe{\0}\0", "cannot be read: stream did not contain valid UTF-8"),
        ] {
            let told = told_of(file, bytes);
            assert!(told.starts_with(&format!("{file}: {said}")), "{told}");
        }
    }
}

#[test]
fn what_is_too_deep() {
    let lists = format!("{}{}", "[".repeat(200), "]".repeat(200));
    let objects = format!("{}1{}", r#"{"a":"#.repeat(200), "}".repeat(200));
    for file in FILES {
        for text in [&lists, &objects, &"[".repeat(100_000)] {
            let told = told_of(file, text.as_bytes());
            assert!(told.starts_with(&format!("{file}: not valid JSON: ")), "{told}");
            assert!(told.contains("recursion limit exceeded"), "{told}");
        }
    }
}

#[test]
fn a_folder_in_place_of_a_file() {
    for file in FILES {
        let place = Place::mall();
        fs::remove_file(place.of(file)).unwrap();
        fs::create_dir(place.of(file)).unwrap();
        let told = told_in(&place);
        assert!(told.starts_with(&format!("{file}: cannot be read: Is a directory")), "{told}");
    }
}

#[test]
fn a_file_in_place_of_a_folder() {
    let place = Place::mall();
    let told = refusal(&mut negotiate(&place, &["Alice", "Bob/goal.json"], &[]), place.path());
    assert!(told.starts_with("Bob/goal.json/ethic_profiles.json: cannot be read: Not a directory"), "{told}");
    let told = refusal(&mut negotiate(&place, &["Alice", "/"], &[]), place.path());
    assert_eq!(told, "/: names no folder, expected a user folder");
}

#[test]
fn more_than_the_engine_takes() {
    let many = |value: &str| {
        let entries: Vec<String> = (0..70_000).map(|n| format!("\"c{n}\": {value}")).collect();
        format!("{{{}}}", entries.join(","))
    };
    for (file, text, what) in [
        (STATUS, many("true"), "conditions"),
        (ACTIVATION, many("[]"), "conditions"),
        (IMPLICATIONS, format!(r#"{{"pharmacy": [{}]}}"#, ["\"d\""; 256].join(",")), "mentions"),
    ] {
        let told = told_of(file, text.as_bytes());
        assert!(told.starts_with(&format!("{file}: more than ")) && told.contains(what), "{told}");
    }
}

/// Takes the mall's texts in-process, decides and tells it, as `negotiate` and `lint` do.
fn take_it_all(text: impl Fn(&'static str) -> String) -> Result<String, InputError> {
    let rules = Rules::parse((ACTIVATION, &text(ACTIVATION)), (IMPLICATIONS, &text(IMPLICATIONS)))?;
    let mut bound = BoundRules::new(rules.clone())?;
    let mut said: Vec<String> = lint_rules(&rules).iter().map(ToString::to_string).collect();
    let mut users = Vec::new();
    for (name, files) in [
        ("Alice", [PROFILES, "Alice/user_status.json", CONTEXT, "Alice/goal.json"]),
        ("Bob", ["Bob/ethic_profiles.json", STATUS, "Bob/context.json", GOAL]),
    ] {
        let texts = files.map(&text);
        let user = User::parse(name, Path::new(name), texts.each_ref().map(String::as_str))?;
        said.extend(lint_user(&rules, &user, true).iter().map(ToString::to_string));
        users.push(bound.bind(&user, &GoalChoice::OwnFile)?);
    }
    let decision = decide(&bound, &users, Options::default(), Policy::Published).unwrap();
    said.push(story::tell(&decision, &users, &bound));
    said.push(serde_json::to_string(&DecisionRecord::new(&decision, &users, &bound)).unwrap());
    Ok(said.concat())
}

/// One change to a file.
#[derive(Clone, Debug)]
enum Mutation {
    Replace(prop::sample::Index, u8),
    Insert(prop::sample::Index, u8),
    Remove(prop::sample::Index),
    Truncate(prop::sample::Index),
    Repeat(prop::sample::Index, prop::sample::Index),
}

impl Mutation {
    fn apply(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let length = bytes.len();
        match self {
            Self::Replace(at, byte) => bytes[at.index(length)] = *byte,
            Self::Insert(at, byte) => bytes.insert(at.index(length), *byte),
            Self::Remove(at) => {
                bytes.remove(at.index(length));
            }
            Self::Truncate(at) => bytes.truncate(at.index(length)),
            Self::Repeat(from, to) => {
                let (from, to) = (from.index(length), to.index(length));
                let piece = bytes[from.min(to)..from.max(to)].to_vec();
                bytes.splice(to..to, piece);
            }
        }
    }
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let at = any::<prop::sample::Index>;
    // Bytes that mean something in JSON, and any others.
    let byte = || prop_oneof![3 => prop::sample::select(b"{}[]\",:0123456789-.eE \ntfn\\".to_vec()), 1 => any::<u8>()];
    prop_oneof![
        4 => (at(), byte()).prop_map(|(at, byte)| Mutation::Replace(at, byte)),
        2 => (at(), byte()).prop_map(|(at, byte)| Mutation::Insert(at, byte)),
        2 => at().prop_map(Mutation::Remove),
        1 => at().prop_map(Mutation::Truncate),
        1 => (at(), at()).prop_map(|(from, to)| Mutation::Repeat(from, to)),
    ]
}

/// Whatever is done to a valid file, it is taken or refused with the name of one of the
/// files, and nothing panics.
#[test]
fn no_change_to_a_valid_file_makes_it_panic() {
    let place = Place::mall();
    let texts: HashMap<&str, String> = FILES
        .into_iter()
        .chain(["Alice/user_status.json", "Alice/goal.json", "Bob/ethic_profiles.json", "Bob/context.json"])
        .map(|file| (file, fs::read_to_string(place.of(file)).unwrap()))
        .collect();
    let config = Config { cases: 5_000, failure_persistence: None, ..Config::default() };
    let changes = (prop::sample::select(FILES.to_vec()), prop::collection::vec(mutation(), 1..4));
    let verdict = TestRunner::new(config).run(&changes, |(changed, mutations)| {
        let mut bytes = texts[changed].clone().into_bytes();
        for mutation in &mutations {
            mutation.apply(&mut bytes);
        }
        let spoiled = String::from_utf8_lossy(&bytes);
        match take_it_all(|file| if file == changed { spoiled.to_string() } else { texts[file].clone() }) {
            Ok(said) => prop_assert!(said.contains("Alice")),
            Err(error) => {
                let said = error.to_string();
                prop_assert!(FILES.iter().any(|file| said.contains(file)), "{}", said);
            }
        }
        Ok(())
    });
    verdict.unwrap();
}
