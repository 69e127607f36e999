//! The document: its head with the security policy, and its sections in order.

use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest as _, Sha256};

use super::super::decision::Decision;
use super::super::page::Page;
use super::{checks, decision, facts, player, timeline};
use crate::run::clock;

const STYLE: &str = include_str!("style.css");
const BEHAVIOUR: &str = include_str!("behaviour.js");

/// Nothing may be fetched, sent or framed, and of scripts and styles only ours may run, whatever
/// got past the escaping.
fn security_policy() -> String {
    let digest = |text: &str| STANDARD.encode(Sha256::digest(text.as_bytes()));
    format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        digest(STYLE),
        digest(BEHAVIOUR)
    )
}

pub(super) fn document(page: &Page) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(security_policy());
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="referrer" content="no-referrer";
                title { (page.title) " – Selfneg report" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                a.skip href="#main" { "Skip to the report" }
                (masthead(page))
                main id="main" {
                    (answers(page))
                    (player::section(page))
                    (decision::section(page))
                    (checks::section(page))
                    (about(page))
                }
                footer {
                    p { "Made from a trace by Selfneg. This file holds everything that it shows; it fetches and sends nothing." }
                }
                script { (PreEscaped(BEHAVIOUR)) }
            }
        }
    }
}

fn masthead(page: &Page) -> Markup {
    let decisions = match page.decisions.len() {
        1 => "one decision".to_owned(),
        number => format!("{number} decisions"),
    };
    html! {
        header.masthead {
            p.kicker { "Selfneg report" }
            h1 { (page.title) }
            p.lede { "A recording of " (length(page.until)) " with " (decisions) "." }
            p.status { a href="#checks" { "Audit" } " " (checks::badge(page.audit.status)) " " (checks::meaning(page.audit.status)) }
            @if page.personal {
                p.personal { b { "This page holds personal data." } " Give it to nobody who may not read the trace." }
            }
            nav aria-label="On this page" {
                ul {
                    li { a href="#answers" { "What was decided" } }
                    li { a href="#run" { "What happened" } }
                    li { a href="#decisions" { "Round by round" } }
                    li { a href="#checks" { "What was checked" } }
                    li { a href="#about" { "The trace" } }
                }
            }
        }
    }
}

/// A time in words.
fn length(time: Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 60, seconds % 60) {
        (0, seconds) => format!("{seconds} s"),
        (minutes, seconds) => format!("{minutes} min {seconds} s"),
    }
}

/// So many answers are shown at once.
const FIRST_ANSWERS: usize = 6;

/// The answers first, each in a sentence or two.
fn answers(page: &Page) -> Markup {
    html! {
        section id="answers" aria-labelledby="answers-title" {
            h2 id="answers-title" { "What was decided" }
            @if page.decisions.is_empty() {
                p { "Nothing had to be decided." }
            } @else {
                @let (first, more) = page.decisions.split_at(page.decisions.len().min(FIRST_ANSWERS));
                ol.answers { @for decision in first { (answer(decision)) } }
                @if !more.is_empty() {
                    details {
                        summary { (more.len()) " more decisions" }
                        ol.answers { @for decision in more { (answer(decision)) } }
                    }
                }
            }
        }
    }
}

fn answer(decision: &Decision) -> Markup {
    html! {
        li {
            p.headline {
                @if decision.question.is_empty() { (clock(decision.at)) " – " (decision.headline) }
                @else { (decision.question) }
            }
            p { @for sentence in &decision.answer { (sentence) " " } }
            @if let Some(change) = &decision.smallest_change { p { (change) } }
            p { a href={ "#decision-" (decision.number) } { "Decision " (decision.number) " round by round" } }
        }
    }
}

fn about(page: &Page) -> Markup {
    html! {
        section id="about" aria-labelledby="about-title" {
            h2 id="about-title" { "The trace" }
            (facts(&page.facts))
            h3 { "What this page does not show" }
            @if let Some(missing) = &page.missing { p { (missing.why) } }
            ul {
                @if let Some(missing) = &page.missing { @for what in &missing.what { li { (what) } } }
                li { "whether what the robot was told is true: a trace says what it was told, and what it did then" }
            }
        }
    }
}

/// Kept apart so that the player can place it beside the map.
pub(super) fn chronicle(page: &Page) -> Markup {
    timeline::list(&page.timeline)
}
