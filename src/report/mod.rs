//! A trace as a page for people: one HTML file that needs nothing else.
//!
//! [`Page::of`] collects what the page says, from a trace, its audit and its explanation, without
//! a word of HTML; [`Page::to_html`] renders it. Both are pure: the same trace gives the same bytes. What comes
//! from the trace is escaped where it is rendered, and the page's content security policy lets
//! no other script or style run than the two that this module holds, and nothing be fetched.
//!
//! ```no_run
//! use selfneg::audit::Keys;
//! use selfneg::report::{File, Page};
//! use selfneg::seal::AuditorKey;
//!
//! // Without identities the page holds what is in the open, and says what it cannot show.
//! let identities = AuditorKey::parse_all(&std::fs::read_to_string("auditor.key")?)?;
//! let keys = Keys { robots: Vec::new(), identities };
//! let bytes = std::fs::read("trace.mcap")?;
//! let page = Page::of(File { name: "trace.mcap", bytes: &bytes }, &keys)?;
//! for decision in &page.decisions {
//!     println!("{} {}", decision.question, decision.answer.join(" "));
//! }
//! std::fs::write("report.html", page.to_html())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod decision;
mod html;
mod page;
mod seal;
mod stage;
mod timeline;
mod who;

pub use decision::{Act, Decision, Emergency, Ending, Negotiated, Negotiation, Party, Round, Welfare, Why};
pub use page::{Fact, File, Missing, Page};
pub use seal::Seal;
pub use stage::{Floor, Mover, Place, Pose, Sample, Shape, Stage};
pub use timeline::{KeyMoment, Kind, Moment, Sentence, Timeline};
pub use who::Who;
