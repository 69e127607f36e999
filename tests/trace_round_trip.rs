//! What was written can be read back, replays to the same replies, and has the same bytes
//! twice.

#![expect(clippy::unwrap_used, reason = "it is a test")]

#[path = "../examples/scripted_trace/run.rs"]
#[allow(unreachable_pub, reason = "shared with the example")]
mod run;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use proptest::prelude::*;
use selfneg::demo;
use selfneg::input::Truth;
use selfneg::mission::{
    AskId, CategoryId, Command, Event, Evidence, ExecutionId, GoalId, LOCATION, Mission, MissionRules,
    Output, Place, Profile, Stated, UserData, UserId,
};
use selfneg::run::{Setup, Watcher};
use selfneg::trace::{PERSONAL, Reader, Recording, Step, TraceError, TraceWriter};
use selfneg_core::{Options, TieRule};
use selfneg_sim::Building;

fn scripted() -> (Vec<u8>, Vec<Output>) {
    let mut writer = TraceWriter::plain(Vec::new()).unwrap();
    let outputs = run::play(&mut writer).unwrap();
    (writer.into_inner().unwrap(), outputs)
}

#[test]
fn the_scripted_run_replays_to_the_same_replies() {
    let (bytes, outputs) = scripted();
    let recording = Recording::read(&bytes).unwrap();
    assert!(recording.is_complete(), "{:?}", recording.damage);
    let replay = recording.replay().unwrap();
    assert_eq!(replay.difference, None);
    assert_eq!(replay.outputs, outputs);
    assert!(replay.events > 10 && recording.decisions() >= 2, "{} {}", replay.events, recording.decisions());
}

#[test]
fn the_same_run_has_the_same_bytes() {
    assert_eq!(scripted().0, scripted().0);
}

#[test]
fn what_the_users_tell_is_on_personal_topics_alone() {
    let (bytes, _) = scripted();
    let names = ["Alice", "Bob", "Carla", "small child", "elderly", "urgency", "crowd", "dense", "people"];
    let mut personal = BTreeSet::new();
    for message in Reader::new(&bytes) {
        let message = message.unwrap();
        let text = String::from_utf8_lossy(&message.data);
        for name in names {
            if text.contains(name) {
                assert!(message.topic.starts_with(PERSONAL), "{name} on {}", message.topic);
                personal.insert(name);
            }
        }
    }
    assert_eq!(personal.len(), names.len(), "{personal:?}");
}

#[test]
fn a_changed_input_is_seen_by_the_replay() {
    let (bytes, _) = scripted();
    let mut recording = Recording::read(&bytes).unwrap();
    let data = recording.entries.iter_mut().find_map(|entry| match &mut entry.step {
        Step::Event { personal: Some(input), .. } => match &mut input.input {
            Some(selfneg::trace::schema::personal::input::Input::Data(data)) => Some(data),
            _ => None,
        },
        _ => None,
    });
    data.unwrap().profiles[0].ranks[0].rank += 1;
    assert!(recording.replay().unwrap().difference.is_some());
}

#[test]
fn a_missing_reply_is_a_difference() {
    let (bytes, _) = scripted();
    let mut recording = Recording::read(&bytes).unwrap();
    recording.entries.pop();
    assert!(recording.replay().unwrap().difference.is_some());
}

/// A writer that is dropped as a killed process would drop it: nothing is finished.
#[test]
fn a_killed_run_leaves_every_decision_told() {
    struct Killed {
        writer: TraceWriter<Shared>,
        disk: Shared,
        on_disk: Vec<Vec<u8>>,
    }
    impl Watcher for Killed {
        fn begin(&mut self, setup: &Setup<'_>) -> std::io::Result<()> {
            self.writer.begin(setup)
        }
        fn event(&mut self, at: Duration, event: &Event) -> std::io::Result<()> {
            self.writer.event(at, event)
        }
        fn output(&mut self, at: Duration, output: &Output) -> std::io::Result<()> {
            self.writer.output(at, output)
        }
        fn world(&mut self, at: Duration, world: &selfneg_sim::World) -> std::io::Result<()> {
            self.writer.world(at, world)
        }
        fn sentence(&mut self, at: Duration, sentence: &str) -> std::io::Result<()> {
            self.writer.sentence(at, sentence)
        }
        fn decided(&mut self, at: Duration) -> std::io::Result<()> {
            self.writer.decided(at)?;
            self.on_disk.push(self.disk.0.borrow().clone());
            Ok(())
        }
        fn end(&mut self, at: Duration) -> std::io::Result<()> {
            self.writer.end(at)
        }
    }
    let disk = Shared::default();
    let writer = TraceWriter::plain(std::io::BufWriter::new(disk.clone()).into_inner().unwrap()).unwrap();
    let mut killed = Killed { writer, disk, on_disk: Vec::new() };
    let outputs = run::play(&mut killed).unwrap();
    assert!(!killed.on_disk.is_empty());
    for (told, bytes) in (1..).zip(&killed.on_disk) {
        let recording = Recording::read(bytes).unwrap();
        assert!(matches!(recording.damage, Some(TraceError::Truncated { .. })), "{:?}", recording.damage);
        assert!(recording.decisions() >= told);
        let replay = recording.replay().unwrap();
        assert_eq!(replay.difference, None);
        assert!(outputs.starts_with(&replay.outputs));
    }
}

#[derive(Clone, Debug, Default)]
struct Shared(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn conditions() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "with a small child",
        "elderly",
        "in urgency",
        "crowd anxiety",
        "of nobody's rules",
    ])
}

fn truth() -> impl Strategy<Value = Truth> {
    prop::sample::select(vec![Truth::True, Truth::False, Truth::Withheld])
}

fn user_data() -> impl Strategy<Value = UserData> {
    let dispositions = [
        "people with a small child",
        "elderly people",
        "disabled people",
        "people in urgency",
        "people with health conditions",
        "people with crowd anxiety",
    ];
    let ranks = prop::collection::vec(0..=5_u8, 6);
    let status = prop::collection::vec((conditions(), truth()), 0..5);
    (ranks, status, any::<bool>()).prop_map(move |(ranks, status, located)| {
        let status: BTreeMap<_, _> = status.into_iter().collect();
        let stated = |(condition, truth): (&str, Truth)| Stated { condition: condition.into(), truth };
        UserData {
            profiles: vec![Profile {
                label: "mall".into(),
                ranks: dispositions.iter().map(|&name| name.into()).zip(ranks).collect(),
            }],
            status: status.into_iter().map(stated).collect(),
            context: if located { vec![(LOCATION.into(), "mall".into())] } else { Vec::new() },
        }
    })
}

/// What a random environment does next; answers cite what was asked last.
fn event() -> impl Strategy<Value = Event> {
    let user = || (1..5_u32).prop_map(UserId);
    let evidence = prop::sample::select(vec![Evidence::Claimed, Evidence::Sensed, Evidence::Verified]);
    prop_oneof![
        3 => (user(), 0..3_u16, 0..9_u32).prop_map(|(user, goal, place)| Event::Request { user, goal: GoalId(goal), place: Place(place) }),
        6 => user_data().prop_map(|data| Event::Data { user: UserId(0), ask: AskId(0), data }),
        1 => user().prop_map(|user| Event::DataTimeout { user, ask: AskId(1) }),
        1 => (user(), conditions()).prop_map(|(user, value)| Event::Context { user, attribute: "crowd".into(), value: value.into() }),
        1 => (user(), conditions(), truth()).prop_map(|(user, condition, truth)| Event::Status { user, condition: condition.into(), truth }),
        3 => Just(Event::ActionDone { execution: ExecutionId(0) }),
        1 => Just(Event::ActionFailed { execution: ExecutionId(0) }),
        8 => Just(Event::NextRound),
        1 => (0..2_u16, 0..9_u32, evidence).prop_map(|(category, place, evidence)| Event::Emergency { category: CategoryId(category), place: Place(place), evidence }),
        1 => user().prop_map(|user| Event::Withdraw { user }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn random_missions_replay_to_the_same_replies(
        events in prop::collection::vec(event(), 0..60),
        tie in prop::sample::select(TieRule::ALL.to_vec()),
        willingness in 0..3_u8,
    ) {
        let (rules, specification) = (demo::rules().unwrap(), run::specification());
        let options = Options { tie, willingness, ..Options::default() };
        let building = building();
        let mut writer = TraceWriter::plain(Vec::new()).unwrap();
        writer.begin(&Setup {
            name: "random", building: &building, rules: &rules, specification: &specification,
            options, policy: None, participants: &run::participants().unwrap(), places: &[],
        }).unwrap();
        let rules = MissionRules::new(&rules, specification, options, None).unwrap();
        let (mut mission, mut all) = Mission::new(rules);
        for output in &all {
            writer.output(Duration::ZERO, output).unwrap();
        }
        let (mut asks, mut execution) = (Vec::new(), ExecutionId(0));
        for (nth, mut event) in (0..).zip(events) {
            let at = Duration::from_millis(nth);
            match &mut event {
                Event::Data { user, ask, .. } => {
                    if let Some(asked) = asks.pop() { (*user, *ask) = asked; }
                }
                Event::ActionDone { execution: cited } | Event::ActionFailed { execution: cited } => *cited = execution,
                _ => {}
            }
            writer.event(at, &event).unwrap();
            for output in mission.handle(event) {
                match output {
                    Output::Command(Command::AskData { user, ask, .. }) => asks.push((user, ask)),
                    Output::Command(Command::Execute { execution: begun, .. }) => execution = begun,
                    _ => {}
                }
                writer.output(at, &output).unwrap();
                all.push(output);
            }
        }
        writer.end(Duration::from_secs(1)).unwrap();
        let bytes = writer.into_inner().unwrap();
        let recording = Recording::read(&bytes).unwrap();
        prop_assert_eq!(&recording.damage, &None);
        let replay = recording.replay().unwrap();
        prop_assert_eq!(replay.difference, None);
        prop_assert_eq!(replay.outputs, all);
    }
}

/// One small room.
fn building() -> Building {
    let map = selfneg_sim::OccupancyGrid::new(
        2,
        1,
        1.0,
        selfneg_sim::Point::default(),
        vec![selfneg_sim::Cell::Free; 2],
    );
    let floor = selfneg_sim::Floor { name: "ground".into(), map: map.unwrap(), places: Vec::new() };
    Building::new("room".into(), vec![floor], Vec::new()).unwrap()
}
