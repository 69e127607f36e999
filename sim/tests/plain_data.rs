//! With the feature `serde`, what goes in and out of a world is plain data.
#![cfg(feature = "serde")]

use selfneg_sim::{Building, Command, Event, Person, Point, Progress, Robot, Settings, World};

#[test]
fn everything_reads_back() {
    let mut world = World::new(Building::mall().unwrap(), Settings::default(), "entrance").unwrap();
    let command = Command::go_to("clinic");
    let text = serde_json::to_string(&command).unwrap();
    assert_eq!(text, r#"{"kind":"go-to","place":"clinic"}"#);
    let mut events = world.step(serde_json::from_str(&text).unwrap());
    for _ in 0..500 {
        events.extend(world.step(Command::Continue));
    }
    let text = serde_json::to_string(&events).unwrap();
    assert_eq!(serde_json::from_str::<Vec<Event>>(&text).unwrap(), events);
    let robot: Robot = serde_json::from_str(&serde_json::to_string(world.robot()).unwrap()).unwrap();
    assert_eq!(robot.floor, world.robot().floor);
    let progress = serde_json::to_string(&world.progress()).unwrap();
    assert!(serde_json::from_str::<Option<Progress>>(&progress).unwrap().is_some());
    let settings: Settings = serde_json::from_str(r#"{"patience": 2.0}"#).unwrap();
    assert_eq!(settings, Settings { patience: 2.0, ..Settings::default() });
    let person: Person =
        serde_json::from_str(r#"{"name": "Ann", "floor": 0, "position": {"x": 1.0, "y": 2.0}}"#).unwrap();
    assert_eq!(person, Person::standing("Ann", 0, Point::new(1.0, 2.0)));
}
