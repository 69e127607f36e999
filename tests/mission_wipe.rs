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
use selfneg::mission::{LOCATION, NAME_BYTES, Profile, Stated, Text, UserData};
use selfneg_core::Options;

const MASK: u8 = 0x5a;

/// As long as a name may be.
const LENGTH: usize = NAME_BYTES;

/// What is searched for is the end of each word: an allocator writes over the beginning of
/// memory that it gets back, which must not be mistaken for wiping.
const UNSEARCHED: usize = 24;

/// Words of one user, masked.
#[derive(Clone, Copy)]
struct Words {
    place: [u8; LENGTH],
    condition: [u8; LENGTH],
    /// One rank for each disposition.
    ranks: [u8; LENGTH],
}

impl Words {
    /// Unlike anything else, and never unmasked here.
    fn new(seed: u8) -> Self {
        // Without a period, so that no word is found inside another.
        let random = |from: u32, among: u32| {
            let mut state = u32::from(seed) * 1_000 + from;
            move || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                u8::try_from((state >> 16) % among).unwrap()
            }
        };
        let letters = |from| {
            let mut next = random(from, 26);
            std::array::from_fn(|_| (b'a' + next()) ^ MASK)
        };
        let mut next = random(9, 120);
        let ranks = std::array::from_fn(|_| (130 + next()) ^ MASK);
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
        let words = words.each_ref().map(|word| &word[UNSEARCHED..]);
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
                        if same && rest.zip(word.iter()).all(|(byte, masked)| byte ^ MASK == *masked) {
                            *found += 1;
                        }
                    }
                }
                // Words may lie across two pieces.
                let whole_words = read == length && at + address(read) != before_own;
                at += address(if whole_words { read - LENGTH } else { length });
            }
        }
        buffer.fill(0);
        found
    }
}

/// Exactly as long as it needs to be, so that it never grows and leaves a copy behind.
fn text(masked: &[u8; LENGTH]) -> Text {
    let mut text = String::with_capacity(masked.len());
    for byte in masked {
        text.push(char::from(byte ^ MASK));
    }
    Text::new(text)
}

fn robot() -> Environment {
    let dispositions: Vec<String> = (0..LENGTH).map(|at| format!("\"D{at}\"")).collect();
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
