//! A counterexample as folders that `selfneg negotiate` reads, and in words.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use selfneg_core::{Disposition, Options};
use selfneg_proofs::counterexample::{Counterexample, OwnedUser};
use serde_json::{Map, Value, json};

/// A counterexample that was written as folders.
#[derive(Clone, Debug)]
pub struct Written {
    /// The property that it refutes.
    pub name: String,
    /// What the property says, and so what to look for.
    pub statement: &'static str,
    /// The commands that run it: once, and if the property compares two runs, twice.
    pub commands: Vec<String>,
}

/// The folder names of the users, by arrival.
#[must_use]
pub fn user_names(count: usize) -> Vec<String> {
    let interrupting = |nth: usize| match count {
        2 => "interrupting".to_owned(),
        _ => format!("interrupting_{nth}"),
    };
    (0..count).map(|nth| if nth == 0 { "current".to_owned() } else { interrupting(nth) }).collect()
}

/// The counterexample in a few indented lines.
#[must_use]
pub fn describe(found: &Counterexample) -> String {
    let mut text = String::new();
    let rows: Vec<String> = found
        .activation
        .iter()
        .enumerate()
        .map(|(nth, row)| {
            let activated =
                if row.is_empty() { "nothing".to_owned() } else { list(row.iter().map(|d| disposition(*d))) };
            format!("{} activates {activated}", condition(nth))
        })
        .collect();
    let _ = writeln!(text, "      {}", rows.join(", "));
    let names = user_names(found.users.len());
    for (name, user) in names.iter().zip(&found.users) {
        let _ = writeln!(text, "      {name:<14} {}", describe_user(user));
    }
    if let Some(altered) = &found.altered {
        let name = names.get(altered.index).map_or("?", String::as_str);
        let _ = writeln!(text, "      second run, {name} instead: {}", describe_user(&altered.user));
    }
    text
}

fn describe_user(user: &OwnedUser) -> String {
    let conditions = match user.conditions.as_slice() {
        [] => "nothing".to_owned(),
        conditions => list(conditions.iter().map(|c| condition(usize::from(c.0)))),
    };
    let ranks =
        user.ranks.iter().enumerate().map(|(nth, rank)| format!("d{} {}", nth.saturating_add(1), rank.0));
    format!("discloses {conditions}; ranks {}", list(ranks))
}

/// The arguments with which `selfneg negotiate` runs a variant.
#[must_use]
pub fn arguments(options: &Options) -> String {
    let Options { quit, aggregation, tie, fallback, willingness } = options;
    format!(
        "--quit {quit} --aggregation {aggregation} --tie {tie} --fallback {fallback} --willingness {willingness}"
    )
}

/// Writes the counterexample into `folder`: `rules`, one folder a user, and for a two-run
/// property the user of the second run. Returns the commands that run it again; with `swapped`
/// also with the two users' parts swapped.
///
/// # Errors
/// The first file that cannot be written, and why.
pub fn write(
    found: &Counterexample,
    swapped: bool,
    folder: &Path,
) -> Result<Vec<String>, (PathBuf, io::Error)> {
    let rules = folder.join("rules");
    let dispositions = found.users.iter().map(|user| user.ranks.len()).max().unwrap_or(0);
    let names = user_names(found.users.len());
    let mut people: Vec<(String, &OwnedUser)> = names.iter().cloned().zip(&found.users).collect();
    if let Some(altered) = &found.altered {
        let name = names.get(altered.index).map_or("altered", String::as_str);
        people.push((format!("{name}_altered"), &altered.user));
    }
    let implications: Map<String, Value> =
        people.iter().map(|(name, user)| (format!("goal of {name}"), json!(mentioned(user)))).collect();
    document(&rules, "disposition_activation.json", &activation(found))?;
    document(&rules, "ethical_implications.json", &Value::Object(implications))?;
    for (name, user) in &people {
        let ranks: Map<String, Value> = (0..dispositions)
            .map(|nth| {
                let rank = user.ranks.get(nth).map_or(0, |rank| rank.0);
                (format!("d{}", nth.saturating_add(1)), json!(rank))
            })
            .collect();
        let status: Map<String, Value> =
            user.conditions.iter().map(|c| (condition(usize::from(c.0)), json!(true))).collect();
        let person = folder.join(name);
        document(&person, "ethic_profiles.json", &json!({ "here": ranks }))?;
        document(&person, "user_status.json", &Value::Object(status))?;
        document(&person, "context.json", &json!({ "location": "here" }))?;
        document(&person, "goal.json", &json!({ "goal": format!("goal of {name}") }))?;
    }
    let run = |people: &[String]| {
        let folders: Vec<String> = people.iter().map(|name| quoted(&folder.join(name))).collect();
        let (current, interrupting) =
            folders.split_first().map_or((String::new(), &[][..]), |(a, b)| (a.clone(), b));
        format!(
            "selfneg negotiate --rules {} --current {current} --interrupting {} {}",
            quoted(&rules),
            interrupting.join(" "),
            arguments(&found.options)
        )
    };
    let mut commands = vec![run(&names)];
    if let Some(altered) = &found.altered {
        let mut second = names.clone();
        if let Some(name) = second.get_mut(altered.index) {
            name.push_str("_altered");
        }
        commands.push(run(&second));
    }
    if swapped {
        let other_way: Vec<String> = names.iter().rev().cloned().collect();
        commands.push(run(&other_way));
    }
    Ok(commands)
}

/// The counterexample as JSON.
#[must_use]
pub fn to_json(found: &Counterexample) -> Value {
    let user = |user: &OwnedUser| {
        let ranks: Map<String, Value> = user
            .ranks
            .iter()
            .enumerate()
            .map(|(nth, rank)| (format!("d{}", nth.saturating_add(1)), json!(rank.0)))
            .collect();
        let conditions: Vec<String> = user.conditions.iter().map(|c| condition(usize::from(c.0))).collect();
        json!({ "discloses": conditions, "ranks": ranks, "goal_implies": mentioned(user) })
    };
    let names = user_names(found.users.len());
    let users: Map<String, Value> =
        names.iter().zip(&found.users).map(|(name, person)| (name.clone(), user(person))).collect();
    let altered = found
        .altered
        .as_ref()
        .map(|altered| json!({ "instead_of": names.get(altered.index), "user": user(&altered.user) }));
    json!({ "activation": activation(found), "users": users, "second_run": altered, "arguments": arguments(&found.options) })
}

/// A path as a POSIX shell takes it for one word.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

fn activation(found: &Counterexample) -> Value {
    let row = |row: &[Disposition]| json!(row.iter().map(|d| disposition(*d)).collect::<Vec<_>>());
    found.activation.iter().enumerate().map(|(nth, of)| (condition(nth), row(of))).collect()
}

fn mentioned(user: &OwnedUser) -> Vec<String> {
    user.goal
        .iter()
        .enumerate()
        .flat_map(|(nth, &times)| {
            std::iter::repeat_n(format!("d{}", nth.saturating_add(1)), usize::from(times))
        })
        .collect()
}

fn document(folder: &Path, name: &str, content: &Value) -> Result<(), (PathBuf, io::Error)> {
    let file = folder.join(name);
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&file, format!("{content:#}\n")));
    written.map_err(|error| (file, error))
}

fn condition(index: usize) -> String {
    format!("c{}", index.saturating_add(1))
}

fn disposition(disposition: Disposition) -> String {
    format!("d{}", usize::from(disposition.0).saturating_add(1))
}

fn list<I: Iterator<Item = String>>(names: I) -> String {
    names.collect::<Vec<_>>().join(", ")
}
