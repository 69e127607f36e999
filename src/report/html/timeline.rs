//! The timeline: an ordered list; its buttons move the map.

use maud::{Markup, html};

use super::super::timeline::{Kind, Moment, Sentence, Timeline};
use super::seconds;
use crate::run::clock;

pub(super) fn list(timeline: &Timeline) -> Markup {
    html! {
        div.chronicle {
            h3 id="timeline-title" { "Timeline" }
            div.timeline id="timeline" role="region" aria-labelledby="timeline-title" tabindex="0" {
                @if timeline.moments.is_empty() {
                    p { "This trace tells nothing in sentences." }
                }
                ol {
                    @for moment in &timeline.moments { (item(moment)) }
                }
            }
        }
    }
}

fn item(moment: &Moment) -> Markup {
    let is = |wanted: fn(Kind) -> bool| moment.sentences.iter().any(|sentence| wanted(sentence.kind));
    let decides = is(|kind| matches!(kind, Kind::Decision { .. }));
    let interrupts = is(|kind| kind == Kind::Interruption);
    html! {
        li.moment.decides[decides].interrupts[interrupts] data-at=(seconds(moment.at)) {
            button.seek type="button" disabled data-at=(seconds(moment.at))
                aria-label={ "Show " (clock(moment.at)) " on the map" } { (clock(moment.at)) }
            div.told {
                @for sentence in &moment.sentences { (told(sentence)) }
            }
        }
    }
}

fn told(sentence: &Sentence) -> Markup {
    match sentence.kind {
        Kind::Other => html! { p { (sentence.text) } },
        Kind::Round { .. } => html! { p.round { (sentence.text) } },
        Kind::Interruption => html! { p.key { span.tag { "Interruption" } " " (sentence.text) } },
        Kind::Decision { decision } => html! {
            p.key {
                span.tag.decision { "Decision " (decision) } " " (sentence.text) " "
                a.to-decision href={ "#decision-" (decision) } data-at=(seconds(sentence.at)) {
                    "Decision " (decision) " round by round"
                }
            }
        },
    }
}
