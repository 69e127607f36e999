//! `selfneg report`: what the page says, that it needs nothing else, and that nothing in a trace
//! can break out of its place in it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::string_slice,
    reason = "a test may panic"
)]

mod scaffold;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use base64::Engine as _;
use proptest::prelude::*;
use scaffold::program::{refusal, selfneg};
use selfneg::audit::{Keys, Status};
use selfneg::report::{Act, File, Page, Why};
use selfneg::seal::AuditorKey;
use selfneg::trace::Recording;
use sha2::Digest as _;
use tempfile::TempDir;

const SCENARIOS: [&str; 6] = ["mall", "three_users", "emergency", "elevator", "withholding", "annotated"];

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

fn simulate(scenario: &Path, trace: &Path) {
    selfneg().arg("simulate").arg(scenario).arg("--plaintext").arg("--trace").arg(trace).assert().success();
}

/// The traces of all example scenarios, by their names.
fn traces() -> &'static TempDir {
    static TRACES: OnceLock<TempDir> = OnceLock::new();
    TRACES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        for name in SCENARIOS {
            simulate(
                &examples().join(format!("scenarios/{name}.toml")),
                &folder.path().join(format!("{name}.mcap")),
            );
        }
        folder
    })
}

fn trace(name: &str) -> Vec<u8> {
    fs::read(traces().path().join(format!("{name}.mcap"))).unwrap()
}

fn page_of(name: &str, bytes: &[u8]) -> Page {
    Page::of(File { name, bytes }, &Keys::default()).unwrap()
}

fn page(name: &str) -> Page {
    page_of(&format!("{name}.mcap"), &trace(name))
}

/// What is between `from` and `to`.
fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let rest = text.split_once(from).unwrap_or_else(|| panic!("no {from}")).1;
    rest.split_once(to).unwrap_or_else(|| panic!("no {to}")).0
}

/// All values of an attribute.
fn values<'t>(html: &'t str, attribute: &str) -> Vec<&'t str> {
    let from = format!(" {attribute}=\"");
    html.split(&from).skip(1).map(|rest| rest.split_once('"').unwrap().0).collect()
}

/// The page as a person reads it: a line a block, without drawings.
fn read_out(html: &str) -> String {
    let mut text = String::new();
    let mut rest = between(html, "<body>", "<script>");
    let mut drawing = false;
    while let Some(start) = rest.find('<') {
        if !drawing {
            text.push_str(&rest[..start]);
        }
        let end = start + rest[start..].find('>').unwrap();
        let tag = &rest[start..=end];
        match tag {
            _ if tag.starts_with("<svg") => drawing = true,
            "</svg>" => drawing = false,
            _ if ["<h", "<p", "<li", "<tr", "<div", "<dt", "<figcaption", "<caption", "<footer"]
                .iter()
                .any(|block| tag.starts_with(block)) =>
            {
                text.push('\n');
            }
            _ if ["<td", "<th", "<dd", "<button", "<option"].iter().any(|cell| tag.starts_with(cell)) => {
                text.push_str("  ");
            }
            _ => {}
        }
        rest = &rest[end + 1..];
    }
    let lines = text.lines().map(str::trim_end).filter(|line| !line.trim().is_empty());
    lines.collect::<Vec<_>>().join("\n").replace("&quot;", "\"").replace("&amp;", "&")
}

#[test]
fn it_is_read_like_this() {
    insta::assert_snapshot!("mall", read_out(&page("mall").to_html()));
    insta::assert_snapshot!("emergency", read_out(&page("emergency").to_html()));
}

#[test]
fn the_program_writes_the_page_and_the_same_trace_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let written = ["first.html", "second.html"].map(|name| {
        let file = folder.path().join(name);
        let mut command = selfneg();
        command.arg("report").arg(traces().path().join("three_users.mcap")).arg("-o").arg(&file);
        command.assert().code(0).stderr("").stdout(format!("The report is in {}\n", file.display()));
        fs::read_to_string(file).unwrap()
    });
    assert_eq!(written[0], written[1]);
    assert_eq!(written[0], page("three_users").to_html());
}

/// Every round of every decision is on the page as it was recorded, and each negotiation with an
/// agreement has one decisive round, the accepted one.
#[test]
fn every_round_is_there_and_the_decisive_one_is_marked() {
    for name in SCENARIOS {
        let page = page(name);
        let recorded = Recording::read(&trace(name)).unwrap();
        assert_eq!(u64::try_from(page.decisions.len()).unwrap(), recorded.decisions(), "{name}");
        for decision in &page.decisions {
            let negotiations = match &decision.why {
                Why::Negotiated(negotiated) => &negotiated.negotiations,
                Why::Emergency(emergency) => &emergency.broken_off,
            };
            for negotiation in negotiations {
                let numbers: Vec<u32> = negotiation.rounds.iter().map(|round| round.number).collect();
                assert_eq!(numbers, (1..).take(numbers.len()).collect::<Vec<_>>(), "{name}");
                let decisive: Vec<_> = negotiation.rounds.iter().filter(|round| round.decisive).collect();
                let Some(ending) = &negotiation.ending else {
                    assert!(decisive.is_empty(), "{name}: nothing was decided");
                    continue;
                };
                assert_eq!(usize::try_from(ending.rounds).unwrap(), numbers.len(), "{name}");
                assert_eq!(decisive.len(), usize::from(ending.winner.is_some()), "{name}");
                for round in decisive {
                    let Act::Offer { worth: Some((value, threshold)), .. } = round.act else {
                        panic!("{name}: {round:?}")
                    };
                    assert!(value > threshold, "{name}: {round:?}");
                    assert_eq!(Some(&round.sender), ending.winner.as_ref());
                }
            }
        }
    }
}

/// One script, one style, both of them the ones that the policy names; nothing that is fetched.
fn assert_self_contained(html: &str) {
    let lower = html.to_lowercase();
    let markup = lower.replace(between(&lower, "<script>", "</script>"), "");
    let markup = markup.replace(between(&markup, "<style>", "</style>"), "");
    // What comes from a trace has no '<' or '>' left, nor a quote in an attribute.
    let tags = markup.split('<').skip(1).map(|rest| rest.split_once('>').unwrap().0);
    let tags: Vec<String> = tags.map(|tag| tag.split('"').step_by(2).collect::<Vec<_>>().join("")).collect();
    for (element, times) in [("script", 1), ("style", 1), ("meta", 5), ("title", 1), ("main", 1), ("h1", 1)] {
        let found = tags.iter().filter(|tag| tag.split(' ').next() == Some(element));
        assert_eq!(found.count(), times, "{element}");
    }
    for tag in &tags {
        let mut words = tag.split([' ', '=']);
        let element = words.next().unwrap();
        assert!(
            !["img", "iframe", "object", "embed", "link", "base", "form", "video", "audio"]
                .contains(&element)
        );
        for attribute in words {
            assert!(!["src", "srcset", "style", "action", "ping"].contains(&attribute), "{tag}");
            assert!(!attribute.starts_with("on"), "an event handler: {tag}");
        }
    }
    assert!(!lower.contains("url(") && !lower.contains("@import"), "a style that fetches");
    let policy = between(html, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
    assert!(policy.starts_with("default-src 'none';") && !policy.contains("unsafe"), "{policy}");
    for (begin, end, kind) in [("<style>", "</style>", "style-src"), ("<script>", "</script>", "script-src")]
    {
        let digest = sha2::Sha256::digest(between(html, begin, end).as_bytes());
        let digest = base64::engine::general_purpose::STANDARD.encode(digest);
        assert!(policy.contains(&format!("{kind} 'sha256-{digest}'")), "{kind}: {policy}");
    }
    let ids = values(html, "id");
    let known: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(known.len(), ids.len(), "an id twice");
    for link in values(html, "href") {
        let target = link.strip_prefix('#').unwrap_or_else(|| panic!("{link} leaves the page"));
        assert!(known.contains(target), "{link} leads nowhere");
    }
    for labels in ["aria-labelledby", "for"].into_iter().flat_map(|attribute| values(html, attribute)) {
        assert!(known.contains(labels), "{labels} names nothing");
    }
}

#[test]
fn it_needs_nothing_else() {
    for name in SCENARIOS {
        assert_self_contained(&page(name).to_html());
    }
}

/// Names that would be markup, from the scenario through the trace onto the page.
#[test]
fn names_from_files_stay_names() {
    let folder = tempfile::tempdir().unwrap();
    let script = "</script><script>alert(1)</script>";
    let image = "\"'><img src=x onerror=alert(1)>";
    hostile_scenario(folder.path(), script, image);
    let file = folder.path().join("hostile.mcap");
    simulate(&folder.path().join("scenarios/hostile.toml"), &file);
    let html = page_of("<b>.mcap", &fs::read(&file).unwrap()).to_html();
    assert_self_contained(&html);
    assert!(!html.contains(script) && !html.contains(image) && !html.contains("<b>.mcap"));
    // They are there, escaped: the goal, the condition, the user and the file.
    assert!(html.contains("&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert!(html.contains("&quot;'&gt;&lt;img src=x onerror=alert(1)&gt;"));
    assert!(html.contains("&lt;b&gt;.mcap"));
}

/// The mall with `script` for its name, the condition "elderly" and the pharmacy as a goal, and
/// `image` for Bob.
fn hostile_scenario(folder: &Path, script: &str, image: &str) {
    let quoted = |text: &str| serde_json::to_string(text).unwrap();
    fs::create_dir_all(folder.join("scenarios")).unwrap();
    let hostile = |text: &str| {
        text.replace("\"elderly\"", &quoted(script))
            .replace("\"pharmacy\"", &quoted(&format!("{script} pharmacy")))
            .replace("\"Bob\"", &quoted(image))
            .replace("\"../mall/Bob\"", &quoted(&format!("../mall/{image}")))
    };
    let mall = hostile(&fs::read_to_string(examples().join("scenarios/mall.toml")).unwrap());
    // Places keep their names, which are the map's.
    let place = format!("guide = {}", quoted(&format!("{script} pharmacy")));
    assert!(mall.contains(&place));
    let mall = mall.replace(&place, "guide = \"pharmacy\"");
    let mall = mall.replace("The paper's mall", script);
    fs::write(folder.join("scenarios/hostile.toml"), mall).unwrap();
    let copy = |from: &str, to: &str| {
        for entry in fs::read_dir(examples().join(from)).unwrap() {
            let entry = entry.unwrap();
            if entry.file_type().unwrap().is_file() {
                fs::create_dir_all(folder.join(to)).unwrap();
                let text = hostile(&fs::read_to_string(entry.path()).unwrap());
                fs::write(folder.join(to).join(entry.file_name()), text).unwrap();
            }
        }
    };
    copy("mall", "mall");
    copy("mall/Alice", "mall/Alice");
    copy("mall/Bob", &format!("mall/{image}"));
}

#[test]
fn a_cut_trace_gives_a_page_that_says_so() {
    let whole = trace("mall");
    let page = page_of("cut.mcap", &whole[..whole.len() * 9 / 10]);
    let complete = page.facts.iter().find(|fact| fact.name == "Complete").unwrap();
    assert!(complete.value.starts_with("no: truncated"), "{}", complete.value);
    assert_eq!(page.audit.status, Status::Truncated);
    assert_self_contained(&page.to_html());
}

#[test]
fn what_is_no_trace_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("text.mcap"), "no trace").unwrap();
    let report = |trace: &str, output: &str| {
        let mut command = selfneg();
        command.current_dir(folder.path()).args(["report", trace, "-o", output]);
        refusal(&mut command, folder.path())
    };
    assert_eq!(report("text.mcap", "page.html"), "text.mcap: not an MCAP file");
    assert!(report("none.mcap", "page.html").starts_with("none.mcap: cannot be read: "));
    assert!(!folder.path().join("page.html").exists());
    let mall = traces().path().join("mall.mcap");
    let unwritable = report(mall.to_str().unwrap(), "text.mcap/page.html");
    assert!(unwritable.contains("cannot be written: "), "{unwritable}");
}

/// The demo's folder: its trace is signed and sealed.
fn demo() -> &'static TempDir {
    static DEMO: OnceLock<TempDir> = OnceLock::new();
    DEMO.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        selfneg().args(["demo", "--out"]).arg(folder.path()).assert().success();
        folder
    })
}

/// The report of the demo's trace, with these flags.
fn report_of_demo(flags: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("page.html");
    let mut command = selfneg();
    command.current_dir(demo().path()).args(["report", "trace.mcap", "-o"]).arg(&file).args(flags);
    command.assert().code(0).stderr("");
    fs::read_to_string(file).unwrap()
}

#[test]
fn the_demo_leaves_the_report_of_its_trace_with_all_that_its_keys_open() {
    let written = fs::read_to_string(demo().path().join("report.html")).unwrap();
    assert_eq!(written, report_of_demo(&["--identity", "auditor.key", "--robot-key", "robot.pub"]));
    assert_self_contained(&written);
    let read = read_out(&written);
    for said in [
        "why was Bob made to wait?",
        "Nothing is wrong, as far as it was checked.",
        "This page holds personal data.",
        "The smallest change: had",
        "signed by a robot key that was given as trusted, and whole",
        "opened with an auditor’s key",
        "5 to Bob, whose own case is 4",
        "The decision was made again from its inputs: it is the same, in every round.",
    ] {
        assert!(read.contains(said), "{said}:\n{read}");
    }
}

/// What the mall names, as it stands on the page of somebody who has the key.
const PERSONAL: [&str; 9] =
    ["Alice", "Bob", "elderly", "small child", "urgency", "pharmacy", "bathroom", "flowers", "data-track"];

#[test]
fn without_a_key_the_page_holds_nothing_personal_and_says_which_key_would() {
    let open = report_of_demo(&["--identity", "auditor.key"]);
    let locked = report_of_demo(&[]);
    for personal in PERSONAL {
        assert!(open.contains(personal), "{personal}: the check would find nothing");
        // The script reads the attribute by another name.
        assert!(
            !locked.replace(between(&locked, "<script>", "</script>"), "").contains(personal),
            "{personal}"
        );
    }
    assert_self_contained(&locked);
    let recipient = fs::read_to_string(demo().path().join("auditor.pub")).unwrap();
    let read = read_out(&locked);
    assert!(read.contains(&format!(
        "give the auditor’s private key with --identity. It is sealed to {}.",
        recipient.trim()
    )));
    assert!(read.contains("why was user 2 made to wait?") && !read.contains("holds personal data"));
    assert!(locked.contains("aria-current=\"true\""), "the decisive round is in the open");
}

#[test]
fn a_cut_trace_is_exit_code_1_and_a_page_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = trace("mall");
    fs::write(folder.path().join("cut.mcap"), &bytes[..bytes.len() * 9 / 10]).unwrap();
    let mut command = selfneg();
    command.current_dir(folder.path()).args(["report", "cut.mcap", "-o", "page.html"]);
    command.assert().code(1).stderr("warning: cut.mcap: truncated; the report says why\n");
    let read = read_out(&fs::read_to_string(folder.path().join("page.html")).unwrap());
    assert!(read.contains("The end is missing; what is intact was checked."), "{read}");
}

#[test]
fn who_is_erased_is_not_on_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("erased.mcap");
    fs::copy(demo().path().join("trace.mcap"), &trace).unwrap();
    selfneg().arg("erase").arg(&trace).arg("user-2").assert().success();
    let page = folder.path().join("page.html");
    let mut command = selfneg();
    command.current_dir(demo().path()).arg("report").arg(&trace).arg("-o").arg(&page);
    command.args(["--identity", "auditor.key", "--robot-key", "robot.pub"]).assert().code(0);
    let html = fs::read_to_string(page).unwrap();
    assert_self_contained(&html);
    let read = read_out(&html);
    for erased in ["Bob", "elderly"] {
        assert!(!html.contains(erased), "{erased}");
    }
    for said in [
        "Alice discloses “with a small child”",
        "It was erased (what shows several people at once, user-2)",
        "replies as recorded.  ✓ held as far as it could be checked",
        "the same in every round.  – not checked",
    ] {
        assert!(read.contains(said), "{said}:\n{read}");
    }
}

#[test]
fn a_sealed_trace_cut_anywhere_gives_a_page_or_an_error() {
    let whole = fs::read(demo().path().join("trace.mcap")).unwrap();
    let key = fs::read_to_string(demo().path().join("auditor.key")).unwrap();
    let keys = Keys { robots: Vec::new(), identities: AuditorKey::parse_all(&key).unwrap() };
    let mut pages = 0;
    for cut in (0..whole.len()).step_by(whole.len() / 40) {
        if let Ok(page) = Page::of(File { name: "cut.mcap", bytes: &whole[..cut] }, &keys) {
            assert_ne!(page.audit.status, Status::Ok);
            assert_self_contained(&page.to_html());
            pages += 1;
        }
    }
    assert!(pages > 20, "{pages}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A trace whose messages are damaged in any way, with their sums made right again, gives a
    /// page or an error, but never a panic, and a page stays whole.
    #[test]
    fn damaged_messages_never_break_the_page(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>()), 1..40)
    ) {
        let bytes = damaged(&trace("mall"), &damage);
        if let Ok(page) = Page::of(File { name: "damaged.mcap", bytes: &bytes }, &Keys::default()) {
            assert_self_contained(&page.to_html());
        }
    }
}

/// The trace written anew, with bytes of its messages changed: which message, which byte, to what.
fn damaged(bytes: &[u8], damage: &[(prop::sample::Index, prop::sample::Index, u8)]) -> Vec<u8> {
    let messages: Result<Vec<_>, _> = mcap::MessageStream::new(bytes).unwrap().collect();
    let mut messages = messages.unwrap();
    for (message, byte, value) in damage {
        let nth = message.index(messages.len());
        let data = messages[nth].data.to_mut();
        if !data.is_empty() {
            let at = byte.index(data.len());
            data[at] = *value;
        }
    }
    let mut written = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut written).unwrap();
    let format = mcap::records::Metadata {
        name: "selfneg.format".to_owned(),
        metadata: [("version".to_owned(), "1.1".to_owned())].into(),
    };
    writer.write_metadata(&format).unwrap();
    for message in &messages {
        writer.write(message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    written.into_inner()
}
