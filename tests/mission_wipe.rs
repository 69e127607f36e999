//! Wiping, seen from outside: the whole writable memory of this process is searched for what
//! a user told the robot.
//!
//! The words searched for are kept masked, so that the search does not find itself. That they
//! *are* found while the user is served is what makes the later absence mean something.

#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may stop")]

mod mission_environment;

use std::fs::{self, File};
use std::os::unix::fs::FileExt;

use mission_environment::{ALICE, BOB, Environment, specification};
use selfneg::input::{Rules, Truth};
use selfneg::mission::{LOCATION, Profile, Stated, Text, UserData};
use selfneg_core::Options;

const MASK: u8 = 0x5a;

/// Words of one user: masked, 24 bytes each.
#[derive(Clone, Copy)]
struct Words {
    place: [u8; 24],
    condition: [u8; 24],
    /// One rank for each disposition.
    ranks: [u8; 24],
}

impl Words {
    /// Unlike anything else, and never unmasked here.
    fn new(seed: u8) -> Self {
        let step = |from: usize, by: usize, at: usize, among: usize| {
            u8::try_from((usize::from(seed) + from + by * at) % among).unwrap()
        };
        let letters = |from| std::array::from_fn(|at| (b'a' + step(from, 7, at, 26)) ^ MASK);
        let ranks = std::array::from_fn(|at| (130 + step(0, 11, at, 120)) ^ MASK);
        Self { place: letters(0), condition: letters(5), ranks }
    }

    fn data(self) -> UserData {
        let ranks =
            self.ranks.iter().enumerate().map(|(at, rank)| (Text::new(format!("D{at}")), rank ^ MASK));
        UserData {
            profiles: vec![Profile { label: text(&self.place), ranks: ranks.collect() }],
            status: vec![Stated { condition: text(&self.condition), truth: Truth::True }],
            context: vec![(LOCATION.into(), text(&self.place))],
        }
    }

    /// How often each word stands in memory.
    fn found(self) -> [usize; 3] {
        let words = [self.place, self.condition, self.ranks];
        let maps = fs::read_to_string("/proc/self/maps").unwrap();
        let memory = File::open("/proc/self/mem").unwrap();
        let mut buffer = vec![0_u8; 1 << 20];
        let mut found = [0; 3];
        for line in maps.lines() {
            let mut fields = line.split_whitespace();
            let (range, access) = (fields.next().unwrap(), fields.next().unwrap());
            if !access.starts_with("rw") {
                continue;
            }
            let (from, to) = range.split_once('-').unwrap();
            let mut at = u64::from_str_radix(from, 16).unwrap();
            let end = u64::from_str_radix(to, 16).unwrap();
            while at < end {
                // Reading the buffer into itself would find everything many times.
                let address = |at: usize| u64::try_from(at).unwrap();
                let own = buffer.as_ptr_range();
                let own = address(own.start.addr())..address(own.end.addr());
                if own.contains(&at) {
                    at = own.end;
                    continue;
                }
                let before_own = if at < own.start { own.start.min(end) } else { end };
                let length = usize::try_from(before_own - at).unwrap().min(buffer.len());
                let Ok(read) = memory.read_at(&mut buffer[..length], at) else { break };
                for (start, byte) in buffer[..read].iter().enumerate() {
                    // Most of memory is zero, and no word has a zero.
                    if *byte == 0 {
                        continue;
                    }
                    for (word, found) in words.iter().zip(&mut found) {
                        let rest = buffer[start..read].iter();
                        let same = byte ^ MASK == word[0] && read - start >= word.len();
                        if same && rest.zip(*word).all(|(byte, masked)| byte ^ MASK == *masked) {
                            *found += 1;
                        }
                    }
                }
                // Words may lie across two pieces.
                let whole_words = read == length && at + address(read) != before_own;
                at += address(if whole_words { read - 24 } else { length });
            }
        }
        buffer.fill(0);
        found
    }
}

/// Exactly as long as it needs to be, so that it never grows and leaves a copy behind.
fn text(masked: &[u8; 24]) -> Text {
    let mut text = String::with_capacity(masked.len());
    for byte in masked {
        text.push(char::from(byte ^ MASK));
    }
    Text::new(text)
}

fn robot() -> Environment {
    let dispositions: Vec<String> = (0..24).map(|at| format!("\"D{at}\"")).collect();
    let list = dispositions.join(", ");
    let goals: Vec<String> = ["t1", "t2", "t3", "fly"].map(|goal| format!("\"{goal}\": [{list}]")).into();
    let rules = Rules::parse(("a", "{}"), ("i", &format!("{{{}}}", goals.join(", ")))).unwrap();
    Environment::under(&rules, specification(), Options::default(), None)
}

#[test]
fn nothing_of_a_user_is_left_in_the_memory_of_the_process() {
    let (alice, bob) = (Words::new(3), Words::new(14));
    assert_eq!((alice.found(), bob.found()), ([0; 3], [0; 3]), "before anything is said");

    let mut robot = robot();
    robot.request(ALICE, "t1").data(ALICE, alice.data());
    // The place is the label of the profile and the value of the attribute.
    assert_eq!(alice.found(), [2, 1, 1], "served");

    robot.request(BOB, "t2").data(BOB, bob.data());
    assert_eq!(alice.found(), [2, 1, 2], "negotiating, with a snapshot of the ranks");
    assert_eq!(bob.found(), [2, 1, 2]);
    robot.negotiate();
    assert_eq!(robot.mission.current_user(), Some(ALICE));
    assert_eq!(alice.found(), [2, 1, 1], "has precedence");
    assert_eq!(bob.found(), [0; 3], "has no precedence");

    robot.finish_goal();
    assert_eq!(alice.found(), [0; 3], "the goal is reached");

    robot.data(BOB, bob.data());
    assert_eq!(robot.mission.current_user(), Some(BOB));
    assert_eq!(bob.found(), [2, 1, 1], "served afterwards");
    drop(robot);
    assert_eq!(bob.found(), [0; 3], "the mission is gone");
}
