//! The published package's layout: where its users, rules and logs are.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::ReplicateError;
use super::log::{self, LoggedRun, Who};
use crate::binding::{BoundRules, BoundUser, GoalChoice};
use crate::input::{InputError, Rules, User, UserFiles};
use crate::lint::{Finding, lint_rules, lint_user};

/// Where the parts of one dataset lie in a package.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) name: &'static str,
    pub(super) log: &'static str,
    pub(super) rules: &'static str,
    pub(super) ground_truth: Option<&'static str>,
    pub(super) users_per_run: usize,
}

pub(super) const LAYOUTS: &[Layout] = &[
    Layout {
        name: "validation",
        log: "results/validation-without_gazebo.log",
        rules: "run/validation/usecases",
        ground_truth: Some("results/ground_truth.csv"),
        users_per_run: 2,
    },
    Layout {
        name: "scalability",
        log: "results/scalability.log",
        rules: "run/scalability/test_cases",
        ground_truth: None,
        users_per_run: 2,
    },
    Layout {
        name: "willingness",
        log: "results/willingness_tb_interrupted.log",
        rules: "run/willingness_tb_interrupted/usecases",
        ground_truth: None,
        users_per_run: 2,
    },
    Layout {
        name: "multi-lateral",
        log: "results/results-multi_lateral.log",
        rules: "run/validation/usecases",
        ground_truth: None,
        users_per_run: 3,
    },
];

/// The published system looks up the current user's goal as this, whatever it is.
const CURRENT_GOAL: &str = "t1";
/// The interrupting user's, likewise.
const INTERRUPTING_GOAL: &str = "t2";

/// A dataset, ready to be rerun.
pub(super) struct Dataset {
    pub(super) layout: &'static Layout,
    pub(super) log: PathBuf,
    pub(super) rules: BoundRules,
    pub(super) cases: Vec<LoggedCase>,
    pub(super) unreadable_lines: Vec<usize>,
    pub(super) findings: Vec<Finding>,
    users: Vec<SeatedUser>,
}

/// A user with the goal of either seat.
struct SeatedUser {
    current: BoundUser,
    interrupting: BoundUser,
}

/// A run of the log.
pub(super) struct LoggedCase {
    /// From 1.
    pub(super) line: usize,
    /// The dataset's users who took part, the current one first.
    pub(super) users: Vec<usize>,
    pub(super) outcome: String,
    pub(super) rounds: u64,
}

impl Dataset {
    pub(super) fn read(package: &Path, layout: &'static Layout) -> Result<Self, ReplicateError> {
        let rules_folder = package.join(layout.rules);
        let rules = Rules::read(&rules_folder)?;
        let log = package.join(layout.log);
        let text = std::fs::read_to_string(&log)
            .map_err(|source| InputError::Unreadable { file: log.clone(), source })?;
        let mut reader = Reader {
            folder: rules_folder,
            log: &log,
            layout,
            bound: BoundRules::new(rules.clone())?,
            findings: lint_rules(&rules),
            rules,
            users: Vec::new(),
            known: HashMap::new(),
        };
        let mut cases = Vec::new();
        let mut unreadable_lines = Vec::new();
        for (nth, text) in text.lines().enumerate() {
            let line = nth.saturating_add(1);
            match log::read_line(text) {
                Some(run) => cases.push(reader.case(line, run)?),
                None if text.trim().is_empty() => {}
                None => unreadable_lines.push(line),
            }
        }
        if cases.is_empty() && unreadable_lines.is_empty() {
            return Err(ReplicateError::NoRuns { log });
        }
        let Reader { bound, findings, users, .. } = reader;
        Ok(Self { layout, log, rules: bound, cases, unreadable_lines, findings, users })
    }

    /// The users at these places, the first one in the current user's seat.
    pub(super) fn seated(&self, users: &[usize]) -> Vec<BoundUser> {
        users
            .iter()
            .enumerate()
            .filter_map(|(seat, &user)| {
                let user = self.users.get(user)?;
                Some(if seat == 0 { user.current.clone() } else { user.interrupting.clone() })
            })
            .collect()
    }

    pub(super) fn names(&self, case: &LoggedCase) -> Vec<&str> {
        case.users
            .iter()
            .filter_map(|&user| self.users.get(user))
            .map(|user| user.current.name.as_str())
            .collect()
    }

    pub(super) fn label(&self, case: &LoggedCase) -> String {
        self.names(case).join(", ")
    }
}

struct Reader<'a> {
    folder: PathBuf,
    log: &'a Path,
    layout: &'static Layout,
    rules: Rules,
    bound: BoundRules,
    findings: Vec<Finding>,
    users: Vec<SeatedUser>,
    known: HashMap<String, usize>,
}

impl Reader<'_> {
    fn case(&mut self, line: usize, run: LoggedRun) -> Result<LoggedCase, ReplicateError> {
        let users = match run.who {
            Who::Names(together) => self.named(line, &together)?,
            Who::Generated { dispositions, share, profile, counter } => {
                self.generated(line, dispositions, share, profile, counter)?
            }
        };
        Ok(LoggedCase { line, users, outcome: run.outcome, rounds: run.rounds })
    }

    /// Users whose names are run together: every name is a folder beside the rules.
    fn named(&mut self, line: usize, together: &str) -> Result<Vec<usize>, ReplicateError> {
        let mut ways = Vec::new();
        self.split(together, self.layout.users_per_run, &mut Vec::new(), &mut ways);
        match ways.as_slice() {
            [names] => names
                .iter()
                .map(|name| {
                    let folder = self.folder.join(name);
                    Ok(self.user(name.clone(), UserFiles::of_folder(&folder))?)
                })
                .collect(),
            other => {
                let how = if other.is_empty() { "do not name" } else { "can be read in several ways as" };
                let problem = format!(
                    "users {together:?} {how} {} user folders of {}",
                    self.layout.users_per_run,
                    self.folder.display()
                );
                Err(self.at(line, problem))
            }
        }
    }

    /// All ways to read `text` as `count` different folder names.
    fn split(&self, text: &str, count: usize, before: &mut Vec<String>, ways: &mut Vec<Vec<String>>) {
        let Some(left) = count.checked_sub(1) else {
            if text.is_empty() {
                ways.push(before.clone());
            }
            return;
        };
        for (end, letter) in text.char_indices() {
            let Some((name, rest)) = text.split_at_checked(end.saturating_add(letter.len_utf8())) else {
                continue;
            };
            if !before.iter().any(|other| other == name) && self.folder.join(name).is_dir() {
                before.push(name.to_owned());
                self.split(rest, left, before, ways);
                before.pop();
            }
        }
    }

    /// Profile i with status i is current, profile j with status j interrupts: i = 1, 2,
    /// ..., for each every other j in order.
    fn generated(
        &mut self,
        line: usize,
        dispositions: u32,
        share: u32,
        profile: usize,
        counter: usize,
    ) -> Result<Vec<usize>, ReplicateError> {
        let folder = self.folder.join(dispositions.to_string());
        let profile_file =
            |user: usize| folder.join(format!("profiles/ethic_profiles_{dispositions}-{user}.json"));
        let population = (1..).take_while(|&user| profile_file(user).exists()).count();
        let others = population.saturating_sub(1);
        let place = counter.checked_sub(1).filter(|_| others > 0);
        let (Some(current), Some(nth)) =
            (place.and_then(|at| at.checked_div(others)), place.and_then(|at| at.checked_rem(others)))
        else {
            let problem =
                format!("test counter {counter} with {population} profiles in {}", folder.display());
            return Err(self.at(line, problem));
        };
        let current = current.saturating_add(1);
        let interrupting =
            if nth.saturating_add(1) < current { nth.saturating_add(1) } else { nth.saturating_add(2) };
        if current != profile || current > population {
            let problem =
                format!("test counter {counter} belongs to profile {current}, found profile {profile}");
            return Err(self.at(line, problem));
        }
        let status = format!("statuses/{share}/user_status_{dispositions}_{share}");
        [current, interrupting]
            .into_iter()
            .map(|user| {
                let files = UserFiles {
                    profiles: profile_file(user),
                    status: folder.join(format!("{status}-{user}.json")),
                    context: self.folder.join("context.json"),
                    goal: self.folder.join("goal.json"),
                };
                Ok(self.user(format!("{dispositions}-{share}-{user}"), files)?)
            })
            .collect()
    }

    /// The user of that name, read when first asked for.
    fn user(&mut self, name: String, files: UserFiles) -> Result<usize, InputError> {
        if let Some(&at) = self.known.get(&name) {
            return Ok(at);
        }
        let user = User::read_files(name.clone(), files)?;
        self.findings.extend(lint_user(&self.rules, &user, false));
        let mut with_goal = |goal: &str| {
            let origin = "the published system".to_owned();
            self.bound.bind(&user, &GoalChoice::Instead { goal: goal.to_owned(), origin })
        };
        let seated =
            SeatedUser { current: with_goal(CURRENT_GOAL)?, interrupting: with_goal(INTERRUPTING_GOAL)? };
        let at = self.users.len();
        self.users.push(seated);
        self.known.insert(name, at);
        Ok(at)
    }

    fn at(&self, line: usize, problem: String) -> ReplicateError {
        ReplicateError::Line { log: self.log.to_owned(), line, problem }
    }
}
