//! What happened and where: the map, its controls, and the timeline beside it.

use maud::{Markup, html};

use super::super::page::Page;
use super::super::timeline::KeyMoment;
use super::{document, floor_map, seconds};
use crate::run::clock;

pub(super) fn section(page: &Page) -> Markup {
    let moments = page.timeline.key_moments();
    html! {
        section id="run" aria-labelledby="run-title" {
            h2 id="run-title" { "What happened, and where" }
            div.stage {
                div.maps {
                    (floor_map::floors(page, &moments))
                    (controls(page))
                    p.now id="now" role="status" {}
                    (keys(&moments))
                }
                (document::chronicle(page))
            }
        }
    }
}

/// Of no use without the script, and not shown without it.
fn controls(page: &Page) -> Markup {
    let last = page.until.as_secs().saturating_add(u64::from(page.until.subsec_nanos() > 0));
    html! {
        div.player id="player" hidden {
            button.play id="play" type="button" { "Play" }
            label.time for="time" { span { "Time" }
                input id="time" type="range" min="0" max=(last) step="1" value=(page.opening.as_secs())
                    data-opening=(seconds(page.opening));
            }
            span.clock id="clock" { (clock(page.opening)) }
            label.speed for="speed" { span { "Speed" }
                select id="speed" {
                    option value="1" { "1×" }
                    option value="4" selected { "4×" }
                    option value="16" { "16×" }
                }
            }
        }
    }
}

/// Buttons for interruptions and decisions, numbered as on the map.
fn keys(moments: &[KeyMoment]) -> Markup {
    html! {
        @if !moments.is_empty() {
            ol.keys aria-label="Interruptions and decisions, numbered as on the map" {
                @for moment in moments {
                    li {
                        button.seek type="button" disabled data-at=(seconds(moment.at)) {
                            span.number { (moment.number) }
                            span.when { (clock(moment.at)) }
                            span.what { (moment.text) }
                        }
                    }
                }
            }
        }
    }
}
