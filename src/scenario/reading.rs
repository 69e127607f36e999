//! From the TOML file to a checked scenario.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use indexmap::IndexMap;
use selfneg_core::{Aggregation, Fallback, Options, QuitRule, Rank, TieRule};
use selfneg_sim::{Building, Person, Point, Settings, Waypoint, World};

use super::error::ScenarioError;
use super::folders::Folders;
use super::format::{
    ActionFile, ProtocolFile, ScenarioFile, SpotFile, UpdateFile, UserFile, WaypointFile, WhenFile,
};
use super::{Action, Behaviour, Cause, Happening, Scenario, When};
use crate::input::{Truth, User, UserFiles};
use crate::mission::{
    Event, GoalId, LOCATION, MissionRules, Place, Profile, Specification, Stated, Text, UserData, UserId,
};
use crate::precedence::Policy;
use crate::run::Participant;

/// The building that comes with the program.
const MALL: &str = "mall";

/// A day: the most that anything may take, in seconds.
const DAY: f64 = 86_400.0;

/// How near is near if the scenario does not say, in metres.
const NEAR: f64 = 2.5;

/// How long a user takes to answer if the scenario does not say.
const ANSWER: Duration = Duration::from_millis(500);

pub(super) fn read(text: &str, file: &Path, folders: &dyn Folders) -> Result<Scenario, ScenarioError> {
    Reader { file, folders }.read(&parse(text, file)?)
}

fn parse(text: &str, file: &Path) -> Result<ScenarioFile, ScenarioError> {
    let not_as_documented = |key: String, error: &toml::de::Error| {
        let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or("");
        ScenarioError::NotAsDocumented {
            file: file.to_owned(),
            line: before.matches('\n').count().saturating_add(1),
            key: if key.is_empty() || key == "." { String::new() } else { format!("{key}: ") },
            message: error.message().replace('\n', ", "),
        }
    };
    let document =
        toml::Deserializer::parse(text).map_err(|error| not_as_documented(String::new(), &error))?;
    serde_path_to_error::deserialize(document)
        .map_err(|error| not_as_documented(error.path().to_string(), error.inner()))
}

struct Reader<'a> {
    file: &'a Path,
    folders: &'a dyn Folders,
}

/// What names may refer to.
struct Names<'a> {
    places: &'a [String],
    participants: &'a [Participant],
    people: &'a [String],
}

impl Reader<'_> {
    fn read(&self, file: &ScenarioFile) -> Result<Scenario, ScenarioError> {
        let building = self.building(&file.building)?;
        let places: Vec<String> = building.places().map(|(_, place)| place.name.clone()).collect();
        let mut world = World::new(building.clone(), Settings::default(), &file.start)
            .map_err(|source| self.world("start", source))?;
        let rules = self.folders.rules(&file.rules).map_err(|source| self.input("rules", source))?;
        let options = self.options(&file.protocol)?;
        let policies = Policy::ALL.map(Policy::name);
        let policy = self.option("protocol.policy", file.protocol.policy.as_deref(), &policies)?;
        let mission_rules =
            MissionRules::new(&rules, file.mission.clone(), options, policy).map_err(|source| {
                ScenarioError::Mission { file: self.file.to_owned(), source: Box::new(source) }
            })?;
        let actions = self.actions(&file.mission, &file.actions, &places)?;

        if file.users.is_empty() {
            return Err(self.unexpected("users", "at least one user", "none"));
        }
        let (mut participants, mut behaviours, mut people) = (Vec::new(), Vec::new(), Vec::new());
        for (nth, user) in file.users.iter().enumerate() {
            let key = format!("users[{nth}]");
            let (participant, behaviour) = self.user(&key, nth, user, &participants)?;
            if let Some(stands) = &user.stands {
                let person = self.person(&key, &building, &participant.person, stands, &user.walks, false)?;
                people.push(person.name.clone());
                world.add_person(person).map_err(|source| self.world(&key, source))?;
            } else if !user.walks.is_empty() {
                return Err(self.unexpected(&format!("{key}.stands"), "where the walk begins", "nothing"));
            }
            participants.push(participant);
            behaviours.push(behaviour);
        }
        for (nth, bystander) in file.people.iter().enumerate() {
            let key = format!("people[{nth}]");
            if people.contains(&bystander.name) || participants.iter().any(|p| p.person == bystander.name) {
                return Err(self.twice(&format!("{key}.name"), &bystander.name));
            }
            let (stands, walks) = (&bystander.stands, &bystander.walks);
            let person = self.person(&key, &building, &bystander.name, stands, walks, bystander.repeat)?;
            people.push(person.name.clone());
            world.add_person(person).map_err(|source| self.world(&key, source))?;
        }

        let names = Names { places: &places, participants: &participants, people: &people };
        let happenings = self.happenings(file, &names, &mission_rules)?;
        if happenings.is_empty() {
            return Err(self.unexpected("requests", "at least one request or emergency", "none"));
        }
        Ok(Scenario {
            name: file.name.clone(),
            about: file.about.clone(),
            world,
            rules,
            specification: file.mission.clone(),
            mission_rules,
            options,
            policy,
            actions,
            until: self.seconds("until", file.until, 1.0, "1 to 86400 s")?,
            round: self.seconds("round-seconds", file.round_seconds, 0.0, "0 to 86400 s")?,
            participants,
            behaviours,
            places,
            happenings,
        })
    }

    fn building(&self, name: &str) -> Result<Building, ScenarioError> {
        let building = match name {
            MALL => Building::mall(),
            path => self.folders.building(Path::new(path)),
        };
        let file = || self.file.to_owned();
        building.map_err(|source| ScenarioError::Building { file: file(), source: Box::new(source) })
    }

    fn options(&self, file: &ProtocolFile) -> Result<Options, ScenarioError> {
        let default = Options::default();
        let names = |all: &[QuitRule]| all.iter().map(|value| value.name()).collect::<Vec<_>>();
        let quit = self.option("protocol.quit", file.quit.as_deref(), &names(QuitRule::ALL))?;
        let names = |all: &[Aggregation]| all.iter().map(|value| value.name()).collect::<Vec<_>>();
        let aggregation =
            self.option("protocol.aggregation", file.aggregation.as_deref(), &names(Aggregation::ALL))?;
        let names = |all: &[TieRule]| all.iter().map(|value| value.name()).collect::<Vec<_>>();
        let tie = self.option("protocol.tie", file.tie.as_deref(), &names(TieRule::ALL))?;
        let names = |all: &[Fallback]| all.iter().map(|value| value.name()).collect::<Vec<_>>();
        let fallback = self.option("protocol.fallback", file.fallback.as_deref(), &names(Fallback::ALL))?;
        Ok(Options {
            quit: quit.unwrap_or(default.quit),
            aggregation: aggregation.unwrap_or(default.aggregation),
            tie: tie.unwrap_or(default.tie),
            fallback: fallback.unwrap_or(default.fallback),
            willingness: file.willingness,
        })
    }

    fn option<T: FromStr>(
        &self,
        key: &str,
        name: Option<&str>,
        known: &[&str],
    ) -> Result<Option<T>, ScenarioError> {
        let Some(name) = name else { return Ok(None) };
        let known = || known.iter().map(|&one| one.to_owned());
        name.parse().map(Some).map_err(|_| self.unknown(key, "option", name, known()))
    }

    /// Every action of every goal, bound to what the robot does for it.
    fn actions(
        &self,
        specification: &Specification,
        bindings: &IndexMap<String, ActionFile>,
        places: &[String],
    ) -> Result<Vec<Vec<Vec<Action>>>, ScenarioError> {
        let mut bound: IndexMap<&str, Action> = IndexMap::new();
        for (name, binding) in bindings {
            let key = format!("actions.{name}");
            let place = |name: &String| match places.contains(name) {
                true => Ok(name.clone()),
                false => Err(self.unknown(&key, "place", name, places.iter().cloned())),
            };
            let action = match binding {
                ActionFile::Meet => Action::Meet,
                ActionFile::Drive(to) => Action::Drive(place(to)?),
                ActionFile::Guide(to) => Action::Guide(place(to)?),
                ActionFile::Wait(seconds) => {
                    Action::Wait(self.seconds(&key, *seconds, 0.0, "0 to 86400 s")?)
                }
                ActionFile::Say(text) => Action::Say(text.clone(), speaking(text)),
            };
            bound.insert(name, action);
        }
        let mut all = Vec::new();
        for (g, goal) in specification.goals.iter().enumerate() {
            let mut tasks = Vec::new();
            for (t, task) in goal.tasks.iter().enumerate() {
                let mut actions = Vec::new();
                for name in &task.actions {
                    let key = format!("mission.goals[{g}].tasks[{t}].actions");
                    let known = bindings.keys().cloned();
                    let action = bound.get(name.as_str()).cloned();
                    actions.push(action.ok_or_else(|| self.unknown(&key, "action", name, known))?);
                }
                tasks.push(actions);
            }
            all.push(tasks);
        }
        Ok(all)
    }

    fn user(
        &self,
        key: &str,
        nth: usize,
        file: &UserFile,
        others: &[Participant],
    ) -> Result<(Participant, Behaviour), ScenarioError> {
        let (user, data) = match &file.folder {
            Some(folder) => {
                if file.profiles.is_some() || file.status.is_some() || file.context.is_some() {
                    let expected = "either a folder, or profiles, status and context here";
                    return Err(self.unexpected(key, expected, "both"));
                }
                let key = format!("{key}.folder");
                let mut user = self.folders.user(folder).map_err(|source| self.input(&key, source))?;
                user.name = file.name.clone().unwrap_or(user.name);
                let data = UserData::from(&user);
                (user, data)
            }
            None => self.inline_user(key, file)?,
        };
        if others.iter().any(|other| other.person == user.name) {
            return Err(self.twice(&format!("{key}.name"), &user.name));
        }
        let number = u32::try_from(nth).unwrap_or(u32::MAX).saturating_add(1);
        let answers_after =
            self.answers_after(&format!("{key}.answers-after"), file.answers_after.as_ref())?;
        let participant = Participant { pseudonym: UserId(number), person: user.name.clone(), user };
        Ok((participant, Behaviour { data, answers_after, leaves: file.leaves }))
    }

    fn answers_after(
        &self,
        key: &str,
        said: Option<&toml::Value>,
    ) -> Result<Option<Duration>, ScenarioError> {
        const EXPECTED: &str = "0 to 86400 s, or \"never\"";
        let seconds = match said {
            None => return Ok(Some(ANSWER)),
            Some(toml::Value::String(word)) if word == "never" => return Ok(None),
            Some(toml::Value::Float(seconds)) => *seconds,
            Some(toml::Value::Integer(seconds)) => {
                u32::try_from(*seconds).map(f64::from).map_err(|_| self.unexpected(key, EXPECTED, seconds))?
            }
            Some(other) => return Err(self.unexpected(key, EXPECTED, other)),
        };
        self.seconds(key, seconds, 0.0, EXPECTED).map(Some)
    }

    fn inline_user(&self, key: &str, file: &UserFile) -> Result<(User, UserData), ScenarioError> {
        let Some(name) = file.name.clone() else {
            return Err(self.unexpected(key, "a name, or a folder named like the user", "neither"));
        };
        let context = file.context.clone().unwrap_or_default();
        let profiles = file.profiles.clone().unwrap_or_default();
        let Some(location) = context.get(LOCATION).cloned() else {
            return Err(self.unexpected(&format!("{key}.context"), "a location", "none"));
        };
        let mut status = Vec::new();
        for (condition, said) in file.status.iter().flatten() {
            status.push((condition.clone(), self.truth(&format!("{key}.status.{condition}"), said)?));
        }
        let ranks = profiles.get(&location).into_iter().flatten();
        let user = User {
            name,
            profile: ranks.map(|(name, &rank)| (name.clone(), Rank(rank))).collect(),
            status: status.clone(),
            goal: None,
            location,
            files: UserFiles {
                profiles: self.place_of(key, "profiles"),
                status: self.place_of(key, "status"),
                context: self.place_of(key, "context"),
                goal: self.place_of(key, "goal"),
            },
        };
        let profile = |(label, ranks): (&String, &IndexMap<String, u8>)| Profile {
            label: label.as_str().into(),
            ranks: ranks.iter().map(|(name, &rank)| (Text::from(name.as_str()), rank)).collect(),
        };
        let stated =
            |(name, truth): &(String, Truth)| Stated { condition: name.as_str().into(), truth: *truth };
        let data = UserData {
            profiles: profiles.iter().map(profile).collect(),
            status: status.iter().map(stated).collect(),
            context: context
                .iter()
                .map(|(name, value)| (name.as_str().into(), value.as_str().into()))
                .collect(),
        };
        Ok((user, data))
    }

    /// Where a message about an inline user may point to.
    fn place_of(&self, key: &str, part: &str) -> PathBuf {
        PathBuf::from(format!("{}: {key}.{part}", self.file.display()))
    }

    fn truth(&self, key: &str, said: &toml::Value) -> Result<Truth, ScenarioError> {
        match said {
            toml::Value::Boolean(true) => Ok(Truth::True),
            toml::Value::Boolean(false) => Ok(Truth::False),
            toml::Value::String(word) if word == "withheld" => Ok(Truth::Withheld),
            other => Err(self.unexpected(key, "true, false, or \"withheld\"", other)),
        }
    }

    fn person(
        &self,
        key: &str,
        building: &Building,
        name: &str,
        stands: &SpotFile,
        walks: &[WaypointFile],
        repeat: bool,
    ) -> Result<Person, ScenarioError> {
        let floors = building.floors();
        let floor = match &stands.floor {
            None => 0,
            Some(floor) => building.floor_named(floor).ok_or_else(|| {
                let known = floors.iter().map(|floor| floor.name.clone());
                self.unknown(&format!("{key}.stands.floor"), "floor", floor, known)
            })?,
        };
        let waypoint = |at: &WaypointFile| Waypoint { position: Point::new(at.x, at.y), wait: at.wait };
        let standing = Person::standing(name, floor, Point::new(stands.x, stands.y));
        Ok(Person { waypoints: walks.iter().map(waypoint).collect(), repeat, ..standing })
    }

    fn happenings(
        &self,
        file: &ScenarioFile,
        names: &Names<'_>,
        rules: &MissionRules,
    ) -> Result<Vec<Happening>, ScenarioError> {
        let mut all = Vec::new();
        for (nth, request) in file.requests.iter().enumerate() {
            let key = format!("requests[{nth}]");
            let participant = self.participant(&key, names, &request.user)?;
            let Some(goal) = request.goal.as_ref().or(participant.user.goal.as_ref()) else {
                return Err(self.unexpected(
                    &format!("{key}.goal"),
                    "a goal, as the user names none",
                    "none",
                ));
            };
            let goals = rules.specification().goals.iter().map(|goal| goal.name.clone());
            let goal: GoalId = rules.goal(goal).ok_or_else(|| {
                self.unknown(&format!("{key}.goal"), "goal in [[mission.goals]]", goal, goals)
            })?;
            let place = self.place(&format!("{key}.meet"), names, &request.meet)?;
            let event = Event::Request { user: participant.pseudonym, goal, place };
            all.push(Happening { when: self.when(&key, names, &request.when)?, event, key });
        }
        for (nth, update) in file.updates.iter().enumerate() {
            self.update(&format!("updates[{nth}]"), names, update, &mut all)?;
        }
        for (nth, withdrawal) in file.withdrawals.iter().enumerate() {
            let key = format!("withdrawals[{nth}]");
            let event = Event::Withdraw { user: self.participant(&key, names, &withdrawal.user)?.pseudonym };
            all.push(Happening { when: self.when(&key, names, &withdrawal.when)?, event, key });
        }
        for (nth, emergency) in file.emergencies.iter().enumerate() {
            let key = format!("emergencies[{nth}]");
            let known = rules.specification().emergencies.iter().map(|category| category.name.clone());
            let category = rules.category(&emergency.category).ok_or_else(|| {
                let what = "category in [[mission.emergencies]]";
                self.unknown(&format!("{key}.category"), what, &emergency.category, known)
            })?;
            let place = self.place(&format!("{key}.place"), names, &emergency.place)?;
            let event = Event::Emergency { category, place, evidence: emergency.evidence };
            all.push(Happening { when: self.when(&key, names, &emergency.when)?, event, key });
        }
        if let Some(when) = &file.shutdown {
            let (key, event) = ("shutdown".to_owned(), Event::Shutdown);
            all.push(Happening { when: self.when(&key, names, when)?, event, key });
        }
        Ok(all)
    }

    fn update(
        &self,
        key: &str,
        names: &Names<'_>,
        update: &UpdateFile,
        all: &mut Vec<Happening>,
    ) -> Result<(), ScenarioError> {
        let user = self.participant(key, names, &update.user)?.pseudonym;
        let when = self.when(key, names, &update.when)?;
        if update.status.is_empty() && update.context.is_empty() {
            return Err(self.unexpected(key, "a status or a context", "neither"));
        }
        let mut push = |event| all.push(Happening { when: when.clone(), event, key: key.to_owned() });
        for (condition, said) in &update.status {
            let truth = self.truth(&format!("{key}.status.{condition}"), said)?;
            push(Event::Status { user, condition: condition.as_str().into(), truth });
        }
        for (attribute, value) in &update.context {
            push(Event::Context { user, attribute: attribute.as_str().into(), value: value.as_str().into() });
        }
        Ok(())
    }

    fn participant<'n>(
        &self,
        key: &str,
        names: &Names<'n>,
        name: &str,
    ) -> Result<&'n Participant, ScenarioError> {
        names.participants.iter().find(|participant| participant.person == name).ok_or_else(|| {
            let known = names.participants.iter().map(|participant| participant.person.clone());
            self.unknown(&format!("{key}.user"), "user", name, known)
        })
    }

    fn place(&self, key: &str, names: &Names<'_>, name: &str) -> Result<Place, ScenarioError> {
        let at = names.places.iter().position(|place| place == name);
        at.and_then(|at| u32::try_from(at).ok())
            .map(Place)
            .ok_or_else(|| self.unknown(key, "place", name, names.places.iter().cloned()))
    }

    fn when(&self, key: &str, names: &Names<'_>, when: &WhenFile) -> Result<When, ScenarioError> {
        let key = if key == "shutdown" { key.to_owned() } else { format!("{key}.when") };
        let later = self.seconds(&format!("{key}.later"), when.later.unwrap_or(0.0), 0.0, "0 to 86400 s")?;
        let within = when.within.unwrap_or(NEAR);
        if !(0.0..=1000.0).contains(&within) {
            return Err(self.unexpected(&format!("{key}.within"), "0 to 1000 m", &within));
        }
        if when.within.is_some() && when.near.is_none() {
            return Err(self.unexpected(&format!("{key}.within"), "it beside near alone", "no near"));
        }
        let cause = match (when.at, &when.near, &when.reaching) {
            (Some(at), None, None) => {
                Cause::At(self.seconds(&format!("{key}.at"), at, 0.0, "0 to 86400 s")?)
            }
            (None, Some(name), None) if names.people.contains(name) => {
                Cause::NearPerson(name.clone(), within)
            }
            (None, Some(name), None) if names.places.contains(name) => Cause::NearPlace(name.clone(), within),
            (None, Some(name), None) => {
                let known = names.people.iter().chain(names.places).cloned();
                let what = "person who stands somewhere, or place,";
                return Err(self.unknown(&format!("{key}.near"), what, name, known));
            }
            (None, None, Some(place)) => {
                self.place(&format!("{key}.reaching"), names, place)?;
                Cause::Reaching(place.clone())
            }
            (None, None, None) => return Err(self.unexpected(&key, "one of at, near, reaching", "none")),
            _ => return Err(self.unexpected(&key, "one of at, near, reaching", "several")),
        };
        Ok(When { cause, later })
    }

    fn seconds(
        &self,
        key: &str,
        seconds: f64,
        least: f64,
        expected: &'static str,
    ) -> Result<Duration, ScenarioError> {
        let in_range = (least..=DAY).contains(&seconds);
        let duration = Duration::try_from_secs_f64(seconds).ok().filter(|_| in_range);
        duration.ok_or_else(|| self.unexpected(key, expected, &seconds))
    }

    fn unexpected(
        &self,
        key: &str,
        expected: &'static str,
        found: &(impl ToString + ?Sized),
    ) -> ScenarioError {
        ScenarioError::Unexpected {
            file: self.file.to_owned(),
            key: key.to_owned(),
            expected,
            found: found.to_string(),
        }
    }

    fn unknown(
        &self,
        key: &str,
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = String>,
    ) -> ScenarioError {
        let (key, name, known) = (key.to_owned(), name.to_owned(), known.collect());
        ScenarioError::Unknown { file: self.file.to_owned(), key, what, name, known }
    }

    fn twice(&self, key: &str, name: &str) -> ScenarioError {
        let (key, name) = (key.to_owned(), name.to_owned());
        ScenarioError::Twice { file: self.file.to_owned(), key, name }
    }

    fn input(&self, key: &str, source: crate::input::InputError) -> ScenarioError {
        ScenarioError::Input { file: self.file.to_owned(), key: key.to_owned(), source: Box::new(source) }
    }

    fn world(&self, key: &str, source: selfneg_sim::WorldError) -> ScenarioError {
        ScenarioError::World { file: self.file.to_owned(), key: key.to_owned(), source: Box::new(source) }
    }
}

/// How long it takes to say something: 15 letters a second, and a second of silence.
fn speaking(text: &str) -> Duration {
    let letters = u64::try_from(text.chars().count()).unwrap_or(u64::MAX);
    Duration::from_millis(letters.saturating_mul(67).saturating_add(1000))
}
