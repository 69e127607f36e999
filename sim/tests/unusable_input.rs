//! Buildings, worlds and people that cannot be: each is an error that says so.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "also in what tests call")]

use std::fs;
use std::path::Path;

use selfneg_sim::{
    Building, BuildingError, MapError, Person, PgmError, Point, RobotModel, Settings, Waypoint, World,
    WorldError,
};

const MAP: &str = "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A room of 4 x 3 m with a wall across, open at the top.
fn image() -> Vec<u8> {
    let mut bytes = b"P5\n40 30\n255\n".to_vec();
    for row in 0..30 {
        bytes.extend((0..40).map(|column| if (20..22).contains(&column) && row > 12 { 0 } else { 254 }));
    }
    bytes
}

fn read(building: &str, map: &str, image: &[u8]) -> Result<Building, BuildingError> {
    Building::from_memory(building, |path| match path.to_str() {
        Some("m.yaml") => Ok(map.as_bytes().to_vec()),
        Some("m.pgm") => Ok(image.to_vec()),
        _ => Err(BuildingError::Io { path: path.to_owned(), source: std::io::ErrorKind::NotFound.into() }),
    })
}

fn with_place(place: &str) -> Result<Building, BuildingError> {
    read(&format!("floors: [{{name: f, map: m.yaml, places: [{place}]}}]"), MAP, &image())
}

fn world() -> World {
    let building = with_place("{name: a, x: 1, y: 1}, {name: b, x: 3, y: 1}").unwrap();
    World::new(building, Settings::default(), "a").unwrap()
}

#[test]
fn places_off_the_map_or_inside_a_wall() {
    assert!(matches!(with_place("{name: a, x: 9, y: 1}"), Err(BuildingError::OffMap { .. })));
    assert!(matches!(with_place("{name: a, x: -0.01, y: 1}"), Err(BuildingError::OffMap { .. })));
    assert!(matches!(with_place("{name: a, x: 2.1, y: 1}"), Err(BuildingError::InsideWall { .. })));
    assert!(matches!(with_place("{name: a, x: .nan, y: 1}"), Err(BuildingError::Yaml { .. })));
    assert!(matches!(with_place("{name: a, x: 1}"), Err(BuildingError::Yaml { .. })));
    let twice = with_place("{name: a, x: 1, y: 1}, {name: a, x: 3, y: 1}");
    assert!(matches!(twice, Err(BuildingError::DuplicateName { what: "places", .. })));
    let tight = with_place("{name: a, x: 1, y: 1}, {name: b, x: 1.9, y: 1}").unwrap();
    let error = World::new(tight, Settings::default(), "a").unwrap_err();
    assert!(matches!(&error, WorldError::TooTight { name, .. } if name == "b"), "{error}");
}

#[test]
fn buildings_that_do_not_hang_together() {
    assert!(matches!(read("floors: []", MAP, &image()), Err(BuildingError::NoFloor)));
    assert!(matches!(read("floors: [{name: f, map: x.yaml}]", MAP, &image()), Err(BuildingError::Io { .. })));
    let f = "{name: f, map: m.yaml}";
    let two = read(&format!("floors: [{f}, {f}]"), MAP, &image());
    assert!(matches!(two, Err(BuildingError::DuplicateName { what: "floors", .. })));
    let lift = |lift: &str| read(&format!("floors: [{f}]\nelevators: [{lift}]"), MAP, &image());
    let unknown = lift("{name: e, ride_seconds: 9, stops: [{floor: g, x: 1, y: 1}]}");
    assert!(matches!(unknown, Err(BuildingError::UnknownFloor { .. })));
    let slow = lift("{name: e, ride_seconds: 1e9, stops: []}");
    assert!(matches!(slow, Err(BuildingError::Ride { .. })));
    let wall = lift("{name: e, ride_seconds: 9, stops: [{floor: f, x: 2.1, y: 1}]}");
    assert!(matches!(wall, Err(BuildingError::InsideWall { .. })));
}

#[test]
fn every_truncation_of_every_file_is_an_error_or_a_building_and_never_a_panic() {
    let building =
        "name: h\nfloors:\n  - name: f\n    map: m.yaml\n    places:\n      - {name: a, x: 1, y: 1}\n";
    let image = image();
    for cut in 0..building.len() {
        let _ = read(building.get(..cut).unwrap(), MAP, &image);
    }
    for cut in 0..MAP.len() {
        let _ = read(building, MAP.get(..cut).unwrap(), &image);
    }
    for cut in 0..image.len() {
        let error = read(building, MAP, &image[..cut]).unwrap_err();
        assert!(matches!(error, BuildingError::Map { source: MapError::Pgm(_), .. }), "{error}");
    }
}

#[test]
fn errors_name_the_file() {
    let folder = std::env::temp_dir().join(format!("selfneg-sim-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).unwrap();
    write("b.yaml", b"floors: [{name: f, map: m.yaml}]");
    write("m.yaml", MAP.as_bytes());
    write("m.pgm", &image()[..100]);
    let open = || Building::open(&folder.join("b.yaml")).map_err(|e| e.to_string());
    let truncated = open().unwrap_err();
    assert!(truncated.contains("m.yaml") && truncated.contains("87 of 1200 samples"), "{truncated}");
    fs::remove_file(folder.join("m.pgm")).unwrap();
    assert!(open().unwrap_err().contains("m.pgm"));
    write("m.yaml", b"\xff");
    assert!(open().unwrap_err().contains("not UTF-8"));
    write("m.yaml", &vec![b' '; (1 << 20) + 1]);
    assert!(open().unwrap_err().contains("more than"));
    fs::remove_dir_all(&folder).unwrap();
    assert!(matches!(Building::open(Path::new("nowhere.yaml")), Err(BuildingError::Io { .. })));
}

#[test]
fn huge_images_are_refused_before_they_are_read() {
    let error = read("floors: [{name: f, map: m.yaml}]", MAP, b"P5 8192 8192 255\n").unwrap_err();
    let expected = MapError::Pgm(PgmError::Dimensions { width: 8192, height: 8192 });
    assert!(matches!(error, BuildingError::Map { source, .. } if source == expected));
}

#[test]
fn settings_out_of_range() {
    let start = |settings| World::new(Building::mall().unwrap(), settings, "entrance").unwrap_err();
    let base = Settings::default();
    let model = RobotModel::TIAGO;
    for (bad, name) in [
        (Settings { step: std::time::Duration::ZERO, ..base }, "step"),
        (Settings { step: std::time::Duration::from_secs(1), ..base }, "step"),
        (Settings { patience: f64::NAN, ..base }, "patience"),
        (Settings { model: RobotModel { radius: -1.0, ..model }, ..base }, "radius"),
        (Settings { model: RobotModel { acceleration: f64::INFINITY, ..model }, ..base }, "acceleration"),
        (Settings { model: RobotModel { cruise_speed: 2.0, ..model }, ..base }, "cruise_speed"),
    ] {
        let error = start(bad);
        assert!(matches!(&error, WorldError::Setting { name: n, .. } if *n == name), "{name}: {error}");
    }
    let unknown = World::new(Building::mall().unwrap(), base, "moon").unwrap_err();
    assert!(unknown.to_string().contains("bakery"), "{unknown}");
}

#[test]
fn people_that_cannot_be() {
    let mut world = world();
    let ann = Person::standing("Ann", 0, Point::new(3.0, 2.0));
    let mut add = |person: Person| world.add_person(person).unwrap_err();
    assert!(matches!(add(Person { floor: 7, ..ann.clone() }), WorldError::UnknownFloor { .. }));
    assert!(matches!(add(Person { radius: 0.0, ..ann.clone() }), WorldError::BadPerson { .. }));
    assert!(matches!(add(Person { speed: f64::NAN, ..ann.clone() }), WorldError::BadPerson { .. }));
    assert!(matches!(
        add(Person { position: Point::new(2.0, 1.0), ..ann.clone() }),
        WorldError::PersonInWall { .. }
    ));
    assert!(matches!(add(ann.clone().walking(&[Point::new(1.0, 1.0)])), WorldError::PersonInWall { .. }));
    assert!(matches!(
        add(Person { position: Point::new(1.2, 1.2), ..ann.clone() }),
        WorldError::Overlap { .. }
    ));
    world.add_person(ann.clone()).unwrap();
    assert!(matches!(world.add_person(ann), Err(WorldError::DuplicatePerson { .. })));
    let wait = Waypoint { position: Point::new(3.0, 1.0), wait: -1.0 };
    assert!(matches!(world.send_person("Ann", vec![wait]), Err(WorldError::BadPerson { .. })));
    assert!(matches!(world.send_person("Zoe", vec![]), Err(WorldError::UnknownPerson { .. })));
}
