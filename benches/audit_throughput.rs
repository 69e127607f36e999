//! How many decisions an audit checks in a second: 10,000 decisions, signed and sealed, in many
//! traces and in one, with the auditor's key and without.
//!
//! `cargo bench --bench audit_throughput`; `SELFNEG_DECISIONS=1000` makes it shorter.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    reason = "a measurement"
)]

#[path = "../tests/random_mission/mod.rs"]
mod random_mission;

use std::io;
use std::time::Instant;

use random_mission::{Choice, data};
use rayon::prelude::*;
use selfneg::audit::{Keys, Status, audit};
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal};
use selfneg::trace::TraceWriter;
use selfneg_core::Options;

/// Decisions of each of the many traces.
const EACH: usize = 10;

fn random(bytes: &mut [u8]) -> io::Result<()> {
    getrandom::fill(bytes).map_err(io::Error::other)
}

/// Alice and Bob, again and again: the paper's case, two rounds.
fn story(decisions: usize) -> Vec<Choice> {
    let alice = data([4, 2, 2, 3, 5, 3], &["with a small child", "in urgency"]);
    let bob = data([5, 4, 3, 3, 3, 1], &["elderly"]);
    let once = [
        Choice::Request(1, 0),
        Choice::Answer(alice),
        Choice::Request(2, 1),
        Choice::Answer(bob),
        Choice::Rounds(60),
        Choice::Withdraw(1),
        Choice::Withdraw(2),
    ];
    std::iter::repeat_n(once, decisions).flatten().collect()
}

fn sealed(decisions: usize, robot: &RobotKey, auditor: &AuditorKey) -> Vec<u8> {
    let seal = Seal {
        privacy: Privacy::Sealed(vec![auditor.public()]),
        signer: Some(robot.clone()),
        random: Box::new(random),
    };
    let mut writer = TraceWriter::create(Vec::new(), seal).unwrap();
    random_mission::play(story(decisions), Options::default(), None, &mut writer);
    writer.into_inner().unwrap()
}

fn measure(what: &str, traces: &[Vec<u8>], keys: &Keys, threads: usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let began = Instant::now();
    let (decisions, redecided) = pool.install(|| {
        traces
            .par_iter()
            .map(|bytes| {
                let found = audit(bytes, keys);
                assert_eq!(found.status, Status::Ok, "{:?}", found.findings.first());
                (found.decisions.len(), found.redecided())
            })
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
    });
    let seconds = began.elapsed().as_secs_f64();
    println!(
        "{what}, {threads} thread(s): {decisions} decisions ({redecided} made again) in {seconds:.2} s, {:.0} a second",
        decisions as f64 / seconds
    );
}

fn main() {
    let decisions =
        std::env::var("SELFNEG_DECISIONS").ok().and_then(|text| text.parse().ok()).unwrap_or(10_000);
    let (robot, auditor) = (RobotKey::generate(&mut random).unwrap(), AuditorKey::generate());
    let keys = Keys { robots: vec![robot.public()], identities: vec![auditor.clone()] };
    let open = Keys { identities: Vec::new(), ..keys.clone() };
    let began = Instant::now();
    let many: Vec<Vec<u8>> =
        (0..decisions / EACH).into_par_iter().map(|_| sealed(EACH, &robot, &auditor)).collect();
    let one = vec![sealed(decisions, &robot, &auditor)];
    let bytes = |traces: &[Vec<u8>]| traces.iter().map(Vec::len).sum::<usize>() >> 20;
    println!(
        "written in {:.1} s: {} traces of {EACH} decisions ({} MiB), and one of {decisions} ({} MiB)",
        began.elapsed().as_secs_f64(),
        many.len(),
        bytes(&many),
        bytes(&one)
    );
    for threads in [1, 2] {
        measure("many traces, with the auditor's key", &many, &keys, threads);
        measure("many traces, without it", &many, &open, threads);
    }
    measure("one trace, with the auditor's key", &one, &keys, 1);
    measure("one trace, without it", &one, &open, 1);
}
