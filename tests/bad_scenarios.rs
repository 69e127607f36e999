//! Scenarios that cannot be used, and scenarios in which something cannot be done: a clear
//! error and exit code 2, or a recorded failure; never a hang.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;
use std::path::Path;

use scaffold::program::{document, refusal, selfneg};
use tempfile::TempDir;

/// The examples in a folder of their own, to be spoiled.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples"), place.folder.path());
        place
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.folder.path().join("scenarios").join(name), text).unwrap();
    }

    /// The mall's scenario with `from` made `to`.
    fn spoil(&self, from: &str, to: &str) {
        self.spoil_of("mall", from, to);
    }

    fn spoil_of(&self, scenario: &str, from: &str, to: &str) {
        let file = self.folder.path().join(format!("scenarios/{scenario}.toml"));
        let text = fs::read_to_string(file).unwrap();
        assert!(text.contains(from), "{from:?}");
        self.write("spoilt.toml", &text.replacen(from, to, 1));
    }

    fn simulate(&self) -> assert_cmd::Command {
        let mut command = selfneg();
        command.timeout(std::time::Duration::from_secs(120));
        command.current_dir(self.folder.path().join("scenarios")).args(["simulate", "spoilt.toml"]);
        command
    }

    /// What is said of a spoilt scenario, after its name.
    fn refused(&self) -> String {
        refusal(&mut self.simulate(), self.folder.path())
    }
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let (entry, target) = (entry.as_ref().unwrap().path(), to.join(entry.as_ref().unwrap().file_name()));
        if entry.is_dir() {
            fs::create_dir_all(&target).unwrap();
            copy(&entry, &target);
        } else {
            fs::copy(entry, target).unwrap();
        }
    }
}

/// One floor of 4 m x 2 m, with a wall across it if `divided`.
fn small_house(place: &Place, divided: bool, places: &str) {
    let mut image = String::from("P2 40 20 255\n");
    for row in 0..20 {
        for column in 0..40 {
            let wall = row == 0 || row == 19 || column == 0 || column == 39 || (divided && column == 20);
            image.push_str(if wall { "0 " } else { "254 " });
        }
    }
    place.write("house.pgm", &image);
    place.write(
        "house_map.yaml",
        "image: house.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    );
    place.write(
        "house.yaml",
        &format!("floors:\n  - name: only\n    map: house_map.yaml\n    places:\n{places}"),
    );
}

const HOUSE: &str = r#"
name = "House"
building = "house.yaml"
start = "left"
rules = "../mall"
until = 120
[mission]
goals = [{ name = "bathroom", tasks = [{ name = "go", interruptible = true, actions = ["go"] }] }]
[actions]
go = "meet"
[[users]]
folder = "../mall/Alice"
[[requests]]
user = "Alice"
meet = "right"
when = { at = 1 }
"#;

const PLACES: &str = "      - {name: left, x: 1.0, y: 1.0}\n      - {name: right, x: 3.0, y: 1.0}\n";

#[test]
fn whatever_is_wrong_is_named_with_its_key_and_what_was_expected() {
    let place = Place::new();
    let mut wrong = Vec::new();
    for (from, to, told) in [
        (
            "start = \"charging station\"",
            "start = \"roof\"",
            "spoilt.toml: start: no place named \"roof\"; there are: entrance",
        ),
        ("building = \"mall\"", "building = \"castle.yaml\"", "spoilt.toml: building: castle.yaml: "),
        (
            "rules = \"../mall\"",
            "rules = \"../none\"",
            "spoilt.toml: rules: ../none/disposition_activation.json: cannot be read",
        ),
        (
            "folder = \"../mall/Alice\"",
            "folder = \"../mall/Eve\"",
            "spoilt.toml: users[0].folder: ../mall/Eve: cannot be read",
        ),
        (
            "folder = \"../mall/Alice\"",
            "folder = \"../mall/Bob\"",
            "spoilt.toml: users[1].name: \"Bob\" is there already",
        ),
        ("until = 300", "until = -1", "spoilt.toml: until: expected 1 to 86400 s, found -1"),
        ("until = 300", "until = nan", "spoilt.toml: until: expected 1 to 86400 s, found NaN"),
        (
            "until = 300",
            "untill = 300",
            "spoilt.toml:12: untill: unknown field `untill`, expected one of `name`, ",
        ),
        (
            "until = 300",
            "until = \"long\"",
            "spoilt.toml:12: until: invalid type: string \"long\", expected f64",
        ),
        (
            "when = { at = 1 }",
            "when = { at = -1 }",
            "spoilt.toml: requests[0].when.at: expected 0 to 86400 s, found -1",
        ),
        (
            "when = { at = 1 }",
            "when = { at = 1, near = \"Bob\" }",
            "spoilt.toml: requests[0].when: expected one of at, near, reaching, found several",
        ),
        (
            "when = { at = 1 }",
            "when = {}",
            "spoilt.toml: requests[0].when: expected one of at, near, reaching, found none",
        ),
        (
            "near = \"Bob\"",
            "near = \"Eve\"",
            "spoilt.toml: requests[1].when.near: there is no person who stands somewhere, or place, \"Eve\", expected one of \"Alice\", \"Bob\", \"entrance\"",
        ),
        (
            "within = 3.5",
            "within = -3.5",
            "spoilt.toml: requests[1].when.within: expected 0 to 1000 m, found -3.5",
        ),
        (
            "answers-after = 1.5",
            "answers-after = -1",
            "spoilt.toml: users[1].answers-after: expected 0 to 86400 s, or \"never\", found -1",
        ),
        (
            "answers-after = 1.5",
            "answers-after = \"soon\"",
            "spoilt.toml: users[1].answers-after: expected 0 to 86400 s, or \"never\", found \"soon\"",
        ),
        (
            "user = \"Alice\"",
            "user = \"Eve\"",
            "spoilt.toml: requests[0].user: there is no user \"Eve\", expected one of \"Alice\", \"Bob\"",
        ),
        (
            "meet = \"flowers\"",
            "meet = \"roof\"",
            "spoilt.toml: requests[0].meet: there is no place \"roof\", expected one of \"entrance\", ",
        ),
        (
            "user = \"Alice\"",
            "goal = \"moon\"\nuser = \"Alice\"",
            "spoilt.toml: requests[0].goal: there is no goal in [[mission.goals]] \"moon\", expected one of \"bathroom\", \"pharmacy\"",
        ),
        (
            "name = \"pharmacy\"",
            "name = \"moon\"",
            "spoilt.toml: mission: ethical implications: goal \"moon\" is not listed",
        ),
        (
            "name = \"pharmacy\"",
            "name = \"bathroom\"",
            "spoilt.toml: mission: \"bathroom\" is specified twice",
        ),
        (
            "\"greet\" = {",
            "\"great\" = {",
            "spoilt.toml: mission.goals[0].tasks[0].actions: there is no action \"greet\", expected one of \"go to meet them\", \"great\"",
        ),
        (
            "{ guide = \"bathroom\" }",
            "{ guide = \"roof\" }",
            "spoilt.toml: actions.guide to the bathroom: there is no place \"roof\"",
        ),
        (
            "{ guide = \"bathroom\" }",
            "{ fly = \"roof\" }",
            "spoilt.toml:36: actions.guide to the bathroom: unknown variant `fly`, expected one of `meet`, `drive`, `guide`, `wait`, `say`",
        ),
        (
            "x = 24.6, y = 3.4",
            "x = 0.1, y = 3.4",
            "spoilt.toml: users[0]: person \"Alice\" cannot get to (0.10, 3.40): a wall is in the way",
        ),
        (
            "x = 24.6, y = 3.4",
            "x = 27.2, y = 8.6",
            "spoilt.toml: users[0]: the robot and person \"Alice\" would overlap",
        ),
        (
            "x = 24.6, y = 3.4",
            "x = 24.6, y = 3.4, floor = \"attic\"",
            "spoilt.toml: users[0].stands.floor: there is no floor \"attic\", expected one of \"ground\", \"upper\"",
        ),
        (
            "[mission]\n",
            "[protocol]\npolicy = \"loudest\"\n[mission]\n",
            "spoilt.toml: protocol.policy: there is no option \"loudest\", expected one of \"published\", \"condorcet\"",
        ),
        ("name = \"The paper's mall\"", "name = The mall", "spoilt.toml:4: "),
    ] {
        place.spoil(from, to);
        let complaint = place.refused();
        if !complaint.starts_with(told) {
            wrong.push(format!("{complaint}\nexpected to begin with\n{told}\n"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_scenario_without_users_or_without_anything_to_happen_is_refused() {
    let place = Place::new();
    let text = fs::read_to_string(place.folder.path().join("scenarios/mall.toml")).unwrap();
    let (before, after) = text.split_at(text.find("[[users]]").unwrap());
    place.write("spoilt.toml", before);
    assert_eq!(place.refused(), "spoilt.toml: users: expected at least one user, found none");
    let (users, _) = after.split_at(after.find("[[requests]]").unwrap());
    place.write("spoilt.toml", &format!("{before}{users}"));
    assert_eq!(
        place.refused(),
        "spoilt.toml: requests: expected at least one request or emergency, found none"
    );
}

#[test]
fn a_missing_or_unreadable_scenario_is_refused() {
    let place = Place::new();
    assert!(place.refused().starts_with("spoilt.toml: cannot be read: "));
    place.write("spoilt.toml", "");
    assert_eq!(place.refused(), "spoilt.toml:1: missing field `name`");
    place.write("spoilt.toml", &"#".repeat((1 << 20) + 1));
    assert_eq!(place.refused(), "spoilt.toml: cannot be read: more than 1 MiB");
}

#[test]
fn a_bad_map_or_a_place_inside_a_wall_is_refused() {
    let place = Place::new();
    place.write("spoilt.toml", HOUSE);
    small_house(&place, false, PLACES);
    place.write("house.pgm", "P2 40 20 255\n0 0 0");
    assert_eq!(
        place.refused(),
        "spoilt.toml: building: house_map.yaml: the PGM image is truncated: 3 of 800 samples"
    );
    small_house(
        &place,
        false,
        "      - {name: left, x: 0.05, y: 1.0}\n      - {name: right, x: 3.0, y: 1.0}\n",
    );
    assert_eq!(
        place.refused(),
        "spoilt.toml: building: \"left\" at (0.05, 1.00) is inside a wall of floor \"only\""
    );
    small_house(
        &place,
        false,
        "      - {name: left, x: 0.2, y: 1.0}\n      - {name: right, x: 3.0, y: 1.0}\n",
    );
    assert!(place.refused().contains("does not fit at \"left\""));
}

#[test]
fn a_goal_that_cannot_be_reached_is_a_recorded_failure() {
    let place = Place::new();
    place.write("spoilt.toml", HOUSE);
    small_house(&place, false, PLACES);
    let reached = document(&mut place.simulate(), 0);
    assert_eq!(reached["requests"][0]["how"]["closed"], "reached");

    small_house(&place, true, PLACES);
    let failed = document(&mut place.simulate(), 1);
    assert_eq!(failed["requests"][0]["how"]["closed"], "failed");
    assert_eq!(failed["failures"][0]["what"], "no way to \"right\" that the robot fits through");
    assert_eq!(failed["ended"], "idle");
}

/// Somebody who stands in the only way: the robot gives up.
#[test]
fn a_way_that_stays_blocked_is_a_recorded_failure() {
    let place = Place::new();
    small_house(&place, false, PLACES);
    let person = "[[people]]\nname = \"A guard\"\nstands = { x = 2.9, y = 1.0 }\n";
    place.write("spoilt.toml", &format!("{HOUSE}{person}"));
    let failed = document(&mut place.simulate(), 1);
    assert_eq!(failed["requests"][0]["how"]["closed"], "failed");
    assert_eq!(failed["failures"][0]["what"], "the way to \"right\" is blocked");
}

#[test]
fn who_never_answers_is_put_off_and_at_last_handed_to_staff() {
    let place = Place::new();
    place.spoil("answers-after = 1.5", "answers-after = \"never\"");
    let told = document(&mut place.simulate(), 0);
    assert_eq!(told["requests"][0]["how"]["closed"], "reached");
    assert_eq!(told["requests"][1]["how"]["closed"]["staff"], "deferred-too-often");
}

#[test]
fn who_answers_too_late_has_no_say() {
    let place = Place::new();
    place.spoil("answers-after = 1.5", "answers-after = 2.5");
    let told = document(&mut place.simulate(), 0);
    assert_eq!(told["decisions"], 0);
    let sentences: Vec<&str> =
        told["story"].as_array().unwrap().iter().map(|told| told["sentence"].as_str().unwrap()).collect();
    assert!(sentences.contains(&"Bob has not answered in time."), "{sentences:?}");
    assert!(sentences.contains(&"That of Bob (data) has no effect any more."), "{sentences:?}");
}

#[test]
fn what_cannot_happen_is_told_when_the_time_is_up() {
    let place = Place::new();
    place.spoil("near = \"Bob\", within = 3.5", "near = \"cinema\"");
    let told = document(&mut place.simulate(), 1);
    assert_eq!(told["ended"], "time-up");
    assert_eq!(told["never-happened"], serde_json::json!(["requests[1]"]));
    place.spoil("until = 300", "until = 20");
    let told = document(&mut place.simulate(), 1);
    assert_eq!((&told["ended"], &told["requests"][0]["how"]), (&"time-up".into(), &serde_json::Value::Null));
}

#[test]
fn a_second_request_of_a_waiting_user_is_refused_and_the_first_kept() {
    let place = Place::new();
    let again = "[[requests]]\nuser = \"Alice\"\nmeet = \"bakery\"\nwhen = { at = 5 }\n\n[[requests]]\nuser = \"Bob\"";
    place.spoil("[[requests]]\nuser = \"Bob\"", again);
    let told = document(&mut place.simulate(), 0);
    assert_eq!(told["requests"][0]["how"]["closed"], "reached");
    assert_eq!(told["requests"][1]["how"]["refused"], "already-asking");
}
