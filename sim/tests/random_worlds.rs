//! Random rooms, people and commands: what must hold after every step, always holds; what can be
//! reached is reached; nothing goes on for ever.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "also in what tests call")]

use std::time::Duration;

use proptest::prelude::*;
use selfneg_sim::{
    Activity, Building, Cell, Command, Event, Floor, OccupancyGrid, Person, Place, Point, RobotModel,
    Settings, World,
};

mod invariants;
use invariants::Watch;

/// A block of furniture: column, row, width and height in cells.
type Block = (u32, u32, u32, u32);

const COLUMNS: u32 = 70;
const ROWS: u32 = 50;

fn room(resolution: f64, blocks: &[Block], places: &[Point]) -> Option<Building> {
    let cells = (0..ROWS).flat_map(|row| {
        (0..COLUMNS).map(move |column| {
            let inside = |&(c, r, w, h): &Block| (c..c + w).contains(&column) && (r..r + h).contains(&row);
            if blocks.iter().any(inside) { Cell::Occupied } else { Cell::Free }
        })
    });
    let map = OccupancyGrid::new(COLUMNS, ROWS, resolution, Point::new(-2.0, 1.0), cells.collect()).ok()?;
    let places = places.iter().zip(["a", "b", "c"]).map(|(&p, name)| Place {
        name: name.into(),
        position: Point::new(-2.0 + p.x * 70.0 * resolution, 1.0 + p.y * 50.0 * resolution),
        heading: None,
    });
    let floor = Floor { name: "room".into(), map, places: places.collect() };
    Building::new("room".into(), vec![floor], vec![]).ok()
}

fn blocks() -> impl Strategy<Value = Vec<Block>> {
    let block = prop_oneof![
        (0..COLUMNS, 0..ROWS, 1..14u32, 1..4u32),
        (0..COLUMNS, 0..ROWS, 1..4u32, 1..14u32),
        (0..COLUMNS, 0..ROWS, 1..6u32, 1..6u32),
    ];
    proptest::collection::vec(block, 0..14)
}

fn spot() -> impl Strategy<Value = Point> {
    (0.03..0.97f64, 0.04..0.96f64).prop_map(|(x, y)| Point::new(x, y))
}

/// Robots from nimble to sluggish; the sluggish ones would cut corners.
fn settings() -> impl Strategy<Value = Settings> {
    (0.1..1.0f64, 0.2..1.5f64, 0.2..1.0f64, 0.3..1.5f64, 10..=50u64).prop_map(
        |(acceleration, turn_acceleration, cruise_speed, max_turn, step)| Settings {
            model: RobotModel {
                acceleration,
                turn_acceleration,
                cruise_speed,
                max_turn,
                ..RobotModel::TIAGO
            },
            step: Duration::from_millis(step),
            ..Settings::default()
        },
    )
}

fn command() -> impl Strategy<Value = (Command, u32)> {
    let command = prop_oneof![
        4 => prop_oneof![Just("a"), Just("b"), Just("c")].prop_map(Command::go_to),
        1 => Just(Command::Stop),
        1 => Just(Command::Resume),
        1 => Just(Command::Cancel),
    ];
    (command, 1..400u32)
}

fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(60)
}

proptest! {
    // More with PROPTEST_CASES, in release mode.
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn what_can_be_reached_is_reached_without_a_touch(
        blocks in blocks(), places in proptest::collection::vec(spot(), 2), resolution in 0.06..0.2f64,
        settings in settings(),
    ) {
        let Some(building) = room(resolution, &blocks, &places) else { return Ok(()) };
        let Ok(mut world) = World::new(building, settings, "a") else { return Ok(()) };
        let foretold = world.estimate("b");
        let mut watch = Watch::new(&world);
        let mut events = watch.step(&mut world, Command::go_to("b"));
        let Ok(foretold) = foretold else {
            let unreachable = matches!(events[..], [Event::Unreachable { .. }]);
            prop_assert!(unreachable);
            return Ok(());
        };
        while world.activity() != Activity::Idle {
            events.extend(watch.step(&mut world, Command::Continue));
            prop_assert!(world.time().as_secs_f64() < 30.0 + 4.0 * foretold.seconds, "{:?}", events);
        }
        prop_assert_eq!(events.last(), Some(&Event::Arrived { place: "b".into() }), "{:?}", events);
    }

    #[test]
    fn whatever_is_commanded_nothing_is_touched(
        blocks in blocks(),
        places in proptest::collection::vec(spot(), 3),
        people in proptest::collection::vec((spot(), spot(), spot(), 0.1..0.4f64, 0.3..2.0f64), 0..5),
        commands in proptest::collection::vec(command(), 1..8),
        settings in settings(),
    ) {
        let Some(building) = room(0.1, &blocks, &places) else { return Ok(()) };
        let Ok(mut world) = World::new(building, settings, "a") else { return Ok(()) };
        for (i, (from, b, c, radius, speed)) in people.iter().enumerate() {
            let at = |p: &Point| Point::new(-2.0 + p.x * 7.0, 1.0 + p.y * 5.0);
            let person = Person::standing(&format!("p{i}"), 0, at(from)).walking(&[at(b), at(c), at(from)]);
            // Who would walk through a wall or the robot stays out.
            let _ = world.add_person(Person { radius: *radius, speed: *speed, repeat: true, ..person });
        }
        let mut watch = Watch::new(&world);
        for (command, steps) in commands {
            watch.step(&mut world, command);
            for _ in 0..steps {
                watch.step(&mut world, Command::Continue);
            }
        }
    }

    #[test]
    fn every_goal_ends_in_an_event(
        blocks in blocks(),
        places in proptest::collection::vec(spot(), 2),
        people in proptest::collection::vec((spot(), spot(), 0.1..0.4f64), 1..5),
    ) {
        let Some(building) = room(0.1, &blocks, &places) else { return Ok(()) };
        let settings = Settings { give_up_after: 20.0, ..Settings::default() };
        let Ok(mut world) = World::new(building, settings, "a") else { return Ok(()) };
        for (i, (from, to, radius)) in people.iter().enumerate() {
            let at = |p: &Point| Point::new(-2.0 + p.x * 7.0, 1.0 + p.y * 5.0);
            let person = Person::standing(&format!("p{i}"), 0, at(from)).walking(&[at(to), at(from)]);
            let _ = world.add_person(Person { radius: *radius, repeat: true, ..person });
        }
        let mut events = world.step(Command::go_to("b"));
        let mut steps = 0;
        while world.activity() != Activity::Idle {
            events.extend(world.step(Command::Continue));
            steps += 1;
            prop_assert!(steps < 50 * 400, "{:?}", events);
        }
        let ended = matches!(
            events.last(),
            Some(Event::Arrived { .. } | Event::Unreachable { .. } | Event::Blocked { .. })
        );
        prop_assert!(ended, "{:?}", events);
    }
}
