//! Each decision, with its negotiations as tables.

use maud::{Markup, html};

use super::super::decision::{Act, Decision, Negotiated, Negotiation, Party, Round, Welfare, Why};
use super::super::page::Page;
use super::floor_map::tint;
use crate::run::clock;
use crate::trace::schema::evidence::Verdict;

pub(super) fn section(page: &Page) -> Markup {
    html! {
        section id="decisions" aria-labelledby="decisions-title" {
            h2 id="decisions-title" { "Round by round" }
            @if page.decisions.is_empty() { p { "This trace holds no decision." } }
            @for decision in &page.decisions { (article(decision)) }
        }
    }
}

fn article(decision: &Decision) -> Markup {
    let id = format!("decision-{}", decision.number);
    html! {
        article.decision id=(id) tabindex="-1" aria-labelledby={ (id) "-title" } {
            h3 id={ (id) "-title" } {
                span.tag.decision { "Decision " (decision.number) } " "
                span { (clock(decision.at)) " – " (decision.headline) }
            }
            @match &decision.why {
                Why::Negotiated(negotiated) => (negotiations(decision, negotiated)),
                Why::Emergency(emergency) => {
                    p.reason { "An emergency that is certain goes before everybody: " (emergency.category) ". " (emergency.evidence) }
                    @if !emergency.broken_off.is_empty() {
                        p { "It broke off what was being negotiated, whose rounds decided nothing:" }
                        @for (nth, negotiation) in (1_usize..).zip(&emergency.broken_off) {
                            (table(decision, nth, negotiation))
                        }
                    }
                    (sections(decision))
                }
            }
        }
    }
}

/// What else the explanation says.
fn sections(decision: &Decision) -> Markup {
    html! {
        @for section in &decision.sections {
            h4 { (section.title) }
            ul { @for sentence in &section.sentences { li { (sentence) } } }
        }
    }
}

/// Welfare as bars, each with its number.
fn worth(negotiated: &Negotiated, welfare: &Welfare) -> Markup {
    let best = welfare.of_serving.iter().map(|(.., worth)| *worth).max().unwrap_or(0);
    html! {
        h4 { "What serving whom is worth to all of them together" }
        table.welfare {
            caption { "Ranks of everybody, summed over the complete offer of who is served" }
            thead { tr { th scope="col" { "Serving" } th scope="col" { "Worth" } } }
            tbody {
                @for (user, name, worth) in &welfare.of_serving {
                    @let served = negotiated.parties.iter().any(|party| party.user == *user && party.served);
                    tr {
                        th scope="row" {
                            (name)
                            @if served { " " span.tag.decision { "served" } }
                            @if *worth == best { " " span.tag.best { "best" } }
                        }
                        td class=(tint(*user)) {
                            span.amount { (worth) }
                            svg.bar viewBox="0 0 100 14" preserveAspectRatio="none" aria-hidden="true" {
                                rect.own x="0" y="2" width=(share(*worth, best)) height="10" {}
                            }
                        }
                    }
                }
            }
        }
        p {
            @if welfare.regret == 0 { "Nobody else’s request is worth more." }
            @else { "The best is worth " (welfare.regret) " more than what was decided." }
        }
    }
}

/// In percent.
fn share(number: u64, most: u64) -> u64 {
    number.saturating_mul(100).checked_div(most).unwrap_or(0)
}

fn negotiations(decision: &Decision, negotiated: &Negotiated) -> Markup {
    html! {
        ul.parties {
            @for (nth, party) in negotiated.parties.iter().enumerate() { (one_party(nth, party)) }
        }
        @for (nth, negotiation) in (1_usize..).zip(&negotiated.negotiations) {
            (table(decision, nth, negotiation))
        }
        @if let Some(welfare) = &negotiated.welfare { (worth(negotiated, welfare)) }
        (sections(decision))
        p.variant { "Protocol variant " code { (negotiated.variant) } ", policy " code { (negotiated.policy) } "." }
    }
}

fn one_party(nth: usize, party: &Party) -> Markup {
    html! {
        li class=(tint(party.user)) {
            span.dot aria-hidden="true" {}
            span {
                b { (party.name) } ", "
                @if nth == 0 { "who had the robot" } @else { "who interrupted" }
                @if let Some(goal) = &party.goal { " (" (goal) ")" }
                ": " @if party.served { strong { "is served" } } @else { "has to wait" }
            }
        }
    }
}

fn table(decision: &Decision, nth: usize, negotiation: &Negotiation) -> Markup {
    html! {
        div.negotiation {
            h4 {
                "The robot speaks for " (negotiation.current) " and for " (negotiation.interrupting)
            }
            // Phones show rows as cards; the roles keep this a table for screen readers then.
            table.rounds role="table" {
                caption {
                    "Negotiation " (nth) " of decision " (decision.number) ". "
                    (negotiation.interrupting) " interrupts and offers first."
                }
                thead role="rowgroup" {
                    tr role="row" {
                        @for column in ["Round", "Offer", "Worth", "Answer"] {
                            th scope="col" role="columnheader" { (column) }
                        }
                    }
                }
                tbody role="rowgroup" { @for round in &negotiation.rounds { (row(round)) } }
            }
            @match &negotiation.ending {
                Some(ending) => p.ending {
                    @match &ending.winner {
                        Some(winner) => b { "Agreement for " (winner) },
                        None => b { "No agreement" },
                    }
                    " after " (ending.rounds) @if ending.rounds == 1 { " round. " } @else { " rounds. " }
                    (ending.sentence)
                },
                None => p.ending { b { "Broken off." } },
            }
        }
    }
}

fn row(round: &Round) -> Markup {
    html! {
        tr.decisive[round.decisive] role="row" aria-current=[round.decisive.then_some("true")] {
            th scope="row" role="rowheader" { (round.number) }
            @match &round.act {
                Act::Quit => {
                    td role="cell" { (round.sender) " has no further offer and quits." }
                    td.nothing role="cell" { "–" }
                    td.nothing role="cell" { "–" }
                }
                Act::Offer { depth, discloses, worth, verdict } => {
                    td role="cell" {
                        @match discloses {
                            Some(what) => { b { (round.sender) } " discloses " (what) "." },
                            None => { b { (round.sender) } " discloses one more condition, the " (ordinal(*depth)) "." },
                        }
                    }
                    td role="cell" {
                        @match worth {
                            Some((value, threshold)) => (bar(&round.receiver, *value, *threshold)),
                            None => span.none { "not shown" },
                        }
                    }
                    (answer(round, *verdict))
                }
            }
        }
    }
}

fn answer(round: &Round, verdict: Verdict) -> Markup {
    let (class, sign, word) = match verdict {
        Verdict::Accept => ("accept", "✓", "accepts"),
        Verdict::Reject => ("reject", "✗", "rejects"),
        Verdict::Hold => ("hold", "…", "holds it"),
        Verdict::Unspecified => ("reject", "?", "gives no answer"),
    };
    html! {
        td role="cell" {
            span class={ "verdict " (class) } { span aria-hidden="true" { (sign) } " " (round.receiver) " " (word) }
            @if round.decisive { " " span.badge { "decisive" } }
        }
    }
}

/// What the offer is worth to its receiver, against the receiver's own case.
fn bar(receiver: &str, value: u64, threshold: u64) -> Markup {
    let most = value.max(threshold).max(1);
    html! {
        span { b { (value) } " to " (receiver) ", whose own case is " b { (threshold) } }
        svg.bar viewBox="0 0 100 14" preserveAspectRatio="none" aria-hidden="true" {
            rect.value.more[value > threshold] x="0" y="0" width=(share(value, most)) height="6" {}
            rect.threshold x="0" y="8" width=(share(threshold, most)) height="6" {}
        }
    }
}

fn ordinal(depth: u64) -> String {
    match depth {
        1 => "first".to_owned(),
        2 => "second".to_owned(),
        3 => "third".to_owned(),
        more => format!("number {more}"),
    }
}
