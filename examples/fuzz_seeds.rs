//! Writes the fuzz targets' seeds: `cargo run --example fuzz_seeds`, in the project's root.

#[path = "../fuzz/src/targets.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    clippy::expect_used,
    clippy::indexing_slicing,
    reason = "shared with the fuzz targets"
)]
mod targets;

use std::error::Error;
use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use selfneg::mission::{Event, Output};
use selfneg::run::{Setup, Watcher, run};
use selfneg::scenario::Scenario;
use selfneg::seal::{AuditorKey, Privacy, Seal};
use selfneg::trace::TraceWriter;
use targets::{InMemory, ROOM, SEALED, SEPARATOR, bare, keys, packed, robot, seeds_of, unpacked};

fn main() -> Result<(), Box<dyn Error>> {
    let mall = Path::new("examples/mall");
    let texts = |folder: &str, files: &[&str]| -> Result<String, Box<dyn Error>> {
        let read = files.iter().map(|file| fs::read_to_string(mall.join(folder).join(file)));
        Ok(read.collect::<Result<Vec<_>, _>>()?.join(SEPARATOR))
    };
    let rules = texts("", &["disposition_activation.json", "ethical_implications.json"])?;
    let user = ["ethic_profiles.json", "user_status.json", "context.json", "goal.json"];
    let (alice, bob) = (texts("Alice", &user)?, texts("Bob", &user)?);
    let carol = [
        r#"{"mall": {"elderly people": 255, "disabled people": 0}, "": {}}"#,
        r#"{"unheard of": true, "elderly": null, "in urgency": true, "end of goal": true}"#,
        r#"{"location": "mall", "other": [1, -2.5e3, "\u00e9", {}]}"#,
        r#"{"goal": "pharmacy"}"#,
    ]
    .join(SEPARATOR);
    write("rules", "mall", &rules)?;
    write("rules", "small", format!(r#"{{"a": ["x", "x"], "b": []}}{SEPARATOR}{{"g": ["x", "y", "y"]}}"#))?;
    for (name, user) in [("alice", &alice), ("bob", &bob), ("carol", &carol)] {
        write("user", name, user)?;
    }
    for (name, variant, users) in [
        ("two", "exhausted per-condition first-sender first-come 0 -", vec![&alice, &bob]),
        ("willing", "literal per-disposition fallback utilitarian 3 condorcet", vec![&bob, &carol]),
        ("three", "exhausted per-condition surplus first-come 1 published", vec![&alice, &bob, &carol]),
        ("four", "exhausted per-condition surplus utilitarian 0 -", vec![&carol, &alice, &bob, &alice]),
    ] {
        let mut texts = vec![variant, rules.as_str()];
        texts.extend(users.into_iter().map(String::as_str));
        write("decision", name, texts.join(SEPARATOR))?;
    }
    write("building", "room", ROOM.join(SEPARATOR))?;
    let elevator = "floors:\n- {name: a, map: a.yaml}\n- {name: b, map: b.yaml}\nelevators:\n- \
                    {name: lift, ride_seconds: 9, stops: [{floor: a, x: .5, y: .5}, {floor: b, x: .5, y: .5}]}";
    let map = "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 1\noccupied_thresh: 0.6\nfree_thresh: 0.2\n\
               mode: trinary\n";
    write("building", "elevator", [elevator, map, "P5\n1 1\n255\n\0"].join(SEPARATOR))?;

    let room = fs::read_to_string("examples/room/scenario.toml")?;
    for target in ["scenario", "run"] {
        write(target, "room", &room)?;
    }
    write("run", "room-three", room.replace("at = 2 }", "at = 2.9 }").replace("at = 9 }", "at = 19 }"))?;
    write("scenario", "every-key", fs::read_to_string("examples/scenarios/annotated.toml")?)?;

    let scenario = Scenario::parse(&room, Path::new("examples/room/scenario.toml"), &InMemory)?;
    let mut writer = TraceWriter::plain(Vec::new())?;
    run(&scenario, &mut [&mut Blind(&mut writer)])?;
    let trace = writer.into_inner().ok_or("the trace is not there")?;
    // Only if it was emptied: it is random, and the targets know that no other was signed.
    if SEALED.is_empty() {
        write("sealed", "room.mcap", sealed(&scenario)?)?;
    }
    if !SEALED.is_empty() {
        write("sealed", "bare.mcap", bare(SEALED))?;
    }
    let messages = unpacked(&trace);
    let bare_trace = packed(&messages);
    write("trace", "cut.mcap", bare_trace.get(..bare_trace.len() / 2).unwrap_or_default())?;
    write("trace", "bare.mcap", bare_trace)?;
    write("messages", "room", messages)?;
    write("trace", "room.mcap", &trace)?;

    Ok(())
}

fn sealed(scenario: &Scenario) -> Result<Vec<u8>, Box<dyn Error>> {
    let auditors = keys().identities.iter().map(AuditorKey::public).collect();
    let random = |bytes: &mut [u8]| getrandom::fill(bytes).map_err(io::Error::other);
    let seal = Seal { privacy: Privacy::Sealed(auditors), signer: Some(robot()), random: Box::new(random) };
    let mut writer = TraceWriter::create(Vec::new(), seal)?;
    run(scenario, &mut [&mut Blind(&mut writer)])?;
    Ok(writer.into_inner().ok_or("the trace is not there")?)
}

fn write(target: &str, name: &str, content: impl AsRef<[u8]>) -> Result<(), Box<dyn Error>> {
    let folder = seeds_of(target);
    fs::create_dir_all(&folder)?;
    fs::write(folder.join(name), content)?;
    Ok(())
}

/// Does not see where everybody is, which makes most of a trace.
struct Blind<'w>(&'w mut dyn Watcher);

impl Watcher for Blind<'_> {
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        self.0.begin(setup)
    }

    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        self.0.event(at, event)
    }

    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        self.0.output(at, output)
    }

    fn decided(&mut self, at: Duration) -> io::Result<()> {
        self.0.decided(at)
    }

    fn end(&mut self, at: Duration) -> io::Result<()> {
        self.0.end(at)
    }
}
