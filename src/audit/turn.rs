//! A trace in turns: an event, and all that the mission replied to it.

use crate::trace::schema::evidence::{command, event, record};
use crate::trace::{Entry, Open, Recording, Step};

/// An event with its replies. The replies before the first event are a turn without event.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn<'r> {
    pub(super) event: Option<&'r Entry>,
    pub(super) replies: &'r [Entry],
    /// Whether the trace may have lost some of the replies.
    pub(super) may_be_cut: bool,
}

/// The turns of a trace, in order.
pub(super) fn turns(recording: &Recording) -> Vec<Turn<'_>> {
    let is_event = |entry: &Entry| matches!(entry.step, Step::Event { .. });
    let mut turns = Vec::new();
    let mut rest = recording.entries.as_slice();
    let mut event = None;
    loop {
        let replies = rest.iter().position(is_event).unwrap_or(rest.len());
        let (mine, after) = rest.split_at_checked(replies).unwrap_or((rest, &[]));
        let may_be_cut = after.is_empty() && recording.damage.is_some();
        turns.push(Turn { event, replies: mine, may_be_cut });
        let Some((next, behind)) = after.split_first() else { break };
        event = Some(next);
        rest = behind;
    }
    turns
}

impl<'r> Turn<'r> {
    pub(super) fn happened(&self) -> Option<&'r event::Event> {
        match &self.event?.step {
            Step::Event { open, .. } => open.event.as_ref(),
            Step::Reply { .. } => None,
        }
    }

    /// The records, with their entries.
    pub(super) fn records(&self) -> impl Iterator<Item = (&'r Entry, &'r record::Record)> + use<'r> {
        self.replies.iter().filter_map(|entry| match &entry.step {
            Step::Reply { open: Open::Record(open), .. } => {
                open.record.as_ref().map(|record| (entry, record))
            }
            _ => None,
        })
    }

    /// The commands.
    pub(super) fn commands(&self) -> impl Iterator<Item = &'r command::Command> + use<'r> {
        self.replies.iter().filter_map(|entry| match &entry.step {
            Step::Reply { open: Open::Command(open), .. } => open.command.as_ref(),
            _ => None,
        })
    }
}
