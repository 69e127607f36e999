//! Short runs in a room, every one another: two or three users whose statuses and profiles
//! are random, a random protocol variant, now and then an emergency or somebody who gives up.

use std::error::Error;
use std::fmt::Write as _;
use std::io;
use std::path::Path;

use fastrand::Rng;
use selfneg::demo;
use selfneg::input::{InputError, Rules, User};
use selfneg::scenario::{Folders, Scenario};
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal};
use selfneg::trace::{TraceWriter, erase};
use selfneg_core::{Aggregation, Fallback, QuitRule, TieRule};
use selfneg_sim::{Building, BuildingError};

/// The fleet's keys: one for all its robots.
pub struct Keys {
    pub robot: RobotKey,
    pub auditor: AuditorKey,
}

impl Keys {
    /// New keys.
    pub fn generate() -> io::Result<Self> {
        Ok(Self { robot: RobotKey::generate(&mut random)?, auditor: AuditorKey::generate() })
    }
}

/// The trace of a seed: signed and sealed. One in fifty is cut, one in sixty has a byte
/// changed, one in seventy is plain, and of one in eighty somebody's data are erased.
pub fn trace(seed: u64, keys: &Keys) -> Result<Vec<u8>, Box<dyn Error>> {
    let plain = seed.is_multiple_of(70);
    let seal = Seal {
        privacy: if plain { Privacy::Plain } else { Privacy::Sealed(vec![keys.auditor.public()]) },
        signer: if plain { None } else { Some(keys.robot.clone()) },
        random: Box::new(random),
    };
    let mut writer = TraceWriter::create(Vec::new(), seal)?;
    selfneg::run::run(&scenario(seed)?, &mut [&mut writer])?;
    let mut bytes = writer.into_inner().ok_or("the trace is not there")?;
    // First, since of a damaged trace nothing is erased.
    if seed.is_multiple_of(80) && !plain {
        bytes = erase(&bytes, "user-1")?.bytes;
    }
    if seed.is_multiple_of(50) {
        bytes.truncate(bytes.len().saturating_mul(3) / 4);
    }
    if seed.is_multiple_of(60) {
        let middle = bytes.len() / 2;
        bytes.iter_mut().skip(middle).take(1).for_each(|byte| *byte ^= 1);
    }
    Ok(bytes)
}

fn random(bytes: &mut [u8]) -> io::Result<()> {
    getrandom::fill(bytes).map_err(io::Error::other)
}

/// The scenario of a seed.
pub fn scenario(seed: u64) -> Result<Scenario, Box<dyn Error>> {
    Ok(Scenario::parse(&text(seed)?, Path::new("generated.toml"), &Room)?)
}

/// The mall's rules, and a room with a charging station, a desk and a window.
struct Room;

impl Folders for Room {
    fn rules(&self, _: &Path) -> Result<Rules, InputError> {
        demo::rules()
    }

    fn user(&self, folder: &Path) -> Result<User, InputError> {
        User::read(folder)
    }

    fn building(&self, _: &Path) -> Result<Building, BuildingError> {
        Building::from_memory(include_str!("../room/building.yaml"), |file| {
            Ok(match file.extension().is_some_and(|kind| kind == "yaml") {
                true => include_str!("../room/map.yaml"),
                false => include_str!("../room/map.pgm"),
            }
            .into())
        })
    }
}

fn text(seed: u64) -> Result<String, Box<dyn Error>> {
    let mut random = Rng::with_seed(seed);
    let rules = demo::rules()?;
    let users = if random.u8(..3) == 0 { 3 } else { 2 };
    let mut text = String::from(include_str!("../room/generated.toml"));
    let name = |names: &[&'static str], random: &mut Rng| random.choice(names.to_vec()).unwrap_or_default();
    let policy = name(&["published", "condorcet"], &mut random);
    writeln!(
        text,
        "[protocol]\nquit = \"{}\"\naggregation = \"{}\"\ntie = \"{}\"\nfallback = \"{}\"\nwillingness = {}\npolicy = \"{policy}\"",
        random.choice(QuitRule::ALL).map_or("", |value| value.name()),
        random.choice(Aggregation::ALL).map_or("", |value| value.name()),
        random.choice(TieRule::ALL).map_or("", |value| value.name()),
        random.choice(Fallback::ALL).map_or("", |value| value.name()),
        random.u8(..2),
    )?;
    for user in 1..=users {
        writeln!(
            text,
            "[[users]]\nname = \"User {user}\"\nanswers-after = 0.1\ncontext.location = \"mall\""
        )?;
        let mut conditions: Vec<&str> = rules.activation.iter().map(|(name, _)| name.as_str()).collect();
        random.shuffle(&mut conditions);
        for condition in conditions {
            let truth = random.choice(["true", "true", "false", "\"withheld\""]).unwrap_or("true");
            writeln!(text, "status.\"{condition}\" = {truth}")?;
        }
        for (_, dispositions) in &rules.activation {
            for disposition in dispositions {
                writeln!(text, "profiles.mall.\"{disposition}\" = {}", random.u8(..=5))?;
            }
        }
    }
    for user in 1..=users {
        // The second and the third while the first is being served.
        let at = if user == 1 { 1.0 } else { 2.0 + random.f64() };
        let goal = name(&["bathroom", "pharmacy"], &mut random);
        let meet = name(&["desk", "window"], &mut random);
        writeln!(
            text,
            "[[requests]]\nuser = \"User {user}\"\ngoal = \"{goal}\"\nmeet = \"{meet}\"\nwhen = {{ at = {at:.2} }}"
        )?;
    }
    if random.u8(..8) == 0 {
        let evidence = name(&["claimed", "sensed"], &mut random);
        writeln!(
            text,
            "[[emergencies]]\ncategory = \"fall\"\nplace = \"desk\"\nevidence = \"{evidence}\"\nwhen = {{ at = {:.2} }}",
            random.f64() * 8.0
        )?;
    }
    if random.u8(..8) == 0 {
        let at = 3.0 + random.f64() * 4.0;
        writeln!(text, "[[withdrawals]]\nuser = \"User {users}\"\nwhen = {{ at = {at:.2} }}")?;
    }
    Ok(text)
}
