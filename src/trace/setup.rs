//! What is fixed before a run: as messages, and back as a mission's rules.

use std::collections::BTreeMap;
use std::path::PathBuf;

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

use super::replay::ReplayError;

pub(super) fn header(setup: &Setup<'_>) -> open::Header {
    open::Header {
        format_major: FORMAT_MAJOR,
        format_minor: FORMAT_MINOR,
        program: PROGRAM.to_owned(),
        scenario: setup.name.to_owned(),
        options: Some(options_of(setup.options)),
        policy: setup.policy.map_or_else(String::new, |policy| policy.name().to_owned()),
        building: setup.building.name().to_owned(),
        floors: setup.building.floors().iter().map(|floor| floor.name.clone()).collect(),
        places: setup.places.to_vec(),
        specification: Some(specification(setup.specification)),
        participants: setup.participants.iter().map(|participant| participant.pseudonym.0).collect(),
    }
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
