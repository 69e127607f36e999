//! What was checked: the audit's status, properties and findings, and the seal.

use maud::{Markup, html};

use super::super::page::Page;
use super::facts;
use crate::audit::{Audit, Finding, Property, PropertyResult, Redecided, Status, Verdict};

pub(super) fn section(page: &Page) -> Markup {
    let audit = &page.audit;
    html! {
        section id="checks" aria-labelledby="checks-title" {
            h2 id="checks-title" { "What was checked" }
            p.status { (badge(audit.status)) " " (meaning(audit.status)) }
            (findings(audit))
            p { (made_again(audit)) }
            div.scroll role="region" aria-label="Properties checked" tabindex="0" {
                table {
                    caption { "Properties that every run of the robot must have" }
                    thead { tr { th scope="col" { "Property" } th scope="col" { "Result" } th scope="col" { "Checked" } } }
                    tbody { @for property in &audit.properties { (row(property)) } }
                }
            }
            @if !audit.unchecked.is_empty() {
                h3 { "Not checked" }
                ul { @for what in &audit.unchecked { li { (what) } } }
            }
            h3 id="seal" { "Seal" }
            p { (page.seal.signature) }
            p { (page.seal.privacy) }
            (facts(&page.seal.facts))
        }
    }
}

/// The status as a word in a frame; never by colour alone.
pub(super) fn badge(status: Status) -> Markup {
    let (class, sign) = match status {
        Status::Ok => ("accept", "✓"),
        Status::Unreadable | Status::Tampered | Status::WrongDecision | Status::Violation => ("reject", "✗"),
        Status::Truncated | Status::Untrusted | Status::Unsealed | Status::Incomplete => ("hold", "!"),
    };
    html! { span class={ "verdict fixed " (class) } { span aria-hidden="true" { (sign) } " " (status) } }
}

pub(super) const fn meaning(status: Status) -> &'static str {
    match status {
        Status::Unreadable => "This is not a trace that this program can read.",
        Status::Tampered => "What is here is not what was written.",
        Status::WrongDecision => "A decision is not what rules, options and inputs lead to.",
        Status::Violation => "A property does not hold that every run must have.",
        Status::Truncated => "The end is missing; what is intact was checked.",
        Status::Untrusted => {
            "Nothing is wrong, but who signed it is not known here: no robot key was given, or another one."
        }
        Status::Unsealed => "Nothing is wrong, but it is not signed, or its personal data are in the open.",
        Status::Incomplete => "Nothing is wrong, but personal data are erased, left out or locked.",
        Status::Ok => "Nothing is wrong, as far as it was checked.",
    }
}

fn findings(audit: &Audit) -> Markup {
    html! {
        @if !audit.findings.is_empty() {
            h3 { "Findings" }
            ul.findings { @for finding in &audit.findings { (one(finding)) } }
            @if audit.more_findings > 0 { p { "And " (audit.more_findings) " more." } }
        }
    }
}

fn one(finding: &Finding) -> Markup {
    html! { li { b { (finding.status) } ", at " (finding.at) ": " (finding.what) "." } }
}

fn made_again(audit: &Audit) -> String {
    let is = |wanted| audit.decisions.iter().filter(|decision| decision.redecided == wanted).count();
    let (same, differs, all) = (is(Redecided::Same), is(Redecided::Differs), audit.decisions.len());
    match (all, same, differs) {
        (0, ..) => "There is no decision to make again.".to_owned(),
        (1, 1, _) => {
            "The decision was made again from its inputs: it is the same, in every round.".to_owned()
        }
        (_, _, 0) if same == all => {
            format!(
                "All {all} decisions were made again from their inputs: they are the same, in every round."
            )
        }
        (_, 0, 0) => "No decision was made again: what they were made from cannot be read here.".to_owned(),
        _ => format!(
            "Of {all} decisions made again from their inputs {same} are the same in every round, {differs} are \
             not, and the others could not be made again."
        ),
    }
}

fn row(property: &PropertyResult) -> Markup {
    let (class, sign, word) = match property.result {
        Verdict::Held => ("accept", "✓", "held"),
        Verdict::HeldInPart => ("hold", "✓", "held as far as it could be checked"),
        Verdict::Violated => ("reject", "✗", "violated"),
        Verdict::NotChecked => ("hold", "–", "not checked"),
        Verdict::NothingToCheck => ("hold", "–", "nothing to check on"),
    };
    let said = Property::ALL.into_iter().find(|known| known.name() == property.name).map(says);
    html! {
        tr {
            th scope="row" { (property.name) @if let Some(said) = said { " " span.says { (said) } } }
            td { span class={ "verdict " (class) } { span aria-hidden="true" { (sign) } " " (word) } }
            td.fixed { (property.checked) @if property.checked == 1 { " time" } @else { " times" } }
        }
    }
}

const fn says(property: Property) -> &'static str {
    match property {
        Property::Termination => {
            "No negotiation takes more rounds than both users have offers, and two more."
        }
        Property::OneDisclosure => "Each offer discloses exactly one condition more.",
        Property::NoVerdictWithoutOffer => "Nothing is accepted that was not offered.",
        Property::Protocol => "Who speaks when, when it ends and who wins follow from the answers.",
        Property::RulesInForce => "Protocol variant and policy are those that the run began with.",
        Property::Policy => {
            "The decision follows from the negotiations, and the robot does what was decided."
        }
        Property::WipedInTime => "Data of whoever is put off or done with are wiped at once.",
        Property::HardEthics => {
            "Certain emergencies go first, the graver before the others; mere claims change nothing."
        }
        Property::Redecision => "Made again from its inputs, each decision is the same in every round.",
        Property::Replay => "Run again on the recorded events, the robot replies as recorded.",
        Property::Commitments => "What was committed to in the open fits what was sealed.",
    }
}
