//! The tables of `audit --parquet`, through the program: the same totals as its JSON, nothing
//! personal, and no half file.
//!
//! `.ci/parquet-readers` reads them with an independent reader, on many more traces.

#![expect(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "it is a test")]

#[path = "../examples/generate_fleet/run.rs"]
#[allow(unreachable_pub, reason = "shared with the example")]
mod run;
mod scaffold;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::Output;
use std::sync::OnceLock;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use rayon::prelude::*;
use scaffold::program::selfneg;
use serde_json::Value;
use tempfile::TempDir;

/// One that is cut, one that is changed, one that is plain, one with somebody erased, and
/// some with nothing wrong.
const SEEDS: [u64; 12] = [1, 2, 3, 4, 5, 6, 7, 8, 50, 60, 70, 80];

fn fleet() -> &'static Path {
    static FLEET: OnceLock<TempDir> = OnceLock::new();
    let made = || {
        let folder = TempDir::new().unwrap();
        let keys = run::Keys::generate().unwrap();
        fs::write(folder.path().join("robot.pub"), keys.robot.public().to_pem().unwrap()).unwrap();
        fs::write(folder.path().join("auditor.key"), keys.auditor.to_text().as_bytes()).unwrap();
        SEEDS.par_iter().for_each(|&seed| {
            let trace = run::trace(seed, &keys).unwrap();
            fs::write(folder.path().join(format!("robot-{seed:02}.mcap")), trace).unwrap();
        });
        fs::write(folder.path().join("robot-99.mcap"), "not a trace").unwrap();
        folder
    };
    FLEET.get_or_init(made).path()
}

fn audit(identity: bool, arguments: &[&str]) -> Output {
    let mut command = selfneg();
    command.current_dir(fleet()).args(["audit", ".", "--robot-key", "robot.pub"]).args(arguments);
    if identity {
        command.args(["--identity", "auditor.key"]);
    }
    command.output().unwrap()
}

fn tables(identity: bool) -> (TempDir, String) {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("new").join("tables");
    let done = audit(identity, &["--parquet", out.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
    (folder, String::from_utf8(done.stdout).unwrap())
}

type Rows = Vec<BTreeMap<String, Field>>;

fn rows(folder: &TempDir, table: &str) -> Rows {
    let path = folder.path().join("new/tables").join(format!("{table}.parquet"));
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| row.unwrap().into_columns().into_iter().collect()).collect()
}

fn number(field: &Field) -> Option<i64> {
    match field {
        Field::Long(number) => Some(*number),
        Field::Null => None,
        other => panic!("{other}"),
    }
}

fn text(field: &Field) -> Option<&str> {
    match field {
        Field::Str(text) => Some(text),
        Field::Null => None,
        other => panic!("{other}"),
    }
}

fn document(identity: bool) -> Value {
    let done = audit(identity, &["--json"]);
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn the_tables_say_what_the_json_says() {
    for identity in [true, false] {
        let (folder, _) = tables(identity);
        let (traces, decisions) = (rows(&folder, "traces"), rows(&folder, "decisions"));
        let document = document(identity);
        let documented = document["traces"].as_array().unwrap();
        assert_eq!(traces.len(), SEEDS.len() + 1);
        let mut of_trace = decisions.iter();
        for (row, trace) in traces.iter().zip(documented) {
            assert_eq!(text(&row["file"]), trace["file"].as_str());
            assert_eq!(text(&row["status"]), trace["status"].as_str());
            assert_eq!(text(&row["robot_key"]), trace["seal"]["key"].as_str());
            for column in ["decisions", "redecided"] {
                assert_eq!(number(&row[column]), trace[column].as_i64(), "{column}");
            }
            let findings = trace["findings"].as_array().unwrap().len();
            assert_eq!(number(&row["findings"]), i64::try_from(findings).ok());
            for one in trace["each_decision"].as_array().unwrap() {
                let row = of_trace.next().unwrap();
                assert_eq!(text(&row["file"]), trace["file"].as_str());
                assert_eq!(text(&row["trace_status"]), trace["status"].as_str());
                assert_eq!(number(&row["decision"]), one["decision"].as_i64());
                assert_eq!(number(&row["rounds"]), one["rounds"].as_i64());
                assert_eq!(text(&row["redecided"]), one["redecided"].as_str());
                let outcome = text(&row["outcome"]).or(text(&row["kind"]));
                assert_eq!(outcome, one["outcome"].as_str());
                let served = number(&row["served"]).map(|user| format!("user-{user}"));
                assert_eq!(served.as_deref(), one["served"].as_str());
                for (column, key) in
                    [("welfare_served", "served"), ("welfare_optimum", "optimum"), ("regret", "regret")]
                {
                    assert_eq!(number(&row[column]), one["welfare"][key].as_i64(), "{column}");
                }
            }
        }
        assert_eq!(of_trace.next(), None);
        // What was made again, and what it was worth, of a fleet that is sealed but for one.
        let worth = decisions.iter().filter(|row| number(&row["regret"]).is_some()).count();
        assert_eq!(worth > 2, identity, "{worth}");
    }
}

#[test]
fn the_rounds_are_those_of_the_decisions() {
    let (folder, _) = tables(true);
    let (decisions, rounds) = (rows(&folder, "decisions"), rows(&folder, "rounds"));
    let key = |row: &BTreeMap<String, Field>| {
        (text(&row["file"]).unwrap().to_owned(), number(&row["decision"]).unwrap())
    };
    let mut of_decision: BTreeMap<_, Rows> = BTreeMap::new();
    for round in rounds {
        of_decision.entry(key(&round)).or_default().push(round);
    }
    for decision in &decisions {
        let rounds = of_decision.remove(&key(decision)).unwrap_or_default();
        assert_eq!(i64::try_from(rounds.len()).ok(), number(&decision["rounds"]));
        let (participants, disclosed) = (list(&decision["participants"]), list(&decision["disclosed"]));
        assert_eq!(participants.len(), disclosed.len());
        for (user, disclosed) in participants.iter().zip(disclosed) {
            let own = rounds.iter().filter(|round| number(&round["sender"]) == Some(*user));
            let deepest = own.filter_map(|round| number(&round["depth"])).max();
            assert_eq!(deepest.unwrap_or(0), disclosed);
        }
        for round in &rounds {
            let is_offer = text(&round["event"]) == Some("offer");
            assert_eq!(is_offer, number(&round["depth"]).is_some());
            assert_eq!(is_offer, text(&round["verdict"]).is_some());
        }
    }
    assert!(of_decision.is_empty(), "rounds of no decision");
    assert!(decisions.len() > 8);
}

fn list(field: &Field) -> Vec<i64> {
    match field {
        Field::ListInternal(list) => list.elements().iter().map(|one| number(one).unwrap()).collect(),
        other => panic!("{other}"),
    }
}

/// Conditions and dispositions of the generated users; ranks are too common as numbers to be
/// looked for, and have no column.
#[test]
fn no_cell_names_a_condition_a_goal_or_a_user() {
    let (folder, printed) = tables(true);
    let rules = selfneg::demo::rules().unwrap();
    let mut words: Vec<String> = ["User 1", "User 2", "bathroom", "pharmacy"].map(str::to_owned).into();
    for (condition, dispositions) in rules.activation {
        words.push(condition);
        words.extend(dispositions);
    }
    let mut seen = 0;
    for table in ["traces", "decisions", "rounds"] {
        for row in rows(&folder, table) {
            for (column, field) in row {
                if let Field::Str(text) = field {
                    seen += 1;
                    assert!(words.iter().all(|word| !text.contains(word)), "{table}.{column}: {text}");
                }
            }
        }
    }
    assert!(seen > 100);
    assert!(words.iter().all(|word| !printed.contains(word)));
}

#[test]
fn a_path_that_cannot_be_opened_is_a_row() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("new/tables");
    let done = audit(true, &["not-there.mcap", "--parquet", out.to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(said.starts_with("warning: not-there.mcap: cannot be read: "), "{said}");
    let traces = rows(&folder, "traces");
    assert_eq!(traces.len(), SEEDS.len() + 2);
    let last = traces.last().unwrap();
    assert_eq!((text(&last["file"]), text(&last["status"])), (Some("not-there.mcap"), Some("unreadable")));
}

#[test]
fn the_summary_alone_is_printed() {
    let (folder, printed) = tables(true);
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), 2, "{printed}");
    assert!(lines[0].starts_with("13 traces: "), "{printed}");
    let rounds = rows(&folder, "rounds").len();
    assert!(lines[1].contains(&format!("13 traces, {} decisions", rows(&folder, "decisions").len())));
    assert!(lines[1].contains(&format!("{rounds} rounds")), "{printed}");
}

#[test]
fn nothing_is_left_of_an_export_that_fails_and_the_older_one_stays() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("tables");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("traces.parquet"), "older").unwrap();
    let audit = |traces: &str| {
        let mut command = selfneg();
        command.current_dir(fleet()).args(["audit", traces, "--parquet"]).arg(&out);
        command.output().unwrap()
    };
    assert_eq!(audit("not-there.mcap").status.code(), Some(2));
    let names = || {
        let mut names: Vec<_> = fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["traces.parquet"]);
    assert_eq!(fs::read_to_string(out.join("traces.parquet")).unwrap(), "older");

    assert_eq!(audit("robot-01.mcap").status.code(), Some(1));
    assert_eq!(names(), ["decisions.parquet", "rounds.parquet", "traces.parquet"]);
    assert!(fs::read(out.join("traces.parquet")).unwrap().starts_with(b"PAR1"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let done = audit(true, &["--parquet", file.join("tables").to_str().unwrap()]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(said.contains("file/tables: cannot be written: "), "{said}");
}
