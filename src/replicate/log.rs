//! The published logs' lines.

/// One run as a log line tells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct LoggedRun {
    pub(super) who: Who,
    pub(super) rounds: u64,
    pub(super) outcome: String,
}

/// Who took part in a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Who {
    /// Users by name, run together: `AB`, `ABC`.
    Names(String),
    /// A generated case of the scalability data.
    Generated {
        /// How many dispositions there are.
        dispositions: u32,
        /// The share of active conditions, in percent.
        share: u32,
        /// The current user's profile, from 1.
        profile: usize,
        /// The run's number among those of its size and share, from 1.
        counter: usize,
    },
}

/// Reads one line; `None` if it is no run.
pub(super) fn read_line(line: &str) -> Option<LoggedRun> {
    let who = match after(line, "Users: ") {
        Some(rest) => Who::Names(rest.split('.').next()?.trim().to_owned()),
        None => Who::Generated {
            dispositions: number(after(line, "Scalability test! ")?)?,
            share: number(after(line, " dispositions, ")?)?,
            profile: number(after(line, "ethicprofile no. ")?)?,
            counter: number(after(line, "Test counter: ")?)?,
        },
    };
    let outcome = after(line, "Result: ")?.split(['.', ' ']).next()?.trim();
    let known = matches!(outcome, "current" | "interrupting" | "no-agreement")
        || outcome.strip_prefix("interrupting_").is_some_and(|nth| nth.parse::<u8>().is_ok());
    known.then_some(())?;
    Some(LoggedRun {
        who,
        rounds: number(after(line, "Negotiation rounds: ")?)?,
        outcome: outcome.to_owned(),
    })
}

fn after<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.split_once(key).map(|(_, rest)| rest)
}

/// The number that `text` begins with.
fn number<N: std::str::FromStr>(text: &str) -> Option<N> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    text.get(..end)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_with_names_is_read() {
        let line = "Users: ABC. Multi-lateral: True. Gazebo: False. Negotiation rounds: 4. \
                    Preparation time: 2.010 seconds. Result: interrupting_2";
        assert_eq!(
            read_line(line),
            Some(LoggedRun {
                who: Who::Names("ABC".to_owned()),
                rounds: 4,
                outcome: "interrupting_2".to_owned()
            })
        );
    }

    #[test]
    fn a_generated_line_is_read() {
        let line = "Gazebo: False. Negotiation rounds: 12. Negotiation time: 0.027 seconds. \
                    Result: no-agreement. Goal: {\"goal\": \"Scalability test! 200 dispositions, \
                    75 activated conditions, ethicprofile no. 10. Test counter: 90\"}";
        let who = Who::Generated { dispositions: 200, share: 75, profile: 10, counter: 90 };
        let expected = LoggedRun { who, rounds: 12, outcome: "no-agreement".to_owned() };
        assert_eq!(read_line(line), Some(expected));
    }

    #[test]
    fn anything_else_is_no_run() {
        for line in [
            "",
            "Users: AB. Result: current",
            "Users: AB. Negotiation rounds: x. Result: current",
            "Users: AB. Negotiation rounds: 4. Result: maybe",
            "Negotiation rounds: 4. Result: current",
        ] {
            assert_eq!(read_line(line), None, "{line}");
        }
    }
}
