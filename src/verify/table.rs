//! A verification told to people, and as one JSON document.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use selfneg_core::Options;
use selfneg_proofs::expected::Verdict;
use selfneg_proofs::report::Report;
use serde_json::{Value, json};

use super::counterexample::{self, Written};
use super::cover;
use super::{Row, Subject, Verification};

/// The verification in words: counts, then each property.
#[must_use]
pub fn tell(verification: &Verification) -> String {
    let mut text = String::new();
    let counts = &verification.counts;
    let _ = writeln!(
        text,
        "Domain: {}: {} ordered pairs of users.\n\
         For these counts every pair is covered by one of {} classes, and the engine ran on one\n\
         pair of each, in both roles. The published variant, {}:\n",
        verification.domain,
        grouped(counts.pairs),
        grouped(u128::from(counts.classes)),
        Options::default()
    );
    let mut count = |what: &str, pairs: u128| {
        let _ = writeln!(text, "  {what:<34} {:>22}  {:>7}", grouped(pairs), share(pairs, counts.pairs));
    };
    count("agreement on the current user", counts.agreement_current);
    count("agreement on the interrupting user", counts.agreement_interrupting);
    count("no agreement", counts.no_agreement);
    count("winner depends on who interrupts", counts.role_dependent);
    count("not a utilitarian optimum", counts.suboptimal());
    let _ = writeln!(
        text,
        "  largest regret {}, among agreements {}\n",
        counts.max_regret(),
        counts.regret_agreed.max
    );
    let mut domains = Domains::default();
    for (subject, rows) in by_subject(&verification.rows) {
        text.push_str(&tell_subject(subject, &rows, &mut domains));
        text.push('\n');
    }
    text.push_str("Domains:\n");
    for (nth, domain) in domains.0.iter().enumerate() {
        let mut lines = wrapped(domain, 90).into_iter();
        let _ = writeln!(text, "  [{}] {}", nth.saturating_add(1), lines.next().unwrap_or_default());
        for line in lines {
            let _ = writeln!(text, "      {line}");
        }
    }
    text.push('\n');
    let unexpected = verification.rows.iter().filter(|row| !row.is_as_expected()).count();
    let verdict = match unexpected {
        0 => "all as expected".to_owned(),
        1 => "1 NOT AS EXPECTED".to_owned(),
        many => format!("{many} NOT AS EXPECTED"),
    };
    let _ = writeln!(
        text,
        "{} verdicts, {verdict}. {:.1} s.\n\
         \"Every case\" is of the domain named and no other; where it says in how many classes (at most,\n\
         over the variants), the engine ran on one case of each. \"Random\" is a sample. Variants that differ\n\
         only in what a property does not look at share their cases. Kani was not run.",
        verification.rows.len(),
        verification.time.as_secs_f64()
    );
    text
}

/// The verification as one JSON document.
#[must_use]
pub fn to_json(verification: &Verification, written: &[Written]) -> Value {
    let counts = &verification.counts;
    let domain = &verification.domain;
    let properties: Vec<Value> = verification.rows.iter().map(row_to_json).collect();
    json!({
        "domain": {
            "dispositions": domain.dispositions(),
            "ranks": [domain.ranks().start(), domain.ranks().end()],
            "pairs": counts.pairs.to_string(),
            "classes": counts.classes.to_string(),
        },
        "counts": {
            "variant": Options::default().to_string(),
            "agreement_current": counts.agreement_current.to_string(),
            "agreement_interrupting": counts.agreement_interrupting.to_string(),
            "no_agreement": counts.no_agreement.to_string(),
            "role_dependent": counts.role_dependent.to_string(),
            "suboptimal": counts.suboptimal().to_string(),
            "max_regret": counts.max_regret(),
            "max_regret_agreed": counts.regret_agreed.max,
        },
        "as_expected": verification.is_as_expected(),
        "properties": properties,
        "written": written.iter().map(|written| json!({ "name": written.name, "commands": written.commands })).collect::<Vec<_>>(),
        "seconds": verification.time.as_secs_f64(),
    })
}

fn row_to_json(row: &Row) -> Value {
    let principal = row.principal();
    let evidence: Vec<Value> = row
        .evidence
        .iter()
        .map(|report| {
            json!({
                "engine": report.method,
                "domain": report.domain,
                "verdict": report.verdict.name(),
                "cases": report.cases.to_string(),
                "classes": report.classes.map(|classes| classes.to_string()),
                "nonvacuous": report.nonvacuous.to_string(),
                "failing": report.failing.map(|failing| failing.to_string()),
                "seconds": report.time.as_secs_f64(),
            })
        })
        .collect();
    json!({
        "name": row.subject.name(),
        "variant": row.options.to_string(),
        "verdict": row.verdict().name(),
        "expected": row.expected.name(),
        "as_expected": row.is_as_expected(),
        "engine": principal.map(|report| report.method),
        "cases": principal.map(|report| report.cases.to_string()),
        "counterexample": row.counterexample().map(counterexample::to_json),
        "evidence": evidence,
    })
}

/// The rows of each property, in the order of the rows.
#[must_use]
pub fn by_subject(rows: &[Row]) -> Vec<(Subject, Vec<&Row>)> {
    let mut subjects: Vec<(Subject, Vec<&Row>)> = Vec::new();
    for row in rows {
        match subjects.iter_mut().find(|(subject, _)| *subject == row.subject) {
            Some((_, rows)) => rows.push(row),
            None => subjects.push((row.subject, vec![row])),
        }
    }
    subjects
}

fn tell_subject(subject: Subject, rows: &[&Row], domains: &mut Domains) -> String {
    let mut text = format!("{}\n", subject.name());
    for line in wrapped(subject.statement(), 96) {
        let _ = writeln!(text, "  {line}");
    }
    let all: BTreeSet<Options> = rows.iter().map(|row| row.options).collect();
    let such = |verdict: Verdict| -> BTreeSet<Options> {
        rows.iter().filter(|row| row.verdict() == verdict).map(|row| row.options).collect()
    };
    let (holds, fails) = (such(Verdict::Holds), such(Verdict::Fails));
    for (verdict, variants) in [("holds", &holds), ("fails", &fails)] {
        if !variants.is_empty() {
            let count = variants.len();
            let noun = if count == 1 { "variant" } else { "variants" };
            let _ = writeln!(text, "  {verdict} in {count} {noun}: {}", cover::describe(variants, &all));
        }
    }
    for row in rows.iter().filter(|row| !row.is_as_expected()) {
        let _ = writeln!(
            text,
            "  NOT AS EXPECTED: {}: {}, expected {}",
            row.options,
            row.verdict(),
            row.expected
        );
    }
    for line in evidence(rows, domains) {
        let _ = writeln!(text, "  {line}");
    }
    let smallest = rows.iter().find(|row| row.verdict() == Verdict::Fails);
    if let Some(found) = smallest.and_then(|row| row.counterexample()) {
        let _ = write!(
            text,
            "  smallest counterexample found for {}:\n{}",
            found.options,
            counterexample::describe(found)
        );
    }
    text
}

/// The domains in the order in which they were first named.
#[derive(Default)]
struct Domains(Vec<String>);

impl Domains {
    /// The domain's number, from 1.
    fn number(&mut self, domain: &str) -> usize {
        if let Some(at) = self.0.iter().position(|known| known == domain) {
            return at.saturating_add(1);
        }
        self.0.push(domain.to_owned());
        self.0.len()
    }
}

/// One line for each engine and domain: what it looked at for one variant.
fn evidence(rows: &[&Row], domains: &mut Domains) -> Vec<String> {
    let mut kinds: Vec<(&str, &str, Vec<&Report>)> = Vec::new();
    for report in rows.iter().flat_map(|row| &row.evidence) {
        match kinds
            .iter_mut()
            .find(|(method, domain, _)| *method == report.method && *domain == report.domain)
        {
            Some((_, _, reports)) => reports.push(report),
            None => kinds.push((report.method, &report.domain, vec![report])),
        }
    }
    kinds
        .into_iter()
        .map(|(method, domain, reports)| {
            let cases = grouped(reports.iter().map(|report| report.cases).max().unwrap_or(0));
            let seconds: f64 = reports.iter().map(|report| report.time.as_secs_f64()).sum();
            let what = match method {
                "sweep" => {
                    let classes = reports.iter().filter_map(|report| report.classes).max().unwrap_or(0);
                    format!("every case of {cases}, in {} classes", grouped(u128::from(classes)))
                }
                "random" => format!("{cases} random cases"),
                "outcomes" => format!("every case of {cases}"),
                _ => format!("every case of {cases}, one by one"),
            };
            let variants = match reports.len() {
                1 => "1 variant".to_owned(),
                many => format!("each of {many} variants"),
            };
            format!("{what:<58} {variants:<21} {seconds:>5.1} s  [{}]", domains.number(domain))
        })
        .collect()
}

/// Digits in groups of three.
fn grouped(number: u128) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (nth, digit) in digits.chars().enumerate() {
        if nth > 0 && digits.len().saturating_sub(nth) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A part of a whole in percent, rounded to two places.
fn share(part: u128, whole: u128) -> String {
    let half = whole / 2;
    let basis_points = part.saturating_mul(10_000).saturating_add(half).checked_div(whole).unwrap_or(0);
    format!("{}.{:02} %", basis_points / 100, basis_points % 100)
}

/// `text` in lines of at most `width` letters, cut between words.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.len().saturating_add(word.len()) < width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_by_thousands() {
        for (number, text) in
            [(0, "0"), (999, "999"), (1_000, "1,000"), (1_000_000_000_000, "1,000,000,000,000")]
        {
            assert_eq!(grouped(number), text);
        }
    }

    #[test]
    fn shares_are_rounded() {
        assert_eq!(share(35_364_899_472, 1_000_000_000_000), "3.54 %");
        assert_eq!(share(1, 0), "0.00 %");
    }

    #[test]
    fn lines_are_cut_between_words() {
        assert_eq!(wrapped("one two three", 8), ["one two", "three"]);
    }
}
