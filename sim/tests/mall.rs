//! The mall: every place can be reached from every other, within the limits, touching nothing.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "also in what tests call")]

use std::time::Duration;

use selfneg_sim::{Activity, Building, Command, Event, Leg, Person, Point, Settings, World, normalize_angle};

#[path = "../examples/make_mall/plan.rs"]
mod plan;

mod invariants;
use invariants::Watch;

fn world(start: &str) -> World {
    World::new(Building::mall().unwrap(), Settings::default(), start).unwrap()
}

/// Goes to a place, checking every step; gives all events.
fn go(world: &mut World, place: &str, seconds: u32) -> Vec<Event> {
    let mut watch = Watch::new(world);
    let mut events = watch.step(world, Command::go_to(place));
    for _ in 0..seconds * 50 {
        events.extend(watch.step(world, Command::Continue));
        if world.activity() == Activity::Idle {
            break;
        }
    }
    events
}

fn arrived(events: &[Event], place: &str) -> bool {
    events.last() == Some(&Event::Arrived { place: place.into() })
}

#[test]
fn the_committed_images_are_what_the_example_draws() {
    for (name, bytes) in plan::images() {
        let path = format!("{}/maps/mall/{name}", env!("CARGO_MANIFEST_DIR"));
        assert!(std::fs::read(&path).unwrap() == bytes, "{path} is out of date: run the example make_mall");
    }
}

#[test]
fn the_files_on_disk_are_the_mall_that_is_built_in() {
    let path = format!("{}/maps/mall/mall.yaml", env!("CARGO_MANIFEST_DIR"));
    assert_eq!(Building::open(path.as_ref()).unwrap(), Building::mall().unwrap());
}

#[test]
fn a_tour_of_all_places_arrives_everywhere_about_when_foretold() {
    let building = Building::mall().unwrap();
    let mut world = world("entrance");
    let mut ratios = Vec::new();
    for (floor, place) in building.places().skip(1) {
        let foretold = world.estimate(&place.name).unwrap();
        let before = world.time();
        let events = go(&mut world, &place.name, 180);
        assert!(arrived(&events, &place.name), "{}: {events:?}", place.name);
        assert!(!events.iter().any(|e| matches!(e, Event::Rerouted | Event::Waiting { .. })), "{events:?}");
        let robot = world.robot();
        assert_eq!(robot.floor, floor);
        assert!(robot.pose.position.distance(place.position) < 0.1);
        if let Some(heading) = place.heading {
            assert!(normalize_angle(robot.pose.heading - heading).abs() < 0.05);
        }
        let took = (world.time() - before).as_secs_f64();
        ratios.push(took / foretold.seconds);
        println!(
            "{:24} {:6.2} m  foretold {:6.2} s  took {:6.2} s",
            place.name, foretold.distance, foretold.seconds, took
        );
    }
    assert!(ratios.iter().all(|r| (0.85..1.15).contains(r)), "{ratios:?}");
}

#[test]
fn an_elevator_takes_its_time_and_ends_on_the_other_floor() {
    let mut world = world("entrance");
    let events = go(&mut world, "clinic", 180);
    assert!(arrived(&events, "clinic"));
    let begun = events.iter().position(|e| matches!(e, Event::RideBegun { from: 0, to: 1, .. })).unwrap();
    assert_eq!(events[begun + 1], Event::FloorChanged { floor: 1 });
}

#[test]
fn somebody_standing_in_the_elevator_upstairs_is_waited_for_and_then_given_up() {
    let mut world = world("elevator hall");
    world.add_person(Person::standing("Eve", 1, Point::new(14.2, 13.0))).unwrap();
    let events = go(&mut world, "clinic", 200);
    let blocked = Event::Blocked { place: "clinic".into(), person: Some("Eve".into()) };
    assert_eq!(events.last(), Some(&blocked));
    assert_eq!(world.robot().floor, 0);
}

#[test]
fn stop_keeps_the_goal_and_resume_goes_on() {
    let mut world = world("entrance");
    let mut watch = Watch::new(&world);
    watch.step(&mut world, Command::go_to("pharmacy"));
    for _ in 0..200 {
        watch.step(&mut world, Command::Continue);
    }
    assert_eq!(watch.step(&mut world, Command::Stop), [Event::Paused { place: "pharmacy".into() }]);
    for _ in 0..2000 {
        assert_eq!(watch.step(&mut world, Command::Continue), []);
    }
    assert_eq!(world.activity(), Activity::Paused);
    let stands = *world.robot();
    assert_eq!((stands.twist.linear, stands.twist.angular), (0.0, 0.0));
    assert!(world.progress().unwrap().fraction > 0.0);
    assert_eq!(watch.step(&mut world, Command::Resume), [Event::Resumed { place: "pharmacy".into() }]);
    let mut last = Vec::new();
    for _ in 0..3000 {
        last.extend(watch.step(&mut world, Command::Continue));
    }
    assert!(arrived(&last, "pharmacy"), "{last:?}");
}

#[test]
fn another_goal_on_the_way_replaces_the_first() {
    let mut world = world("entrance");
    let mut watch = Watch::new(&world);
    watch.step(&mut world, Command::go_to("pharmacy"));
    for _ in 0..250 {
        watch.step(&mut world, Command::Continue);
    }
    let events = go(&mut world, "bathroom", 120);
    assert_eq!(events[0], Event::Dropped { place: "pharmacy".into() });
    assert!(arrived(&events, "bathroom"));
}

#[test]
fn a_person_who_passes_is_waited_for() {
    let mut world = world("entrance");
    world
        .add_person(Person::standing("Ann", 0, Point::new(11.5, 5.6)).walking(&[Point::new(17.5, 5.6)]))
        .unwrap();
    let mut watch = Watch::new(&world);
    let mut events = watch.step(&mut world, Command::go_to("elevator hall"));
    for _ in 0..3000 {
        events.extend(watch.step(&mut world, Command::Continue));
    }
    assert!(events.contains(&Event::Arrived { place: "elevator hall".into() }), "{events:?}");
    assert!(events.contains(&Event::PersonDone { person: "Ann".into() }), "{events:?}");
}

#[test]
fn a_person_who_stands_in_the_way_is_passed_where_there_is_room() {
    let mut world = world("entrance");
    let route = world.route("pharmacy").unwrap();
    let Leg::Drive { way, .. } = &route[0] else { panic!("{route:?}") };
    world.add_person(Person::standing("Bob", 0, way[0].towards(way[1], 0.6))).unwrap();
    let events = go(&mut world, "pharmacy", 120);
    assert!(events.contains(&Event::Waiting { person: "Bob".into() }), "{events:?}");
    assert!(events.contains(&Event::Rerouted), "{events:?}");
    assert!(arrived(&events, "pharmacy"), "{events:?}");
}

#[test]
fn a_person_in_a_doorway_ends_in_an_event_not_a_hang() {
    let settings = Settings { give_up_after: 20.0, ..Settings::default() };
    let mut world = World::new(Building::mall().unwrap(), settings, "entrance").unwrap();
    world.add_person(Person::standing("Cid", 0, Point::new(19.6, 5.0))).unwrap();
    let events = go(&mut world, "pharmacy", 200);
    let blocked = Event::Blocked { place: "pharmacy".into(), person: Some("Cid".into()) };
    assert_eq!(events.last(), Some(&blocked), "{events:?}");
    assert!(world.time() < Duration::from_secs(60));
    // Once the way is free the same goal is reached.
    world.remove_person("Cid").unwrap();
    assert!(arrived(&go(&mut world, "pharmacy", 60), "pharmacy"));
}

#[test]
fn the_unknown_is_an_event() {
    let mut world = world("entrance");
    let events = world.step(Command::go_to("Mars"));
    assert!(matches!(&events[..], [Event::Unreachable { place, .. }] if place == "Mars"), "{events:?}");
    assert_eq!(world.activity(), Activity::Idle);
}

/// Among them the bakery, where the robot once came to stand so near to a door jamb that every
/// arc was refused.
#[test]
fn shops_are_reached_through_people_who_walk_to_and_fro() {
    let mut world = world("entrance");
    for i in 0..20_u32 {
        let x = 1.0 + 1.2 * f64::from(i);
        let walk = [Point::new(x, 11.2), Point::new(x, 5.8)];
        let person = Person::standing(&format!("p{i}"), 0, walk[1]).walking(&walk);
        // Those whose walk would lead through a planter stay at home.
        let _ = world.add_person(Person { repeat: true, ..person });
    }
    assert!(world.people().count() >= 5);
    for place in ["entrance", "information", "bakery", "grocery"] {
        let events = go(&mut world, place, 180);
        assert!(arrived(&events, place), "{events:?}");
    }
}
