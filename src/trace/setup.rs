//! What is fixed before a run: as messages, and back as a mission's rules.

use std::collections::BTreeMap;
use std::path::PathBuf;

use prost::Message as _;
use selfneg_core::{Options, Rank};

use super::encode::{options_of, rank, stated};
use super::format::{FORMAT_MAJOR, FORMAT_MINOR, PROGRAM};
use super::schema::{evidence as open, personal};
use crate::input::Rules;
use crate::mission::{
    Category, ContextImplication, Goal, Inference, Limits, MissionRules, Proof, Specification, Task,
    Willingness,
};
use crate::precedence::Policy;
use crate::run::{Participant, Setup};
use crate::seal::chain::rules_digest;

use super::replay::ReplayError;

/// What is in the open: how many there are of everything that has a name, and no name.
pub(super) fn header(setup: &Setup<'_>, rules: &personal::Rules, privacy: open::Privacy) -> open::Header {
    let options = options_of(setup.options);
    let policy = setup.policy.map_or_else(String::new, |policy| policy.name().to_owned());
    open::Header {
        format_major: FORMAT_MAJOR,
        format_minor: FORMAT_MINOR,
        program: PROGRAM.to_owned(),
        rules_digest: rules_digest(&options, &policy, &rules.encode_to_vec()).to_vec(),
        options: Some(options),
        policy,
        floors: nameless(rules.floors.len()),
        places: nameless(rules.places.len()),
        specification: rules.specification.as_ref().map(without_names),
        participants: setup.participants.iter().map(|participant| participant.pseudonym.0).collect(),
        privacy: privacy.into(),
        ..open::Header::default()
    }
}

fn nameless(count: usize) -> Vec<String> {
    vec![String::new(); count]
}

/// A specification's structure.
fn without_names(named: &open::Specification) -> open::Specification {
    let task = |task: &open::Task| open::Task {
        name: String::new(),
        actions: nameless(task.actions.len()),
        interruptible: task.interruptible,
    };
    let goal = |goal: &open::Goal| open::Goal {
        tasks: goal.tasks.iter().map(task).collect(),
        ..open::Goal::default()
    };
    let emergency = |emergency: &open::Emergency| open::Emergency {
        gravity: emergency.gravity,
        proof: emergency.proof,
        ..open::Emergency::default()
    };
    open::Specification {
        goals: named.goals.iter().map(goal).collect(),
        emergencies: named.emergencies.iter().map(emergency).collect(),
        willingness_from_percent: named.willingness_from_percent,
        limits: named.limits,
        ..open::Specification::default()
    }
}

/// The same for those who tell what happens without names.
pub(super) fn anonymous(specification: &Specification) -> Specification {
    let task = |task: &Task| Task {
        name: String::new(),
        actions: nameless(task.actions.len()),
        interruptible: task.interruptible,
    };
    let goal = |goal: &Goal| Goal { tasks: goal.tasks.iter().map(task).collect(), ..Goal::default() };
    let category = |category: &Category| Category {
        name: String::new(),
        gravity: category.gravity,
        proof: category.proof,
        goal: String::new(),
    };
    Specification {
        goals: specification.goals.iter().map(goal).collect(),
        emergencies: specification.emergencies.iter().map(category).collect(),
        ..Specification::default()
    }
}

/// Gives an open header its names. A header of format 1.0 has them.
///
/// # Errors
/// What is wrong, if these are not the header's rules.
pub(super) fn name_header(
    header: &mut open::Header,
    rules: &personal::Rules,
    bytes: &[u8],
) -> Result<(), &'static str> {
    if header.rules_digest.is_empty() && rules.specification.is_none() {
        return Ok(());
    }
    let options = header.options.clone().unwrap_or_default();
    if rules_digest(&options, &header.policy, bytes) != *header.rules_digest {
        return Err("they are not the rules of the header's digest");
    }
    let same = (&header.floors, &header.places, &header.specification)
        == (
            &nameless(rules.floors.len()),
            &nameless(rules.places.len()),
            &rules.specification.as_ref().map(without_names),
        );
    if !same {
        return Err("they have another structure than the header");
    }
    header.scenario.clone_from(&rules.scenario);
    header.building.clone_from(&rules.building);
    header.floors.clone_from(&rules.floors);
    header.places.clone_from(&rules.places);
    header.specification.clone_from(&rules.specification);
    Ok(())
}

fn specification(specification: &Specification) -> open::Specification {
    let task = |task: &Task| open::Task {
        name: task.name.clone(),
        actions: task.actions.clone(),
        interruptible: task.interruptible,
    };
    let goal = |goal: &Goal| open::Goal {
        name: goal.name.clone(),
        needs: goal.needs.clone(),
        tasks: goal.tasks.iter().map(task).collect(),
    };
    let emergency = |category: &Category| open::Emergency {
        name: category.name.clone(),
        gravity: u32::from(category.gravity),
        proof: match category.proof {
            Proof::Sensed => open::Proof::Sensed,
            Proof::Verified => open::Proof::Verified,
        }
        .into(),
        goal: category.goal.clone(),
    };
    let limits = specification.limits;
    open::Specification {
        capabilities: specification.capabilities.clone(),
        goals: specification.goals.iter().map(goal).collect(),
        emergencies: specification.emergencies.iter().map(emergency).collect(),
        willingness_from_percent: u32::from(specification.willingness.from_percent),
        limits: Some(open::Limits {
            users: u32::from(limits.users),
            requests: u32::from(limits.requests),
            emergencies: u32::from(limits.emergencies),
            profiles: u32::from(limits.profiles),
            conditions: u32::from(limits.conditions),
            attributes: u32::from(limits.attributes),
            deferrals: u32::from(limits.deferrals),
            data_within_ms: limits.data_within_ms,
        }),
    }
}

pub(super) fn rules(setup: &Setup<'_>) -> personal::Rules {
    let row = |(name, dispositions): &(String, Vec<String>)| personal::Row {
        name: name.clone(),
        dispositions: dispositions.clone(),
    };
    let specification = setup.specification;
    let inference = |inference: &Inference| personal::Inference {
        attribute: inference.attribute.clone(),
        value: inference.value.clone(),
        condition: inference.condition.clone(),
    };
    let normative = |(label, ranks): (&String, &BTreeMap<String, u8>)| personal::Profile {
        label: label.clone(),
        ranks: ranks.iter().map(|(name, value)| rank((name, Rank(*value)))).collect(),
    };
    let contexts = (0_u32..).zip(&specification.goals).flat_map(|(number, goal)| {
        goal.implications.iter().map(move |implication| personal::ContextImplication {
            goal: number,
            attribute: implication.attribute.clone(),
            value: implication.value.clone(),
            dispositions: implication.dispositions.clone(),
        })
    });
    personal::Rules {
        activation: setup.rules.activation.iter().map(row).collect(),
        implications: setup.rules.implications.iter().map(row).collect(),
        inferences: specification.inferences.iter().map(inference).collect(),
        normative: specification.normative.iter().map(normative).collect(),
        context_implications: contexts.collect(),
        scenario: setup.name.to_owned(),
        building: setup.building.name().to_owned(),
        floors: setup.building.floors().iter().map(|floor| floor.name.clone()).collect(),
        places: setup.places.to_vec(),
        specification: Some(self::specification(specification)),
    }
}

pub(super) fn participant(participant: &Participant) -> personal::Participant {
    let user = &participant.user;
    personal::Participant {
        user: participant.pseudonym.0,
        person: participant.person.clone(),
        name: user.name.clone(),
        profile: user.profile.iter().map(|(name, value)| rank((name, *value))).collect(),
        status: user.status.iter().map(|(name, truth)| stated(name, *truth)).collect(),
        goal: user.goal.clone(),
        location: user.location.clone(),
    }
}

/// The rules of the recorded mission.
pub(super) fn mission_rules(
    header: &open::Header,
    personal: &personal::Rules,
) -> Result<MissionRules, ReplayError> {
    let rows = |rows: &[personal::Row]| {
        rows.iter().map(|row| (row.name.clone(), row.dispositions.clone())).collect()
    };
    let rules = Rules {
        activation: rows(&personal.activation),
        implications: rows(&personal.implications),
        activation_file: PathBuf::from("disposition activation of the trace"),
        implications_file: PathBuf::from("ethical implications of the trace"),
    };
    let options = header.options.as_ref().ok_or(ReplayError::Unknown("options"))?;
    let options = Options {
        quit: options.quit.parse().map_err(|_| ReplayError::Unknown("quit rule"))?,
        aggregation: options.aggregation.parse().map_err(|_| ReplayError::Unknown("aggregation"))?,
        tie: options.tie.parse().map_err(|_| ReplayError::Unknown("tie rule"))?,
        fallback: options.fallback.parse().map_err(|_| ReplayError::Unknown("fallback"))?,
        willingness: small(options.willingness, "willingness")?,
    };
    let policy: Option<Policy> = match header.policy.as_str() {
        "" => None,
        name => Some(name.parse().map_err(|_| ReplayError::Unknown("policy"))?),
    };
    let recorded = header.specification.as_ref().ok_or(ReplayError::Unknown("specification"))?;
    Ok(MissionRules::new(&rules, specification_of(recorded, personal)?, options, policy)?)
}

fn specification_of(
    recorded: &open::Specification,
    personal: &personal::Rules,
) -> Result<Specification, ReplayError> {
    let limits = recorded.limits.ok_or(ReplayError::Unknown("limits"))?;
    let task = |task: &open::Task| Task {
        name: task.name.clone(),
        actions: task.actions.clone(),
        interruptible: task.interruptible,
    };
    let goal = |(number, goal): (u32, &open::Goal)| Goal {
        name: goal.name.clone(),
        needs: goal.needs.clone(),
        tasks: goal.tasks.iter().map(task).collect(),
        implications: personal
            .context_implications
            .iter()
            .filter(|implication| implication.goal == number)
            .map(|implication| ContextImplication {
                attribute: implication.attribute.clone(),
                value: implication.value.clone(),
                dispositions: implication.dispositions.clone(),
            })
            .collect(),
    };
    let category = |category: &open::Emergency| {
        Ok(Category {
            name: category.name.clone(),
            gravity: small(category.gravity, "gravity")?,
            proof: match category.proof() {
                open::Proof::Sensed => Proof::Sensed,
                open::Proof::Verified => Proof::Verified,
                open::Proof::Unspecified => return Err(ReplayError::Unknown("proof")),
            },
            goal: category.goal.clone(),
        })
    };
    let inference = |inference: &personal::Inference| Inference {
        attribute: inference.attribute.clone(),
        value: inference.value.clone(),
        condition: inference.condition.clone(),
    };
    let normative = |profile: &personal::Profile| {
        let ranks = profile.ranks.iter();
        let ranks = ranks.map(|rank| Ok((rank.disposition.clone(), small(rank.rank, "rank")?)));
        Ok((profile.label.clone(), ranks.collect::<Result<_, ReplayError>>()?))
    };
    Ok(Specification {
        capabilities: recorded.capabilities.clone(),
        goals: (0..).zip(&recorded.goals).map(goal).collect(),
        emergencies: recorded.emergencies.iter().map(category).collect::<Result<_, ReplayError>>()?,
        inferences: personal.inferences.iter().map(inference).collect(),
        normative: personal.normative.iter().map(normative).collect::<Result<_, ReplayError>>()?,
        willingness: Willingness {
            from_percent: small(recorded.willingness_from_percent, "willingness percentage")?,
        },
        limits: Limits {
            users: small(limits.users, "limits")?,
            requests: small(limits.requests, "limits")?,
            emergencies: small(limits.emergencies, "limits")?,
            profiles: small(limits.profiles, "limits")?,
            conditions: small(limits.conditions, "limits")?,
            attributes: small(limits.attributes, "limits")?,
            deferrals: small(limits.deferrals, "limits")?,
            data_within_ms: limits.data_within_ms,
        },
    })
}

/// A number within its type's range.
pub(super) fn small<T: TryFrom<u32>>(number: u32, what: &'static str) -> Result<T, ReplayError> {
    T::try_from(number).map_err(|_| ReplayError::Unknown(what))
}
