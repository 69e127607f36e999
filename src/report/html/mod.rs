//! Renders a page as HTML. All text goes through `maud`, which escapes it.

mod checks;
mod decision;
mod document;
mod floor_map;
mod player;
mod timeline;

use std::time::Duration;

use maud::{Markup, html};

use super::page::{Fact, Page};

impl Page {
    /// The page as one HTML file.
    #[must_use]
    pub fn to_html(&self) -> String {
        document::document(self).into_string()
    }
}

/// A time for a script: seconds with two decimals.
fn seconds(at: Duration) -> String {
    format!("{}.{:02}", at.as_secs(), at.subsec_millis() / 10)
}

fn facts(facts: &[Fact]) -> Markup {
    html! {
        @if !facts.is_empty() {
            dl.facts { @for fact in facts { div { dt { (fact.name) } dd { (fact.value) } } } }
        }
    }
}
